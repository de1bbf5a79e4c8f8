"""The side of many points, by the winding number: how often curves cross a ray to the right."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.arclet import below, derivatives
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.ground.jit import kernel, uncounted

_NEWTON_STEPS = 80
# Newton's last step: its error is about the square of this, so the parameter is good to rounding.
_LAST_STEP = 1e-9
# A halving gains one bit, so it goes on to the last one.
_LAST_BISECTION = 1e-16
# The walk's stack: a balanced tree over 2^60 arclets is no deeper.
_STACK = 64
# A point nearer to a curve than this share of the largest coordinate has a side of it by rounding
# only. Smaller: where a line is drawn to and fro, a point on it may count one way and not the
# other; larger: points are asked again in vain.
_ON = 64 * 2.220446049250313e-16
# How often such a point, if it is clear of the boundary, is asked again elsewhere, as far away as
# this share of its distance and turned by this angle (radians) each time. No boundary lies between.
_AGAIN, _AWAY, _TURNED = 12, 0.45, 2.399963229728653
# Share of the distance within which a neighbor is certain to be on the same side. Rounding in
# the distance is far below what is left.
_SURE = 0.999999


@kernel
def fill_inside(
    boxes: Floats,
    ranges: Ints,
    chain: Ints,
    arcs: Floats,
    points: Floats,
    distance: Floats,
    least: int,
    inside: Bools,
) -> None:
    """Fill whether each point is inside, by its winding number and the fill rule.

    Parameters
    ----------
    boxes, ranges, chain, arcs : ndarray
        Of `Arclets`: all the curves that were drawn, also those that bound nothing.
    points : ndarray, shape (n, 2)
        Neighbors one after the other.
    distance : ndarray, shape (n,)
        To the boundary of the filled region, or a lower bound. A point nearer to an earlier one
        than that one's distance is on the same side: no boundary lies between them.
    least : int
        Numbers of at least so much, with either sign, are inside; odd ones for 0.
    inside : ndarray of bool, shape (n,)
    """
    nodes = np.empty(_STACK, dtype=np.int64)
    anchor_x = anchor_y = anchor_squared = 0.0
    last = False
    grain = 0.0
    for k in range(4):
        grain = max(grain, _ON * abs(boxes[0, k]))
    for i in range(points.shape[0]):
        px, py = points[i, 0], points[i, 1]
        here = (_SURE * distance[i]) ** 2
        if (px - anchor_x) ** 2 + (py - anchor_y) ** 2 < anchor_squared:
            if here > anchor_squared:
                anchor_x, anchor_y, anchor_squared = px, py, here
        else:
            number = _number(boxes, ranges, chain, arcs, nodes, (px, py), distance[i], grain)
            last = number % 2 != 0 if least == 0 else abs(number) >= least
            anchor_x, anchor_y, anchor_squared = px, py, here
        inside[i] = last


@uncounted
def _number(
    boxes: Floats,
    ranges: Ints,
    chain: Ints,
    arcs: Floats,
    nodes: Ints,
    point: tuple[float, float],
    distance: float,
    grain: float,
) -> int:
    """Winding number of a point; of one beside it if it is on a curve that bounds nothing."""
    px, py = point
    number, on = _winding(boxes, ranges, chain, arcs, nodes, px, py, grain)
    away = _AWAY * distance
    for k in range(_AGAIN):
        if not on or not away > grain:
            break
        x, y = px + away * math.cos(k * _TURNED), py + away * math.sin(k * _TURNED)
        again, on = _winding(boxes, ranges, chain, arcs, nodes, x, y, grain)
        number = number if on else again
    return number


@uncounted
def _winding(
    boxes: Floats,
    ranges: Ints,
    chain: Ints,
    arcs: Floats,
    nodes: Ints,
    px: float,
    py: float,
    grain: float,
) -> tuple[int, bool]:
    """Winding number by the ray in +x, and whether the point is on a curve, to rounding.

    A run of arclets right of the point counts by its ends. ``nodes`` is room for the walk.
    """
    on = False
    count = 0
    size = 1
    nodes[0] = 0
    while size > 0:
        size -= 1
        node = nodes[size]
        if not (boxes[node, 1] <= py < boxes[node, 3] and px <= boxes[node, 2]):
            continue
        first, end = ranges[node, 0], ranges[node, 1]
        if px < boxes[node, 0] and chain[node] == 1:
            count += int(arcs[end - 1, 2] > py) - int(arcs[first, 4] > py)
        elif end - first == 1:
            crossing, near = _crossing(arcs, first, px, py, grain)
            count += crossing
            on = on or near
        else:
            nodes[size], nodes[size + 1] = below(node, first, end)
            size += 2
    return count, on


@uncounted
def _crossing(arcs: Floats, i: int, px: float, py: float, grain: float) -> tuple[int, bool]:
    """+1, -1 or 0: how the y-monotone arclet i crosses the ray from the point in +x.

    And whether the arclet passes the point no farther than the grain, to first order.
    """
    rising = int(arcs[i, 2] > py) - int(arcs[i, 4] > py)
    if rising == 0:
        return 0, False
    low, high = 0.0, 1.0
    vy = py - arcs[i, 4]
    t = vy / (arcs[i, 2] - arcs[i, 4])
    last = 3 + 2 * int(arcs[i, 0])
    for _ in range(_NEWTON_STEPS):
        y = dy = 0.0
        for k in range(last + 1, 4, -2):
            dy = dy * t + y + arcs[i, k]
            y = (y + arcs[i, k]) * t
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
    x, _, dx, dy, _, _ = derivatives(arcs, i, t)
    beside = x + arcs[i, 3] - px
    # Across the tangent: where it is nearly level, rounding along the ray is far more.
    near = abs(beside * dy) <= grain * math.sqrt(dx * dx + dy * dy)
    return (rising if beside > 0.0 else 0), near
