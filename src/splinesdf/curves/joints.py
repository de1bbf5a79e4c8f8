"""Joints: how the arclets of a boundary follow one another, and how the curve turns there."""

from __future__ import annotations

import numpy as np

from splinesdf._arrays import Floats, Ints
from splinesdf._tables import Arclets, Joints
from splinesdf.curves.geometry import derivatives_at, points_at

# An arclet whose velocity at an end is below this share of its chord stands still there.
_STANDS = 1e-8
# Turns within this of half a turn (radians) are cusps: rounding decides on which side of the
# arriving branch the leaving one lies, so points of both are compared. Larger: corners that are
# merely sharp are looked at too, which does no harm.
_CUSP = 1e-3
# Where on the branches of a cusp they are compared, as shares of the shorter one.
_ON_BRANCHES = (1e-3, 1e-2, 0.1, 0.5)
# Steps to the nearest point of the other branch, from one that is nearly the nearest.
_STEPS = 5
# Branches that are no farther apart than this share of the largest coordinate are so by rounding.
_APART = 16 * 2.220446049250313e-16
# Where one piece of the shape was cut it does not turn; tangents of very short arclets differ by
# less than this (radians), for rounding. Larger: corners of nearly cusps might be taken for it.
_CUT = 1e-5


def joints(boundary: Arclets) -> Joints:
    """Loops, turns and tangents of a boundary; every arclet must lead to another."""
    order, loops = _loops(boundary.following)
    leaving, arriving = (
        vectors / np.hypot(vectors[:, 0], vectors[:, 1])[:, None]
        for vectors in _end_directions(boundary)
    )
    turn = _angle(arriving, leaving[boundary.following])
    cusps = np.flatnonzero(np.abs(turn) > np.pi - _CUSP)
    side = _side_of_cusps(boundary, cusps)
    turn[cusps] = np.copysign(turn[cusps], side)
    cut = boundary.interval[:, 1] == boundary.interval[boundary.following, 0]
    cut &= boundary.piece == boundary.piece[boundary.following]
    turn[cut & (np.abs(turn) < _CUT)] = 0.0
    chord = boundary.end - boundary.start
    early, late = _angle(leaving, chord), _angle(chord, arriving)
    turning = np.abs(early) + np.abs(late)
    for undecided in cusps[side == 0.0]:
        _close_up(turn, early + late, int(undecided), order, loops)
    return Joints(order, loops, turn, np.concatenate([leaving, arriving], axis=1), turning)


def _end_directions(boundary: Arclets) -> tuple[Floats, Floats]:
    """Directions at the start and at the end of every arclet, also where it stands still."""
    power = boundary.power
    chord = boundary.end - boundary.start
    steps = np.arange(1.0, power.shape[1])
    first, last = power[:, 1], np.einsum("k,nkc->nc", steps, power[:, 1:])
    if power.shape[1] < 3:
        return first, last
    bend = np.einsum("k,nkc->nc", steps * (steps - 1.0), power[:, 1:])
    result = []
    for velocity, other in ((first, power[:, 2]), (last, -bend)):
        # Rounding is left of a velocity that should vanish; the next derivative decides then.
        length = np.hypot(chord[:, 0], chord[:, 1])
        still = np.hypot(velocity[:, 0], velocity[:, 1]) <= _STANDS * length
        vector = np.where(still[:, None], other, velocity)
        still = np.hypot(vector[:, 0], vector[:, 1]) <= _STANDS * length
        result.append(np.where(still[:, None], chord, vector))
    return result[0], result[1]


def _loops(following: Ints) -> tuple[Ints, Ints]:
    """Arclets loop after loop, and where each loop starts."""
    count = len(following)
    # Mostly, the next one has the next number: only where it has not does the walk jump.
    order = np.empty(count, dtype=np.int64)
    seen = np.zeros(count, dtype=np.bool_)
    breaks = np.flatnonzero(following != np.arange(1, count + 1))
    starts = [0]
    filled = 0
    for first in [0, *(breaks[:-1] + 1).tolist()]:
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


def _angle(first: Floats, second: Floats) -> Floats:
    """How far to turn left from one direction to the other, (-pi, pi]."""
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return np.asarray(np.arctan2(cross, np.sum(first * second, axis=1)))


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
    """Positive where the tip points outward, negative where inward, 0 if that cannot be told: (n,).

    The inside is on the left of both branches: if the arriving one lies on the left of the leaving
    one, the inside is between them, and the tip points outward.
    """
    result = np.zeros(len(arclet))
    following = boundary.following[arclet]
    chords = [
        np.hypot(*(boundary.end[which] - boundary.start[which]).T) for which in (arclet, following)
    ]
    noise = _APART * float(np.abs(boundary.boxes[0]).max())
    for share in _ON_BRANCHES:
        length = share * np.minimum(*chords)
        before = points_at(boundary, arclet, 1.0 - length / chords[0])
        # The nearest point of the other branch: across from there is where the first one lies.
        at = length / chords[1]
        for _ in range(_STEPS):
            ahead, _ = derivatives_at(boundary, following, at)
            apart = before - points_at(boundary, following, at)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = np.sum(apart * ahead, axis=1) / np.sum(ahead * ahead, axis=1)
            at = np.clip(at + np.nan_to_num(step), 0.0, 1.0)
        ahead, _ = derivatives_at(boundary, following, at)
        apart = before - points_at(boundary, following, at)
        cross = ahead[:, 0] * apart[:, 1] - ahead[:, 1] * apart[:, 0]
        told = np.abs(cross) > noise * np.hypot(ahead[:, 0], ahead[:, 1])
        result = np.where((result == 0.0) & told, cross, result)
    return result
