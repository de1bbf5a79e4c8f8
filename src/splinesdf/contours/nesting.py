"""Which contour directly encloses which: crossings of rays with conic arcs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.contours.extremes import evaluate_each
from splinesdf.ground.arrays import Bools, Floats, Ints

# Where on a contour points are taken, as shares of its arcs: nowhere that a drawing would put a
# contact, such as a half or a third.
_PLACES = np.array([0.1307, 0.4729, 0.8213])


def nested(contours: Sequence[Contour]) -> list[Contour]:
    """The contours, each with the one that directly encloses it as its ``parent``.

    Parameters
    ----------
    contours : sequence of Contour
        Of one level, so that no two cross. Open ones enclose nothing, but may be enclosed.

    Returns
    -------
    list of Contour
        In the same order.
    """
    count = len(contours)
    if count < 2:
        return [_inside(contour, None) for contour in contours]
    low = np.array([contour.arcs.min(axis=(0, 1)) for contour in contours])
    high = np.array([contour.arcs.max(axis=(0, 1)) for contour in contours])
    places = np.array([_places(contour) for contour in contours])
    box, point = points_in_boxes(low, high, places.reshape(-1, 2))
    # How many of its three points lie in the box of each contour that has any of them.
    pair, within = np.unique(box * count + point // len(_PLACES), return_counts=True)
    outer, inner = np.divmod(pair[within >= 2], count)
    closed = np.array([contour.closed for contour in contours])
    may = (outer != inner) & closed[outer]
    outer, inner = outer[may], inner[may]
    around = np.zeros(len(outer), dtype=np.bool_)
    begins = np.flatnonzero(np.diff(outer, prepend=-1))
    for a, b in pairwise([*begins.tolist(), len(outer)]):
        around[a:b] = _most_enclosed(contours[int(outer[a])], places[inner[a:b]])
    outer, inner = outer[around], inner[around]
    # The depth grows by one from a contour to those directly inside it.
    depth = np.bincount(inner, minlength=count)
    parent = np.full(count, -1)
    deepest = np.lexsort((-outer, depth[outer], inner))
    parent[inner[deepest]] = outer[deepest]
    result = list(contours)
    for j in np.argsort(depth, kind="stable").tolist():
        result[j] = _inside(contours[j], result[parent[j]] if parent[j] >= 0 else None)
    return result


def points_in_boxes(low: Floats, high: Floats, points: Floats) -> tuple[Ints, Ints]:
    """All pairs of a box (n, 2), (n, 2) and a point (m, 2) in it, or on its sides.

    Points are sorted into the cells of a grid, row after row, so that a box asks one stretch of
    them for each row that it meets.
    """
    across = max(1, int(len(points) ** 0.5))
    start = points.min(axis=0)
    step = np.maximum(np.ptp(points, axis=0) / across, np.finfo(np.float64).tiny)

    def cells(of: Floats) -> Ints:
        with np.errstate(over="ignore"):  # of points on one line, far away
            return np.asarray(np.clip((of - start) / step, 0, across - 1).astype(np.int64))

    column, row = cells(points).T
    order = np.argsort(row * across + column, kind="stable")
    starts = np.searchsorted((row * across + column)[order], np.arange(across * across + 1))
    first, last = cells(low), cells(high)
    rows = last[:, 1] - first[:, 1] + 1
    box, step_up = _counted(rows)
    base = (first[box, 1] + step_up) * across
    begin = starts[base + first[box, 0]]
    stretch, place = _counted(starts[base + last[box, 0] + 1] - begin)
    box, point = box[stretch], order[begin[stretch] + place]
    within = ((low[box] <= points[point]) & (points[point] <= high[box])).all(axis=1)
    return box[within], point[within]


def _counted(counts: Ints) -> tuple[Ints, Ints]:
    """Each number as often as its count says, and 0, 1, 2, ... beside it."""
    which = np.repeat(np.arange(len(counts)), counts)
    return which, np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)


def smallest_around(contours: Sequence[Contour]) -> list[int]:
    """Of each contour, the row of the smallest one that encloses most of it, or -1.

    Parameters
    ----------
    contours : sequence of Contour
        Of any levels. Of two that cross, at most one counts as enclosed: the smaller one.
    """
    areas = np.array([abs(contour.area) if contour.closed else 0.0 for contour in contours])
    low = np.array([contour.arcs.min(axis=(0, 1)) for contour in contours])
    high = np.array([contour.arcs.max(axis=(0, 1)) for contour in contours])
    result = [-1] * len(contours)
    for j, contour in enumerate(contours):
        places = _places(contour)
        middle = places[1]
        # Of equal ones, which are the same contour twice, neither is in the other.
        may = np.all((low <= middle) & (middle <= high), axis=1) & (areas > areas[j])
        rows = np.flatnonzero(may)
        for i in rows[np.argsort(areas[rows], kind="stable")].tolist():
            if _most_enclosed(contours[i], places[None])[0]:
                result[j] = i
                break
    return result


def _places(contour: Contour) -> Floats:
    """Three points of a contour, between the ends of its arcs: others touch it there, if at all."""
    at = _PLACES * len(contour.arcs)
    arc = at.astype(np.int64)
    return evaluate_each(contour.arcs[arc], contour.weights[arc], at - arc)


def _most_enclosed(contour: Contour, places: Floats) -> Bools:
    """Whether at least two of three points of each lie inside: (n, 3, 2) -> (n,).

    One may be where the two touch, so that rounding decides: the third is asked if two disagree.
    """
    first, last = (enclosed(contour, places[:, k]) for k in (0, 2))
    doubtful = np.flatnonzero(first != last)
    if len(doubtful):
        first[doubtful] = enclosed(contour, places[doubtful, 1])
    return first


def _inside(contour: Contour, parent: Contour | None) -> Contour:
    """The contour with another parent: all else was checked when it was made."""
    if contour.parent is parent:
        return contour
    result = object.__new__(Contour)
    result.__dict__.update(contour.__dict__, parent=parent)
    return result


def enclosed(contour: Contour, points: Floats) -> Bools:
    """Whether each point lies inside a closed contour: (n, 2) -> (n,).

    The exact crossings of the ray to the right are counted. Which arcs cross follows from the
    signs at their ends, which neighbors share to the bit, so that none is counted twice.
    """
    low, high = contour.arcs.min(axis=1), contour.arcs.max(axis=1)
    right, below, above = high[:, 0], low[:, 1], high[:, 1]
    # Of most arcs the control points show that the ray passes them by.
    near = [np.flatnonzero((below <= y) & (y <= above) & (x <= right)) for x, y in points]
    of_point, of_arc = np.repeat(np.arange(len(points)), [*map(len, near)]), np.concatenate(near)
    arcs = contour.arcs[of_arc] - points[of_point, None]
    crossings = _crossings_to_the_right(arcs, contour.weights[of_arc])
    return np.asarray(np.bincount(of_point, crossings, len(points)) % 2 == 1)


def _crossings_to_the_right(arcs: Floats, weights: Floats) -> Ints:
    """How often each arc crosses the positive x axis: (n, 3, 2) -> (n,)."""
    # The numerator of y in Bernstein form: its roots are where an arc crosses the axis.
    p, q, r = arcs[:, 0, 1], weights * arcs[:, 1, 1], arcs[:, 2, 1]
    differ = (p < 0.0) != (r < 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(q * q - p * r, 0.0))
        # With both ends on one side there may be two crossings: a parabola through the axis.
        dips = ~differ & (q * q > p * r) & (np.where(p < 0.0, -q, q) < 0.0)
        # t / (1 - t) = s with p + 2 q s + r s² = 0, in forms that do not cancel.
        big = -(q + np.where(q < 0.0, -root, root))
        first, second = p / big, big / r
        is_first = first >= 0.0
        result = (dips | (differ & is_first)) & _right_of_zero(arcs, weights, first)
        other = (dips | (differ & ~is_first)) & _right_of_zero(arcs, weights, second)
    return np.asarray(result.astype(np.int64) + other)


def _right_of_zero(arcs: Floats, weights: Floats, s: Floats) -> Bools:
    """Whether points at t / (1 - t) = s have a positive x."""
    x = arcs[:, 0, 0] + s * (2.0 * weights * arcs[:, 1, 0] + s * arcs[:, 2, 0])
    # For s beyond all bounds that is the end of the arc.
    return np.asarray(np.where(np.isfinite(x), x, arcs[:, 2, 0]) > 0.0)
