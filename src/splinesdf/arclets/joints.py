"""Joints: how the arclets of a boundary follow one another, and how the curve turns there."""

from __future__ import annotations

import numpy as np

from splinesdf.arclets.crossings import degrees
from splinesdf.arclets.points import angles, derivatives_at, points_at, previous_of
from splinesdf.arclets.tables import Arclets, Joints
from splinesdf.arclets.tangents import led_on, settled
from splinesdf.arclets.thresholds import CUSP, CUT
from splinesdf.arclets.vertices import Vertices
from splinesdf.ground.arrays import Floats, Ints

# Arclets along the branches of a cusp that are looked at, until both branches are apart.
_ARCLETS = 24
# Steps to the nearest point of the other branch; arclets are nearly straight.
_STEPS = 8
# Branches that are no farther apart than this share of the largest coordinate are apart by rounding
# only, or were cut where they count as touching (64 ulp, see `boundary`).
_APART = 512 * 2.220446049250313e-16
# Rounding in a velocity, as a share of the largest coordinate; divided by the velocity's length it
# is that of the direction, and turns within that are none. Larger: real corners are rounded off
# over 1e-15 of the size.
_DIRECTION = 16 * 2.220446049250313e-16
# Pieces of a degree above the first are compiled: they agree with their curve to 4 ulp, and their
# velocities at the ends to the square of the degree times as much, which is the second.
_DRAWN, _COMPILED = 3, 32.0


def joints(boundary: Arclets, vertices: Vertices, *, outside: bool) -> Joints:
    """Find loops, turns and tangents of a boundary, seen from inside or from outside.

    Where a boundary touches itself, its arclets make up different loops seen from either side.
    """
    following = boundary.following.copy()
    following[vertices.ends] = vertices.outside if outside else vertices.inside
    boundary = boundary._replace(following=following)
    boundary = boundary._replace(following=_closed(boundary))
    order, loops = cycles(boundary.following)
    sizes = np.diff(loops)
    first = np.repeat(loops[:-1], sizes)
    place = np.empty((len(order), 3), dtype=np.int64)
    place[order] = np.column_stack([np.arange(len(order)) - first, first, np.repeat(sizes, sizes)])
    arcs, velocities = settled(boundary)
    velocities = led_on(velocities, boundary.following)
    lengths = [np.hypot(vector[:, 0], vector[:, 1]) for vector in velocities]
    leaving, arriving = (
        vector / length[:, None] for vector, length in zip(velocities, lengths, strict=True)
    )
    turn = angles(arriving, leaving[boundary.following])
    cusps = np.flatnonzero(np.abs(turn) > np.pi - CUSP)
    side = _side_of_cusps(boundary, cusps) if len(cusps) else np.empty(0)
    turn[cusps] = np.copysign(turn[cusps], side)
    cut = boundary.interval[:, 1] == boundary.interval[boundary.following, 0]
    cut &= boundary.piece == boundary.piece[boundary.following]
    cut &= np.abs(turn) < CUT
    rounding = _DIRECTION * float(np.abs(boundary.boxes[0]).max() + np.abs(boundary.origin).max())
    noise = np.where(degrees(boundary) > _DRAWN, _COMPILED * rounding, rounding)
    next_length = lengths[0][boundary.following]
    next_noise = noise[boundary.following]
    none = cut | (np.abs(turn) < noise / lengths[1] + next_noise / next_length)
    turn[none] = 0.0
    # Both arclets get the tangent of the longer velocity, which is more exact.
    later = np.flatnonzero(none & (lengths[1] >= next_length))
    earlier = np.flatnonzero(none & (lengths[1] < next_length))
    leaving[boundary.following[later]] = arriving[later]
    arriving[earlier] = leaving[boundary.following[earlier]]
    chord = boundary.end - boundary.start
    early, late = angles(leaving, chord), angles(chord, arriving)
    turning = np.abs(early) + np.abs(late)
    for undecided in cusps[side == 0.0]:
        _close_up(turn, early + late, int(undecided), order, loops)
    tangents = np.concatenate([leaving, arriving], axis=1)
    return Joints(
        order, loops, place, boundary.following, turn, tangents, turning, arcs, vertices.touch
    )


def _closed(boundary: Arclets) -> Ints:
    """Find the arclet that follows each, each once, also where more than two branches meet.

    There rounding may lead two ends to one start; one of them gets the nearest that is left.
    """
    following = boundary.following.copy()
    count = len(following)
    if len(np.unique(following)) == count:
        return following
    gap = np.hypot(*(boundary.start[following] - boundary.end).T)
    # Of several ends that lead to one start the nearest keeps it.
    order = np.argsort(-gap, kind="stable")
    taken = np.full(count, -1)
    taken[following[order]] = order
    ends = np.flatnonzero(taken[following] != np.arange(count))
    kept = np.ones(count, dtype=np.bool_)
    kept[ends] = False
    led_to = np.zeros(count, dtype=np.bool_)
    led_to[following[kept]] = True
    starts = np.flatnonzero(~led_to)
    apart = np.hypot(*np.moveaxis(boundary.end[ends][:, None] - boundary.start[starts], 2, 0))
    for _ in range(len(ends)):
        one, other = np.unravel_index(int(np.argmin(apart)), apart.shape)
        following[ends[one]] = starts[other]
        apart[one], apart[:, other] = np.inf, np.inf
    return following


def cycles(following: Ints) -> tuple[Ints, Ints]:
    """Order numbers cycle after cycle, each before its follower; and where each cycle starts.

    Mostly the follower has the next number: the walk jumps only where it has not.
    """
    count = len(following)
    order = np.empty(count, dtype=np.int64)
    seen = np.zeros(count, dtype=np.bool_)
    breaks = np.flatnonzero(following != np.arange(1, count + 1))
    starts = [0]
    filled = 0
    for first in [0, *(breaks[:-1] + 1).tolist()][:count]:
        at = first
        while not seen[at]:
            end = int(breaks[np.searchsorted(breaks, at)])
            length = end + 1 - at
            order[filled : filled + length] = np.arange(at, end + 1)
            seen[at : end + 1] = True
            filled += length
            at = int(following[end])
        if filled > starts[-1]:
            starts.append(filled)
    return order, np.array(starts, dtype=np.int64)


def _close_up(turn: Floats, bend: Floats, cusp: int, order: Ints, loops: Ints) -> None:
    """Choose the side of a cusp whose branches coincide so that its loop turns once.

    Such a loop is a sliver or a slit of no width: one cusp may point outward, the other inward.
    """
    place = int(np.flatnonzero(order == cusp)[0])
    loop = int(np.searchsorted(loops, place, side="right")) - 1
    members = order[loops[loop] : loops[loop + 1]]
    rest = float(np.sum(turn[members]) + np.sum(bend[members])) - turn[cusp]
    sides = np.array([np.pi, -np.pi])
    off = np.abs(np.abs(rest + sides) - 2.0 * np.pi)
    turn[cusp] = sides[int(np.argmin(off))]


def _side_of_cusps(boundary: Arclets, arclet: Ints) -> Floats:
    """Find where tips of cusps point: positive outward, negative inward, 0 if undecided: (n,).

    The inside is on the left of both branches: if the arriving one lies on the left of the leaving
    one, the inside is between them, and the tip points outward.
    """
    result = np.zeros(len(arclet))
    noise = _APART * float(np.abs(boundary.boxes[0]).max() + np.abs(boundary.origin).max())
    previous = previous_of(boundary.following)
    before, after = arclet.copy(), boundary.following[arclet]
    # Arclets next to a tip are tiny: look farther along both branches until they are apart.
    for _ in range(_ARCLETS):
        for share in (0.5, 1.0):
            point = points_at(boundary, before, np.full(len(before), 1.0 - share))
            # On which side of the nearest point of the other branch this branch lies.
            gap = np.full(len(before), np.inf)
            cross = np.zeros(len(before))
            for other in (previous[after], after, boundary.following[after]):
                apart, ahead = _across(boundary, other, point)
                length = np.hypot(apart[:, 0], apart[:, 1])
                side = ahead[:, 0] * apart[:, 1] - ahead[:, 1] * apart[:, 0]
                nearer = (length < gap) & (np.abs(side) > 0.5 * length * np.hypot(*ahead.T))
                gap, cross = np.where(nearer, length, gap), np.where(nearer, side, cross)
            decided = (result == 0.0) & (gap > noise) & np.isfinite(gap)
            result = np.where(decided, cross, result)
        if (result != 0.0).all():
            break
        before, after = previous[before], boundary.following[after]
    return result


def _across(boundary: Arclets, arclet: Ints, points: Floats) -> tuple[Floats, Floats]:
    """Find vectors from the nearest points of arclets to points (n, 2), and velocities there."""
    at = np.full(len(arclet), 0.5)
    for _ in range(_STEPS):
        ahead, _ = derivatives_at(boundary, arclet, at)
        apart = points - points_at(boundary, arclet, at)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.sum(apart * ahead, axis=1) / np.sum(ahead * ahead, axis=1)
        at = np.clip(at + np.nan_to_num(step), 0.0, 1.0)
    ahead, _ = derivatives_at(boundary, arclet, at)
    return points - points_at(boundary, arclet, at), ahead
