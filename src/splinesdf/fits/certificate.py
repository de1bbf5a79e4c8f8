"""The true error of a spline: proved brackets of the maximum of |s - u| over cells.

triangles ─→ what can be closest there (culling) ─→ branch and bound (kernels.enclosure)
    ↑                                                     │ parts that stay open
    └── halved twice ←── not good enough ←── 1-Lipschitz bound around an exact distance
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from splinesdf.fits.pieces import pieces
from splinesdf.fits.tables import Asked, Brackets, Limits
from splinesdf.fits.target import Target
from splinesdf.fits.trials import Known
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.ground.blocks import in_blocks
from splinesdf.splines.spline import SplineSDF

# Triangles a thread takes at a time. Fewer: the pool's overhead shows; more: the last block keeps
# one core busy alone.
_BLOCK = 512
# Open parts that a triangle of a block may leave on average; beyond it, it is open as a whole.
_OPEN = 32
# A bracket of an error is as narrow as this share of it, unless less is asked.
TIGHT = 0.005
# Halvings of a cell's triangles before what has no structure is asked for exact distances, which
# cost more than a halving; open triangles are asked at once.
_PATIENCE = 3
# How often open triangles are halved twice. Twelve times divide the length by 4096: the Lipschitz
# bound is then within half a percent of what is large in a cell. Without a proof once is all.
_ROUNDS, _SAMPLED_ROUNDS = 12, 1
# Parts of an eighth that may be looked at before it is left as it is, and to know the largest
# error of all. More: slower where no proof is to be had; fewer: good cells are halved in vain.
# In bands less: at a thin one triangles must be small all along it, and ten times the effort gains
# a digit at most.
_GLANCE, _EFFORT, _EFFORT_IN_BANDS = 100, 20_000, 2_000
# Cells whose error is looked at together when the largest of all is sought. More: some in vain;
# fewer: more rounds.
_TOGETHER = 64
# Below this share of the largest coordinate an error is not told from the rounding that the proof
# allows for (256 units in the last place, of a coordinate and of a distance). Less: where the
# spline is exact, seconds a cell are spent on noise; more: bounds above it are wider than need be.
_NOISE = 2.5e-13
# Rounding in distances and ordinates, as a share of the largest coordinate: that of the kernel.
_GRAIN = 256 * 2.220446049250313e-16
# Open triangles at a time: 100 MB. Beyond it they keep the bound that they have.
_MOST_OPEN = 400_000
# Cells at a time whose polynomials are cut into quadratics: 100 kB each.
_MOST_CELLS = 512
# Share of what an error need not be known below that quadratics may miss of the spline, to tell
# good cells from bad ones, and to know the largest error of all. Smaller: four times the triangles
# for each eighth of it, of degree 3; larger: bounds are that much wider.
ROUGH, _MISSED = 2e-2, 2e-3
# So many times that in cells with as large an error at the center: most are bad. More: more are
# halved that are not, as in bands that the center is not in; fewer: bad ones are cut in vain.
_HOPELESS = 20.0


# The corner (SW SE NW NE) of a cell at which each of its eighths lies.
_CORNER = np.array([0, 1, 1, 3, 3, 2, 2, 0])


class Wanted(NamedTuple):
    """When an error is known well enough."""

    threshold: float  # below it, it need not be known better
    enough: float = np.inf  # an eighth that is known to exceed it is left
    tight: float = TIGHT  # bracketed to this share of it
    effort: int = _GLANCE  # parts of an eighth that may be looked at before it is left as it is
    # Points count as well in which the spline is above a band and the distance below it, or the
    # other way round. A spline that is wrong there has its level somewhere beside them, and the
    # error in the band does not get smaller by halving cells at that level only.
    around: bool = False
    missed: float = _MISSED  # of the threshold, see there
    proved: bool = True  # otherwise what stays open is sampled and taken as it is


class _Search(NamedTuple):
    """A search, as far as it does not change while triangles are halved."""

    target: Target
    bands: Floats
    wanted: Wanted
    largest: float
    # (n, 4) of each cell: its middle, its exact distance, what quadratics miss of the spline.
    anchor: Floats
    low: Floats  # (8 n,) of the eighths of cells: the error is at least this
    high: Floats  # (8 n,) and at most this; improved step by step
    counts: Bools  # (8 n,)


def cell_errors(
    target: Target, spline: SplineSDF, cells: Ints, center: Floats, bands: Floats, wanted: Wanted
) -> Known:
    """Bracket the largest error in each of some cells.

    Parameters
    ----------
    target : Target
    spline : SplineSDF
    cells : ndarray, shape (n,)
    center : ndarray, shape (n,)
        Exact signed distances at the centers of these cells.
    bands : ndarray, shape (k, 2)
        Only what may lie in one of them counts; all does if there is none.
    wanted : Wanted
    """
    if spline.element.degree > 2 and len(cells) > _MOST_CELLS:
        blocks = np.array_split(np.arange(len(cells)), math.ceil(len(cells) / _MOST_CELLS))
        found = [
            cell_errors(target, spline, cells[block], center[block], bands, wanted)
            for block in blocks
        ]
        return Known(*(np.concatenate(values) for values in zip(*found, strict=True)))
    boxes = spline.mesh.local_boxes[cells] + np.tile(spline.domain[:2] - target.origin, 2)
    count = len(cells)
    middles, largest = 0.5 * (boxes[:, :2] + boxes[:, 2:]), target.largest(boxes)

    def meets(cell: Ints, corners: Floats, least: Floats, most: Floats) -> Bools:
        # The distance is 1-Lipschitz, and known in the middle of the cell.
        apart = np.linalg.norm(corners.reshape(-1, 3, 2) - middles[cell, None], axis=2).max(axis=1)
        grain = _GRAIN * (largest + np.abs(center[cell]))
        reach = apart + grain
        taken, exact = (least - grain, most + grain), (center[cell] - reach, center[cell] + reach)
        return _counts(taken, exact, bands[:, 0, None], bands[:, 1, None], wanted.around)

    numbers, asked = spline.ordinates[cells], meets if len(bands) else None
    wrong = np.abs(spline.element.at_centers(numbers) - center)
    allowed = wanted.missed * np.clip(wrong, wanted.threshold, _HOPELESS * wanted.threshold)
    first = pieces(spline.element, boxes, numbers, allowed, asked)
    search = _Search(
        target=target,
        bands=bands,
        wanted=wanted,
        largest=largest,
        anchor=np.column_stack([middles, center, first.missed]),
        low=np.zeros(8 * count),
        high=np.zeros(8 * count),
        counts=np.zeros(8 * count, dtype=np.bool_),
    )
    part, triangles = _enclose(search, first.boxes, first.halves, first.triangles)
    rounds = _ROUNDS if wanted.proved else _SAMPLED_ROUNDS
    for number in range(rounds + 1):
        if len(part) == 0:
            break
        last = number == rounds or len(part) > _MOST_OPEN
        part, triangles = _sample(search, part, triangles, last)
        corners = triangles[:, :6].reshape(-1, 3, 2)
        around = np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)
        part, triangles = _enclose(search, around, np.stack([part, part], axis=1), triangles)
    low = search.low.reshape(-1, 8)
    high = np.maximum(low, search.high.reshape(-1, 8))
    unsure = high > wanted.threshold if wanted.proved else low > wanted.threshold
    over = np.stack([np.any(unsure & (k == _CORNER), axis=1) for k in range(4)], axis=1)
    counts = np.any(search.counts.reshape(-1, 8), axis=1)
    return Known(low.max(axis=1), high.max(axis=1), counts, over)


def _enclose(
    search: _Search, boxes: Floats, halves: Ints, triangles: Floats
) -> tuple[Ints, Floats]:
    """Improve what is known of eighths by triangles, as many in each box; what stays open.

    ``halves`` (n, 2) says of which eighth each half of a triangle is.
    """
    if len(halves) == 0:
        return halves[:, 0], triangles
    wanted, in_box = search.wanted, len(halves) // len(boxes)
    limits = Limits(
        bands=search.bands,
        around=wanted.around,
        largest=search.largest,
        threshold=wanted.threshold,
        tight=wanted.tight,
        enough=wanted.enough,
        effort=wanted.effort,
        patience=_PATIENCE if in_box > 1 else 1,
    )
    known = search.low[halves]
    low, high = np.empty(halves.shape), np.empty(halves.shape)
    counts = np.empty(halves.shape, dtype=np.bool_)
    anchor = search.anchor[halves[:, 0] // 8]
    left: dict[int, tuple[Ints, Floats]] = {}

    def work(block: slice) -> None:
        here = boxes[block.start // in_box : block.stop // in_box]
        size = block.stop - block.start
        asked = Asked(
            triangles=triangles[block],
            group=np.arange(size) // in_box,
            anchor=anchor[block],
            low=known[block],
        )
        brackets = Brackets(
            low=low[block],
            high=high[block],
            counts=counts[block],
            open_count=np.zeros(1, dtype=np.int64),
            open_from=np.empty(size * _OPEN, dtype=np.int64),
            open_triangles=np.empty((size * _OPEN, 12)),
        )
        search.target.enclose(here, asked, limits, brackets)
        found = int(brackets.open_count[0])
        owner = halves[block].reshape(-1)[brackets.open_from[:found]]
        left[block.start] = owner, brackets.open_triangles[:found].copy()

    in_blocks(len(halves), work, size=_BLOCK)
    np.maximum.at(search.low, halves, low)
    np.maximum.at(search.high, halves, high)
    search.counts[halves[counts]] = True
    owners, pieces = zip(*(left[first] for first in sorted(left)), strict=True)
    part, triangles = np.concatenate(owners), np.concatenate(pieces)
    undecided = search.low[part] <= wanted.enough
    return part[undecided], triangles[undecided]


def _sample(search: _Search, part: Ints, triangles: Floats, last: bool) -> tuple[Ints, Floats]:
    """Bound triangles by the exact distance in one point of each; quarters of what is left.

    Within r of a point p, |s - u| <= |s(p) - u(p)| + (1 + G) r, with G the largest slope of s:
    the distance is 1-Lipschitz.
    """
    from splinesdf.fits.kernels.enclosure import quarter, steepest

    low, high, counts = search.low, search.high, search.counts
    wanted = search.wanted
    middle = 0.5 * (triangles[:, 0:2] + triangles[:, 2:4])
    arms = triangles[:, [0, 1, 4, 5]].reshape(-1, 2, 2) - middle[:, None]
    reach = np.sqrt(np.sum(arms * arms, axis=2).max(axis=1))
    exact = search.target.values(middle + search.target.origin)
    c = triangles[:, 6:]
    error = np.abs(_middle(c) - exact)
    missed = search.anchor[part // 8, 3]
    grain = _GRAIN * search.largest + missed
    slope = np.empty(len(part))
    steepest(triangles, slope)
    spread = (1.0 + slope) * reach + grain
    bound = error + spread
    if not wanted.proved and last:
        bound = error
    seen, meets = error - missed, np.ones(len(part), dtype=np.bool_)
    if len(search.bands):
        seen, meets = _in_bands(search, exact, c, seen, (spread, reach + grain, grain))
    np.maximum.at(low, part[meets], seen[meets])
    counts[part[meets]] = True
    known = low[part]
    enough = np.maximum(wanted.threshold, (1.0 + wanted.tight) * known)
    hopeless = np.bincount(part, minlength=len(low))[part] > wanted.effort
    closed = meets & ((bound <= enough) | (known > wanted.enough) | hopeless | last)
    bound[known > wanted.enough] = np.inf
    np.maximum.at(high, part[closed], bound[closed])
    goes_on = meets & ~closed
    quarters = np.empty((4 * np.count_nonzero(goes_on), 12))
    quarter(triangles[goes_on], quarters)
    return np.repeat(part[goes_on], 4), quarters


def largest_error(
    target: Target,
    spline: SplineSDF,
    center: Floats,
    bands: Floats | None = None,
    known: Known | None = None,
) -> tuple[float, float]:
    """Bracket the largest error over all cells, as narrowly as `TIGHT` unless that cannot be had.

    It cannot where rounding is more than `TIGHT` of the error.

    Parameters
    ----------
    target : Target
    spline : SplineSDF
    center : ndarray, shape (n_cells,)
        Exact signed distances at the centers of the cells.
    bands : ndarray, shape (k, 2), optional
    known : Known, optional
        What is already known of all cells.

    Returns
    -------
    low, high : float
    """
    bands = np.empty((0, 2)) if bands is None else bands
    noise = _NOISE * target.largest_in(spline.domain)
    if known is not None and len(bands):  # what was seen may lie around a band
        known = known._replace(low=np.zeros_like(known.low))
    if known is None:
        error = np.abs(spline.element.at_centers(spline.ordinates) - center)
        wanted = Wanted((1.0 + TIGHT) * float(error.max()) + noise)
        known = cell_errors(target, spline, np.arange(len(center)), center, bands, wanted)
    low, high = (np.where(known.counts, values, 0.0) for values in known[:2])
    # Where nothing is known from below, a glance first: most cells need no more then.
    most = _EFFORT_IN_BANDS if len(bands) else _EFFORT
    effort = most if low.any() else _GLANCE
    while True:
        largest = float(low.max(initial=0.0))
        enough = (1.0 + TIGHT) * largest + noise
        cells = np.flatnonzero(high > enough)
        # The most promising first: once its error is known, few others can exceed it.
        cells = cells[np.argsort(-high[cells], kind="stable")][:_TOGETHER]
        wanted = Wanted(enough, effort=effort)
        found = cell_errors(target, spline, cells, center[cells], bands, wanted)
        improved = (found.low > low[cells]) | (found.high < high[cells])
        if effort == most and not improved.any():  # or no cell was left
            return largest, float(high.max(initial=0.0))
        low[cells] = np.maximum(low[cells], found.low)
        high[cells] = np.minimum(high[cells], found.high)
        effort = most


def _in_bands(
    search: _Search,
    exact: Floats,
    c: Floats,
    error: Floats,
    margins: tuple[Floats, Floats, Floats],
) -> tuple[Floats, Bools]:
    """A lower bound of |s - u| in a point of a band on each triangle, and whether it can meet one.

    In the middle of the longest side it is ``error``, and that counts if this point does. On all
    of the triangle it is less by the first margin at most; that counts if the spline takes a value
    of a band in one of four points, or between them. The other margins are those of the distance
    and of the spline's coefficients.
    """
    spread, reach, grain = margins
    around = search.wanted.around
    lows, highs = search.bands[:, 0, None], search.bands[:, 1, None]
    spline = np.column_stack([c[:, :3], _middle(c)])
    at = _counts((spline[:, 3], spline[:, 3]), (exact, exact), lows, highs, around)
    taken = spline.min(axis=1), spline.max(axis=1)
    some = _counts(taken, (exact, exact), lows, highs, around)
    seen = np.where(some, np.maximum(error - spread, 0.0), 0.0)
    possible = c.min(axis=1) - grain, c.max(axis=1) + grain
    meets = _counts(possible, (exact - reach, exact + reach), lows, highs, around)
    return np.where(at, error, seen), meets


def _counts(
    spline: tuple[Floats, Floats],
    distance: tuple[Floats, Floats],
    lows: Floats,
    highs: Floats,
    around: bool,
) -> Bools:
    """Whether from least to most the spline or the distance is in a band, or both are around it."""
    below, above = spline[0] <= highs, spline[1] >= lows
    nearer, farther = distance[0] <= highs, distance[1] >= lows
    found = (below & above) | (nearer & farther)
    if around:
        found = (below | nearer) & (above | farther)
    return np.asarray(np.any(found, axis=0))


def _middle(c: Floats) -> Floats:
    """The spline halfway along the longest side of triangles with coefficients (n, 6)."""
    return 0.25 * (c[:, 0] + 2.0 * c[:, 3] + c[:, 1])
