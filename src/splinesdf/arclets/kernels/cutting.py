"""Pieces cut into arclets: where x or y turns first, then in halves until they are thin.

An arc waits on a stack with the stage that it is in: its x, and then its y, is made monotone; what
lies within rounding of a cusp is left out; and it is halved while it bulges or bends too much.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.kernels.bernstein import (
    LANES,
    extent,
    fill_curvature,
    split,
    thickness,
)
from splinesdf.arclets.tables import Arcs
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel_as_written, uncounted_as_written

# Stages of an arc, beside those of x (0) and y (1): past all turns.
_MONOTONE = 2
# Halvings to where a coordinate turns.
_BISECTIONS = 54
# Arcs that wait: one a halving. Each stage halves about as often as a number has bits.
_WAITING = 256


class Cutting(NamedTuple):
    """What pieces are cut by, see `splinesdf.arclets.cutting` for all limits."""

    pascal: Floats  # (m, m) binomial coefficients
    noise: Floats  # (m,) by degree: steps that are rounding
    bulge: float
    bent: float
    halvings: int
    smallest: float  # a share of the piece
    lost: float  # a length


class Pieces(NamedTuple):
    """Pieces of any degree, one after the other."""

    control: Floats  # (n_control, 2)
    starts: Ints  # (n_pieces + 1,)
    origin: Floats  # (2,)


class Cut(NamedTuple):
    """Arcs, as the kernel fills them in, piece after piece."""

    arcs: Arcs
    total: Ints  # (1,) how many there are, even if there is no room for all


class _Waiting(NamedTuple):
    """Arcs on the stack; the one at the top is being cut."""

    control: Floats  # (n, m, 2)
    start: Floats  # (n, 2)
    interval: Floats  # (n, 2)
    stage: Ints  # (n, 2) and how often it was halved


class _Room(NamedTuple):
    halves: Floats  # (2, m, 2)
    steps: Floats  # (2, m)
    lanes: Floats  # (m, 2, 4) an arc in the first of four, the others zero
    rows: Floats  # (10, 2 m, 4), see `fill_curvature`
    ranges: Floats  # (3, 4)


@kernel_as_written
def cut_pieces(pieces: Pieces, cutting: Cutting, found: Cut) -> None:
    """Fill the arcs into which pieces are cut, piece after piece."""
    m = found.arcs.control.shape[1]
    waiting = _Waiting(
        np.empty((_WAITING, m, 2)),
        np.empty((_WAITING, 2)),
        np.empty((_WAITING, 2)),
        np.empty((_WAITING, 2), dtype=np.int64),
    )
    room = _Room(
        np.empty((2, m, 2)),
        np.empty((2, m)),
        np.zeros((m, 2, LANES)),
        np.empty((10, 2 * m, LANES)),
        np.empty((3, LANES)),
    )
    _cut_pieces(pieces, cutting, waiting, room, found)


@uncounted_as_written
def _cut_pieces(
    pieces: Pieces,
    cutting: Cutting,
    waiting: _Waiting,
    room: _Room,
    found: Cut,
) -> None:
    # Not literals, for which what is called would be compiled by itself.
    bottom, one = int(np.int64(0)), int(np.int64(1))
    for piece in range(pieces.starts.shape[0] - 1):
        first = pieces.starts[piece]
        d = pieces.starts[piece + 1] - first - 1
        for axis in range(2):
            for k in range(d + 1):
                waiting.control[0, k, axis] = pieces.control[first + k, axis]
            waiting.start[0, axis] = pieces.control[first, axis] - pieces.origin[axis]
            waiting.interval[0, axis] = float(axis)
        if d == 1:
            _keep(waiting, bottom, d, piece, found)
            continue
        own = extent(waiting.control[0], d)
        _near_slow_end(waiting.control[0], d)
        waiting.stage[0, 0] = waiting.stage[0, 1] = 0
        size = one
        while size > 0:
            size = _cut_one(waiting, size, (d, piece, own), cutting, room, found)


@uncounted_as_written
def _cut_one(
    waiting: _Waiting,
    size: int,
    of: tuple[int, int, float],
    cutting: Cutting,
    room: _Room,
    found: Cut,
) -> int:
    """Take one step with the arc at the top of the stack; how many wait now."""
    d, piece, own = of
    top = size - 1
    noise = cutting.noise[d]
    control, interval, stage = waiting.control[top], waiting.interval[top], waiting.stage[top]
    full = size + 1 >= _WAITING
    while stage[0] < _MONOTONE:
        turns = _turns(control, stage[0], d, noise)
        if turns > 1 and not full:
            return _halve(waiting, top, d, 0.5, room.halves)
        if turns == 1 and not full:
            t = _turn(control, stage[0], d, noise, room.steps)
            split(control, d, t, room.halves[0], room.halves[1])
            stage[0] += 1
            # A turn beside an end, where a formula's pieces begin, is rounding in where it is: the
            # coordinate does not change between them, and the speck would have no direction.
            axis = stage[0] - 1
            if (
                _change(room.halves[0], axis, d) > noise
                and _change(room.halves[1], axis, d) > noise
            ):
                return _halve(waiting, top, d, t, room.halves)
        else:
            stage[0] += 1
    if stage[0] == _MONOTONE:
        # Two turns in one place, as in a cusp, leave a part between them that is all rounding.
        whole = interval[0] == 0.0 and interval[1] == 1.0
        if not whole and not extent(control, d) > noise:
            return top
        # A cusp inside a piece is an end by now.
        _near_slow_end(control, d)
        stage[0] += 1
    if stage[1] < cutting.halvings and not full:
        size_of = extent(control, d)
        if size_of > max(cutting.smallest * own, cutting.lost) and _is_thick(
            control, d, cutting, room
        ):
            stage[1] += 1
            return _halve(waiting, top, d, 0.5, room.halves)
    _keep(waiting, top, d, piece, found)
    return top


@uncounted_as_written
def _halve(waiting: _Waiting, top: int, d: int, t: float, halves: Floats) -> int:
    """Put both parts of the arc at the top in its place, the first one on top; how many wait."""
    low, high = waiting.interval[top, 0], waiting.interval[top, 1]
    middle = low + t * (high - low)
    split(waiting.control[top], d, t, halves[0], halves[1])
    for axis in range(2):
        for k in range(d + 1):
            waiting.control[top, k, axis] = halves[1, k, axis]
            waiting.control[top + 1, k, axis] = halves[0, k, axis]
        waiting.start[top + 1, axis] = waiting.start[top, axis]
        waiting.start[top, axis] += halves[1, 0, axis] - halves[0, 0, axis]
        waiting.stage[top + 1, axis] = waiting.stage[top, axis]
    waiting.interval[top, 0], waiting.interval[top, 1] = middle, high
    waiting.interval[top + 1, 0], waiting.interval[top + 1, 1] = low, middle
    return top + 2


@uncounted_as_written
def _keep(waiting: _Waiting, top: int, d: int, piece: int, found: Cut) -> None:
    """Append the arc at the top."""
    arcs, count = found.arcs, found.total[0]
    if count < arcs.degree.shape[0]:
        for axis in range(2):
            for k in range(d + 1):
                arcs.control[count, k, axis] = waiting.control[top, k, axis]
            arcs.start[count, axis] = waiting.start[top, axis]
            arcs.interval[count, axis] = waiting.interval[top, axis]
        arcs.degree[count], arcs.piece[count] = d, piece
    found.total[0] = count + 1


@uncounted_as_written
def _near_slow_end(control: Floats, d: int) -> None:
    """Take the end at which an arc is slower, and has its cusp if it has one, from its points."""
    first = max(abs(control[0, 0] - control[1, 0]), abs(control[0, 1] - control[1, 1]))
    last = max(abs(control[d, 0] - control[d - 1, 0]), abs(control[d, 1] - control[d - 1, 1]))
    for axis in range(2):
        end = control[0, axis] if first <= last else control[d, axis]
        for k in range(d + 1):
            control[k, axis] -= end


@uncounted_as_written
def _turns(control: Floats, axis: int, d: int, noise: float) -> int:
    """Sign changes of the steps of one coordinate, steps that are rounding passed over."""
    count = 0
    last = 0.0
    for k in range(d):
        step = control[k + 1, axis] - control[k, axis]
        if abs(step) > noise:
            if step * last < 0.0:
                count += 1
            last = 1.0 if step > 0.0 else -1.0
    return count


@uncounted_as_written
def _change(control: Floats, axis: int, d: int) -> float:
    """How far one coordinate reaches."""
    low, high = control[0, axis], control[0, axis]
    for k in range(1, d + 1):
        low, high = min(low, control[k, axis]), max(high, control[k, axis])
    return float(high - low)


@uncounted_as_written
def _turn(control: Floats, axis: int, d: int, noise: float, room: Floats) -> float:
    """Where a coordinate turns whose steps have exactly one sign change, by bisection."""
    rising = False
    for k in range(d - 1, -1, -1):
        step = control[k + 1, axis] - control[k, axis]
        room[0, k] = step if abs(step) > noise else 0.0
        if room[0, k] != 0.0:
            rising = room[0, k] < 0.0
    low, high = 0.0, 1.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        for k in range(d):
            room[1, k] = room[0, k]
        for k in range(d - 1, 0, -1):
            for j in range(k):
                room[1, j] = (1.0 - middle) * room[1, j] + middle * room[1, j + 1]
        if (room[1, 0] < 0.0) == rising:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@uncounted_as_written
def _is_thick(control: Floats, d: int, cutting: Cutting, room: _Room) -> bool:
    """Whether an arc bulges or bends too much for its chord's length."""
    length = math.hypot(control[d, 0] - control[0, 0], control[d, 1] - control[0, 1])
    # One that comes back to its start is bent, however long.
    if not length > 0.0 or thickness(control, d) / length > cutting.bulge:
        return True
    for axis in range(2):
        for k in range(d + 1):
            room.lanes[k, axis, 0] = control[k, axis]
    fill_curvature(room.lanes, d, cutting.pascal, room.rows, room.ranges)
    return bool(max(room.ranges[1, 0], -room.ranges[0, 0]) * length > cutting.bent)
