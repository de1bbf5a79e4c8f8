"""A tree over arclets in their order along the curve: each node has a box and a capsule.

A capsule is all that lies within a radius of a segment. Around a smooth arc of length L its
radius shrinks like L², a box's slack only like L: with boxes alone, a search among n short arcs
visits about sqrt(n) of them, with capsules about log(n).

         box                         capsule of the same arcs
    +---------ooo                          _ooo
    |     ooo   |                       ooo
    | ooo       |                    ooo
    ooo---------+                  ooo
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.tables import Arclets, Hierarchy
from splinesdf.ground.arrays import Floats, Ints

# Rounding in a distance to a segment, in units of the coordinates' size. Too small: a true
# minimum may be pruned; too large: a few nodes are visited in vain.
_ROUNDING = 16 * 2.220446049250313e-16
# A random point in the drawing's box lies in the boxes of about as many nodes as the tree is deep
# if contours lie beside one another. If it lies in so many times more, the curve winds around
# itself, as a spiral does, and all of its turns are looked at for each point. Larger: such curves
# take time like the square of their length; smaller: a second tree is made in vain. With fewer
# arclets than the second number it is never made.
_WINDS, _MANY = 6.0, 1024
# Bits of each coordinate in the order of places.
_BITS = 24


class SearchTree(NamedTuple):
    """What searches for arclets in a place read, as the columns of `Arclets` of these names.

    The range of a leaf is its arclet; the ranges of other nodes only say how many are below.
    """

    tree: Floats
    boxes: Floats
    range: Ints


def search_tree(arclets: Arclets) -> SearchTree:
    """The tree of arclets along the curve, or in the order of places where that is far better."""
    tree, boxes, ranges = arclets.tree, arclets.boxes, arclets.range
    count = len(arclets.start)
    if count < _MANY:
        return SearchTree(tree, boxes, ranges)
    sides = boxes[:, 2:] - boxes[:, :2]
    areas = sides[:, 0] * sides[:, 1]
    if not float(areas.sum()) > _WINDS * math.log2(count) * float(areas[0]):
        return SearchTree(tree, boxes, ranges)
    leaves = ranges[:, 1] - ranges[:, 0] == 1
    own, radius = boxes[leaves], tree[leaves, 5]
    order = np.argsort(along_z(0.5 * (own[:, :2] + own[:, 2:])), kind="stable")
    # Of arclets in this order no two are known to follow one another.
    tree, boxes, ranges, _ = build_hierarchy(
        arclets.start[order], arclets.end[order], own[order], radius[order], np.arange(count)
    )
    leaves = ranges[:, 1] - ranges[:, 0] == 1
    ranges[leaves] = np.column_stack([order, order + 1])
    tree[leaves, 6:] = ranges[leaves]
    return SearchTree(tree, boxes, ranges)


def along_z(points: Floats, bits: int = _BITS) -> Ints:
    """Where points (n, 2) lie along the Z-shaped curve through the cells of a lattice: (n,)."""
    low = points.min(axis=0)
    reach = np.maximum(points.max(axis=0) - low, np.finfo(np.float64).tiny)
    cells = ((points - low) / reach * (2.0**bits - 1.0)).astype(np.int64)
    key = np.zeros(len(points), dtype=np.int64)
    for bit in range(bits):
        key |= ((cells[:, 0] >> bit) & 1) << (2 * bit) | ((cells[:, 1] >> bit) & 1) << (2 * bit + 1)
    return key


def build_hierarchy(
    start: Floats, end: Floats, boxes: Floats, radius: Floats, label: Ints
) -> Hierarchy:
    """The preorder tree that halves the list of arclets again and again.

    Parameters
    ----------
    start, end : ndarray, shape (n, 2)
        Of each arclet, relative to the middle of them all.
    boxes : ndarray, shape (n, 4)
        xmin, ymin, xmax, ymax of each.
    radius : ndarray, shape (n,)
        No point of the arclet is farther than this from its chord.
    label : ndarray, shape (n,)
        Equal for arclets of one run in which each starts where the last one ended.

    Returns
    -------
    Hierarchy
        Of 2 n - 1 nodes: a node's left child follows it, and the children halve its range of
        arclets. See `splinesdf.arclets.tables` for the columns.
    """
    from splinesdf.arclets.kernels.assembly import fill_hierarchy  # Numba loads only when used

    nodes = 2 * len(boxes) - 1
    found = Hierarchy(
        tree=np.empty((nodes, 8)),
        boxes=np.empty((nodes, 4)),
        range=np.empty((nodes, 2), dtype=np.int64),
        chain=np.empty(nodes, dtype=np.int64),
    )
    fill_hierarchy(start, end, boxes, radius, label, found)
    found.tree[:, 5] += _ROUNDING * float(np.abs(found.boxes[0]).max())
    return found
