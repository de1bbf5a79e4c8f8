"""Points sorted into the cells of a quadtree: each cell of each level is a run of the order."""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted


@kernel
def finite_box(points: Floats, box: Floats) -> None:
    """Fill xmin, ymin, xmax, ymax of the finite points (n, 2); infinity, -infinity if none is."""
    xmin = ymin = np.inf
    xmax = ymax = -np.inf
    for i in range(points.shape[0]):
        x, y = points[i, 0], points[i, 1]
        if np.isfinite(x) and np.isfinite(y):
            xmin, xmax = min(xmin, x), max(xmax, x)
            ymin, ymax = min(ymin, y), max(ymax, y)
    box[0], box[1], box[2], box[3] = xmin, ymin, xmax, ymax


@kernel
def sort_into_cells(
    points: Floats, box: Floats, levels: int, starts: Ints, order: Ints, ordered: Floats
) -> None:
    """Sort points by the finest cell that they lie in, cells numbered along a Z-shaped curve.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
    box : ndarray, shape (4,)
        Lower left corner, width and height of the root cell.
    levels : int
        There are 4^levels finest cells.
    starts : ndarray, shape (4^levels + 2,)
        Filled: cell ``c`` has the points ``order[starts[c]:starts[c + 1]]``. The last cell is
        the plane outside the box.
    order : ndarray, shape (n,)
        Filled; points that are not finite are left out, at its end.
    ordered : ndarray, shape (n, 2)
        Filled with the points in this order.
    """
    side = 1 << levels
    outside = side * side
    code = np.empty(points.shape[0], dtype=np.int32)
    starts[:] = 0
    for i in range(points.shape[0]):
        px, py = points[i, 0], points[i, 1]
        x, y = (px - box[0]) / box[2], (py - box[1]) / box[3]
        if 0.0 <= x < 1.0 and 0.0 <= y < 1.0:
            code[i] = _spread(int(x * side)) | (_spread(int(y * side)) << 1)
        elif np.isfinite(px) and np.isfinite(py):
            code[i] = outside
        else:
            code[i] = -1
            continue
        starts[code[i] + 1] += 1
    for cell in range(outside + 1):
        starts[cell + 1] += starts[cell]
    total = left_out = starts[outside + 1]
    # From the back, so that the points of a cell keep their order: starts[cell + 1], the end of
    # the cell, moves down to its beginning.
    for i in range(points.shape[0] - 1, -1, -1):
        cell = code[i]
        if cell < 0:
            at = left_out
            left_out += 1
        else:
            starts[cell + 1] -= 1
            at = starts[cell + 1]
        order[at] = i
        ordered[at, 0], ordered[at, 1] = points[i, 0], points[i, 1]
    for cell in range(outside + 1):
        starts[cell] = starts[cell + 1]
    starts[outside + 1] = total


@uncounted
def _spread(value: int) -> int:
    """The bits of a number below 2^16, with a zero in front of each."""
    value = (value | (value << 8)) & 0x00FF00FF
    value = (value | (value << 4)) & 0x0F0F0F0F
    value = (value | (value << 2)) & 0x33333333
    return (value | (value << 1)) & 0x55555555
