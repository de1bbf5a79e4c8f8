"""Where points are: the cells that they lie in, and the offsets from the cells' centers.

On a grid by a guess as if it were uniform; in a quadtree through a table of entries, then down.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.spaces.tables import Block, Ways


@uncounted
def locate(x: Floats, y: Floats, points: Floats, first: int, count: int, block: Block) -> int:
    """Fill the cells of points, and where in them they are; how many are outside the domain."""
    cells, local = block.cells, block.local
    m, n = x.shape[0] - 1, y.shape[0] - 1
    scale_x, scale_y = m / (x[m] - x[0]), n / (y[n] - y[0])
    outside = 0
    for k in range(count):
        px, py = points[first + k, 0], points[first + k, 1]
        if not (x[0] <= px <= x[m] and y[0] <= py <= y[n]):  # NaN lands here too
            outside += 1
            _leave_out(block, k)
            continue
        i, j = _interval(x, m, scale_x, px), _interval(y, n, scale_y, py)
        cells[k] = i * n + j
        width, height = x[i + 1] - x[i], y[j + 1] - y[j]
        local[2, k], local[3, k] = 1.0 / width, 1.0 / height
        local[0, k] = (px - 0.5 * (x[i] + x[i + 1])) * local[2, k]
        local[1, k] = (py - 0.5 * (y[j] + y[j + 1])) * local[3, k]
    return outside


@uncounted
def _leave_out(block: Block, k: int) -> None:
    """Have NaN computed for a point."""
    block.cells[k] = 0
    for e in range(4):
        block.local[e, k] = np.nan


@uncounted
def _interval(lines: Floats, count: int, scale: float, value: float) -> int:
    """The last line at or below the value: a guess as if uniform, bisection if that fails."""
    guess = min(max(int((value - lines[0]) * scale), 0), count - 1)
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


@uncounted
def enter(
    domain: Floats,
    shape: tuple[int, int],
    scales: tuple[float, float],
    points: Floats,
    block: Block,
) -> int:
    """Fill places of points in the table of entries, and where they are among them.

    How many are outside the domain.
    """
    cells, local = block.cells, block.local
    m, n = shape
    outside = 0
    for k in range(points.shape[0]):
        px, py = points[k, 0], points[k, 1]
        if not (domain[0] <= px <= domain[2] and domain[1] <= py <= domain[3]):
            outside += 1
            cells[k] = 0
            local[0, k] = np.nan
            continue
        local[0, k], local[1, k] = (px - domain[0]) * scales[0], (py - domain[1]) * scales[1]
        i, j = min(int(local[0, k]), m - 1), min(int(local[1, k]), n - 1)
        cells[k] = i * n + j
    return outside


@uncounted
def descend(
    walk: Ints, shape: tuple[int, int], scales: tuple[float, float], count: int, block: Block
) -> None:
    """From the entries of points to their cells, and where in them they are."""
    cells, local = block.cells, block.local
    m, n = shape
    for k in range(count):
        u, v, node, factor = local[0, k], local[1, k], cells[k], 1.0
        if u != u:
            _leave_out(block, k)
            continue
        if node < 0:
            up = ~node & 31
            node = ~node >> 5
            factor = 1.0 / (1 << up)
            u, v = u * factor, v * factor
            u -= min(math.floor(u), m * factor - 1.0)
            v -= min(math.floor(v), n * factor - 1.0)
        else:
            u -= min(math.floor(u), m - 1.0)
            v -= min(math.floor(v), n - 1.0)
            while walk[node] >= 0:
                u, v, factor = 2.0 * u, 2.0 * v, 2.0 * factor
                node = walk[node]
                if u >= 1.0:
                    u -= 1.0
                    node += 2
                if v >= 1.0:
                    v -= 1.0
                    node += 1
            node = ~walk[node]
        cells[k] = node
        local[0, k], local[1, k] = u - 0.5, v - 0.5
        local[2, k], local[3, k] = scales[0] * factor, scales[1] * factor


@kernel
def fill_ways(shape: Ints, child: Ints, cell_of: Ints, levels: int, ways: Ways) -> None:
    """Fill the two tables that lead a point of a quadtree to its cell.

    Parameters
    ----------
    shape : ndarray, shape (2,)
        Roots each way.
    child, cell_of : ndarray, shape (n_nodes,)
        First child of a node or -1; cell number of a leaf.
    levels : int
    ways : Ways
        Filled; its entries are of shape (m 2^levels, n 2^levels).
    """
    entry, walk = ways.entry, ways.walk
    for node in range(child.shape[0]):
        walk[node] = child[node] if child[node] >= 0 else ~cell_of[node]
    for i in range(entry.shape[0]):
        for j in range(entry.shape[1]):
            node, up = (i >> levels) * shape[1] + (j >> levels), levels
            while up > 0 and child[node] >= 0:
                up -= 1
                node = child[node] + 2 * ((i >> up) & 1) + ((j >> up) & 1)
            entry[i, j] = node if child[node] >= 0 else ~(32 * cell_of[node] + up)
