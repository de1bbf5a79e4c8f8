"""What is near a stretch of a parallel: the arclets that may reach its disks, and whether any does.

Used by `trim`.
"""

from __future__ import annotations

import math

from splinesdf._arrays import Floats, Ints
from splinesdf._jit import kernel
from splinesdf._tables import Arclets, Scratch
from splinesdf.kernels.nearest import capsule_distance, search


@kernel
def gather(
    arclets: Arclets,
    place: Ints,
    disk: tuple[float, float, float],
    chord: tuple[tuple[float, float, float, float], float],
    own: tuple[int, int, int],
    near: Ints,
    most: int,
    scratch: Scratch,
) -> int:
    """List the arclets, but for the own chain, that may reach into a disk, and near to a chord.

    The disk is x, y, radius; the chord its ends and how near. How many there are, or -1 if they are
    more than ``most``.
    """
    tree, nodes = arclets.tree, scratch.nodes
    x, y, farthest = disk
    segment, beside = chord
    first, begin, length = own
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


@kernel
def is_near(arclets: Arclets, x: float, y: float, limit: float, scratch: Scratch) -> bool:
    """Whether anything is nearer to a point than the limit."""
    if limit <= 0.0:
        return False
    scratch.nodes[0] = 0
    _, hit, _ = search(arclets.tree, arclets.arcs, x, y, limit, 1, -1, -1.0, scratch)
    return bool(hit >= 0)
