"""Quadtree: a uniform grid whose cells are halved again and again where it matters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.ground.brief import brief, counted, without_caches
from splinesdf.ground.values import by_value
from splinesdf.meshes.mesh import Box, check_counts, check_domain

# Lattice coordinates of the finest level, times a few roots, must stay far inside 63 bits when two
# of them are packed into one key.
DEEPEST = 26
# Cells of the finest level along a side: pairs of their numbers must fit into one of 63 bits.
_LATTICE = 2**30


@by_value
@without_caches
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
        m, n = check_counts(m, n)
        index = np.column_stack([np.repeat(np.arange(m), n), np.tile(np.arange(n), m)])
        level, child = np.zeros(m * n, dtype=np.int64), np.full(m * n, -1)
        return cls(check_domain(domain), (m, n), level, index, child)

    @classmethod
    def from_splits(cls, domain: Box, shape: tuple[int, int], split: Bools) -> Quadtree:
        """The tree whose nodes, level after level, are split or not; the flags determine it.

        Raises
        ------
        InputError
            If there are too few or too many flags for the nodes that they make, or cells so small
            that rounding makes them empty.
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
            if len(here) < len(index):
                raise InputError("expected a flag for every node of the quadtree, got too few")
            if level > DEEPEST:
                raise InputError(f"expected at most {DEEPEST} halvings of a quadtree, got more")
            child = np.full(len(index), -1)
            child[here] = stop + 4 * np.arange(np.count_nonzero(here))
            levels.append(np.full(len(index), level))
            indices.append(index)
            children.append(child)
            index, start, level = _quarters(index[here]), stop, level + 1
        if start != len(split):
            raise InputError("expected a flag for every node of the quadtree, got too many")
        result = cls(
            tree.domain,
            tree.shape,
            np.concatenate(levels),
            np.concatenate(indices),
            np.concatenate(children),
        )
        # Each side of a cell is rounded by up to one unit in the last place of the coordinates.
        rounding = np.spacing(max(map(abs, tree.domain)))
        if result.side(result.depth).min() < 4.0 * rounding:
            raise InputError(
                f"expected cells that rounding leaves open, got {result.depth} halvings of "
                f"{m} x {n} cells of {tree.domain}"
            )
        return result

    def __repr__(self) -> str:
        return brief("Quadtree", "", counted(self.cell_count, "cell"), self.description)

    kind: ClassVar = "quadtree"

    @property
    def description(self) -> str:
        """A few words for a person."""
        return f"quadtree of {self.depth + 1} levels"

    @property
    def cell_count(self) -> int:
        """How many cells it has."""
        return len(self.leaves)

    @property
    def can_halve(self) -> bool:
        """Whether its finest cells may be halved once more."""
        return self.depth < DEEPEST and max(self.shape) << self.depth < _LATTICE

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays that determine it, as a file holds them: which nodes are split."""
        domain = np.array(self.domain, dtype=np.float64)
        return {"domain": domain, "shape": np.array(self.shape), "split": self.child >= 0}

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
        return np.asarray(self.local_boxes + np.tile(self.domain[:2], 2))

    @cached_property
    def local_boxes(self) -> Floats:
        """The cells from the domain's lower left corner, shape (n, 4)."""
        return np.asarray(self.corners * np.tile(self.side(self.depth), 2))

    @property
    def corners(self) -> Ints:
        """Cells on the lattice of the finest level."""
        size = 2 ** (self.depth - self.level[self.leaves])[:, None]
        low = self.index[self.leaves] * size
        return np.concatenate([low, low + size], axis=1)


def _quarters(index: Ints) -> Ints:
    """The children of cells, one after the other: (n, 2) -> (4 n, 2)."""
    quarter = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])
    return np.asarray((2 * index[:, None] + quarter).reshape(-1, 2))
