"""Trials of a fit: a mesh that can be refined, and the quasi-interpolant of a shape on it.

Both kinds answer the same: which cells there are, the spline, the exact distance at the centers of
cells, which cells have changed since they were last measured, and what is known of their errors.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from splinesdf.distance.exact import signed_distance
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.meshes import Box, Grid
from splinesdf.shapes.shape import Shape
from splinesdf.spaces.hierarchical import leaves, ordinates, owned, quadtree, refined, roots
from splinesdf.splines.quasi import STENCILS, quasi_interpolate
from splinesdf.splines.spline import SplineSDF


class Known(NamedTuple):
    """What is known of the largest |s - u| in each of some cells."""

    low: Floats  # (n,) it is at least this, up to rounding
    high: Floats  # (n,) and at most this
    counts: Bools  # (n,) whether the cell meets a band; all do if there is none
    over: Bools  # (n, 4) in which quarters (SW SE NW NE) it is not known to be small enough


def _nothing_known(count: int) -> Known:
    return Known(
        np.zeros(count),
        np.full(count, np.inf),
        np.ones(count, dtype=np.bool_),
        np.ones((count, 4), dtype=np.bool_),
    )


class Trial(Protocol):
    """What the loop of a fit asks."""

    evaluations: int
    spline: SplineSDF
    changed: Ints

    @property
    def center(self) -> Floats:
        """Exact distances at the centers of all cells."""

    @property
    def known(self) -> Known:
        """What is known of the errors in all cells."""

    def learn(self, cells: Ints, errors: Known) -> None:
        """Remember what was found out about some cells."""

    def plan(self, bad: Ints) -> int:
        """Plan to halve cells, and what else must be so that they get better: the cells then."""

    def refine(self) -> None:
        """Do what was planned."""


class GridTrial:
    """On a tensor grid; whatever is refined, all cells change."""

    _mesh: Grid
    _planned: Grid  # the next one

    def __init__(self, shape: Shape, mesh: Grid, operator: str, whole: bool) -> None:
        self._shape, self._operator, self._whole = shape, operator, whole
        self.evaluations = 0
        self._interpolate(mesh)

    @property
    def center(self) -> Floats:
        """Exact distances at the centers of all cells."""
        return self._center

    @property
    def known(self) -> Known:
        """What is known of the errors in all cells."""
        return self._known

    def learn(self, cells: Ints, errors: Known) -> None:
        """Remember what was found out about some cells."""
        for mine, theirs in zip(self._known, errors, strict=True):
            mine[cells] = theirs

    def plan(self, bad: Ints) -> int:
        """Plan to halve every row and column with a bad cell, or all: the cells then."""
        mesh = self._mesh
        if self._whole:
            self._planned = mesh.halve()
        else:
            marked = np.zeros(len(mesh.boxes), dtype=np.bool_)
            marked[bad] = True
            marked = marked.reshape(mesh.shape)
            self._planned = mesh.insert(np.any(marked, axis=1), np.any(marked, axis=0))
        m, n = self._planned.shape
        return m * n

    def refine(self) -> None:
        """Do what was planned."""
        self._interpolate(self._planned)

    def _interpolate(self, mesh: Grid) -> None:
        self._mesh = self._planned = mesh
        shape = self._shape
        found = quasi_interpolate(self._distance, mesh, self._operator)
        self.spline = SplineSDF(mesh, found.ordinates, shape=shape)
        count = len(mesh.boxes)
        self._center = self._distance(0.5 * (mesh.boxes[:, :2] + mesh.boxes[:, 2:]))
        self.changed = np.arange(count)
        self._known = _nothing_known(count)

    def _distance(self, points: Floats) -> Floats:
        self.evaluations += len(points)
        return signed_distance(self._shape, points)


class TreeTrial:
    """On a quadtree. No distance is asked twice: a node keeps that at its center.

    For operator W also that at its lower left corner: a corner belongs to the cell right of and
    above it. Of four children one has its parent's corner and one its center there, so that a
    node costs 1.5 distances, and 1 with the other operators.
    """

    def __init__(self, shape: Shape, domain: Box, start: tuple[int, int], operator: str) -> None:
        self._shape, self._domain, self._operator = shape, domain, operator
        self._stencil = STENCILS[operator]
        self._side = np.array(
            [(domain[2] - domain[0]) / start[0], (domain[3] - domain[1]) / start[1]]
        )
        self.evaluations = 0
        nodes = roots(start)
        every = np.arange(len(nodes.level))
        self._nodes = self._planned = nodes
        self._centers = self._ask(nodes.level, nodes.place + 0.5)
        self._corners = np.full(len(every), np.nan)
        if operator == "W":
            self._corners = self._ask(nodes.level, nodes.place)
        self._values = np.full(len(every), np.nan)
        self._ordinates = np.full((len(every), 8), np.nan)
        self._known = _nothing_known(len(every))
        self._interpolate()

    @property
    def center(self) -> Floats:
        """Exact distances at the centers of all cells."""
        return self._centers[self._cells]

    @property
    def known(self) -> Known:
        """What is known of the errors in all cells."""
        low, high, counts, over = self._known
        cells = self._cells
        return Known(low[cells], high[cells], counts[cells], over[cells])

    def learn(self, cells: Ints, errors: Known) -> None:
        """Remember what was found out about some cells."""
        for mine, theirs in zip(self._known, errors, strict=True):
            mine[self._cells[cells]] = theirs

    def plan(self, bad: Ints) -> int:
        """Plan to halve the 2 x 2 cells around the corner at each bad quarter of bad cells."""
        self._planned = refined(self._nodes, self._cells[bad], self.known.over[bad])
        return len(leaves(self._planned))

    def refine(self) -> None:
        """Do what was planned."""
        before = len(self._nodes.level)
        self._nodes = nodes = self._planned
        count = len(nodes.level) - before
        self._values = np.concatenate([self._values, np.full(count, np.nan)])
        self._ordinates = np.concatenate([self._ordinates, np.full((count, 8), np.nan)])
        old, new = self._known, _nothing_known(count)
        self._known = Known(
            np.concatenate([old.low, new.low]),
            np.concatenate([old.high, new.high]),
            np.concatenate([old.counts, new.counts]),
            np.concatenate([old.over, new.over]),
        )
        self._sample(before)
        self._interpolate()

    def _sample(self, before: int) -> None:
        """Distances at centers and corners of the nodes from a number on."""
        nodes = self._nodes
        every = np.arange(before, len(nodes.level))
        centers = self._ask(nodes.level[every], nodes.place[every] + 0.5)
        self._centers = np.concatenate([self._centers, centers])
        self._corners = np.concatenate([self._corners, np.full(len(every), np.nan)])
        if self._operator != "W":
            return
        parents = np.empty(len(every), dtype=np.int64)
        split = np.flatnonzero(nodes.child >= before)
        for k in range(4):
            parents[nodes.child[split] + k - before] = split
        quarter = (nodes.place[every] & 1).sum(axis=1)
        new = every[quarter == 1]
        self._corners[new] = self._ask(nodes.level[new], nodes.place[new])
        last = quarter == 2
        self._corners[every[last]] = self._centers[parents[last]]
        # Coarse ones first, as a parent may itself be new.
        for level in np.unique(nodes.level[every]):
            same = (quarter == 0) & (nodes.level[every] == level)
            self._corners[every[same]] = self._corners[parents[same]]

    def _interpolate(self) -> None:
        nodes = self._nodes
        own = owned(nodes)
        fresh = np.flatnonzero(own & np.isnan(self._values))
        self._values[fresh] = self._functional(fresh)
        self._cells = leaves(nodes)
        found = ordinates(nodes, own, self._values, self._cells)
        self.changed = np.flatnonzero(np.any(found != self._ordinates[self._cells], axis=1))
        self._ordinates[self._cells] = found
        mesh = quadtree(nodes, self._domain)
        self.spline = SplineSDF(mesh, found, shape=self._shape)

    def _functional(self, chosen: Ints) -> Floats:
        """The quasi-interpolant's functional of nodes."""
        nodes = self._nodes
        offsets, weights = (np.array(part) for part in self._stencil)
        # The cells in whose center, or in whose lower left corner, the samples lie: (n, k, 2).
        corner = offsets[:, 0] % 1.0 != 0.0
        shift = np.broadcast_to(np.ceil(offsets), (len(chosen), *offsets.shape)).astype(np.int64)
        if self._operator == "P":
            shift[:, :, 0] *= 1 - 2 * (nodes.place[chosen].sum(axis=1) & 1)[:, None]
        other = nodes.near[chosen[:, None], 4 + 3 * shift[..., 0] + shift[..., 1]]
        known = np.maximum(other, 0)
        values = np.where(corner, self._corners[known], self._centers[known])
        cell, sample = np.nonzero(other < 0)  # beyond the ring around the domain
        within = np.where(corner, 0.0, 0.5)[sample, None]
        place = nodes.place[chosen[cell]] + shift[cell, sample] + within
        values[cell, sample] = self._ask(nodes.level[chosen[cell]], place)
        return np.asarray(values @ weights)

    def _ask(self, level: Ints, place: NDArray[Any]) -> Floats:
        """Exact distances at places (n, 2) in cells of a level from the domain's corner."""
        self.evaluations += len(level)
        side = self._side * np.exp2(-level.astype(np.float64))[:, None]
        return signed_distance(self._shape, np.array(self._domain[:2]) + place * side)
