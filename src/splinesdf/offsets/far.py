"""Offsets so far out that only the convex hull counts: arcs around its corners, and its edges.

Where the hull bridges a dent of width L, the exact offset at the distance d runs along two arcs
that cross; they are no more than L^2 / 8 d inside the line over the bridge.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.points import off_chord, points_at
from splinesdf.arclets.tables import ROUND, STRAIGHT
from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.shapes.shape import Shape

# Distances beyond so many times the size are far: parallels there differ by rounding only. Smaller:
# offsets lose their exact corners; larger: time is spent in vain.
FAR = 2e4
# Where parallels left loose ends, a fit helps up to so many times the size; beyond, its domain is
# all empty plane, and the hull takes its place.
_EMPTY = 20.0
# Shares of the tolerance: for dents, for curves that become polygons, and for corners left out.
_DENTS, _FLAT, _FEWER = 0.25, 0.125, 0.25
# Points of one arclet at most, so that a tolerance far below its bulge does not fill the memory.
_POINTS = 4096
# Centers of one circle are no farther apart, as a share of the size.
_SAME = 1e-9
_QUARTER = 0.5 * math.pi + 1e-6


def is_far(shape: Shape, distance: float) -> bool:
    """Whether rounding hides parallels from each other at a distance."""
    return distance > FAR * shape.size


def has_no_fit(shape: Shape, distance: float) -> bool:
    """Whether a distance is too far for a fit around the boundary."""
    return distance > _EMPTY * shape.size


def hull_offset(shape: Shape, distance: float, tolerance: float) -> Contour:
    """Offset the shape's convex hull in place of the shape.

    Raises
    ------
    InputError
        If both may differ by more than the tolerance.
    """
    least = shape.size**2 / (8.0 * distance) / _DENTS
    if tolerance < least:
        raise InputError(
            f"expected a tolerance of at least {least:.2g} at {distance / shape.size:.2g} times "
            f"the shape's size, got {tolerance:.2g}: raise it, or ask for a smaller distance"
        )
    centers, radii = _disks(shape, tolerance)
    normal = _normals(centers, radii)
    arcs, weights, lines = [], [], []
    for center, radius, before, after in zip(
        centers, radii + distance, np.roll(normal, 1, axis=0), normal, strict=True
    ):
        turn = math.atan2(before[0] * after[1] - before[1] * after[0], float(before @ after))
        # Corners turn by less than half a turn; a circle may be seen from nearly all around.
        turn += 2.0 * math.pi if len(centers) == 1 or (turn < 0.0 and radius > distance) else 0.0
        count = max(1, math.ceil(turn / _QUARTER))
        angles = math.atan2(before[1], before[0]) + turn * np.arange(2 * count + 1) / (2 * count)
        weight = math.cos(0.5 * turn / count)
        around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        around[0], around[-1] = before, after
        around[1::2] /= weight
        around = center + radius * around
        arcs += [around[k : k + 3] for k in range(0, 2 * count, 2)]
        weights += [weight] * count
        if len(centers) > 1:
            lines.append(len(arcs))
            arcs.append(np.stack([around[-1]] * 3))  # its end is set below
            weights.append(1.0)
    every = np.stack(arcs)
    every[:, 2] = np.roll(every[:, 0], -1, axis=0)
    every[lines, 1] = 0.5 * (every[lines, 0] + every[lines, 2])
    every += shape.boundary.origin
    return Contour(
        every,
        np.array(weights),
        distance=distance,
        y_down=shape.y_down,
        unit=shape.unit,
        page=shape.page,
    )


def _disks(shape: Shape, tolerance: float) -> tuple[Floats, Floats]:
    """Find disks with the hull of the shape, counterclockwise: its circles, and corners as points.

    Returns
    -------
    centers : ndarray, shape (n, 2)
    radii : ndarray, shape (n,)
    """
    points, arclet = _points(shape, _FLAT * tolerance)
    hull = _hull(points)
    corners, arclet = points[hull], arclet[hull]
    kinds = shape.kinds
    round_ = kinds.kind[arclet] == ROUND
    center = kinds.center[arclet]
    following = np.roll(np.arange(len(hull)), -1)
    with np.errstate(invalid="ignore"):
        apart = np.hypot(*(center[following] - center).T)
    same = round_ & round_[following] & (apart <= _SAME * shape.size)
    # A corner on a circle has another corner on that circle before or behind it.
    before = np.roll(same, 1)
    on_circle = same | before
    begins = np.flatnonzero(~before & (on_circle | np.roll(on_circle, 1)))
    order = np.roll(np.arange(len(hull)), -begins[0]) if len(begins) else np.arange(len(hull))
    centers, radii = [], []
    for rows in np.split(order, (begins - begins[:1])[1:]):
        if on_circle[rows[0]]:
            about = center[rows].mean(axis=0)
            centers.append(about[None])
            radii.append(np.array([np.hypot(*(corners[rows] - about).T).mean()]))
        else:
            centers.append(_fewer(corners[rows], _FEWER * tolerance))
            radii.append(np.zeros(len(centers[-1])))
    return np.concatenate(centers), np.concatenate(radii)


def _normals(centers: Floats, radii: Floats) -> Floats:
    """Outward normals of the lines that touch each disk and the next one: (n, 2)."""
    apart = np.roll(centers, -1, axis=0) - centers
    length = np.hypot(apart[:, 0], apart[:, 1])
    if len(centers) == 1:
        return np.array([[1.0, 0.0]])
    ahead = apart / length[:, None]
    # Both are as far out along the normal: n . c + r is the same.
    lean = np.clip((radii - np.roll(radii, -1)) / length, -1.0, 1.0)[:, None]
    right = np.stack([ahead[:, 1], -ahead[:, 0]], axis=1)
    return np.asarray(lean * ahead + np.sqrt(1.0 - lean * lean) * right)


def _points(shape: Shape, apart: float) -> tuple[Floats, Ints]:
    """Sample the boundary so that chords are no farther off it: points, and their arclets."""
    boundary = shape.boundary
    bulge = shape.bends.rows[:, 10]
    count = np.clip(np.ceil(np.sqrt(bulge / apart)), 2, _POINTS).astype(np.int64)
    count[shape.kinds.kind == STRAIGHT] = 1
    count[shape.kinds.kind == ROUND] = 4
    arclet = np.repeat(np.arange(len(count)), count)
    place = np.arange(len(arclet)) - np.repeat(np.cumsum(count) - count, count)
    return points_at(boundary, arclet, place / count[arclet]), arclet


def _hull(points: Floats) -> Ints:
    """The corners of the convex hull, counterclockwise: Andrew's monotone chain."""
    order = np.lexsort((points[:, 1], points[:, 0]))
    sides = []
    for ordered in (order, order[::-1]):
        chain: list[int] = []
        rows = points[ordered].tolist()
        for k, (x, y) in enumerate(rows):
            while chain:
                bx, by = rows[chain[-1]]
                if len(chain) > 1:
                    ax, ay = rows[chain[-2]]
                    if (bx - ax) * (y - by) - (by - ay) * (x - bx) > 0.0:
                        break
                elif (x, y) != (bx, by):
                    break
                chain.pop()
            chain.append(k)
        sides.append(ordered[chain[:-1]])
    return np.concatenate(sides)


def _fewer(chain: Floats, apart: float) -> Floats:
    """Thin out a chain: corners that are left out are no farther from the chords."""
    count = len(chain)
    kept, first = [0], 0
    while first < count - 1:
        low, high = first + 1, min(first + 2, count - 1)
        # The longest chord: doubled while it fits, then halved.
        while high > low and off_chord(chain[first : high + 1][None])[0] <= apart:
            low, high = high, min(first + 2 * (high - first), count - 1)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (
                (middle, high)
                if off_chord(chain[first : middle + 1][None])[0] <= apart
                else (low, middle)
            )
        kept.append(low)
        first = low
    return chain[kept]
