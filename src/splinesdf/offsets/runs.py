"""Runs: consecutive segments of a loop on one line, one circle or one smooth curve.

Lines and circles of the shape have lines and circles as their offsets, and corners have circles;
these stay as they are. All segments between two of them, or two corners, are one free run.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.points import angles, off_chord
from splinesdf.arclets.tables import FREE, ROUND, STRAIGHT
from splinesdf.arclets.thresholds import SMOOTH
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.offsets.tables import POINT, TANGENT, Loops, Runs
from splinesdf.offsets.trimmed import parallels, selected
from splinesdf.shapes.shape import Shape

# A line or a circle is no farther off its run anywhere than this share of the tolerance or, for
# rounding, of the largest coordinate. Larger: exact lines and circles are off by as much; smaller:
# chains of many short pieces come back as many lines and arcs.
_SHARE, _ROUNDING = 1e-3, 32 * 2.220446049250313e-16


class SegmentKinds(NamedTuple):
    """Kind and shape of each segment of loops."""

    kind: Ints  # (n,) as in `Kinds`, free where its parallel is neither line nor circle
    center: Floats  # (n, 2) of a round one
    points: Floats  # (n, 3, 2) at its start, middle and end


def runs_of(shape: Shape, loops: Loops, distance: float, tolerance: float) -> tuple[Runs, Ints]:
    """Cut loops into runs, each loop restarted where a run does.

    A line or a circle reaches as far as it stays within a small share of the tolerance.

    Returns
    -------
    runs : Runs
    first : ndarray, shape (n_loops + 1,)
        Loop j has the runs ``first[j]:first[j + 1]``.
    """
    largest = max(abs(value) for value in (*shape.box, distance))
    allowed = max(_SHARE * tolerance, _ROUNDING * largest)
    kind, center, points = _kinds(shape, loops, distance, allowed)
    count = len(kind)
    after = np.arange(1, count + 1)
    after[loops.first[1:] - 1] = loops.first[:-1]
    same = (kind == kind[after]) & loops.smooth
    same &= (kind != ROUND) | (
        (_off_circle(points, points[after], center[after]) <= allowed)
        & (_off_circle(points[after], points, center) <= allowed)
        & (_tangents_apart(points, points[after], center, center[after]) <= SMOOTH)
    )
    order = np.concatenate([_turned(np.arange(a, b), same[a:b]) for a, b in pairwise(loops.first)])
    # Runs end where their loops do.
    ends = ~same[order]
    ends[loops.first[1:] - 1] = True
    ends |= _bent(points[order], center[order], kind[order], ends, allowed)
    first = np.concatenate([[0], np.flatnonzero(ends) + 1])
    members = np.repeat(np.arange(len(first) - 1), np.diff(first))
    kind, center, sweep = kind[order], center[order], _sweeps(loops, distance)[order]
    with np.errstate(invalid="ignore"):
        weight = np.abs(sweep)
        total = np.bincount(members, weight)
        mean = np.column_stack([np.bincount(members, weight * c) / total for c in center.T])
    mean = np.where((total > 0.0)[:, None], mean, center[first[:-1]])
    starts = np.searchsorted(first, loops.first)
    closed = np.zeros(len(first) - 1, dtype=np.bool_)
    alone = np.flatnonzero(np.diff(starts) == 1)
    closed[starts[alone]] = loops.smooth[order[loops.first[alone + 1] - 1]]
    return (
        Runs(
            selected(loops.segments, order),
            first,
            kind[first[:-1]],
            mean,
            np.bincount(members, sweep).astype(np.float64),
            closed,
        ),
        starts,
    )


def _kinds(shape: Shape, loops: Loops, distance: float, allowed: float) -> SegmentKinds:
    """Give each segment the kind of its arclet, if its parallel keeps that."""
    table, segments = shape.kinds, loops.segments
    arclet, corner = segments.elements.T
    bridge, around = arclet < 0, np.isfinite(loops.center[:, 0])
    kind = np.where(corner == 1, ROUND, table.kind[arclet])
    kind = np.where(bridge, np.where(around, ROUND, STRAIGHT), kind)
    center = np.where((corner == 1)[:, None], shape.boundary.end[arclet], table.center[arclet])
    center = np.where(bridge[:, None], loops.center, center)
    own = np.flatnonzero(~bridge)
    start, end = segments.start[:, POINT], segments.end[:, POINT]
    middle = 0.5 * (start + end)
    at = segments.spans[own].mean(axis=1)
    middle[own] = parallels(shape, segments.elements[own], at, distance)[:, POINT]
    # An arclet that is a line or a circle to rounding need not have such a parallel far from it.
    points = np.stack([start, middle, end], axis=1)
    off = np.where(kind == ROUND, _off_circle(points[:, 1:2], points, center), off_chord(points))
    return SegmentKinds(np.where(~bridge & (off > allowed), FREE, kind), center, points)


def _off_circle(some: Floats, points: Floats, center: Floats) -> Floats:
    """Measure how far points (n, k, 2) are off the circles about centers (n, 2) through others."""
    own = np.hypot(*np.moveaxis(some - center[:, None], 2, 0)).mean(axis=1)
    return np.asarray(
        np.abs(np.hypot(*np.moveaxis(points - center[:, None], 2, 0)) - own[:, None]).max(axis=1)
    )


def _tangents_apart(one: Floats, other: Floats, center: Floats, others: Floats) -> Floats:
    """Compare tangents of two circles (radians) at the far ends of two arcs: the larger angle.

    An arc so short that any circle fits it may turn by far more than the circle beside it.
    """
    start, end = (angles(at - center, at - others) for at in (one[:, 0], other[:, -1]))
    return np.maximum(np.abs(start), np.abs(end))


def _bent(points: Floats, center: Floats, kind: Ints, ends: Bools, allowed: float) -> Bools:
    """Find where straight and round runs must end early to stay on their line or circle."""
    result = np.zeros(len(ends), dtype=np.bool_)
    last = np.flatnonzero(ends)
    for a, b in zip([0, *(last[:-1] + 1).tolist()], (last + 1).tolist(), strict=True):
        if b - a < 2 or kind[a] == FREE:
            continue
        if kind[a] == STRAIGHT:
            chain = np.concatenate([points[a : a + 1, 0], points[a:b, 2]])
            if off_chord(chain[None])[0] > allowed:
                result[a + _straight_parts(chain, allowed)] = True
            continue
        if (
            _off_circle(points[None, a, 1:2], points[a:b].reshape(1, -1, 2), center[None, a])[0]
            > allowed
        ):
            first = a
            for k in range(a + 1, b):
                if (
                    _off_circle(points[None, first], points[None, k], center[None, first])[0]
                    > allowed
                ):
                    result[k - 1], first = True, k
    return result


def _straight_parts(chain: Floats, allowed: float) -> Ints:
    """Cut a nearly straight chain into the longest lines: the segments with which they end.

    A line from one vertex to another passes as near as allowed to all vertices between if its
    direction is within a sector about each of them.
    """
    result = []
    first, number = 0, 1
    low, high = -np.inf, np.inf
    ahead = chain[-1] - chain[0]
    turned = np.array([-ahead[1], ahead[0]])
    while number < len(chain):
        apart = chain[number] - chain[first]
        x, y = float(apart @ ahead), float(apart @ turned)
        length = float(np.hypot(x, y))
        angle = float(np.arctan2(y, x))
        if not low <= angle <= high and number > first + 1:
            result.append(number - 2)
            first, low, high = number - 1, -np.inf, np.inf
            continue
        scaled = allowed * float(np.hypot(*ahead))
        if length > scaled:
            room = float(np.arcsin(scaled / length))
            low, high = max(low, angle - room), min(high, angle + room)
        number += 1
    return np.array(result, dtype=np.int64)


def _sweeps(loops: Loops, distance: float) -> Floats:
    """Turn of the tangent along each segment (radians), less than half a turn each: (n,)."""
    segments, center = loops.segments, loops.center
    result = np.zeros(len(center))
    own = np.flatnonzero(segments.elements[:, 0] >= 0)
    result[own] = angles(segments.start[own, TANGENT], segments.end[own, TANGENT])
    arcs = np.flatnonzero(np.isfinite(center[:, 0]))
    start, end = segments.start[arcs, POINT], segments.end[arcs, POINT]
    result[arcs] = angles(start - center[arcs], end - center[arcs])
    corners = segments.elements[:, 1] == 1
    # Around the tip of a cusp rounding may take a half turn for a half turn to the other side.
    result[corners] = np.copysign(result[corners], distance)
    return result


def _turned(rows: Ints, same: Bools) -> Ints:
    """Restart the rows of a loop behind its last break, if there is a break."""
    breaks = np.flatnonzero(~same)
    return np.concatenate([rows[breaks[-1] + 1 :], rows[: breaks[-1] + 1]]) if len(breaks) else rows
