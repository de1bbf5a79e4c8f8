"""Which parts of the parallel curves are the offset: those that nothing else is nearer to.

A point of the parallel at the distance d is on the offset if the open disk of radius |d| around it
is empty. For a stretch of it, of radius r around its middle p, that is decided at once for all
its points where possible, otherwise for its halves:

* something is nearer to p than |d| - r: nothing of the stretch is on the offset;
* an arclet is farther from p than |d| + r: it does not matter for this stretch;
* between, the arclet's distance along the stretch has the value e, the slope e' and, by the
  ranges of both curvatures, a second derivative in a known range. That proves it to stay beyond
  |d|, or to stay below, or to be monotone: then it passes |d| once, and where is found by
  iteration.

The arclet's own chain, as far as it turns by less than half a turn and neither has a corner
toward the offset nor bends by more than 1 / |d| toward it, cannot enter the disk (Schur's
theorem), so it is not looked at. Where a chain does bend by more, the parallel has turning points;
the stretches between them are also compared with the exact distance at their ends.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf._arrays import Bools, Floats, Ints
from splinesdf._jit import kernel
from splinesdf._tables import Arclets, Joints, Scratch, Trimming
from splinesdf.kernels.nearest import closest_on, room_to_search, search
from splinesdf.kernels.parallels import parallel_point

# How far a chain may turn (radians) and still be called the arclet's own. It must be below pi, by
# more than an arclet turns.
_OWN_TURN = 2.0
# Halvings of an arclet to separate where its parallel runs forward from where it runs backward.
# What is then undecided is 1/4096 of it next to a turning point, less than 1e-14 of the offset.
_TURNING = 12
# The parallel of an arclet is but a point, to rounding, if it is shorter by this factor, as that of
# a circle at its own radius.
_POINT = 1e-11
# An arclet that may bend without limit, next to a cusp, is taken in so many equal parts.
_CUSP_PARTS = 64
# A stretch whose reach is not small against |d| is halved rather than compared with more than a few
# arclets, as most of it will soon be seen to be no offset at all. More: time is spent on those;
# fewer: on stretches.
_COARSE, _FEW = 32.0, 24
# A joint that turns by half a turn within this (radians) is a cusp: branches so close may cross
# once more, so the offset is compared with the exact distance near them.
_CUSP = 1e-3
# Of each stretch between turning points, so many parts have their ends compared.
_COMPARED = 4
# A point this share of its distance beside the end of an arclet, or more, stays on that side where
# the second derivative of its distance is bounded, as it moves by less than half of its distance.
_BESIDE = 0.7
# Steps to where the offset is left. Bisection alone would need 53; the secants need about 8.
_STEPS = 80
# Stretches of one element that are looked at. Only where two boundaries are |d| apart to rounding
# over a length are there so many; from then on, stretches that reach no farther than a share of
# |d| count as their middles do.
_PATIENCE, _IMPATIENT = 5_000, 1e-5


@kernel
def own_chains(
    arclets: Arclets, joints: Joints, trimming: Trimming, bent: Bools, reach: Ints
) -> None:
    """Fill which arclets bend too much, and how far each one's own chain reaches.

    Parameters
    ----------
    bent : ndarray of bool, shape (n,)
        Filled, by arclet: whether its parallel may run backward somewhere.
    reach : ndarray, shape (n, 3)
        Filled, by place in ``joints.order``: how many of the following and how many of the
        preceding arclets belong to the chain; 1 if one of the chain is bent, else 0.
    """
    order, loops, turn = joints.order, joints.loops, joints.turn
    distance = trimming.distance
    for i in range(bent.shape[0]):
        low, high = trimming.bends[i, 0], trimming.bends[i, 1]
        # written so that infinite ranges and NaN count as bent
        bent[i] = not (1.0 + low * distance > 0.0 and 1.0 + high * distance > 0.0)
    for j in range(loops.shape[0] - 1):
        first, size = loops[j], loops[j + 1] - loops[j]
        for backward in range(2):
            count = 0
            total = 0.0
            for n in range(size):
                p = size - 1 - n if backward else n
                while count < size - 1:
                    # the last one in the chain, the next one, and the joint between them
                    if backward:
                        last = order[first + (p - count) % size]
                        other = order[first + (p - count - 1) % size]
                        angle = turn[other]
                    else:
                        last = order[first + (p + count) % size]
                        other = order[first + (p + count + 1) % size]
                        angle = turn[last]
                    if angle * distance < -trimming.smooth * abs(distance):
                        break
                    more = abs(angle) + joints.turning[other]
                    if count > 0 and total + more > _OWN_TURN:
                        break
                    total += more
                    count += 1
                reach[first + p, backward] = count
                if count > 0:
                    # what the first step of this chain was, the next one has behind it
                    other = (
                        order[first + (p - 1) % size] if backward else order[first + (p + 1) % size]
                    )
                    angle = turn[other] if backward else turn[order[first + p]]
                    total -= abs(angle) + joints.turning[other]
                    count -= 1
                    total = 0.0 if count == 0 else total
        for p in range(size):
            reach[first + p, 2] = 0
        # Whether a bent one is in the chain: distance to the nearest bent one on either side.
        for backward in range(2):
            since = 2 * size
            for n in range(2 * size):
                p = (2 * size - 1 - n if not backward else n) % size
                i, before = order[first + p], order[first + (p - 1) % size]
                cusp = max(abs(turn[i]), abs(turn[before])) > math.pi - _CUSP
                since = 0 if bent[i] or cusp else since + 1
                if since <= reach[first + p, backward]:
                    reach[first + p, 2] = 1


@kernel
def trim(
    arclets: Arclets,
    joints: Joints,
    trimming: Trimming,
    bent: Bools,
    reach: Ints,
    place: Ints,
    elements: Ints,
    spans: Floats,
) -> int:
    """Fill the stretches of parallels and arcs around corners that are the offset, in order.

    Parameters
    ----------
    bent, reach : ndarray
        From `own_chains`.
    place : ndarray, shape (n, 3)
        Of each arclet: its place in its loop, and the loop's first place and size.
    elements : ndarray, shape (room, 2)
        Filled: the arclet, and 1 for the arc around its end.
    spans : ndarray, shape (room, 2)
        Filled: the parameters where the stretch starts and ends.

    Returns
    -------
    int
        How many there are; if more than there is room for, only those are filled.
    """
    arcs = arclets.arcs
    order, loops, turn = joints.order, joints.loops, joints.turn
    distance = trimming.distance
    radius = abs(distance)
    scratch = room_to_search(arcs)
    near = np.empty(4 * arcs.shape[0] + 1024, dtype=np.int64)
    stack = np.empty((4096, 4))
    parts = np.empty((_CUSP_PARTS + 2**_TURNING, 2))
    total = 0
    for j in range(loops.shape[0] - 1):
        first, size = loops[j], loops[j + 1] - loops[j]
        for p in range(size):
            i = order[first + p]
            for corner in range(2):
                if corner and not turn[i] * distance > trimming.smooth * radius:
                    continue
                after = (p + 1) % size
                behind, ahead = reach[first + p, 1], reach[first + p, 0]
                compared = reach[first + p, 2] > 0
                if corner:
                    ahead = 1 + reach[first + after, 0]
                    compared = compared or reach[first + after, 2] > 0
                own = (first, p - behind, min(behind + ahead + 1, size))
                element = (i, corner)
                count = 1
                parts[0, 0], parts[0, 1] = 0.0, 1.0
                if not corner and bent[i]:
                    count = _forward(arcs, joints, trimming, element, parts)
                since = total
                for k in range(count):
                    total = _trim_stretch(
                        arclets,
                        joints,
                        trimming,
                        (element, (parts[k, 0], parts[k, 1]), own, compared),
                        place,
                        (near, stack, scratch),
                        (elements, spans),
                        (since, total),
                    )
    return total


@kernel
def _forward(
    arcs: Floats, joints: Joints, trimming: Trimming, element: tuple[int, int], parts: Floats
) -> int:
    """The parts of a bent arclet where its parallel runs forward, in order; how many."""
    i = element[0]
    distance = trimming.distance
    row = trimming.bends[i]
    if 1.0 + max(row[0] * distance, row[1] * distance) <= _POINT:
        return 0
    # Of 1 + kappa d with the parameter.
    change = abs(distance) * trimming.bends[i, 2] * trimming.bends[i, 9]
    count = 0
    if not change < np.inf:
        for k in range(_CUSP_PARTS):
            a, b = k / _CUSP_PARTS, (k + 1) / _CUSP_PARTS
            middle = parallel_point(arcs, joints, element, 0.5 * (a + b), distance)
            if middle[4] > 0.0:
                parts[count, 0], parts[count, 1] = a, b
                count += 1
        return count
    at, depth = 0, 0  # the part from at / 2^depth to (at + 1) / 2^depth
    while True:
        width = 1.0 / (1 << depth)
        a = at * width
        middle = parallel_point(arcs, joints, element, a + 0.5 * width, distance)
        # 1 / (1 + kappa d), from the curvature of the parallel
        bound = 0.5 * width * change
        # 1 + kappa d = 1 / (1 - d curvature)
        value = 1.0 / (1.0 - distance * middle[5]) if middle[5] < np.inf else 0.0
        decided = depth == _TURNING or abs(value) > bound
        if decided:
            if value > 0.0 and (depth < _TURNING or value > bound):
                parts[count, 0], parts[count, 1] = a, a + width
                count += 1
            while depth > 0 and at & 1:
                at >>= 1
                depth -= 1
            if depth == 0:
                return count
            at += 1
        else:
            at, depth = 2 * at, depth + 1


@kernel
def _trim_stretch(
    arclets: Arclets,
    joints: Joints,
    trimming: Trimming,
    stretch: tuple[tuple[int, int], tuple[float, float], tuple[int, int, int], bool],
    place: Ints,
    room: tuple[Ints, Floats, Scratch],
    found: tuple[Ints, Floats],
    counts: tuple[int, int],
) -> int:
    """Append what is left of one stretch, see `trim`; how many there are then."""
    element, (start, stop), own, compared = stretch
    near, stack, scratch = room
    since, total = counts
    arcs, tree = arclets.arcs, arclets.tree
    distance = trimming.distance
    radius, grain = abs(distance), trimming.grain
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = start, stop, -1.0, 0.0
    size, looked = 1, 0
    while size > 0:
        size -= 1
        a, b, base, number = (
            stack[size, 0],
            stack[size, 1],
            int(stack[size, 2]),
            int(stack[size, 3]),
        )
        looked += 1
        m = 0.5 * (a + b)
        middle = parallel_point(arcs, joints, element, m, distance)
        x, y = middle[0], middle[1]
        reach = 0.0
        for t in (a, b):
            end = parallel_point(arcs, joints, element, t, distance)
            reach = max(reach, math.sqrt((end[0] - x) ** 2 + (end[1] - y) ** 2))
        reach += grain
        if base < 0:
            scratch.nodes[0] = 0
            if radius > reach:
                _, hit, _ = search(tree, arcs, x, y, radius - reach, 1, -1, -1.0, scratch)
                if hit >= 0:
                    continue
            most = near.shape[0] // 2
            if _COARSE * reach > radius and size + 2 < stack.shape[0] and a < m < b:
                most = _FEW
            number = _gather(arclets, x, y, radius + reach, own, place, near, most, scratch)
            if number < 0:
                stack[size, 0], stack[size, 1], stack[size, 2] = m, b, -1.0
                stack[size + 1, 0], stack[size + 1, 1], stack[size + 1, 2] = a, m, -1.0
                size += 2
                continue
            base, top = 0, number
        else:
            top = base + number
        low, high, left, gone = _narrow(
            arclets, joints, trimming, (element, a, b, reach), (base, number, top), near, scratch
        )
        if gone:
            continue
        if left > 0:
            small = reach <= trimming.shortest or not a < m < b
            small = small or (looked > _PATIENCE and reach <= _IMPATIENT * radius)
            if not small and size + 2 < stack.shape[0] and top + left < near.shape[0]:
                if 2 * left > number:
                    # few have gone: the halves share the list as it was, which costs no room
                    left, top = number, base
                m = 0.5 * (low + high)
                stack[size, 0], stack[size, 1], stack[size, 2], stack[size, 3] = m, high, top, left
                stack[size + 1, 0], stack[size + 1, 1] = low, m
                stack[size + 1, 2], stack[size + 1, 3] = top, left
                size += 2
                continue
            if _is_near(arclets, x, y, radius - grain, scratch):
                continue
        if compared:
            total = _compare(
                arclets, joints, trimming, element, (low, high), scratch, found, since, total
            )
        else:
            total = _append(element, (low, high), found, since, total)
    return total


@kernel
def _gather(
    arclets: Arclets,
    x: float,
    y: float,
    farthest: float,
    own: tuple[int, int, int],
    place: Ints,
    near: Ints,
    most: int,
    scratch: Scratch,
) -> int:
    """List the arclets, but for the own chain, that may be nearer than ``farthest``.

    How many there are, or -1 if they are more than ``most``.
    """
    tree, nodes = arclets.tree, scratch.nodes
    first, begin, length = own
    count = 0
    nodes[0] = 0
    size = 1
    while size > 0:
        size -= 1
        node = nodes[size]
        wx, wy = x - tree[node, 0], y - tree[node, 1]
        dx, dy = tree[node, 2], tree[node, 3]
        share = min(max((wx * dx + wy * dy) * tree[node, 4], 0.0), 1.0)
        wx, wy = wx - share * dx, wy - share * dy
        if math.sqrt(wx * wx + wy * wy) - tree[node, 5] > farthest:
            continue
        lo, hi = int(tree[node, 6]), int(tree[node, 7])
        if hi - lo > 1:
            nodes[size] = node + 2 * ((lo + hi) // 2 - lo)
            nodes[size + 1] = node + 1
            size += 2
            continue
        if place[lo, 1] == first and (place[lo, 0] - begin) % place[lo, 2] < length:
            continue
        if count == most:
            return -1
        near[count] = lo
        count += 1
    return count


@kernel
def _narrow(
    arclets: Arclets,
    joints: Joints,
    trimming: Trimming,
    stretch: tuple[tuple[int, int], float, float, float],
    listed: tuple[int, int, int],
    near: Ints,
    scratch: Scratch,
) -> tuple[float, float, int, bool]:
    """Cut off what some arclet is surely nearer to; list those of which nothing is proved.

    Returns
    -------
    low, high : float
        What is left of the stretch as far as is known.
    left : int
        How many arclets are not done with; they stand in ``near`` from ``listed[2]`` on.
    gone : bool
        Nothing is left.
    """
    element, a, b, reach = stretch
    base, number, top = listed
    arcs = arclets.arcs
    distance = trimming.distance
    radius, grain = abs(distance), trimming.grain
    m = 0.5 * (a + b)
    x, y, tx, ty, _, bend = parallel_point(arcs, joints, element, m, distance)
    low, high = a, b
    left = 0
    # A stretch that turns by at most half a turn is at most this much longer than its chords.
    length = 1.12 * reach
    least, most = _bend_range(trimming, element, bend, b - a)
    for k in range(number):
        j = near[base + k]
        squared, t = closest_on(arcs, j, x, y, (radius + reach) ** 2, scratch)
        far = math.sqrt(squared)
        if not far < radius + reach:
            continue
        if far + reach <= radius:
            return a, b, 0, True
        px, py = _point_of(arcs, j, t)
        gx, gy = (x - px) / far, (y - py) / far
        gap, slope = far - radius - grain, gx * tx + gy * ty
        under, over, slack = _second_range(
            trimming.bends[j], (far, gx, gy, t), (tx, ty, least, most), length
        )
        if gap + abs(slope) * length + 0.5 * max(over, 0.0) * length * length <= 0.0:
            return a, b, 0, True
        steepest = abs(slope) + slack
        lowest = gap - steepest * length + 0.5 * min(under, 0.0) * length * length
        if under > 0.0 and steepest < under * length:
            lowest = gap - 0.5 * steepest * steepest / under
        if lowest > 0.0:
            continue
        if abs(slope) > slack + max(abs(under), abs(over)) * length:
            at_a = _gap_at(arclets, joints, trimming, element, j, a, scratch)
            at_b = _gap_at(arclets, joints, trimming, element, j, b, scratch)
            if at_a <= 0.0 and at_b <= 0.0:
                return a, b, 0, True
            if at_a < 0.0 < at_b:
                low = max(low, _passes(arclets, joints, trimming, element, j, (a, b), scratch))
                continue
            if at_b < 0.0 < at_a:
                high = min(high, _passes(arclets, joints, trimming, element, j, (b, a), scratch))
                continue
            if at_a > 0.0 and at_b > 0.0:
                continue
        near[top + left] = j
        left += 1
    return low, high, left, not low < high


@kernel
def _bend_range(
    trimming: Trimming, element: tuple[int, int], bend: float, width: float
) -> tuple[float, float]:
    """The range of the curvature of a stretch, of which that in the middle is ``bend``.

    It increases with the curvature kappa of the arclet: kappa / (1 + kappa d).
    """
    i, corner = element
    if corner:
        return bend, bend
    low, high, d = trimming.bends[i, 0], trimming.bends[i, 1], trimming.distance
    middle = bend / (1.0 - bend * d)
    change = 0.5 * width * trimming.bends[i, 9] * trimming.bends[i, 2]
    if change < np.inf and middle == middle:
        low, high = max(low, middle - change), min(high, middle + change)
    if 1.0 + low * d > 0.0 and 1.0 + high * d > 0.0:
        return low / (1.0 + low * d), high / (1.0 + high * d)
    return -np.inf, np.inf


@kernel
def _second_range(
    row: Floats,
    foot: tuple[float, float, float, float],
    along: tuple[float, float, float, float],
    length: float,
) -> tuple[float, float, float]:
    """The range of the second derivative of the distance to an arclet along a stretch.

    With h the curvature of the distance's level sets, g its gradient, T and n tangent and left
    normal of the stretch, k its curvature: h (1 - (g.T)^2) + k (g.n). If h has no lower bound,
    that of the distance to any one point of the arclet, for which h >= 0, and by how much the
    slope toward that may differ from g.T.
    """
    far, gx, gy, t = foot
    tx, ty, least, most = along
    if not (-np.inf < least and most < np.inf) or far <= 2.0 * length:
        return -np.inf, np.inf, 0.0
    # how much the angle between g and T changes
    change = length / (far - length) + max(abs(least), abs(most)) * length
    across, side = abs(gx * ty - gy * tx), gy * tx - gx * ty
    square_low = max(across - change, 0.0) ** 2
    square_high = min(across + change, 1.0) ** 2
    side_low, side_high = max(side - change, -1.0), min(side + change, 1.0)
    h_low, slack = _least_bend(row, foot, length), 0.0
    if h_low == -np.inf:
        h_low, slack = 0.0, row[9] / far
    # The distance to a set bends by no more than that to a point.
    over = square_high / (far - length)
    over += max(max(least * side_low, least * side_high), max(most * side_low, most * side_high))
    under = h_low * (square_high if h_low < 0.0 else square_low)
    under += min(min(least * side_low, least * side_high), min(most * side_low, most * side_high))
    return under, over, slack


@kernel
def _least_bend(row: Floats, foot: tuple[float, float, float, float], length: float) -> float:
    """A lower bound, not above 0, of the curvature of an arclet's distance within ``length``."""
    far, gx, gy, t = foot
    # Curvature toward the point is positive on the right of the arclet.
    dx, dy = row[5] + row[7], row[6] + row[8]
    if t <= 0.0:
        dx, dy = row[5], row[6]
    elif t >= 1.0:
        dx, dy = row[7], row[8]
    right = gx * dy - gy * dx
    if abs(right) > _BESIDE * math.sqrt(dx * dx + dy * dy):
        least = row[0] if right > 0.0 else -row[1]
    else:
        # The foot is an end, and the point ahead of it: those of neighbors may be on both sides.
        least = min(row[0], -row[1])
    if least >= 0.0:
        return 0.0
    width = 1.0 + least * (far + length)
    return least / width if width > 0.0 else -np.inf


@kernel
def _point_of(arcs: Floats, i: int, t: float) -> tuple[float, float]:
    x = y = 0.0
    if t == 1.0:
        return arcs[i, 1], arcs[i, 2]
    for k in range(3 + 2 * int(arcs[i, 0]), 3, -2):
        x = (x + arcs[i, k]) * t
        y = (y + arcs[i, k + 1]) * t
    return arcs[i, 3] + x, arcs[i, 4] + y


@kernel
def _gap_at(
    arclets: Arclets,
    joints: Joints,
    trimming: Trimming,
    element: tuple[int, int],
    j: int,
    t: float,
    scratch: Scratch,
) -> float:
    """How much farther than |d| the arclet j is from a point of the parallel."""
    point = parallel_point(arclets.arcs, joints, element, t, trimming.distance)
    squared, _ = closest_on(arclets.arcs, j, point[0], point[1], np.inf, scratch)
    return math.sqrt(squared) - abs(trimming.distance) - trimming.grain


@kernel
def _passes(
    arclets: Arclets,
    joints: Joints,
    trimming: Trimming,
    element: tuple[int, int],
    j: int,
    ends: tuple[float, float],
    scratch: Scratch,
) -> float:
    """Where the gap to arclet j, below zero at the first end, is zero: secants in a bracket."""
    low, high = ends
    f_low = _gap_at(arclets, joints, trimming, element, j, low, scratch)
    f_high = _gap_at(arclets, joints, trimming, element, j, high, scratch)
    side = 0
    t = high
    for step in range(_STEPS):
        t = low - f_low * (high - low) / (f_high - f_low)
        # every fourth step halves, so that the bracket shrinks whatever the function
        if step % 4 == 3 or not min(low, high) < t < max(low, high):
            t = 0.5 * (low + high)
        if t == low or t == high:
            break
        f = _gap_at(arclets, joints, trimming, element, j, t, scratch)
        if f == 0.0:
            break
        # Illinois: an end that stays loses half of its weight
        if f < 0.0:
            low, f_low = t, f
            f_high = 0.5 * f_high if side < 0 else f_high
            side = -1
        else:
            high, f_high = t, f
            f_low = 0.5 * f_low if side > 0 else f_low
            side = 1
    return t


@kernel
def _is_near(arclets: Arclets, x: float, y: float, limit: float, scratch: Scratch) -> bool:
    """Whether anything is nearer to a point than the limit."""
    if limit <= 0.0:
        return False
    scratch.nodes[0] = 0
    _, hit, _ = search(arclets.tree, arclets.arcs, x, y, limit, 1, -1, -1.0, scratch)
    return bool(hit >= 0)


@kernel
def _compare(
    arclets: Arclets,
    joints: Joints,
    trimming: Trimming,
    element: tuple[int, int],
    span: tuple[float, float],
    scratch: Scratch,
    found: tuple[Ints, Floats],
    since: int,
    total: int,
) -> int:
    """Append the parts of a stretch at whose points nothing is nearer than |d|."""
    low, high = span
    limit = abs(trimming.distance) - trimming.grain
    last = low
    point = parallel_point(arclets.arcs, joints, element, low, trimming.distance)
    before = _is_near(arclets, point[0], point[1], limit, scratch)
    began = low
    for k in range(1, _COMPARED + 1):
        t = high if k == _COMPARED else low + (high - low) * k / _COMPARED
        point = parallel_point(arclets.arcs, joints, element, t, trimming.distance)
        now = _is_near(arclets, point[0], point[1], limit, scratch)
        if now != before:
            a, b = last, t
            for _ in range(_STEPS):
                m = 0.5 * (a + b)
                if m == a or m == b:
                    break
                point = parallel_point(arclets.arcs, joints, element, m, trimming.distance)
                if _is_near(arclets, point[0], point[1], limit, scratch) == before:
                    a = m
                else:
                    b = m
            if now:
                total = _append(element, (began, a), found, since, total)
            else:
                began = b
        last, before = t, now
    if not before:
        total = _append(element, (began, high), found, since, total)
    return total


@kernel
def _append(
    element: tuple[int, int],
    span: tuple[float, float],
    found: tuple[Ints, Floats],
    since: int,
    total: int,
) -> int:
    """One more stretch, or a longer last one if that ended here."""
    elements, spans = found
    if since < total <= spans.shape[0] and spans[total - 1, 1] == span[0]:
        spans[total - 1, 1] = span[1]
        return total
    if total < spans.shape[0]:
        elements[total, 0], elements[total, 1] = element
        spans[total, 0], spans[total, 1] = span
    return total + 1
