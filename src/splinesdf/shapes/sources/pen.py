"""How a stroke is drawn, and what it adds to its strips: joins at corners, caps at open ends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.shapes.region import Loops, region
from splinesdf.shapes.sources.compiled import compile_arc


class Pen(NamedTuple):
    """How a stroke is drawn."""

    width: float
    cap: str = "butt"  # butt, round, square
    join: str = "miter"  # miter, round, bevel
    miter_limit: float = 4.0


def turn_between(one: Floats, other: Floats) -> float:
    """The angle from one direction to another, in (-pi, pi]."""
    return math.atan2(one[0] * other[1] - one[1] * other[0], float(one @ other))


def join(at: Floats, before: Floats, after: Floats, half: float, pen: Pen) -> Loops:
    """Return what is added where a path turns, on the outer side."""
    turn = turn_between(before, after)
    side = -math.copysign(half, turn)
    if pen.join == "round":
        return _fan(at, side * np.array([-before[1], before[0]]), turn)
    one = at + side * np.array([-before[1], before[0]])
    other = at + side * np.array([-after[1], after[0]])
    corners = [at, one, other]
    # The miter is 1 / sin of half the angle between the pieces, in widths.
    sine = math.cos(0.5 * turn)
    if pen.join != "bevel" and sine > 0.0 and pen.miter_limit * sine >= 1.0:
        middle = 0.5 * (one + other) - at
        tip = at + middle * (half * half / float(middle @ middle))
        corners = [at, one, tip, other]
    return region([_polygon(corners)], "nonzero")


def cap(at: Floats, outward: Floats, half: float, pen: Pen) -> Loops:
    """Return what is added beyond an open end."""
    normal = half * np.array([-outward[1], outward[0]])
    if pen.cap == "round":
        return _fan(at, -normal, math.pi)
    if pen.cap != "square":
        return []
    far = at + half * outward
    return [_polygon([at - normal, far - normal, far + normal, at + normal])]


def dot(at: Floats, along: Floats, pen: Pen) -> Loops:
    """Return what is seen of a path of no length: its caps."""
    half = 0.5 * pen.width
    if pen.cap == "round":
        return _disk(at, half)
    ahead, left = half * along, half * np.array([-along[1], along[0]])
    return [_polygon([at - ahead - left, at + ahead - left, at + ahead + left, at - ahead + left])]


def _fan(at: Floats, spoke: Floats, turn: float) -> Loops:
    """A sector of a disk, from a spoke on.

    No more of the disk: that would be seen beyond the butt end of a short piece.
    """
    arc = compile_arc(at, spoke, np.array([-spoke[1], spoke[0]]), 0.0, turn)
    lines = [np.array([arc[-1][-1], at]), np.array([at, arc[0][0]])]
    return region([[*arc, *lines]], "nonzero")


def _disk(at: Floats, radius: float) -> Loops:
    return [compile_arc(at, (radius, 0.0), (0.0, radius), 0.0, 2.0 * math.pi)]


def _polygon(corners: Sequence[Floats]) -> list[Floats]:
    return [np.array(pair) for pair in zip(corners, [*corners[1:], corners[0]], strict=True)]
