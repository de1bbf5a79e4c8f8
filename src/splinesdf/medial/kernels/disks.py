"""Maximal disks: for feet on the boundary the largest disks of the region that touch it there.

A disk of radius r that touches q with the normal n contains p if k(q, p) = 2 n.(p - q) / |p - q|^2
is above 1 / r. So r falls to the radius of the maximal disk by r <- 1 / k(q, p), p the closest
point of the boundary to the center; it starts from the radius of curvature.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.arclet import derivatives, point_on
from splinesdf.arclets.kernels.nearest import room_to_search, search
from splinesdf.arclets.tables import Searched
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.medial.kernels.frames import NONE, ROOT, frame, place_of
from splinesdf.medial.tables import FIRST_BEND, FREE, KIND, Disks, Walk

# Steps to the radius; the method is Newton's, ten are much. At the ceiling the disk is not used.
_STEPS = 200
# A disk is empty if nothing is nearer to its center than this share of its radius, which is above
# the rounding in a distance. Larger: feet of disks differ by as much; smaller: noise is followed.
_EMPTY = 1.0 - 4e-15
# And by less than this share of the largest coordinate: rounding where disks are small.
_GRAIN = 8e-16
# A closest point nearer to the foot than this share of the radius is the foot itself, to rounding,
# or where the disk of curvature is the maximal one. Larger: disks beside ends of the axis are not
# found; smaller: k is rounding.
_ITSELF = 1e-6
# How near to a corner a foot is in it, as a share of the largest coordinate.
_NEAR = 1e-13


@kernel
def disks(searched: Searched, walk: Walk, most: float, found: Ints, room: Disks) -> None:
    """Fill center, radius and second foot of the maximal disk at each first foot.

    Parameters
    ----------
    searched : Searched
        The boundary.
    walk : Walk
    most : float
        No disk is larger.
    found : ndarray of int, shape (n,)
        Filled: 1 if there is a second foot; 0 if the disk is that of curvature.
    room : Disks
        Its first feet are read.
    """
    scratch = room_to_search(searched.arcs)
    near, grain = _NEAR * searched.largest, _GRAIN * searched.largest
    for i in range(found.shape[0]):
        e, u = room.element[i, 0], room.at[i, 0]
        x, y, nx, ny = frame(walk, e, u)
        bend = walk.numbers[e, FIRST_BEND] if u == 0.0 else _bend(walk, e, u)
        r = most
        if bend * most > 1.0:
            r = 1.0 / bend
        found[i] = 0
        arclet, t = NONE, 0.0
        for _ in range(_STEPS):
            scratch.nodes[0] = 0
            _, a, at = search(
                searched.tree,
                searched.arcs,
                (x + r * nx, y + r * ny),
                r * _EMPTY - grain,
                ROOT,
                NONE,
                -1.0,
                scratch,
            )
            if a < 0:
                found[i] = 1 if arclet >= 0 else 0
                break
            px, py = point_on(searched.arcs, a, at)
            vx, vy = px - x, py - y
            squared = vx * vx + vy * vy
            across = 2.0 * (nx * vx + ny * vy)
            if squared <= (_ITSELF * r) * (_ITSELF * r) or not across * r > squared:
                found[i] = 1 if arclet >= 0 else 0
                break
            r = squared / across
            arclet, t = a, at
        room.center[i, 0], room.center[i, 1] = x + r * nx, y + r * ny
        room.radius[i] = r
        room.element[i, 1], room.at[i, 1] = -1, 0.0
        if found[i] == 1:
            # The foot of the last center, which is the nearest but for the first foot.
            t = closer(walk, arclet, t, x + r * nx, y + r * ny)
            if t <= 0.0 or t >= 1.0:
                # The foot may be just inside the arclet beside, which is nearer by no more than the
                # square of how far: less than a search sees, but the order of feet depends on it.
                a = walk.of_arclet[arclet, 3 if t <= 0.0 else 4]
                at = closer(walk, a, 1.0 if t <= 0.0 else 0.0, x + r * nx, y + r * ny)
                if 0.0 < at < 1.0:
                    arclet, t = a, at
            px, py = point_on(searched.arcs, arclet, t)
            vx, vy = px - x, py - y
            across = 2.0 * (nx * vx + ny * vy)
            better = (vx * vx + vy * vy) / across
            if abs(better - r) < 1e-6 * r:
                r = better
            cx, cy = x + r * nx, y + r * ny
            room.center[i, 0], room.center[i, 1] = cx, cy
            room.radius[i] = r
            other, v = place_of(walk, arclet, t, (px, py), (cx - px, cy - py), near)
            room.element[i, 1], room.at[i, 1] = other, v


@uncounted
def _bend(walk: Walk, e: int, u: float) -> float:
    """Curvature at a place, positive where the region is convex."""
    if walk.element[e, KIND] != FREE:
        return float(walk.numbers[e, 8])
    _, _, bend = _turning(walk, e, u)
    return float(bend)


@uncounted
def _turning(walk: Walk, e: int, u: float) -> tuple[float, float, float]:
    arcs, i = walk.arcs, walk.element[e, 1]
    dx = dy = ddx = ddy = 0.0
    for k in range(3 + 2 * int(arcs[i, 0]), 3, -2):
        n = (k - 3) // 2
        dx, dy = dx * u + n * arcs[i, k], dy * u + n * arcs[i, k + 1]
        if n > 1:
            ddx = ddx * u + n * (n - 1) * arcs[i, k]
            ddy = ddy * u + n * (n - 1) * arcs[i, k + 1]
    speed = math.sqrt(dx * dx + dy * dy)
    if speed == 0.0:
        return dx, dy, 0.0
    return dx, dy, (dx * ddy - dy * ddx) / (speed * speed * speed)


@uncounted
def closer(walk: Walk, arclet: int, t: float, x: float, y: float) -> float:
    """The parameter of a point's foot on an arclet, from one that is near, by Newton's method."""
    arcs = walk.arcs
    for _ in range(4):
        cx, cy, dx, dy, ddx, ddy = derivatives(arcs, arclet, t)
        cx, cy = cx + arcs[arclet, 3] - x, cy + arcs[arclet, 4] - y
        slope = dx * dx + dy * dy + (cx * ddx + cy * ddy)
        if not slope > 1e-9 * (dx * dx + dy * dy):
            break
        step = (cx * dx + cy * dy) / slope
        if abs(step) > 1e-3:
            break
        t -= step
        if t < 0.0:
            t = 0.0
        if t > 1.0:
            t = 1.0
    return t


@kernel
def frames(walk: Walk, element: Ints, at: Floats, rows: Floats) -> None:
    """Fill points and normals of a walk at places: x, y, nx, ny."""
    for i in range(rows.shape[0]):
        rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3] = frame(walk, element[i], at[i])


@kernel
def distances(searched: Searched, points: Floats, far: Floats) -> None:
    """Fill how far points are from the boundary."""
    scratch = room_to_search(searched.arcs)
    for i in range(far.shape[0]):
        scratch.nodes[0] = 0
        far[i], _, _ = search(
            searched.tree,
            searched.arcs,
            (points[i, 0], points[i, 1]),
            np.inf,
            ROOT,
            NONE,
            -1.0,
            scratch,
        )
