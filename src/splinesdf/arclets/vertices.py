"""Vertices in which a boundary touches itself, and how it goes on there, seen from both sides.

Where more than two branches meet, they bound wedges that are inside and outside by turns. Seen from
inside, a branch that arrives goes on in the other one that bounds its wedge inside; seen from
outside, in the other one of its wedge outside. An offset inward has one corner for each wedge
inside, an offset outward one for each wedge outside.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.arclets.points import points_at
from splinesdf.arclets.tables import Arclets
from splinesdf.ground.arrays import Floats, Ints

# Directions are compared at points of all branches that are equally far from the vertex, at most
# this share of the shortest arclet there, so that branches with a common tangent differ.
_LOOK = 0.9
# Halvings to such a point.
_STEPS = 50


class Vertices(NamedTuple):
    """Points in which more than two branches meet."""

    touch: Ints  # (n, 2) the vertex that each arclet starts and ends in, -1 for none
    ends: Ints  # (m,) arclets that end in a vertex, vertex after vertex
    inside: Ints  # (m,) the arclets that follow them around the inside
    outside: Ints  # (m,) the arclets that follow them around the outside


class _Branches(NamedTuple):
    """Branches that arrive in a vertex, as in `Vertices`."""

    ends: Ints
    inside: Ints
    outside: Ints


def vertices(boundary: Arclets) -> Vertices:
    """Find vertices by coordinates of ends, which are equal to the bit (see `boundary`)."""
    count = len(boundary.start)
    touch = np.full((count, 2), -1)
    none = np.empty(0, dtype=np.int64)
    last = np.flatnonzero(np.diff(boundary.run, append=-1) != 0)
    first = np.flatnonzero(np.diff(boundary.run, prepend=-1) != 0)
    if len(last) < 2:
        return Vertices(touch, none, none, none)
    points = np.concatenate([boundary.end[last], boundary.start[first]])
    _, number, multiple = np.unique(points, axis=0, return_inverse=True, return_counts=True)
    number = number.ravel()
    # Two arriving and two leaving branches at least.
    crowded = multiple[number] >= 4
    if not crowded.any():
        return Vertices(touch, none, none, none)
    ends, starts = crowded[: len(last)], crowded[len(last) :]
    touch[last[ends], 1] = number[: len(last)][ends]
    touch[first[starts], 0] = number[len(last) :][starts]
    found = [
        _around(boundary, np.flatnonzero(touch[:, 1] == v), np.flatnonzero(touch[:, 0] == v))
        for v in np.unique(touch[touch >= 0])
    ]
    kept = [some for some in found if some is not None]
    if not kept:
        return Vertices(touch, none, none, none)
    return Vertices(touch, *(np.concatenate(column) for column in zip(*kept, strict=True)))


def _around(boundary: Arclets, ends: Ints, starts: Ints) -> _Branches | None:
    """Find the arclets that follow arriving branches on both sides; None if rounding decides."""
    if len(ends) != len(starts):
        return None
    arclet = np.concatenate([ends, starts])
    arrives = np.arange(len(arclet)) < len(ends)
    vertex = boundary.end[ends[0]]
    points = _equally_far(boundary, arclet, arrives, vertex)
    order = np.argsort(np.arctan2(*(points - vertex).T[::-1]), kind="stable")
    if (arrives[order] == np.roll(arrives[order], 1)).any():
        return None
    at = np.flatnonzero(arrives[order])
    around = arclet[order]
    # Counterclockwise of a branch that arrives lies the outside.
    return _Branches(around[at], around[at - 1], around[(at + 1) % len(around)])


def _equally_far(boundary: Arclets, arclet: Ints, arrives: np.ndarray, vertex: Floats) -> Floats:
    """Find a point of each branch, all at the same distance from the vertex: (n, 2)."""
    chord = np.hypot(*(boundary.end[arclet] - boundary.start[arclet]).T)
    radius = _LOOK * chord.min()
    near, far = np.zeros(len(arclet)), np.ones(len(arclet))
    for _ in range(_STEPS):
        middle = 0.5 * (near + far)
        points = points_at(boundary, arclet, np.where(arrives, 1.0 - middle, middle))
        inside = np.hypot(*(points - vertex).T) < radius
        near, far = np.where(inside, middle, near), np.where(inside, far, middle)
    return points_at(boundary, arclet, np.where(arrives, 1.0 - far, far))
