"""The true error of a spline: the maximum of |s - u| over cells, not its value at their centers.

    each cell: 9 x 9 samples ─→ largest |e|, largest step between neighbors
             └─ squares whose corners and steps leave room for more than a threshold
                     └─ 5 x 5 samples in each ─→ again, four times finer each time

Away from the medial axis e is smooth and the first samples would do; where the axis crosses a
cell the maximum sits on a ridge between them, and the second search climbs it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from splinesdf._arrays import Bools, Floats, Ints
from splinesdf.spaces.cells import sampling_matrix
from splinesdf.spline import SplineSDF

Function = Callable[[Floats], Floats]

# Samples a side. Fewer: cells at a kink pass by luck and the search below has more to find; more:
# the cost of a fit, nearly all of which is these samples, grows with the square.
SAMPLES = 9
# Rounds of the search; each divides a square by four, so the last one looks at 1/512 of a cell's
# side, where what is still missed is under a hundredth of what a kink adds.
_ROUNDS = 3
_DIVISIONS = 4
# Cells a batch: 81 samples of 2000 cells and what the distance needs for them stay near 10 MB.
_BATCH = 2000


class CellErrors(NamedTuple):
    """What the first samples say of each cell."""

    largest: Floats  # (n,) largest |e| over the samples
    step: Floats  # (n,) largest difference of e between neighboring samples
    center: Floats  # (n,) |e| at the center: the paper's error


def _square(count: int) -> Floats:
    """Offsets from the center, in cells, of count x count samples; shape (count, count, 2)."""
    line = np.linspace(-0.5, 0.5, count)
    return np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1)


_OFFSETS = _square(SAMPLES)


def cell_errors(function: Function, spline: SplineSDF, cells: Ints) -> CellErrors:
    """Sample the error over the given cells, corners and sides included."""
    offsets = _OFFSETS.reshape(-1, 2)
    matrix = sampling_matrix(offsets)
    result = CellErrors(*(np.empty(len(cells)) for _ in range(3)))
    for first in range(0, len(cells), _BATCH):
        part = slice(first, first + _BATCH)
        chosen = cells[part]
        error = _errors(function, spline, chosen, offsets, matrix)
        square = error.reshape(-1, SAMPLES, SAMPLES)
        result.largest[part] = np.abs(error).max(axis=1)
        result.center[part] = np.abs(square[:, SAMPLES // 2, SAMPLES // 2])
        result.step[part] = np.maximum(
            np.abs(np.diff(square, axis=1)).max(axis=(1, 2)),
            np.abs(np.diff(square, axis=2)).max(axis=(1, 2)),
        )
    return result


def _errors(
    function: Function, spline: SplineSDF, cells: Ints, offsets: Floats, matrix: Floats
) -> Floats:
    boxes = spline.mesh.boxes[cells]
    centers, sides = 0.5 * (boxes[:, :2] + boxes[:, 2:]), boxes[:, 2:] - boxes[:, :2]
    points = centers[:, None] + offsets * sides[:, None]
    exact = function(points.reshape(-1, 2)).reshape(len(cells), -1)
    return spline.ordinates[cells] @ matrix - exact


def sharpen(
    function: Function, spline: SplineSDF, cells: Ints, errors: CellErrors, threshold: float
) -> Floats:
    """Largest |e| of each cell again, searched wherever it may exceed the threshold.

    Parameters
    ----------
    cells : ndarray, shape (n,)
    errors : CellErrors
        Of these cells.
    threshold : float
        Only what lies above it is looked for; below it the first samples stand.

    Returns
    -------
    ndarray, shape (n,)

    Notes
    -----
    A square of one sample step holds no more than its corners' largest |e| plus one step's
    change, if e changes nowhere faster than between the samples seen so far. That is an
    estimate, not a proof; the steps of a kink are all seen by the first samples.
    """
    largest = errors.largest.copy()
    candidates = np.flatnonzero(largest + errors.step > threshold)
    for first in range(0, len(candidates), _BATCH):
        rows = candidates[first : first + _BATCH]
        _climb(function, spline, cells[rows], errors.step[rows], rows, threshold, largest)
    return largest


def _climb(
    function: Function,
    spline: SplineSDF,
    cells: Ints,
    step: Floats,
    rows: Ints,
    threshold: float,
    largest: Floats,
) -> None:
    """Search squares of the given cells, finer and finer; raises ``largest[rows]``."""
    offsets = _OFFSETS.reshape(-1, 2)
    error = np.abs(_errors(function, spline, cells, offsets, sampling_matrix(offsets)))
    low = _OFFSETS[:-1, :-1].reshape(-1, 2)
    side = 1.0 / (SAMPLES - 1)
    owner, square = np.nonzero(
        _corner_maximum(error.reshape(-1, SAMPLES, SAMPLES)) + step[:, None] > threshold
    )
    low = low[square]
    for _ in range(_ROUNDS):
        if len(owner) == 0:
            return
        step = step / _DIVISIONS
        fine = (_square(_DIVISIONS + 1) + 0.5) * side
        side /= _DIVISIONS
        count = (_DIVISIONS + 1) ** 2
        at = (low[:, None] + fine.reshape(-1, 2)).reshape(-1, 2)
        error = _error_at(function, spline, np.repeat(cells[owner], count), at)
        error = error.reshape(-1, _DIVISIONS + 1, _DIVISIONS + 1)
        np.maximum.at(largest, rows[owner], error.max(axis=(1, 2)))
        # What a square's corners and its step cannot lift above both what is known of this
        # cell and the threshold is left.
        known = np.maximum(threshold, largest[rows[owner]])
        which, square = np.nonzero(_corner_maximum(error) + step[owner][:, None] > known[:, None])
        low = low[which] + fine[:-1, :-1].reshape(-1, 2)[square]
        owner = owner[which]


def _corner_maximum(values: Floats) -> Floats:
    """Of the four corners of every square of a sample grid: (n, k, k) -> (n, (k - 1)²)."""
    rows = np.maximum(values[:, :-1], values[:, 1:])
    return np.maximum(rows[:, :, :-1], rows[:, :, 1:]).reshape(len(values), -1)


def _error_at(function: Function, spline: SplineSDF, cells: Ints, offsets: Floats) -> Floats:
    boxes = spline.mesh.boxes[cells]
    low, high = boxes[:, :2], boxes[:, 2:]
    points = 0.5 * (low + high) + offsets * (high - low)
    # Rounding must not put a sample on the far side of the domain's border.
    domain = np.array(spline.domain)
    points = np.clip(points, domain[:2], domain[2:])
    return np.abs(spline(points) - function(points))


def may_meet(
    function: Function, spline: SplineSDF, cells: Ints, band: tuple[float, float]
) -> Bools:
    """Whether the exact distance or the spline can take a value of the band in each cell.

    The distance is 1-Lipschitz, so within a cell it stays within half a diagonal of its value at
    the center; the spline stays between its smallest and largest ordinate.
    """
    boxes = spline.mesh.boxes[cells]
    low, high = band
    reach = 0.5 * np.hypot(boxes[:, 2] - boxes[:, 0], boxes[:, 3] - boxes[:, 1])
    value = function(0.5 * (boxes[:, :2] + boxes[:, 2:]))
    exact = (value + reach >= low) & (value - reach <= high)
    ordinates = spline.ordinates[cells]
    near = (ordinates.max(axis=1) >= low) & (ordinates.min(axis=1) <= high)
    return np.asarray(exact | near)
