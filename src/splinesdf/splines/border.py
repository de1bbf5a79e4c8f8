"""A spline along the border of its domain, and what is answered from there beside it."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.ground.blocks import in_blocks
from splinesdf.meshes import Box, Mesh
from splinesdf.spaces.element import Element, indices
from splinesdf.spaces.tables import Evaluated
from splinesdf.splines.tables import Border

# Share of the largest number of a cell that quadratics along the border may miss of a spline of a
# higher degree. Smaller: rounding; larger: values jump by that much on the way out of the domain.
_MISSED = 1e-12
# Halvings of a cell's edge for that at most: beyond it the spline is none that distances have.
_HALVINGS = 12
# Nodes of a grid outside the domain that a thread extends to at a time.
_OUTER = 8192


def border_of(mesh: Mesh, element: Element, numbers: Floats) -> Border:
    """The border of a spline, see `splinesdf.splines.kernels.extension`.

    Of a higher degree than 2 in pieces, on which quadratics with the same ends miss little.
    """
    from splinesdf.splines.kernels.extension import fill_drops  # Numba loads only when it is used

    boxes, corners, domain = mesh.local_boxes, mesh.corners, mesh.domain
    edges = []
    allowed = _MISSED * float(np.abs(numbers).max())
    # Side after side: cells beside it, by which corner; which triangle; the axis along it.
    for by, triangle, axis in ((1, 0, 0), (2, 1, 1), (3, 2, 0), (0, 3, 1)):
        last = corners[:, by].max() if by > 1 else corners[:, by].min()
        cells = np.flatnonzero(corners[:, by] == last)
        cells = cells[np.argsort(corners[cells, axis])]
        beside = element.ordinates(numbers[cells])[:, triangle][:, _along_side(element.degree)]
        # Triangles N and W run against their axes.
        beside = beside[:, ::-1] if triangle > 1 else beside
        start, stop = boxes[cells, axis], boxes[cells, axis + 2]
        if element.degree > 2:
            start, beside = _as_quadratics(start, stop, beside, allowed)
        side = np.column_stack([start, beside[:, 0], beside[:, 1]])
        length = domain[axis + 2] - domain[axis]
        edges.append(np.vstack([side, [length, beside[-1, 2], 0.0]]))
    counts = np.array([len(side) for side in edges])
    starts = np.concatenate([[0], np.cumsum(counts)])
    drops = np.zeros((4, 2 << math.ceil(math.log2(counts.max()))))
    border = Border(starts, np.ascontiguousarray(np.concatenate(edges)), drops)
    fill_drops(border)
    return border


def _along_side(degree: int) -> list[int]:
    """The ordinates of a triangle along its side from its first corner to its second."""
    return [k for k, (_, _, c) in enumerate(indices(degree)) if c == 0]


def _as_quadratics(
    start: Floats, stop: Floats, ordinates: Floats, allowed: float
) -> tuple[Floats, Floats]:
    """Edges of a higher degree in halves, until quadratics miss no more than is allowed.

    A quadratic has an edge's ends, and its value halfway. Answers where edges start, and the
    quadratics' ordinates.
    """
    found = []
    halvings = 0
    while len(start):
        rows, middle = [ordinates], ordinates
        while middle.shape[1] > 1:  # de Casteljau's scheme
            middle = 0.5 * (middle[:, :-1] + middle[:, 1:])
            rows.append(middle)
        first, last = ordinates[:, 0], ordinates[:, -1]
        quadratic = np.stack([first, 2.0 * middle[:, 0] - 0.5 * (first + last), last], axis=1)
        raised = quadratic
        while raised.shape[1] < ordinates.shape[1]:
            share = np.arange(1, raised.shape[1]) / raised.shape[1]
            inner = share * raised[:, :-1] + (1.0 - share) * raised[:, 1:]
            raised = np.column_stack([first, inner, last])
        done = np.abs(raised - ordinates).max(axis=1) <= allowed
        done |= halvings == _HALVINGS
        halvings += 1
        found.append((start[done], quadratic[done]))
        go = ~done
        low = np.stack([row[go, 0] for row in rows], axis=1)
        high = np.stack([row[go, -1] for row in reversed(rows)], axis=1)
        between = 0.5 * (start[go] + stop[go])
        start, stop = np.append(start[go], between), np.append(between, stop[go])
        ordinates = np.concatenate([low, high])
    starts, quadratics = (np.concatenate(values) for values in zip(*found, strict=True))
    order = np.argsort(starts)
    return starts[order], quadratics[order]


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
