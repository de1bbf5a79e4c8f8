"""Values and derivatives of a quartic spline, whose cells are in the power form of `quartic`.

As in `evaluation`: no search for the triangle and no branch, in blocks of three short loops.
"""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.spaces.kernels.location import descend, enter, locate
from splinesdf.spaces.tables import Block, Evaluated, Ways

# Points a block. More: the fetched rows, 120 bytes each, leave the first-level cache; fewer: the
# fetching loop ends before memory is busy.
_BLOCK = 192
_NUMBERS = 15


@kernel
def evaluate_quartic_grid(x: Floats, y: Floats, powers: Floats, evaluated: Evaluated) -> int:
    """Fill values, gradients and Hessians as far as they are asked for, on a grid.

    Parameters
    ----------
    x, y : ndarray, shapes (m + 1,), (n + 1,)
        Increasing grid lines.
    powers : ndarray, shape (m n, 15)
    evaluated : Evaluated
        NaN is filled in outside the domain.

    Returns
    -------
    int
        How many points are outside the domain or not finite.
    """
    points = evaluated.points
    rows = np.empty((_BLOCK, _NUMBERS))
    block = Block(np.empty(_BLOCK, dtype=np.int64), np.empty((4, _BLOCK)), rows)
    outside = 0
    for first in range(0, points.shape[0], _BLOCK):
        count = min(_BLOCK, points.shape[0] - first)
        outside += locate(x, y, points, first, count, block)
        _fetch_and_compute(powers, block, first, count, evaluated)
    return outside


@kernel
def evaluate_quartic_tree(domain: Floats, ways: Ways, powers: Floats, evaluated: Evaluated) -> int:
    """Fill values, gradients and Hessians as far as they are asked for, on a quadtree.

    Parameters
    ----------
    domain : ndarray, shape (4,)
    ways : Ways
    powers, evaluated : ndarray, Evaluated
        As in `evaluate_quartic_grid`.

    Returns
    -------
    int
        How many points are outside the domain or not finite.
    """
    points, entry = evaluated.points, ways.entry
    m, n = entry.shape
    entries = entry.reshape(m * n)
    scales = m / (domain[2] - domain[0]), n / (domain[3] - domain[1])
    rows = np.empty((_BLOCK, _NUMBERS))
    block = Block(np.empty(_BLOCK, dtype=np.int64), np.empty((4, _BLOCK)), rows)
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
    local, rows = block.local, block.rows
    for k in range(count):
        cell = np.uint64(block.cells[k])
        for e in range(_NUMBERS):
            rows[k, e] = powers[cell, e]
    for k in range(count):
        evaluated.value[first + k] = _value(rows[k], local[0, k], local[1, k])
    if evaluated.gradient.shape[0] > 0:
        for k in range(count):
            _fill_gradient(rows[k], local, k, evaluated.gradient[first + k])
    if evaluated.hessian.shape[0] > 0:
        for k in range(count):
            _fill_hessian(rows[k], local, k, evaluated.hessian[first + k])


@uncounted
def _value(a: Floats, s: float, t: float) -> float:
    right, left = _truncated(s, t)
    plus, minus = (s + t) * (s + t), (s - t) * (s - t)
    right, left = right * right, left * left
    in_s = a[1] + s * (a[3] + s * (a[6] + a[10] * t) + a[7] * t) + a[4] * t
    in_t = a[2] + t * (a[5] + t * (a[9] + a[11] * s) + a[8] * s)
    fourth = a[12] * (plus * plus + minus * minus) + a[13] * right * right + a[14] * left * left
    return float(a[0] + s * in_s + t * in_t + fourth)


@uncounted
def _truncated(s: float, t: float) -> tuple[float, float]:
    """(s - t)₊ and (s + t)₊, without a branch."""
    return s - t if s > t else 0.0, s + t if s > -t else 0.0


@uncounted
def _fill_gradient(a: Floats, local: Floats, k: int, gradient: Floats) -> None:
    s, t = local[0, k], local[1, k]
    right, left = _truncated(s, t)
    plus, minus = s + t, s - t
    along = 4.0 * (a[12] * plus * plus * plus + a[14] * left * left * left)
    across = 4.0 * (a[12] * minus * minus * minus + a[13] * right * right * right)
    in_s = a[1] + s * (2.0 * a[3] + 3.0 * s * (a[6] + a[10] * t) + 2.0 * a[7] * t)
    in_s += t * (a[4] + t * (a[8] + a[11] * t)) + along + across
    in_t = a[2] + t * (2.0 * a[5] + 3.0 * t * (a[9] + a[11] * s) + 2.0 * a[8] * s)
    in_t += s * (a[4] + s * (a[7] + a[10] * s)) + along - across
    gradient[0], gradient[1] = in_s * local[2, k], in_t * local[3, k]


@uncounted
def _fill_hessian(a: Floats, local: Floats, k: int, hessian: Floats) -> None:
    s, t, in_x, in_y = local[0, k], local[1, k], local[2, k], local[3, k]
    right, left = _truncated(s, t)
    plus, minus = s + t, s - t
    along = 12.0 * (a[12] * plus * plus + a[14] * left * left)
    across = 12.0 * (a[12] * minus * minus + a[13] * right * right)
    in_ss = 2.0 * a[3] + 6.0 * s * (a[6] + a[10] * t) + 2.0 * a[7] * t
    in_st = a[4] + s * (2.0 * a[7] + 3.0 * a[10] * s) + t * (2.0 * a[8] + 3.0 * a[11] * t)
    in_tt = 2.0 * a[5] + 6.0 * t * (a[9] + a[11] * s) + 2.0 * a[8] * s
    hessian[0] = (in_ss + along + across) * in_x * in_x
    hessian[1] = (in_st + along - across) * in_x * in_y
    hessian[2] = (in_tt + along + across) * in_y * in_y
