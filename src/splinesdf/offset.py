"""`offset`: trimmed offsets of a shape as conic arcs, to a tolerance.

for each distance: fit only where the distance is near it ─→ the level set of the fit
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from splinesdf._arrays import positive
from splinesdf.contour import Contour, evaluate
from splinesdf.curves.shape import Shape
from splinesdf.distance import signed_distance
from splinesdf.errors import InputError
from splinesdf.fit import fit

# Points an arc at which `deviation` measures: an arc's error has one or two bumps.
_MEASURED = np.linspace(0.0, 1.0, 9)


def offset(shape: Shape, distances: ArrayLike, *, tolerance: float) -> list[Contour]:
    """The curves at given distances from the boundary, already trimmed.

    Parameters
    ----------
    shape : Shape
    distances : float or array_like, shape (n,)
        Positive outward, negative inward, in the shape's unit; 0 is the boundary itself.
    tolerance : float
        How far the exact distance of a point of the result may be from the distance asked.

    Returns
    -------
    list of Contour
        In the order of the distances, each with its ``.distance``, closed, the side nearer to
        the inside on its left. None for a distance at which nothing is left of the shape. Tangents
        are continuous: a corner of the exact offset is rounded within the tolerance.

    Raises
    ------
    ToleranceNotReached
        If the tolerance needs more than a million cells.
    InputError

    References
    ----------
    [Wang2014] section 5: an offset's swallowed parts are not in a level set.
    """
    try:
        wanted = np.atleast_1d(np.asarray(distances, dtype=np.float64))
    except (TypeError, ValueError) as error:
        raise InputError(f"expected distances as numbers, got {distances!r}") from error
    if wanted.ndim != 1 or not len(wanted) or not np.isfinite(wanted).all():
        raise InputError(f"expected one or more finite distances, got {distances!r}")
    asked = positive(tolerance, "tolerance")
    result = []
    for distance in wanted.tolist():
        fitted = fit(shape, tolerance=asked, band=(distance, distance))
        result += fitted.spline.contours(distance)
    return result


def deviation(shape: Shape, contours: Iterable[Contour]) -> float:
    """How far contours are from the distance they stand for, at most, measured exactly.

    Nine points on each arc, its ends included, are asked for their exact distance to the shape.
    """
    worst = 0.0
    for contour in contours:
        exact = signed_distance(shape, evaluate(contour.arcs, contour.weights, _MEASURED))
        worst = max(worst, float(np.abs(exact - contour.distance).max()))
    return worst
