"""Values of a spline at the nodes of a lattice, from cell to cell: no node looks for its cell."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.blocks import in_blocks, processors
from splinesdf.meshes import Mesh


def values_on_lattice(
    mesh: Mesh, frames: Floats, powers: Floats, lines: tuple[Floats, Floats]
) -> Floats:
    """Values at the nodes of increasing lines x and y, NaN outside the domain.

    Parameters
    ----------
    mesh : Grid or Quadtree
    frames, powers : ndarray, shapes (n, 4), (n, 8)
        As `splinesdf.spaces.kernels.evaluation.evaluate_lattice` has them.
    lines : (x, y), shapes (nx,), (ny,)

    Returns
    -------
    ndarray, shape (ny, nx)
    """
    from splinesdf.spaces.kernels.evaluation import evaluate_lattice  # Numba loads only when used

    x, y = lines
    columns, rows = _nodes_of_cells(mesh, x, 0), _nodes_of_cells(mesh, y, 1)
    local_x, local_y = x - mesh.domain[0], y - mesh.domain[1]
    values = np.full((len(y), len(x)), np.nan)

    def work(part: slice) -> None:
        cells = frames[part], powers[part], columns[part], rows[part]
        evaluate_lattice(*cells, local_x, local_y, values)

    in_blocks(len(powers), work, size=min(4096, math.ceil(len(powers) / (4 * processors()))))
    return values


def _nodes_of_cells(mesh: Mesh, nodes: Floats, axis: int) -> Ints:
    """The range of increasing nodes in each cell; the last cells have the border's too."""
    boxes, corners = mesh.boxes, mesh.corners
    first = np.searchsorted(nodes, boxes[:, axis], side="left")
    end = np.searchsorted(nodes, boxes[:, axis + 2], side="left")
    last = corners[:, axis + 2] == corners[:, axis + 2].max()
    end[last] = np.searchsorted(nodes, mesh.domain[axis + 2], side="right")
    return np.column_stack([first, end])
