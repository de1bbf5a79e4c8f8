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

import math

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.spaces.tables import Block, Evaluated

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
        outside += _locate(x, y, points, first, count, block)
        _fetch_and_compute(powers, block, first, count, evaluated)
    return outside


@uncounted
def _locate(x: Floats, y: Floats, points: Floats, first: int, count: int, block: Block) -> int:
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


@kernel
def evaluate_tree(
    domain: Floats, entry: Ints, walk: Ints, powers: Floats, evaluated: Evaluated
) -> int:
    """Fill values, gradients and Hessians as far as they are asked for, on a quadtree.

    Parameters
    ----------
    domain : ndarray, shape (4,)
    entry, walk : ndarray, shapes (m, n), (n_nodes,)
        As `fill_ways` fills them.
    powers, evaluated : ndarray, Evaluated
        As in `evaluate_grid`.

    Returns
    -------
    int
        How many points are outside the domain or not finite.
    """
    points = evaluated.points
    m, n = entry.shape
    entries = entry.reshape(m * n)
    scales = m / (domain[2] - domain[0]), n / (domain[3] - domain[1])
    block = Block(np.empty(_BLOCK, dtype=np.int64), np.empty((4, _BLOCK)), np.empty((_BLOCK, 8)))
    outside = 0
    for first in range(0, points.shape[0], _BLOCK):
        count = min(_BLOCK, points.shape[0] - first)
        outside += _enter(domain, (m, n), scales, points[first : first + count], block)
        for k in range(count):
            block.cells[k] = entries[np.uint64(block.cells[k])]
        _descend(walk, (m, n), scales, count, block)
        _fetch_and_compute(powers, block, first, count, evaluated)
    return outside


@uncounted
def _enter(
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
def _descend(
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
def fill_ways(
    shape: Ints, child: Ints, cell_of: Ints, levels: int, entry: Ints, walk: Ints
) -> None:
    """Fill the two tables that lead a point of a quadtree to its cell.

    Parameters
    ----------
    shape : ndarray, shape (2,)
        Roots each way.
    child, cell_of : ndarray, shape (n_nodes,)
        First child of a node or -1; cell number of a leaf.
    levels : int
    entry : ndarray, shape (m 2^levels, n 2^levels)
        Filled: the node at this level, or ``~(32 cell + up)`` for a leaf ``up`` levels above.
    walk : ndarray, shape (n_nodes,)
        Filled: the first child of a node, or ``~cell`` for a leaf.
    """
    for node in range(child.shape[0]):
        walk[node] = child[node] if child[node] >= 0 else ~cell_of[node]
    for i in range(entry.shape[0]):
        for j in range(entry.shape[1]):
            node, up = (i >> levels) * shape[1] + (j >> levels), levels
            while up > 0 and child[node] >= 0:
                up -= 1
                node = child[node] + 2 * ((i >> up) & 1) + ((j >> up) & 1)
            entry[i, j] = node if child[node] >= 0 else ~(32 * cell_of[node] + up)


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
