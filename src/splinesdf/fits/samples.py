"""Samples of the exact distance that a fit asks of a target, none of them twice.

On a grid a refinement moves all samples. On a quadtree a node keeps the distance at its center; and
that at its lower left corner, if the operator has samples in corners: a corner belongs to the cell
right of and above it. Of four children one has its parent's corner and one its center there, so
that a node costs 1.5 distances, and 1 without corners. Centers are kept in any case, as the
certificate begins with them; all samples of the quartic element are in corners.
"""

from __future__ import annotations

from typing import Any, Protocol, cast

import numpy as np

from splinesdf.fits.target import Target
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.spaces.element import Operator
from splinesdf.spaces.hierarchical import HierarchicalSpace
from splinesdf.spaces.space import Space
from splinesdf.spaces.tensor import TensorSpace


class Samples(Protocol):
    """Exact distances at places of a space."""

    @property
    def count(self) -> int:
        """How many were asked so far."""

    @property
    def at_centers(self) -> Floats:
        """At the centers of all cells."""

    def at(self, bsplines: Ints, offsets: Floats) -> Floats:
        """At offsets (n, 2) in cells from the centers of B-splines (n,)."""

    def on(self, space: Any) -> Samples:
        """Those of a refined space, of the same kind."""


class GridSamples:
    """On a grid."""

    def __init__(self, target: Target, space: TensorSpace, count: int = 0) -> None:
        self._target, self._space, self.count = target, space, count
        boxes = space.mesh.boxes
        self.at_centers = self._ask(0.5 * (boxes[:, :2] + boxes[:, 2:]))

    def at(self, bsplines: Ints, offsets: Floats) -> Floats:
        """At offsets (n, 2) in cells from the centers of B-splines (n,)."""
        return self._ask(self._space.points(bsplines, offsets))

    def on(self, space: TensorSpace) -> GridSamples:
        """Those of a refined space: nothing is kept."""
        return GridSamples(self._target, space, self.count)

    def _ask(self, points: Floats) -> Floats:
        self.count += len(points)
        return self._target.values(points)


class TreeSamples:
    """On a quadtree, where no distance is asked twice."""

    def __init__(self, target: Target, space: HierarchicalSpace, operator: Operator) -> None:
        self._target, self._space, self.count = target, space, 0
        # From the centers of the cells that B-splines belong to, to their own.
        self._shift = np.array(space.element.centers[0]) - 0.5
        self._has_corners = bool(np.any((np.array(operator.offsets) + self._shift) % 1.0))
        every = np.arange(len(space.places))
        self._centers = self._ask(every, np.zeros((len(every), 2)))
        self._corners = np.full(len(every), np.nan)
        if self._has_corners:
            self._corners = self._ask(every, np.full((len(every), 2), -0.5))

    @property
    def at_centers(self) -> Floats:
        """At the centers of all cells."""
        return self._centers[self._space.cells]

    def at(self, bsplines: Ints, offsets: Floats) -> Floats:
        """At offsets (n, 2) in cells from the centers of B-splines (n,)."""
        # The cells in whose center, or in whose lower left corner, the samples lie.
        offsets = offsets + self._shift
        near, ring = self._space.nodes.near, self._space.element.beyond
        in_corner = np.all(offsets % 1.0 == 0.5, axis=1)
        shift = np.clip(np.ceil(offsets), -ring, ring).astype(np.int64)
        there = np.all(shift - 0.5 * in_corner[:, None] == offsets, axis=1)
        place = near.shape[1] // 2 + (2 * ring + 1) * shift[:, 0] + shift[:, 1]
        other = near[bsplines, place]
        other = np.where(there, other, -1)
        known = np.maximum(other, 0)
        values = np.where(in_corner, self._corners[known], self._centers[known])
        beyond = np.flatnonzero(other < 0)  # also the ring around the domain
        values[beyond] = self._ask(bsplines[beyond], offsets[beyond])
        return values

    def on(self, space: HierarchicalSpace) -> TreeSamples:
        """Those of a space that has grown; old nodes keep theirs."""
        before, nodes = len(self._centers), space.nodes
        self._space = space
        every = np.arange(before, len(nodes.level))
        centers = self._ask(every, np.zeros((len(every), 2)))
        self._centers = np.concatenate([self._centers, centers])
        self._corners = np.concatenate([self._corners, np.full(len(every), np.nan)])
        if self._has_corners:
            self._fill_corners(every, before)
        return self

    def _fill_corners(self, every: Ints, before: int) -> None:
        """At the lower left corners of new nodes, of which half have been asked before."""
        nodes = self._space.nodes
        parents = np.empty(len(every), dtype=np.int64)
        split = np.flatnonzero(nodes.child >= before)
        for k in range(4):
            parents[nodes.child[split] + k - before] = split
        quarter = (nodes.place[every] & 1).sum(axis=1)
        new = every[quarter == 1]
        self._corners[new] = self._ask(new, np.full((len(new), 2), -0.5))
        last = quarter == 2
        self._corners[every[last]] = self._centers[parents[last]]
        # Coarse ones first, as a parent may itself be new.
        for level in np.unique(nodes.level[every]):
            same = (quarter == 0) & (nodes.level[every] == level)
            self._corners[every[same]] = self._corners[parents[same]]

    def _ask(self, nodes: Ints, offsets: Floats) -> Floats:
        """At offsets (n, 2) in cells from the centers of nodes."""
        self.count += len(nodes)
        return self._target.values(self._space.points(nodes, offsets - self._shift))


def samples_on(target: Target, space: Space, operator: Operator) -> Samples:
    """The samples of a space that a fit starts from, or that is given."""
    if space.persistent:
        return TreeSamples(target, cast(HierarchicalSpace, space), operator)
    return GridSamples(target, cast(TensorSpace, space))
