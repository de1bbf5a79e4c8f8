"""Runs of parallels as few conic arcs: tangents kept, the deviation under a tolerance.

A conic with given ends and tangents has one number left, the weight of its middle control point;
with the curve's point nearest to that control point, it is determined:

    q = a P0 + b P1 + c P2, a + b + c = 1   lies on it if   b^2 = 4 w^2 a c

and any other point is off it by about |b^2 - 4 w^2 a c| over the length of that function's
gradient. The error falls with the fifth power of the length. Each arc is taken as long as the
tolerance allows, which makes as few as can be; it ends at the latest where the curve bends to the
other side, as a conic cannot.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf._arrays import Floats, Ints
from splinesdf._jit import kernel
from splinesdf._tables import Arclets, Joints, Runs
from splinesdf.kernels.parallels import parallel_point

# An arc turns by no more than this (radians). Larger: weights near zero, control points far off.
_TURN = 1.9
# Straight and round runs are cut to arcs of at most a quarter of a circle.
_QUARTER = 0.5 * math.pi + 1e-9
# Points of the curve at which an arc is measured, at least this many, and on each element; and how
# many times as many before it is taken.
_POINTS, _POINTS_EACH = 10, 3
_FINER = 4
# The longest step between them, as a share of the chord.
_STRIDE = 0.15
# Between those points the error may be this much larger.
_SAFE = 0.9
# Where a run bends by less than this (radians) from end to end it is straight: rounding decides
# where its tangents meet.
_FLAT = 1e-11
# Parts of an element whose bending is compared to find where it changes sides, and how much of a
# turn over the element's length counts as bending.
_PARTS, _BENDS = 8, 1e-9
# The next length that is tried as a share of one that fits; of one that does not when looked at
# closely; and how near to the longest an arc is long enough.
_GROWTH, _SHRINK, _NEAR = 1.7, 0.95, 0.03
# No arc is shorter than this share of an element.
_SHORTEST = 1e-6


@kernel
def fit_runs(
    arclets: Arclets,
    joints: Joints,
    runs: Runs,
    distance: float,
    tolerance: Floats,
    arcs: Floats,
    weights: Floats,
    owner: Ints,
) -> int:
    """Fill the arcs of all runs, in order; how many there are, even if there is no room for all.

    Parameters
    ----------
    tolerance : ndarray, shape (n_runs,)
    arcs : ndarray, shape (room, 3, 2)
        Filled, relative to the origin of the arclets.
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
        if kind == 1:
            total = _straight(runs, r, arcs, weights, owner, total)
        elif kind == 2:
            total = _round(runs, r, arcs, weights, owner, total)
        else:
            if _PARTS * (end - begin) + 8 > breaks.shape[0]:
                breaks = np.empty(2 * _PARTS * (end - begin) + 8)
            count = _find_breaks(arclets, joints, runs, (begin, end), distance, breaks)
            total = _free(
                arclets,
                joints,
                runs,
                (r, count),
                (distance, tolerance[r]),
                breaks,
                (arcs, weights, owner),
                total,
            )
    return total


@kernel
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


@kernel
def _straight(runs: Runs, r: int, arcs: Floats, weights: Floats, owner: Ints, total: int) -> int:
    ax, ay = runs.start[runs.first[r], 0], runs.start[runs.first[r], 1]
    last = runs.first[r + 1] - 1
    bx, by = runs.end[last, 0], runs.end[last, 1]
    one = (ax, ay, 0.5 * (ax + bx), 0.5 * (ay + by), bx, by, 1.0)
    return _append(one, r, arcs, weights, owner, total)


@kernel
def _round(runs: Runs, r: int, arcs: Floats, weights: Floats, owner: Ints, total: int) -> int:
    """Arcs of a circle, equal ones; both ends of the run are kept to the bit."""
    first, last = runs.first[r], runs.first[r + 1] - 1
    x, y = runs.center[r, 0], runs.center[r, 1]
    sweep = runs.sweep[r]
    ax, ay = runs.start[first, 0], runs.start[first, 1]
    ex, ey = runs.end[last, 0], runs.end[last, 1]
    radius = 0.5 * (math.hypot(ax - x, ay - y) + math.hypot(ex - x, ey - y))
    count = max(1, int(math.ceil(abs(sweep) / _QUARTER)))
    began = math.atan2(ay - y, ax - x)
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


@kernel
def _at(
    arclets: Arclets, joints: Joints, runs: Runs, begin: int, place: float, distance: float
) -> tuple[float, float, float, float, float, float]:
    """Point, tangent, speed and bend of a run at element + share of its span."""
    k = int(place)
    share = place - k
    k += begin
    if k >= runs.spans.shape[0] or (share == 0.0 and k > begin and place == int(place)):
        # The end of the element before it: joints are smooth.
        k, share = k - 1, 1.0
    low, high = runs.spans[k, 0], runs.spans[k, 1]
    t = high if share == 1.0 else low + share * (high - low)
    element = (runs.elements[k, 0], runs.elements[k, 1])
    x, y, tx, ty, speed, bend = parallel_point(arclets.arcs, joints, element, t, distance)
    return x, y, tx, ty, speed * (high - low), bend


@kernel
def _find_breaks(
    arclets: Arclets,
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
            point = _at(arclets, joints, runs, begin, inside, distance)
            now = point[5]
            if not abs(now) * abs(point[4]) > _BENDS:
                continue
            if now * side < 0.0:
                a, b = last, inside
                for _ in range(60):
                    middle = 0.5 * (a + b)
                    if middle == a or middle == b:
                        break
                    if _at(arclets, joints, runs, begin, middle, distance)[5] * side > 0.0:
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
    arclets: Arclets,
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
    node = _node(arclets, joints, runs, r, 0.0, distance)
    for b in range(count - 1):
        place, limit = breaks[b], breaks[b + 1]
        while place < limit:
            at = _farthest(arclets, joints, runs, r, (place, limit, step), node, asked)
            while True:
                other = _node(arclets, joints, runs, r, at, distance)
                fits, px, py, w = _conic(
                    arclets, joints, runs, begin, (place, at), node, other, asked, _FINER
                )
                if fits:
                    break
                if at - place < _SHORTEST:
                    # Rounding is all that is left to fit.
                    px, py, w = 0.5 * (node[0] + other[0]), 0.5 * (node[1] + other[1]), 1.0
                    break
                at = place + _SHRINK * (at - place)
            one = (node[0], node[1], px, py, other[0], other[1], w)
            total = _append(one, r, arcs, weights, owner, total)
            step = at - place
            place, node = at, other
    return total


@kernel
def _farthest(
    arclets: Arclets,
    joints: Joints,
    runs: Runs,
    r: int,
    span: tuple[float, float, float],
    node: tuple[float, float, float, float],
    asked: tuple[float, float],
) -> float:
    """About how far one arc from a place can go, at most to a limit; a first step is given."""
    place, limit, step = span
    begin = runs.first[r]
    low, high = 0.0, np.inf
    # not to leave a little piece before the limit
    length = limit - place if limit - place < 1.3 * step else step
    while True:
        at = limit if place + length >= limit else place + length
        other = _node(arclets, joints, runs, r, at, asked[0])
        fits, _, _, _ = _conic(arclets, joints, runs, begin, (place, at), node, other, asked, 1)
        if fits:
            low = length
            if at == limit:
                return limit
        else:
            high = length
        if high < _SHORTEST:
            return min(place + _SHORTEST, limit)
        if high - low < _NEAR * low:
            return place + low
        if high == np.inf:
            length = _GROWTH * low
        else:
            length = 0.5 * (low + high)


@kernel
def _node(
    arclets: Arclets, joints: Joints, runs: Runs, r: int, place: float, distance: float
) -> tuple[float, float, float, float]:
    """Point and tangent where an arc may end; the run's own ends to the bit."""
    begin, end = runs.first[r], runs.first[r + 1]
    x, y, tx, ty, _, _ = _at(arclets, joints, runs, begin, place, distance)
    if place == 0.0:
        x, y = runs.start[begin, 0], runs.start[begin, 1]
    elif place == end - begin:
        x, y = runs.end[end - 1, 0], runs.end[end - 1, 1]
        if runs.closed[r]:
            _, _, tx, ty, _, _ = _at(arclets, joints, runs, begin, 0.0, distance)
    return x, y, tx, ty


@kernel
def _conic(
    arclets: Arclets,
    joints: Joints,
    runs: Runs,
    begin: int,
    span: tuple[float, float],
    node: tuple[float, float, float, float],
    other: tuple[float, float, float, float],
    asked: tuple[float, float],
    finer: int,
) -> tuple[bool, float, float, float]:
    """Whether one conic does for a part of a run; its middle control point and weight."""
    distance, tolerance = asked
    ax, ay, ux, uy = node
    bx, by, vx, vy = other
    cx, cy = bx - ax, by - ay
    cross, dot = ux * vy - uy * vx, ux * vx + uy * vy
    turn = math.atan2(cross, dot)
    if abs(turn) > _TURN:
        return False, 0.0, 0.0, 0.0
    low, high = span
    each = int(math.ceil(high)) - int(low)
    count = finer * max(_POINTS, _POINTS_EACH * each)
    # Where a short arclet turns fast its parallel is long: steps are bounded along that, too.
    chord = math.sqrt(cx * cx + cy * cy)
    longest = _STRIDE * chord / finer
    limit = _SAFE * tolerance
    if abs(turn) <= _FLAT:
        if not (chord > 0.0 and abs(cx * uy - cy * ux) <= limit):
            return False, 0.0, 0.0, 0.0
        place, x, y = low, ax, ay
        while place < high:
            place, x, y = _stride(
                arclets,
                joints,
                runs,
                begin,
                (place, high),
                (x, y),
                (high - low) / count,
                longest,
                distance,
            )
            if abs((x - ax) * cy - (y - ay) * cx) > limit * chord:
                return False, 0.0, 0.0, 0.0
        return True, 0.5 * (ax + bx), 0.5 * (ay + by), 1.0
    early, late = (cx * vy - cy * vx) / cross, (ux * cy - uy * cx) / cross
    if not (early > 0.0 and late > 0.0):
        return False, 0.0, 0.0, 0.0
    px, py = ax + early * ux, ay + early * uy
    triangle = (ax, ay, px - ax, py - ay, cx, cy)
    # The weight, by the point that is nearest to P1.
    most = square = 0.0
    place, x, y = low, ax, ay
    while place < high:
        place, x, y = _stride(
            arclets,
            joints,
            runs,
            begin,
            (place, high),
            (x, y),
            (high - low) / count,
            longest,
            distance,
        )
        a, b, c = _barycentric(triangle, x, y)
        if b > most and a > 0.0 and c > 0.0:
            most = b
            square = b * b / (4.0 * a * c)
    if not square > 0.0:
        return False, 0.0, 0.0, 0.0
    place, x, y = low, ax, ay
    while place < high:
        place, x, y = _stride(
            arclets,
            joints,
            runs,
            begin,
            (place, high),
            (x, y),
            (high - low) / count,
            longest,
            distance,
        )
        if place < high and not _off(triangle, square, x, y) <= limit:
            return False, 0.0, 0.0, 0.0
    return True, px, py, math.sqrt(square)


@kernel
def _stride(
    arclets: Arclets,
    joints: Joints,
    runs: Runs,
    begin: int,
    span: tuple[float, float],
    point: tuple[float, float],
    step: float,
    longest: float,
    distance: float,
) -> tuple[float, float, float]:
    """The next place at which a run is looked at, and its point."""
    place, high = span
    x, y = point
    while True:
        at = min(place + step, high)
        if high - at < 0.01 * step:
            at = high
        row = _at(arclets, joints, runs, begin, at, distance)
        if math.hypot(row[0] - x, row[1] - y) <= longest or place + 0.5 * step <= place:
            return at, row[0], row[1]
        step = 0.5 * step


@kernel
def _barycentric(
    triangle: tuple[float, float, float, float, float, float], x: float, y: float
) -> tuple[float, float, float]:
    """The shares a, b, c of P0, P1, P2 in a point; a triangle is P0, P1 - P0, P2 - P0."""
    ax, ay, ex, ey, cx, cy = triangle
    area = ex * cy - ey * cx
    qx, qy = x - ax, y - ay
    b = (qx * cy - qy * cx) / area
    c = (ex * qy - ey * qx) / area
    return 1.0 - b - c, b, c


@kernel
def _off(
    triangle: tuple[float, float, float, float, float, float], square: float, x: float, y: float
) -> float:
    """The distance of a point from a conic, by two steps of Newton's method toward it."""
    _, _, ex, ey, cx, cy = triangle
    area = ex * cy - ey * cx
    result = 0.0
    for _ in range(2):
        a, b, c = _barycentric(triangle, x, y)
        value = b * b - 4.0 * square * a * c
        gx = (2.0 * b * cy - 4.0 * square * (c * (ey - cy) - a * ey)) / area
        gy = (4.0 * square * (c * (ex - cx) - a * ex) - 2.0 * b * cx) / area
        squared = gx * gx + gy * gy
        x -= value * gx / squared
        y -= value * gy / squared
        result += abs(value) / math.sqrt(squared)
    return result
