"""Named bundles of arrays that the kernels of this folder read."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.ground.arrays import Floats, Ints


class Nodes(NamedTuple):
    """A quadtree that grows, see `splinesdf.spaces.kernels.hierarchical`."""

    shape: Ints  # (2,) roots each way in the domain; one or two more on each side around it
    level: Ints  # (n,)
    place: Ints  # (n, 2) the cell of its level; those before the domain are negative
    child: Ints  # (n,) first of four children, -1 for none
    near: Ints  # (n, 9 or 25) the nodes around, negative where there is none


class Mask(NamedTuple):
    """Subdivision of coefficients, for each parity 2 (i % 2) + j % 2 of a child (i, j)."""

    steps: Ints  # (4, k, 2) from the parent to coarser B-splines
    weights: Floats  # (4, k) theirs


class Ways(NamedTuple):
    """How points get to the cells of a quadtree, see `splinesdf.spaces.kernels.location`."""

    entry: Ints  # (m, n) the node, or ~(32 cell + levels up) of a leaf
    walk: Ints  # (n_nodes,) the first child of a node, or ~cell of a leaf


class Evaluated(NamedTuple):
    """Points, and what is filled in there of a spline."""

    points: Floats  # (n, 2)
    value: Floats  # (n,)
    gradient: Floats  # (n or 0, 2), only filled if not empty
    hessian: Floats  # (n or 0, 3) xx, xy, yy, likewise; it needs the gradient


class Block(NamedTuple):
    """Room for a block of points on their way to the coefficients of their cells."""

    cells: Ints  # (n,)
    local: Floats  # (4, n) s, t, and the inverse sides of the cell
    rows: Floats  # (n, 8 or 15) the coefficients, or none
