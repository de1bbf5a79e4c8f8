"""Feet: where on nearby arclets the closest point of a disk's middle is, and that of its others.

Used by `enclosure`; equation numbers are those of docs/theory/certificate.md.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.arclet import derivatives, foot_on_line
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import uncounted

# Newton's steps toward a foot on an arclet with a convex squared distance. The square of a step's
# error is left, so that five or six do; a bracket halves what leads out of it. Fewer: feet are off.
_STEPS = 12
_LAST_STEP = 1e-12
# Rounding in Bernstein coefficients of a squared distance, see `nearest`, and in differences of
# them, as a share of what goes into them.
_CONVEX_NOISE = 128 * 2.220446049250313e-16
_BEFORE, _START, _END, _AFTER = 1, 2, 4, 8


@uncounted
def fill_foot_table(
    arcs: Floats,
    rows: Floats,
    second: Floats,
    ids: Ints,
    count: int,
    disk: tuple[float, float, float],
    near: Floats,
) -> tuple[int, float, bool]:
    """Keep the arclets that can be closest within r of p: how many, the distance, if it is exact.

    A row of ``near``: distance, or minus a lower bound of it; parameter of the foot; vector from
    the foot to p; curvature and unit tangent there; flags (the foot of every point of the disk is
    the arclet's start: 1, or end: 8; that of some may be: 2, 4); a lower bound of the distance.
    """
    px, py, r = disk
    nearest = np.inf
    for j in range(count):
        i = ids[j]
        row = rows[i]
        degree = int(arcs[i, 0])
        vx, vy = px - arcs[i, 3], py - arcs[i, 4]
        near[j, 8] = _from_chord(arcs, i, vx, vy) - row[10]
        if near[j, 8] > nearest + 2.0 * r:
            near[j, 0] = -1.0
            continue
        first = -(vx * row[5] + vy * row[6])
        last = (arcs[i, 1] - px) * row[7] + (arcs[i, 2] - py) * row[8]
        if not row[1] < np.inf or (degree > 1 and not _convex(second[i], vx, vy, r)):
            # Its directions are not known, or it may have several feet. What is known is a lower
            # bound of the distance, and some upper one.
            value = min(vx * vx + vy * vy, (arcs[i, 1] - px) ** 2 + (arcs[i, 2] - py) ** 2)
            nearest = min(nearest, math.sqrt(value))
            if degree > 1:
                near[j, 8] = max(near[j, 8], _lower_bound(arcs, i, vx, vy))
            near[j, 0] = -max(near[j, 8], 1e-300)
            continue
        if first >= 0.0:
            t, wx, wy, tx, ty, bend = 0.0, vx, vy, row[5], row[6], row[3]
        elif last <= 0.0:
            t, tx, ty, bend = 1.0, row[7], row[8], row[4]
            wx, wy = px - arcs[i, 1], py - arcs[i, 2]
        else:
            t = first / (first - last)
            t = foot_on_line(arcs, i, vx, vy) if degree == 1 else _foot(arcs, i, px, py, t)
            x, y, dx, dy, ddx, ddy = derivatives(arcs, i, t)
            speed = math.sqrt(dx * dx + dy * dy)
            wx, wy, tx, ty = vx - x, vy - y, dx / speed, dy / speed
            bend = (dx * ddy - dy * ddx) / (speed * speed * speed)
        distance = math.sqrt(wx * wx + wy * wy)
        near[j, 0], near[j, 1], near[j, 2], near[j, 3] = distance, t, wx, wy
        near[j, 4], near[j, 5], near[j, 6] = bend, tx, ty
        flags = (_BEFORE if first >= r else 0) | (_START if first > -r else 0)
        near[j, 7] = flags | (_END if last < r else 0) | (_AFTER if last <= -r else 0)
        near[j, 8] = distance
        nearest = min(nearest, distance)
    kept = 0
    exact = True
    limit = nearest + 2.0 * r
    for j in range(count):
        if near[j, 8] <= limit:
            exact = exact and near[j, 0] >= 0.0
            ids[kept] = ids[j]
            for k in range(9):
                near[kept, k] = near[j, k]
            kept += 1
    return kept, nearest, exact


@uncounted
def _from_chord(arcs: Floats, i: int, vx: float, vy: float) -> float:
    """Distance to the chord of an arclet, a little less; v leads to the point from its start."""
    dx, dy = arcs[i, 1] - arcs[i, 3], arcs[i, 2] - arcs[i, 4]
    squared = dx * dx + dy * dy
    share = min(max((vx * dx + vy * dy) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    vx, vy = vx - share * dx, vy - share * dy
    return math.sqrt(vx * vx + vy * vy) * (1.0 - 1e-12)


@uncounted
def _convex(second: Floats, vx: float, vy: float, r: float) -> bool:
    """Whether the squared distance to an arclet is convex for all points within r (2.2).

    v leads to the disk's middle from the arclet's start.
    """
    least = np.inf
    for k in range(second.shape[1]):
        bend = second[0, k] - 2.0 * (vx * second[1, k] + vy * second[2, k])
        least = min(least, bend - 2.0 * r * second[3, k])
    return bool(least > _CONVEX_NOISE * (vx * vx + vy * vy + second[4, 0]))


@uncounted
def _lower_bound(arcs: Floats, i: int, vx: float, vy: float) -> float:
    """A lower bound of the distance to an arclet from Bernstein coefficients (2.3)."""
    n = 2 * int(arcs[i, 0])
    x, y, s = 5 + n, 6 + 2 * n, 7 + 3 * n
    squared = vx * vx + vy * vy
    noise = _CONVEX_NOISE * (squared + arcs[i, s + n])
    least = squared
    for k in range(n + 1):
        least = min(
            least, arcs[i, s + k] + squared - 2.0 * (vx * arcs[i, x + k] + vy * arcs[i, y + k])
        )
    return math.sqrt(max(least - noise, 0.0))


@uncounted
def _foot(arcs: Floats, i: int, px: float, py: float, start: float) -> float:
    """The root of h(t) = (c(t) - p) . c'(t), which rises from below zero to above, in [0, 1]."""
    low, high = 0.0, 1.0
    t = start
    for _ in range(_STEPS):
        x, y, dx, dy, ddx, ddy = derivatives(arcs, i, t)
        x, y = x + arcs[i, 3] - px, y + arcs[i, 4] - py
        h = x * dx + y * dy
        if h < 0.0:
            low = t
        else:
            high = t
        moved = t - h / (dx * dx + dy * dy + x * ddx + y * ddy)
        if not low <= moved <= high:
            moved = 0.5 * (low + high)
        step = abs(moved - t)
        t = moved
        if step <= _LAST_STEP:
            break
    return t
