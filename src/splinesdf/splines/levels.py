"""The level sets of a spline as contours: exact ones of quadratics, proved ones of the others."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from splinesdf.contours.contour import Contour
from splinesdf.contours.nesting import nested
from splinesdf.ground.arrays import positive
from splinesdf.splines import level_sets

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF


def contours(
    spline: SplineSDF, level: float = 0.0, *, tolerance: float | None = None
) -> list[Contour]:
    """The level set ``s = level`` as chains of conic arcs, lower values on their left.

    Closed and with a continuous tangent, but for those that leave the domain (``closed`` is
    False) and where the gradient vanishes. Left and right as x turns into y. Each has the
    contour that directly encloses it as its ``parent``.

    Of a quadratic spline they are exact. On those of a cubic or quartic one |s - level| is at
    most ``tolerance``, which is proved: a tenth of the fit's ``bound`` unless given.

    Raises
    ------
    InputError
        If a cubic or quartic spline has no bound and no tolerance is given, or if it is below
        rounding, or a million cells do not do for it.
    """
    mesh, ordinates = spline.mesh, spline.ordinates
    tolerance = None if tolerance is None else positive(tolerance, "tolerance")
    if spline.element.degree != 2:
        allowed = level_sets.allowed_beside(spline.element, spline._bound, tolerance)
        mesh, ordinates = level_sets.followed(mesh, spline.element, ordinates, level, allowed)
    found = level_sets.contours(mesh, ordinates, level, y_down=spline.y_down)
    if spline.shape is not None:
        unit, page = spline.shape.unit, spline.shape.page
        found = [replace(contour, unit=unit, page=page) for contour in found]
    return nested(found)
