"""The truncated hierarchical space on a quadtree, without writing down its basis.

The basis is that of Giannelli, Jüttler and Speleers (THB-splines, 2012).

The coefficient of function (i, j) of level l is the quasi-interpolant's functional of that level
if the function's whole support, the 3 x 3 cells around (i, j), lies in cells of level l or finer;
else it comes from level l - 1 by subdivision. Then every leaf is an ordinary cell of its level, and
the spline is as smooth across levels as within. (The support of the quartic element's functions is
4 x 4 cells, and its mask another one.)

    level l - 1:  ·   ·   ·         a child's coefficient by subdivision: half its parent's and
                  · [o o] ·         a quarter each of the parent's neighbors on the child's sides
                  · [o o] ·

References
----------
[Speleers2016] Effortless quasi-interpolation in hierarchical spaces.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from math import isqrt

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.meshes.mesh import Box
from splinesdf.meshes.quadtree import Quadtree
from splinesdf.spaces.element import Element
from splinesdf.spaces.tables import Evaluated, Mask, Nodes, Ways

# A quadtree's points enter it at the finest level that has at most so many places a cell. More:
# memory, 8 bytes a place beside the 64 of a cell; fewer: points go down more levels one by one.
_PLACES = 2.0

_QUARTERS = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])
# The 2 x 2 cells around each corner SW SE NW NE of a cell, as changes of (level, i, j).
_BESIDE = np.array(
    [[(0, a * i, b * j) for i in (0, 1) for j in (0, 1)] for b in (-1, 1) for a in (-1, 1)]
)


@dataclass(frozen=True, eq=False)
class HierarchicalSpace:
    """B-splines of an element on all levels of a quadtree; see `splinesdf.spaces.space.Space`.

    Attributes
    ----------
    mesh : Quadtree
    element : Element
    grown : Nodes, optional
        The mesh's tree with its ring, if it is known: otherwise it is made from the mesh.
    """

    mesh: Quadtree
    element: Element
    grown: Nodes | None = None

    @classmethod
    def of_nodes(cls, nodes: Nodes, domain: Box, element: Element) -> HierarchicalSpace:
        """The space on a tree that has grown."""
        return cls(quadtree(nodes, domain), element, nodes)

    @property
    def name(self) -> str:
        """Of the kind of space."""
        return "hierarchical"

    @property
    def equal_cells(self) -> bool:
        """True: those of a level are."""
        return True

    @property
    def persistent(self) -> bool:
        """True: nodes keep their numbers."""
        return True

    @cached_property
    def nodes(self) -> Nodes:
        """The tree with its ring; B-splines are numbered like its nodes."""
        if self.grown is not None:
            return self.grown
        mesh = self.mesh
        split = mesh.child >= 0
        first = roots(mesh.shape, self.element.beyond)
        return split_cells(first, np.column_stack([mesh.level, mesh.index])[split])

    @property
    def places(self) -> Ints:
        """The cell (i, j) of its level that each B-spline belongs to."""
        return self.nodes.place

    @cached_property
    def family(self) -> Ints:
        """There is one family."""
        return np.zeros(len(self.places), dtype=np.int64)

    @cached_property
    def own(self) -> Bools:
        """Which B-splines have a coefficient of their own, not by subdivision."""
        return owned(self.nodes)

    @cached_property
    def cells(self) -> Ints:
        """The B-spline of each cell."""
        return leaves(self.nodes)

    @cached_property
    def _roots(self) -> Floats:
        (xmin, ymin, xmax, ymax), (m, n) = self.mesh.domain, self.mesh.shape
        return np.array([(xmax - xmin) / m, (ymax - ymin) / n])

    def points(self, bsplines: Ints, offsets: Floats) -> Floats:
        """Places from the centers of B-splines, offsets (k, 2) in cells, as points (k, 2)."""
        nodes = self.nodes
        side = self._roots * np.exp2(-nodes.level[bsplines].astype(np.float64))[:, None]
        place = nodes.place[bsplines] + (np.array(self.element.centers[0]) + offsets)
        return np.asarray(np.array(self.mesh.domain[:2]) + place * side)

    def numbers(self, coefficients: Floats) -> Floats:
        """The numbers of all cells from the own coefficients of nodes."""
        from splinesdf.spaces.kernels.hierarchical import blocks
        from splinesdf.spaces.kernels.hierarchical import coefficients as fill

        nodes, cells, table = self.nodes, self.cells, self.element.mask
        assert table is not None
        mask = Mask(table[..., :2].astype(np.int64), np.ascontiguousarray(table[..., 2]))
        every = np.empty(len(coefficients))
        fill(nodes, mask, _coarse_first(nodes), self.own, coefficients, every)
        around = np.empty((len(cells), self.element.from_coefficients.shape[1]))
        blocks(nodes, mask, cells, every, around)
        return self.element.cell_numbers(around)

    def refined(self, bad: Ints, quarters: Bools) -> HierarchicalSpace:
        """The 2 x 2 cells around the corner at each bad quarter of bad cells halved.

        Of functions over 4 x 4 cells a new one alone cannot lift a quarter: all nine around.
        """
        if self.element.beyond > 1:
            quarters = np.ones_like(quarters)
        nodes = refined(self.nodes, self.cells[bad], quarters)
        return HierarchicalSpace.of_nodes(nodes, self.mesh.domain, self.element)

    def evaluator(self, table: Floats) -> Callable[[Evaluated], int]:
        """A function that fills values and derivatives from the element's table of all cells."""
        # Numba loads only when used.
        if self.element.degree == 4:
            from splinesdf.spaces.kernels.quartics import evaluate_quartic_tree

            return partial(evaluate_quartic_tree, np.array(self.mesh.domain), self._ways, table)
        from splinesdf.spaces.kernels.evaluation import evaluate_tree

        return partial(evaluate_tree, np.array(self.mesh.domain), self._ways, table)

    @cached_property
    def _ways(self) -> Ways:
        """How points get to the cells."""
        from splinesdf.spaces.kernels.location import fill_ways

        mesh, levels = self.mesh, 0
        m, n = mesh.shape
        count = len(mesh.leaves)
        while levels < mesh.depth and m * n * 4 ** (levels + 1) <= _PLACES * count:
            levels += 1
        entry = np.empty((m << levels, n << levels), dtype=np.int64)
        ways = Ways(entry, np.empty(len(mesh.child), dtype=np.int64))
        fill_ways(np.array(mesh.shape), mesh.child, mesh.cell_of, levels, ways)
        return ways


def roots(shape: tuple[int, int], ring: int) -> Nodes:
    """The tree of m x n roots and the ring around them, so many roots wide."""
    m, n = shape
    along = [np.arange(-ring, count + ring) for count in (m, n)]
    index = np.stack(np.meshgrid(*along, indexing="ij"), -1)
    count = (m + 2 * ring) * (n + 2 * ring)
    level, child = np.zeros(count, dtype=np.int64), np.full(count, -1)
    return _linked(np.array([m, n]), level, index.reshape(-1, 2), child, (2 * ring + 1) ** 2)


def _inside(nodes: Nodes) -> Ints:
    """The roots in the domain."""
    m, n = (int(count) for count in nodes.shape)
    ring = isqrt(nodes.near.shape[1]) // 2
    every = np.arange((m + 2 * ring) * (n + 2 * ring)).reshape(m + 2 * ring, n + 2 * ring)
    return every[ring:-ring, ring:-ring].reshape(-1)


def _grown(nodes: Nodes, split: Bools) -> Nodes:
    """The tree with four children below each node that is to be split; old nodes keep their number.

    Nodes of the ring beside it must be split with it.
    """
    chosen = np.flatnonzero(split & (nodes.child < 0))
    child = np.concatenate([nodes.child, np.full(4 * len(chosen), -1)])
    child[chosen] = len(nodes.child) + 4 * np.arange(len(chosen))
    index = (2 * nodes.place[chosen][:, None] + _QUARTERS).reshape(-1, 2)
    level = np.repeat(nodes.level[chosen] + 1, 4)
    return _linked(
        nodes.shape,
        np.concatenate([nodes.level, level]),
        np.concatenate([nodes.place, index]),
        child,
        nodes.near.shape[1],
    )


def refined(nodes: Nodes, bad: Ints, quarters: Bools) -> Nodes:
    """The tree in which new functions reach the marked quarters (k, 4) of some leaves (k,).

    A B-spline of the next level is used where its support lies in cells of that level. That of a
    child of a cell reaches into the cells beside that quarter: the 2 x 2 cells around the corner
    at which the quarter lies (SW SE NW NE) are split.
    """
    cell, quarter = np.nonzero(quarters)
    cells = np.column_stack([nodes.level[bad], nodes.place[bad]])[cell]
    return split_cells(nodes, (cells[:, None] + _BESIDE[quarter]).reshape(-1, 3))


def split_cells(nodes: Nodes, targets: Ints) -> Nodes:
    """The tree in which cells (k, 3), each a level and its place there, are split."""
    from splinesdf.spaces.kernels.hierarchical import mark  # Numba loads only when it is used

    targets = np.ascontiguousarray(targets)
    again = True
    while again:
        split = np.zeros(len(nodes.level), dtype=np.bool_)
        again = mark(nodes, targets, split)
        nodes = _grown(nodes, split)
    return nodes


def _linked(shape: Ints, level: Ints, index: Ints, child: Ints, around: int) -> Nodes:
    """The tree, in which so many nodes around each are known."""
    from splinesdf.spaces.kernels.hierarchical import link

    near = np.empty((len(level), around), dtype=np.int64)
    nodes = Nodes(shape, level, np.ascontiguousarray(index), child, near)
    link(nodes, _coarse_first(nodes), near)
    return nodes


def _coarse_first(nodes: Nodes) -> Ints:
    return np.argsort(nodes.level.astype(np.uint8), kind="stable")


def owned(nodes: Nodes) -> Bools:
    """Which nodes have a coefficient of their own."""
    from splinesdf.spaces.kernels.hierarchical import owned as fill

    own = np.empty(len(nodes.level), dtype=np.bool_)
    fill(nodes, own)
    return own


def leaves(nodes: Nodes) -> Ints:
    """The nodes that are cells, in the order of `quadtree`."""
    return _mesh_order(nodes)[1]


def quadtree(nodes: Nodes, domain: Box) -> Quadtree:
    """The tree without its ring, as a mesh."""
    order, _ = _mesh_order(nodes)
    child = np.full(len(order), -1)
    split = nodes.child[order] >= 0
    m, n = (int(count) for count in nodes.shape)
    child[split] = m * n + 4 * np.arange(np.count_nonzero(split))
    return Quadtree(domain, (m, n), nodes.level[order], nodes.place[order], child)


def _mesh_order(nodes: Nodes) -> tuple[Ints, Ints]:
    """The nodes in the domain, level after level, each with its children in order; the leaves."""
    here = _inside(nodes)
    levels = [here]
    while True:
        child = nodes.child[here]
        child = child[child >= 0]
        if len(child) == 0:
            break
        here = (child[:, None] + np.arange(4)).reshape(-1)
        levels.append(here)
    order = np.concatenate(levels)
    return order, order[nodes.child[order] < 0]
