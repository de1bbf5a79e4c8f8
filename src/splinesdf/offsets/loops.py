"""Stretches of parallels joined to closed loops: end to start, corner by corner.

Where one stretch runs on into the next there is nothing to do. The other ends are those of the
offset's own corners, each of which is also the start of another stretch, to rounding.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.arclets.joints import CUSP, cycles
from splinesdf.arclets.points import angles
from splinesdf.distance.exact import signed_distance
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.offsets.specks import Loops, without_specks
from splinesdf.offsets.trimmed import (
    SMOOTH,
    Stretches,
    joints_at,
    loop_sizes,
    parallels,
    smooth_turn,
)
from splinesdf.shapes.shape import Shape

# Steps of Newton's method from where trimming left two stretches to where they cross: one that goes
# too far, as where they nearly touch, is halved. Fewer: such corners stay where trimming left them.
_STEPS = 24
# Ends and starts are matched in rounds, each with a radius so many times the one before, so that
# near ones find each other first.
_WIDER = 30.0
# Where boundaries touch, stretches on the wrong side may be left that are shorter than the root of
# rounding, as a share of their own loop's size, not of the drawing's.
_SHORT = 1e-4
# Where two parallels cross at an angle of 1e-8, trimming may leave a gap of this share of the size,
# and of the distance, whose rounding there is. Smaller: far out, ends find no start.
_SHALLOW = 1e-5
# Where a parallel is as far from the boundary as asked but for this share of the size, it was cut
# for rounding only. Larger: what something is nearer to by as much stays in.
_ROUNDING = 1e-12
# Loops that reach no farther than this many times the largest gap in them are none. 1: what is left
# of a stretch to and fro; larger: loops that are nearly as small as a gap are lost.
_OPEN = 1.5
# Stretches that overlap are nearly on one line if they turn by less than this (radians) there.
_OVERLAP = 1e-3
# They may cross so far (in the parameter) beyond the end of an arclet, on its continuation.
_BEYOND = 1e-3
# What is left open, as a share of the tolerance, is closed by moving both ends; more by a bridge.
_MOVED = 1e-3


class Loose(NamedTuple):
    """Stretches of which some end where others start: ends that are to meet, and are moved."""

    elements: Ints  # (n, 2) see `Stretches`
    spans: Floats  # (n, 2) moved in place
    points: Floats  # (2, n, 6) what `parallels` has at starts and ends, moved along
    one: Ints  # (m,) whose ends
    other: Ints  # (m,) whose starts, one for each
    sizes: Floats  # (n,) of the boundary's loop that each is about


def loops_of(shape: Shape, stretches: Stretches, distance: float, tolerance: float) -> Loops | None:
    """Join stretches to loops, or None if one end finds no start within the tolerance."""
    smooth = smooth_turn(distance, tolerance)
    follows = _run_on(shape, stretches, distance, smooth)
    sizes = loop_sizes(shape, distance)
    if distance:  # the boundary itself is on neither side
        stretches, follows = _without_wrong_sides(shape, stretches, follows, distance, sizes)
    if not len(follows):
        return _as_loops(stretches, follows, np.empty((2, 0, 6)), np.empty((0, 5)))
    spans = stretches.spans.copy()
    points = np.stack([parallels(shape, stretches.elements, at, distance) for at in spans.T])
    ends, starts = np.flatnonzero(follows < 0), np.flatnonzero(_led_to_by_none(follows))
    own = sizes[stretches.elements[:, 0]]
    farthest = max(tolerance, _SHALLOW * (float(own.max(initial=0.0)) + abs(distance)))
    which = _matched(points[1, ends, :2], points[0, starts, :2], farthest)
    if which is None:
        return None
    follows[ends] = starts[which]
    real = _larger_than_their_gaps(points, follows)
    if not real.all():
        number = np.cumsum(real) - 1
        stretches = Stretches(stretches.elements[real], stretches.spans[real])
        spans, points, own = spans[real], points[:, real], own[real]
        ends, follows = number[ends[real[ends]]], number[follows[real]]
        if not len(follows):
            return _as_loops(stretches, follows, points, np.empty((0, 5)))
    loose = Loose(stretches.elements, spans, points, ends, follows[ends], own)
    _draw_back(shape, loose, distance)
    _to_crossings(shape, loose, distance)
    _fill_in(shape, loose, distance, smooth)
    bridges = _bridges(shape, points, ends, follows[ends], distance, tolerance)
    if bridges is None:
        return None
    loops = _as_loops(Stretches(stretches.elements, spans), follows, points, bridges)
    return without_specks(loops, sizes, tolerance)


def _run_on(shape: Shape, stretches: Stretches, distance: float, smooth: float) -> Ints:
    """The stretch that each one runs on into, -1 where it ends in a corner: (n,)."""
    elements, spans = stretches
    arclet, corner = elements.T
    boundary, joints = shape.boundary, joints_at(shape, distance)
    turns = (corner == 0) & (joints.turn[arclet] * distance > smooth * abs(distance))
    # What comes next: the arc around the end, or the next arclet.
    wanted = np.where(turns, 2 * arclet + 1, 2 * joints.following[arclet])
    opening = np.full(2 * len(boundary.start), -1)
    fresh = np.flatnonzero(spans[:, 0] == 0.0)
    opening[2 * arclet[fresh] + corner[fresh]] = fresh
    # In a corner toward the offset the parallels cross, be it too near to their ends for trimming.
    cross = (corner == 0) & (joints.turn[arclet] * distance < -smooth * abs(distance))
    return np.where((spans[:, 1] == 1.0) & ~cross, opening[wanted], -1)


def _led_to_by_none(follows: Ints) -> Bools:
    """Which stretches none runs on into."""
    result = np.ones(len(follows), dtype=np.bool_)
    result[follows[follows >= 0]] = False
    return result


def _without_wrong_sides(
    shape: Shape, stretches: Stretches, follows: Ints, distance: float, sizes: Floats
) -> tuple[Stretches, Ints]:
    """Without stretches on the wrong side, next to what is too thin for its sides to be told.

    Such are slivers between the branches of a cusp, and short ones where boundaries touch.
    """
    right = np.ones(len(follows), dtype=np.bool_)
    if (np.abs(joints_at(shape, distance).turn) > np.pi - CUSP).any():
        asked = np.arange(len(follows))
    else:
        asked = np.flatnonzero((follows < 0) | _led_to_by_none(follows))
        first, last = (
            parallels(shape, stretches.elements[asked], at, distance)[:, :2]
            for at in stretches.spans[asked].T
        )
        own = sizes[stretches.elements[asked, 0]]
        asked = asked[np.hypot(*(last - first).T) < _SHORT * own]
    if len(asked):
        middles = stretches.spans[asked].mean(axis=1)
        points = parallels(shape, stretches.elements[asked], middles, distance)[:, :2]
        there = signed_distance(shape, points + shape.boundary.origin)
        right[asked] = np.sign(there) == np.sign(distance)
    if right.all():
        return stretches, follows
    number = np.cumsum(right) - 1
    kept = follows[right]
    leads = (kept >= 0) & right[kept]
    return (
        Stretches(stretches.elements[right], stretches.spans[right]),
        np.where(leads, number[kept], -1),
    )


def _matched(ends: Floats, starts: Floats, farthest: float) -> Ints | None:
    """For each end the start next to it, each used once; None if there is none."""
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


def _larger_than_their_gaps(points: Floats, follows: Ints) -> Bools:
    """Which stretches are in loops that reach farther than what is open in them.

    A short stretch between two crossings at small angles may be nearer to itself than, for
    rounding, to its neighbors. Then those are matched to each other, and it is a loop alone.
    """
    order, first = cycles(follows)
    begins = first[:-1]
    gap = np.hypot(*(points[0, follows, :2] - points[1, :, :2]).T)[order]
    low, high = points[:, order, :2].min(axis=0), points[:, order, :2].max(axis=0)
    reach = np.maximum.reduceat(high, begins) - np.minimum.reduceat(low, begins)
    real = reach.max(axis=1) > _OPEN * np.maximum.reduceat(gap, begins)
    result = np.empty(len(follows), dtype=np.bool_)
    result[order] = np.repeat(real, np.diff(first))
    return result


def _to_crossings(shape: Shape, loose: Loose, distance: float) -> None:
    """Move the ends of some stretches and the starts of others to where both cross, if they do.

    Trimming leaves both ends at nearly the same point, each to rounding over the sine of the angle
    between them.
    """
    elements, spans, points, one, other, _ = loose
    a, b = spans[one, 1].copy(), spans[other, 0].copy()
    at_a, at_b = points[1, one].copy(), points[0, other].copy()
    gap = at_b[:, :2] - at_a[:, :2]
    part = np.ones(len(one))
    for _ in range(_STEPS):
        va, vb = at_a[:, 2:4] * at_a[:, 4:5], at_b[:, 2:4] * at_b[:, 4:5]
        cross = va[:, 0] * vb[:, 1] - va[:, 1] * vb[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            step_a = part * (gap[:, 0] * vb[:, 1] - gap[:, 1] * vb[:, 0]) / cross
            step_b = part * (gap[:, 0] * va[:, 1] - gap[:, 1] * va[:, 0]) / cross
        new_a, new_b = a + step_a, b + step_b
        usable = (new_a > spans[one, 0]) & (new_a <= 1.0 + _BEYOND)
        usable &= (new_b < spans[other, 1]) & (new_b >= -_BEYOND)
        # Beyond both ends it would be a miter.
        usable &= (new_a <= 1.0) | (new_b >= 0.0)
        usable &= (new_a != a) | (new_b != b)
        if not usable.any():
            break
        new_a, new_b = np.where(usable, new_a, a), np.where(usable, new_b, b)
        new_at_a = parallels(shape, elements[one], new_a, distance)
        new_at_b = parallels(shape, elements[other], new_b, distance)
        new_gap = new_at_b[:, :2] - new_at_a[:, :2]
        better = np.hypot(*new_gap.T) < np.hypot(*gap.T)
        part = np.where(better, 1.0, 0.5 * part)
        a, b = np.where(better, new_a, a), np.where(better, new_b, b)
        at_a = np.where(better[:, None], new_at_a, at_a)
        at_b = np.where(better[:, None], new_at_b, at_b)
        gap = np.where(better[:, None], new_gap, gap)
    spans[one, 1], spans[other, 0] = a, b
    points[1, one], points[0, other] = at_a, at_b


def _fill_in(shape: Shape, loose: Loose, distance: float, smooth: float) -> None:
    """Let smooth parallels run on where they were cut though nothing is nearer, but for rounding.

    So they are beside a point of the shape in which another branch touches this one.
    """
    elements, spans, points, one, other, sizes = loose
    (i, corner), (j, other_corner) = elements[one].T, elements[other].T
    end, start = spans[one, 1], spans[other, 0]
    same = (i == j) & (end < start)
    joints = joints_at(shape, distance)
    next_ = (joints.following[i] == j) & (np.abs(joints.turn[i]) <= smooth)
    gap = np.hypot(*(points[0, other, :2] - points[1, one, :2]).T)
    cut = (corner + other_corner == 0) & (same | next_) & (gap > 0.0)
    cut &= gap <= _SHALLOW * sizes[one]
    one, other, same, middle = one[cut], other[cut], same[cut], 0.5 * (end + start)[cut]
    if not len(one):
        return
    ends = parallels(shape, elements[one], np.where(same, middle, 1.0), distance)
    starts = parallels(shape, elements[other], np.where(same, middle, 0.0), distance)
    exact = signed_distance(shape, ends[:, :2] + shape.boundary.origin)
    near = np.abs(exact - distance) <= _ROUNDING * (shape.size + abs(distance))
    near &= ends[:, 4] > 0.0
    one, other = one[near], other[near]
    points[1, one], points[0, other] = ends[near], starts[near]
    spans[one, 1] = np.where(same, middle, 1.0)[near]
    spans[other, 0] = np.where(same, middle, 0.0)[near]


def _draw_back(shape: Shape, loose: Loose, distance: float) -> None:
    """Take back what two stretches, nearly on one line, overlap: the quicker one begins later.

    Next to a cusp parallels turn back so shortly that rounding hides where they cross.
    """
    elements, spans, points, one, other, sizes = loose
    gap = points[0, other, :2] - points[1, one, :2]
    length = np.hypot(*gap.T)
    ahead, leaving = points[1, one, 2:4], points[0, other, 2:4]
    near = _SHALLOW * sizes[one]
    back = (np.sum(gap * ahead, axis=1) < -0.5 * length) & (length <= near)
    back &= np.abs(angles(ahead, leaving)) <= _OVERLAP
    for a, b, away in zip(one[back], other[back], length[back], strict=True):
        late = abs(points[0, b, 4]) >= abs(points[1, a, 4])
        row, side, fixed = (b, 0, points[1, a]) if late else (a, 1, points[0, b])
        t, at = spans[row, side], points[side, row]
        for _ in range(_STEPS):
            if at[4] == 0.0:  # a point that stands still
                break
            t += float((fixed[:2] - at[:2]) @ at[2:4] / at[4])
            if not 0.0 < t < 1.0:
                break
            at = parallels(shape, elements[[row]], np.array([t]), distance)[0]
        shorter = spans[b, 0] < t < spans[b, 1] if late else spans[a, 0] < t < spans[a, 1]
        if shorter and np.hypot(*(at[:2] - fixed[:2])) < 0.01 * away:
            spans[row, side], points[side, row] = t, at


def _bridges(
    shape: Shape, points: Floats, one: Ints, other: Ints, distance: float, tolerance: float
) -> Floats | None:
    """Close what is still open: move both ends, or a bridge; None if that goes too far.

    Returns
    -------
    ndarray, shape (k, 5)
        After which stretch, the center of the arc or NaN, and whether it joins smoothly.
    """
    gap = np.hypot(*(points[0, other, :2] - points[1, one, :2]).T)
    wide = gap > _MOVED * tolerance
    if not wide.any():
        return np.empty((0, 5))
    one, other = one[wide], other[wide]
    normals = np.stack([points[:, :, 3], -points[:, :, 2]], axis=-1)
    feet = points[..., :2] - distance * normals
    apart = np.hypot(*(feet[0, other] - feet[1, one]).T)
    before, after = points[1, one, 2:4], points[0, other, 2:4]
    turn = angles(before, after)
    # Both ends belong to one point of the shape: next to a corner too small for its tangents.
    around = (apart <= _MOVED * tolerance) & (turn * distance > 0.0)
    center = np.where(around[:, None], 0.5 * (feet[0, other] + feet[1, one]), np.nan)
    middle = 0.5 * (points[1, one, :2] + points[0, other, :2])
    bulge = middle - center
    with np.errstate(divide="ignore", invalid="ignore"):
        bulge *= (abs(distance) / np.hypot(bulge[:, 0], bulge[:, 1]))[:, None]
    middle = np.where(around[:, None], center + bulge, middle)
    exact = signed_distance(shape, middle + shape.boundary.origin)
    if not (np.abs(exact - distance) <= 0.5 * tolerance).all():
        return None
    return np.column_stack([one, center, around, np.zeros(len(one))])


def _as_loops(stretches: Stretches, follows: Ints, points: Floats, bridges: Floats) -> Loops:
    """Rows in the order of the loops, joints made equal to the bit."""
    count = len(follows)
    start, end = points[0, :, :2].copy(), points[1, :, :2].copy()
    # A smooth end is one that runs on: its tangent is that of the next stretch.
    smooth = np.abs(angles(points[1, :, 2:4], points[0, follows, 2:4])) <= SMOOTH
    bridged = bridges[:, 0].astype(np.int64)
    joined = np.ones(count, dtype=np.bool_)
    joined[bridged] = False
    shared = 0.5 * (end + start[follows])
    end = np.where(joined[:, None], shared, end)
    start[follows[joined]] = shared[joined]
    elements, spans, center = stretches.elements, stretches.spans, np.full((count, 2), np.nan)
    if len(bridged):
        arcs = bridges[:, 3] > 0.0
        following = follows[bridged]
        elements = np.concatenate([elements, np.full((len(bridged), 2), -1)])
        spans = np.concatenate([spans, np.tile([0.0, 1.0], (len(bridged), 1))])
        start = np.concatenate([start, end[bridged]])
        end = np.concatenate([end, start[following]])
        center = np.concatenate([center, bridges[:, 1:3]])
        smooth[bridged] = arcs
        smooth = np.concatenate([smooth, arcs])
        follows = np.concatenate([follows, following])
        follows[bridged] = count + np.arange(len(bridged))
    order, first = cycles(follows)
    return Loops(
        elements[order], spans[order], start[order], end[order], center[order], smooth[order], first
    )
