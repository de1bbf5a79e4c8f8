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

from splinesdf.arclets.tables import Arclets
from splinesdf.ground.arrays import Floats, Ints

# Rounding in a distance to a segment, in units of the coordinates' size. Too small: a true
# minimum may be pruned; too large: a few nodes are visited in vain.
_ROUNDING = 16 * 2.220446049250313e-16
# A random point in the drawing's box lies in the boxes of about as many nodes as the tree is deep
# if contours lie beside one another. If it lies in so many times more, the curve winds around
# itself, as a spiral does, and all of its turns are looked at for each point. Larger: such curves
# take time like the square of their length; smaller: a second tree is made in vain. With fewer
# arclets than the second number it is never made.
_WINDS, _MANY = 3.0, 1024
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
    boxes, tree, ranges, _ = build_hierarchy(
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
) -> tuple[Floats, Floats, Ints, Ints]:
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
    boxes : ndarray, shape (2 n - 1, 4)
    tree : ndarray, shape (2 n - 1, 8)
        See `splinesdf.arclets.tables`.
    range : ndarray, shape (2 n - 1, 2)
        First and past-the-end arclet. A node's left child follows it; the children halve the range.
    chain : ndarray, shape (2 n - 1,)
        1 if the node's arclets follow one another.
    """
    count = len(boxes)
    ranges, levels = _ranges(count)
    node_boxes = np.empty((2 * count - 1, 4))
    ends = np.empty((2 * count - 1, 4))
    radii = np.empty(2 * count - 1)
    leaves = ranges[:, 1] - ranges[:, 0] == 1
    arclet = ranges[leaves, 0]
    node_boxes[leaves] = boxes[arclet]
    ends[leaves, :2], ends[leaves, 2:] = start[arclet], end[arclet]
    radii[leaves] = radius[arclet]
    chain = label[ranges[:, 0]] == label[ranges[:, 1] - 1]
    for node in reversed(levels):
        right = node + 2 * ((ranges[node, 0] + ranges[node, 1]) // 2 - ranges[node, 0])
        both = np.stack([node + 1, right])
        node_boxes[node, :2] = node_boxes[both, :2].min(axis=0)
        node_boxes[node, 2:] = node_boxes[both, 2:].max(axis=0)
        chords = np.column_stack([start[ranges[node, 0]], end[ranges[node, 1] - 1]])
        chords = _shifted(chords, ends[both], radii[both])
        around_chord = _radius(chords, ends[both], radii[both])
        middles, around_box = _along_box(node_boxes[node])
        tighter = (around_box < around_chord)[:, None]
        ends[node] = np.where(tighter, middles, chords)
        radii[node] = np.minimum(around_box, around_chord)
    vectors = ends[:, 2:] - ends[:, :2]
    squared = np.sum(vectors * vectors, axis=1)
    # So short that its inverse would overflow: a point, and what it is long is radius.
    point = squared < np.finfo(np.float64).tiny
    radii[point] += np.sqrt(squared[point])
    vectors[point] = 0.0
    with np.errstate(divide="ignore"):
        inverse = np.where(point, 0.0, 1.0 / squared)
    size = float(np.abs(node_boxes[0]).max())
    tree = np.column_stack([ends[:, :2], vectors, inverse, radii + _ROUNDING * size, ranges])
    return node_boxes, tree, ranges, chain.astype(np.int64)


def _ranges(count: int) -> tuple[Ints, list[Ints]]:
    """The arclets of each node, and the inner nodes level by level."""
    node = np.zeros(1, dtype=np.int64)
    first, last = np.zeros(1, dtype=np.int64), np.full(1, count)
    ranges = np.empty((2 * count - 1, 2), dtype=np.int64)
    levels = []
    while len(node):
        ranges[node] = np.column_stack([first, last])
        inner = last - first > 1
        node, first, last = node[inner], first[inner], last[inner]
        levels.append(node)
        middle = (first + last) // 2
        node, first, last = (
            np.concatenate([node + 1, node + 2 * (middle - first)]),
            np.concatenate([first, middle]),
            np.concatenate([middle, last]),
        )
    return ranges, levels


def _shifted(chords: Floats, ends: Floats, radii: Floats) -> Floats:
    """Chords moved sideways into the middle of two capsules: an arc bulges to one side only."""
    along = chords[:, 2:] - chords[:, :2]
    length = np.hypot(along[:, 0], along[:, 1])
    normal = np.column_stack([-along[:, 1], along[:, 0]]) / np.where(length, length, 1.0)[:, None]
    points = ends.reshape(2, -1, 2, 2) - chords[:, None, :2]
    across = np.sum(points * normal[:, None], axis=-1)
    low = (across - radii[..., None]).min(axis=(0, 2))
    high = (across + radii[..., None]).max(axis=(0, 2))
    return np.asarray(chords + np.tile(0.5 * (low + high)[:, None] * normal, 2))


def _radius(chords: Floats, ends: Floats, radii: Floats) -> Floats:
    """How far two capsules (2, n, ...) reach from chords (n, 4).

    The distance to a segment is convex, so over another segment it is largest at an end.
    """
    from_start = ends.reshape(2, -1, 2, 2) - chords[:, None, :2]
    along = chords[:, 2:] - chords[:, :2]
    squared = np.maximum(np.sum(along * along, axis=1), np.finfo(np.float64).tiny)
    share = np.sum(from_start * along[:, None], axis=-1) / squared[:, None]
    rest = from_start - np.clip(share, 0.0, 1.0)[..., None] * along[:, None]
    return np.asarray((np.hypot(rest[..., 0], rest[..., 1]).max(axis=2) + radii).max(axis=0))


def _along_box(boxes: Floats) -> tuple[Floats, Floats]:
    """The middle lines of boxes along their longer sides, and half of the shorter sides."""
    middle = 0.5 * (boxes[:, :2] + boxes[:, 2:])
    sides = boxes[:, 2:] - boxes[:, :2]
    wide = sides[:, 0] >= sides[:, 1]
    reach = 0.5 * sides * np.column_stack([wide, ~wide])
    return np.column_stack([middle - reach, middle + reach]), 0.5 * sides.min(axis=1)
