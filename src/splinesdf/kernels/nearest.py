"""Closest point and side of many points: a walk down the tree of boxes.

For a point p and an arclet c of degree d, D(t) = |c(t) - p|^2 is a Bernstein polynomial of degree
2d whose coefficients cost two multiplications each. They prove what is needed:

* D >= its smallest coefficient: an arclet that cannot beat the best so far is left at once;
* D' has at most as many roots as the coefficients' differences change sign: with one change the
  minimum is unique and a bracketed Newton finds it; with more, D is halved. D is flat to rounding
  where the point is the centre of a circular arc: there any parameter is right.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf._arrays import Floats, Ints
from splinesdf._jit import kernel
from splinesdf._tables import Arclets

# Rounding in a coefficient of D, as a multiple of |p - start|^2 + |arc|^2: about three roundings
# an operation over sums of at most 15 terms. Too small: a true minimum may be pruned by noise;
# too large: more arclets are visited in vain.
_NOISE = 32 * 2.220446049250313e-16
# Halvings of one arclet: 2^-50 of it is below the spacing of floating-point numbers.
_DEPTH = 50
# Newton's last step: its error is about the square of this, so the parameter is good to rounding.
_LAST_STEP = 1e-9
# A halving gains one bit, so it goes on to the last one.
_LAST_BISECTION = 1e-16
_NEWTON_STEPS = 80
# The walk's stack: a balanced tree over 2^60 arclets is no deeper.
_STACK = 64


@kernel
def nearest(
    arclets: Arclets, points: Floats, distance: Floats, closest: Floats, arclet: Ints, at: Floats
) -> None:
    """Fill the closest point of each point.

    Parameters
    ----------
    arclets : Arclets
    points : ndarray, shape (n, 2)
        Relative to ``arclets.origin``. Neighbours in the list should be neighbours in the plane:
        each point starts from the bound that the last one gives.
    distance, closest, arclet, at : ndarray, shapes (n,), (n, 2), (n,), (n,)
        Filled: distance without sign, closest point, its arclet and parameter there in [0, 1].
        A point that is not finite gets NaN, and arclet -1.
    """
    most = arclets.gram.shape[1]
    work = np.empty((_DEPTH + 2, most))
    spans = np.empty((_DEPTH + 2, 2))
    nodes = np.empty(_STACK, dtype=np.int64)
    bounds = np.empty(_STACK)
    have = False
    last_x = last_y = last_distance = 0.0
    for i in range(points.shape[0]):
        px, py = points[i, 0], points[i, 1]
        if not (math.isfinite(px) and math.isfinite(py)):
            distance[i] = closest[i, 0] = closest[i, 1] = at[i] = np.nan
            arclet[i] = -1
            continue
        best = np.inf
        if have:
            # The distance is 1-Lipschitz. The slack keeps the bound above the true minimum.
            best = (last_distance + math.hypot(px - last_x, py - last_y)) ** 2
            best = best * (1.0 + 1e-12) + 1e-300
        found = -1
        found_at = 0.0
        while found < 0:
            size = 1
            nodes[0] = 0
            bounds[0] = _box_distance(arclets, 0, px, py)
            while size > 0:
                size -= 1
                if bounds[size] > best:
                    continue
                node = nodes[size]
                first, end = arclets.range[node, 0], arclets.range[node, 1]
                if end - first == 1:
                    value, t = _closest_on(arclets, first, px, py, best, work, spans)
                    if value < best or (found < 0 and value <= best):
                        best, found, found_at = value, first, t
                    continue
                left = node + 1
                right = node + 2 * ((first + end) // 2 - first)
                near_bound = _box_distance(arclets, left, px, py)
                far_bound = _box_distance(arclets, right, px, py)
                if near_bound > far_bound:
                    left, right = right, left
                    near_bound, far_bound = far_bound, near_bound
                if far_bound <= best:
                    nodes[size], bounds[size] = right, far_bound
                    size += 1
                if near_bound <= best:
                    nodes[size], bounds[size] = left, near_bound
                    size += 1
            if found < 0:
                best = np.inf
        x, y = _point(arclets, found, found_at)
        distance[i] = math.hypot(x - px, y - py)
        closest[i, 0], closest[i, 1] = x, y
        arclet[i], at[i] = found, found_at
        have, last_x, last_y, last_distance = True, px, py, distance[i]


@kernel
def _box_distance(arclets: Arclets, node: int, px: float, py: float) -> float:
    dx = max(arclets.boxes[node, 0] - px, px - arclets.boxes[node, 2], 0.0)
    dy = max(arclets.boxes[node, 1] - py, py - arclets.boxes[node, 3], 0.0)
    return float(dx * dx + dy * dy)


@kernel
def _point(arclets: Arclets, i: int, t: float) -> tuple[float, float]:
    if t == 0.0:
        return arclets.start[i, 0], arclets.start[i, 1]
    if t == 1.0:
        return arclets.end[i, 0], arclets.end[i, 1]
    x = y = 0.0
    for k in range(arclets.degree[i], 0, -1):
        x = (x + arclets.power[i, k, 0]) * t
        y = (y + arclets.power[i, k, 1]) * t
    return arclets.start[i, 0] + x, arclets.start[i, 1] + y


@kernel
def _closest_on(
    arclets: Arclets, i: int, px: float, py: float, best: float, work: Floats, spans: Floats
) -> tuple[float, float]:
    """Smallest squared distance to arclet i, where it beats ``best``, and its parameter."""
    vx, vy = px - arclets.start[i, 0], py - arclets.start[i, 1]
    squared = vx * vx + vy * vy
    degree = arclets.degree[i]
    if degree == 1:
        cx, cy = arclets.power[i, 1, 0], arclets.power[i, 1, 1]
        t = min(max((vx * cx + vy * cy) / (cx * cx + cy * cy), 0.0), 1.0)
        x, y = _point(arclets, i, t)
        return (x - px) * (x - px) + (y - py) * (y - py), t
    n = 2 * degree
    smallest = largest = work[0, 0] = squared
    for k in range(1, n + 1):
        value = arclets.gram[i, k] + squared
        value -= 2.0 * (vx * arclets.linear[i, k, 0] + vy * arclets.linear[i, k, 1])
        work[0, k] = value
        smallest, largest = min(smallest, value), max(largest, value)
    noise = _NOISE * (squared + arclets.gram[i, n])
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
        for t in (low, high):
            x, y = _point(arclets, i, t)
            value = (x - px) * (x - px) + (y - py) * (y - py)
            if value < result:
                result, result_at = value, t
        if changes >= 1 and (changes > 1 or first_sign < 0.0):
            t = _newton(arclets, i, px, py, low, high, low + root * (high - low))
            x, y = _point(arclets, i, t)
            value = (x - px) * (x - px) + (y - py) * (y - py)
            if value < result:
                result, result_at = value, t
    return result, result_at


@kernel
def _newton(
    arclets: Arclets, i: int, px: float, py: float, low: float, high: float, start: float
) -> float:
    """A root of h(t) = (c(t) - p) . c'(t) in [low, high], h going from negative to positive."""
    ox, oy = arclets.start[i, 0] - px, arclets.start[i, 1] - py
    t = start
    for _ in range(_NEWTON_STEPS):
        x = y = dx = dy = ddx = ddy = 0.0
        for k in range(arclets.degree[i], 0, -1):
            ddx, ddy = ddx * t + dx, ddy * t + dy
            dx, dy = dx * t + x + arclets.power[i, k, 0], dy * t + y + arclets.power[i, k, 1]
            x, y = (x + arclets.power[i, k, 0]) * t, (y + arclets.power[i, k, 1]) * t
        x, y = x + ox, y + oy
        h = x * dx + y * dy
        if h < 0.0:
            low = t
        else:
            high = t
        slope = dx * dx + dy * dy + 2.0 * (x * ddx + y * ddy)
        moved = t - h / slope if slope > 0.0 else low - 1.0
        last_step = _LAST_STEP
        if not low <= moved <= high:
            moved = 0.5 * (low + high)
            last_step = _LAST_BISECTION
        step = abs(moved - t)
        t = moved
        if step <= last_step:
            break
    return t


@kernel
def winding(arclets: Arclets, points: Floats, distance: Floats, number: Ints) -> None:
    """Fill the winding number of each point, from crossings of the ray in +x.

    A run of arclets right of the point counts by its two end points alone. A point nearer to its
    forerunner than that one's ``distance`` to the curve has the same number: no curve between.
    """
    nodes = np.empty(_STACK, dtype=np.int64)
    last_x = last_y = last_distance = 0.0
    last_number = 0
    for i in range(points.shape[0]):
        px, py = points[i, 0], points[i, 1]
        if not (math.isfinite(px) and math.isfinite(py)):
            number[i] = 0
            continue
        if math.hypot(px - last_x, py - last_y) < 0.999999 * last_distance:
            number[i] = last_number
            last_x, last_y, last_distance = px, py, distance[i]
            continue
        count = 0
        size = 1
        nodes[0] = 0
        while size > 0:
            size -= 1
            node = nodes[size]
            box = arclets.boxes[node]
            if not (box[1] <= py < box[3] and px <= box[2]):
                continue
            first, end = arclets.range[node, 0], arclets.range[node, 1]
            if px < box[0] and arclets.chain[node] == 1:
                count += int(arclets.end[end - 1, 1] > py) - int(arclets.start[first, 1] > py)
            elif end - first == 1:
                count += _crossing(arclets, first, px, py)
            else:
                nodes[size] = node + 1
                nodes[size + 1] = node + 2 * ((first + end) // 2 - first)
                size += 2
        number[i] = count
        last_x, last_y, last_distance, last_number = px, py, distance[i], count


@kernel
def _crossing(arclets: Arclets, i: int, px: float, py: float) -> int:
    """+1, -1 or 0: how the y-monotone arclet i crosses the ray from the point in +x."""
    rising = int(arclets.end[i, 1] > py) - int(arclets.start[i, 1] > py)
    if rising == 0:
        return 0
    if px < min(arclets.start[i, 0], arclets.end[i, 0]) and arclets.degree[i] == 1:
        return rising
    low, high = 0.0, 1.0
    vy = py - arclets.start[i, 1]
    t = vy / (arclets.end[i, 1] - arclets.start[i, 1])
    for _ in range(_NEWTON_STEPS):
        y = dy = 0.0
        for k in range(arclets.degree[i], 0, -1):
            dy = dy * t + y + arclets.power[i, k, 1]
            y = (y + arclets.power[i, k, 1]) * t
        if (y - vy) * rising < 0.0:
            low = t
        else:
            high = t
        moved = t - (y - vy) / dy if dy != 0.0 else low - 1.0
        last_step = _LAST_STEP
        if not low <= moved <= high:
            moved = 0.5 * (low + high)
            last_step = _LAST_BISECTION
        step = abs(moved - t)
        t = moved
        if step <= last_step:
            break
    x, _y = _point(arclets, i, t)
    return rising if x > px else 0
