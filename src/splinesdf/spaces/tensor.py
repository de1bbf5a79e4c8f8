"""The space S₂¹ on a grid: one coefficient a cell and a ring of cells around the domain.

The B-spline of a cell is the Zwart-Powell element, the box spline M₁₁₁₁, on unequal cells.
"""

from __future__ import annotations

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, whole
from splinesdf.meshes.grid import Grid


def ghosted_sides(lines: Floats) -> Floats:
    """Cell sides with one more at each end, equal to its neighbor: (m + 1,) -> (m + 2,)."""
    sides = np.diff(lines)
    return np.concatenate([sides[:1], sides, sides[-1:]])


def tensor_ordinates(mesh: Grid, coefficients: Floats) -> Floats:
    """Ordinates of the spline with these coefficients.

    Parameters
    ----------
    mesh : Grid
        m x n cells with sides h_i, k_j; the ring beyond has the sides of its neighbors.
    coefficients : ndarray, shape (m + 2, n + 2)
        One a cell, the ring included.

    Returns
    -------
    ndarray, shape (m n, 8)

    References
    ----------
    [Wang2014] Section 2, in the form: values at cell centers, interpolated linearly to the grid
    lines, ``(h_i c_{i-1} + h_{i-1} c_i) / (h_{i-1} + h_i)``.
    """
    m, n = mesh.shape
    if coefficients.shape != (m + 2, n + 2):
        raise InputError(
            f"expected coefficients of shape {(m + 2, n + 2)}, got {coefficients.shape}"
        )
    to_x = _to_lines(coefficients, ghosted_sides(mesh.x))  # (m + 1, n + 2)
    to_y = _to_lines(coefficients.T, ghosted_sides(mesh.y)).T  # (m + 2, n + 1)
    vertex = _to_lines(to_x.T, ghosted_sides(mesh.y)).T  # (m + 1, n + 1)
    west, south = to_x[:, 1:-1], to_y[1:-1]
    parts = [
        vertex[:-1, :-1],
        vertex[1:, :-1],
        vertex[:-1, 1:],
        vertex[1:, 1:],
        south[:, :-1],
        west[1:],
        south[:, 1:],
        west[:-1],
    ]
    return np.stack([part.reshape(-1) for part in parts], axis=1)


def _to_lines(values: Floats, sides: Floats) -> Floats:
    """Linear interpolation along axis 0 from cell centers to the lines between them."""
    before, after = sides[:-1, None], sides[1:, None]
    return np.asarray((after * values[:-1] + before * values[1:]) / (before + after))


def bspline_coefficients(mesh: Grid, i: int, j: int) -> Floats:
    """Coefficients of the one B-spline of cell (i, j), where -1 and m, n are the ring."""
    m, n = mesh.shape
    i, j = whole(i, "i", least=-1, most=m), whole(j, "j", least=-1, most=n)
    result = np.zeros((m + 2, n + 2))
    result[i + 1, j + 1] = 1.0
    return result
