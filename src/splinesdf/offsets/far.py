"""Offsets so far out that only the convex hull counts: arcs around its corners, and its edges.

Where the hull bridges a dent of width L, the exact offset at the distance d runs along two arcs
that cross; they are no more than L^2 / 8 d inside the line over the bridge.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf._arrays import Floats
from splinesdf.contour import Contour
from splinesdf.curves.geometry import points_at
from splinesdf.curves.shape import Shape
from splinesdf.errors import InputError

# What is farther than so many times the size is far: parallels there lie within rounding of one
# another. Smaller: offsets lose their exact corners; larger: work that ends in nothing.
FAR = 2e4
# Where parallels left loose ends, a fit helps up to so many times the size; beyond, its domain is
# all empty plane, and the hull must do.
_EMPTY = 20.0
# Shares of the tolerance: for dents, for curves that become polygons, and for corners left out.
_DENTS, _FLAT, _FEWER = 0.25, 0.125, 0.25
# Points of one arclet at most, so that a tolerance far below its bulge does not fill the memory.
_POINTS = 4096
_QUARTER = 0.5 * math.pi + 1e-6


def is_far(shape: Shape, distance: float) -> bool:
    """Whether parallels are not to be told apart at a distance."""
    return distance > FAR * shape.size


def has_no_fit(shape: Shape, distance: float) -> bool:
    """Whether a fit around the boundary is no way to an offset at a distance."""
    return distance > _EMPTY * shape.size


def hull_offset(shape: Shape, distance: float, tolerance: float) -> Contour:
    """The offset of the shape's convex hull, if that is the shape's own within the tolerance.

    Raises
    ------
    InputError
        If it is not.
    """
    least = shape.size**2 / (8.0 * distance) / _DENTS
    if tolerance < least:
        raise InputError(
            f"expected a tolerance of at least {least:.2g} at {distance / shape.size:.2g} times "
            f"the shape's size, got {tolerance:.2g}: raise it, or ask for a smaller distance"
        )
    corners = _fewer(_hull(_points(shape, _FLAT * tolerance)), _FEWER * tolerance)
    edge = np.roll(corners, -1, axis=0) - corners
    ahead = edge / np.hypot(edge[:, 0], edge[:, 1])[:, None]
    normal = np.stack([ahead[:, 1], -ahead[:, 0]], axis=1)
    arcs, weights = [], []
    for corner, before, after, length in zip(
        corners, np.roll(normal, 1, axis=0), normal, np.hypot(*edge.T), strict=True
    ):
        turn = math.atan2(before[0] * after[1] - before[1] * after[0], float(before @ after))
        count = max(1, math.ceil(turn / _QUARTER))
        began = math.atan2(before[1], before[0])
        angles = began + turn * np.arange(2 * count + 1) / (2 * count)
        weight = math.cos(0.5 * turn / count)
        around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        around[0], around[-1] = before, after
        around[1::2] /= weight
        around = corner + distance * around
        arcs += [around[k : k + 3] for k in range(0, 2 * count, 2)]
        weights += [weight] * count
        start, along = around[-1], length * np.array([-after[1], after[0]])
        arcs.append(np.stack([start, start + 0.5 * along, start + along]))
        weights.append(1.0)
    every = np.stack(arcs)
    every[:, 2] = np.roll(every[:, 0], -1, axis=0)
    every += shape.boundary.origin
    return Contour(every, np.array(weights), distance=distance, y_down=shape.y_down)


def _points(shape: Shape, apart: float) -> Floats:
    """Points of the boundary between which its chords are no farther off, about its origin."""
    boundary = shape.boundary
    bulge = shape.bends.rows[:, 10]
    count = np.clip(np.ceil(np.sqrt(bulge / apart)), 1, _POINTS).astype(np.int64)
    arclet = np.repeat(np.arange(len(count)), count)
    place = np.arange(len(arclet)) - np.repeat(np.cumsum(count) - count, count)
    return points_at(boundary, arclet, place / count[arclet])


def _hull(points: Floats) -> Floats:
    """The corners of the convex hull, counterclockwise: Andrew's monotone chain."""
    points = np.unique(points, axis=0)
    sides = [np.empty((0, 2))] * 2
    for side, ordered in enumerate((points, points[::-1])):
        chain: list[tuple[float, float]] = []
        for x, y in ordered.tolist():
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2:]
                if (bx - ax) * (y - by) - (by - ay) * (x - bx) > 0.0:
                    break
                chain.pop()
            chain.append((x, y))
        sides[side] = np.array(chain[:-1])
    return np.concatenate(sides)


def _fewer(corners: Floats, apart: float) -> Floats:
    """Corners of which those between two that are kept are no farther from their chord."""
    count = len(corners)
    if count < 4:
        return corners
    closed = np.concatenate([corners, corners[:1]])
    kept, first = [0], 0
    while first < count:
        low, high = first + 1, min(first + 2, count)
        # As far as can be: doubled while it fits, then halved.
        while high > low and _within(closed[first : high + 1], apart):
            low, high = high, min(first + 2 * (high - first), count)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (
                (middle, high) if _within(closed[first : middle + 1], apart) else (low, middle)
            )
        kept.append(low)
        first = low
    chosen = corners[kept[:-1]]
    return chosen if len(chosen) > 2 else corners


def _within(points: Floats, apart: float) -> bool:
    chord, off = points[-1] - points[0], points - points[0]
    length = float(np.hypot(*chord))
    across = np.abs(chord[0] * off[:, 1] - chord[1] * off[:, 0]).max()
    return length > 0.0 and bool(across <= apart * length)
