"""An arclet and a node of its tree, as many kernels read them: points, feet, least distances."""

from __future__ import annotations

import math

from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import uncounted

# A bound that the distance is compared with is raised by this share, so that rounding in it
# cannot hide the minimum.
SLACK = 1.0 + 1e-12


@uncounted
def point_on(arcs: Floats, i: int, t: float) -> tuple[float, float]:
    """The point of arclet i at a parameter."""
    if t == 1.0:
        return arcs[i, 1], arcs[i, 2]
    x = y = 0.0
    for k in range(3 + 2 * int(arcs[i, 0]), 3, -2):
        x = (x + arcs[i, k]) * t
        y = (y + arcs[i, k + 1]) * t
    return arcs[i, 3] + x, arcs[i, 4] + y


@uncounted
def derivatives(arcs: Floats, i: int, t: float) -> tuple[float, float, float, float, float, float]:
    """An arclet minus its start, its first and its second derivative."""
    x = y = dx = dy = ddx = ddy = 0.0
    for k in range(3 + 2 * int(arcs[i, 0]), 3, -2):
        ddx, ddy = ddx * t + dx, ddy * t + dy
        dx, dy = dx * t + x + arcs[i, k], dy * t + y + arcs[i, k + 1]
        x, y = (x + arcs[i, k]) * t, (y + arcs[i, k + 1]) * t
    return x, y, dx, dy, 2.0 * ddx, 2.0 * ddy


@uncounted
def foot_on_line(arcs: Floats, i: int, vx: float, vy: float) -> float:
    """The parameter of a straight arclet's closest point; v leads from its start to the other."""
    return float(min(max((vx * arcs[i, 5] + vy * arcs[i, 6]) * arcs[i, 7], 0.0), 1.0))


@uncounted
def below(node: int, first: int, end: int) -> tuple[int, int]:
    """The two nodes under one that holds the arclets from one number up to another."""
    return node + 1, node + 2 * ((first + end) // 2 - first)


@uncounted
def capsule_distance(tree: Floats, node: int, px: float, py: float) -> float:
    """Nothing under a node of the tree is nearer to a point than this."""
    wx, wy = from_axis(tree, node, px, py)
    # Far away, rounding in the distance itself could exceed the capsule's own margin.
    return float(math.sqrt(wx * wx + wy * wy) * (2.0 - SLACK) - tree[node, 5])


@uncounted
def from_axis(tree: Floats, node: int, px: float, py: float) -> tuple[float, float]:
    """The vector to the point from the nearest one of a capsule's segment."""
    wx, wy = px - tree[node, 0], py - tree[node, 1]
    dx, dy = tree[node, 2], tree[node, 3]
    share = min(max((wx * dx + wy * dy) * tree[node, 4], 0.0), 1.0)
    return wx - share * dx, wy - share * dy
