"""A trial of a fit: a space that can be refined, and the quasi-interpolant of a target in it.

It answers which cells there are, the spline, the exact distance at the centers of cells, which
cells have changed since they were last measured, and what is known of their errors.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.fits.samples import samples_on
from splinesdf.fits.target import Target
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.shapes.shape import Shape
from splinesdf.spaces.space import Space, operator_on
from splinesdf.splines.spline import SplineSDF


class Known(NamedTuple):
    """Bounds of the largest |s - u| in each of some cells."""

    low: Floats  # (n,) it is at least this, up to rounding
    high: Floats  # (n,) and at most this
    counts: Bools  # (n,) whether the cell meets a band; all do if there is none
    over: Bools  # (n, 4) in which quarters (SW SE NW NE) it is not known to be small enough

    def take(self, cells: Ints) -> Known:
        """Some of them."""
        return Known(self.low[cells], self.high[cells], self.counts[cells], self.over[cells])


class Trial:
    """The quasi-interpolant on a space, step by step.

    What is known of a cell or of a B-spline stands under its number, so that on a space where
    numbers persist it is kept.
    """

    spline: SplineSDF
    changed: Ints  # cells whose polynomials are new since the last refinement
    _space: Space
    _known: Known
    _coefficients: Floats  # of B-splines, NaN where not known
    _numbers: Floats  # of cells

    def __init__(self, target: Target, shape: Shape, space: Space, operator: str) -> None:
        self._shape, self._operator = shape, operator
        self._samples = samples_on(target, space, operator_on(space, operator))
        self._planned = space
        self._take_up(0)

    @property
    def evaluations(self) -> int:
        """Exact distances asked so far."""
        return self._samples.count

    @property
    def center(self) -> Floats:
        """Exact distances at the centers of all cells."""
        return self._samples.at_centers

    @property
    def known(self) -> Known:
        """Bounds of the errors in all cells."""
        return self._known.take(self._space.cells)

    def learn(self, cells: Ints, errors: Known) -> None:
        """Remember what was found out about some cells."""
        numbers = self._space.cells[cells]
        for mine, theirs in zip(self._known, errors, strict=True):
            mine[numbers] = theirs

    def plan(self, bad: Ints) -> int:
        """Plan to halve cells, and what else must be so that they get better: the cells then."""
        self._planned = self._space.refined(bad, self.known.over[bad])
        return self._planned.mesh.cell_count

    def refine(self) -> None:
        """Do what was planned."""
        kept = len(self._coefficients) if self._planned.persistent else 0
        self._samples = self._samples.on(self._planned)
        self._take_up(kept)

    def _take_up(self, kept: int) -> None:
        """Go over to the planned space; so many numbers of the old one persist."""
        space = self._space = self._planned
        count = len(space.places) - kept
        new = Known(
            np.zeros(count),
            np.full(count, np.inf),
            np.ones(count, dtype=np.bool_),
            np.ones((count, 4), dtype=np.bool_),
        )
        coefficients = np.full(count, np.nan)
        numbers = np.full((count, space.element.numbers), np.nan)
        if kept:
            new = Known(*(np.concatenate(pair) for pair in zip(self._known, new, strict=True)))
            coefficients = np.concatenate([self._coefficients, coefficients])
            numbers = np.concatenate([self._numbers, numbers])
        self._known, self._coefficients, self._numbers = new, coefficients, numbers
        self._interpolate()

    def _interpolate(self) -> None:
        space, samples = self._space, self._samples
        fresh = np.flatnonzero(space.own & np.isnan(self._coefficients))
        operator = operator_on(space, self._operator)
        self._coefficients[fresh] = operator.coefficients(
            space.places[fresh],
            space.family[fresh],
            lambda offsets: samples.at(fresh, offsets),
        )
        found = space.numbers(self._coefficients)
        cells = space.cells
        self.changed = np.flatnonzero(np.any(found != self._numbers[cells], axis=1))
        self._numbers[cells] = found
        self.spline = SplineSDF(space.mesh, found, shape=self._shape, element=space.element)
