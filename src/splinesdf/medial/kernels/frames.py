"""Feet and normals along a walk, and places of feet that are known by arclet and parameter."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from splinesdf.arclets.kernels.arclet import derivatives, point_on
from splinesdf.ground.jit import uncounted
from splinesdf.medial.tables import ANGLE, FAN, KIND, OWNER, ROUND, STRAIGHT, Walk

# Searches start from the root alone and pass over no arclet; no arclet is known yet. As integers of
# a type of their own: for literals Numba would compile what is called once more.
ROOT, NONE, FIRST = (cast(int, np.int64(k)) for k in (1, -1, 0))


@uncounted
def frame(walk: Walk, e: int, u: float) -> tuple[float, float, float, float]:
    """The point of a walk at a place, and the unit normal there, into the region."""
    i = walk.element[e, OWNER]
    kind = walk.element[e, KIND]
    numbers = walk.numbers
    if kind == FAN:
        turned = numbers[e, ANGLE] * u
        c, s = math.cos(turned), math.sin(turned)
        tx, ty = numbers[e, 0], numbers[e, 1]
        x, y = point_on(walk.arcs, i, 1.0)
        return x, y, -(tx * s + ty * c), tx * c - ty * s
    x, y = point_on(walk.arcs, i, u)
    if u <= 0.0 or kind == STRAIGHT:
        return x, y, -numbers[e, 1], numbers[e, 0]
    if u >= 1.0:
        return x, y, -numbers[e, 3], numbers[e, 2]
    if kind == ROUND:
        # The center is known to rounding, derivatives of compiled circles are not.
        nx, ny = numbers[e, 4] - x, numbers[e, 5] - y
        length = math.copysign(math.sqrt(nx * nx + ny * ny), numbers[e, 6])
        return x, y, nx / length, ny / length
    _, _, dx, dy, _, _ = derivatives(walk.arcs, i, u)
    length = math.sqrt(dx * dx + dy * dy)
    if length == 0.0:
        return x, y, -numbers[e, 1], numbers[e, 0]
    return x, y, -dy / length, dx / length


@uncounted
def place_of(
    walk: Walk,
    arclet: int,
    t: float,
    foot: tuple[float, float],
    arm: tuple[float, float],
    near: float,
) -> tuple[int, float]:
    """The place of a foot; an arm leads from it to the center, and tells directions in a fan.

    ``near`` is how near to the end of an arclet a foot is in the corner there.
    """
    x, y = foot
    for end in (0, 1):
        e = walk.of_arclet[arclet, 1 + end]
        if e < 0:
            continue
        ex, ey = point_on(walk.arcs, arclet, float(end))
        if math.hypot(ex - x, ey - y) > near:
            continue
        tx, ty = walk.numbers[e, 0], walk.numbers[e, 1]
        # From the first normal (-ty, tx) to the arm.
        turned = math.atan2(-ty * arm[1] - tx * arm[0], -ty * arm[0] + tx * arm[1])
        u = turned / walk.numbers[e, ANGLE]
        if u < 0.0:
            u = 0.0
        if u > 1.0:
            u = 1.0
        return e, u
    return walk.of_arclet[arclet, 0], t
