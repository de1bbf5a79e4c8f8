"""A spline's cells as triangles with quadratics, which is what the certificate looks at.

Of a quadratic element the four triangles of a cell are that. A polynomial of higher degree is
replaced, on triangles halved until it matters little, by the quadratic through its values at the
corners and in the middles of the sides; what that misses is bounded by the Bernstein-Bézier
ordinates of the difference, and all that is proved allows for it.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.spaces.element import Element, indices, reparametrized

# From the order AA AB AC BB BC CC of an element to AA BB CC AB BC CA of the kernels.
_ORDER = [0, 3, 5, 1, 4, 2]
# Share of what an error need not be known below that a quadratic may miss of the spline. Smaller:
# four times the triangles for each eighth of it, of degree 3; larger: bounds are that much wider.
_MISSED = 2e-3
# How often a cell's triangles are quartered for that at most: 1024 triangles a cell.
_QUARTERINGS = 4


class Pieces(NamedTuple):
    """Triangles with quadratics, those of a box after one another, as many in each."""

    halves: Ints  # (k, 2) which eighth of a cell, 8 cell + number, each half of a triangle is in
    triangles: Floats  # (k, 12) corners A B C, coefficients AA BB CC AB BC CA
    boxes: Floats  # (b, 4) around k / b triangles each
    missed: Floats  # (cells,) the largest difference between quadratics and spline


def pieces(element: Element, boxes: Floats, numbers: Floats, threshold: float) -> Pieces:
    """The pieces of cells.

    Parameters
    ----------
    element : Element
    boxes, numbers : ndarray, shapes (n, 4), (n, element.numbers)
    threshold : float
        What an error need not be known below.
    """
    ordinates, corners = element.ordinates(numbers), _corners(boxes)
    count = len(boxes)
    if element.degree == 2:
        triangles = np.concatenate([corners, ordinates[..., _ORDER]], axis=2).reshape(-1, 12)
        return Pieces(np.arange(8 * count).reshape(-1, 2), triangles, boxes, np.zeros(count))
    missed = np.zeros(count)
    eighths, found = [], []
    rest = np.arange(count)
    for quarterings in range(1, _QUARTERINGS + 1):  # at least once: a part lies in one eighth
        parts, to_quadratic, to_difference = _subdivision(element.degree, quarterings)
        difference = np.abs(np.einsum("pdk,ntk->ntpd", to_difference, ordinates[rest]))
        missed[rest] = difference.max(axis=(1, 2, 3), initial=0.0)
        done = (missed[rest] <= _MISSED * threshold) | (quarterings == _QUARTERINGS)
        here = rest[done]
        at = np.einsum("pck,ntkx->ntpcx", parts, corners[here].reshape(-1, 4, 3, 2))
        quadratic = np.einsum("pqk,ntk->ntpq", to_quadratic, ordinates[here])
        shape = (len(here), 4, len(parts), 6)
        found.append(np.concatenate([at.reshape(shape), quadratic], axis=3).reshape(-1, 12))
        # The first half of the parts is on A's side of a triangle, see `kernels.enclosure`.
        half = 2 * np.arange(len(parts))[None] // len(parts)
        eighth = 8 * here[:, None, None] + 2 * np.arange(4)[:, None] + half
        eighths.append(eighth.reshape(-1))
        rest = rest[~done]
    triangles, eighth = np.concatenate(found), np.concatenate(eighths)
    at = triangles[:, :6].reshape(-1, 3, 2)
    around = np.concatenate([at.min(axis=1), at.max(axis=1)], axis=1)
    return Pieces(np.stack([eighth, eighth], axis=1), triangles, around, missed)


def _corners(boxes: Floats) -> Floats:
    """The corners of the triangles S E N W of cells, counterclockwise: (n, 4, 6)."""
    x, y = boxes[:, [0, 2, 2, 0]], boxes[:, [1, 1, 3, 3]]
    mx, my = 0.5 * (boxes[:, 0] + boxes[:, 2]), 0.5 * (boxes[:, 1] + boxes[:, 3])
    return np.stack(
        [
            np.column_stack([x[:, a], y[:, a], x[:, b], y[:, b], mx, my])
            for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))
        ],
        axis=1,
    )


@cache
def _subdivision(degree: int, quarterings: int) -> tuple[Floats, Floats, Floats]:
    """Parts of a triangle that is quartered some times, by barycentric coordinates (p, 3, 3).

    And the matrices from the triangle's ordinates to the quadratics on the parts, (p, 6, k), and to
    what these miss, as ordinates of the degree, (p, k, k).
    """
    parts = [np.eye(3)]
    for _ in range(2 * quarterings):
        halved = []
        for a, b, c in parts:
            middle = 0.5 * (a + b)
            halved += [np.array([c, a, middle]), np.array([b, c, middle])]
        parts = halved
    every = indices(degree)
    values = np.zeros((6, len(every)))
    for row, corners in zip(values, _NODES, strict=True):
        row[:] = reparametrized(degree, np.tile(corners, (3, 1)))[0]
    a, b, c, ab, bc, ca = values
    quadratic = np.stack(
        [a, b, c, 2 * ab - (a + b) / 2, 2 * bc - (b + c) / 2, 2 * ca - (c + a) / 2]
    )
    lifted = _elevation(degree)
    moved = np.stack([reparametrized(degree, part) for part in parts])
    return np.stack(parts), quadratic @ moved, moved - lifted @ quadratic @ moved


# Corners A B C and middles of AB BC CA, by barycentric coordinates.
_NODES = np.array(
    [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0.5, 0), (0, 0.5, 0.5), (0.5, 0, 0.5)], dtype=np.float64
)


def _elevation(degree: int) -> Floats:
    """Ordinates of a degree from those AA BB CC AB BC CA of a quadratic: (k, 6)."""
    columns = [indices(2)[k] for k in _ORDER]
    rows = np.eye(6)
    lower = 2
    while lower < degree:
        lower += 1
        raised = np.zeros((len(indices(lower)), 6))
        for row, index in zip(raised, indices(lower), strict=True):
            for v in range(3):
                if index[v]:
                    a, b, c = (n - (v == w) for w, n in enumerate(index))
                    row += index[v] / lower * rows[columns.index((a, b, c))]
        rows, columns = raised, indices(lower)
    return rows
