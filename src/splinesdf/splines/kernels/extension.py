"""Outside the domain: the least of s(q) + |p - q| over the points q of its border.

This is the 1-Lipschitz extension of McShane and Whitney, from the border.

    side 0: bottom, 1: right, 2: top, 3: left; each runs in the direction of its axis

              p ·.          a: where p is along the line of a side
                │ `.        b: how far p is from that line
    q = t on a  │b  `.      f(t) = s(t) + √((t - a)² + b²)
    side ───────a────t───

Along a cell's edge s is one quadratic with second derivative c. Where f has a minimum inside the
edge, f'' = c + b²/r³ >= 0 there: so for c < 0 it is within a window around a in which f is convex,
and for c >= 0 f is convex everywhere. One safeguarded Newton iteration finds it; the two ends are
the other candidates.

The edges of a side are the leaves of a binary tree whose node k has the children 2 k + 1 and
2 k + 2, each with half of the edges. Over a node s is at least the chord between its ends less
``drops[k]``, and chord + distance has its least value in closed form: what lies above the best so
far is left out. Such bounds miss by the square of the length, so a handful of edges remains.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.spaces.tables import Evaluated
from splinesdf.splines.tables import Border

# Iterations of Newton or bisection at most: bisection halves an interval to rounding in 60.
_STEPS = 64
# Nodes on the way down: one more than the levels of a tree for each of the four sides.
_DEPTH = 256
# An end where f rises no steeper than this is the minimum of a smooth stretch that happens to lie
# there, up to rounding; where it is steeper, q stays in that corner as p moves.
_LEVEL = 1e-9
# A point this near to the border counts as this far: inverses of smaller numbers overflow.
_TINY = 1e-150


@kernel
def fill_drops(border: Border) -> None:
    """Fill how far s falls below the chord between the ends of a node's edges."""
    starts, edges, drops = border.starts, border.edges, border.drops
    nodes = np.empty((_DEPTH, 3), dtype=np.int64)  # first and last knot, number
    for side in range(4):
        nodes[0, 0], nodes[0, 1], nodes[0, 2] = starts[side], starts[side + 1] - 1, 0
        open_count = 1
        while open_count > 0:
            open_count -= 1
            i, j, node = nodes[open_count, 0], nodes[open_count, 1], nodes[open_count, 2]
            drops[side, node] = _drop(edges, i, j)
            if j > i + 1:
                middle = (i + j) // 2
                _open(nodes, open_count, i, middle, 2 * node + 1)
                _open(nodes, open_count + 1, middle, j, 2 * node + 2)
                open_count += 2


@uncounted
def _open(nodes: Ints, at: int, first: int, last: int, node: int) -> None:
    nodes[at, 0], nodes[at, 1], nodes[at, 2] = first, last, node


@uncounted
def _drop(edges: Floats, i: int, j: int) -> float:
    """How far s falls below the chord from one knot to another."""
    slope = (edges[j, 1] - edges[i, 1]) / (edges[j, 0] - edges[i, 0])
    drop = 0.0
    for k in range(i, j):
        along = edges[k, 0] - edges[i, 0]
        drop = max(drop, edges[i, 1] + slope * along - edges[k, 1])
        along += 0.5 * (edges[k + 1, 0] - edges[k, 0])
        # The middle ordinate is where the end tangents meet: the curve keeps halfway.
        share = 0.5 if j == i + 1 else 1.0
        drop = max(drop, share * (edges[i, 1] + slope * along - edges[k, 2]))
    return drop


@kernel
def extend(domain: Floats, border: Border, evaluated: Evaluated) -> None:
    """Fill values, gradients and Hessians as far as they are asked for, outside the domain.

    Parameters
    ----------
    domain : ndarray, shape (4,)
    border : Border
        With what `fill_drops` fills in.
    evaluated : Evaluated
        Points in the domain and those that are not finite are passed over.
    """
    points, value, gradient = evaluated.points, evaluated.value, evaluated.gradient
    nodes, bounds = np.empty((_DEPTH, 4), dtype=np.int64), np.empty(_DEPTH)
    for k in range(points.shape[0]):
        x, y = points[k, 0], points[k, 1]
        if domain[0] <= x <= domain[2] and domain[1] <= y <= domain[3]:
            continue
        if not (math.isfinite(x) and math.isfinite(y)):
            continue
        value[k], side, at, bend, free = _closest(domain, border, x, y, nodes, bounds)
        if gradient.shape[0] > 0:
            _fill_derivatives(domain, (x, y), (side, at, bend, free), k, evaluated)


@uncounted
def _closest(
    domain: Floats, border: Border, x: float, y: float, nodes: Ints, bounds: Floats
) -> tuple[float, int, float, float, bool]:
    """The least s + distance; on which side, where there, s's second derivative; if in an edge.

    There is room in ``nodes`` for the nodes still to be looked at: first and last knot, number and
    side.
    """
    starts, edges, drops = border.starts, border.edges, border.drops
    best, best_side, at, bend, free = np.inf, 0, 0.0, 0.0, False
    open_count = 4
    for side in range(4):
        nodes[side, 0], nodes[side, 1] = starts[side], starts[side + 1] - 1
        nodes[side, 2], nodes[side, 3] = 0, side
        a, b = _seen_from(domain, side, x, y)
        bounds[side] = _lower_bound(edges, nodes[side, 0], nodes[side, 1], drops[side, 0], a, b)
    while open_count > 0:
        open_count -= 1
        if bounds[open_count] >= best:
            continue
        i, j = nodes[open_count, 0], nodes[open_count, 1]
        node, side = nodes[open_count, 2], nodes[open_count, 3]
        a, b = _seen_from(domain, side, x, y)
        if j == i + 1:
            found, t, curved, inner = _least_on_edge(edges, i, a, b)
            if found < best:
                best, best_side, at, bend, free = found, side, t, curved, inner
            continue
        middle = (i + j) // 2
        low = _lower_bound(edges, i, middle, drops[side, 2 * node + 1], a, b)
        high = _lower_bound(edges, middle, j, drops[side, 2 * node + 2], a, b)
        # The half with the lower bound goes on top, so that it comes first.
        left = open_count if low >= high else open_count + 1
        right = 2 * open_count + 1 - left
        _open(nodes, left, i, middle, 2 * node + 1)
        _open(nodes, right, middle, j, 2 * node + 2)
        nodes[left, 3], nodes[right, 3] = side, side
        bounds[left], bounds[right] = low, high
        open_count += 2
    return best, best_side, at, bend, free


@uncounted
def _fill_derivatives(
    domain: Floats,
    point: tuple[float, float],
    foot: tuple[int, float, float, bool],
    k: int,
    evaluated: Evaluated,
) -> None:
    """Fill the gradient, and the Hessian where asked for, of a point whose foot is known."""
    gradient, hessian = evaluated.gradient, evaluated.hessian
    (x, y), (side, at, bend, free) = point, foot
    upright = side % 2 == 1
    line = domain[2] if side == 1 else domain[0]
    if not upright:
        line = domain[3] if side == 2 else domain[1]
    along, up = x - domain[0], y - domain[1]
    dx, dy = (x - line, up - at) if upright else (along - at, y - line)
    distance = _length(dx, dy)
    if distance < _TINY:
        dx, dy, distance = dx / _TINY, dy / _TINY, _TINY
        scale = 1.0 / _length(dx, dy)
    else:
        scale = 1.0 / distance
    dx, dy = dx * scale, dy * scale
    gradient[k, 0], gradient[k, 1] = dx, dy
    if hessian.shape[0] > 0:
        # Across (dx, dy), by the unit vector (-dy, dx); zero along it.
        bent = 1.0 / distance
        turn_rate = dx if upright else -dy
        if free and bend * distance + turn_rate * turn_rate > 0.0:
            bent = bend / (bend * distance + turn_rate * turn_rate)
        hessian[k, 0] = bent * dy * dy
        hessian[k, 1] = -bent * dx * dy
        hessian[k, 2] = bent * dx * dx


@uncounted
def _length(x: float, y: float) -> float:
    """As hypot, in a fifth of its time where squares neither overflow nor vanish."""
    squared = x * x + y * y
    return math.sqrt(squared) if 1e-280 < squared < 1e300 else math.hypot(x, y)


@uncounted
def _seen_from(domain: Floats, side: int, x: float, y: float) -> tuple[float, float]:
    """Where a point is along the line of a side, from its start, and how far from it."""
    along, up = x - domain[0], y - domain[1]
    if side == 0:
        return along, abs(up)
    if side == 1:
        return up, abs(x - domain[2])
    if side == 2:
        return along, abs(y - domain[3])
    return up, abs(along)


@uncounted
def _lower_bound(edges: Floats, i: int, j: int, drop: float, a: float, b: float) -> float:
    """A lower bound of s + distance between two knots: that of their chord, less the drop."""
    t0, t1 = edges[i, 0], edges[j, 0]
    slope = (edges[j, 1] - edges[i, 1]) / (t1 - t0)
    if abs(slope) < 1.0:
        t = min(max(a - slope * b / math.sqrt(1.0 - slope * slope), t0), t1)
    else:
        t = t0 if slope > 0.0 else t1
    least: float = edges[i, 1] + slope * (t - t0) + _length(t - a, b) - drop
    return least


@uncounted
def _least_on_edge(edges: Floats, i: int, a: float, b: float) -> tuple[float, float, float, bool]:
    """The least s + distance between a knot and the next.

    And where it is, the second derivative of s, and whether s + distance is level there, as it is
    anywhere but in an end.
    """
    t0: float = edges[i, 0]
    s0: float = edges[i, 1]
    t1, middle, s1 = edges[i + 1, 0], edges[i, 2], edges[i + 1, 1]
    length = t1 - t0
    slope, bend = 2.0 * (middle - s0) / length, 2.0 * (s0 - 2.0 * middle + s1) / (length * length)
    r0, r1 = _length(t0 - a, b), _length(t1 - a, b)
    if s0 + r0 <= s1 + r1:
        best: float = s0 + r0
        at = t0
        rise = slope + (t0 - a) / r0
    else:
        best, at = s1 + r1, t1
        rise = slope + bend * length + (t1 - a) / r1
    free = abs(rise) <= _LEVEL
    low, high = t0, t1
    if bend < 0.0:
        share = 1.0 / (-bend * b) if b > 0.0 else 0.0
        if share <= 1.0:
            return best, at, bend, free
        window = b * math.sqrt(share ** (2.0 / 3.0) - 1.0)
        low, high = max(low, a - window), min(high, a + window)
        if low >= high:
            return best, at, bend, free
    r = _length(low - a, b)
    if slope + bend * (low - t0) + (low - a) / r >= 0.0:
        return best, at, bend, free
    r = _length(high - a, b)
    if slope + bend * (high - t0) + (high - a) / r <= 0.0:
        return best, at, bend, free
    # Where the chord's slope would have it.
    chord = (s1 - s0) / length
    t = a - chord * b / math.sqrt(1.0 - chord * chord) if abs(chord) < 1.0 else 0.5 * (low + high)
    if not low < t < high:
        t = 0.5 * (low + high)
    for _ in range(_STEPS):
        r = _length(t - a, b)
        rise = slope + bend * (t - t0) + (t - a) / r
        if rise < 0.0:
            low = t
        else:
            high = t
        steep = bend + (b / r) * (b / r) / r
        step = rise / steep if steep > 0.0 else np.inf
        after = t - step
        if not low < after < high:
            after = 0.5 * (low + high)
        if after == t or abs(after - t) <= 4e-16 * (abs(t) + length):
            t = after
            break
        t = after
    along = t - t0
    found = s0 + along * (slope + 0.5 * bend * along) + _length(t - a, b)
    if found < best:
        best, at, free = found, t, True
    return best, at, bend, free
