"""Which arclets are straight or parts of circles, see `splinesdf.arclets.kinds`."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.tables import FREE, ROUND, STRAIGHT, Kinds
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.ground.jit import kernel_as_written, uncounted_as_written

# Parameters at which an arclet is looked at, a quarter apart. A piece has several arclets as a
# rule, and all of them must be on one circle, so that few points do.
_LOOKED = 5


@kernel_as_written
def fill_kinds(
    arcs: Floats,
    piece: Ints,
    interval: Floats,
    limits: tuple[float, float],
    three: Floats,
    found: Kinds,
) -> None:
    """Fill the kind of every arclet, and the centers of round ones.

    Parameters
    ----------
    arcs, piece, interval : ndarray
        Of `Arclets`.
    limits : tuple of float
        How far off points may be, and how many times its length a radius may be.
    three : ndarray, shape (n_pieces, 3, 2)
        Room for the first and last point of each piece on the boundary, and one between.
    found : Kinds
        Filled.
    """
    count = three.shape[0]
    straight, round_ = np.ones(count, dtype=np.bool_), np.ones(count, dtype=np.bool_)
    which = np.full((count, 3), -1)
    _find_three(arcs, piece, interval, which, three)
    for i in range(arcs.shape[0]):
        _look(arcs, i, three[piece[i]], limits, found, straight, round_, piece[i])
    for i in range(arcs.shape[0]):
        found.kind[i] = FREE
        if straight[piece[i]]:
            found.kind[i] = STRAIGHT
        elif round_[piece[i]]:
            found.kind[i] = ROUND
        if found.kind[i] != ROUND:
            found.center[i, 0] = found.center[i, 1] = np.nan


@uncounted_as_written
def _find_three(arcs: Floats, piece: Ints, interval: Floats, which: Ints, three: Floats) -> None:
    """Fill three points of each piece, and the arclets that they are on."""
    for i in range(arcs.shape[0]):
        first, last = which[piece[i], 0], which[piece[i], 1]
        if first < 0 or _low(interval, i) < _low(interval, first):
            which[piece[i], 0] = i
        if last < 0 or _high(interval, i) >= _high(interval, last):
            which[piece[i], 1] = i
    for i in range(arcs.shape[0]):
        row = which[piece[i]]
        middle = 0.5 * (_low(interval, row[0]) + _high(interval, row[1]))
        if row[2] < 0 or _away(interval, i, middle) <= _away(interval, row[2], middle):
            row[2] = i
    for p in range(which.shape[0]):
        first, last, between = which[p]
        if first < 0:
            continue
        low, high = _low(interval, between), _high(interval, between)
        middle = 0.5 * (_low(interval, first) + _high(interval, last))
        share = min(max((middle - low) / (high - low), 0.0), 1.0)
        # A point near an end would leave the circle undetermined.
        if not 0.1 < share < 0.9:
            share = 0.5
        # Pieces that run backward have their intervals backward, too.
        at = (0.0, share, 1.0)
        for k in range(3):
            i = (first, between, last)[k]
            turned = interval[i, 0] > interval[i, 1]
            three[p, k, 0], three[p, k, 1] = _point(arcs, i, 1.0 - at[k] if turned else at[k])


@uncounted_as_written
def _low(interval: Floats, i: int) -> float:
    return float(min(interval[i, 0], interval[i, 1]))


@uncounted_as_written
def _high(interval: Floats, i: int) -> float:
    return float(max(interval[i, 0], interval[i, 1]))


@uncounted_as_written
def _away(interval: Floats, i: int, middle: float) -> float:
    return float(abs(0.5 * (_low(interval, i) + _high(interval, i)) - middle))


@uncounted_as_written
def _point(arcs: Floats, i: int, t: float) -> tuple[float, float]:
    """As `point_on`, with sums as they are written."""
    if t == 1.0:
        return arcs[i, 1], arcs[i, 2]
    x = y = 0.0
    for k in range(3 + 2 * int(arcs[i, 0]), 3, -2):
        x, y = (x + arcs[i, k]) * t, (y + arcs[i, k + 1]) * t
    return x + arcs[i, 3], y + arcs[i, 4]


@uncounted_as_written
def _look(
    arcs: Floats,
    i: int,
    three: Floats,
    limits: tuple[float, float],
    found: Kinds,
    straight: Bools,
    round_: Bools,
    p: int,
) -> None:
    """Note whether an arclet is on the line and the circle through three points of its piece."""
    off, flattest = limits
    ax, ay = three[0, 0], three[0, 1]
    long = math.hypot(three[2, 0] - ax, three[2, 1] - ay)
    dx, dy = (three[2, 0] - ax) / long, (three[2, 1] - ay) / long
    x, y = three[1, 0] - ax, three[1, 1] - ay
    mx, my = x * dx + y * dy, dx * y - dy * x
    power = mx * (mx - long) + my * my
    scale = math.hypot(power, my * long)
    for k in range(_LOOKED):
        px, py = _point(arcs, i, k / (_LOOKED - 1))
        px, py = px - ax, py - ay
        x, y = px * dx + py * dy, dx * py - dy * px
        # How far points are off the circle through three others, written without its radius and
        # center, which are lost to rounding where it is flat.
        square = x * (x - long) + y * y
        straight[p] = straight[p] and abs(y) <= off
        round_[p] = round_[p] and abs((my * square - power * y) / scale) <= off
    height = power / (2.0 * my)
    round_[p] = round_[p] and math.hypot(height, 0.5 * long) <= flattest * long
    found.center[i, 0] = 0.5 * (ax + three[2, 0]) - height * dy
    found.center[i, 1] = 0.5 * (ay + three[2, 1]) + height * dx
