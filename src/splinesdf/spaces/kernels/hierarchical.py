"""A quadtree that grows, with a ring of cells around its domain, and its spline's coefficients.

Nodes never change their number: what is known of one stays where it is. Children follow one
another: (2i, 2j), (2i, 2j + 1), (2i + 1, 2j), (2i + 1, 2j + 1). A node of the ring is split with
the nodes of the domain beside it, so that every function that reaches into a cell is a node.

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
    near : ndarray, shape (n, 9)
    """
    m, n = nodes.shape[0], nodes.shape[1]
    for node in range((m + 2) * (n + 2)):
        i, j = nodes.place[node, 0], nodes.place[node, 1]
        for a in range(-1, 2):
            for b in range(-1, 2):
                there = -1 <= i + a <= m and -1 <= j + b <= n
                other = (i + a + 1) * (n + 2) + j + b + 1
                near[node, 4 + 3 * a + b] = other if there else _BEYOND
    for node in order:
        child = nodes.child[node]
        if child < 0:
            continue
        limit_i = m << (nodes.level[node] + 1)
        limit_j = n << (nodes.level[node] + 1)
        for k in range(4):
            for a in range(-1, 2):
                for b in range(-1, 2):
                    i, j = (k >> 1) + a, (k & 1) + b
                    other = near[node, 4 + 3 * (i >> 1) + (j >> 1)]
                    if other >= 0 and nodes.child[other] >= 0:
                        found = nodes.child[other] + 2 * (i & 1) + (j & 1)
                    else:
                        x, y = nodes.place[child + k, 0] + a, nodes.place[child + k, 1] + b
                        inside = 0 <= x < limit_i and 0 <= y < limit_j
                        found = _COARSER if inside else _BEYOND
                    near[child + k, 4 + 3 * a + b] = found


@kernel
def owned(nodes: Nodes, own: Bools) -> None:
    """Fill whether a node has a coefficient of its own: its 3 x 3 cells are all as fine."""
    m, n = nodes.shape[0], nodes.shape[1]
    for node in range(nodes.level.shape[0]):
        level = nodes.level[node]
        i, j = nodes.place[node, 0], nodes.place[node, 1]
        own[node] = -1 <= i <= m << level and -1 <= j <= n << level
        for k in range(9):
            if nodes.near[node, k] == _COARSER:
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
        for k in range(9):
            other = nodes.near[node, k]
            if other >= 0 and nodes.child[other] < 0 and _outside(nodes, other):
                split[other] = True
    return again


@uncounted
def _outside(nodes: Nodes, node: int) -> bool:
    level, i, j = nodes.level[node], nodes.place[node, 0], nodes.place[node, 1]
    return not (0 <= i < nodes.shape[0] << level and 0 <= j < nodes.shape[1] << level)


@uncounted
def _ancestor(nodes: Nodes, level: int, i: int, j: int) -> int:
    """The node of a cell, or the finest one around it."""
    node = ((i >> level) + 1) * (nodes.shape[1] + 2) + (j >> level) + 1
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
    m, n = nodes.shape[0], nodes.shape[1]
    for node in order:
        if own[node]:
            result[node] = values[node]
            continue
        level, i, j = nodes.level[node], nodes.place[node, 0], nodes.place[node, 1]
        if not (-1 <= i <= m << level and -1 <= j <= n << level):
            result[node] = 0.0  # in the ring, but no function of it reaches the domain
        else:
            result[node] = _subdivided(nodes, mask, result, level, i, j)


@kernel
def blocks(nodes: Nodes, mask: Mask, cells: Ints, values: Floats, result: Floats) -> None:
    """Fill the coefficients of the 3 x 3 cells around cells from those of all nodes.

    Parameters
    ----------
    nodes : Nodes
    mask : Mask
    cells : ndarray, shape (k,)
        Nodes in the domain that are not split.
    values : ndarray, shape (n,)
    result : ndarray, shape (k, 9)
    """
    for place in range(cells.shape[0]):
        for k in range(9):
            result[place, k] = _near(nodes, mask, values, cells[place], k)


@uncounted
def _near(nodes: Nodes, mask: Mask, values: Floats, node: int, k: int) -> float:
    """The coefficient of the k-th of the 3 x 3 cells around a node."""
    other = nodes.near[node, k]
    if other >= 0:
        return float(values[other])
    level, i, j = nodes.level[node], nodes.place[node, 0], nodes.place[node, 1]
    return _subdivided(nodes, mask, values, level, i + k // 3 - 1, j + k % 3 - 1)


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
        if not (-1 <= x <= nodes.shape[0] << level and -1 <= y <= nodes.shape[1] << level):
            continue
        node = _ancestor(nodes, level, x, y)
        known = nodes.level[node] == level
        value = values[node] if known else _subdivided(nodes, mask, values, level, x, y)
        total += mask.weights[parity, k] * value
    return total
