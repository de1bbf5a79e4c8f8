"""Shapes moved and combined: what stays what it was, and what the pieces become.

Each function here is a method of `splinesdf.Shape`, whose file would be too long with them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, as_floats, finite, shown
from splinesdf.ground.limits import using
from splinesdf.shapes import region as regions
from splinesdf.shapes.region import Loops, region

if TYPE_CHECKING:
    from splinesdf.shapes.shape import Shape

# Cosine and sine of whole quarter turns, which the functions miss by rounding.
_QUARTERS = {
    0.0: (1.0, 0.0),
    90.0: (0.0, 1.0),
    -90.0: (0.0, -1.0),
    180.0: (-1.0, 0.0),
    -180.0: (-1.0, 0.0),
}
Combine = Callable[[Loops, Loops], Loops]


def translate(shape: Shape, dx: float, dy: float) -> Shape:
    """The shape moved by (dx, dy); page and unit stay.

    Examples
    --------
    >>> import splinesdf as ss
    >>> ss.Shape.rectangle(0, 0, 2, 1).translate(1, 3).box
    (1.0, 3.0, 3.0, 4.0)
    """
    return _mapped(shape, shape.control + np.array([finite(dx, "dx"), finite(dy, "dy")]))


def scale(shape: Shape, factor: ArrayLike, *, about: ArrayLike = (0.0, 0.0)) -> Shape:
    """The shape so many times as large, as seen from a point; page and unit stay.

    Parameters
    ----------
    factor : float or pair of float
        Of x and y apart, if there are two; negative ones mirror.
    about : array_like, shape (2,)
        The point that stays where it is.

    Examples
    --------
    >>> import splinesdf as ss
    >>> ss.Shape.rectangle(0, 0, 2, 1).scale(2, about=(2, 1)).box
    (-2.0, -1.0, 2.0, 1.0)
    """
    by = as_floats(factor, "factor")
    if by.shape not in ((), (2,)) or not np.isfinite(by).all() or not by.all():
        raise InputError(f"expected one or two finite factors, not 0, got {shown(factor)}")
    middle = _point(about)
    return _mapped(shape, middle + (shape.control - middle) * by)


def rotate(shape: Shape, degrees: float, *, about: ArrayLike = (0.0, 0.0)) -> Shape:
    """The shape turned, from x to y, about a point; page and unit stay.

    Parameters
    ----------
    degrees : float
        Quarter turns are exact.
    about : array_like, shape (2,)

    Examples
    --------
    >>> import splinesdf as ss
    >>> ss.Shape.rectangle(0, 0, 2, 1).rotate(90).box
    (-1.0, 0.0, 0.0, 2.0)
    """
    turn = math.remainder(finite(degrees, "degrees"), 360.0)
    angle = math.radians(turn)
    cos, sin = _QUARTERS.get(turn, (math.cos(angle), math.sin(angle)))
    middle = _point(about)
    return _mapped(shape, middle + (shape.control - middle) @ np.array([[cos, sin], [-sin, cos]]))


def union(shape: Shape, other: Shape) -> Shape:
    """What is in this shape or in another: ``a | b``.

    Examples
    --------
    >>> import splinesdf as ss
    >>> one, other = ss.Shape.rectangle(0, 0, 2, 1), ss.Shape.rectangle(1, 0, 3, 1)
    >>> one.union(other).area, (one | other).area
    (3.0, 3.0)
    """
    return _combined(shape, other, lambda a, b: regions.union([a, b]), "in either of two shapes")


def intersection(shape: Shape, other: Shape) -> Shape:
    """What is in this shape and in another: ``a & b``.

    Examples
    --------
    >>> import splinesdf as ss
    >>> one, other = ss.Shape.rectangle(0, 0, 2, 1), ss.Shape.rectangle(1, 0, 3, 1)
    >>> one.intersection(other).box
    (1.0, 0.0, 2.0, 1.0)
    """
    return _combined(shape, other, regions.intersection, "common to two shapes")


def difference(shape: Shape, other: Shape) -> Shape:
    """What is in this shape and not in another: ``a - b``.

    Examples
    --------
    >>> import splinesdf as ss
    >>> one, other = ss.Shape.rectangle(0, 0, 2, 1), ss.Shape.rectangle(1, 0, 3, 1)
    >>> one.difference(other).box
    (0.0, 0.0, 1.0, 1.0)
    """
    return _combined(shape, other, regions.difference, "left of a shape without another")


def loops_of(shape: Shape) -> Loops:
    """The pieces of each loop."""
    pieces = np.split(shape.control, shape.starts[1:-1])
    return [pieces[first:end] for first, end in pairwise(shape.loops.tolist())]


def _combined(shape: Shape, other: Shape, combine: Combine, what: str) -> Shape:
    if not isinstance(other, type(shape)):
        raise InputError(f"expected another Shape, got {type(other).__name__}")
    if shape.y_down != other.y_down:
        raise InputError("expected shapes with y the same way, got one with y up, one with y down")
    if None not in (shape.unit, other.unit) and shape.unit != other.unit:
        raise InputError(
            f"expected shapes of one unit, got {shape.unit:g} mm and {other.unit:g} mm: scale one"
        )
    with using(shape.limits):
        found = combine(*(region(loops_of(one), one.fill) for one in (shape, other)))
    if not found:
        raise InputError(f"expected something {what}, got nothing")
    unit = other.unit if shape.unit is None else shape.unit
    made = shape.from_pieces(
        found, name=shape.name, y_down=shape.y_down, once=False, unit=unit, page=shape.page
    )
    return replace(made, notes=(*shape.notes, *other.notes, *made.notes), limits=shape.limits)


def _mapped(shape: Shape, control: Floats) -> Shape:
    """The shape with other control points, checked as new ones are."""
    made = shape.from_pieces(
        loops_of(replace(shape, control=control)),
        fill=shape.fill,
        y_down=shape.y_down,
        name=shape.name,
        notes=shape.notes,
        once=False,
        unit=shape.unit,
        page=shape.page,
    )
    return replace(made, limits=shape.limits)


def _point(about: ArrayLike) -> Floats:
    point = as_floats(about, "about")
    if point.shape != (2,) or not np.isfinite(point).all():
        raise InputError(f"expected a finite point (x, y) for about, got {shown(about)}")
    return point
