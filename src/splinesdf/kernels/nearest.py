"""Closest points: a walk down the tree of capsules, started for whole cells of points at once.

For a point p and an arclet c of degree d, D(t) = |c(t) - p|^2 is a Bernstein polynomial of degree
2d whose coefficients cost two multiplications each. They prove what is needed:

* D >= its smallest coefficient: an arclet that cannot beat the best so far is left at once;
* D' has at most as many roots as the coefficients' differences change sign: with one change the
  minimum is unique and a bracketed Newton finds it; with more, D is halved. D is flat to rounding
  where the point is the center of a circular arc: there any parameter is right.

Points come sorted into the cells of a quadtree. A cell inherits the nodes of its parent that can
be closest to some point of it (`_cull`), so that a point starts its walk from a few of them.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf._arrays import Floats, Ints
from splinesdf._jit import kernel
from splinesdf._tables import Arclets, Cells, Feet, Scratch

# Rounding in a coefficient of D, as a multiple of |p - start|^2 + |arc|^2: about three roundings
# an operation over sums of at most 15 terms. Too small: a true minimum may be pruned by noise;
# too large: more arclets are visited in vain.
_NOISE = 32 * 2.220446049250313e-16
# Halvings of one arclet: 2^-50 of it is below the spacing of floating-point numbers.
_DEPTH = 50
# Halley's last step: its error is about the cube of this, so the parameter is good to rounding.
_LAST_STEP = 4e-6
# A halving gains one bit, so it goes on to the last one.
_LAST_BISECTION = 1e-16
_STEPS = 80
# The walk's stack: a balanced tree over 2^60 arclets is no deeper, and a cell's own nodes.
_STACK = 128
# Nodes that a cell keeps at most. More: the walk of each point starts lower; fewer: less memory.
_KEPT = 48
# A bound that the distance is compared with is raised by this share, so that rounding in it
# cannot hide the minimum.
_SLACK = 1.0 + 1e-12
# Cells hold a node rather than its children once its segment is this many cell sides long.
_NODE_SIZE = 2.0


@kernel
def nearest(arclets: Arclets, cells: Cells, feet: Feet) -> None:
    """Fill the closest point of each point of the cells.

    Parameters
    ----------
    arclets : Arclets
    cells : Cells
        Of points relative to ``arclets.origin``; finite where a cell holds them.
    feet : Feet
        Filled. A point farther than ``feet.farthest`` from the curve gets infinity and arclet -1.
    """
    tree, arcs = arclets.tree, arclets.arcs
    scratch = _scratch(arcs)
    # What the cell of each level around the current one keeps: level 0 is the whole plane.
    kept = np.zeros((cells.levels + 2, _KEPT), dtype=np.int64)
    kept_bounds = np.zeros((cells.levels + 2, _KEPT))
    count = np.ones(cells.levels + 2, dtype=np.int64)
    last_cell = -1
    limit = feet.farthest * _SLACK
    for cell in range(cells.starts.shape[0] - 1):
        first, end = cells.starts[cell], cells.starts[cell + 1]
        if first == end:
            continue
        level = 0
        # The last cell is all that is outside the others; a single point is no help to itself.
        if cell < cells.starts.shape[0] - 2 and end - first > 1:
            level = cells.levels + 1
            for around in range(_shared(last_cell, cell, cells.levels), level):
                x, y, reach = _cell(cells, cell, around)
                parent = kept[around, : count[around]]
                count[around + 1] = _cull(
                    tree,
                    arcs,
                    x,
                    y,
                    reach,
                    parent,
                    kept[around + 1],
                    kept_bounds[around + 1],
                    scratch,
                )
            last_cell = cell
        best = limit
        last_x = last_y = last_distance = 0.0
        for i in range(first, end):
            px, py = cells.points[i, 0], cells.points[i, 1]
            if i > first:
                # The distance is 1-Lipschitz. The slack keeps the bound above the true minimum.
                step = math.sqrt((px - last_x) ** 2 + (py - last_y) ** 2)
                best = min((last_distance + step) * _SLACK, limit)
            for j in range(count[level]):
                # nearest ones last, on top of the stack
                scratch.nodes[j] = kept[level, count[level] - 1 - j]
            distance, found, t = _search(tree, arcs, px, py, best, count[level], scratch)
            feet.arclet[i], feet.at[i] = found, t
            if found < 0:
                feet.distance[i] = feet.closest[i, 0] = feet.closest[i, 1] = np.inf
                last_distance = feet.farthest
            else:
                feet.distance[i] = last_distance = distance
                feet.closest[i, 0], feet.closest[i, 1] = _point(arcs, found, t)
            last_x, last_y = px, py


@kernel
def clearance(
    arclets: Arclets,
    points: Floats,
    own: Ints,
    touching: float,
    clear: Floats,
    partner: Ints,
    at: Floats,
) -> None:
    """Fill how far points on arclets are from all other arclets that do not pass through them.

    Parameters
    ----------
    arclets : Arclets
    points : ndarray, shape (n, 2)
        Relative to ``arclets.origin``.
    own : ndarray, shape (n,)
        The arclet that each lies on.
    touching : float
        Other arclets within this distance pass through the point.
    clear : ndarray, shape (n,)
    partner, at : ndarray, shape (n,)
        The first of the arclets through the point and its parameter there, -1 if there is none.
    """
    tree, arcs = arclets.tree, arclets.arcs
    scratch = _scratch(arcs)
    nodes = scratch.nodes
    for i in range(points.shape[0]):
        px, py = points[i, 0], points[i, 1]
        best = np.inf
        partner[i], at[i] = -1, np.nan
        nodes[0] = 0
        size = 1
        while size > 0:
            size -= 1
            node = nodes[size]
            if _capsule_distance(tree, node, px, py) > best:
                continue
            first, end = int(tree[node, 6]), int(tree[node, 7])
            if end - first > 1:
                left, right = node + 1, node + 2 * ((first + end) // 2 - first)
                nodes[size], nodes[size + 1] = left, right
                if _capsule_distance(tree, left, px, py) < _capsule_distance(tree, right, px, py):
                    nodes[size], nodes[size + 1] = right, left
                size += 2
            elif first != own[i]:
                squared, t = _closest_on(arcs, first, px, py, best * best, scratch)
                if squared > touching * touching:
                    best = min(best, math.sqrt(squared))
                elif partner[i] < 0 or first < partner[i]:
                    partner[i], at[i] = first, t
        clear[i] = best


@kernel
def _scratch(arcs: Floats) -> Scratch:
    return Scratch(
        np.empty((_DEPTH + 2, (arcs.shape[1] - 8) // 4 + 1)),
        np.empty((_DEPTH + 2, 2)),
        np.empty(_STACK, dtype=np.int64),
        np.empty(_STACK),
    )


@kernel
def _shared(one: int, other: int, levels: int) -> int:
    """How many cells around a finest one, from the root on, are around the other one as well."""
    if one < 0:
        return 0
    difference = one ^ other
    shared = levels + 1
    while difference > 0:
        difference >>= 2
        shared -= 1
    return shared


@kernel
def _cell(cells: Cells, cell: int, level: int) -> tuple[float, float, float]:
    """Center and half diagonal of the cell of a level in which a finest cell lies."""
    code = cell >> (2 * (cells.levels - level))
    column = row = 0
    for bit in range(level):
        column |= ((code >> (2 * bit)) & 1) << bit
        row |= ((code >> (2 * bit + 1)) & 1) << bit
    scale = 0.5**level
    width, height = cells.box[2] * scale, cells.box[3] * scale
    x = cells.box[0] + (column + 0.5) * width
    y = cells.box[1] + (row + 0.5) * height
    return x, y, 0.5 * math.sqrt(width * width + height * height) * _SLACK


@kernel
def _cull(
    tree: Floats,
    arcs: Floats,
    x: float,
    y: float,
    reach: float,
    parent: Ints,
    kept: Ints,
    kept_bounds: Floats,
    scratch: Scratch,
) -> int:
    """Fill the nodes that can be closest to a point within ``reach`` of (x, y), nearest first.

    With the distance d of (x, y), its closest point at the unit vector m behind it, and a capsule
    at the distance e in the direction n: at the place moved by v, |v| <= reach, the curve is no
    farther than d + m.v + |v|^2 / (2 (d - reach)) (second-order bound of the distance to a point),
    the capsule no nearer than e + n.v (it is convex). So the node can be left if
    e - d > |m - n| reach + reach^2 / (2 (d - reach)); and always if e - d > 2 reach.
    """
    nodes = scratch.nodes
    size = parent.shape[0]
    for j in range(size):
        nodes[j] = parent[size - 1 - j]
    distance, found, t = _search(tree, arcs, x, y, np.inf, size, scratch)
    fx, fy = _point(arcs, found, t)
    mx, my = (x - fx) / distance, (y - fy) / distance
    far = distance > 1.5 * reach
    bend = reach * reach / (2.0 * (distance - reach)) if far else 0.0
    slack = distance * (_SLACK - 1.0)
    for j in range(size):
        nodes[j] = parent[j]
    total = 0
    while size > 0:
        size -= 1
        node = int(nodes[size])
        wx, wy = _from_axis(tree, node, x, y)
        axis = math.sqrt(wx * wx + wy * wy)
        margin = 2.0 * reach
        if far and axis > 0.0:
            turn = math.sqrt((mx - wx / axis) ** 2 + (my - wy / axis) ** 2)
            margin = min(margin, turn * reach + bend)
        bound = axis - tree[node, 5]
        if bound > distance + margin + slack:
            continue
        first, last = int(tree[node, 6]), int(tree[node, 7])
        length = abs(tree[node, 2]) + abs(tree[node, 3]) + 2.0 * tree[node, 5]
        if last - first > 1 and length > _NODE_SIZE * reach and size + total + 2 < _KEPT:
            nodes[size] = node + 1
            nodes[size + 1] = node + 2 * ((first + last) // 2 - first)
            size += 2
            continue
        place = total
        while place > 0 and kept_bounds[place - 1] > bound:
            kept[place], kept_bounds[place] = kept[place - 1], kept_bounds[place - 1]
            place -= 1
        kept[place], kept_bounds[place] = node, bound
        total += 1
    return total


@kernel
def _search(
    tree: Floats, arcs: Floats, px: float, py: float, best: float, size: int, scratch: Scratch
) -> tuple[float, int, float]:
    """Nearest arclet under some nodes, if any is within ``best``; its distance and parameter.

    The nodes stand in ``scratch.nodes[:size]``, the first to be looked at last.
    """
    nodes, bounds = scratch.nodes, scratch.bounds
    found = -1
    found_at = 0.0
    for j in range(size):
        bounds[j] = _capsule_distance(tree, nodes[j], px, py)
    while size > 0:
        size -= 1
        if bounds[size] > best:
            continue
        node = nodes[size]
        first, end = int(tree[node, 6]), int(tree[node, 7])
        if end - first == 1:
            squared, t = _closest_on(arcs, first, px, py, best * best, scratch)
            value = math.sqrt(squared)
            if value < best or (found < 0 and value <= best):
                best, found, found_at = value, first, t
            continue
        left = node + 1
        right = node + 2 * ((first + end) // 2 - first)
        near_bound = _capsule_distance(tree, left, px, py)
        far_bound = _capsule_distance(tree, right, px, py)
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


@kernel
def _capsule_distance(tree: Floats, node: int, px: float, py: float) -> float:
    wx, wy = _from_axis(tree, node, px, py)
    # Far away, rounding in the distance itself could exceed the capsule's own margin.
    return float(math.sqrt(wx * wx + wy * wy) * (2.0 - _SLACK) - tree[node, 5])


@kernel
def _from_axis(tree: Floats, node: int, px: float, py: float) -> tuple[float, float]:
    """The vector to the point from the nearest one of a capsule's segment."""
    wx, wy = px - tree[node, 0], py - tree[node, 1]
    dx, dy = tree[node, 2], tree[node, 3]
    share = min(max((wx * dx + wy * dy) * tree[node, 4], 0.0), 1.0)
    return wx - share * dx, wy - share * dy


@kernel
def _point(arcs: Floats, i: int, t: float) -> tuple[float, float]:
    if t == 1.0:
        return arcs[i, 1], arcs[i, 2]
    x = y = 0.0
    for k in range(3 + 2 * int(arcs[i, 0]), 3, -2):
        x = (x + arcs[i, k]) * t
        y = (y + arcs[i, k + 1]) * t
    return arcs[i, 3] + x, arcs[i, 4] + y


@kernel
def _squared(arcs: Floats, i: int, t: float, px: float, py: float) -> float:
    x, y = _point(arcs, i, t)
    return (x - px) * (x - px) + (y - py) * (y - py)


@kernel
def _closest_on(
    arcs: Floats, i: int, px: float, py: float, best: float, scratch: Scratch
) -> tuple[float, float]:
    """Smallest squared distance to arclet i, where it beats ``best``, and its parameter."""
    work, spans = scratch.coefficients, scratch.spans
    vx, vy = px - arcs[i, 3], py - arcs[i, 4]
    squared = vx * vx + vy * vy
    degree = int(arcs[i, 0])
    if degree == 1:
        cx, cy = arcs[i, 5], arcs[i, 6]
        t = min(max((vx * cx + vy * cy) / (cx * cx + cy * cy), 0.0), 1.0)
        return _squared(arcs, i, t, px, py), t
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
        if changes >= 1 and (changes > 1 or first_sign < 0.0):
            t = _foot(arcs, i, px, py, low, high, low + root * (high - low))
            value = _squared(arcs, i, t, px, py)
            if value < result:
                result, result_at = value, t
            if changes == 1:
                continue  # falling before it and rising behind it: no end is nearer
        if changes > 0 or first_sign >= 0.0:
            value = _squared(arcs, i, low, px, py)
            if value < result:
                result, result_at = value, low
        if changes > 0 or first_sign <= 0.0:
            value = _squared(arcs, i, high, px, py)
            if value < result:
                result, result_at = value, high
    return result, result_at


@kernel
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
        last_step = _LAST_STEP
        if not low <= moved <= high:
            moved = 0.5 * (low + high)
            last_step = _LAST_BISECTION
        step = abs(moved - t)
        t = moved
        if step <= last_step:
            break
    return t
