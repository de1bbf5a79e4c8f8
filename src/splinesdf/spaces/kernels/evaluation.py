"""Values and derivatives of a spline whose cells are in truncated-power form.

With s, t the offsets from a cell's center in cells, the four quadratics of a cell are one
polynomial and two truncated powers, one across each diagonal:

    a0 + a1 s + a2 t + a3 s² + a4 s t + a5 t² + a6 (s - t)₊² + a7 (s + t)₊²

so no search for the triangle and no branch. Points come in any order, so it is the way to their
cells' coefficients that costs; each block of points is therefore taken through three short loops:

    points ─ locate ─→ cell, s, t ─ fetch ─→ the cells' a0 ... a7, side by side ─ compute ─→ values

The loop that fetches does nothing else: the processor then has a dozen lines of memory under way
at a time, where a loop that also computes has three.
"""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.spaces.kernels.location import descend, enter, locate
from splinesdf.spaces.tables import Block, Evaluated, Ways

# Points a block. More: the fetched rows, 64 bytes each, leave the first-level cache; fewer: the
# fetching loop ends before memory is busy.
_BLOCK = 256


@kernel
def evaluate_grid(x: Floats, y: Floats, powers: Floats, evaluated: Evaluated) -> int:
    """Fill values, gradients and Hessians as far as they are asked for, on a grid.

    Parameters
    ----------
    x, y : ndarray, shapes (m + 1,), (n + 1,)
        Increasing grid lines.
    powers : ndarray, shape (m n, 8)
        a0 ... a7 of each cell.
    evaluated : Evaluated
        NaN is filled in outside the domain.

    Returns
    -------
    int
        How many points are outside the domain or not finite.
    """
    points = evaluated.points
    block = Block(np.empty(_BLOCK, dtype=np.int64), np.empty((4, _BLOCK)), np.empty((_BLOCK, 8)))
    outside = 0
    for first in range(0, points.shape[0], _BLOCK):
        count = min(_BLOCK, points.shape[0] - first)
        outside += locate(x, y, points, first, count, block)
        _fetch_and_compute(powers, block, first, count, evaluated)
    return outside


@kernel
def evaluate_tree(domain: Floats, ways: Ways, powers: Floats, evaluated: Evaluated) -> int:
    """Fill values, gradients and Hessians as far as they are asked for, on a quadtree.

    Parameters
    ----------
    domain : ndarray, shape (4,)
    ways : Ways
    powers, evaluated : ndarray, Evaluated
        As in `evaluate_grid`.

    Returns
    -------
    int
        How many points are outside the domain or not finite.
    """
    points, entry = evaluated.points, ways.entry
    m, n = entry.shape
    entries = entry.reshape(m * n)
    scales = m / (domain[2] - domain[0]), n / (domain[3] - domain[1])
    block = Block(np.empty(_BLOCK, dtype=np.int64), np.empty((4, _BLOCK)), np.empty((_BLOCK, 8)))
    outside = 0
    for first in range(0, points.shape[0], _BLOCK):
        count = min(_BLOCK, points.shape[0] - first)
        outside += enter(domain, (m, n), scales, points[first : first + count], block)
        for k in range(count):
            block.cells[k] = entries[np.uint64(block.cells[k])]
        descend(ways.walk, (m, n), scales, count, block)
        _fetch_and_compute(powers, block, first, count, evaluated)
    return outside


@uncounted
def _fetch_and_compute(
    powers: Floats, block: Block, first: int, count: int, evaluated: Evaluated
) -> None:
    """The two last loops of a block, whose cells and places in them are known."""
    cells, local, rows = block.cells, block.local, block.rows
    value, gradient, hessian = evaluated.value, evaluated.gradient, evaluated.hessian
    for k in range(count):
        # Unsigned, it needs no check for a negative index, which would hold up the fetching.
        cell = np.uint64(cells[k])
        for e in range(8):
            rows[k, e] = powers[cell, e]
    if gradient.shape[0] == 0:
        for k in range(count):
            a, s, t = rows[k], local[0, k], local[1, k]
            right = s - t if s > t else 0.0
            left = s + t if s > -t else 0.0
            value[first + k] = _value(a, s, t, right, left)
        return
    for k in range(count):
        a, s, t = rows[k], local[0, k], local[1, k]
        right = s - t if s > t else 0.0
        left = s + t if s > -t else 0.0
        value[first + k] = _value(a, s, t, right, left)
        across, along = 2.0 * a[6] * right, 2.0 * a[7] * left
        in_s = a[1] + 2.0 * a[3] * s + a[4] * t + across + along
        in_t = a[2] + a[4] * s + 2.0 * a[5] * t - across + along
        gradient[first + k, 0], gradient[first + k, 1] = in_s * local[2, k], in_t * local[3, k]
    if hessian.shape[0] > 0:
        for k in range(count):
            a, s, t, in_x, in_y = rows[k], local[0, k], local[1, k], local[2, k], local[3, k]
            across = 2.0 * a[6] if s > t else 0.0
            along = 2.0 * a[7] if s > -t else 0.0
            hessian[first + k, 0] = (2.0 * a[3] + across + along) * in_x * in_x
            hessian[first + k, 1] = (a[4] - across + along) * in_x * in_y
            hessian[first + k, 2] = (2.0 * a[5] + across + along) * in_y * in_y


@uncounted
def _value(a: Floats, s: float, t: float, right: float, left: float) -> float:
    return float(
        a[0]
        + s * (a[1] + a[3] * s + a[4] * t)
        + t * (a[2] + a[5] * t)
        + a[6] * right * right
        + a[7] * left * left
    )


@kernel
def evaluate_lattice(
    frames: Floats,
    powers: Floats,
    columns: Ints,
    rows: Ints,
    x: Floats,
    y: Floats,
    value: Floats,
) -> None:
    """Fill values at the nodes of a lattice, cell by cell: no node looks for its cell.

    Parameters
    ----------
    frames, powers : ndarray, shapes (n, 4), (n, 8)
        Center and inverse sides, and a0 ... a7, of each cell.
    columns, rows : ndarray, shape (n, 2)
        Cell ``c`` has the nodes ``x[columns[c, 0]:columns[c, 1]]`` and likewise in y.
    x, y : ndarray, shapes (nx,), (ny,)
    value : ndarray, shape (ny, nx)
    """
    for cell in range(frames.shape[0]):
        _fill_cell(frames[cell], powers[cell], columns[cell], rows[cell], x, y, value)


@uncounted
def _fill_cell(
    frame: Floats, a: Floats, columns: Ints, rows: Ints, x: Floats, y: Floats, value: Floats
) -> None:
    """Fill values at the nodes of a lattice that lie in one cell."""
    for j in range(rows[0], rows[1]):
        t = (y[j] - frame[1]) * frame[3]
        constant, slope = a[0] + t * (a[2] + a[5] * t), a[1] + a[4] * t
        for i in range(columns[0], columns[1]):
            s = (x[i] - frame[0]) * frame[2]
            right = s - t if s > t else 0.0
            left = s + t if s > -t else 0.0
            value[j, i] = (
                constant + s * (slope + a[3] * s) + a[6] * right * right + a[7] * left * left
            )
