"""Where a level crosses the edges of the mesh, each segment of an edge asked once.

A side of a coarse cell on which vertices of finer cells hang is several segments. Two cells that
share a segment read the same crossings, so whatever is built from them closes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.meshes import Mesh
from splinesdf.spaces.quadratic import TRIANGLES, center_ordinates

# Values within this share of the largest ordinate of the level count as reaching it when cells
# are chosen. It must cover the rounding by which two cells disagree about their common side;
# larger only looks at some cells for nothing.
_SLACK = 1e-13


class EdgeCrossings(NamedTuple):
    """EdgeCrossings, and what each triangle sees of them.

    The last three are sorted by triangle and counterclockwise along its boundary.
    """

    cells: Ints  # (n,) cells that the level may pass
    position: Floats  # (c, 2) from the domain's lower left corner
    triangle: Ints  # (e,) 4 * (row of cells) + number of the triangle in the cell
    crossing: Ints  # (e,) which crossing
    leaving: Bools  # (e,) the way round leaves the side below the level there


class _Segments(NamedTuple):
    """Parts of sides of cells, each run counterclockwise around its cell."""

    row: Ints  # (s,) row of cells
    side: Ints  # (s,) which side, 0 to 3
    ends: Ints  # (s, 2, 2) first and last point on the lattice
    part: Floats  # (s, 2) parameters of these points along the side


def find_edge_crossings(mesh: Mesh, ordinates: Floats, level: float) -> EdgeCrossings:
    """All crossings of ``s = level`` with sides and half-diagonals of the cells.

    A value equal to the level counts as above it.
    """
    slack = _SLACK * (float(np.max(np.abs(ordinates))) + abs(level))
    low, high = ordinates.min(axis=1), ordinates.max(axis=1)
    cells = np.flatnonzero((low < level + slack) & (high > level - slack))
    values = ordinates[cells] - level
    keys, first = np.unique(_keys(mesh.corners.reshape(-1, 2, 2)), return_index=True)
    vertex_value = ordinates[:, :4].ravel()[first] - level
    vertex_at = _corner_points(mesh.local_boxes).reshape(-1, 2)[first]

    segments = _split_sides(_corner_lattice(mesh.corners[cells]), keys)
    ends = np.searchsorted(keys, _pack(segments.ends))
    shared, which, forward = _shared(ends, segments.part)
    side_values = _side_ordinates(values, segments)
    side_values[~forward] = side_values[~forward, ::-1]
    ends[~forward] = ends[~forward, ::-1]

    beside, center = center_ordinates(values)
    diagonals = np.stack([values[:, :4], beside, np.repeat(center[:, None], 4, axis=1)], axis=-1)
    corner = np.searchsorted(keys, _pack(_corner_lattice(mesh.corners[cells])))
    boxes = mesh.local_boxes[cells]
    middle = np.repeat(0.5 * (boxes[:, :2] + boxes[:, 2:]), 4, axis=0)

    polynomial = np.concatenate([side_values[shared], diagonals.reshape(-1, 3)])
    below = np.concatenate(
        [
            vertex_value[ends[shared]] < 0.0,
            np.stack([vertex_value[corner.ravel()], np.repeat(center, 4)], axis=1) < 0.0,
        ]
    )
    start = np.concatenate([vertex_at[ends[shared, 0]], vertex_at[corner.ravel()]])
    stop = np.concatenate([vertex_at[ends[shared, 1]], middle])
    roots = _roots(polynomial, below)
    found = ~np.isnan(roots)
    number = np.where(found, np.cumsum(found.ravel()).reshape(-1, 2) - 1, -1)
    position = start[:, None] + roots[..., None] * (stop - start)[:, None]

    # Around a triangle: its side, the half-diagonal to the center, the other one back.
    rows = np.arange(len(cells))
    triangle = [4 * segments.row + segments.side]
    order = [segments.part[:, 0]]
    segment = [which]
    ahead = [forward]
    for k, (a, _, b) in enumerate(TRIANGLES):
        for place, v in ((2.0, b), (3.0, a)):
            triangle.append(4 * rows + k)
            order.append(np.full(len(rows), place))
            segment.append(len(shared) + 4 * rows + v)
            ahead.append(np.full(len(rows), place == 2.0))
    return EdgeCrossings(
        cells,
        position[found],
        *_events(
            np.concatenate(triangle),
            np.concatenate(order),
            np.concatenate(segment),
            np.concatenate(ahead),
            number,
            below[:, 0],
        ),
    )


def _events(
    triangle: Ints, order: Floats, segment: Ints, ahead: Bools, number: Ints, below: Bools
) -> tuple[Ints, Ints, Bools]:
    """EdgeCrossings as the triangles see them, in order along their boundaries."""
    slot = np.array([0, 1])
    crossing = number[segment]
    # The first root leaves the side below if the segment starts there, the second the other way
    # round; whoever runs the segment backward sees the opposite, and the second root first.
    leaving = (below[segment][:, None] ^ (slot == 1)) ^ ~ahead[:, None]
    rank = np.where(ahead[:, None], slot, 1 - slot)
    there = crossing >= 0
    triangle = np.repeat(triangle[:, None], 2, axis=1)[there]
    order = np.repeat(order[:, None], 2, axis=1)[there]
    crossing, leaving, rank = crossing[there], leaving[there], rank[there]
    sorted_ = np.lexsort((rank, order, triangle))
    return triangle[sorted_], crossing[sorted_], leaving[sorted_]


def _corner_lattice(corners: Ints) -> Ints:
    """Lattice points of the corners SW, SE, NW, NE: (n, 4) -> (n, 4, 2)."""
    return corners[:, [[0, 1], [2, 1], [0, 3], [2, 3]]]


def _corner_points(boxes: Floats) -> Floats:
    return boxes[:, [[0, 1], [2, 1], [0, 3], [2, 3]]]


def _keys(corners: Ints) -> Ints:
    """One number for each corner of each cell: (n, 2, 2) -> (4 n,)."""
    return _pack(_corner_lattice(corners.reshape(-1, 4))).ravel()


def _pack(lattice: Ints) -> Ints:
    """One sortable number for each lattice point: (..., 2) -> (...,)."""
    result: Ints = lattice[..., 0] * 2**31 + lattice[..., 1]
    return result


def _split_sides(corners: Ints, keys: Ints) -> _Segments:
    """Sides of cells, cut at the vertices (by their keys) that hang on them."""
    count = len(corners)
    run = np.array([(a, b) for a, _, b in TRIANGLES])
    segments = _Segments(
        np.repeat(np.arange(count), 4),
        np.tile(np.arange(4), count),
        corners[:, run].reshape(-1, 2, 2),
        np.tile([0.0, 1.0], (4 * count, 1)),
    )
    done: list[_Segments] = []
    while not done or len(segments.row):
        total = segments.ends.sum(axis=1)
        # A vertex that hangs on a segment is its middle, or hangs on one of the halves then.
        middle = total >> 1
        place = np.minimum(np.searchsorted(keys, _pack(middle)), len(keys) - 1)
        cut = np.all(total % 2 == 0, axis=1) & (keys[place] == _pack(middle))
        done.append(_Segments(*(values[~cut] for values in segments)))
        row, side, ends, part = (values[cut] for values in segments)
        middle, half = middle[cut], part.mean(axis=1)
        segments = _Segments(
            np.concatenate([row, row]),
            np.concatenate([side, side]),
            np.concatenate(
                [np.stack([ends[:, 0], middle], axis=1), np.stack([middle, ends[:, 1]], axis=1)]
            ),
            np.concatenate(
                [np.stack([part[:, 0], half], axis=1), np.stack([half, part[:, 1]], axis=1)]
            ),
        )
    return _Segments(*(np.concatenate(values) for values in zip(*done, strict=True)))


def _shared(ends: Ints, part: Floats) -> tuple[Ints, Ints, Bools]:
    """The segments without repetition, each represented by the finest cell that has it.

    Returns the representatives, for each segment the number of its representative, and whether
    it runs from the smaller vertex to the larger one.
    """
    forward = ends[:, 0] < ends[:, 1]
    key = ends.min(axis=1) * 2**31 + ends.max(axis=1)
    finest_first = np.argsort(part[:, 0] - part[:, 1], kind="stable")
    _, first, inverse = np.unique(key[finest_first], return_index=True, return_inverse=True)
    which = np.empty(len(key), dtype=np.int64)
    which[finest_first] = inverse
    return finest_first[first], which, forward


def _side_ordinates(values: Floats, segments: _Segments) -> Floats:
    """The three ordinates of the spline along each segment: its polar form at the ends."""
    run = np.array(TRIANGLES)[segments.side]
    p, q, r = np.take_along_axis(values[segments.row], run, axis=1).T

    def polar(u: Floats, v: Floats) -> Floats:
        mixed = u * (1.0 - v) + v * (1.0 - u)
        return np.asarray(p * (1.0 - u) * (1.0 - v) + q * mixed + r * u * v)

    u, v = segments.part.T
    return np.stack([polar(u, u), polar(u, v), polar(v, v)], axis=1)


def _roots(polynomial: Floats, below: Bools) -> Floats:
    """Roots in [0, 1] of quadratics in Bernstein form, NaN where there is none: (n, 3) -> (n, 2).

    How many follows from which ends are below zero, given beside the polynomials, because
    neighbors agree on that and not on rounding: one if they differ, else none or two.
    """
    # So that the first end is above.
    p, q, r = np.where(below[:, :1], -polynomial, polynomial).T
    differ = below[:, 0] != below[:, 1]
    p = np.maximum(p, 0.0)
    r = np.where(differ, np.minimum(r, 0.0), np.maximum(r, 0.0))
    root = np.sqrt(np.maximum(q * q - p * r, 0.0))
    result = np.full((len(p), 2), np.nan)
    with np.errstate(invalid="ignore", divide="ignore"):
        # t = τ / (1 + τ) with p + 2 q τ + r τ² = 0, in the form that does not cancel.
        up = q > 0.0
        single = np.where(up, (q + root) / (q + root - r), p / (p + root - q))
        flat = (p == 0.0) & (root - q == 0.0) & ~up
        result[:, 0] = np.where(differ, np.where(flat, 0.0, single), np.nan)
        dips = ~differ & (q < 0.0) & (q * q > p * r)
        result[dips, 0] = (p / (p + root - q))[dips]
        result[dips, 1] = ((root - q) / (r + root - q))[dips]
    return result
