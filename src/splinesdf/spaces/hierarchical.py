"""The truncated hierarchical space on a quadtree, without writing down its basis.

The coefficient of function (i, j) of level l is the quasi-interpolant's functional of that level
if the function's whole support, the 3 x 3 cells around (i, j), lies in cells of level l or finer;
else it comes from level l - 1 by subdivision. Then every leaf is an ordinary cell of its level, and
the spline is C¹ across levels.

    level l - 1:  ·   ·   ·         a child's coefficient by subdivision: half its parent's and
                  · [o o] ·         a quarter each of the parent's neighbors on the child's sides
                  · [o o] ·

References
----------
[Speleers2016] Effortless quasi-interpolation in hierarchical spaces.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from splinesdf._arrays import Floats, Ints
from splinesdf.meshes.quadtree import Quadtree, cell_keys

# (level, cells (n, 2)) -> the functional of that level for these cells, (n,)
Functional = Callable[[int, Ints], Floats]

_AROUND = np.array([(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)])


def hierarchical_ordinates(mesh: Quadtree, functional: Functional) -> Floats:
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


def _with_ring(cells: Ints) -> tuple[Ints, Ints]:
    """The cells and all their neighbors, sorted by key, each once."""
    every = (cells[:, None] + _AROUND).reshape(-1, 2)
    keys, first = np.unique(cell_keys(every), return_index=True)
    return keys, every[first]


def _support_refined(mesh: Quadtree, level: int, cells: Ints) -> np.ndarray:
    """Whether the 3 x 3 cells around each cell all exist at this level, inside the domain."""
    result = np.ones(len(cells), dtype=bool)
    for shift in _AROUND:
        neighbor = cells + shift
        result &= (mesh.find(level, neighbor) >= 0) | mesh.outside(level, neighbor)
    return result


def _subdivide(cells: Ints, coarse_keys: Ints, coarse: Floats) -> Floats:
    parent = cells >> 1
    toward = 2 * (cells & 1) - 1
    beside_x = parent + toward * np.array([1, 0])
    beside_y = parent + toward * np.array([0, 1])
    at = [np.searchsorted(coarse_keys, cell_keys(p)) for p in (parent, beside_x, beside_y)]
    return 0.5 * coarse[at[0]] + 0.25 * (coarse[at[1]] + coarse[at[2]])


def _look_up(keys: Ints, values: Floats, cells: Ints) -> Floats:
    """Coefficients of the 3 x 3 block around each cell, shape (n, 3, 3)."""
    every = (cells[:, None] + _AROUND).reshape(-1, 2)
    return values[np.searchsorted(keys, cell_keys(every))].reshape(-1, 3, 3)


def _cell_ordinates(c: Floats) -> Floats:
    """Eight ordinates of uniform cells from the 3 x 3 coefficients around each."""
    low, high = slice(0, 2), slice(1, 3)
    corners = [c[:, a, b].mean(axis=(1, 2)) for b in (low, high) for a in (low, high)]
    middle = c[:, 1, 1]
    sides = [0.5 * (middle + other) for other in (c[:, 1, 0], c[:, 2, 1], c[:, 1, 2], c[:, 0, 1])]
    return np.stack(corners + sides, axis=1)
