"""Which arclets are straight and which are parts of circles, to rounding, whatever they came from.

An arc of an SVG path, a NURBS circle and a formula of cosines are all polynomial pieces by now;
what they describe is told by their points. It holds for whole pieces: a short enough part of any
curve is straight, to rounding.
"""

from __future__ import annotations

import numpy as np

from splinesdf._arrays import Floats, Ints
from splinesdf._tables import FREE, ROUND, STRAIGHT, Arclets, Kinds
from splinesdf.curves.geometry import points_at

# Points of a straight or round arclet may be off by this share of the largest coordinate, for
# rounding and compilation (4 ulp). Larger: curves that only look like circles lose their own
# shape by as much; smaller: circles are not recognized, and come back as several conics.
_OFF = 32 * 2.220446049250313e-16
# Two centers of one circle, found on short arclets, may differ by this share of size and radius.
_CENTERS_APART = 1e-9
# Arclets below this share of the largest coordinate are straight and round alike.
_SHORT = 1e-6
# Where an arclet is looked at, the middle one in the middle. A piece has several arclets as a rule,
# and all of them must be on one circle, so that few points do.
_INSIDE = np.array([0.25, 0.5, 0.75])


def kinds(boundary: Arclets) -> Kinds:
    """Kind of every arclet, and center and signed radius of the round ones."""
    count = len(boundary.start)
    # Rounding and compilation left what they did before the origin was moved.
    largest = float(np.abs(boundary.boxes[0]).max() + np.abs(boundary.origin).max())
    every = np.repeat(np.arange(count), len(_INSIDE))
    inside = points_at(boundary, every, np.tile(_INSIDE, count)).reshape(count, -1, 2)
    chord = boundary.end - boundary.start
    length = np.hypot(chord[:, 0], chord[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = chord / length[:, None]
        apart = inside - boundary.start[:, None]
        across = ahead[:, None, 0] * apart[..., 1] - ahead[:, None, 1] * apart[..., 0]
        straight = np.abs(across).max(axis=1) <= _OFF * largest
        # The circle through both ends and the point in the middle, from its sagitta.
        middle = 0.5 * (boundary.start + boundary.end)
        sagitta = across[:, len(_INSIDE) // 2]
        along = np.sum((inside[:, len(_INSIDE) // 2] - middle) * ahead, axis=1)
        # that point is not quite above the middle of the chord
        height = (along**2 + sagitta**2 - 0.25 * length**2) / (2.0 * sagitta)
        left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
        center = middle + height[:, None] * left
        radius = -np.sign(sagitta) * np.hypot(*(center - boundary.start).T)
        off = np.hypot(*np.moveaxis(inside - center[:, None], 2, 0)) - np.abs(radius)[:, None]
        scale = largest + np.abs(radius)
        curved = np.abs(off).max(axis=1) <= _OFF * scale
    # What was cut off just beside a turn of x or y has no radius of its own.
    short = length <= _SHORT * largest
    straight = _of_pieces(straight | short, boundary.piece)
    curved = _of_pieces((curved & np.isfinite(radius)) | short, boundary.piece) & ~straight
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        # Rounding in a center grows with the square of radius over length.
        unsure = _CENTERS_APART * scale + _OFF * scale * (radius / length) ** 2
    unsure = np.where(short, np.inf, unsure)
    curved &= _one_center(center, radius, length, unsure, boundary.piece)
    center, radius = _averages(center, radius, length, boundary.piece, curved)
    kind = np.where(straight, STRAIGHT, np.where(curved, ROUND, FREE))
    return Kinds(
        kind,
        np.where(curved[:, None], center, np.nan),
        np.where(curved, radius, np.nan),
    )


def _of_pieces(flags: np.ndarray, piece: Ints) -> np.ndarray:
    """Whether a flag is set for all arclets of an arclet's piece."""
    bad = np.zeros(int(piece.max()) + 1, dtype=np.bool_)
    bad[piece[~flags]] = True
    return np.asarray(~bad[piece])


def _one_center(
    center: Floats, radius: Floats, length: Floats, unsure: Floats, piece: Ints
) -> np.ndarray:
    """Whether all arclets of an arclet's piece have the circle of the longest one."""
    circle = np.column_stack([np.where(np.isfinite(center), center, 0.0), np.nan_to_num(radius)])
    longest = np.zeros(int(piece.max()) + 1, dtype=np.int64)
    order = np.argsort(length, kind="stable")
    longest[piece[order]] = order
    apart = np.abs(circle - circle[longest[piece]]).max(axis=1)
    return _of_pieces(apart <= unsure, piece)


def _averages(
    center: Floats, radius: Floats, length: Floats, piece: Ints, chosen: np.ndarray
) -> tuple[Floats, Floats]:
    """One circle for all arclets of a piece: a center's error falls with the square of the arc."""
    known = chosen & np.isfinite(radius) & np.isfinite(center).all(axis=1)
    weight = np.where(known, length**2, 0.0)
    total = np.bincount(piece, weight)
    sums = [
        np.bincount(piece, weight * np.where(known, column, 0.0)) for column in (*center.T, radius)
    ]
    with np.errstate(divide="ignore", invalid="ignore"):
        x, y, r = (column / total for column in sums)
    return np.column_stack([x, y])[piece], r[piece]
