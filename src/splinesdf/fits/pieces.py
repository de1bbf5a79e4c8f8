"""A spline's cells as triangles with quadratics, which is what the certificate looks at.

Of a quadratic element the four triangles of a cell are that. A polynomial of higher degree is
replaced, on triangles halved until it matters little, by the quadratic through its values at the
corners and in the middles of the sides; what that misses is bounded by the Bernstein-Bézier
ordinates of the difference, and all that is proved allows for it. Triangles that cannot meet a band
are left out on the way.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.spaces.element import Element, indices, reparametrized

# From the order AA AB AC BB BC CC of an element to AA BB CC AB BC CA of the kernels.
_ORDER = [0, 3, 5, 1, 4, 2]
# How often a cell's triangles are quartered at most until quadratics miss little: 1024 triangles a
# cell. In bands only those that can meet one are: along a level they double where others quadruple.
_QUARTERINGS, _QUARTERINGS_IN_BANDS = 4, 9
# Triangles of all cells together are not quartered beyond that: 120 MB. More: memory; fewer:
# quadratics miss more of the spline, and bounds are that much wider.
_MOST = 400_000

# Whether parts count, from the cells that they are of, their corners (n, 6), and the least and
# the most of the spline on them.
Counts = Callable[[Ints, Floats, Floats, Floats], Bools]


class Pieces(NamedTuple):
    """Triangles with quadratics, those of a box after one another, as many in each."""

    halves: Ints  # (k, 2) which eighth of a cell, 8 cell + number, each half of a triangle is in
    triangles: Floats  # (k, 12) corners A B C, coefficients AA BB CC AB BC CA
    boxes: Floats  # (b, 4) around k / b triangles each
    missed: Floats  # (cells,) the largest difference between quadratics and spline


class _Parts(NamedTuple):
    """Triangles on which the spline is a polynomial of its degree."""

    cell: Ints  # (n,)
    eighth: Ints  # (n,)
    corners: Floats  # (n, 6)
    ordinates: Floats  # (n, k)

    def take(self, rows: Bools) -> _Parts:
        """Some of them."""
        return _Parts(self.cell[rows], self.eighth[rows], self.corners[rows], self.ordinates[rows])


def pieces(
    element: Element, boxes: Floats, numbers: Floats, allowed: Floats, counts: Counts | None = None
) -> Pieces:
    """The pieces of cells, of an element of a higher degree only those that count.

    Parameters
    ----------
    element : Element
    boxes, numbers : ndarray, shapes (n, 4), (n, element.numbers)
    allowed : ndarray, shape (n,)
        What quadratics may miss of the spline, where so many triangles can be had.
    counts : callable, optional
    """
    ordinates, corners = element.ordinates(numbers), _corners(boxes)
    count = len(boxes)
    if element.degree == 2:
        triangles = np.concatenate([corners, ordinates[..., _ORDER]], axis=2).reshape(-1, 12)
        return Pieces(np.arange(8 * count).reshape(-1, 2), triangles, boxes, np.zeros(count))
    rest = _Parts(
        np.repeat(np.arange(count), 4),
        2 * np.arange(4 * count),
        corners.reshape(-1, 6),
        ordinates.reshape(4 * count, ordinates.shape[2]),
    )
    to_quadratic, to_missed = _quadratics(element.degree)
    most = _QUARTERINGS if counts is None else _QUARTERINGS_IN_BANDS
    missed = np.zeros(count)
    found = [(np.empty(0, dtype=np.int64), np.empty((0, 12)))]
    for number in range(1, most + 1):  # at least once: a part lies in one eighth
        rest = _quartered(element.degree, rest, first=number == 1)
        if counts is not None:
            low, high = rest.ordinates.min(axis=1), rest.ordinates.max(axis=1)
            rest = rest.take(counts(rest.cell, rest.corners, low, high))
        lost = np.abs(np.einsum("qk,nk->nq", to_missed, rest.ordinates)).max(axis=1, initial=0.0)
        done = lost <= allowed[rest.cell]
        if number == most or 4 * len(rest.cell) > _MOST:
            done[:] = True
        np.maximum.at(missed, rest.cell[done], lost[done])
        here = rest.take(done)
        quadratics = np.einsum("qk,nk->nq", to_quadratic, here.ordinates)
        triangles = np.concatenate([here.corners, quadratics], axis=1)
        found.append((here.eighth, triangles))
        rest = rest.take(~done)
        if len(rest.cell) == 0:
            break
    eighth, triangles = (np.concatenate(values) for values in zip(*found, strict=True))
    at = triangles[:, :6].reshape(-1, 3, 2)
    around = np.concatenate([at.min(axis=1), at.max(axis=1)], axis=1)
    return Pieces(np.stack([eighth, eighth], axis=1), triangles, around, missed)


def _quartered(degree: int, parts: _Parts, *, first: bool) -> _Parts:
    """The four quarters of each of n triangles; at first the eighths that they are in are found."""
    shares, moved = _quarters(degree)
    corners = np.einsum("pck,nkx->npcx", shares, parts.corners.reshape(-1, 3, 2))
    ordinates = np.einsum("pdk,nk->npd", moved, parts.ordinates)
    # The first half of the quarters is on A's side of a triangle, see `kernels.enclosure`.
    half = np.array([0, 0, 1, 1]) if first else np.zeros(4, dtype=np.int64)
    return _Parts(
        np.repeat(parts.cell, 4),
        (parts.eighth[:, None] + half).reshape(-1),
        corners.reshape(-1, 6),
        ordinates.reshape(-1, ordinates.shape[2]),
    )


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
def _quarters(degree: int) -> tuple[Floats, Floats]:
    """The halves of both halves of a triangle, by barycentric coordinates (4, 3, 3).

    And the matrices from the triangle's ordinates to theirs, (4, k, k).
    """
    parts = [np.eye(3)]
    for _ in range(2):
        halved = []
        for a, b, c in parts:
            middle = 0.5 * (a + b)
            halved += [np.array([c, a, middle]), np.array([b, c, middle])]
        parts = halved
    return np.stack(parts), np.stack([reparametrized(degree, part) for part in parts])


@cache
def _quadratics(degree: int) -> tuple[Floats, Floats]:
    """Matrices from a triangle's ordinates to its quadratic, (6, k), and what that misses, (k, k).

    What it misses are ordinates of the degree.
    """
    every = indices(degree)
    values = np.zeros((6, len(every)))
    for row, corners in zip(values, _NODES, strict=True):
        row[:] = reparametrized(degree, np.tile(corners, (3, 1)))[0]
    a, b, c, ab, bc, ca = values
    quadratic = np.stack(
        [a, b, c, 2 * ab - (a + b) / 2, 2 * bc - (b + c) / 2, 2 * ca - (c + a) / 2]
    )
    return quadratic, np.eye(len(every)) - _elevation(degree) @ quadratic


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
