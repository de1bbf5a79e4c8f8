"""A spline along the border of its domain, and what is answered from there beside it."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.ground.blocks import in_blocks
from splinesdf.meshes import Box, Mesh
from splinesdf.spaces.tables import Evaluated
from splinesdf.splines.tables import Border

# Nodes of a grid outside the domain that a thread extends to at a time.
_OUTER = 8192


def border_of(mesh: Mesh, ordinates: Floats) -> Border:
    """The border of a quadratic spline, see `splinesdf.splines.kernels.extension`."""
    from splinesdf.splines.kernels.extension import fill_drops  # Numba loads only when it is used

    boxes, corners, domain = mesh.local_boxes, mesh.corners, mesh.domain
    edges = []
    # Side after side: cells beside it, by which corner; columns of V, E, V; the axis along it.
    for by, columns, axis in (
        (1, (0, 4, 1), 0),
        (2, (1, 5, 3), 1),
        (3, (2, 6, 3), 0),
        (0, (0, 7, 2), 1),
    ):
        last = corners[:, by].max() if by > 1 else corners[:, by].min()
        cells = np.flatnonzero(corners[:, by] == last)
        cells = cells[np.argsort(corners[cells, axis])]
        beside = ordinates[cells][:, columns]
        side = np.column_stack([boxes[cells, axis], beside[:, 0], beside[:, 1]])
        length = domain[axis + 2] - domain[axis]
        edges.append(np.vstack([side, [length, beside[-1, 2], 0.0]]))
    counts = np.array([len(side) for side in edges])
    starts = np.concatenate([[0], np.cumsum(counts)])
    drops = np.zeros((4, 2 << math.ceil(math.log2(counts.max()))))
    border = Border(starts, np.ascontiguousarray(np.concatenate(edges)), drops)
    fill_drops(border)
    return border


def extend_lattice(domain: Box, border: Border, x: Floats, y: Floats, distance: Floats) -> None:
    """Fill the nodes of a grid, shape (ny, nx), that are outside the domain."""
    from splinesdf.splines.kernels.extension import extend

    xmin, ymin, xmax, ymax = domain
    beside = (y < ymin) | (y > ymax)
    nodes = np.flatnonzero(beside[:, None] | ((x < xmin) | (x > xmax)))
    flat = distance.reshape(-1)

    def work(part: slice) -> None:
        j, i = np.divmod(nodes[part], len(x))
        value = np.empty(len(i))
        points = np.column_stack([x[i], y[j]])
        extend(
            np.array(domain), border, Evaluated(points, value, np.empty((0, 2)), np.empty((0, 3)))
        )
        flat[nodes[part]] = value

    in_blocks(len(nodes), work, size=_OUTER)
