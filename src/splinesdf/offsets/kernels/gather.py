"""What is near a stretch of a parallel: the arclets that may reach its disks, and whether any does.

Used by `trim`.
"""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from splinesdf.arclets.kernels.arclet import below, capsule_distance, point_on
from splinesdf.arclets.kernels.nearest import search
from splinesdf.arclets.tables import Scratch
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import uncounted
from splinesdf.offsets.kernels.clearance import bend_range, is_nearer_at_its_ends
from splinesdf.offsets.kernels.parallels import parallel_point
from splinesdf.offsets.tables import Parallels, Walls

# Searches start from the root alone and pass over no arclet. As integers of a type of their own:
# for literals Numba would compile `search` anew.
_ROOT, _NONE = cast(int, np.int64(1)), cast(int, np.int64(-1))


@uncounted
def gather(
    tree: Floats,
    place: Ints,
    disk: tuple[float, float, float],
    chord: tuple[tuple[float, float, float, float], float],
    own: tuple[int, int, int],
    near: Ints,
    most: int,
    nodes: Ints,
) -> int:
    """List the arclets, but for the own chain, that may reach into a disk, and near to a chord.

    The disk is x, y, radius; the chord its ends and how near. How many there are, or -1 if they are
    more than ``most``. ``nodes`` is room for the walk.
    """
    x, y, farthest = disk
    segment, beside = chord
    count = 0
    nodes[0] = 0
    size = 1
    while size > 0:
        size -= 1
        node = nodes[size]
        if capsule_distance(tree, node, x, y) > farthest:
            continue
        # A long stretch beside long walls: most of what is in the disk is far from the stretch.
        if beside < farthest and _apart(tree, node, segment) > beside:
            continue
        lo, hi = int(tree[node, 6]), int(tree[node, 7])
        if hi - lo > 1:
            nodes[size + 1], nodes[size] = below(node, lo, hi)
            size += 2
            continue
        if _is_own(place, own, lo):
            continue
        if count == most:
            return -1
        near[count] = lo
        count += 1
    return count


@uncounted
def _is_own(place: Ints, own: tuple[int, int, int], j: int) -> bool:
    """Whether an arclet is of the own chain: the loop's first place, the chain's, its length."""
    first, begin, length = own
    return bool(place[j, 1] == first and (place[j, 0] - begin) % place[j, 2] < length)


@uncounted
def one_is_nearer(
    parallels: Parallels,
    walls: Walls,
    place: Ints,
    stretch: tuple[tuple[int, int], float, float],
    own: tuple[int, int, int],
    bounds: tuple[float, float],
    scratch: Scratch,
) -> bool:
    """Whether what is nearest to the middle of a stretch is nearer to all of it than |d|.

    Bounds are the largest curvature of the stretch, and no less than its length.
    """
    element, a, b = stretch
    x, y, _, _, _, _ = parallel_point(parallels, element, 0.5 * (a + b))
    _, hit, _ = _nearest(walls, x, y, abs(parallels.distance), scratch)
    if hit < 0 or _is_own(place, own, hit):
        return False
    return is_nearer_at_its_ends(parallels, walls, stretch, hit, bounds, scratch)


@uncounted
def _apart(tree: Floats, node: int, segment: tuple[float, float, float, float]) -> float:
    """Nothing under a node of the tree is nearer to a segment than this."""
    ax, ay, bx, by = segment
    x, y, dx, dy = tree[node, 0], tree[node, 1], tree[node, 2], tree[node, 3]
    wx, wy = bx - ax, by - ay
    squared = wx * wx + wy * wy
    # If they cross: each has the other's ends on both sides.
    one = (dx * (ay - y) - dy * (ax - x)) * (dx * (by - y) - dy * (bx - x))
    other = (wx * (y - ay) - wy * (x - ax)) * (wx * (y + dy - ay) - wy * (x + dx - ax))
    if one <= 0.0 and other <= 0.0:
        return float(-tree[node, 5])
    # The nearest points of two segments that do not cross: an end of one, and the other.
    result: float = min(capsule_distance(tree, node, ax, ay), capsule_distance(tree, node, bx, by))
    for share in (0.0, 1.0):
        px, py = x + share * dx - ax, y + share * dy - ay
        t = min(max((px * wx + py * wy) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
        far = math.sqrt((px - t * wx) ** 2 + (py - t * wy) ** 2)
        result = min(result, far - float(tree[node, 5]))
    return result


@uncounted
def is_near(walls: Walls, x: float, y: float, limit: float, scratch: Scratch) -> bool:
    """Whether anything is nearer to a point than the limit."""
    if limit <= 0.0:
        return False
    _, hit, _ = _nearest(walls, x, y, limit, scratch)
    return bool(hit >= 0)


@uncounted
def _nearest(
    walls: Walls, x: float, y: float, limit: float, scratch: Scratch
) -> tuple[float, int, float]:
    """The arclet nearest to a point within a limit, see `search`."""
    scratch.nodes[0] = 0
    return search(walls.tree, walls.arcs, (x, y), limit, _ROOT, _NONE, -1.0, scratch)


@uncounted
def surfaces(
    parallels: Parallels,
    walls: Walls,
    element: tuple[int, int],
    span: tuple[float, float],
    limits: tuple[float, float],
    spans: Floats,
    scratch: Scratch,
) -> float:
    """A parameter between two, to which something is nearer, where nothing is; else NaN.

    The distance to the nearest point, as it moves along the stretch, bends upward by no more than
    1 / distance + curvature. So it stays below the limit for a while from either end, which grows
    like the root of how far below it is there. If both meet, nothing is between. Limits are how
    near something is, and how short a stretch is not looked at.
    """
    limit, shortest = limits
    spans[0, 0], spans[0, 1] = span
    size = 1
    for _ in range(spans.shape[0] - 2):
        if size == 0:
            break
        size -= 1
        a, b = spans[size, 0], spans[size, 1]
        ax, ay, far_a, slope_a = _nearest_along(parallels, walls, element, a, scratch)
        bx, by, far_b, slope_b = _nearest_along(parallels, walls, element, b, scratch)
        length = 1.12 * math.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
        if length <= shortest:
            continue
        m = 0.5 * (a + b)
        _, _, _, _, _, bend = parallel_point(parallels, element, m)
        least, most = bend_range(walls.bends, parallels.distance, element, bend, b - a)
        curved = max(abs(least), abs(most))
        if curved < np.inf and length < min(far_a, far_b):
            up = curved + 1.0 / (min(far_a, far_b) - length)
            below = _stays_below(far_a - limit, slope_a, up)
            below += _stays_below(far_b - limit, -slope_b, up)
            if below >= length:
                continue
        _, _, far, _ = _nearest_along(parallels, walls, element, m, scratch)
        if far >= limit:
            return float(m)
        spans[size, 0], spans[size, 1] = m, b
        spans[size + 1, 0], spans[size + 1, 1] = a, m
        size += 2
    return math.nan


@uncounted
def _nearest_along(
    parallels: Parallels,
    walls: Walls,
    element: tuple[int, int],
    t: float,
    scratch: Scratch,
) -> tuple[float, float, float, float]:
    """A point of a parallel, how far what is nearest is, and how fast that changes along it."""
    x, y, tx, ty, _, _ = parallel_point(parallels, element, t)
    # Nothing is farther than where the point belongs, but for rounding.
    far, hit, at = _nearest(walls, x, y, 2.0 * abs(parallels.distance), scratch)
    if hit < 0 or far == 0.0:
        return x, y, far, 0.0
    px, py = point_on(walls.arcs, hit, at)
    return x, y, far, ((x - px) * tx + (y - py) * ty) / far


@uncounted
def _stays_below(value: float, slope: float, bend: float) -> float:
    """How far what is below zero, has a slope, and bends up by no more than that, stays there."""
    return float((math.sqrt(max(slope * slope - 2.0 * bend * value, 0.0)) - slope) / bend)
