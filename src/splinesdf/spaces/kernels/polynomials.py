"""Values and derivatives of a spline of any degree: a polynomial in each triangle of a cell.

The road of elements that have no truncated-power form (`evaluation`). Triangles are S E N W, in the
order of `splinesdf.spaces.element`, which also says how polynomials are written.
"""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.spaces.kernels.location import locate
from splinesdf.spaces.tables import Block, Evaluated

# Points a block. More: memory; fewer: calls.
_BLOCK = 256


@kernel
def evaluate_polynomials(
    x: Floats, y: Floats, polynomials: Floats, degree: int, evaluated: Evaluated
) -> int:
    """Fill values, gradients and Hessians as far as they are asked for, on a grid.

    Parameters
    ----------
    x, y : ndarray, shapes (m + 1,), (n + 1,)
        Increasing grid lines.
    polynomials : ndarray, shape (m n, 4, monomials)
    degree : int
    evaluated : Evaluated
        NaN is filled in outside the domain.

    Returns
    -------
    int
        How many points are outside the domain or not finite.
    """
    points = evaluated.points
    block = Block(np.empty(_BLOCK, dtype=np.int64), np.empty((4, _BLOCK)), np.empty((0, 0)))
    outside = 0
    for first in range(0, points.shape[0], _BLOCK):
        count = min(_BLOCK, points.shape[0] - first)
        outside += locate(x, y, points, first, count, block)
        _compute(polynomials, degree, block, first, count, evaluated)
    return outside


@uncounted
def _compute(
    polynomials: Floats, degree: int, block: Block, first: int, count: int, evaluated: Evaluated
) -> None:
    """Fill values and derivatives of a block whose cells and places in them are known."""
    value, gradient, hessian = evaluated.value, evaluated.gradient, evaluated.hessian
    for k in range(count):
        s, t = block.local[0, k], block.local[1, k]
        in_x, in_y = block.local[2, k], block.local[3, k]
        below, right = s > t, s > -t
        triangle = (1 if right else 0) if below else (2 if right else 3)
        c = polynomials[block.cells[k], triangle]
        at = c.shape[0]
        f, fs, ft, fss, fst, ftt = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        # Horner's rule in s, whose coefficients are polynomials in t by Horner's rule.
        for a in range(degree, -1, -1):
            g, gt, gtt = 0.0, 0.0, 0.0
            for _ in range(degree + 1 - a):
                at -= 1
                gtt = gtt * t + 2.0 * gt
                gt = gt * t + g
                g = g * t + c[at]
            fss = fss * s + 2.0 * fs
            fs = fs * s + f
            fst = fst * s + ft
            f = f * s + g
            ft = ft * s + gt
            ftt = ftt * s + gtt
        value[first + k] = f
        if gradient.shape[0] > 0:
            gradient[first + k, 0], gradient[first + k, 1] = fs * in_x, ft * in_y
        if hessian.shape[0] > 0:
            hessian[first + k, 0] = fss * in_x * in_x
            hessian[first + k, 1] = fst * in_x * in_y
            hessian[first + k, 2] = ftt * in_y * in_y
