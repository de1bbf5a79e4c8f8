"""Distances, sides and filled regions by other means: polylines, GEOS, exact fractions.

Nothing here calls the package; of a `Shape` only the control points are read.

    shape ─ polylines ─→ rings ─┬─ winding_number ─────→ side
                                ├─ polyline_distance ──→ distance to every contour
                                └─ filled_boundary ────→ lines ─ polyline_distance ─→ distance
    corners ─ exact_winding_number, exact_filled_boundary: fractions, for polygons
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise

import numpy as np
import shapely

import splinesdf as ss

# A slit along a slanting line, in decimals, is open by rounding: faces thinner than this share of
# the largest coordinate are closed. It is what distances of real drawings are good to here.
SNAP = 1e-13
# Vertices of a line in the tree: short ones have small boxes, long ones make a small tree.
_RUN = 8
# Pairs of a side and a point at a time: 100 MB. Fewer take longer.
_PAIRS = 500_000


def polylines(shape: ss.Shape, deviation: float) -> list[np.ndarray]:
    """Closed polylines, last point as the first, that stay within ``deviation`` of the loops.

    A chord over a parameter step h is within h²/8 of the largest second derivative of its curve;
    that of a Bézier piece is at most d(d - 1) times its largest second difference. Steps are
    powers of two, so that a piece walked backwards has the same vertices, bit for bit.
    """
    pieces = [piece(shape, i) for i in range(shape.piece_count)]
    lines = _piece_polylines(pieces, deviation)
    result = []
    for first, last in zip(shape.loops[:-1], shape.loops[1:], strict=True):
        parts = [line[:-1] for line in lines[first:last]]
        result.append(np.concatenate([*parts, parts[0][:1]]))
    return result


def piece(shape: ss.Shape, index: int) -> np.ndarray:
    return shape.control[shape.starts[index] : shape.starts[index + 1]]


def _piece_polylines(pieces: Sequence[np.ndarray], deviation: float) -> list[np.ndarray]:
    """Each Bézier piece as a polyline with both ends; those of one degree and fineness at once."""
    result = [np.empty((0, 2))] * len(pieces)
    degrees = np.array([len(control) - 1 for control in pieces])
    for degree in np.unique(degrees):
        same = np.flatnonzero(degrees == degree)
        controls = np.stack([pieces[i] for i in same])
        bend = np.zeros(len(same))
        if degree > 1:
            second = np.linalg.norm(np.diff(controls, 2, axis=1), axis=2)
            bend = degree * (degree - 1) * second.max(axis=1)
        steps = np.maximum(1.0, np.sqrt(bend / (8.0 * deviation)))
        halvings = np.ceil(np.log2(steps)).astype(np.int64)
        for number in np.unique(halvings):
            rows = np.flatnonzero(halvings == number)
            t = np.linspace(0.0, 1.0, 2**number + 1)[:, None, None]
            points = np.broadcast_to(controls[rows, None], (len(rows), len(t), degree + 1, 2))
            while points.shape[2] > 1:
                points = (1.0 - t) * points[:, :, :-1] + t * points[:, :, 1:]
            for row, line in zip(rows, points[:, :, 0], strict=True):
                result[same[row]] = line
    return result


def polyline_distance(lines: Iterable[np.ndarray], points: np.ndarray) -> np.ndarray:
    """Unsigned distance to the nearest of some polylines, by GEOS."""
    return _distance_to(_tree(lines), points)


def _tree(lines: Iterable[np.ndarray]) -> shapely.STRtree:
    return shapely.STRtree(np.concatenate([_runs(line) for line in lines]))


def _distance_to(tree: shapely.STRtree, points: np.ndarray) -> np.ndarray:
    where, distance = tree.query_nearest(
        shapely.points(points), all_matches=False, return_distance=True
    )
    result = np.full(len(points), np.nan)
    result[where[0]] = distance
    return result


def _runs(line: np.ndarray) -> np.ndarray:
    """The line in short ones, each of which starts where the one before it ends."""
    first = np.arange(0, len(line) - 1, _RUN)
    last = np.minimum(first + _RUN, len(line) - 1)
    number = np.repeat(np.arange(len(first)), last - first + 1)
    at = np.arange(len(number)) - number  # the last vertex of each run once more
    lines: np.ndarray = shapely.linestrings(line[at], indices=number)
    return lines


def winding_number(rings: Iterable[np.ndarray], points: np.ndarray) -> np.ndarray:
    """How often the closed polylines turn about each point, from crossings of the ray in +x.

    A side counts for points of a half-open strip in y. Right where no side comes within rounding.
    """
    order = np.argsort(points[:, 1], kind="stable")
    x, y = points[order].T
    number = np.zeros(len(points), dtype=np.int64)
    for ring in rings:
        start, end = ring[:-1], ring[1:]
        low = np.searchsorted(y, np.minimum(start[:, 1], end[:, 1]))
        high = np.searchsorted(y, np.maximum(start[:, 1], end[:, 1]))
        count = high - low
        for sides in _portions(count):
            side = np.repeat(sides, count[sides])
            first = np.cumsum(count[sides]) - count[sides]
            at = np.arange(len(side)) - np.repeat(first, count[sides]) + low[side]
            (ax, ay), (bx, by) = start[side].T, end[side].T
            left_of = (bx - ax) * (y[at] - ay) - (x[at] - ax) * (by - ay)
            number += np.bincount(at[(by > ay) & (left_of > 0)], minlength=len(number))
            number -= np.bincount(at[(by < ay) & (left_of < 0)], minlength=len(number))
    result = np.empty_like(number)
    result[order] = number
    return result


def _portions(count: np.ndarray) -> list[np.ndarray]:
    """Sides whose strips hold some points, as many at a time as have so many points in all."""
    some = np.flatnonzero(count)
    total = np.cumsum(count[some])
    cuts = np.searchsorted(total, np.arange(_PAIRS, count.sum(), _PAIRS))
    return np.split(some, cuts)


def is_filled(number: np.ndarray, fill: str) -> np.ndarray:
    return number != 0 if fill == "nonzero" else number % 2 != 0


def filled_boundary(
    rings: Sequence[np.ndarray], fill: str, *, snap: float = 0.0
) -> list[np.ndarray]:
    """The boundary of what closed polylines fill, as polylines; empty if they fill nothing.

    The lines are cut at all crossings and tell apart the faces of the plane; a face is filled
    if the winding number at a point in it is.

    Parameters
    ----------
    snap : float
        Vertices are moved to a grid so fine: faces that are thinner close.
    """
    drawn = shapely.multilinestrings([shapely.linestrings(ring) for ring in rings])
    noded = shapely.unary_union(drawn, grid_size=snap or None)
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    if len(faces) == 0:
        return []
    inner = shapely.get_coordinates(shapely.point_on_surface(faces))
    filled = faces[is_filled(winding_number(rings, inner), fill)]
    boundary = shapely.boundary(shapely.unary_union(filled))
    return [shapely.get_coordinates(line) for line in shapely.get_parts(boundary)]


def signed_polyline_distance(
    rings: Sequence[np.ndarray], fill: str, points: np.ndarray, *, snap: float = 0.0
) -> np.ndarray | None:
    """Signed distance to the boundary of what the polylines fill, None if they fill nothing."""
    boundary = filled_boundary(rings, fill, snap=snap)
    return _signed(rings, fill, _tree(boundary), points) if boundary else None


def _signed(
    rings: Sequence[np.ndarray], fill: str, boundary: shapely.STRtree, points: np.ndarray
) -> np.ndarray:
    inside = is_filled(winding_number(rings, points), fill)
    return np.where(inside, -1.0, 1.0) * _distance_to(boundary, points)


@lru_cache(maxsize=8)
def _drawn(shape: ss.Shape, deviation: float) -> tuple[list[np.ndarray], shapely.STRtree] | None:
    """The polylines of a shape and the boundary of what they fill; None if they fill nothing."""
    rings = polylines(shape, deviation)
    snap = SNAP * float(np.abs(shape.control).max())
    boundary = filled_boundary(rings, shape.fill, snap=snap)
    return (rings, _tree(boundary)) if boundary else None


def sure_polyline_distance(
    shape: ss.Shape, points: np.ndarray, deviation: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Signed distance good to ``deviation``, and where it is sure to be; None if nothing is filled.

    Where contours cross at a small angle, or touch, the filled region's boundary moves by much
    more than the polylines deviate. Those are the places where two finenesses do not agree.
    """
    both = _drawn(shape, deviation), _drawn(shape, deviation / 16.0)
    if both[0] is None or both[1] is None:
        return None
    coarse, fine = (_signed(rings, shape.fill, tree, points) for rings, tree in both)
    return fine, np.abs(np.abs(coarse) - np.abs(fine)) < 2.0 * deviation


def on_lines(shape: ss.Shape, points: np.ndarray, deviation: float) -> np.ndarray:
    """Which points are on what was drawn: of a line to and fro, rounding tells their side."""
    drawn = shapely.multilinestrings(
        [shapely.linestrings(line) for line in polylines(shape, deviation)]
    )
    shapely.prepare(drawn)
    near = SNAP * float(np.abs(shape.control).max())
    return np.asarray(shapely.dwithin(drawn, shapely.points(points), near))


Exact = tuple[Fraction, Fraction]


def exact_winding_number(corners: Iterable[np.ndarray], point: np.ndarray) -> int:
    """Winding number of polygons about a point that is on no side, without rounding.

    Parameters
    ----------
    corners : iterable of ndarray, shape (n, 2)
        The last corner is joined to the first.
    """
    px, py = _exact(point)
    number = 0
    for ring in corners:
        ends = np.roll(ring, -1, axis=0)
        rising = (ends[:, 1] > point[1]).astype(int) - (ring[:, 1] > point[1])
        for i in np.flatnonzero(rising):
            (ax, ay), (bx, by) = _exact(ring[i]), _exact(ends[i])
            left_of = (bx - ax) * (py - ay) - (px - ax) * (by - ay)
            number += int(rising[i]) * int(left_of * int(rising[i]) > 0)
    return number


def exact_filled_boundary(corners: Iterable[np.ndarray], fill: str) -> list[np.ndarray]:
    """What `filled_boundary` gives, for polygons of few sides, without rounding.

    Each side is cut wherever it meets another. A part stays if of its two banks one is filled.
    Only the ends of the parts are rounded.
    """
    sides = [
        (_exact(a), _exact(b))
        for ring in corners
        for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True)
        if (a != b).any()
    ]
    parts = {part for side in sides for part in _cut(side, sides)}
    return [
        np.array([a, b], dtype=np.float64)
        for a, b in parts
        if a < b or (b, a) not in parts
        if len({bool(is_filled(np.int64(n), fill)) for n in _banks(a, b, sides)}) == 2
    ]


def _exact(point: np.ndarray) -> Exact:
    return Fraction(float(point[0])), Fraction(float(point[1]))


def _cross(a: Exact, b: Exact, c: Exact) -> Fraction:
    """Twice the area of the triangle."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _along(a: Exact, b: Exact, c: Exact) -> Fraction:
    """(b - a) · (c - a)."""
    return (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1])


def _cut(side: tuple[Exact, Exact], sides: list[tuple[Exact, Exact]]) -> list[tuple[Exact, Exact]]:
    """The side's parts between the places where it meets others."""
    a, b = side
    whole = _along(a, b, b)
    at = {Fraction(0), Fraction(1)}
    for c, d in sides:
        to_c, to_d = _cross(a, b, c), _cross(a, b, d)
        if to_c == to_d == 0:
            at |= {_along(a, b, end) / whole for end in (c, d)}
        elif to_c * to_d <= 0:
            at.add((_along(a, b, c) * to_d - _along(a, b, d) * to_c) / (whole * (to_d - to_c)))
    inner = sorted(t for t in at if 0 <= t <= 1)
    points = [(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])) for t in inner]
    return list(pairwise(points))


def _banks(a: Exact, b: Exact, sides: list[tuple[Exact, Exact]]) -> tuple[int, int]:
    """Winding numbers left and right of a part that meets no other side in its inside.

    The ray from the part's middle to its left. A side that lies on the part is crossed by a ray
    that starts on the right bank, and not by one that starts on the left bank.
    """
    middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    ahead = (middle[0] + b[0] - a[0], middle[1] + b[1] - a[1])
    left = right = 0
    for c, d in sides:
        # Positions along the part take the place of y, those across it of x.
        s_c, s_d = _along(middle, ahead, c), _along(middle, ahead, d)
        turn = int(s_d <= 0) - int(s_c <= 0)
        if turn == 0:
            continue
        across_c, across_d = _cross(middle, ahead, c), _cross(middle, ahead, d)
        across = (across_c * s_d - across_d * s_c) / (s_d - s_c)
        left += turn * int(across > 0)
        right += turn * int(across >= 0)
    return left, right
