"""A spline at the nodes of a grid: each cell's polynomials at the nodes in it."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.blocks import in_blocks, processors
from splinesdf.meshes import Mesh

# Cells a thread works on at a time. More: some threads idle at the end; fewer: handing out costs.
_BLOCK = 4096


def values_at_nodes(mesh: Mesh, frames: Floats, table: Floats, x: Floats, y: Floats) -> Floats:
    """Values at increasing x (m,) and y (n,), NaN outside the domain: (n, m).

    Parameters
    ----------
    frames, table : ndarray
        Of the cells, as evaluation takes them.
    """
    from splinesdf.spaces.kernels.evaluation import evaluate_lattice  # Numba loads only when used

    columns, rows = _nodes_of_cells(mesh, x, 0), _nodes_of_cells(mesh, y, 1)
    value = np.full((len(y), len(x)), np.nan)
    local_x, local_y = x - mesh.domain[0], y - mesh.domain[1]

    def work(part: slice) -> None:
        cells = frames[part], table[part], columns[part], rows[part]
        evaluate_lattice(*cells, local_x, local_y, value)

    count = len(frames)
    in_blocks(count, work, size=min(_BLOCK, math.ceil(count / (4 * processors()))))
    return value


def _nodes_of_cells(mesh: Mesh, nodes: Floats, axis: int) -> Ints:
    """The range of increasing nodes in each cell; the last cells have the border's too."""
    boxes, corners = mesh.boxes, mesh.corners
    first = np.searchsorted(nodes, boxes[:, axis], side="left")
    end = np.searchsorted(nodes, boxes[:, axis + 2], side="left")
    last = corners[:, axis + 2] == corners[:, axis + 2].max()
    end[last] = np.searchsorted(nodes, mesh.domain[axis + 2], side="right")
    return np.column_stack([first, end])
