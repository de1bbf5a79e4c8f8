"""The quadtree and its space the slow way: cells looked up by numbers, level after level."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from splinesdf.meshes import Mesh, Quadtree

Functional = Callable[[int, np.ndarray], np.ndarray]

_AROUND = np.array([(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)])


def hierarchical_ordinates(mesh: Quadtree, functional: Functional) -> np.ndarray:
    """Ordinates of the hierarchical quasi-interpolant.

    Parameters
    ----------
    mesh : Quadtree
    functional : callable
        ``functional(level, cells)`` with cells of shape (n, 2), one ring beyond the domain
        included, answers the coefficients (n,) of the uniform quasi-interpolant of that level.

    Returns
    -------
    ndarray, shape (n_cells, 8)
    """
    result = np.empty((len(mesh.leaves), 8))
    coarse_keys, coarse = np.empty(0, dtype=np.int64), np.empty(0)
    for level in range(mesh.depth + 1):
        nodes = np.flatnonzero(mesh.level == level)
        keys, cells = _with_ring(mesh.index[nodes])
        values = np.empty(len(cells))
        own = _support_refined(mesh, level, cells)
        values[own] = functional(level, cells[own])
        if not own.all():
            values[~own] = _subdivide(cells[~own], coarse_keys, coarse)
        leaves = nodes[mesh.child[nodes] < 0]
        block = _look_up(keys, values, mesh.index[leaves])
        result[mesh.cell_of[leaves]] = _cell_ordinates(block)
        coarse_keys, coarse = keys, values
    return result


def _with_ring(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cells and all their neighbors, sorted by key, each once."""
    every = (cells[:, None] + _AROUND).reshape(-1, 2)
    keys, first = np.unique(cell_keys(every), return_index=True)
    return keys, every[first]


def _support_refined(mesh: Quadtree, level: int, cells: np.ndarray) -> np.ndarray:
    """Whether the 3 x 3 cells around each cell all exist at this level, inside the domain."""
    result = np.ones(len(cells), dtype=bool)
    for shift in _AROUND:
        neighbor = cells + shift
        result &= (find(mesh, level, neighbor) >= 0) | outside(mesh, level, neighbor)
    return result


def _subdivide(cells: np.ndarray, coarse_keys: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    parent = cells >> 1
    toward = 2 * (cells & 1) - 1
    beside_x = parent + toward * np.array([1, 0])
    beside_y = parent + toward * np.array([0, 1])
    at = [np.searchsorted(coarse_keys, cell_keys(p)) for p in (parent, beside_x, beside_y)]
    return 0.5 * coarse[at[0]] + 0.25 * (coarse[at[1]] + coarse[at[2]])


def _look_up(keys: np.ndarray, values: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Coefficients of the 3 x 3 block around each cell, shape (n, 3, 3)."""
    every = (cells[:, None] + _AROUND).reshape(-1, 2)
    return values[np.searchsorted(keys, cell_keys(every))].reshape(-1, 3, 3)


def _cell_ordinates(c: np.ndarray) -> np.ndarray:
    """Eight ordinates of uniform cells from the 3 x 3 coefficients around each."""
    low, high = slice(0, 2), slice(1, 3)
    corners = [c[:, a, b].mean(axis=(1, 2)) for b in (low, high) for a in (low, high)]
    middle = c[:, 1, 1]
    sides = [0.5 * (middle + other) for other in (c[:, 1, 0], c[:, 2, 1], c[:, 1, 2], c[:, 0, 1])]
    return np.stack(corners + sides, axis=1)


def refine(mesh: Quadtree, cells: np.ndarray) -> Quadtree:
    """Halve the 3 x 3 block around every marked cell, so that new functions cover it whole.

    A B-spline of the next level is used where its support lies in cells of that level: the
    nine functions over the children of a cell reach one cell of this level further.
    """
    marked = mesh.leaves[cells]
    around = np.array([(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)])
    wanted: list[np.ndarray] = []
    blocks: np.ndarray = np.empty((0, 2), dtype=np.int64)
    for level in range(mesh.depth, -1, -1):
        here = mesh.index[marked[mesh.level[marked] == level]]
        blocks = np.concatenate([blocks >> 1, (here[:, None] + around).reshape(-1, 2)])
        blocks = blocks[~outside(mesh, level, blocks)]
        blocks = np.unique(blocks, axis=0) if len(blocks) else blocks
        wanted.append(blocks)
    wanted.reverse()
    levels, indices, children = [], [], []
    index = mesh.index[mesh.level == 0]
    total = 0
    for level in range(mesh.depth + 2):
        old = find(mesh, level, index) if level <= mesh.depth else np.full(len(index), -1)
        split = np.where(old >= 0, mesh.child[old], -1) >= 0
        if level < len(wanted) and len(wanted[level]):
            split |= _contains(wanted[level], index)
        total += len(index)
        child = np.full(len(index), -1)
        child[split] = total + 4 * np.arange(np.count_nonzero(split))
        levels.append(np.full(len(index), level))
        indices.append(index)
        children.append(child)
        if not split.any():
            break
        index = _quarters(index[split])
    return Quadtree(
        mesh.domain,
        mesh.shape,
        np.concatenate(levels),
        np.concatenate(indices),
        np.concatenate(children),
    )


def find(mesh: Quadtree, level: int, index: np.ndarray) -> np.ndarray:
    """The node of each cell (n, 2) of a level, -1 where the tree has none."""
    limits = np.array(mesh.shape) * 2**level
    inside = np.all((index >= 0) & (index < limits), axis=1)
    index = np.where(inside[:, None], index, 0)
    top = index >> level
    node = top[:, 0] * mesh.shape[1] + top[:, 1]
    for k in range(level - 1, -1, -1):
        bits = (index >> k) & 1
        below = mesh.child[node]
        node = np.where((below >= 0) & (node >= 0), below + 2 * bits[:, 0] + bits[:, 1], -1)
    return np.where(inside, node, -1)


def outside(mesh: Quadtree, level: int, index: np.ndarray) -> np.ndarray:
    """True for cells of a level that lie beyond the domain."""
    limits = np.array(mesh.shape) * 2**level
    return np.asarray(np.any((index < 0) | (index >= limits), axis=1))


def cell_keys(index: np.ndarray) -> np.ndarray:
    """One sortable number for each cell (n, 2) of a level, one ring outside the domain included."""
    return np.asarray((index[:, 0] + 1) * 2**31 + index[:, 1] + 1, dtype=np.int64)


def _contains(cells: np.ndarray, index: np.ndarray) -> np.ndarray:
    return np.isin(cell_keys(index), cell_keys(cells))


def _quarters(index: np.ndarray) -> np.ndarray:
    quarter = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])
    return (2 * index[:, None] + quarter).reshape(-1, 2)


def cells_at(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """The cell of each point, by looking at all; the domain's far borders are its last cells'."""
    low, high = mesh.boxes[:, :2], mesh.boxes[:, 2:]
    beyond = np.where(high == np.array(mesh.domain[2:]), np.inf, high)
    result = np.empty(len(points), dtype=np.int64)
    for k, point in enumerate(points):
        (result[k],) = np.flatnonzero(np.all((low <= point) & (point < beyond), axis=1))
    return result
