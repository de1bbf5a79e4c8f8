"""Cubics and quartics in triangles by their values at nodes, for `triangles`.

In a triangle of corners p, q, r there are the nodes (u p + v q + w r) / degree with u + v + w the
degree, in VTK's order: corners; pq, qr and rp, each from its first corner; those within.
"""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.spaces.element import indices


class Fans(NamedTuple):
    """The triangles that cells are cut into, each from a part of a side to the cell's center."""

    points: Floats  # (v + c, 2) vertices, then centers of cells
    corners: Ints  # (p, 3) of those, counterclockwise, the center last
    part: Floats  # (p, 2) where the part starts and ends along its side, from 0 to 1
    following: Ints  # (p,) the next one around its cell
    edge: Ints  # (p,) one number for each side of triangles that two cells share


def lagrange_nodes(
    degree: int, ordinates: Floats, fans: Fans
) -> tuple[Floats, Ints, Floats, float]:
    """Nodes (n, 2), those of each triangle (p, nodes), values (n,); and how far these disagree.

    Parameters
    ----------
    degree : int
    ordinates : ndarray, shape (p, k)
        Of the triangle between the whole side and the center.
    fans : Fans
    """
    local = _nodes(degree) / degree
    start, stop = fans.part.T
    zero, one = np.zeros_like(start), np.ones_like(start)
    # The triangle's corners in barycentric coordinates of the whole side's.
    corners = np.array([(1.0 - start, start, zero), (1.0 - stop, stop, zero), (zero, zero, one)])
    every = np.einsum("nk,kcp->pnc", local, corners)
    found = np.zeros(every.shape[:2])
    for column, (a, b, c) in enumerate(indices(degree)):
        weight = factorial(degree) / (factorial(a) * factorial(b) * factorial(c))
        terms = every[..., 0] ** a * every[..., 1] ** b * every[..., 2] ** c
        found += weight * terms * ordinates[:, column, None]
    number = _numbers(degree, fans)
    count = int(number.max()) + 1
    points, values = np.empty((count, 2)), np.empty(count)
    # By steps from the first corner: what lies on the domain's border does so to the last bit.
    first, *others = np.moveaxis(fans.points[fans.corners], 1, 0)
    steps = np.stack([corner - first for corner in others], axis=1)
    points[number] = first[:, None] + np.einsum("nk,pkx->pnx", local[:, 1:], steps)
    points[: len(fans.points)] = fans.points
    values[number] = found
    return points, number, values, float(np.max(np.abs(found - values[number])))


def _nodes(degree: int) -> Ints:
    """How often each node has the three corners."""
    steps = range(1, degree)
    found = [(degree, 0, 0), (0, degree, 0), (0, 0, degree)]
    found += [(degree - k, k, 0) for k in steps]
    found += [(0, degree - k, k) for k in steps]
    found += [(k, 0, degree - k) for k in steps]
    # Of degree 3 one, of degree 4 three, the nearest to the first corner first.
    found += [index for index in indices(degree) if min(index) > 0]
    return np.array(found)


def _numbers(degree: int, fans: Fans) -> Ints:
    """The nodes of each triangle: corners, edges, spokes to the center, and those within."""
    count, steps = len(fans.corners), np.arange(degree - 1)
    first, last, _ = fans.corners.T
    base = len(fans.points)
    # Along an edge from the vertex of the smaller number, for both cells the same.
    along = np.where((first < last)[:, None], steps, steps[::-1])
    edges = base + fans.edge[:, None] * len(steps) + along
    base += (int(fans.edge.max()) + 1) * len(steps)
    spokes = base + np.arange(count)[:, None] * len(steps) + steps  # from the vertex
    base += count * len(steps)
    within = (degree - 1) * (degree - 2) // 2
    inner = base + np.arange(count)[:, None] * within + np.arange(within)
    return np.concatenate(
        [fans.corners, edges, spokes[fans.following], spokes[:, ::-1], inner], axis=1
    )
