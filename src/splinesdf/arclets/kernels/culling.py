"""Which parts of a curve can be closest to some point of a cell, down a quadtree.

A cell inherits the nodes of its parent that pass a test, or their children. Some point q of the
curve is at the distance d from the middle of the cell, in the direction -m; a node's capsule is at
e from it, in the direction -n. At a place moved by v from the middle, |v| <= r:

    q is no farther than        d + m.v + |v|^2 / (2 (d - r))     (second-order bound, for r < d)
    the capsule no nearer than  e + n.v                           (it is convex)

so the node can be left if e - d > |m - n| r + r^2 / (2 (d - r)), and always if e - d > 2 r.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.kernels.arclet import below, from_axis, point_on
from splinesdf.arclets.tables import Cells
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted

# Nodes that a cell keeps at most. More: the walk of each point starts lower; fewer: less memory.
MOST_KEPT = 48
# The walk's stack: a balanced tree over 2^60 arclets is no deeper, and what a cell keeps.
_STACK = 64 + MOST_KEPT
# A bound that a distance is compared with is raised by this share and by _GRAIN times the largest
# coordinate, so that rounding cannot hide what is closest.
_SLACK = 1e-12
_GRAIN = 16 * 2.220446049250313e-16
# A node is kept rather than its children if its arcs are no longer than this many half diagonals.
# Shorter: more nodes for each point to try; longer: more levels for each point to walk.
_NODE_SIZE = 2.0


class _Room(NamedTuple):
    """What the cells around the current one keep, and room for the walk."""

    kept: Ints  # (levels + 2, MOST_KEPT) of the cell of each level; level 0 is the whole plane
    sizes: Ints  # (levels + 2,) how many
    bounds: Floats  # (MOST_KEPT,)
    stack: Ints


@kernel
def cull_cells(tree: Floats, arcs: Floats, cells: Cells, starts: Ints, nodes: Ints) -> None:
    """Fill the candidates of all cells that have two points or more; for the others, the root.

    Parameters
    ----------
    tree, arcs : ndarray
        Of `Arclets`.
    cells : Cells
        Relative to the arclets' origin.
    starts, nodes : ndarray, shapes (n_cells + 1,), (n_cells * MOST_KEPT,)
        As in `Candidates`; the end of ``nodes`` is left as it is.
    """
    room = _Room(
        np.zeros((cells.levels + 2, MOST_KEPT), dtype=np.int64),
        np.ones(cells.levels + 2, dtype=np.int64),
        np.empty(MOST_KEPT),
        np.empty(_STACK, dtype=np.int64),
    )
    _cull_all(tree, arcs, cells, room, starts, nodes)


@uncounted
def _cull_all(
    tree: Floats, arcs: Floats, cells: Cells, room: _Room, starts: Ints, nodes: Ints
) -> None:
    last_cell = int(np.int64(-1))  # a literal would be compiled for by itself
    total = 0
    last = cells.starts.shape[0] - 2
    for cell in range(last + 1):
        starts[cell] = total
        level = 0
        # The last cell is all that is outside the others; a single point is no help to itself.
        if cell < last and cells.starts[cell + 1] - cells.starts[cell] > 1:
            level = cells.levels + 1
            for around in range(_shared(last_cell, cell, cells.levels), level):
                room.sizes[around + 1] = _cull(
                    tree,
                    arcs,
                    _disk(cells, cell, around),
                    room.kept[around, : room.sizes[around]],
                    room.kept[around + 1],
                    room.bounds,
                    room.stack,
                )
            last_cell = cell
        for j in range(room.sizes[level]):
            nodes[total] = room.kept[level, j]
            total += 1
    starts[last + 1] = total


@kernel
def cull_boxes(tree: Floats, arcs: Floats, boxes: Floats, starts: Ints, nodes: Ints) -> None:
    """Fill the candidates of boxes (n, 4), each from the root of the tree; see `cull_cells`."""
    stack = np.empty(_STACK, dtype=np.int64)
    root, bounds = np.zeros(1, dtype=np.int64), np.empty(MOST_KEPT)
    total = 0
    for i in range(boxes.shape[0]):
        starts[i] = total
        width, height = boxes[i, 2] - boxes[i, 0], boxes[i, 3] - boxes[i, 1]
        reach = 0.5 * math.sqrt(width * width + height * height)
        x, y = 0.5 * (boxes[i, 0] + boxes[i, 2]), 0.5 * (boxes[i, 1] + boxes[i, 3])
        total += _cull(tree, arcs, (x, y, reach), root, nodes[total:], bounds, stack)
    starts[boxes.shape[0]] = total


@uncounted
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


@uncounted
def _disk(cells: Cells, cell: int, level: int) -> tuple[float, float, float]:
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
    return x, y, 0.5 * math.sqrt(width * width + height * height)


@uncounted
def _cull(
    tree: Floats,
    arcs: Floats,
    disk: tuple[float, float, float],
    parent: Ints,
    kept: Ints,
    bounds: Floats,
    stack: Ints,
) -> int:
    """Fill the nodes under the parent's that can be closest in a disk: x, y and radius."""
    x, y, reach = disk
    size = parent.shape[0]
    for j in range(size):
        stack[j] = parent[size - 1 - j]
    distance, mx, my = _near_point(tree, arcs, x, y, stack, size)
    grain = _GRAIN * (abs(tree[0, 0]) + abs(tree[0, 1]) + abs(tree[0, 2]) + abs(tree[0, 3]))
    reach += _SLACK * (distance + reach) + grain
    far = distance > 1.5 * reach
    bend = reach * reach / (2.0 * (distance - reach)) if far else 0.0
    for j in range(size):
        stack[j] = parent[j]
    total = 0
    while size > 0:
        size -= 1
        node = int(stack[size])
        nx, ny = from_axis(tree, node, x, y)
        axis = math.sqrt(nx * nx + ny * ny)
        margin = 2.0 * reach
        if far and axis > 0.0:
            turn = math.sqrt((mx - nx / axis) ** 2 + (my - ny / axis) ** 2)
            margin = min(margin, turn * reach + bend)
        bound = axis - tree[node, 5]
        if bound > distance + margin:
            continue
        first, last = int(tree[node, 6]), int(tree[node, 7])
        length = abs(tree[node, 2]) + abs(tree[node, 3]) + 2.0 * tree[node, 5]
        if last - first > 1 and length > _NODE_SIZE * reach and size + total + 2 < MOST_KEPT:
            stack[size], stack[size + 1] = below(node, first, last)
            size += 2
            continue
        place = total
        while place > 0 and bounds[place - 1] > bound:
            kept[place], bounds[place] = kept[place - 1], bounds[place - 1]
            place -= 1
        kept[place], bounds[place] = node, bound
        total += 1
    return total


@uncounted
def _near_point(
    tree: Floats, arcs: Floats, x: float, y: float, stack: Ints, size: int
) -> tuple[float, float, float]:
    """Distance and direction from a point of the curve that is about the nearest to (x, y)."""
    best = np.inf
    mx = my = 0.0
    while size > 0:
        size -= 1
        node = int(stack[size])
        wx, wy = from_axis(tree, node, x, y)
        if math.sqrt(wx * wx + wy * wy) - tree[node, 5] >= best:
            continue
        first, last = int(tree[node, 6]), int(tree[node, 7])
        if last - first == 1:
            px, py = _about_nearest(arcs, first, x, y)
            distance = math.sqrt((x - px) ** 2 + (y - py) ** 2)
            if distance < best:
                best, mx, my = distance, x - px, y - py
            continue
        left, right = below(node, first, last)
        ux, uy = from_axis(tree, left, x, y)
        vx, vy = from_axis(tree, right, x, y)
        if ux * ux + uy * uy < vx * vx + vy * vy:
            left, right = right, left
        stack[size], stack[size + 1] = left, right
        size += 2
    if best > 0.0:
        mx, my = mx / best, my / best
    return best, mx, my


@uncounted
def _about_nearest(arcs: Floats, i: int, x: float, y: float) -> tuple[float, float]:
    """The point of a nearly straight arclet at the parameter of the nearest one on its chord."""
    dx, dy = arcs[i, 1] - arcs[i, 3], arcs[i, 2] - arcs[i, 4]
    squared = dx * dx + dy * dy
    share = (x - arcs[i, 3]) * dx + (y - arcs[i, 4]) * dy
    t = min(max(share / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    return point_on(arcs, i, t)
