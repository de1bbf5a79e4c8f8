"""Segments of parallels joined to closed loops: end to start, corner by corner.

Where a segment runs on into the next there is nothing to do. The other ends are in the offset's own
corners, in each of which another segment starts, to rounding.
"""

from __future__ import annotations

import numpy as np

from splinesdf.arclets.joints import cycles
from splinesdf.arclets.points import angles
from splinesdf.arclets.thresholds import CUSP, SMOOTH
from splinesdf.distance.exact import signed_distance
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.offsets.corners import Bridges, Corners, bridged, solved
from splinesdf.offsets.specks import without_specks
from splinesdf.offsets.tables import POINT, TANGENT, Loops, OffsetSegments
from splinesdf.offsets.trimmed import (
    joints_at,
    loop_sizes,
    parallels,
    selected,
    smooth_turn,
    stacked,
)
from splinesdf.shapes.shape import Shape

# Ends and starts are matched in rounds, each with so many times the radius of the round before, so
# that the nearest find each other first.
_WIDER = 30.0
# Where boundaries touch, segments on the wrong side may be left that are shorter than the root of
# rounding, as a share of their own loop's size, not of the drawing's.
_SHORT = 1e-4
# Where two parallels cross at an angle of 1e-8, trimming may leave a gap of this share of the size,
# and of the distance, whose rounding there is. Smaller: far out, ends find no start.
_SHALLOW = 1e-5
# Loops that reach no farther than this many times their largest gap are left out. 1: segments that
# run to and fro; larger: loops that are nearly as small as a gap are lost.
_OPEN = 1.5


def loops_of(
    shape: Shape, segments: OffsetSegments, distance: float, tolerance: float
) -> Loops | None:
    """Join segments to loops, or None if an end finds no start within the tolerance."""
    smooth = smooth_turn(distance, tolerance)
    follows = _run_on(shape, segments, distance, smooth)
    sizes = loop_sizes(shape, distance)
    if distance:  # the boundary itself is on neither side
        segments, follows = _without_wrong_sides(shape, segments, follows, distance, sizes)
    ends, starts = np.flatnonzero(follows < 0), np.flatnonzero(_led_to_by_none(follows))
    own = sizes[segments.elements[:, 0]]
    farthest = max(tolerance, _SHALLOW * (float(own.max(initial=0.0)) + abs(distance)))
    which = _matched(segments.end[ends, POINT], segments.start[starts, POINT], farthest)
    if which is None:
        return None
    follows[ends] = starts[which]
    real = _larger_than_their_gaps(segments, follows)
    if not real.all():
        number = np.cumsum(real) - 1
        segments, own = selected(segments, real), own[real]
        ends, follows = number[ends[real[ends]]], number[follows[real]]
    corners = Corners(ends, follows[ends], own[ends])
    segments = solved(shape, segments, corners, distance, smooth)
    bridges = bridged(shape, segments, corners, distance, tolerance)
    if bridges is None:
        return None
    return without_specks(_as_loops(segments, follows, bridges), sizes, tolerance)


def _run_on(shape: Shape, segments: OffsetSegments, distance: float, smooth: float) -> Ints:
    """Find the segment that each segment runs on into, -1 where it ends in a corner: (n,)."""
    arclet, corner = segments.elements.T
    spans = segments.spans
    boundary, joints = shape.boundary, joints_at(shape, distance)
    turns = (corner == 0) & (joints.turn[arclet] * distance > smooth * abs(distance))
    # The next element: the arc around the end, or the next arclet.
    wanted = np.where(turns, 2 * arclet + 1, 2 * joints.following[arclet])
    opening = np.full(2 * len(boundary.start), -1)
    fresh = np.flatnonzero(spans[:, 0] == 0.0)
    opening[2 * arclet[fresh] + corner[fresh]] = fresh
    # In a corner toward the offset parallels cross, if too near to their ends for trimming.
    cross = (corner == 0) & (joints.turn[arclet] * distance < -smooth * abs(distance))
    return np.where((spans[:, 1] == 1.0) & ~cross, opening[wanted], -1)


def _led_to_by_none(follows: Ints) -> Bools:
    """Find the segments that no other runs on into: (n,)."""
    result = np.ones(len(follows), dtype=np.bool_)
    result[follows[follows >= 0]] = False
    return result


def _without_wrong_sides(
    shape: Shape, segments: OffsetSegments, follows: Ints, distance: float, sizes: Floats
) -> tuple[OffsetSegments, Ints]:
    """Leave out segments on the wrong side, next to shapes too thin to have two sides.

    Such are slivers between the branches of a cusp, and short segments where boundaries touch.
    """
    right = np.ones(len(follows), dtype=np.bool_)
    if (np.abs(joints_at(shape, distance).turn) > np.pi - CUSP).any():
        asked = np.arange(len(follows))
    else:
        asked = np.flatnonzero((follows < 0) | _led_to_by_none(follows))
        chord = segments.end[asked, POINT] - segments.start[asked, POINT]
        own = sizes[segments.elements[asked, 0]]
        asked = asked[np.hypot(*chord.T) < _SHORT * own]
    if len(asked):
        middles = segments.spans[asked].mean(axis=1)
        points = parallels(shape, segments.elements[asked], middles, distance)[:, POINT]
        there = signed_distance(shape, points + shape.boundary.origin)
        right[asked] = np.sign(there) == np.sign(distance)
    if right.all():
        return segments, follows
    number = np.cumsum(right) - 1
    kept = follows[right]
    leads = (kept >= 0) & right[kept]
    return selected(segments, right), np.where(leads, number[kept], -1)


def _matched(ends: Floats, starts: Floats, farthest: float) -> Ints | None:
    """Match each end to the nearest start, each used once; None if an end finds none."""
    if len(ends) != len(starts):
        return None
    result = np.full(len(ends), -1)
    order = np.argsort(starts[:, 0])
    x = starts[order, 0]
    free = np.ones(len(starts), dtype=np.bool_)
    radius = farthest * _WIDER**-6
    while True:
        left = np.flatnonzero(result < 0)
        if not len(left):
            return result
        low = np.searchsorted(x, ends[left, 0] - radius)
        count = np.searchsorted(x, ends[left, 0] + radius, side="right") - low
        one = np.repeat(left, count)
        offsets = np.arange(len(one)) - np.repeat(np.cumsum(count) - count, count)
        other = order[np.repeat(low, count) + offsets]
        gap = np.hypot(*(ends[one] - starts[other]).T)
        for pair in np.argsort(gap):
            if gap[pair] > radius:
                break
            if free[other[pair]] and result[one[pair]] < 0:
                result[one[pair]], free[other[pair]] = other[pair], False
        if radius >= farthest:
            return None if (result < 0).any() else result
        radius = min(radius * _WIDER, farthest)


def _larger_than_their_gaps(segments: OffsetSegments, follows: Ints) -> Bools:
    """Find the segments of loops that reach farther than their gaps.

    A short segment between two crossings at small angles may, by rounding, be nearer to itself than
    to its neighbors. Then those are matched to each other, and the segment is a loop by itself.
    """
    if not len(follows):
        return np.ones(0, dtype=np.bool_)
    order, first = cycles(follows)
    begins = first[:-1]
    starts, ends = segments.start[:, POINT], segments.end[:, POINT]
    gap = np.hypot(*(starts[follows] - ends).T)[order]
    low, high = np.minimum(starts, ends)[order], np.maximum(starts, ends)[order]
    reach = np.maximum.reduceat(high, begins) - np.minimum.reduceat(low, begins)
    real = reach.max(axis=1) > _OPEN * np.maximum.reduceat(gap, begins)
    result = np.empty(len(follows), dtype=np.bool_)
    result[order] = np.repeat(real, np.diff(first))
    return result


def _as_loops(segments: OffsetSegments, follows: Ints, bridges: Bridges) -> Loops:
    """Order segments and bridges along their loops, with ends and starts equal to the bit."""
    count, start, end = len(follows), segments.start.copy(), segments.end.copy()
    # At a smooth end the tangent is that of the next segment.
    smooth = np.abs(angles(end[:, TANGENT], start[follows, TANGENT])) <= SMOOTH
    joined = np.ones(count, dtype=np.bool_)
    joined[bridges.after] = False
    shared = 0.5 * (end[joined, POINT] + start[follows[joined], POINT])
    end[joined, POINT] = shared
    start[follows[joined], POINT] = shared
    segments, center = segments._replace(start=start, end=end), np.full((count, 2), np.nan)
    if len(bridges.after):
        added = len(bridges.after)
        following = follows[bridges.after]
        frames = np.full((2, added, 6), np.nan)
        frames[0, :, POINT], frames[1, :, POINT] = (
            end[bridges.after, POINT],
            start[following, POINT],
        )
        rows = OffsetSegments(
            np.full((added, 2), -1), np.tile([0.0, 1.0], (added, 1)), frames[0], frames[1]
        )
        segments = stacked(segments, rows)
        center = np.concatenate([center, bridges.center])
        smooth[bridges.after] = bridges.smooth
        smooth = np.concatenate([smooth, bridges.smooth])
        follows = np.concatenate([follows, following])
        follows[bridges.after] = count + np.arange(added)
    order, first = cycles(follows)
    return Loops(selected(segments, order), center[order], smooth[order], first)
