"""Runs of parallels as few conic arcs: tangents kept, the deviation under a tolerance.

Each arc is taken as long as the tolerance allows, which makes as few as can be; it ends at the
latest where the curve bends to the other side, as a conic cannot.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.tables import ROUND, STRAIGHT, Joints
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.offsets.kernels.conic_arc import conic_arc, look, run_point
from splinesdf.offsets.tables import Runs

# An arc is measured at so many times as many points before it is taken.
_FINER = 4
# Straight and round runs are cut to arcs of at most a quarter of a circle.
_QUARTER = 0.5 * math.pi + 1e-6
# Parts of an element whose bending is compared to find where it changes sides, and how much of a
# turn over the element's length counts as bending.
_PARTS, _BENDS = 8, 1e-9
# The next length that is tried as a share of one that fits; of one that does not when looked at
# closely; and how near to the longest an arc is long enough.
_GROWTH, _SHRINK, _NEAR = 1.7, 0.95, 0.03
# What a length is aimed at, and what is enough, as shares of the deviation allowed: the fifth root
# of the latter is within 5 % of the longest.
_AIM, _ENOUGH = 0.9, 0.8
# Points of one arc that are looked at, at most.
_ROOM = 4096
# No arc is shorter than this share of an element.
_SHORTEST = 1e-6
# What reaches no farther than this share of the tolerance is no reason to end an arc, whatever its
# directions: so small, they are rounding. Larger: tangents jump where a chord takes its place;
# smaller: next to ends that stand still, stubs by the thousand.
_LITTLE = 0.03
# Points of an element that are looked at for that.
_LOOKED = 6
# Arcs of all runs: a tolerance that takes more is below what anybody has a use for. More: memory.
MOST_ARCS = 2_000_000


@kernel
def fit_runs(
    joints: Joints,
    runs: Runs,
    distance: float,
    tolerance: Floats,
    arcs: Floats,
    weights: Floats,
    owner: Ints,
) -> int:
    """Fill the arcs of all runs, in order; how many there are, even if there is no room for all.

    It ends early once there are more than `MOST_ARCS`.

    Parameters
    ----------
    tolerance : ndarray, shape (n_runs,)
    arcs : ndarray, shape (room, 3, 2)
        Filled, relative to the origin of the boundary.
    weights : ndarray, shape (room,)
        Filled.
    owner : ndarray, shape (room,)
        Filled: the run.
    """
    total = 0
    breaks = np.empty(_PARTS * 64 + 8)
    for r in range(runs.first.shape[0] - 1):
        begin, end = runs.first[r], runs.first[r + 1]
        kind = runs.kind[r]
        if kind == STRAIGHT:
            total = _straight(runs, r, arcs, weights, owner, total)
        elif kind == ROUND:
            total = _round(runs, r, arcs, weights, owner, total)
        else:
            if _PARTS * (end - begin) + 8 > breaks.shape[0]:
                breaks = np.empty(2 * _PARTS * (end - begin) + 8)
            count = _find_breaks(joints, runs, (begin, end), distance, breaks)
            total = _free(
                joints,
                runs,
                (r, count),
                (distance, tolerance[r]),
                breaks,
                (arcs, weights, owner),
                total,
            )
    return total


@uncounted
def _append(
    one: tuple[float, float, float, float, float, float, float],
    r: int,
    arcs: Floats,
    weights: Floats,
    owner: Ints,
    total: int,
) -> int:
    if total < weights.shape[0]:
        arcs[total, 0, 0], arcs[total, 0, 1] = one[0], one[1]
        arcs[total, 1, 0], arcs[total, 1, 1] = one[2], one[3]
        arcs[total, 2, 0], arcs[total, 2, 1] = one[4], one[5]
        weights[total] = one[6]
        owner[total] = r
    return total + 1


@uncounted
def _straight(runs: Runs, r: int, arcs: Floats, weights: Floats, owner: Ints, total: int) -> int:
    ax, ay = runs.start[runs.first[r], 0], runs.start[runs.first[r], 1]
    last = runs.first[r + 1] - 1
    bx, by = runs.end[last, 0], runs.end[last, 1]
    one = (ax, ay, 0.5 * (ax + bx), 0.5 * (ay + by), bx, by, 1.0)
    return _append(one, r, arcs, weights, owner, total)


@uncounted
def _round(runs: Runs, r: int, arcs: Floats, weights: Floats, owner: Ints, total: int) -> int:
    """Arcs of a circle, equal ones; both ends of the run are kept to the bit."""
    first, last = runs.first[r], runs.first[r + 1] - 1
    x, y = runs.center[r, 0], runs.center[r, 1]
    sweep = runs.sweep[r]
    ax, ay = runs.start[first, 0], runs.start[first, 1]
    ex, ey = runs.end[last, 0], runs.end[last, 1]
    radius = 0.5 * (math.hypot(ax - x, ay - y) + math.hypot(ex - x, ey - y))
    began = math.atan2(ay - y, ax - x)
    # Tangents say how often it goes round; where it ends, the end itself.
    ended = math.atan2(ey - y, ex - x)
    sweep = ended - began + 2.0 * math.pi * round((sweep - ended + began) / (2.0 * math.pi))
    count = max(1, math.ceil(abs(sweep) / _QUARTER))
    half = 0.5 * sweep / count
    weight = math.cos(half)
    for k in range(count):
        angle = began + sweep * (k + 1) / count
        bx, by = x + radius * math.cos(angle), y + radius * math.sin(angle)
        if k == count - 1:
            bx, by = ex, ey
        angle -= half
        mx, my = x + radius / weight * math.cos(angle), y + radius / weight * math.sin(angle)
        total = _append((ax, ay, mx, my, bx, by, weight), r, arcs, weights, owner, total)
        ax, ay = bx, by
    return total


@uncounted
def _find_breaks(
    joints: Joints,
    runs: Runs,
    span: tuple[int, int],
    distance: float,
    breaks: Floats,
) -> int:
    """Fill where a run must be cut, its ends included: where it bends to the other side."""
    begin, end = span
    breaks[0] = 0.0
    count = 1
    side = 0.0
    last = 0.0
    for k in range(end - begin):
        for part in range(_PARTS + 1):
            place = k + part / _PARTS if part < _PARTS else k + 1.0
            # just before a joint and just behind it
            inside = place if part > 0 else k + 1e-9
            point = run_point(joints, runs, begin, inside, distance)
            now = point[5]
            if not abs(now) * abs(point[4]) > _BENDS:
                continue
            if now * side < 0.0:
                a, b = last, inside
                for _ in range(60):
                    middle = 0.5 * (a + b)
                    if middle in (a, b):
                        break
                    if run_point(joints, runs, begin, middle, distance)[5] * side > 0.0:
                        a = middle
                    else:
                        b = middle
                # not at a hair's breadth from a joint
                nearest = float(round(b))
                breaks[count] = nearest if abs(b - nearest) < 1e-8 else b
                if breaks[count] > breaks[count - 1] and breaks[count] < end - begin:
                    count += 1
            side, last = now, inside
    breaks[count] = float(end - begin)
    return count + 1


@kernel
def _free(
    joints: Joints,
    runs: Runs,
    run: tuple[int, int],
    asked: tuple[float, float],
    breaks: Floats,
    found: tuple[Floats, Floats, Ints],
    total: int,
) -> int:
    """Append as few arcs as can be between the breaks of a run."""
    r, count = run
    distance = asked[0]
    arcs, weights, owner = found
    begin = runs.first[r]
    step = 1.0
    points = np.empty((_ROOM, 2))
    node = _node(joints, runs, r, 0.0, distance)
    for b in range(count - 1):
        place, limit = breaks[b], breaks[b + 1]
        while place < limit and total <= MOST_ARCS:
            at = _farthest(joints, runs, r, (place, limit, step), node, asked, points)
            while True:
                other = _node(joints, runs, r, at, distance)
                off, px, py, w = conic_arc(
                    joints, runs, (begin, place, at), (node, other), asked, _FINER, points
                )
                if off <= 1.0:
                    break
                if _is_little(joints, runs, (begin, place, at), node, asked):
                    px, py, w = 0.5 * (node[0] + other[0]), 0.5 * (node[1] + other[1]), 1.0
                    break
                if at - place < _SHORTEST:
                    # Directions are rounding here, as next to a cusp: a chord has to do.
                    at = _chord(joints, runs, r, (place, limit), node, asked, points)
                    other = _node(joints, runs, r, at, distance)
                    px, py, w = 0.5 * (node[0] + other[0]), 0.5 * (node[1] + other[1]), 1.0
                    break
                at = place + _SHRINK * (at - place)
            one = (node[0], node[1], px, py, other[0], other[1], w)
            total = _append(one, r, arcs, weights, owner, total)
            step = at - place
            place, node = at, other
    return total


@uncounted
def _chord(
    joints: Joints,
    runs: Runs,
    r: int,
    span: tuple[float, float],
    node: tuple[float, float, float, float],
    asked: tuple[float, float],
    points: Floats,
) -> float:
    """How far a straight line from a place may go, at most to a limit, whatever its direction."""
    place, limit = span
    begin = runs.first[r]
    length = limit - place
    while True:
        at = limit if length == limit - place else place + length
        x, y, _, _ = _node(joints, runs, r, at, asked[0])
        cx, cy = x - node[0], y - node[1]
        chord = math.hypot(cx, cy)
        start = node[0], node[1]
        worst = 0.0
        count = look(
            joints,
            runs,
            (begin, place, at),
            start,
            asked[0],
            1,
            max(chord, asked[1]),
            points,
        )
        for k in range(count):
            px, py = points[k, 0] - node[0], points[k, 1] - node[1]
            share = (px * cx + py * cy) / (chord * chord) if chord > 0.0 else 0.0
            share = min(max(share, 0.0), 1.0)
            worst = max(worst, math.hypot(px - share * cx, py - share * cy))
        if (count > 0 and worst <= 0.5 * asked[1]) or place + 0.5 * length <= place:
            return at
        length = 0.5 * length


@uncounted
def _farthest(
    joints: Joints,
    runs: Runs,
    r: int,
    span: tuple[float, float, float],
    node: tuple[float, float, float, float],
    asked: tuple[float, float],
    points: Floats,
) -> float:
    """About how far one arc from a place can go, at most to a limit; a first step is given."""
    place, limit, step = span
    begin = runs.first[r]
    low, high = 0.0, np.inf
    # not to leave a little piece before the limit
    length = limit - place if limit - place < 1.3 * step else step
    while True:
        at = limit if place + length >= limit else place + length
        other = _node(joints, runs, r, at, asked[0])
        off, _, _, _ = conic_arc(joints, runs, (begin, place, at), (node, other), asked, 1, points)
        if off <= 1.0:
            low = length
            if at == limit:
                return limit
            if off > _ENOUGH:
                return at
        elif _is_little(joints, runs, (begin, place, at), node, asked):
            low = length
            if at == limit:
                return limit
        else:
            high = length
        if high < _SHORTEST:
            return min(place + _SHORTEST, limit)
        if high - low < _NEAR * low:
            return place + low
        # The error grows with the fifth power of the length.
        length *= min(max((_AIM / max(off, 1e-9)) ** 0.2, 0.3), _GROWTH)
        if not low < length < high:
            length = _GROWTH * low if high == np.inf else 0.5 * (low + high)


@uncounted
def _is_little(
    joints: Joints,
    runs: Runs,
    span: tuple[int, float, float],
    node: tuple[float, float, float, float],
    asked: tuple[float, float],
) -> bool:
    """Whether a part of a run stays within a share of the tolerance about its start."""
    begin, place, end = span
    count = _LOOKED * (math.ceil(end) - int(place))
    for k in range(count, 0, -1):
        at = place + (end - place) * k / count
        row = run_point(joints, runs, begin, at, asked[0])
        if math.hypot(row[0] - node[0], row[1] - node[1]) > _LITTLE * asked[1]:
            return False
    return True


@uncounted
def _node(
    joints: Joints, runs: Runs, r: int, place: float, distance: float
) -> tuple[float, float, float, float]:
    """Point and tangent where an arc may end; the run's own ends to the bit."""
    begin, end = runs.first[r], runs.first[r + 1]
    x, y, tx, ty, _, _ = run_point(joints, runs, begin, place, distance)
    if place == 0.0:
        x, y = runs.start[begin, 0], runs.start[begin, 1]
    elif place == end - begin:
        x, y = runs.end[end - 1, 0], runs.end[end - 1, 1]
        if runs.closed[r]:
            _, _, tx, ty, _, _ = run_point(joints, runs, begin, 0.0, distance)
    return x, y, tx, ty
