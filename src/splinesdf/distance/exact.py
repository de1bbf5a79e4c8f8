"""Exact signed distance and closest point of a `Shape`: the ground of every number here.

points ─ blocks ─→ cells of a quadtree ─→ kernels.nearest (closest point on the boundary)
                                      └─→ kernels.winding (side, by all that was drawn)
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.arclets.culling import candidates_of_cells
from splinesdf.arclets.points import derivatives_at, points_at
from splinesdf.arclets.tables import NOTHING, Arclets, Cells, Feet, Searched
from splinesdf.arclets.thresholds import CORNER
from splinesdf.ground.arrays import Floats, Ints, as_points, positive
from splinesdf.ground.blocks import in_blocks, processors
from splinesdf.ground.brief import brief, counted
from splinesdf.meshes.lattice import DistanceGrid, Nodes, grid_nodes
from splinesdf.meshes.mesh import Box, check_domain
from splinesdf.shapes.shape import Shape, check_shape

# Closer to the boundary than this share of the size, the vector from the closest point is mostly
# rounding. Larger: good directions are withheld; smaller: noise is given as a direction.
_NO_DIRECTION = 1e-12
# Points a thread works on at a time. More: memory, 100 bytes each, and its caches overflow; fewer:
# neighbors are farther apart and have less in common. Below the second, threads do not pay.
_BLOCK = 131_072
_SMALL_BLOCK = 4096
# Points a finest cell should have. More: what they have in common is less; fewer: finding that
# out, about half a microsecond a cell, is shared by fewer.
_IN_CELL = 64
# 4^8 cells are enough for any block of points, and what is kept of each stays small beside it.
_MOST_LEVELS = 8
# Beyond this many sizes of the shape a point is drawn nearer, along the ray to it: what is closest
# stays the same, and squares of squares of lengths do not overflow.
_FAR = 1e20
# A foot this near to an arclet's end (in its parameter) is at the joint, to rounding.
_AT_END = 1e-12
# Nodes along each side of the tiles in which a grid is worked on: 130,000 points.
_TILE = 362


class Projection(NamedTuple):
    """Closest points of a shape's boundary, for points of shape (...,).

    Attributes
    ----------
    distance : ndarray, shape (...,)
        Signed: negative inside.
    point : ndarray, shape (..., 2)
        The closest point of the boundary; on the medial axis one of several.
    piece : ndarray of int, shape (...,)
        The shape's piece that it lies on, for `Shape.piece`.
    parameter : ndarray, shape (...,)
        Its parameter there, in [0, 1].
    curvature : ndarray, shape (...,)
        Of the boundary at that point, positive where the inside is convex: a disk of radius r has
        1 / r. Infinite in a corner, with the sign of the turn; where two smooth pieces meet,
        that of one of them. At the distance u, the level set's is curvature / (1 + curvature u).
        Exact to rounding on lines and Bézier pieces; good to about 1e-9 of the inverse of the
        size on arcs and formulas, which are compiled to pieces.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> found = ss.project(square, [[5.0, 1.0], [5.0, 5.0]])
    >>> found.point.tolist(), found.curvature.tolist()
    ([[4.0, 1.0], [4.0, 4.0]], [0.0, inf])
    """

    distance: Floats
    point: Floats
    piece: Ints
    parameter: Floats
    curvature: Floats

    def __repr__(self) -> str:
        return brief("Projection", "", counted(int(np.size(self.distance)), "point"))


def signed_distance(
    shape: Shape,
    points: ArrayLike,
    y: ArrayLike | None = None,
    *,
    max_distance: float | None = None,
) -> Floats:
    """Distance to the boundary of the filled region, negative inside.

    Parameters
    ----------
    shape : Shape
    points : array_like, shape (..., 2)
    y : array_like, optional
        With it ``points`` are x alone, and both broadcast to shape (...).
    max_distance : float, optional
        Look no farther: what is beyond gets ``-max_distance`` or ``max_distance``. Quicker, the
        smaller it is.

    Returns
    -------
    ndarray, shape (...,)
        In the unit of ``points``: the global minimum over the boundary to rounding, about 1e-15
        of the larger of distance and size. Points that are not finite give NaN. On the medial
        axis the gradient does not exist; the distance does.

    Raises
    ------
    InputError
        If the shape fills nothing, or an argument cannot be used.

    References
    ----------
    [Wang2014] Definition 2; negative inside, unlike its introduction.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> ss.signed_distance(square, [[1.0, 2.0], [4.0, 1.0], [7.0, 8.0]]).tolist()
    [-1.0, 0.0, 5.0]
    >>> ss.signed_distance(square, [[7.0, 8.0]], max_distance=2.0).tolist()
    [2.0]
    >>> ss.signed_distance(square, [1.0, 4.0, 7.0], [[1.0], [2.0]]).tolist()
    [[-1.0, 0.0, 3.0], [-1.0, 0.0, 3.0]]
    """
    array = as_points(points, y)
    flat = array.reshape(-1, 2)
    farthest = _farthest(max_distance)
    result = np.empty(len(flat))
    boundary = check_shape(shape).boundary

    def work(part: slice) -> None:
        feet, order = _feet(shape, boundary, flat[part], farthest=farthest)
        result[part][order] = feet.distance

    in_blocks(len(flat), work, size=_block_size(len(flat)))
    return result.reshape(array.shape[:-1])


def signed_distance_grid(
    shape: Shape,
    nx: Nodes,
    ny: int | None = None,
    *,
    domain: Box | None = None,
    max_distance: float | None = None,
) -> DistanceGrid:
    """Signed distances at the nodes of a grid, its border included.

    Parameters
    ----------
    shape : Shape
    nx, ny : int
        Nodes each way, at least 2: two numbers, a pair of them, or one for both.
    domain : (xmin, ymin, xmax, ymax), optional
        The shape's box grown by a tenth of its size unless given.
    max_distance : float, optional
        As in `signed_distance`.

    Returns
    -------
    DistanceGrid
        Its distances are those of `signed_distance` at these points, found quicker.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> grid = ss.signed_distance_grid(square, 3, 2, domain=(2, 2, 8, 3))
    >>> grid.x.tolist(), grid.y.tolist()
    ([2.0, 5.0, 8.0], [2.0, 3.0])
    >>> grid.distance.tolist()
    [[-2.0, 1.0, 4.0], [-1.0, 1.0, 4.0]]
    """
    box = check_shape(shape).default_domain() if domain is None else check_domain(domain)
    x, y = grid_nodes(nx, ny, box)
    farthest, columns, rows = _farthest(max_distance), len(x), len(y)
    distance = np.empty((rows, columns))
    boundary = check_shape(shape).boundary
    across = math.ceil(columns / _TILE)

    def work(tiles: slice) -> None:
        row, column = (_TILE * k for k in divmod(tiles.start, across))
        part = np.s_[row : row + _TILE, column : column + _TILE]
        nodes = np.stack(np.meshgrid(x[part[1]], y[part[0]]), axis=-1)
        feet, order = _feet(shape, boundary, nodes.reshape(-1, 2), farthest=farthest)
        values = np.empty(len(order))
        values[order] = feet.distance
        distance[part] = values.reshape(nodes.shape[:2])

    in_blocks(across * math.ceil(rows / _TILE), work, size=1)
    return DistanceGrid(x, y, distance)


def closest_point(shape: Shape, points: ArrayLike) -> Floats:
    """The boundary point nearest to each point; on the medial axis one of several.

    Parameters
    ----------
    shape : Shape
    points : array_like, shape (..., 2)

    Returns
    -------
    ndarray, shape (..., 2)
        NaN where the point is not finite.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> ss.closest_point(square, [5.0, 1.0]).tolist()
    [4.0, 1.0]
    """
    return project(shape, points).point


def project(shape: Shape, points: ArrayLike) -> Projection:
    """Closest points on the boundary, and all that is known of them.

    Parameters
    ----------
    shape : Shape
    points : array_like, shape (..., 2)

    Returns
    -------
    Projection
        For points that are not finite: NaN, and piece -1.

    Examples
    --------
    >>> import splinesdf as ss
    >>> disk = ss.Shape.from_formula("2*cos(t)", "2*sin(t)")
    >>> found = ss.project(disk, [3.0, 0.0])
    >>> float(found.distance.round(9)), float(found.curvature.round(6))
    (1.0, 0.5)
    """
    array = as_points(points)
    flat = array.reshape(-1, 2)
    boundary = check_shape(shape).boundary
    turn = shape.corners
    count = len(flat)
    found = Projection(
        distance=np.empty(count),
        point=np.empty((count, 2)),
        piece=np.empty(count, dtype=np.int64),
        parameter=np.empty(count),
        curvature=np.empty(count),
    )

    def work(part: slice) -> None:
        feet, order = _feet(shape, boundary, flat[part])
        arclet, at = feet.arclet, feet.at
        found.distance[part][order] = feet.distance
        found.point[part][order] = points_at(boundary, arclet, at) + boundary.origin
        found.piece[part][order] = np.where(arclet >= 0, boundary.piece[arclet], -1)
        first, last = boundary.interval[arclet].T
        found.parameter[part][order] = first + at * (last - first)
        found.curvature[part][order] = _curvature(boundary, turn, arclet, at)

    in_blocks(count, work, size=_block_size(count))
    grid = array.shape[:-1]
    return Projection(
        found.distance.reshape(grid),
        found.point.reshape(array.shape),
        found.piece.reshape(grid),
        found.parameter.reshape(grid),
        found.curvature.reshape(grid),
    )


def distance_and_gradient(shape: Shape, points: ArrayLike) -> tuple[Floats, Floats]:
    """Signed distance and its gradient, the unit vector away from the inside.

    Parameters
    ----------
    shape : Shape
    points : array_like, shape (..., 2)

    Returns
    -------
    distance : ndarray, shape (...,)
    gradient : ndarray, shape (..., 2)
        Good to about 1e-16 × size / distance; NaN within 1e-12 × size of the boundary, where no
        digit is left. On the medial axis one of several.
    """
    array = as_points(points)
    found = project(shape, array)
    lost = np.abs(found.distance) <= _NO_DIRECTION * shape.size
    gradient = (array - found.point) / np.where(lost, np.nan, found.distance)[..., None]
    return found.distance, gradient


def _farthest(max_distance: float | None) -> float:
    return np.inf if max_distance is None else positive(max_distance, "max_distance")


def _block_size(count: int) -> int:
    return min(_BLOCK, max(_SMALL_BLOCK, math.ceil(count / processors())))


def _feet(
    shape: Shape, boundary: Arclets, points: Floats, *, farthest: float = np.inf
) -> tuple[Feet, Ints]:
    """Closest points of a block, with signed distances, and the order in which they come."""
    from splinesdf.arclets.kernels.nearest import nearest
    from splinesdf.arclets.kernels.nearest_convex import (
        nearest_of_few,  # Numba loads only when it is used
    )
    from splinesdf.arclets.kernels.winding import fill_inside

    outline = shape.arclets
    count = len(points)
    local = points - boundary.origin
    largest = float(np.abs(boundary.boxes[0]).max())
    reach = _FAR * largest
    far = np.flatnonzero(np.abs(local).max(axis=1, initial=0.0) > reach)
    far = far[np.isfinite(points[far]).all(axis=1)]
    beyond = local[far]
    local[far] *= reach / np.abs(beyond).max(axis=1, keepdims=True, initial=0.0)
    cells, order = sorted_into_cells(local)
    feet = Feet(
        distance=np.full(count, np.nan),
        arclet=np.full(count, -1),
        at=np.full(count, np.nan),
        farthest=farthest,
    )
    candidates = candidates_of_cells(boundary, cells)
    done = np.zeros(len(cells.starts) - 1, dtype=np.bool_)
    nearest_of_few(boundary.tree, boundary.arcs, cells, candidates, feet, done)
    searched = Searched(boundary.tree, boundary.arcs, largest)
    nearest(searched, cells, candidates, done, NOTHING, feet)
    np.minimum(feet.distance, farthest, out=feet.distance)  # no point is known to be farther off
    inside = np.zeros(count, dtype=np.bool_)
    fill_inside(
        outline.boxes,
        outline.range,
        outline.chain,
        outline.arcs,
        cells.points[: cells.starts[-1]],
        feet.distance,
        0 if shape.fill == "evenodd" else 1,
        inside,
    )
    np.negative(feet.distance, out=feet.distance, where=inside)
    if len(far):
        place = np.argsort(order)[far]
        feet.distance[place] = np.hypot(
            *(beyond - points_at(boundary, feet.arclet[place], feet.at[place])).T
        )
    return feet, order


def sorted_into_cells(points: Floats) -> tuple[Cells, Ints]:
    """Points sorted into the cells of a quadtree over their box, and the order that sorts them."""
    from splinesdf.arclets.kernels.bins import finite_box, sort_into_cells

    box = np.zeros(4)
    finite_box(points, box)
    sides = np.maximum(box[2:] - box[:2], 0.0) if len(points) else np.zeros(2)
    side = float(sides.max())
    count = len(points)
    levels = 0
    if side > 0.0:
        # As many as if the points filled the square: they may lie along a line or in a strip.
        share = max(float(sides.min()) / side, 2.0**-_MOST_LEVELS)
        while levels < _MOST_LEVELS and 4**levels * share * _IN_CELL * 2 < count:
            levels += 1
    # Larger by a little, so that the last points are inside.
    root = np.array([box[0], box[1], *np.full(2, side * (1.0 + 1e-9) or 1.0)])
    starts = np.empty(4**levels + 2, dtype=np.int64)
    order = np.empty(count, dtype=np.int64)
    ordered = np.empty((count, 2))
    sort_into_cells(points, root, levels, starts, order, ordered)
    return Cells(root, levels, starts, ordered), order


def _curvature(boundary: Arclets, turn: Floats, arclet: Ints, at: Floats) -> Floats:
    """Curvature of arclets at parameters (n,), infinite where the curve has a corner.

    ``turn`` says by what angle it turns at the start and end of each arclet, (n_arclets, 2).
    """
    first, second = derivatives_at(boundary, arclet, at)
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        result = cross / np.hypot(first[:, 0], first[:, 1]) ** 3
    for end, near_end in enumerate((at <= _AT_END, at >= 1.0 - _AT_END)):
        angle = np.where(near_end, turn[arclet, end], 0.0)
        result = np.where(np.abs(angle) > CORNER, np.copysign(np.inf, angle), result)
    return np.where(arclet >= 0, result, np.nan)
