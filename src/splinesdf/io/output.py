"""`write`: contours, or a field, to a file, in the format that the file's extension names."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any, TypedDict, Unpack

import numpy as np

from splinesdf.contours.carve import Carve
from splinesdf.contours.contour import Contour, box, check_tolerance, smallest_tolerance
from splinesdf.errors import InputError
from splinesdf.ground.arrays import positive
from splinesdf.ground.atomic import write_text
from splinesdf.ground.options import check_known, with_options
from splinesdf.ground.paths import as_path
from splinesdf.io.carved import carved_text
from splinesdf.io.fields import FIELDS, write_field
from splinesdf.io.placing import Placement, placed
from splinesdf.io.writers import WRITERS
from splinesdf.io.writers.milling import Milling
from splinesdf.io.writers.options import Options, check_options, factor
from splinesdf.shapes.shape import Shape
from splinesdf.splines.spline import SplineSDF

# The default tolerance as a share of the contours' size: far below what a machine cuts or a
# screen shows, while a circle still takes only about 2000 chords.
_DEFAULT_TOLERANCE = 1e-6
# Contours whose coordinates are rounded by more than this share of their size, once they are moved
# in the file, are refused. Larger: curves come out as steps; smaller: far origins are refused that
# nobody would see.
_MOVED = 1e-6


class WriteOptions(TypedDict, total=False):
    """The options of `write`, which says what they mean."""

    tolerance: float | None
    arcs: bool
    units: str | None
    milling: Milling | None
    scale: float
    origin: str | tuple[float, float] | None
    flip: bool | None


DEFAULTS: WriteOptions = {
    "tolerance": None,
    "arcs": False,
    "units": None,
    "milling": None,
    "scale": 1.0,
    "origin": None,
    "flip": None,
}
write_options = with_options(WriteOptions, DEFAULTS)


@write_options
def write(
    path: str | os.PathLike[str],
    contours: Iterable[Contour] | Contour | Shape | SplineSDF | Carve,
    **options: Unpack[WriteOptions],
) -> None:
    """Write contours, or the field of a spline, to a file, whole or not at all.

    Parameters
    ----------
    path : str or path
        ======================== ===========================================================
        ``.dxf``                 exact: CIRCLE, LWPOLYLINE with bulges, LINE, ARC for contours of
                                 lines and circular arcs, one rational SPLINE for any other
        ``.svg``                 exact but for hyperbolas: L, A, Q; C for those
        ``.nc .ngc .gcode``      G1, G2, G3: lines and circular arcs
        ``.geojson .wkt``        polygons with holes, or lines where a contour is open
        ``.csv``                 points
        ``.vtu``                 a spline: exact, on quadratic triangles (`SplineSDF.triangles`)
        ``.glsl .wgsl``          a spline: functions for shaders, in float32 (`SplineSDF.to_glsl`,
                                 `SplineSDF.to_wgsl`), and in the comment at the end their table
        ======================== ===========================================================
    contours : iterable of Contour, one Contour, Shape, SplineSDF, or Carve
        Of a shape its boundary is written (its offset by 0, to half the tolerance); a spline takes
        none of the options; the paths of a carve go into G-code and CSV, in space.

    Other Parameters
    ----------------
    tolerance : float, optional
        How far the file may be from the contours, where it is not exact, in their unit: the file's
        own is scaled as its numbers are. Default: 1e-6 of the larger side of the contours' box, or
        the rounding of the coordinates if that is more.
    arcs : bool
        DXF and SVG: only lines and circular arcs, as G-code always has (see `as_arcs`).
    units : {"mm", "inch"}, optional
        DXF and G-code: what the numbers are. They are converted if the contours say how long
        their unit is (``Contour.unit``); otherwise they are written as they are. Default: mm in
        G-code; in DXF the contours' own unit, if DXF has a number for it, or else mm; none if it
        is not known. Distances that name layers stay in the contours' unit.
    milling : Milling, optional
        G-code: feed, heights, start and direction.
    scale : float
        The file's numbers are so many times as large.
    origin : {"lower-left", "center"} or (float, float), optional
        What becomes (0, 0): the corner with the least x and y, as the file has them, of the box of
        all that is written; its center; or a point of the contours' coordinates.
    flip : bool, optional
        Mirror y, or do not. Default: as the file's axis asks. In DXF and G-code y points up, in SVG
        down; contours are mirrored if their source has it the other way. The other formats have no
        axes: there nothing is mirrored unless asked for.

    Notes
    -----
    From the contours' coordinates to the file's numbers, in this order:

    1. Where y is mirrored, it becomes ``top + bottom - y`` of the page (``Contour.page``), so that
       the page's lower edge comes to where its upper edge was; ``-y`` if the source has no page.
    2. ``origin`` is moved to (0, 0), a point being mirrored as the contours are.
    3. All is converted to ``units``.
    4. All is multiplied by ``scale``.

    Raises
    ------
    InputError
        If the extension is unknown, there is nothing to write, the format cannot use an option,
        the tolerance is not positive or below rounding, also where ``origin`` moves it, or the file
        cannot be written.
    MissingExtraError
        For ``.dxf`` without ezdxf.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> ss.write("grown.svg", ss.offset(square, 1))
    >>> ss.write("grown.nc", ss.offset(square, 1), milling=ss.Milling(feed=300, depth=2))
    >>> round(sum(c.area for c in ss.offset(ss.read("grown.svg"), 0)), 6)  # 32 + pi
    35.141593
    """
    check_known("write", options, WriteOptions)
    if isinstance(contours, SplineSDF):
        defaults: dict[str, Any] = {**DEFAULTS}
        given = [name for name, value in options.items() if value is not defaults[name]]
        return write_field(path, contours, given)
    if isinstance(contours, Shape):
        # Half of what the file may be off is for the conics that stand for the pieces.
        asked = options.get("tolerance")
        whole = (
            _DEFAULT_TOLERANCE * contours.size if asked is None else positive(asked, "tolerance")
        )
        options["tolerance"] = 0.5 * whole
        contours = contours.offset(0.0, tolerance=0.5 * whole)
    write_text(path, file_text(path, contours, **options))


def file_text(
    path: str | os.PathLike[str],
    contours: Iterable[Contour] | Contour | Carve,
    **options: Unpack[WriteOptions],
) -> str:
    """What `write` writes."""
    check_known("write", options, WriteOptions)
    asked: dict[str, Any] = {**DEFAULTS, **options}
    tolerance = asked.pop("tolerance")
    suffix, placement = check_format(path, **asked)
    if isinstance(contours, Carve):
        return carved_text(path, suffix, placement, contours, {**asked, "tolerance": tolerance})
    chains = _as_contours(contours)
    xmin, ymin, xmax, ymax = box(chains)
    size = max(xmax - xmin, ymax - ymin)
    if size == 0.0:
        raise InputError("expected contours with an extent, got a single point")
    unit, units = _unit_of(chains), asked["units"]
    by = factor(suffix, unit, units)
    if by != 1.0:
        units = units or "mm"
    there, mirrors = placed(chains, suffix, placement, by)
    by *= placement.scale
    tolerance = _tolerance(chains, there, by, size, tolerance)
    told = Options(by * tolerance, bool(asked["arcs"]), units, asked["milling"], unit, by, mirrors)
    return WRITERS[suffix](there, told)


def _tolerance(
    chains: list[Contour], there: list[Contour], by: float, size: float, given: float | None
) -> float:
    """The tolerance in the contours' unit, which rounding where they are placed must allow."""
    before, after = (np.concatenate([c.arcs for c in some]) for some in (chains, there))
    least = smallest_tolerance(after) / by
    # Of a small contour far from the origin, the default is below what its coordinates hold.
    default = max(_DEFAULT_TOLERANCE * size, smallest_tolerance(before))
    if given is not None:
        check_tolerance(given, before)
    if least > (max(default, _MOVED * size) if given is None else given):
        raise InputError(
            f"expected contours nearer to the file's (0, 0): their coordinates there are rounded "
            f"by {least:.2g}, choose another origin" + ("" if given is None else " or tolerance")
        )
    return max(default, least) if given is None else float(given)


def _unit_of(chains: list[Contour]) -> float | None:
    """The unit that all contours have, None if it is not known."""
    units = {chain.unit for chain in chains}
    if len(units) > 1:
        raise InputError("expected contours of one unit, got several: write one file for each")
    return units.pop()


def check_format(
    path: str | os.PathLike[str],
    *,
    arcs: bool = False,
    units: str | None = None,
    milling: Milling | None = None,
    scale: float = 1.0,
    origin: str | tuple[float, float] | None = None,
    flip: bool | None = None,
) -> tuple[str, Placement]:
    """The extension, in lower case, and where the file's numbers lie.

    Raises
    ------
    InputError
        If no such file can be written.
    """
    suffix = as_path(path).suffix.lower()
    if suffix in FIELDS:
        raise InputError(
            f"expected a spline for {suffix}, got none: give the spline of a fit, or for contours "
            f"a file name ending in {', '.join(sorted(WRITERS))}"
        )
    if suffix not in WRITERS:
        kept = "; a fit is saved by its spline.save" if suffix == ".npz" else ""
        raise InputError(
            f"expected a file name ending in {', '.join(sorted(WRITERS))}, got "
            f"{os.fspath(path)!r}{kept}"
        )
    check_options(suffix, arcs=arcs, units=units, milling=milling)
    return suffix, Placement(scale, origin, flip)


def _as_contours(contours: Iterable[Contour] | Contour) -> list[Contour]:
    if isinstance(contours, Contour):
        return [contours]
    if not isinstance(contours, Iterable):
        raise InputError(f"expected a list of contours or a spline, got {type(contours).__name__}")
    chains = list(contours)
    for chain in chains:
        if not isinstance(chain, Contour):
            raise InputError(f"expected a list of contours, got {type(chain).__name__} in it")
    if not chains:
        raise InputError("expected at least one contour to write, got none")
    return chains
