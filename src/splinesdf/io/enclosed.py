"""The region that curves of a file enclose, against the exact distance: no part lost or twice.

All points of a curve may be at the right distance though another curve is missing, or is there
twice. So points beside the true offset, beside the curves, and all over are asked for their side.

    pieces of the shape ─ march by the distance along normals ─→ what really is there ─┐
    curves ─ polylines ─ a little aside ───────────────────────────────────────────────┼─→ points
    a grid over all ───────────────────────────────────────────────────────────────────┘
    points ─┬─ exact distance - distance ─→ below or above the level
            └─ winding number of the polylines ─→ enclosed or not
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from splinesdf.arclets.points import bezier_points
from splinesdf.arclets.thresholds import FAN
from splinesdf.distance.exact import signed_distance
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.shapes.shape import Shape

# How far off the level points are asked, in tolerances, and how near they may turn out to be. As
# curves are within one tolerance and their polylines within a quarter more, sides are sure there.
_OFF, _NEAR, _CHORD = 2.0, 1.5, 0.25
# Samples of the boundary in all, by length, and of each piece at least. More: a small part of an
# offset that only a short stretch of the boundary makes is found without zooming in; and time.
_SAMPLES, _OF_A_PIECE = 4000, 5
# Stretches of the boundary that come near to having a parallel there are looked at more closely,
# the nearest ones, each round four times: 4^-8 of a sample's share of the boundary is seen.
_SUSPECTS, _ROUNDS = 512, 8
# Directions between the normals of a corner.
_FAN = 9
# Points beside each curve at least, and beside all; the side of the grid.
_OF_A_CURVE, _BESIDE, _GRID = 16, 4000, 64
# Rounding, in units in the last place of the largest coordinate.
_ULPS = 64.0
# First steps of a segment, and the most halvings after: beyond 2^20 an arc is a tolerance wide.
_STEPS, _HALVINGS = 4, 20
# Pairs of a point and a side of a polyline at a time, 50 bytes each.
_PAIRS = 2_000_000


@dataclass(frozen=True)
class Sides:
    """Points asked whether the curves of one distance enclose them, and those that are wrong.

    Attributes
    ----------
    distance : float
    asked : int
    lost : int
        How many of them are nearer than the distance, and not enclosed as they should be.
    spurious : int
        How many are farther, and enclosed.
    turned : int
        How many are enclosed, but by curves that run the wrong way around, where that matters.
    point : (float, float)
        The wrong point farthest from the level, in the shape's coordinates.
    apart : float
        How far it is from the level.
    """

    distance: float
    asked: int
    lost: int
    spurious: int
    turned: int
    point: tuple[float, float]
    apart: float

    @property
    def wrong(self) -> int:
        """How many points are on the wrong side."""
        return self.lost + self.spurious + self.turned


def check_sides(
    shape: Shape, distance: float, curves: Sequence[Floats], tolerance: float, turn: int = 0
) -> Sides:
    """Compare what closed polylines enclose with where the exact distance is less.

    Parameters
    ----------
    curves : sequence of ndarray, shape (n, 2)
        All those of the distance, within a quarter of the tolerance of what they stand for.
    turn : {0, 1, -1}
        1 if x turns into y along curves around what is nearer, -1 if y into x, 0 if either may be.
    """
    largest = max(float(np.abs(shape.control).max()), *map(abs, shape.box)) + abs(distance)
    allowed = tolerance + _ULPS * float(np.spacing(largest))
    points = np.concatenate(
        [
            _beside_the_level(shape, distance, allowed),
            _beside_curves(curves, _OFF * allowed),
            _everywhere(shape, distance, curves),
        ]
    )
    above = signed_distance(shape, points) - distance
    sure = np.abs(above) > _NEAR * allowed
    points, above = points[sure], above[sure]
    number = winding_number(curves, points)
    below = above < 0.0
    around = number % 2 != 0 if turn == 0 else number != 0
    lost, spurious = below & ~around, ~below & around
    turned = below & around & (number != turn) if turn else np.zeros_like(below)
    worst = np.where(lost | spurious | turned, np.abs(above), -1.0)
    at = int(np.argmax(worst)) if len(worst) else -1
    wrong = at >= 0 and worst[at] >= 0.0
    return Sides(
        distance=distance,
        asked=len(points),
        lost=int(np.count_nonzero(lost)),
        spurious=int(np.count_nonzero(spurious)),
        turned=int(np.count_nonzero(turned)),
        point=(float(points[at, 0]), float(points[at, 1])) if wrong else (math.nan, math.nan),
        apart=float(worst[at]) if wrong else 0.0,
    )


def flattened(at: Callable[[Floats], Floats], count: int, tolerance: float) -> Floats:
    """A curve with parameters in [0, count] as a polyline within a quarter of the tolerance."""
    ends = np.linspace(0.0, float(count), _STEPS * count + 1)
    points = at(ends)
    for _ in range(_HALVINGS):
        middles = 0.5 * (ends[:-1] + ends[1:])
        between = at(middles)
        off = between - 0.5 * (points[:-1] + points[1:])
        coarse = np.flatnonzero(np.hypot(off[:, 0], off[:, 1]) > _CHORD * tolerance)
        if len(coarse) == 0:
            break
        ends = np.insert(ends, coarse + 1, middles[coarse])
        points = np.insert(points, coarse + 1, between[coarse], axis=0)
    return points


def winding_number(curves: Sequence[Floats], points: Floats) -> Ints:
    """How often closed polylines turn about each point, x into y: (n, 2) -> (n,).

    Sides that a ray to the right crosses, each a half-open strip in y. Open ones are closed.
    """
    order = np.argsort(points[:, 1], kind="stable")
    x, y = points[order].T
    sorted_number = np.zeros(len(points), dtype=np.int64)
    for curve in curves:
        start = curve if (curve[0] != curve[-1]).any() else curve[:-1]
        end = np.roll(start, -1, axis=0)
        low = np.searchsorted(y, np.minimum(start[:, 1], end[:, 1]))
        high = np.searchsorted(y, np.maximum(start[:, 1], end[:, 1]))
        length = high - low
        bounds = np.concatenate([[0], np.cumsum(length)])
        first = 0
        while first < len(length):
            # At least one side, and as many as make no more pairs than there may be.
            last = int(np.searchsorted(bounds, bounds[first] + _PAIRS, side="right")) - 1
            last = max(last, first + 1)
            some = slice(first, last)
            side = np.repeat(np.arange(first, last), length[some])
            which = np.arange(len(side)) - (bounds[side] - bounds[first]) + low[side]
            way, to = end[side] - start[side], np.stack([x[which], y[which]], -1) - start[side]
            left = way[:, 0] * to[:, 1] - way[:, 1] * to[:, 0]
            up = way[:, 1] > 0.0
            crossed = np.where(up, (left > 0.0).astype(np.int64), -(left < 0.0).astype(np.int64))
            sorted_number += np.bincount(which, crossed, len(points)).astype(np.int64)
            first = last
    number = np.empty_like(sorted_number)
    number[order] = sorted_number
    return number


def _beside_the_level(shape: Shape, distance: float, allowed: float) -> Floats:
    """Points a little off the true level, to both sides: from all of the boundary, by normals."""
    piece, t, step = _samples(shape)
    marched, normals, off = _march(shape, distance, piece, t)
    result = [(marched, normals, off)]
    # Between samples that have no parallel at the level there may be some that have.
    half = len(piece)
    piece, t, step = np.tile(piece, 2), np.tile(t, 2), np.tile(step, 2)
    other = np.repeat([1.0, -1.0], half)
    low = (off <= np.roll(off, 1)) & (off <= np.roll(off, -1)) & (off > 0.5 * allowed)
    spacing = np.hypot(*(marched - np.roll(marched, 1, axis=0)).T)
    near = np.where(low, off / np.maximum(spacing, allowed), np.inf)
    chosen = np.argsort(near)[:_SUSPECTS]
    chosen = chosen[np.isfinite(near[chosen])]
    best, width = t[chosen], step[chosen]
    for _ in range(_ROUNDS if len(chosen) else 0):
        around = np.clip(best[:, None] + width[:, None] * np.linspace(-1.0, 1.0, 9), 0.0, 1.0)
        pieces, sides = np.repeat(piece[chosen], 9), np.repeat(other[chosen], 9)
        found = _march(shape, distance, pieces, around.ravel(), sides)
        result.append(found)
        best = around[np.arange(len(best)), np.argmin(found[2].reshape(-1, 9), axis=1)]
        width = 0.25 * width
    result.append(_fans(shape, distance))
    marched, normals, off = (np.concatenate(parts) for parts in zip(*result, strict=True))
    there = off <= 0.5 * allowed
    aside = _OFF * allowed * normals[there]
    return np.concatenate([marched[there] + aside, marched[there] - aside])


def _samples(shape: Shape) -> tuple[Ints, Floats, Floats]:
    """Pieces and parameters all over the boundary, and the parameters' steps."""
    ways = np.hypot(*np.diff(shape.control, axis=0).T)
    ways[shape.starts[1:-1] - 1] = 0.0  # from one piece to the next
    length = np.add.reduceat(np.append(ways, 0.0), shape.starts[:-1])
    number = _OF_A_PIECE + np.floor(_SAMPLES * length / length.sum()).astype(np.int64)
    piece = np.repeat(np.arange(shape.piece_count), number)
    place = np.arange(len(piece)) - np.repeat(np.cumsum(number) - number, number)
    return piece, (place + 0.5) / number[piece], 1.0 / number[piece]


def _march(
    shape: Shape, distance: float, piece: Ints, t: Floats, sides: Floats | None = None
) -> tuple[Floats, Floats, Floats]:
    """Along normals by the distance: where, the normals, and how far off the level that is.

    To both sides, one after the other, if none are given.
    """
    points, normals = np.empty((len(piece), 2)), np.empty((len(piece), 2))
    degree = np.diff(shape.starts)[piece] - 1
    for d in np.unique(degree).tolist():
        rows = np.flatnonzero(degree == d)
        control = shape.control[shape.starts[piece[rows], None] + np.arange(d + 1)]
        points[rows], ways = bezier_points(control, t[rows])
        normals[rows] = np.stack([-ways[:, 1], ways[:, 0]], -1)
    length = np.hypot(normals[:, 0], normals[:, 1])
    # Where the curve stands still there is no normal, and any direction does no harm.
    normals = np.where(length[:, None] > 0.0, normals / np.where(length, length, 1.0)[:, None], 0.0)
    if sides is None:
        points, normals = np.tile(points, (2, 1)), np.concatenate([normals, -normals])
    else:
        normals = normals * sides[:, None]
    marched = points + abs(distance) * normals
    return marched, normals, np.abs(signed_distance(shape, marched) - distance)


def _fans(shape: Shape, distance: float) -> tuple[Floats, Floats, Floats]:
    """The same around corners, in directions between the normals of the pieces that meet there."""
    every = np.arange(shape.piece_count)
    after = every + 1
    after[shape.loops[1:] - 1] = shape.loops[:-1]
    arriving = shape.control[shape.starts[1:] - 1] - shape.control[shape.starts[1:] - 2]
    leaving = shape.control[shape.starts[:-1] + 1] - shape.control[shape.starts[:-1]]
    # A handle without length has no direction: all around, then.
    still = (arriving == 0.0).all(axis=1) | (leaving[after] == 0.0).all(axis=1)
    first = np.arctan2(arriving[:, 1], arriving[:, 0])
    turn = np.arctan2(leaving[after, 1], leaving[after, 0]) - first
    turn = np.where(still, np.pi, (turn + np.pi) % (2.0 * np.pi) - np.pi)
    rows: Bools = np.abs(turn) > FAN
    share = (np.arange(_FAN) + 0.5) / _FAN
    angle = (first[rows, None] + turn[rows, None] * share).ravel() + 0.5 * np.pi
    normals = np.stack([np.cos(angle), np.sin(angle)], -1)
    points = np.repeat(shape.control[shape.starts[1:] - 1][rows], _FAN, axis=0)
    normals, points = np.concatenate([normals, -normals]), np.tile(points, (2, 1))
    marched = points + abs(distance) * normals
    if len(marched) == 0:
        return marched, normals, np.empty(0)
    return marched, normals, np.abs(signed_distance(shape, marched) - distance)


def _beside_curves(curves: Sequence[Floats], off: float) -> Floats:
    """Points a little off each curve, to both sides."""
    result = [np.empty((0, 2))]
    for curve in curves:
        ways = np.diff(curve, axis=0)
        length = np.hypot(ways[:, 0], ways[:, 1])
        ends = np.cumsum(length)
        number = max(_OF_A_CURVE, _BESIDE // len(curves))
        rows = np.searchsorted(ends, ends[-1] * (np.arange(number) + 0.5) / number)
        rows = rows[length[rows] > 0.0]
        middles = 0.5 * (curve[rows] + curve[rows + 1])
        aside = off * np.stack([-ways[rows, 1], ways[rows, 0]], -1) / length[rows, None]
        result += [middles + aside, middles - aside]
    return np.concatenate(result)


def _everywhere(shape: Shape, distance: float, curves: Sequence[Floats]) -> Floats:
    """A grid over the shape, grown by the distance, and over the curves."""
    grown = 1.05 * max(distance, 0.0) + 0.0123 * shape.size
    xmin, ymin, xmax, ymax = shape.box
    corners = np.array([(xmin - grown, ymin - grown), (xmax + grown, ymax + grown)])
    hull = np.concatenate([corners, *curves])
    low, high = hull.min(axis=0), hull.max(axis=0)
    axes = [np.linspace(low[k], high[k], _GRID) for k in (0, 1)]
    return np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
