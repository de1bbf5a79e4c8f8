"""Values and derivatives of a spline whose cells are in truncated-power form.

With s, t the offsets from a cell's center in cells, the four quadratics of a cell are one
polynomial and two truncated powers, one across each diagonal:

    a0 + a1 s + a2 t + a3 s² + a4 s t + a5 t² + a6 (s - t)₊² + a7 (s + t)₊²

so no search for the triangle and no branch.
"""

from __future__ import annotations

import numpy as np

from splinesdf._arrays import Floats, Ints
from splinesdf._jit import kernel


@kernel
def evaluate(
    frames: Floats,
    powers: Floats,
    cells: Ints,
    points: Floats,
    value: Floats,
    gradient: Floats,
    hessian: Floats,
) -> None:
    """Fill values, and gradients and Hessians where their arrays are not empty.

    Parameters
    ----------
    frames : ndarray, shape (n, 4)
        Center and inverse sides of each cell.
    powers : ndarray, shape (n, 8)
        a0 ... a7 of each cell.
    cells : ndarray, shape (p,)
        -1 gives NaN.
    points : ndarray, shape (p, 2)
    value, gradient, hessian : ndarray, shapes (p,), (p or 0, 2), (p or 0, 3)
        The Hessian as xx, xy, yy. On a diagonal or side it is one of the limits.
    """
    with_gradient, with_hessian = gradient.shape[0] > 0, hessian.shape[0] > 0
    for k in range(points.shape[0]):
        cell = cells[k]
        if cell < 0:
            value[k] = np.nan
            if with_gradient:
                gradient[k, :] = np.nan
            if with_hessian:
                hessian[k, :] = np.nan
            continue
        frame, a = frames[cell], powers[cell]
        s, t = (points[k, 0] - frame[0]) * frame[2], (points[k, 1] - frame[1]) * frame[3]
        right, left = max(s - t, 0.0), max(s + t, 0.0)
        value[k] = (
            a[0]
            + s * (a[1] + a[3] * s + a[4] * t)
            + t * (a[2] + a[5] * t)
            + a[6] * right * right
            + a[7] * left * left
        )
        if with_gradient:
            across, along = 2.0 * a[6] * right, 2.0 * a[7] * left
            gradient[k, 0] = (a[1] + 2.0 * a[3] * s + a[4] * t + across + along) * frame[2]
            gradient[k, 1] = (a[2] + a[4] * s + 2.0 * a[5] * t - across + along) * frame[3]
        if with_hessian:
            bend_across = 2.0 * a[6] if s > t else 0.0
            bend_along = 2.0 * a[7] if s > -t else 0.0
            xx = 2.0 * a[3] + bend_across + bend_along
            yy = 2.0 * a[5] + bend_across + bend_along
            xy = a[4] - bend_across + bend_along
            hessian[k, 0] = xx * frame[2] * frame[2]
            hessian[k, 1] = xy * frame[2] * frame[3]
            hessian[k, 2] = yy * frame[3] * frame[3]
