"""Closest points in cells where little can be closest: all points of a cell at once.

Where a cell has no more than a few arclets as candidates, and the squared distance D(t) to each
is convex for all points of the cell, there is nothing to search: D' has one root or none, and
two steps of Halley's method from a good start find it to rounding. They have no branches, so
that the compiler takes several points at a time where the degree is small. That the steps did end
is checked; a cell in which one did not is left to `nearest`.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.arclet import foot_on_line, from_axis
from splinesdf.arclets.tables import Candidates, Cells, Feet
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.ground.jit import kernel, uncounted

# Arclets of a cell that are tried. More: cells near the medial axis are taken too, but try more
# arclets in vain.
_FEW = 4
# Sides of a polygon that are tried, without a walk down the tree.
_FEW_LINES = 40
# Rounding in a coefficient of D, as a multiple of |p - start|^2 + |arc|^2, see `nearest`.
_NOISE = 32 * 2.220446049250313e-16
# Two steps are enough where the error that they leave, about the second (second / first)^3, is
# below this share of the arclet. A third step takes more time than the cells that it saves.
_STEPS = 2
_ERROR = 1e-16
# The degree of compiled curves. Pieces of a higher one, which are rare, are left to `nearest`.
_DEGREE = 7


@kernel
def nearest_of_few(
    tree: Floats, arcs: Floats, cells: Cells, candidates: Candidates, feet: Feet, done: Bools
) -> None:
    """Fill the closest points of all points of the cells that can be done in this way.

    Parameters
    ----------
    tree, arcs : ndarray
        Of `Arclets`.
    cells : Cells
        Of points relative to the arclets' origin; finite where a cell holds them.
    candidates : Candidates
        Of these cells.
    feet : Feet
        Filled in the cells that are done.
    done : ndarray of bool, shape (n_cells,)
        Filled.
    """
    power = np.empty((_DEGREE, 2))
    for cell in range(done.shape[0]):
        done[cell] = _fill(tree, arcs, cells, candidates, cell, power, feet)


@uncounted
def _fill(
    tree: Floats,
    arcs: Floats,
    cells: Cells,
    candidates: Candidates,
    cell: int,
    power: Floats,
    feet: Feet,
) -> bool:
    """Fill the closest points of a cell, and say whether it is done; ``power`` is room."""
    first, end = cells.starts[cell], cells.starts[cell + 1]
    if first == end:
        return True
    if arcs.shape[1] > 8 * (_DEGREE + 1):
        return False
    kept = candidates.nodes[candidates.starts[cell] : candidates.starts[cell + 1]]
    points = cells.points[first:end]
    reach = _reach(points)
    # Lines alone have the narrowest rows.
    lines = arcs.shape[1] == 16
    if lines and _total(tree, kept) > _FEW_LINES:
        return False
    if not lines and not _all_convex(tree, arcs, points[0, 0], points[0, 1], reach, kept):
        return False
    done = True
    distance, arclet, at = feet.distance[first:end], feet.arclet[first:end], feet.at[first:end]
    for k in range(end - first):
        distance[k], arclet[k] = np.inf, -1
    for place in range(kept.shape[0]):
        node = kept[place]
        # The first candidate is the nearest: what is far from it is far from all.
        if _bound(tree, node, points[0, 0], points[0, 1]) - reach > feet.farthest:
            continue
        i = int(tree[node, 6])
        if lines:
            for j in range(i, int(tree[node, 7])):
                _try_line(arcs, j, points, distance, arclet, at)
            continue
        degree = int(arcs[i, 0])
        for k in range(_DEGREE):
            power[k, 0] = arcs[i, 5 + 2 * k] if k < degree else 0.0
            power[k, 1] = arcs[i, 6 + 2 * k] if k < degree else 0.0
        if degree <= 3:
            unfinished = _try_cubic(arcs, i, power, points, distance, arclet, at)
        else:
            unfinished = _try_arc(arcs, i, power, points, distance, arclet, at)
        if unfinished > 0:
            done = False
    for k in range(end - first):
        distance[k] = math.sqrt(distance[k])
        if distance[k] > feet.farthest:
            distance[k], arclet[k] = np.inf, -1
    return done


@uncounted
def _reach(points: Floats) -> float:
    """How far the points are from the first of them, at most."""
    reach = 0.0
    for k in range(points.shape[0]):
        dx, dy = points[k, 0] - points[0, 0], points[k, 1] - points[0, 1]
        reach = max(reach, dx * dx + dy * dy)
    return math.sqrt(reach)


@uncounted
def _total(tree: Floats, kept: Ints) -> int:
    """How many arclets there are under some nodes."""
    total = 0
    for place in range(kept.shape[0]):
        node = kept[place]
        total += int(tree[node, 7]) - int(tree[node, 6])
    return total


@uncounted
def _try_line(
    arcs: Floats, i: int, points: Floats, squared: Floats, arclet: Ints, at: Floats
) -> None:
    """Put a straight arclet in where it is nearer than what has been found."""
    for p in range(points.shape[0]):
        x, y = points[p, 0] - arcs[i, 3], points[p, 1] - arcs[i, 4]
        t = foot_on_line(arcs, i, x, y)
        x -= t * arcs[i, 5]
        y -= t * arcs[i, 6]
        value = x * x + y * y
        nearer = value < squared[p]
        squared[p] = value if nearer else squared[p]
        arclet[p] = i if nearer else arclet[p]
        at[p] = t if nearer else at[p]


@uncounted
def _bound(tree: Floats, node: int, x: float, y: float) -> float:
    """Nothing under the node is nearer than this."""
    wx, wy = from_axis(tree, node, x, y)
    return float(math.sqrt(wx * wx + wy * wy) - tree[node, 5])


@uncounted
def _all_convex(tree: Floats, arcs: Floats, x: float, y: float, reach: float, kept: Ints) -> bool:
    """Whether the nodes are a few arclets, each with a convex D for all points near (x, y).

    D is convex if second differences of its coefficients are positive. They are linear in the
    point, so it is enough to know them for one and how far the others are.
    """
    if kept.shape[0] > _FEW:
        return False
    for place in range(kept.shape[0]):
        node = kept[place]
        i = int(tree[node, 6])
        if int(tree[node, 7]) - i > 1:
            return False
        n = 2 * int(arcs[i, 0])
        if n == 2:
            continue
        vx, vy = x - arcs[i, 3], y - arcs[i, 4]
        noise = _NOISE * (vx * vx + vy * vy + arcs[i, 7 + 4 * n])
        for k in range(5 + n, 4 + 2 * n):
            bend_x = arcs[i, k] - 2.0 * arcs[i, k + 1] + arcs[i, k + 2]
            at = k + n + 1
            bend_y = arcs[i, at] - 2.0 * arcs[i, at + 1] + arcs[i, at + 2]
            at += n + 1
            bend = arcs[i, at] - 2.0 * arcs[i, at + 1] + arcs[i, at + 2]
            bend -= 2.0 * (vx * bend_x + vy * bend_y)
            if bend <= 4.0 * noise + 2.0 * reach * math.sqrt(bend_x * bend_x + bend_y * bend_y):
                return False
    return True


@uncounted
def _try_cubic(
    arcs: Floats, i: int, power: Floats, points: Floats, squared: Floats, arclet: Ints, at: Floats
) -> int:
    """As `_try_line`, for degrees up to 3. Returns for how many points the steps did not end."""
    unfinished = 0
    ax, ay, bx, by, cx, cy = (
        power[0, 0],
        power[0, 1],
        power[1, 0],
        power[1, 1],
        power[2, 0],
        power[2, 1],
    )
    end_x, end_y = ax + 2.0 * bx + 3.0 * cx, ay + 2.0 * by + 3.0 * cy
    for p in range(points.shape[0]):
        ox, oy = arcs[i, 3] - points[p, 0], arcs[i, 4] - points[p, 1]
        # h = D' / 2 rises: from its values at the ends a secant, cut to [0, 1].
        low = ox * ax + oy * ay
        high = (arcs[i, 1] - points[p, 0]) * end_x + (arcs[i, 2] - points[p, 1]) * end_y
        s = min(max(low / (low - high), 0.0), 1.0)
        moved = before = step = 0.0
        for _ in range(_STEPS):
            x, y = ((cx * s + bx) * s + ax) * s + ox, ((cy * s + by) * s + ay) * s + oy
            dx, dy = (3.0 * cx * s + 2.0 * bx) * s + ax, (3.0 * cy * s + 2.0 * by) * s + ay
            ddx, ddy = 6.0 * cx * s + 2.0 * bx, 6.0 * cy * s + 2.0 * by
            h = x * dx + y * dy
            slope = dx * dx + dy * dy + x * ddx + y * ddy
            bend = 3.0 * (dx * ddx + dy * ddy) + 6.0 * (x * cx + y * cy)
            free = s - h * slope / (slope * slope - 0.5 * h * bend)
            new = min(max(free, 0.0), 1.0)
            # A step that was cut off says nothing of how the next ones shrink.
            before, moved = step, abs(new - s)
            step = moved if new == free else 0.0
            s = new
        x, y = ((cx * s + bx) * s + ax) * s + ox, ((cy * s + by) * s + ay) * s + oy
        value = x * x + y * y
        shrunk = moved / max(before, _ERROR)
        unfinished += 0 if moved * shrunk * shrunk * shrunk <= _ERROR else 1
        nearer = value < squared[p]
        squared[p] = value if nearer else squared[p]
        arclet[p] = i if nearer else arclet[p]
        at[p] = s if nearer else at[p]
    return unfinished


@uncounted
def _try_arc(
    arcs: Floats, i: int, power: Floats, points: Floats, squared: Floats, arclet: Ints, at: Floats
) -> int:
    """As `_try_cubic`, for degrees up to _DEGREE; unused powers are zero."""
    unfinished = 0
    end_x = end_y = 0.0
    for k in range(_DEGREE):
        end_x += (k + 1) * power[k, 0]
        end_y += (k + 1) * power[k, 1]
    for p in range(points.shape[0]):
        ox, oy = arcs[i, 3] - points[p, 0], arcs[i, 4] - points[p, 1]
        low = ox * power[0, 0] + oy * power[0, 1]
        high = (arcs[i, 1] - points[p, 0]) * end_x + (arcs[i, 2] - points[p, 1]) * end_y
        s = min(max(low / (low - high), 0.0), 1.0)
        moved = before = step = 0.0
        for _ in range(_STEPS):
            x = y = dx = dy = ddx = ddy = dddx = dddy = 0.0
            for k in range(_DEGREE - 1, -1, -1):
                # Taylor coefficients: a half of the second derivative, a sixth of the third.
                dddx, dddy = dddx * s + ddx, dddy * s + ddy
                ddx, ddy = ddx * s + dx, ddy * s + dy
                dx, dy = dx * s + x + power[k, 0], dy * s + y + power[k, 1]
                x, y = (x + power[k, 0]) * s, (y + power[k, 1]) * s
            x, y = x + ox, y + oy
            h = x * dx + y * dy
            slope = dx * dx + dy * dy + 2.0 * (x * ddx + y * ddy)
            bend = 6.0 * (dx * ddx + dy * ddy + x * dddx + y * dddy)
            free = s - h * slope / (slope * slope - 0.5 * h * bend)
            new = min(max(free, 0.0), 1.0)
            # A step that was cut off says nothing of how the next ones shrink.
            before, moved = step, abs(new - s)
            step = moved if new == free else 0.0
            s = new
        x = y = 0.0
        for k in range(_DEGREE - 1, -1, -1):
            x, y = (x + power[k, 0]) * s, (y + power[k, 1]) * s
        x, y = x + ox, y + oy
        value = x * x + y * y
        shrunk = moved / max(before, _ERROR)
        unfinished += 0 if moved * shrunk * shrunk * shrunk <= _ERROR else 1
        nearer = value < squared[p]
        squared[p] = value if nearer else squared[p]
        arclet[p] = i if nearer else arclet[p]
        at[p] = s if nearer else at[p]
    return unfinished
