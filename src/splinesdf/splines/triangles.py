"""`Triangles`: a spline as a conforming mesh of Lagrange triangles, for other software.

Each of a cell's four triangles is one polynomial, here a quadratic (`lagrange` has the others);
where vertices of finer cells hang on its side, it is cut into a fan from the cell's center to them.
A part of a polynomial is the same one, so nothing is approximated:

    V ─ e ─ V ─ e ─ V        V  vertices, each once however many cells meet there
      s     s     s          e  edge middles, each once for both cells
        s   s   s            C  the center
          s s s              s  spoke middles, halfway from the center to a vertex
            C
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.ground.brief import brief, counted
from splinesdf.meshes import Mesh
from splinesdf.meshes.mesh import SQUARABLE
from splinesdf.spaces.element import Element
from splinesdf.spaces.space import space_on
from splinesdf.splines.lagrange import Fans, lagrange_nodes

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF

# Of the largest ordinate: cells may disagree about their common side by so much. Less: rounding
# reaches it; more: what is no continuous function, which no conforming mesh can hold, passes.
_APART = 1e-10
# Corners of a cell counterclockwise, as columns of its box or of its corners on the lattice.
_AROUND_X, _AROUND_Y = (0, 2, 2, 0), (1, 1, 3, 3)
# Sides S E N W: whether they run along x, and whether toward larger numbers.
_ALONG_X = np.array([True, False, True, False])
_FORWARD = np.array([1, 1, -1, -1])


@dataclass(frozen=True, eq=False)
class Triangles:
    """A conforming mesh of Lagrange triangles, and a function's values at its nodes.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Nodes, each once: first all corners of triangles, then those on edges, then those within.
    triangles : ndarray, shape (m, 6), of cubics (m, 10), of quartics (m, 15)
        Nodes of each triangle: its corners p, q, r, counterclockwise as x turns into y; then the
        middles of pq, qr and rp, or the nodes that divide each of them evenly, from its first
        corner; then those within. It is VTK's order of a quadratic or a Lagrange triangle.
    values : ndarray, shape (n,)
        At the nodes.

    Examples
    --------
    >>> import splinesdf as ss
    >>> mesh = ss.fit(ss.example("gamma1"), tolerance=0.05).spline.triangles()
    >>> mesh.triangles.shape[1], len(mesh.points) == len(mesh.values)
    (6, True)
    """

    points: Floats
    triangles: Ints
    values: Floats

    def __repr__(self) -> str:
        triangles, nodes = (
            counted(len(self.triangles), "triangle"),
            counted(len(self.points), "node"),
        )
        return brief("Triangles", "", triangles, nodes)

    @property
    def degree(self) -> int:
        """Of the polynomials: 2, 3 or 4."""
        return {6: 2, 10: 3, 15: 4}[self.triangles.shape[1]]


class _Vertices(NamedTuple):
    """The corners of all cells, each once, in columns from left to right, upward in each."""

    number: Ints  # (cells, 4) of a cell's corners, counterclockwise
    lattice: Ints  # (n, 2)
    points: Floats  # (n, 2)
    by_rows: Ints  # (n,) the vertices in rows from the bottom up, to the right in each


class _Pieces(NamedTuple):
    """Sides of cells from vertex to vertex, counterclockwise around each cell, cell after cell."""

    side: Ints  # (p,) 4 * cell + side
    start: Ints  # (p,) the vertex where it starts
    following: Ints  # (p,) the piece that starts where this one ends
    part: Floats  # (p, 2) where it starts and ends along the side, from 0 to 1


def triangles(spline: SplineSDF) -> Triangles:
    """The spline as a conforming mesh of Lagrange triangles of its degree, exact to rounding.

    Four triangles a cell, more where cells of a quadtree have smaller neighbors: there a
    triangle is a fan from the cell's center to their corners. No node hangs on an edge.

    Raises
    ------
    InputError
        If the spline is not finite, or not continuous (fits are).

    Examples
    --------
    >>> import splinesdf as ss
    >>> ss.interpolate(ss.example("gamma1"), (4, 4)).spline.triangles()
    <Triangles: 64 triangles, 145 nodes>
    """
    return _lagrange_triangles(spline.mesh, spline.element, spline.ordinates)


def _lagrange_triangles(mesh: Mesh, element: Element, numbers: Floats) -> Triangles:
    """The mesh of a spline.

    Raises
    ------
    InputError
        If the spline is not finite or beyond 1e100, or not continuous.
    """
    space_on(mesh, element)  # refuses what is no mesh
    if len(numbers) != mesh.cell_count:
        raise InputError(f"expected ordinates of {mesh.cell_count} cells, got of {len(numbers)}")
    if not np.max(np.abs(numbers)) <= SQUARABLE:  # NaN must fail
        raise InputError(f"expected finite ordinates up to {SQUARABLE:g}, got others")
    vertices = _vertices(mesh)
    pieces = _pieces(vertices)
    cell, first, last = pieces.side // 4, pieces.start, pieces.start[pieces.following]
    count = len(vertices.points)
    keys = np.minimum(first, last) * count + np.maximum(first, last)
    _, one, edge = np.unique(keys, return_index=True, return_inverse=True)

    low, high = vertices.points[vertices.number[:, 0]], vertices.points[vertices.number[:, 2]]
    centers = low + 0.5 * (high - low)
    if element.degree > 2:
        fans = Fans(
            np.concatenate([vertices.points, centers]),
            np.column_stack([first, last, count + cell]),
            pieces.part,
            pieces.following,
            edge,
        )
        every = element.ordinates(numbers)
        every = every.reshape(-1, every.shape[2])[pieces.side]
        nodes, of_each, values, apart = lagrange_nodes(element.degree, every, fans)
        _check_together(apart, every)
        return Triangles(nodes, of_each, values)
    ordinates = element.ordinates(numbers).reshape(-1, 6)[pieces.side]
    at_start = _on_side(ordinates, pieces.part[:, 0])
    at_middle = _on_side(ordinates, pieces.part.mean(axis=1))
    at_vertex = np.zeros(count)
    at_vertex[first] = at_start
    apart = max(
        float(np.max(np.abs(at_start - at_vertex[first]))),
        float(np.max(np.abs(at_middle - at_middle[one][edge]))),
    )
    _check_together(apart, ordinates)
    xy = vertices.points
    edges = 0.5 * (xy[first[one]] + xy[last[one]])
    spokes = 0.5 * (xy[first] + centers[cell])

    at_center = element.at_centers(numbers)
    center = count + cell
    middle = count + len(centers) + edge
    spoke = count + len(centers) + len(edges) + np.arange(len(first))
    return Triangles(
        np.concatenate([xy, centers, edges, spokes]),
        np.column_stack([first, last, center, middle, spoke[pieces.following], spoke]),
        np.concatenate([at_vertex, at_center, at_middle[one], _on_spoke(ordinates, pieces)]),
    )


def _check_together(apart: float, ordinates: Floats) -> None:
    if apart > _APART * float(np.max(np.abs(ordinates))):
        raise InputError(
            "expected a continuous spline, as fits are, got ordinates by which cells are "
            f"{apart:.3g} apart along a common side"
        )


def _vertices(mesh: Mesh) -> _Vertices:
    corners, boxes = mesh.corners, mesh.boxes
    # Ranks and not the numbers of the lattice, whose products may be beyond 63 bits.
    x, column = np.unique(corners[:, _AROUND_X], return_inverse=True)
    y, row = np.unique(corners[:, _AROUND_Y], return_inverse=True)
    keys = column.reshape(-1) * len(y) + row.reshape(-1)
    keys, first, number = np.unique(keys, return_index=True, return_inverse=True)
    column, row = np.divmod(keys, len(y))
    points = np.stack([boxes[:, _AROUND_X], boxes[:, _AROUND_Y]], axis=-1).reshape(-1, 2)[first]
    # Those of a quadtree are rounded, and may lie outside the domain.
    points[column == len(x) - 1, 0] = mesh.domain[2]
    points[row == len(y) - 1, 1] = mesh.domain[3]
    return _Vertices(
        number.reshape(-1, 4),
        np.column_stack([x[column], y[row]]),
        points,
        np.argsort(row * len(x) + column),
    )


def _pieces(vertices: _Vertices) -> _Pieces:
    """The sides, cut where vertices hang on them."""
    number = vertices.number
    place = np.empty(len(vertices.by_rows), dtype=np.int64)
    place[vertices.by_rows] = np.arange(len(place))
    # Vertices on a side follow one another: in a row along x, in a column along y.
    start = np.where(_ALONG_X, place[number], number)
    stop = np.where(_ALONG_X, place[np.roll(number, -1, axis=1)], np.roll(number, -1, axis=1))
    counts = np.abs(stop - start)
    side = np.repeat(np.arange(counts.size), counts.reshape(-1))
    before = np.cumsum(counts).reshape(-1, 4) - counts
    step = np.arange(len(side)) - before.reshape(-1)[side]
    along_x = _ALONG_X[side % 4]
    at = start.reshape(-1)[side] + _FORWARD[side % 4] * step
    first = at.copy()
    first[along_x] = vertices.by_rows[at[along_x]]

    following = np.arange(1, len(side) + 1)
    last = before[:, 3] + counts[:, 3] - 1
    following[last] = before[:, 0]
    ends = vertices.lattice[np.stack([number, np.roll(number, -1, axis=1)], axis=-1)]
    part = [
        _part(vertices.lattice[which], ends.reshape(-1, 2, 2)[side], along_x)
        for which in (first, first[following])
    ]
    return _Pieces(side, first, following, np.column_stack(part))


def _part(at: Ints, ends: Ints, along_x: Bools) -> Floats:
    """Where lattice points (p, 2) are on the way between ends (p, 2, 2), exactly."""
    here = np.where(along_x, at[:, 0], at[:, 1])
    start, stop = np.where(along_x[:, None], ends[..., 0], ends[..., 1]).T
    return np.asarray((here - start) / (stop - start))


def _on_side(ordinates: Floats, part: Floats) -> Floats:
    """Values along the sides of triangles, from their ordinates AA AB AC BB BC CC."""
    rest = 1.0 - part
    return np.asarray(
        rest * rest * ordinates[:, 0]
        + 2.0 * rest * part * ordinates[:, 1]
        + part * part * ordinates[:, 3]
    )


def _on_spoke(ordinates: Floats, pieces: _Pieces) -> Floats:
    """Values halfway from the start of each piece to the center."""
    part = pieces.part[:, 0]
    between = (1.0 - part) * ordinates[:, 2] + part * ordinates[:, 4]
    return np.asarray(0.25 * (_on_side(ordinates, part) + 2.0 * between + ordinates[:, 5]))
