"""Rational conic arcs compiled to polynomial pieces, all of many arcs together.

    arcs ──two halves each──> sample all ──4 ulp?──yes──> pieces, joined and in order
                                  ^          └─no──> split ─┐
                                  └─────────────────────────┘

The arithmetic is that of `nurbs_pieces`, which compiles each arc by itself and takes several times
as long. It still gets the arcs that have no plain answer, to resolve or to refuse.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from splinesdf.ground.arrays import LARGEST, Bools, Floats, Ints
from splinesdf.shapes.sources.nurbs import nurbs_pieces
from splinesdf.shapes.sources.resolution import (
    CORNER,
    FIRST_INTERVALS,
    agreement,
    interpolate,
    interval_parameters,
    noise_parameters,
    split,
)

# So many arcs are sampled at once, with some 0.3 MB each. More: memory grows and nothing is
# quicker; fewer: the cost of NumPy's calls shows.
_TOGETHER = 32
# Weights, and their inverses, up to this are compiled together. Beyond, `nurbs_pieces` knows how
# much a curve may hide near its ends.
_WIDE = 1e6
# A half of more intervals than this goes to `nurbs_pieces`, which goes on. Fewer: arcs of weights
# near `_WIDE`, of some 210 a half, are compiled twice; more: memory for what is then refused.
_MOST_INTERVALS = 400
# A jump between the halves up to this share of the largest coordinate is rounding.
_ROUNDING_GAP = 1e-13
_KNOTS = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
_STOP = 0.5


@dataclass(frozen=True)
class _Halves:
    """The first halves of arcs, t from 0 to 1/2: of each arc, and of the same arc turned around."""

    control: Floats  # (n, 3, 2)
    weights: Floats  # (n, 3), the largest 1

    def at(self, t: Floats, rows: Ints | slice = slice(None)) -> Floats:
        """Points at parameters (m, s), or (1, s) for all, of m halves: (m, 2, s)."""
        first, weights = self.control[rows, 0, :, None], self.weights[rows, :, None]
        # Seen from the first point, so that rounding stays in proportion to the arc.
        legs = np.swapaxes(self.control[rows, 1:] - self.control[rows, :1], 1, 2)
        # By pow, as `nurbs_pieces` does; with the scalar 2 NumPy multiplies, one bit away at times.
        squared = np.full_like(t, 2.0)
        before = weights[:, 0] * (1.0 - t) ** squared
        basis = np.empty((len(weights), 2, t.shape[1]))
        np.multiply(2.0 * weights[:, 1] * t, 1.0 - t, out=basis[:, 0])
        np.multiply(weights[:, 2], t**squared, out=basis[:, 1])
        mass = before + basis[:, 0] + basis[:, 1]
        return np.asarray(first + legs @ basis / mass[:, None])


@dataclass(frozen=True)
class _Resolved:
    """Pieces of halves, in no order."""

    half: Ints  # (n,)
    left: Floats  # (n,): where each starts
    control: Floats  # (n, 8, 2)
    straight: Bools  # (n,): only the ends count

    def taken(self, rows: Ints | Bools) -> _Resolved:
        return _Resolved(self.half[rows], self.left[rows], self.control[rows], self.straight[rows])


def rational_pieces(arcs: Floats, weights: Floats) -> list[list[Floats]]:
    """Polynomial pieces of each rational quadratic arc, from its start to its end.

    Parameters
    ----------
    arcs : ndarray, shape (n, 3, 2)
    weights : ndarray, shape (n,)
        Those of the middle control points; the ends have the weight 1.

    Returns
    -------
    list of list of ndarray, shape (8, 2) or (2, 2)
        Those of `nurbs_pieces`.

    Raises
    ------
    InputError
        As `nurbs_pieces`.
    """
    result: list[list[Floats]] = [[] for _ in arcs]
    large = np.abs(arcs).max(axis=(1, 2), initial=0.0)
    plain = (large <= LARGEST) & (weights >= 1.0 / _WIDE) & (weights <= _WIDE)
    together = np.flatnonzero(plain)
    done = np.zeros(len(arcs), dtype=np.bool_)
    for first in range(0, len(together), _TOGETHER):
        rows = together[first : first + _TOGETHER]
        found, done[rows] = _compile(arcs[rows], weights[rows])
        for half, control, straight in zip(found.half, found.control, found.straight, strict=True):
            result[rows[half // 2]].append(control[[0, -1]] if straight else control)
    for row in np.flatnonzero(~done):
        mass = [1.0, weights[row], 1.0]
        result[row] = nurbs_pieces(arcs[row], degree=2, knots=_KNOTS, weights=mass)
    return result


def _compile(arcs: Floats, weights: Floats) -> tuple[_Resolved, Bools]:
    """Pieces in order, and of which arcs these are: not of those that resist, or jump."""
    count = len(arcs)
    mass = np.stack([np.ones(count), weights, np.ones(count)], axis=-1)
    mass /= mass.max(axis=1, keepdims=True)
    halves = _Halves(
        np.stack([arcs, arcs[:, ::-1]], axis=1).reshape(-1, 3, 2), np.repeat(mass, 2, axis=0)
    )
    largest = np.abs(arcs).max(axis=(1, 2))
    found, resisting = _resolve(halves, np.repeat(largest, 2))
    found, gap = _joined(found)
    jumping = found.half[gap > _ROUNDING_GAP * largest[found.half // 2]]
    resisting[jumping] = True
    good: Bools = ~(resisting[::2] | resisting[1::2])
    # As `nurbs_pieces`, without pieces that are points.
    inner = np.any(found.control[:, 1:-1] != found.control[:, :1], axis=(1, 2)) & ~found.straight
    some = inner | np.any(found.control[:, -1] != found.control[:, 0], axis=1)
    return found.taken(some & good[found.half // 2]), good


def _resolve(halves: _Halves, largest: Floats) -> tuple[_Resolved, Bools]:
    """Pieces of all halves, each split until it is resolved, and which halves resist."""
    count = len(largest)
    t = noise_parameters(0.0, _STOP)
    samples = halves.at(t.reshape(1, -1)).reshape(count, 2, *t.shape)
    tolerance, scale = agreement(samples, largest)
    ends = np.linspace(0.0, _STOP, FIRST_INTERVALS + 1)
    intervals = np.tile(np.column_stack([ends[:-1], ends[1:]]), (count, 1))
    half = np.repeat(np.arange(count), FIRST_INTERVALS)
    resisting = np.zeros(count, dtype=np.bool_)
    known = np.zeros(count, dtype=np.int64)
    done = []
    while len(intervals):  # at most 30 rounds: each at least halves all, and narrow ones go
        found = interpolate(halves.at(interval_parameters(intervals), half), tolerance[half])
        good = found.straight | (found.error <= tolerance[half])
        known += np.bincount(half[good], minlength=count)
        done.append(
            _Resolved(half[good], intervals[good, 0], found.control[good], found.straight[good])
        )
        intervals, part = split(
            intervals[~good], found.error[~good], tolerance[half[~good]], scale[half[~good]]
        )
        half = half[~good][part]
        resisting[half[intervals[:, 1] - intervals[:, 0] < CORNER * _STOP]] = True
        resisting |= known + np.bincount(half, minlength=count) > _MOST_INTERVALS
        intervals, half = intervals[~resisting[half]], half[~resisting[half]]
    return _Resolved(
        np.concatenate([each.half for each in done]),
        np.concatenate([each.left for each in done]),
        np.concatenate([each.control for each in done]),
        np.concatenate([each.straight for each in done]),
    ), resisting


def _joined(found: _Resolved) -> tuple[_Resolved, Floats]:
    """Pieces in order, each starting where the one before ends, and by how far each jumped."""
    found = found.taken(np.lexsort((found.left, found.half)))
    control, half = found.control, found.half
    inside = np.flatnonzero(half[1:] == half[:-1])
    control[inside + 1, 0] = control[inside, -1]
    # Second halves were turned around, and are turned back.
    second = half % 2 == 1
    control[second] = control[second, ::-1]
    found = found.taken(np.lexsort((np.where(second, -found.left, found.left), half)))
    control, half = found.control, found.half
    gap = np.zeros(len(half))
    middle = np.flatnonzero((half[1:] % 2 == 1) & (half[:-1] == half[1:] - 1))
    gap[middle + 1] = np.hypot(*(control[middle, -1] - control[middle + 1, 0]).T)
    control[middle + 1, 0] = control[middle, -1]
    return found, gap
