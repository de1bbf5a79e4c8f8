"""Chains of arclets that are nearest on a disk, or points for them, and the distance to each.

Used by `enclosure`; equation numbers are those of docs/theory/certificate.md.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.arclet import derivatives
from splinesdf.arclets.thresholds import CUSP, SMOOTH
from splinesdf.distance.tables import Bent
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import uncounted

# Chains that a triangle may see: beyond it, it is halved.
_CHAINS = 6
# Nearer to a focal point than this (as 1 + kappa u) remainders are too large to be of use.
_FOCAL = 1e-3
# The largest product of three numbers a b^2 with a^2 + b^2 = 1, times three.
_MIXED = 1.1547005383792517
_BEFORE, _START, _END, _AFTER = 1, 2, 4, 8


@uncounted
def side_of(bent: Bent, ids: Ints, count: int, near: Floats, nearest: float, grain: float) -> int:
    """-1 inside, 1 outside, by the arclets in which p has a foot; 0 if they do not agree."""
    side = 0
    for j in range(count):
        if near[j, 0] > nearest * (1.0 + 1e-9) + grain:
            continue
        tx, ty = near[j, 5], near[j, 6]
        # In a corner the side is that of the sum of both normals.
        other = -1
        if near[j, 1] == 0.0:
            other = bent.previous[ids[j]]
            if _place(ids, count, other) >= 0:
                tx, ty = tx + bent.rows[other, 7], ty + bent.rows[other, 8]
        elif near[j, 1] == 1.0:
            for k in range(count):
                if bent.previous[ids[k]] == ids[j]:
                    tx, ty = tx + bent.rows[ids[k], 5], ty + bent.rows[ids[k], 6]
        across = near[j, 2] * ty - near[j, 3] * tx
        here = 1 if across > 1e-9 * near[j, 0] else (-1 if across < -1e-9 * near[j, 0] else 0)
        if here == 0 or (side != 0 and here != side):
            return 0
        side = here
    return side


@uncounted
def _joint(rows: Floats, before: int, after: int, vx: float, vy: float, r: float) -> int:
    """How arclets meet, v leading from p to where: 1 smoothly, 2 in a corner seen from outside.

    0 if for some point of the disk both may have a foot (2.5).
    """
    tx = rows[after, 5] - rows[before, 7]
    ty = rows[after, 6] - rows[before, 8]
    turn = math.sqrt(tx * tx + ty * ty)
    if turn <= SMOOTH:
        return 1
    return 2 if vx * tx + vy * ty >= r * turn else 0


@uncounted
def find_branches(
    bent: Bent,
    ids: Ints,
    count: int,
    disk: tuple[float, float, float],
    near: Floats,
    models: Floats,
) -> int:
    """Fill a model of the distance for each chain; how many, 0 if there is no such structure.

    A row of ``models``: the distance to the chain with its own sign, its gradient, its second
    derivative along the level set, the remainder's bound (2.9), and 1 if points of the disk can
    have their foot in the chain's first or last point.
    """
    arcs, following = bent.arcs, bent.following
    rows, before = bent.rows, bent.previous
    px, py, r = disk
    chains = 0
    for j in range(count):
        previous = _place(ids, count, before[ids[j]])
        if previous >= 0:
            vx, vy = arcs[ids[j], 3] - px, arcs[ids[j], 4] - py
            if _joint(rows, ids[previous], ids[j], vx, vy, r) > 0:
                continue
        # j is the first arclet of a chain.
        last, foot = j, j
        while True:
            after = _place(ids, count, following[ids[last]])
            if after < 0 or after == j:
                break
            vx, vy = arcs[ids[after], 3] - px, arcs[ids[after], 4] - py
            if _joint(rows, ids[last], ids[after], vx, vy, r) == 0:
                break
            last = after
            if near[last, 0] < near[foot, 0]:
                foot = last
        # All feet in its first or last point: another chain is no farther (2.6).
        if int(near[j, 7]) & _BEFORE or int(near[last, 7]) & _AFTER:
            continue
        if chains == _CHAINS:
            return 0
        if not _branch_model(bent, ids, count, (j, last, foot), disk, near, models[chains]):
            return 0
        chains += 1
    return chains


@uncounted
def _branch_model(
    bent: Bent,
    ids: Ints,
    count: int,
    chain: tuple[int, int, int],
    disk: tuple[float, float, float],
    near: Floats,
    model: Floats,
) -> bool:
    """Fill the model of one chain; False if its distance is not smooth on the disk.

    The chain is given by the places of its first and last arclet and of that with p's foot.
    """
    arcs, following, rows = bent.arcs, bent.following, bent.rows
    first, last, foot = chain
    px, py, r = disk
    # Ranges of the curvature and of its change, jumps of both where arclets meet smoothly, and
    # how near the corners and ends are in which there can be feet.
    low, high, slope, jumps, kinks = near[foot, 4], near[foot, 4], 0.0, 0.0, 0.0
    away, cones = np.inf, 0
    ended = False
    j = first
    while True:
        row = rows[ids[j]]
        flags = int(near[j, 7])
        if not flags & (_BEFORE | _AFTER):
            low, high, slope = min(low, row[0]), max(high, row[1]), max(slope, row[2])
        for side in range(2):
            if side == 0 and (j != first or not flags & _START):
                continue
            if side == 1 and not flags & _END:
                continue
            vx = arcs[ids[j], 3 - 2 * side] - px
            vy = arcs[ids[j], 4 - 2 * side] - py
            joined = 0
            if side == 1 and j != last:
                after = _place(ids, count, following[ids[j]])
                if not int(near[after, 7]) & _START:
                    continue
                joined = _joint(rows, ids[j], ids[after], vx, vy, r)
                other = rows[ids[after]]
                low, high = min(low, other[3]), max(high, other[3])
                if joined == 1:
                    jumps += abs(row[4] - other[3])
                    kinks += math.sqrt((other[5] - row[7]) ** 2 + (other[6] - row[8]) ** 2)
            low, high = min(low, row[3 + side]), max(high, row[3 + side])
            if joined != 1:
                away = min(away, math.sqrt(vx * vx + vy * vy) - r)
                cones += 2 if joined == 2 else 1
                ended = ended or joined == 0
        if j == last:
            break
        j = _place(ids, count, following[ids[j]])
    if not (away > 1e-3 * r and high - low < np.inf):
        return False
    u, gx, gy, k, sided = _at_foot(bent, ids, chain, near)
    ended = ended or not sided
    if cones == 0:
        # Feet move by no more than 2 r / (1 + kappa u) along the curve, if that is not halved on
        # the way (2.9).
        here = 1.0 + near[foot, 4] * u
        change = 2.0 * r / here * slope + jumps
        near_low, near_high = max(low, near[foot, 4] - change), min(high, near[foot, 4] + change)
        if min(_bend(near_low, u, r), _bend(near_high, u, r)) >= 0.5 * here > 0.0:
            low, high = near_low, near_high
    least = min(_bend(low, u, r), _bend(high, u, r))
    if not least > _FOCAL:
        return False
    low_k = min(min(k, low / (1.0 + low * (u - r))), low / (1.0 + low * (u + r)))
    high_k = max(max(k, high / (1.0 + high * (u - r))), high / (1.0 + high * (u + r)))
    largest = max(high_k, -low_k)
    third = _MIXED * largest * largest + slope / (least * least * least)
    jumps /= least * least
    if cones > 0:
        third = max(third, _MIXED / (away * away))
        jumps += cones / (away * least)
        low_k, high_k = min(low_k, -1.0 / away), max(high_k, 1.0 / away)
        largest = max(high_k, -low_k)
    swing = max(high_k - k, k - low_k) + abs(k) * min(1.0, r * largest)
    rest = min(0.5 * r * r * swing, r * r * r / 6.0 * third + 0.5 * r * r * jumps)
    model[0], model[1], model[2], model[3] = u, gx, gy, k
    model[4] = rest + r * kinks / min(least, 1.0)
    model[5] = 1.0 if ended else 0.0
    return True


@uncounted
def _at_foot(
    bent: Bent, ids: Ints, chain: tuple[int, int, int], near: Floats
) -> tuple[float, float, float, float, bool]:
    """Distance to a chain, its gradient, its second derivative along the level set.

    And whether the distance has its sign: in a cusp, where the curve turns back, and at an end of
    the chain the side is not to be told from tangents; there it is positive.
    """
    first, last, foot = chain
    d, t, wx, wy = near[foot, 0], near[foot, 1], near[foot, 2], near[foot, 3]
    tx, ty = near[foot, 5], near[foot, 6]
    ahead = wx * tx + wy * ty
    if not ((t == 1.0 and ahead > SMOOTH * d) or (t == 0.0 and ahead < -SMOOTH * d)):
        u = wx * ty - wy * tx
        return u, ty, -tx, near[foot, 4] / (1.0 + near[foot, 4] * u), True
    turn = 0.0
    if t == 1.0 and foot != last:
        after = bent.rows[bent.following[ids[foot]]]
        turn = tx * after[6] - ty * after[5]
    elif t == 0.0 and foot != first:
        before = bent.rows[bent.previous[ids[foot]]]
        turn = before[7] * ty - before[8] * tx
    # A corner is seen from the side that the curve turns away from.
    u = -d if turn < -CUSP else d
    return u, wx / u, wy / u, 1.0 / u, abs(turn) > CUSP


@uncounted
def _bend(curvature: float, u: float, r: float) -> float:
    """The least of 1 + curvature times a distance that differs from u by r at most."""
    return 1.0 + curvature * u - abs(curvature) * r


@uncounted
def _place(ids: Ints, count: int, arclet: int) -> int:
    """Where in a list an arclet stands, -1 if it does not."""
    if arclet >= 0:
        for j in range(count):
            if ids[j] == arclet:
                return j
    return -1


@uncounted
def find_point_branches(
    bent: Bent,
    ids: Ints,
    count: int,
    disk: tuple[float, float, float],
    spare: float,
    near: Floats,
    models: Floats,
) -> int:
    """Fill models of the distances to points of the curve, one of which is nearly the closest.

    How many, 0 if it takes too many. The distance is smaller than the least of theirs by no more
    than ``spare`` (3.1).
    """
    px, py, r = disk
    nearest = np.inf
    total = 0
    for j in range(count):
        row = bent.rows[ids[j]]
        # From a point half a step away the distance is larger by half ^ 2 (1 / distance + bend) / 2
        # at most, and by half the step itself.
        parts = 0.5 * row[9] / spare
        lower = abs(near[j, 0]) - r
        if lower > 0.0:
            bend = 1.0 / lower + max(row[1], -row[0])
            parts = min(parts, 0.5 * row[9] * math.sqrt(0.5 * bend / spare))
        if not parts < models.shape[0]:
            return 0
        parts = math.ceil(parts)
        for n in range(parts + 1):
            x, y, _, _, _, _ = derivatives(bent.arcs, ids[j], n / parts)
            wx, wy = px - bent.arcs[ids[j], 3] - x, py - bent.arcs[ids[j], 4] - y
            d = math.sqrt(wx * wx + wy * wy)
            if d - nearest > 2.0 * r + spare:
                continue
            if total == models.shape[0] or d <= 1.001 * r:
                return 0
            nearest = min(nearest, d)
            model = models[total]
            model[0], model[1], model[2], model[3] = d, wx / d, wy / d, 1.0 / d
            model[4] = r * r * r / 6.0 * _MIXED / ((d - r) * (d - r))
            model[5] = 1.0
            total += 1
    kept = 0
    for m in range(total):
        if models[m, 0] - nearest <= 2.0 * r + spare:
            for e in range(6):
                models[kept, e] = models[m, e]
            kept += 1
    return kept
