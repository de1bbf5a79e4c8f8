"""Nodes of a grid, and what is known at them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, shown, whole
from splinesdf.ground.brief import brief
from splinesdf.meshes.mesh import Box

# Nodes along a side of a grid. More: squared they have no place in any memory, and their count none
# in an index; fewer: a long strip could not be asked for.
_MOST_NODES = 10_000_000

Nodes = int | tuple[int, int]


class DistanceGrid(NamedTuple):
    """Signed distances at the nodes of a grid.

    Attributes
    ----------
    x, y : ndarray, shapes (nx,), (ny,)
    distance : ndarray, shape (ny, nx)
        ``distance[j, i]`` is that of (x[i], y[j]).

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> x, y, distance = ss.signed_distance_grid(square, 5, 3)
    >>> distance.shape == (len(y), len(x))
    True
    """

    x: Floats
    y: Floats
    distance: Floats

    def __repr__(self) -> str:
        return brief("DistanceGrid", "", f"{len(self.x)} x {len(self.y)} nodes")


def grid_nodes(nx: Nodes, ny: int | None, box: Box) -> tuple[Floats, Floats]:
    """Equal steps over a box each way, its border included.

    Parameters
    ----------
    nx, ny : int
        How many nodes: two numbers, a pair of them as ``nx``, or one for both.
    """
    if isinstance(nx, tuple | list):
        if ny is not None or len(nx) != 2:
            raise InputError(f"expected for nx a pair of node counts or one, got {shown(nx)}")
        nx, ny = nx
    columns, rows = node_count(nx, "nx"), node_count(nx if ny is None else ny, "ny")
    return np.linspace(box[0], box[2], columns), np.linspace(box[1], box[3], rows)


def node_count(count: int, name: str) -> int:
    """How many nodes a grid has along a side, from 2 on, or an `InputError`."""
    number = whole(count, f"the number of nodes {name}", least=0, most=_MOST_NODES)
    if number < 2:
        raise InputError(f"expected at least 2 nodes each way, got {number} for {name}")
    return number
