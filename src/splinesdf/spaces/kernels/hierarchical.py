"""A quadtree that grows, with a ring of cells around its domain, and its spline's coefficients.

Nodes never change their number: what is known of one stays where it is. Children follow one
another: (2i, 2j), (2i, 2j + 1), (2i + 1, 2j), (2i + 1, 2j + 1). Nodes of the ring are split with
the nodes of the domain near them, so that every function that reaches into a cell is a node.

The ring is as wide as B-splines reach beyond their cell (`Element.beyond`), one node or two, and so
is what is near a node: 3 x 3 nodes as below, or 5 x 5.

    neighbors of a node      2  5  8      ^ j
                             1  4  7      |
                             0  3  6      +--> i
"""

from __future__ import annotations

from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.spaces.tables import Mask, Nodes

# Where a neighbor would be: in the domain, but coarser; or beyond it.
_COARSER, _BEYOND = -1, -2


@kernel
def link(nodes: Nodes, order: Ints, near: Ints) -> None:
    """Fill the neighbors of all nodes.

    Parameters
    ----------
    nodes : Nodes
    order : ndarray, shape (n,)
        The nodes, coarse ones first.
    near : ndarray, shape (n, 9 or 25)
    """
    m, n = nodes.shape[0], nodes.shape[1]
    ring = _ring(nodes)
    side, middle = 2 * ring + 1, near.shape[1] // 2
    for node in range((m + 2 * ring) * (n + 2 * ring)):
        i, j = nodes.place[node, 0], nodes.place[node, 1]
        for a in range(-ring, ring + 1):
            for b in range(-ring, ring + 1):
                there = -ring <= i + a < m + ring and -ring <= j + b < n + ring
                other = (i + a + ring) * (n + 2 * ring) + j + b + ring
                near[node, middle + side * a + b] = other if there else _BEYOND
    for node in order:
        child = nodes.child[node]
        if child < 0:
            continue
        limit_i = m << (nodes.level[node] + 1)
        limit_j = n << (nodes.level[node] + 1)
        for k in range(4):
            for a in range(-ring, ring + 1):
                for b in range(-ring, ring + 1):
                    i, j = (k >> 1) + a, (k & 1) + b
                    other = near[node, middle + side * (i >> 1) + (j >> 1)]
                    if other >= 0 and nodes.child[other] >= 0:
                        found = nodes.child[other] + 2 * (i & 1) + (j & 1)
                    else:
                        x, y = nodes.place[child + k, 0] + a, nodes.place[child + k, 1] + b
                        inside = 0 <= x < limit_i and 0 <= y < limit_j
                        found = _COARSER if inside else _BEYOND
                    near[child + k, middle + side * a + b] = found


@kernel
def owned(nodes: Nodes, own: Bools) -> None:
    """Fill whether a node has a coefficient of its own: all cells of its support are as fine."""
    ring = _ring(nodes)
    side, middle = 2 * ring + 1, nodes.near.shape[1] // 2
    for node in range(nodes.level.shape[0]):
        own[node] = _reaches(nodes, nodes.level[node], nodes.place[node, 0], nodes.place[node, 1])
        # The support goes as far to the left as B-splines beyond a cell reach it.
        for a in range(-ring, 2):
            for b in range(-ring, 2):
                if nodes.near[node, middle + side * a + b] == _COARSER:
                    own[node] = False


@kernel
def mark(nodes: Nodes, targets: Ints, split: Bools) -> bool:
    """Mark what must be split so that all targets are; whether once is not enough.

    Parameters
    ----------
    nodes : Nodes
    targets : ndarray, shape (k, 3)
        Level, i, j of cells, those outside the domain are passed over.
    split : ndarray of bool, shape (n,)
    """
    again = False
    m, n = nodes.shape[0], nodes.shape[1]
    for target in range(targets.shape[0]):
        level, i, j = targets[target, 0], targets[target, 1], targets[target, 2]
        if not (0 <= i < m << level and 0 <= j < n << level):
            continue
        node = _ancestor(nodes, level, i, j)
        if nodes.child[node] >= 0:
            continue
        again = again or nodes.level[node] < level
        split[node] = True
        for k in range(nodes.near.shape[1]):
            other = nodes.near[node, k]
            if other >= 0 and nodes.child[other] < 0 and _outside(nodes, other):
                split[other] = True
    return again


@uncounted
def _ring(nodes: Nodes) -> int:
    """How wide the ring is."""
    return 1 if nodes.near.shape[1] == 9 else 2


@uncounted
def _reaches(nodes: Nodes, level: int, i: int, j: int) -> bool:
    """Whether a B-spline reaches into the domain."""
    beyond = _ring(nodes) - 1
    in_x = -1 <= i <= (nodes.shape[0] << level) + beyond
    return bool(in_x and -1 <= j <= (nodes.shape[1] << level) + beyond)


@uncounted
def _outside(nodes: Nodes, node: int) -> bool:
    level, i, j = nodes.level[node], nodes.place[node, 0], nodes.place[node, 1]
    return not (0 <= i < nodes.shape[0] << level and 0 <= j < nodes.shape[1] << level)


@uncounted
def _ancestor(nodes: Nodes, level: int, i: int, j: int) -> int:
    """The node of a cell, or the finest one around it."""
    ring = _ring(nodes)
    node = ((i >> level) + ring) * (nodes.shape[1] + 2 * ring) + (j >> level) + ring
    for k in range(level - 1, -1, -1):
        if nodes.child[node] < 0:
            break
        node = nodes.child[node] + 2 * ((i >> k) & 1) + ((j >> k) & 1)
    return int(node)


@kernel
def coefficients(
    nodes: Nodes, mask: Mask, order: Ints, own: Bools, values: Floats, result: Floats
) -> None:
    """Fill the coefficient of every node: its own value, or by subdivision of coarser ones."""
    for node in order:
        if own[node]:
            result[node] = values[node]
            continue
        level, i, j = nodes.level[node], nodes.place[node, 0], nodes.place[node, 1]
        if not _reaches(nodes, level, i, j):
            result[node] = 0.0  # in the ring, but no function of it reaches the domain
        else:
            result[node] = _subdivided(nodes, mask, result, level, i, j)


@kernel
def blocks(nodes: Nodes, mask: Mask, cells: Ints, values: Floats, result: Floats) -> None:
    """Fill the coefficients that reach into cells from those of all nodes.

    Parameters
    ----------
    nodes : Nodes
    mask : Mask
    cells : ndarray, shape (k,)
        Nodes in the domain that are not split.
    values : ndarray, shape (n,)
    result : ndarray, shape (k, 9 or 16)
        Of the cells from one before to one or two beyond, the upper ones running first.
    """
    side = _ring(nodes) + 2
    for place in range(cells.shape[0]):
        for k in range(side * side):
            a, b = k // side - 1, k % side - 1
            result[place, k] = _near(nodes, mask, values, cells[place], a, b)


@uncounted
def _near(nodes: Nodes, mask: Mask, values: Floats, node: int, a: int, b: int) -> float:
    """The coefficient of the node that is (a, b) nodes further."""
    other = nodes.near[node, nodes.near.shape[1] // 2 + (2 * _ring(nodes) + 1) * a + b]
    if other >= 0:
        return float(values[other])
    level, i, j = nodes.level[node], nodes.place[node, 0], nodes.place[node, 1]
    return _subdivided(nodes, mask, values, level, i + a, j + b)


@uncounted
def _subdivided(nodes: Nodes, mask: Mask, values: Floats, level: int, i: int, j: int) -> float:
    """A coefficient from those of the level below, which are known where there are nodes."""
    level -= 1
    if level < 0:
        return 0.0
    total = 0.0
    parity = 2 * (i & 1) + (j & 1)
    for k in range(mask.weights.shape[1]):
        x, y = (i >> 1) + mask.steps[parity, k, 0], (j >> 1) + mask.steps[parity, k, 1]
        if not _reaches(nodes, level, x, y):
            continue
        node = _ancestor(nodes, level, x, y)
        known = nodes.level[node] == level
        value = values[node] if known else _subdivided(nodes, mask, values, level, x, y)
        total += mask.weights[parity, k] * value
    return total
