"""Kinds of arclets: straight ones and parts of circles, to rounding, whatever they came from.

An arc of an SVG path, a NURBS circle and a formula of cosines are all polynomial pieces by now, so
that their points decide. The kind is that of whole pieces: a short enough part of any curve is
straight, to rounding.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.arclets.points import points_at
from splinesdf.arclets.tables import FREE, ROUND, STRAIGHT, Arclets, Kinds
from splinesdf.ground.arrays import Floats, Ints

# Points of a straight or round piece may be off by this share of the largest coordinate, for
# rounding and compilation (4 ulp). Larger: curves that only look like circles lose their own
# shape by as much; smaller: circles are not recognized, and come back as several conics.
_OFF = 32 * 2.220446049250313e-16
# A piece whose radius is above this many times its length is no part of a circle: the center is all
# rounding. Larger: offsets are joined about centers that are off; smaller: flat arcs come back
# as conics, within the tolerance.
_FLATTEST = 1e6
# Parameters at which an arclet is looked at. A piece has several arclets as a rule, and all of them
# must be on one circle, so that few points do.
_INSIDE = np.array([0.25, 0.5, 0.75])


class ThreePoints(NamedTuple):
    """Points of the parts of pieces that are on the boundary."""

    first: Floats  # (n_pieces, 2)
    middle: Floats  # (n_pieces, 2) about halfway by the parameter
    last: Floats  # (n_pieces, 2)


def kinds(boundary: Arclets) -> Kinds:
    """Find the kind of every arclet, and the centers of round arclets."""
    piece, count = boundary.piece, int(boundary.piece.max()) + 1
    # Rounding and compilation happened before the origin was moved.
    rounding = _OFF * float(np.abs(boundary.boxes[0]).max() + np.abs(boundary.origin).max())
    every = np.repeat(np.arange(len(piece)), len(_INSIDE))
    inside = points_at(boundary, every, np.tile(_INSIDE, len(piece))).reshape(-1, 3, 2)
    looked = np.concatenate([boundary.start[:, None], inside, boundary.end[:, None]], axis=1)
    first, middle, last = _three_points(boundary, count)
    chord = last - first
    length = np.hypot(chord[:, 0], chord[:, 1])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        ahead = chord / length[:, None]
        x, y = _along_and_across(looked, first[piece, None], ahead[piece, None])
        straight = np.abs(y).max(axis=1) <= rounding
        # How far points are off the circle through three others, written without its radius and
        # center, which are lost to rounding where it is flat.
        long = length[piece, None]
        mx, my = (v[piece, None] for v in _along_and_across(middle, first, ahead))
        square, power = x * (x - long) + y * y, mx * (mx - long) + my * my
        off = (my * square - power * y) / np.hypot(power, my * long)
        curved = np.abs(off).max(axis=1) <= rounding
        height = (power / (2.0 * my))[:, 0]
        radius = np.hypot(height, 0.5 * long[:, 0])
        curved &= radius <= _FLATTEST * long[:, 0]
        left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
        center = (0.5 * (first + last))[piece] + height[:, None] * left[piece]
    straight = _of_pieces(straight, piece)
    curved = _of_pieces(curved, piece) & ~straight
    kind = np.where(straight, STRAIGHT, np.where(curved, ROUND, FREE))
    return Kinds(kind, np.where(curved[:, None], center, np.nan))


def _three_points(boundary: Arclets, count: int) -> ThreePoints:
    """Find the first and last point of every piece on the boundary, and a point between."""
    low, high = boundary.interval.min(axis=1), boundary.interval.max(axis=1)
    first, last, between = (np.zeros(count, dtype=np.int64) for _ in range(3))
    order = np.argsort(low, kind="stable")[::-1]
    first[boundary.piece[order]] = order
    order = np.argsort(high, kind="stable")
    last[boundary.piece[order]] = order
    middle = 0.5 * (low[first] + high[last])
    away = np.abs(0.5 * (low + high) - middle[boundary.piece])
    order = np.argsort(-away, kind="stable")
    between[boundary.piece[order]] = order
    # Pieces that run backward have their intervals backward, too.
    turned = boundary.interval[:, 0] > boundary.interval[:, 1]
    begin = np.where(turned[:, None], boundary.end, boundary.start)
    end = np.where(turned[:, None], boundary.start, boundary.end)
    share = np.clip((middle - low[between]) / (high - low)[between], 0.0, 1.0)
    # A point near an end would leave the circle undetermined.
    share = np.where((share > 0.1) & (share < 0.9), share, 0.5)
    share = np.where(turned[between], 1.0 - share, share)
    return ThreePoints(begin[first], points_at(boundary, between, share), end[last])


def _along_and_across(points: Floats, start: Floats, ahead: Floats) -> tuple[Floats, Floats]:
    """Coordinates of points along a direction and to the left of it."""
    apart = points - start
    return (
        apart[..., 0] * ahead[..., 0] + apart[..., 1] * ahead[..., 1],
        ahead[..., 0] * apart[..., 1] - ahead[..., 1] * apart[..., 0],
    )


def _of_pieces(flags: np.ndarray, piece: Ints) -> np.ndarray:
    """Set a flag where it is set for all arclets of the piece: (n,)."""
    bad = np.zeros(int(piece.max()) + 1, dtype=np.bool_)
    bad[piece[~flags]] = True
    return np.asarray(~bad[piece])
