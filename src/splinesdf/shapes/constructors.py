"""What shapes are made from: formulas, curves, points, contours, geometries, paths; simple forms.

Each function here is a class method of `splinesdf.Shape`, whose file would be too long with them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError
from splinesdf.ground.arrays import as_points, finite, positive, shown
from splinesdf.shapes.region import difference, region, union, united_regions
from splinesdf.shapes.sources.compiled import compile_arc, compile_curve, point_loops
from splinesdf.shapes.sources.compiled import polygon as polygon_of
from splinesdf.shapes.sources.conics import contour_loops
from splinesdf.shapes.sources.formula import parse_curve
from splinesdf.shapes.sources.geojson import polygons_of
from splinesdf.shapes.sources.nurbs import nurbs_pieces
from splinesdf.shapes.sources.sections import compile_sections
from splinesdf.shapes.sources.svg_path import parse_path

if TYPE_CHECKING:
    from splinesdf.shapes.shape import Shape


def from_formula(
    cls: type[Shape],
    x: str,
    y: str,
    *,
    t: tuple[float | str, float | str] = (0.0, "2*pi"),
    fill: str | None = None,
    name: str = "",
) -> Shape:
    """One closed curve given by two formulas in ``t``.

    The curve is compiled once into polynomial pieces of degree 7 that agree with it to
    about four units in the last place. Corners are found by bisection.

    Parameters
    ----------
    x, y : str
        Arithmetic in ``t`` with ``+ - * / ^``, ``pi``, ``e`` and the usual functions.
    t : pair of float or str
        The parameter's range; formulas without ``t`` are allowed.

    Examples
    --------
    >>> import splinesdf as ss
    >>> ss.Shape.from_formula("2*cos(t)", "2*sin(t)", name="disk").loop_count
    1
    """
    return cls.from_pieces([compile_curve(parse_curve(x, y, t))], fill=fill, name=name)


def from_formulas(
    cls: type[Shape],
    sections: Iterable[tuple[str, str, tuple[float | str, float | str]]],
    *,
    fill: str | None = None,
    close: bool = False,
    name: str = "",
) -> Shape:
    """One closed curve given by several formulas, each for one part of it.

    Parameters
    ----------
    sections : iterable of (x, y, (start, stop))
        As in `from_formula`. Each section starts where the one before it ended, the first
        where the last one ended; the parameters of different sections have nothing in common.
        Make an end of a section wherever the formulas have a corner or bend suddenly.
    close : bool
        Close the curve by a straight piece instead of refusing it.

    Raises
    ------
    OpenContourError
        If the sections do not follow one another, or the curve does not end where it starts.
    InputError
        If a formula cannot be used; the message names the section.

    Examples
    --------
    >>> import splinesdf as ss
    >>> half = ss.Shape.from_formulas([("cos(t)", "sin(t)", (0, "pi")), ("t", "0", (-1, 1))])
    >>> round(half.area, 9)  # pi / 2
    1.570796327
    """
    return cls.from_pieces([compile_sections(sections)], fill=fill, close=close, name=name)


def from_nurbs(
    cls: type[Shape],
    control: ArrayLike,
    *,
    degree: SupportsIndex = 3,
    knots: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    periodic: bool = False,
    fill: str | None = None,
    close: bool = False,
    name: str = "",
) -> Shape:
    """One closed B-spline curve, or NURBS curve if there are weights.

    Up to degree 7 without weights the curve is exact, otherwise it is compiled into pieces of
    degree 7 that agree with it to a few units in the last place.

    Parameters
    ----------
    control : array_like, shape (n, 2)
    degree : int
        From 1 to 25.
    knots : array_like, shape (n + degree + 1,), optional
        Equal steps between repeated ends if not given; see ``nurbs_pieces`` for other
        conventions, and for those of periodic curves.
    weights : array_like, shape (n,), optional
        Positive; the control points are not multiplied by them.
    periodic : bool
        Wrap the control points around to a smooth closed curve.
    close : bool
        Close an open curve by a straight piece instead of refusing it.

    Raises
    ------
    OpenContourError
        If the curve does not end where it starts.
    InputError
        If the numbers do not make a curve.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = [[1, 0], [0, 1], [-1, 0], [0, -1]]
    >>> ss.Shape.from_nurbs(square, degree=3, periodic=True)
    <Shape: 1 loop, 4 pieces, nonzero>
    """
    pieces = nurbs_pieces(control, degree=degree, knots=knots, weights=weights, periodic=periodic)
    return cls.from_pieces([pieces], fill=fill, close=close, name=name)


def from_points(
    cls: type[Shape],
    points: ArrayLike | Sequence[ArrayLike],
    *,
    smooth: bool = False,
    fill: str | None = None,
    name: str = "",
) -> Shape:
    """Closed polygons, or with ``smooth=True`` the periodic C² cubics through their corners.

    Parameters
    ----------
    points : array_like, shape (n, 2), or several of these
        In order; the last is joined to the first. Repeated neighbours are dropped.

    Examples
    --------
    >>> import splinesdf as ss
    >>> ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    <Shape: 1 loop, 4 pieces, nonzero>
    """
    return cls.from_pieces(point_loops(points, smooth=smooth), fill=fill, name=name)


def from_contours(
    cls: type[Shape], contours: Iterable[Contour] | Contour, *, name: str = ""
) -> Shape:
    """The region that closed contours of one level enclose, as those of an offset do.

    So an offset can be offset again. Lines and parabolas are exact, other conics to a few
    units in the last place.

    Examples
    --------
    >>> import splinesdf as ss
    >>> ring = ss.offset(ss.Shape.from_svg_path("M 0 0 H 4 V 4 H 0 Z"), 1)
    >>> round(ss.Shape.from_contours(ring).box[0], 9)
    -1.0
    """
    if isinstance(contours, Contour):
        contours = [contours]
    if not isinstance(contours, Iterable):
        raise InputError(f"expected a list of contours, got {type(contours).__name__}")
    given = list(contours)
    y_down = any(getattr(contour, "y_down", False) for contour in given)
    loops, unit = contour_loops(given), getattr(given[0], "unit", None)
    page = getattr(given[0], "page", None)
    return cls.from_pieces(loops, name=name, y_down=y_down, once=False, unit=unit, page=page)


def from_shapely(cls: type[Shape], geometry: object, *, name: str = "") -> Shape:
    """The union of all polygons of a geometry of Shapely, or of its like.

    It is a GeoJSON object or has a ``__geo_interface__``; points and lines are left out.

    Examples
    --------
    >>> import shapely, splinesdf as ss
    >>> ss.Shape.from_shapely(shapely.box(0, 0, 4, 3).difference(shapely.box(1, 1, 2, 2)))
    <Shape: 2 loops, 8 pieces, evenodd>
    """
    found = polygons_of(geometry)
    regions, notes = found.filled(None)
    loops, fill = united_regions([(one.loops, one.rule) for one in regions])
    return cls.from_pieces(loops, fill=fill, close=True, name=name, notes=notes, once=False)


def from_svg_path(
    cls: type[Shape], path: str, *, fill: str | None = None, close: bool = False, name: str = ""
) -> Shape:
    """The subpaths of SVG path data (the ``d`` attribute), coordinates as written.

    Parameters
    ----------
    close : bool
        Close open subpaths by a straight piece, as an SVG fill does, instead of refusing them.

    Examples
    --------
    >>> import splinesdf as ss
    >>> ss.Shape.from_svg_path("M 0 0 H 4 V 3 Z").box
    (0.0, 0.0, 4.0, 3.0)
    """
    return cls.from_pieces(parse_path(path), fill=fill, close=close, y_down=True, name=name)


def circle(cls: type[Shape], center: ArrayLike, radius: float, *, name: str = "circle") -> Shape:
    """A disk, good to a few units in the last place: its offsets are circles.

    Parameters
    ----------
    center : array_like, shape (2,)
    radius : float

    Examples
    --------
    >>> import splinesdf as ss
    >>> [round(side, 9) for side in ss.Shape.circle((1.0, 2.0), 0.5).box]
    [0.5, 1.5, 1.5, 2.5]
    """
    middle, r = as_points(center), positive(radius, "radius")
    if middle.shape != (2,) or not np.isfinite(middle).all():
        raise InputError(f"expected a finite center (x, y), got {shown(center)}")
    pieces = compile_arc(middle, (r, 0.0), (0.0, r), 0.0, 2.0 * math.pi)
    return cls.from_pieces([pieces], name=name)


def rectangle(
    cls: type[Shape],
    xmin: float,
    ymin: float,
    xmax: float,
    ymax: float,
    *,
    name: str = "rectangle",
) -> Shape:
    """A rectangle with sides along the axes.

    Examples
    --------
    >>> import splinesdf as ss
    >>> ss.Shape.rectangle(0.0, 0.0, 3.0, 2.0).area
    6.0
    """
    named = zip(("xmin", "ymin", "xmax", "ymax"), (xmin, ymin, xmax, ymax), strict=True)
    left, low, right, high = (finite(side, side_name) for side_name, side in named)
    if not (left < right and low < high):
        raise InputError(
            f"expected xmin < xmax and ymin < ymax, got {left:g}, {low:g}, {right:g}, {high:g}"
        )
    corners = [(left, low), (right, low), (right, high), (left, high)]
    return cls.from_pieces([polygon_of(corners)], name=name)


def polygon(
    cls: type[Shape], shell: ArrayLike, holes: Iterable[ArrayLike] = (), *, name: str = ""
) -> Shape:
    """What is in a closed polygon and in none of its holes, whichever way they run.

    Parameters
    ----------
    shell : array_like, shape (n, 2)
    holes : iterable of array_like, shape (m, 2)

    Examples
    --------
    >>> import splinesdf as ss
    >>> outside, hole = [(0, 0), (4, 0), (4, 4), (0, 4)], [(1, 1), (1, 3), (3, 3), (3, 1)]
    >>> ss.Shape.polygon(outside, [hole]).area
    12.0
    """
    outer = region([polygon_of(shell)], "evenodd")
    inner = [region([polygon_of(hole)], "evenodd") for hole in holes]
    left = difference(outer, union(inner)) if inner else outer
    if not left:
        raise InputError("expected a polygon that encloses something beside its holes, got none")
    return cls.from_pieces(left, name=name, once=False)
