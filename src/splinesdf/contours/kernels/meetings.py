"""Conic arcs that meet elsewhere than at an end that they share.

An arc lies in the triangle of its control points. Two triangles apart: the arcs do not meet.
Otherwise the larger one is halved, down to a size below which they count as meeting.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted

# Halvings of one arc: enough from any arc to rounding. The stack holds one pair more for each.
_DEPTH = 128
# Boxes that wait to be looked at: no balanced tree is so deep.
_LEVELS = 64


@kernel
def find_meetings(
    arcs: Floats,
    weights: Floats,
    following: Ints,
    order: Ints,
    apart: tuple[float, float],
    pairs: Ints,
) -> int:
    """Fill the pairs of arcs that come nearer to each other than about a distance.

    Parameters
    ----------
    arcs : ndarray, shape (n, 3, 2)
    weights : ndarray, shape (n,)
    following : ndarray, shape (n,)
        The arc that starts where each one ends.
    order : ndarray, shape (n,)
        The arcs such that those near one another stand near one another.
    apart : tuple of float
        Parts of arcs smaller than the first are not halved any more; parts that are both nearer
        than the second to an end that the arcs share are passed over.
    pairs : ndarray, shape (room, 2)
        Filled.

    Returns
    -------
    int
        How many there are, even if there is no room for all.
    """
    boxes = _box_tree(arcs, order)
    half = boxes.shape[0] // 2
    stack = np.empty((_DEPTH, 2, 7))
    shared = np.empty((2, 2))
    todo = np.empty(_LEVELS, dtype=np.int64)
    total = 0
    for place in range(order.shape[0]):
        own = half + place
        todo[0] = 1
        size = 1
        while size > 0:
            size -= 1
            node = todo[size]
            # The last one under the node, and what comes before this one was asked already.
            last = node
            while last < half:
                last = 2 * last + 1
            if last <= own or not _overlap(boxes, node, own):
                continue
            if node < half:
                todo[size], todo[size + 1] = 2 * node + 1, 2 * node
                size += 2
            elif _meet(
                arcs, weights, (order[place], order[node - half]), following, apart, stack, shared
            ):
                if total < pairs.shape[0]:
                    pairs[total, 0], pairs[total, 1] = order[place], order[node - half]
                total += 1
    return total


@kernel
def _box_tree(arcs: Floats, order: Ints) -> Floats:
    """Boxes around the control points of arcs, and around pairs of boxes: 2 k and 2 k + 1 in k.

    The arcs are the last half, in their order, filled up with boxes that nothing overlaps.
    """
    half = 1
    while half < order.shape[0]:
        half *= 2
    boxes = np.empty((2 * half, 4))
    for k in range(2 * half - 1, 0, -1):
        boxes[k, 0] = boxes[k, 1] = np.inf
        boxes[k, 2] = boxes[k, 3] = -np.inf
        if k < half:
            for side in range(4):
                one, other = boxes[2 * k, side], boxes[2 * k + 1, side]
                boxes[k, side] = min(one, other) if side < 2 else max(one, other)
        elif k - half < order.shape[0]:
            i = order[k - half]
            for p in range(3):
                for axis in range(2):
                    boxes[k, axis] = min(boxes[k, axis], arcs[i, p, axis])
                    boxes[k, 2 + axis] = max(boxes[k, 2 + axis], arcs[i, p, axis])
    boxes[0] = boxes[1]
    return boxes


@uncounted
def _overlap(boxes: Floats, one: int, other: int) -> bool:
    return bool(
        boxes[one, 0] <= boxes[other, 2]
        and boxes[other, 0] <= boxes[one, 2]
        and boxes[one, 1] <= boxes[other, 3]
        and boxes[other, 1] <= boxes[one, 3]
    )


@uncounted
def _meet(
    arcs: Floats,
    weights: Floats,
    pair: tuple[int, int],
    following: Ints,
    apart: tuple[float, float],
    stack: Floats,
    shared: Floats,
) -> bool:
    i, j = pair
    # Ends that both share: at most two, when they are all of a loop.
    count = 0
    if following[i] == j:
        shared[count, 0], shared[count, 1] = arcs[i, 2, 0], arcs[i, 2, 1]
        count += 1
    if following[j] == i:
        shared[count, 0], shared[count, 1] = arcs[j, 2, 0], arcs[j, 2, 1]
        count += 1
    if count == 1 and _leave_apart(arcs, i, j, following):
        return False
    for side in range(2):
        one = pair[side]
        for k in range(3):
            stack[0, side, 2 * k], stack[0, side, 2 * k + 1] = arcs[one, k, 0], arcs[one, k, 1]
        stack[0, side, 6] = weights[one]
    size = 1
    while size > 0:
        size -= 1
        a, b = stack[size, 0], stack[size, 1]
        if _separate(a, b) or _separate(b, a):
            continue
        extent_a, extent_b = _extent(a), _extent(b)
        passed = False
        for k in range(count):
            x, y = shared[k, 0], shared[k, 1]
            if _farthest(a, x, y) < apart[1] and _farthest(b, x, y) < apart[1]:
                passed = True
        if passed:
            continue
        if max(extent_a, extent_b) < apart[0] or size + 2 > stack.shape[0]:
            return True
        which = 0 if extent_a >= extent_b else 1
        _halve(stack[size, which], stack[size + 1, which])
        for k in range(7):
            stack[size + 1, 1 - which, k] = stack[size, 1 - which, k]
        size += 2
    return False


@uncounted
def _leave_apart(arcs: Floats, i: int, j: int, following: Ints) -> bool:
    """Whether a line through the end that two arcs share has one on either side of it."""
    first, second = (i, j) if following[i] == j else (j, i)
    x, y = arcs[first, 2, 0], arcs[first, 2, 1]
    ax, ay = x - arcs[first, 1, 0], y - arcs[first, 1, 1]
    bx, by = arcs[second, 1, 0] - x, arcs[second, 1, 1] - y
    a, b = math.hypot(ax, ay), math.hypot(bx, by)
    # Across the line: halfway between both directions.
    nx, ny = ax * b + bx * a, ay * b + by * a
    for k in range(2):
        if not nx * (arcs[first, k, 0] - x) + ny * (arcs[first, k, 1] - y) < 0.0:
            return False
        if not nx * (arcs[second, k + 1, 0] - x) + ny * (arcs[second, k + 1, 1] - y) > 0.0:
            return False
    return True


@uncounted
def _separate(a: Floats, b: Floats) -> bool:
    """Whether a side of triangle a, or its chord's normal, has triangle b beyond it."""
    for k in range(3):
        x, y = a[2 * k], a[2 * k + 1]
        m = (k + 1) % 3
        dx, dy = a[2 * m] - x, a[2 * m + 1] - y
        for turned in range(2):
            nx, ny = (-dy, dx) if turned == 0 else (dx, dy)
            low_a = high_a = 0.0
            low_b, high_b = np.inf, -np.inf
            for v in range(3):
                at = nx * (a[2 * v] - x) + ny * (a[2 * v + 1] - y)
                low_a, high_a = min(low_a, at), max(high_a, at)
                at = nx * (b[2 * v] - x) + ny * (b[2 * v + 1] - y)
                low_b, high_b = min(low_b, at), max(high_b, at)
            if low_b > high_a or high_b < low_a:
                return True
    return False


@uncounted
def _extent(a: Floats) -> float:
    """The longest side of a triangle."""
    sides = math.hypot(a[2] - a[0], a[3] - a[1]), math.hypot(a[4] - a[2], a[5] - a[3])
    return float(max(sides[0], sides[1], math.hypot(a[4] - a[0], a[5] - a[1])))


@uncounted
def _farthest(a: Floats, x: float, y: float) -> float:
    """How far a triangle reaches from a point."""
    result = 0.0
    for k in range(3):
        result = max(result, math.hypot(a[2 * k] - x, a[2 * k + 1] - y))
    return result


@uncounted
def _halve(first: Floats, second: Floats) -> None:
    """Cut an arc at its shoulder: the first half takes its place, the second is filled in."""
    w = first[6]
    for k in range(2):
        end = first[4 + k]
        into = (first[k] + w * first[2 + k]) / (1.0 + w)
        out_of = (end + w * first[2 + k]) / (1.0 + w)
        middle = 0.5 * (into + out_of)
        first[2 + k], first[4 + k] = into, middle
        second[k], second[2 + k], second[4 + k] = middle, out_of, end
    first[6] = second[6] = math.sqrt(0.5 * (1.0 + w))
