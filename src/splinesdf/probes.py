"""Probes: points in which every small part of a shape shows, wherever a mesh has its samples.

A hole, a bump or a notch much smaller than a cell can lie between the cell's samples. It has
arclets, though, and its trace at a distance lies on their normals, or between the normals of two
arclets that meet in a corner: that is where the probes are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from splinesdf._arrays import Floats
from splinesdf._tables import Arclets
from splinesdf.curves.geometry import derivatives_at, end_tangents, points_at, turns
from splinesdf.curves.shape import Shape

# Directions in the fan of a corner. Fewer: where other parts of the shape leave two gaps in the
# view from a corner, the search is more often in the wrong one.
_FAN = 9
# Arclets that turn by less than this (radians) where they meet are no corner: the fan's width at
# the distance of the shape's size is a thousandth of it, and the normals beside it are near.
_CORNER = 1e-3
# Steps of the search in a fan, each 0.62 of the last: 1e-5 of the fan. A corner e nearer than what
# is beside it is seen at the distance d from an angle of 2 sqrt(2 e / d): 1e-10 d is still found.
_SEARCH = 24
# Distances that agree to this share are the same to rounding.
_TIED = 1e-13
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


def probes(
    distance: Callable[[Floats], Floats], shape: Shape, distances: Iterable[float]
) -> Floats:
    """Points at distances from the ends and middles of all arclets, along normals, both ways.

    Parameters
    ----------
    distance : callable, (n, 2) -> (n,)
        Exact, of this shape.
    shape : Shape
    distances : iterable of float
        The sign does not matter: each is tried on both sides.

    Returns
    -------
    ndarray, shape (n, 2)
        In a corner's fan, the middle of where the corner is nearest. Many are nearer
        to another part of the shape than the distance.
    """
    leaving, arriving = end_tangents(shape.boundary)
    position, normal = _normals(shape.boundary, arriving, leaving)
    fans = _fans(shape.boundary, arriving)
    result = []
    for step in sorted({abs(value) for value in distances}):
        if step == 0.0:
            result.append(position)
        else:
            result += [position + step * normal, position - step * normal]
            result.append(_clearest(distance, fans, step))
    return np.concatenate(result)


class _Fans(NamedTuple):
    """What is seen of corners from outside the turn."""

    corner: Floats  # (n, 2)
    first: Floats  # (n,) angle of the normal that arrives
    turn: Floats  # (n,) from there to the one that leaves


def _normals(arclets: Arclets, arriving: Floats, leaving: Floats) -> tuple[Floats, Floats]:
    """Ends and middles of arclets, and unit normals there."""
    every = np.arange(len(arclets.start))
    half = np.full(len(every), 0.5)
    middle, across = points_at(arclets, every, half), derivatives_at(arclets, every, half)[0]
    position = np.concatenate([arclets.start, middle, arclets.end]) + arclets.origin
    along = np.concatenate([leaving, across, arriving])
    length = np.hypot(along[:, 0], along[:, 1])[:, None]
    return position, np.stack([-along[:, 1], along[:, 0]], axis=1) / np.where(length, length, 1.0)


def _fans(arclets: Arclets, arriving: Floats) -> _Fans:
    turn = turns(arclets)
    corner = np.abs(turn) > _CORNER
    arriving, turn = arriving[corner], turn[corner]
    # The side that the curve turns away from.
    outward = np.where(turn > 0.0, -0.5 * np.pi, 0.5 * np.pi)
    first = np.arctan2(arriving[:, 1], arriving[:, 0]) + outward
    return _Fans(arclets.end[corner] + arclets.origin, first, turn)


def _clearest(distance: Callable[[Floats], Floats], fans: _Fans, step: float) -> Floats:
    """In each fan, at a distance from the corner, the middle of what no other part is nearer to."""

    def at(share: Floats) -> Floats:
        angle = fans.first + share * fans.turn
        return fans.corner + step * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def clear(share: Floats) -> Floats:
        return np.abs(distance(at(share)))

    count = len(fans.turn)
    shares = np.linspace(0.0, 1.0, _FAN)
    seen = np.stack([clear(np.full(count, share)) for share in shares], axis=1)
    best = np.argmax(seen, axis=1)
    low, high = shares[np.maximum(best - 1, 0)], shares[np.minimum(best + 1, _FAN - 1)]
    peak = _peak(clear, low, high)
    peak = np.where(clear(peak) >= clear(shares[best]), peak, shares[best])
    # The corner is nearest in an interval around it, at whose ends something else is as near.
    near = clear(peak) * (1.0 - _TIED)
    ends = []
    for end in (np.zeros(count), np.ones(count)):
        outside, inside = end, peak
        for _ in range(_SEARCH):
            middle = 0.5 * (outside + inside)
            there = clear(middle) >= near
            outside, inside = np.where(there, outside, middle), np.where(there, middle, inside)
        ends.append(np.where(clear(end) >= near, end, inside))
    return at(0.5 * (ends[0] + ends[1]))


def _peak(function: Callable[[Floats], Floats], low: Floats, high: Floats) -> Floats:
    """Where functions of one variable that rise and then fall are largest, by golden section."""
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    on_left, on_right = function(left), function(right)
    for _ in range(_SEARCH):
        go_left = on_left >= on_right
        low, high = np.where(go_left, low, left), np.where(go_left, right, high)
        fresh = np.where(go_left, high - _GOLDEN * (high - low), low + _GOLDEN * (high - low))
        value = function(fresh)
        left, right = np.where(go_left, fresh, right), np.where(go_left, left, fresh)
        on_left, on_right = np.where(go_left, value, on_right), np.where(go_left, on_left, value)
    return np.asarray(np.where(on_left >= on_right, left, right))
