"""Closest points: a walk down the tree of capsules, started for whole cells of points at once.

For a point p and an arclet c of degree d, D(t) = |c(t) - p|^2 is a Bernstein polynomial of degree
2d whose coefficients cost two multiplications each. They prove what is needed:

* D >= its smallest coefficient: an arclet that cannot beat the best so far is left at once;
* D' has at most as many roots as the coefficients' differences change sign: with one change the
  minimum is unique and a bracketed iteration finds it; with more, D is halved. D is flat to
  rounding where the point is the center of a circular arc: there any parameter is right.

Points come sorted into cells, and the nodes of the tree that can be closest to some point of a
cell are known (`culling`), so that a point starts its walk from a few of them.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.arclet import SLACK, below, capsule_distance, foot_on_line, point_on
from splinesdf.arclets.tables import Candidates, Cells, Feet, PassedOver, Scratch, Searched
from splinesdf.ground.arrays import Bools, Floats
from splinesdf.ground.jit import kernel, uncounted

# Rounding in a coefficient of D, as a multiple of |p - start|^2 + |arc|^2: about three roundings
# an operation over sums of at most 15 terms. Too small: a true minimum may be pruned by noise;
# too large: more arclets are visited in vain.
_NOISE = 32 * 2.220446049250313e-16
# Halvings of one arclet: 2^-50 of it is below the spacing of floating-point numbers.
_DEPTH = 50
# Error of a parameter that is not worth another step of Halley's method. What is left after a step
# is about step (step / the one before)^3, as the order is three; next to a cusp, where three roots
# are close to each other, steps shrink by halves at first.
_ERROR = 1e-16
_STEPS = 80
# The walk's stack: a balanced tree over 2^60 arclets is no deeper, and a cell's own nodes.
_STACK = 128
# Straight arclets that are tried one after the other at the bottom of the tree of a polygon.
_LINES = 8
# A bound is raised by this share of the largest coordinate, the rounding in points of the curve.
_GRAIN = 16 * 2.220446049250313e-16


@kernel
def nearest(
    searched: Searched,
    cells: Cells,
    candidates: Candidates,
    done: Bools,
    passed_over: PassedOver,
    feet: Feet,
) -> None:
    """Fill the closest point of each point of the cells that are not done.

    Parameters
    ----------
    searched : Searched
    cells : Cells
        Of points relative to the arclets' origin; finite where a cell holds them.
    candidates : Candidates
        Of these cells.
    done : ndarray of bool, shape (n_cells,)
    passed_over : PassedOver
    feet : Feet
        Filled. A point farther than ``feet.farthest`` from the curve gets infinity and arclet -1.
    """
    scratch = room_to_search(searched.arcs)
    for cell in range(done.shape[0]):
        if not done[cell]:
            _walk(searched, cells, candidates, cell, passed_over, feet, scratch)


@uncounted
def _walk(
    searched: Searched,
    cells: Cells,
    candidates: Candidates,
    cell: int,
    passed_over: PassedOver,
    feet: Feet,
    scratch: Scratch,
) -> None:
    """Fill the closest point of each point of a cell."""
    tree, arcs = searched.tree, searched.arcs
    # Rounding in a distance next to the curve.
    grain = _GRAIN * searched.largest
    limit = feet.farthest * SLACK + grain
    alone = passed_over.own.shape[0] > 0
    own = -1
    ignored = passed_over.within * abs(passed_over.within)
    kept, count = candidates.starts[cell], candidates.starts[cell + 1] - candidates.starts[cell]
    last_x = last_y = 0.0
    last_distance = np.inf
    for i in range(cells.starts[cell], cells.starts[cell + 1]):
        px, py = cells.points[i, 0], cells.points[i, 1]
        if alone:
            own = passed_over.own[i]
        # The distance is 1-Lipschitz; what is added is for rounding.
        step = math.sqrt((px - last_x) ** 2 + (py - last_y) ** 2)
        best = min((last_distance + step) * SLACK + grain, limit)
        while True:
            for j in range(count):
                # nearest ones last, on top of the stack
                scratch.nodes[j] = candidates.nodes[kept + count - 1 - j]
            distance, found, t = search(tree, arcs, (px, py), best, count, own, ignored, scratch)
            if found >= 0 or best == limit:
                break
            best = limit  # rounding hid the minimum from the neighbor's bound
        feet.arclet[i], feet.at[i] = found, t
        feet.distance[i] = distance if found >= 0 else np.inf
        last_x, last_y = px, py
        if not alone:
            last_distance = distance if found >= 0 else feet.farthest


@kernel
def room_to_search(arcs: Floats) -> Scratch:
    """What a search needs, to be used again and again."""
    return Scratch(
        np.empty((_DEPTH + 2, (arcs.shape[1] - 8) // 4 + 1)),
        np.empty((_DEPTH + 2, 2)),
        np.empty(_STACK, dtype=np.int64),
        np.empty(_STACK),
    )


@uncounted
def search(
    tree: Floats,
    arcs: Floats,
    point: tuple[float, float],
    best: float,
    size: int,
    own: int,
    ignored: float,
    scratch: Scratch,
) -> tuple[float, int, float]:
    """Nearest arclet under some nodes, if any is within ``best``; its distance and parameter.

    The nodes stand in ``scratch.nodes[:size]``, the first to be looked at last. The arclet ``own``
    and those whose squared distance is not above ``ignored`` are passed over.
    """
    px, py = point
    nodes, bounds = scratch.nodes, scratch.bounds
    # Lines alone have the narrowest rows. To go through a few is quicker than down the tree.
    few = _LINES if arcs.shape[1] == 16 else 1
    found = -1
    found_at = 0.0
    for j in range(size):
        bounds[j] = capsule_distance(tree, nodes[j], px, py)
    while size > 0:
        size -= 1
        if bounds[size] > best:
            continue
        node = nodes[size]
        first, end = int(tree[node, 6]), int(tree[node, 7])
        if end - first <= few:
            smallest = best * best
            for i in range(first, end):
                if few > 1:
                    squared, t = _closest_on_line(arcs, i, px, py)
                else:
                    squared, t = closest_on(arcs, i, px, py, smallest, scratch)
                if i == own or squared <= ignored:
                    continue
                if squared < smallest or (found < 0 and squared <= smallest):
                    smallest, found, found_at = squared, i, t
                    best = math.sqrt(squared)
            continue
        left, right = below(node, first, end)
        near_bound = capsule_distance(tree, left, px, py)
        far_bound = capsule_distance(tree, right, px, py)
        if near_bound > far_bound:
            left, right = right, left
            near_bound, far_bound = far_bound, near_bound
        if far_bound <= best:
            nodes[size], bounds[size] = right, far_bound
            size += 1
        if near_bound <= best:
            nodes[size], bounds[size] = left, near_bound
            size += 1
    return best, found, found_at


@uncounted
def _squared(arcs: Floats, i: int, t: float, px: float, py: float) -> float:
    x, y = point_on(arcs, i, t)
    return (x - px) * (x - px) + (y - py) * (y - py)


@uncounted
def _closest_on_line(arcs: Floats, i: int, px: float, py: float) -> tuple[float, float]:
    """Squared distance to a straight arclet, and its parameter."""
    vx, vy = px - arcs[i, 3], py - arcs[i, 4]
    t = foot_on_line(arcs, i, vx, vy)
    vx -= t * arcs[i, 5]
    vy -= t * arcs[i, 6]
    return vx * vx + vy * vy, t


@uncounted
def closest_on(
    arcs: Floats, i: int, px: float, py: float, best: float, scratch: Scratch
) -> tuple[float, float]:
    """Smallest squared distance to arclet i, where it beats ``best``, and its parameter."""
    work, spans = scratch.coefficients, scratch.spans
    vx, vy = px - arcs[i, 3], py - arcs[i, 4]
    squared = vx * vx + vy * vy
    degree = int(arcs[i, 0])
    if degree == 1:
        return _closest_on_line(arcs, i, px, py)
    n = 2 * degree
    x, y, squares = 5 + n, 6 + 2 * n, 7 + 3 * n
    smallest = squared
    for k in range(n + 1):
        value = arcs[i, squares + k] + squared
        value -= 2.0 * (vx * arcs[i, x + k] + vy * arcs[i, y + k])
        work[0, k] = value
        smallest = min(smallest, value)
    noise = _NOISE * (squared + arcs[i, squares + n])
    if smallest - noise > best:
        return np.inf, 0.0
    result, result_at = np.inf, 0.0
    spans[0, 0], spans[0, 1] = 0.0, 1.0
    size = 1
    while size > 0:
        top = size - 1
        size -= 1
        low, high = spans[top, 0], spans[top, 1]
        smallest = largest = work[top, 0]
        changes = 0
        sign = 0.0
        first_sign = 0.0
        root = 0.5
        for k in range(1, n + 1):
            value = work[top, k]
            smallest, largest = min(smallest, value), max(largest, value)
            step = value - work[top, k - 1]
            if step * sign < 0.0:
                changes += 1
                before = work[top, k - 1] - work[top, k - 2]
                root = (k - 2 + before / (before - step)) / (n - 1)
            if step != 0.0:
                sign = step
                if first_sign == 0.0:
                    first_sign = step
        if smallest - noise > min(best, result):
            continue
        flat = largest - smallest <= noise
        if changes > 1 and not flat and top + 2 < work.shape[0]:
            middle = 0.5 * (low + high)
            # the left half replaces this interval, the right one goes on top of it
            for k in range(n + 1):
                work[top + 1, n - k] = work[top, n]
                for j in range(n, k, -1):
                    work[top, j] = 0.5 * (work[top, j - 1] + work[top, j])
            # now work[top] holds the left half: entry k was fixed in round k
            spans[top, 1] = middle
            spans[top + 1, 0], spans[top + 1, 1] = middle, high
            size = top + 2
            continue
        # Where D is flat its signs are noise, but h in `_foot` is not: as next to a cusp.
        if flat or changes > 1 or (changes == 1 and first_sign < 0.0):
            t = _foot(arcs, i, px, py, low, high, low + root * (high - low))
            value = _squared(arcs, i, t, px, py)
            if value < result:
                result, result_at = value, t
            if changes == 1 and not flat:
                continue  # falling before it and rising behind it: no end is nearer
        if flat or changes > 0 or first_sign >= 0.0:
            value = _squared(arcs, i, low, px, py)
            if value < result:
                result, result_at = value, low
        if flat or changes > 0 or first_sign <= 0.0:
            value = _squared(arcs, i, high, px, py)
            if value < result:
                result, result_at = value, high
    return result, result_at


@uncounted
def _foot(
    arcs: Floats, i: int, px: float, py: float, low: float, high: float, start: float
) -> float:
    """A root of h(t) = (c(t) - p) . c'(t) in [low, high], h going from negative to positive.

    By Halley's method, which uses h' and h'' and converges with order three; a halving where a
    step leads out of the bracket.
    """
    ox, oy = arcs[i, 3] - px, arcs[i, 4] - py
    last = 3 + 2 * int(arcs[i, 0])
    t = start
    before = 1e-300
    for _ in range(_STEPS):
        x = y = dx = dy = ddx = ddy = dddx = dddy = 0.0
        for k in range(last, 3, -2):
            # Taylor coefficients: dd is half of the second derivative, ddd a sixth of the third.
            dddx, dddy = dddx * t + ddx, dddy * t + ddy
            ddx, ddy = ddx * t + dx, ddy * t + dy
            dx, dy = dx * t + x + arcs[i, k], dy * t + y + arcs[i, k + 1]
            x, y = (x + arcs[i, k]) * t, (y + arcs[i, k + 1]) * t
        x, y = x + ox, y + oy
        h = x * dx + y * dy
        if h < 0.0:
            low = t
        else:
            high = t
        slope = dx * dx + dy * dy + 2.0 * (x * ddx + y * ddy)
        bend = 6.0 * (dx * ddx + dy * ddy + x * dddx + y * dddy)
        under = slope * slope - 0.5 * h * bend
        moved = t - h * slope / under if under > 0.0 and slope > 0.0 else low - 1.0
        halved = not low <= moved <= high
        if halved:
            moved = 0.5 * (low + high)
        step = abs(moved - t)
        t = moved
        left = step if halved else step * (step / before) ** 3
        if min(left, step) <= _ERROR:
            break
        before = 1e-300 if halved else step
    return t
