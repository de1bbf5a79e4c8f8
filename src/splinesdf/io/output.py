"""`write`: contours, or a field, to a file, in the format that the file's extension names."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from splinesdf.contours.contour import Contour, box, check_tolerance, smallest_tolerance
from splinesdf.errors import InputError
from splinesdf.ground.atomic import write_text
from splinesdf.ground.paths import as_path
from splinesdf.io.fields import FIELDS, write_field
from splinesdf.io.writers import WRITERS
from splinesdf.io.writers.options import Milling, Options, check_options, factor
from splinesdf.splines.spline import SplineSDF

# The default tolerance as a share of the contours' size: far below what a machine cuts or a
# screen shows, while a circle still takes only about 2000 chords.
_DEFAULT_TOLERANCE = 1e-6


def write(
    path: str | os.PathLike[str],
    contours: Iterable[Contour] | SplineSDF,
    *,
    tolerance: float | None = None,
    arcs: bool = False,
    units: str | None = None,
    milling: Milling | None = None,
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
        ======================== ===========================================================

        DXF and G-code have y pointing up, SVG pointing down: contours are mirrored where the
        source has it the other way. The others hold the coordinates as they are.
    contours : iterable of Contour, or SplineSDF
        A spline takes none of the options.
    tolerance : float, optional
        How far the file may be from the contours, where it is not exact. Default: 1e-6 of the
        larger side of the contours' box, or the rounding of the coordinates if that is more.
    arcs : bool
        DXF and SVG: only lines and circular arcs, as G-code always has (see `as_arcs`).
    units : {"mm", "inch"}, optional
        DXF and G-code: what the numbers are. They are converted if the contours say how long
        their unit is (`Contour.unit`); otherwise they are written as they are. Default: mm in
        G-code; in DXF the contours' own unit, if DXF has a number for it, or else mm; none if it
        is not known. Distances that name layers stay in the contours' unit.
    milling : Milling, optional
        G-code: feed, heights, start and direction.

    Raises
    ------
    InputError
        If the extension is unknown, there is nothing to write, the format cannot use an option,
        the tolerance is not positive or below rounding, or the file cannot be written.
    MissingExtraError
        For ``.dxf`` without ezdxf.
    """
    if isinstance(contours, SplineSDF):
        given = {"tolerance": tolerance, "arcs": arcs, "units": units, "milling": milling}
        return write_field(path, contours, given)
    suffix = check_format(path, arcs=arcs, units=units, milling=milling)
    chains = _as_contours(contours)
    xmin, ymin, xmax, ymax = box(chains)
    size = max(xmax - xmin, ymax - ymin)
    if size == 0.0:
        raise InputError("expected contours with an extent, got a single point")
    every = np.concatenate([chain.arcs for chain in chains])
    if tolerance is None:
        # Of a small contour far from the origin, that is below what its coordinates hold.
        tolerance = max(_DEFAULT_TOLERANCE * size, smallest_tolerance(every))
    check_tolerance(tolerance, every)
    unit = _unit_of(chains)
    by = factor(suffix, unit, units)
    if by != 1.0:
        chains = [replace(chain, arcs=by * chain.arcs, unit=unit) for chain in chains]
        units = units or "mm"
    options = Options(float(by * tolerance), bool(arcs), units, milling, unit)
    write_text(path, WRITERS[suffix](chains, options))


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
) -> str:
    """The extension, in lower case, or an `InputError` if no such file can be written."""
    suffix = as_path(path).suffix.lower()
    if suffix in FIELDS:
        raise InputError(
            f"expected a spline for {suffix}, got none: give the spline of a fit, or for contours "
            f"a file name ending in {', '.join(sorted(WRITERS))}"
        )
    if suffix not in WRITERS:
        raise InputError(
            f"expected a file name ending in {', '.join(sorted(WRITERS))}, got {os.fspath(path)!r}"
        )
    check_options(suffix, arcs=arcs, units=units, milling=milling)
    return suffix


def _as_contours(contours: Iterable[Contour]) -> list[Contour]:
    if isinstance(contours, Contour):
        raise InputError("expected a list of contours, got one Contour: put it in brackets")
    if not isinstance(contours, Iterable):
        raise InputError(f"expected a list of contours or a spline, got {type(contours).__name__}")
    chains = list(contours)
    for chain in chains:
        if not isinstance(chain, Contour):
            raise InputError(f"expected a list of contours, got {type(chain).__name__} in it")
    if not chains:
        raise InputError("expected at least one contour to write, got none")
    return chains
