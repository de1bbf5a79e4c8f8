"""Quadtree: a uniform grid whose cells are halved again and again where it matters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from splinesdf._arrays import Bools, Floats, Ints
from splinesdf.errors import InputError
from splinesdf.meshes.mesh import Box, check_domain

# Lattice coordinates of the finest level, times a few roots, must stay far inside 63 bits when two
# of them are packed into one key.
DEEPEST = 26


@dataclass(frozen=True, eq=False)
class Quadtree:
    """Nodes of all levels, level after level; the leaves are the cells.

    A node at level l is cell (i, j) of the grid with ``shape * 2**l`` cells. Its four children
    follow one another: (2i, 2j), (2i, 2j+1), (2i+1, 2j), (2i+1, 2j+1).

    Attributes
    ----------
    domain : tuple of float
    shape : tuple of int
        Cells each way at level 0.
    level, index : ndarray, shapes (n_nodes,), (n_nodes, 2)
    child : ndarray, shape (n_nodes,)
        First child of a node, -1 for a leaf.
    """

    domain: Box
    shape: tuple[int, int]
    level: Ints
    index: Ints
    child: Ints

    @classmethod
    def uniform(cls, domain: Box, m: int, n: int) -> Quadtree:
        """The tree that is only its m x n roots."""
        if m < 1 or n < 1:
            raise InputError(f"expected at least one cell each way, got {m} x {n}")
        index = np.column_stack([np.repeat(np.arange(m), n), np.tile(np.arange(n), m)])
        level, child = np.zeros(m * n, dtype=np.int64), np.full(m * n, -1)
        return cls(check_domain(domain), (m, n), level, index, child)

    @classmethod
    def from_splits(cls, domain: Box, shape: tuple[int, int], split: Bools) -> Quadtree:
        """The tree whose nodes, level after level, are split or not; the flags determine it.

        Raises
        ------
        InputError
            If there are too few or too many flags for the nodes that they make.
        """
        m, n = shape
        if m * n > len(split):
            raise InputError("expected a flag for every node of the quadtree, got too few")
        tree = cls.uniform(domain, m, n)
        levels, indices, children = [], [], []
        index, start, level = tree.index, 0, 0
        while len(index):
            stop = start + len(index)
            here = split[start:stop]
            if len(here) < len(index) or level > DEEPEST:
                raise InputError("expected a flag for every node of the quadtree, got too few")
            child = np.full(len(index), -1)
            child[here] = stop + 4 * np.arange(np.count_nonzero(here))
            levels.append(np.full(len(index), level))
            indices.append(index)
            children.append(child)
            index, start, level = _quarters(index[here]), stop, level + 1
        if start != len(split):
            raise InputError("expected a flag for every node of the quadtree, got too many")
        return cls(
            tree.domain,
            tree.shape,
            np.concatenate(levels),
            np.concatenate(indices),
            np.concatenate(children),
        )

    @cached_property
    def leaves(self) -> Ints:
        """Nodes that are cells: cell number -> node."""
        return np.flatnonzero(self.child < 0)

    @cached_property
    def cell_of(self) -> Ints:
        """Node -> cell number, -1 for inner nodes."""
        result = np.full(len(self.child), -1)
        result[self.leaves] = np.arange(len(self.leaves))
        return result

    @property
    def depth(self) -> int:
        """The finest level."""
        return int(self.level[-1])

    def side(self, level: Ints | int) -> Floats:
        """Cell sides at a level, shape (..., 2)."""
        xmin, ymin, xmax, ymax = self.domain
        roots = np.array([(xmax - xmin) / self.shape[0], (ymax - ymin) / self.shape[1]])
        return roots * np.exp2(-np.asarray(level, dtype=np.float64))[..., None]

    @cached_property
    def boxes(self) -> Floats:
        """The cells, shape (n, 4). Equal lattice corners are equal numbers."""
        xmin, ymin, xmax, ymax = self.domain
        scale = np.exp2(-float(self.depth))
        steps = np.array([(xmax - xmin) / self.shape[0], (ymax - ymin) / self.shape[1]]) * scale
        corners = self.corners
        return np.column_stack(
            [corners[:, :2] * steps + [xmin, ymin], corners[:, 2:] * steps + [xmin, ymin]]
        )

    @property
    def corners(self) -> Ints:
        """Cells on the lattice of the finest level."""
        size = 2 ** (self.depth - self.level[self.leaves])[:, None]
        low = self.index[self.leaves] * size
        return np.concatenate([low, low + size], axis=1)

    def locate(self, points: Floats) -> Ints:
        """The cell of each point; the domain's right and upper border belong to its last cells."""
        from splinesdf.kernels.locate import locate_tree  # Numba loads only when it is used

        cells = np.empty(len(points), dtype=np.int64)
        domain, shape = np.array(self.domain), np.array(self.shape)
        locate_tree(domain, shape, self.child, self.cell_of, points, cells)
        return cells

    def find(self, level: int, index: Ints) -> Ints:
        """The node of each cell (n, 2) of a level, -1 where the tree has none."""
        limits = np.array(self.shape) * 2**level
        inside = np.all((index >= 0) & (index < limits), axis=1)
        index = np.where(inside[:, None], index, 0)
        top = index >> level
        node = top[:, 0] * self.shape[1] + top[:, 1]
        for k in range(level - 1, -1, -1):
            bits = (index >> k) & 1
            below = self.child[node]
            node = np.where((below >= 0) & (node >= 0), below + 2 * bits[:, 0] + bits[:, 1], -1)
        return np.where(inside, node, -1)

    def outside(self, level: int, index: Ints) -> Bools:
        """True for cells of a level that lie beyond the domain."""
        limits = np.array(self.shape) * 2**level
        return np.asarray(np.any((index < 0) | (index >= limits), axis=1))

    def refine(self, cells: Bools) -> Quadtree:
        """Halve the 3 x 3 block around every marked cell, so that new functions cover it whole.

        A B-spline of the next level is used where its support lies in cells of that level: the
        nine functions over the children of a cell reach one cell of this level further.
        """
        marked = self.leaves[cells]
        around = np.array([(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)])
        wanted: list[Ints] = []
        blocks: Ints = np.empty((0, 2), dtype=np.int64)
        for level in range(self.depth, -1, -1):
            here = self.index[marked[self.level[marked] == level]]
            blocks = np.concatenate([blocks >> 1, (here[:, None] + around).reshape(-1, 2)])
            blocks = blocks[~self.outside(level, blocks)]
            blocks = np.unique(blocks, axis=0) if len(blocks) else blocks
            wanted.append(blocks)
        wanted.reverse()
        levels, indices, children = [], [], []
        index = self.index[self.level == 0]
        total = 0
        for level in range(self.depth + 2):
            old = self.find(level, index) if level <= self.depth else np.full(len(index), -1)
            split = np.where(old >= 0, self.child[old], -1) >= 0
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
            self.domain,
            self.shape,
            np.concatenate(levels),
            np.concatenate(indices),
            np.concatenate(children),
        )


def cell_keys(index: Ints) -> Ints:
    """One sortable number for each cell (n, 2) of a level, one ring outside the domain included."""
    return np.asarray((index[:, 0] + 1) * 2**31 + index[:, 1] + 1, dtype=np.int64)


def _quarters(index: Ints) -> Ints:
    """The children of cells, one after the other: (n, 2) -> (4 n, 2)."""
    quarter = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])
    return np.asarray((2 * index[:, None] + quarter).reshape(-1, 2))


def _contains(cells: Ints, index: Ints) -> Bools:
    return np.isin(cell_keys(index), cell_keys(cells))
