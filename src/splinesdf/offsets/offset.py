"""`offset`: trimmed offsets of a shape as few conic arcs, to a tolerance.

for each distance: parallels of all arcs ─→ segments to which nothing is nearer ─→ closed loops
    ─→ lines and circles as they are, smooth curves by as few conics as the tolerance allows
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.contours.contour import Contour, evaluate
from splinesdf.contours.nesting import nested
from splinesdf.distance.exact import signed_distance
from splinesdf.errors import InputError
from splinesdf.fits.fit import fit_around
from splinesdf.ground.arrays import as_floats, finite, positive, shown
from splinesdf.ground.brief import counted
from splinesdf.ground.progress import Report, checked_report, tell
from splinesdf.offsets.at_distance import Attempt, contours_at
from splinesdf.offsets.far import has_no_fit, hull_offset, is_far
from splinesdf.shapes.shape import Shape, check_shape

# Points an arc at which `deviation` measures: an arc's error has one or two bumps.
_MEASURED = np.linspace(0.0, 1.0, 9)
# The least tolerance, as a share of the largest number around: a few hundred roundings.
_LEAST_TOLERANCE = 1e-13
# The default tolerance, as shares of the size and of the smallest distance, and the largest share
# of that distance. Larger: contours may be nowhere near the distance; smaller: more arcs.
_OF_SIZE, _OF_DISTANCE, _COARSE = 1e-3, 1e-2, 0.25
# Steps inward, and cells of a fit: work ends with an error beyond.
_MOST_STEPS, _MOST_CELLS = 10_000, 200_000
# Where walls are just twice the distance apart, parallels run on top of each other, and rounding
# decides. A little farther from the boundary it does not: the attempt at the distance itself comes
# first, then, only if that fails, one shifted by this share of the largest number around, and at
# last by these shares of the tolerance. Smaller: rounding decides there, too; larger: exact lines
# and circles are off by as much, and the arcs get less of the tolerance.
# All loops are shifted, not only the loop that failed: at another distance loops join, part and
# vanish (those of a cam: 10 without a shift, 9 with one), so that a loop of one attempt has no
# certain partner in another; and the first shift is below any tolerance.
_FARTHER = 1e-12
_SHARES = (0.125, 0.25)


def offset(
    shape: Shape,
    distances: ArrayLike | None = None,
    *,
    tolerance: float | None = None,
    step: float | None = None,
    coarse: bool = False,
    progress: Report | None = None,
) -> list[Contour]:
    """The curves at given distances from the boundary, already trimmed.

    Parameters
    ----------
    shape : Shape
    distances : float or array_like, shape (n,)
        Positive outward, negative inward, in the shape's unit; 0 is the boundary itself.
    tolerance : float, optional
        How far the exact distance of a point of the result may be from the distance asked. By
        default 1e-3 of the shape's larger side, but at most 1e-2 of the smallest distance or of
        the step; each contour says in ``.tolerance`` what it was.
    step : float, negative
        Instead of distances: step, 2 step, 3 step, ... until nothing is left, as for pocketing.
    coarse : bool
        Allow a tolerance above a quarter of the smallest distance, which may leave little of it.
    progress : callable, optional
        Called after each distance with a `Progress`: ``print``, for example. What it raises ends
        the work.

    Returns
    -------
    list of Contour
        In the order of the distances, each with its ``.distance`` and ``.parent``, closed, the
        side nearer to the inside on its left. None for a distance at which nothing is left.

        Every point of it is as far from the boundary as asked, within the tolerance, and every
        part of the exact offset wider than the tolerance is there. Where the boundary is straight
        or a part of a circle, or has a corner, the offset is a line or a part of a circle, exact
        to rounding; every other stretch is as few conic arcs as the tolerance allows. Tangents
        are continuous but where those of the exact offset are not: at its corners, which are
        exact, too.

    Raises
    ------
    ToleranceNotReached
        If the tolerance needs more than 200,000 cells, where a fit has to help out.
    InputError
        If a number cannot be used: a tolerance above a quarter of the smallest distance, or one
        below rounding; steps so small that there are more than 10,000.

    References
    ----------
    [Wang2014] section 5: an offset's swallowed parts are no part of a level set.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> [contour.distance for contour in ss.offset(square, [-1, 1])]
    [-1.0, 1.0]
    >>> [contour.area for contour in ss.offset(square, -1)]  # corners stay sharp
    [4.0]
    >>> [contour.distance for contour in ss.offset(square, step=-0.75)]
    [-0.75, -1.5]
    """
    check_shape(shape)
    checked_report(progress)
    if step is not None:
        if distances is not None:
            raise InputError("expected distances or a step, got both")
        return _until_nothing_is_left(shape, step, tolerance, coarse, progress)
    if distances is None:
        raise InputError("expected distances or a step, got neither")
    wanted = np.atleast_1d(as_floats(distances, "distances"))
    if wanted.ndim != 1 or not len(wanted) or not np.isfinite(wanted).all():
        raise InputError(f"expected one or more finite distances, got {shown(distances)}")
    asked = offset_tolerance(shape, wanted.tolist(), tolerance, coarse=coarse)
    _check_rounding(shape, float(np.abs(wanted).max()), asked)
    result: list[Contour] = []
    for done, distance in enumerate(wanted.tolist(), start=1):
        found = _at(shape, distance, asked)
        result += found
        tell(progress, _told(distance, found), done, len(wanted))
    return result


def offset_tolerance(
    shape: Shape, distances: Iterable[float], tolerance: float | None, *, coarse: bool = False
) -> float:
    """The tolerance of offsets at some distances, or the default if none is given, see `offset`.

    Raises
    ------
    InputError
        If it is not positive, or above a quarter of the smallest distance, unless ``coarse``.
    """
    smallest = min((abs(d) for d in distances if d), default=math.inf)
    if tolerance is None:
        return min(_OF_SIZE * shape.size, _OF_DISTANCE * smallest)
    tolerance = positive(tolerance, "tolerance")
    if tolerance > _COARSE * smallest and not coarse:
        raise InputError(
            f"expected a tolerance of at most a quarter of the smallest distance, "
            f"{_COARSE * smallest:.4g}, got {tolerance:.4g}: lower it, or ask for coarse offsets"
        )
    return tolerance


def least_tolerance(shape: Shape, farthest: float) -> float:
    """The least tolerance of offsets up to a distance that rounding leaves room for."""
    return _LEAST_TOLERANCE * max(*map(abs, shape.box), farthest)


def _check_rounding(shape: Shape, farthest: float, tolerance: float) -> None:
    """Refuse tolerances below the rounding of the coordinates."""
    least = least_tolerance(shape, farthest)
    if tolerance < least:
        raise InputError(
            f"expected a tolerance of at least {least:.2g}, above the rounding of the coordinates, "
            f"got {tolerance:.2g}: raise it, or move the shape nearer to the origin"
        )


def _until_nothing_is_left(
    shape: Shape, step: float, tolerance: float | None, coarse: bool, progress: Report | None
) -> list[Contour]:
    """Offset inward at step, 2 step, ... as far as contours are left."""
    try:
        size = finite(step, "step")
    except InputError:
        size = 0.0
    if size >= 0.0:
        raise InputError(
            f"expected a negative step, inward, until nothing is left, got {shown(step)}: "
            "outward there is no end, so give the distances"
        )
    asked = offset_tolerance(shape, [size], tolerance, coarse=coarse)
    _check_rounding(shape, 0.0, asked)
    steps = _half_width(shape) / -size
    if steps > _MOST_STEPS:
        raise InputError(
            f"expected a step that is taken {_MOST_STEPS:,} times at most, got {step:g}, which may "
            f"be taken {steps:,.0f} times: give a longer one"
        )
    result: list[Contour] = []
    number = 1
    while found := _at(shape, number * size, asked):
        result += found
        tell(progress, _told(number * size, found), number)
        number += 1
    return result


def _told(distance: float, found: list[Contour]) -> str:
    return f"offset by {distance:g}, {counted(len(found), 'contour')}"


def _half_width(shape: Shape) -> float:
    """Bound the distance of points inside from the boundary."""
    xmin, ymin, xmax, ymax = shape.box
    return 0.5 * min(xmax - xmin, ymax - ymin)


def _at(shape: Shape, distance: float, tolerance: float) -> list[Contour]:
    """Offset at one distance, with a shift, a fit or the hull where parallels do not suffice."""
    if distance < -_half_width(shape) - tolerance:
        return []
    if is_far(shape, distance):
        return [replace(hull_offset(shape, distance, tolerance), tolerance=tolerance)]
    best: Attempt | None = None
    for farther in _shifts(shape, distance, tolerance):
        shift = math.copysign(farther, distance)
        found = contours_at(shape, distance, tolerance - farther, shift=shift)
        best = found if best is None or (found and found.clear) else best
        if best is not None and best.clear:
            break
    if best is not None:
        return nested([replace(contour, tolerance=tolerance) for contour in best.contours])
    if has_no_fit(shape, distance):
        return [replace(hull_offset(shape, distance, tolerance), tolerance=tolerance)]
    # A boundary that crosses itself within rounding has parallels with loose ends. Level sets of
    # splines have none, whatever the spline is a fit of.
    spline = fit_around(shape, distance, tolerance, max_cells=_MOST_CELLS)
    return nested(
        [
            replace(contour, tolerance=tolerance, fitted=True, parent=None)
            for contour in spline.contours(distance)
        ]
    )


def _shifts(shape: Shape, distance: float, tolerance: float) -> list[float]:
    """List by how much farther from the boundary to look, one attempt after the other."""
    if not distance:
        return [0.0]
    shares = [share * tolerance for share in _SHARES]
    least = _FARTHER * max(*map(abs, shape.box), abs(distance))
    return [0.0, *([least] if least < shares[0] else []), *shares]


def deviation(shape: Shape, contours: Iterable[Contour]) -> float:
    """Measure the largest deviation of contours from the distance that they stand for.

    The exact distance to the shape is taken at nine points of each arc, its ends included.
    """
    worst = 0.0
    for contour in contours:
        exact = signed_distance(shape, evaluate(contour.arcs, contour.weights, _MEASURED))
        worst = max(worst, float(np.abs(exact - contour.distance).max()))
    return worst
