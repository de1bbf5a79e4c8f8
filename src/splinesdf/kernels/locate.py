"""Which cell a point lies in."""

from __future__ import annotations

import math

from splinesdf._arrays import Floats, Ints
from splinesdf._jit import kernel


@kernel
def locate_grid(x: Floats, y: Floats, points: Floats, cells: Ints) -> None:
    """Fill the cell number ``i * n + j`` of each point of a grid, -1 outside.

    Parameters
    ----------
    x, y : ndarray, shapes (m + 1,), (n + 1,)
        Increasing grid lines.
    points : ndarray, shape (p, 2)
    cells : ndarray, shape (p,)
    """
    m, n = x.shape[0] - 1, y.shape[0] - 1
    for k in range(points.shape[0]):
        px, py = points[k, 0], points[k, 1]
        if not (x[0] <= px <= x[m] and y[0] <= py <= y[n]):  # NaN lands here too
            cells[k] = -1
            continue
        cells[k] = _interval(x, m, px) * n + _interval(y, n, py)


@kernel
def _interval(lines: Floats, count: int, value: float) -> int:
    """The last line at or below the value: a guess as if uniform, bisection if that fails."""
    guess = int((value - lines[0]) / (lines[count] - lines[0]) * count)
    guess = min(max(guess, 0), count - 1)
    if lines[guess] <= value < lines[guess + 1]:
        return guess
    low, high = 0, count
    while high - low > 1:
        middle = (low + high) // 2
        if lines[middle] <= value:
            low = middle
        else:
            high = middle
    return low


@kernel
def locate_tree(
    domain: Floats, shape: Ints, child: Ints, cell_of: Ints, points: Floats, cells: Ints
) -> None:
    """Fill the cell number of each point of a quadtree, -1 outside.

    Parameters
    ----------
    domain : ndarray, shape (4,)
    shape : ndarray, shape (2,)
        Roots each way.
    child, cell_of : ndarray, shape (n_nodes,)
        First child of a node or -1; cell number of a leaf.
    points : ndarray, shape (p, 2)
    cells : ndarray, shape (p,)
    """
    m, n = shape[0], shape[1]
    scale_x, scale_y = m / (domain[2] - domain[0]), n / (domain[3] - domain[1])
    for k in range(points.shape[0]):
        px, py = points[k, 0], points[k, 1]
        if not (domain[0] <= px <= domain[2] and domain[1] <= py <= domain[3]):
            cells[k] = -1
            continue
        u, v = (px - domain[0]) * scale_x, (py - domain[1]) * scale_y
        i, j = min(math.floor(u), m - 1), min(math.floor(v), n - 1)
        u, v = u - i, v - j
        node = i * n + j
        while child[node] >= 0:
            u, v = 2.0 * u, 2.0 * v
            node = child[node]
            if u >= 1.0:
                u -= 1.0
                node += 2
            if v >= 1.0:
                v -= 1.0
                node += 1
        cells[k] = cell_of[node]
