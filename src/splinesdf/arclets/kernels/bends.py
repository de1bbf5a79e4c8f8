"""How arclets bend: the rows of `Bends`, see `splinesdf.arclets.curvature`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.kernels.bernstein import LANES, SLACK, fill_curvature, thickness
from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import kernel_as_written, uncounted_as_written


class Bending(NamedTuple):
    """What bounds of curvature are made by."""

    pascal: Floats  # (m, m) binomial coefficients
    least: Floats  # (n,) speed at an end below which nothing is claimed
    grain: float  # rounding in points of the curve


class _Room(NamedTuple):
    control: Floats  # (m, 2) points of an arclet
    parts: Floats  # (m, 2, 4) of equal parts of it, which are bounded one by one
    rows: Floats  # (10, 2 m, 4), see `fill_curvature`
    ranges: Floats  # (3, 4)


@kernel_as_written
def fill_bends(arcs: Floats, bending: Bending, rows: Floats, second: Floats) -> None:
    """Fill the rows (n, 11) and second differences (n, 5, k) of `Bends`, from `Arclets.arcs`."""
    m = arcs.shape[1] // 8
    room = _Room(
        np.empty((m, 2)),
        np.empty((m, 2, LANES)),
        np.empty((10, 2 * m, LANES)),
        np.empty((3, LANES)),
    )
    _fill_bends(arcs, bending, room, rows, second)


@uncounted_as_written
def _fill_bends(arcs: Floats, bending: Bending, room: _Room, rows: Floats, second: Floats) -> None:
    for i in range(arcs.shape[0]):
        d = int(arcs[i, 0])
        _fill_control(arcs[i], d, bending.pascal, room.control)
        slowest = _fill_tangents(arcs[i], d, rows[i])
        for k in range(5):
            rows[i, k] = 0.0
        if slowest < bending.least[i] or (d > 1 and not _fill_curvature(d, bending, room, rows[i])):
            rows[i, 0] = -np.inf
            rows[i, 1] = rows[i, 2] = rows[i, 3] = rows[i, 4] = np.inf
        fastest = 0.0
        for k in range(d):
            x = d * (room.control[k + 1, 0] - room.control[k, 0])
            y = d * (room.control[k + 1, 1] - room.control[k, 1])
            fastest = max(fastest, math.hypot(x, y))
        rows[i, 9] = fastest * (1.0 + SLACK)
        rows[i, 10] = thickness(room.control, d) * (1.0 + SLACK) + bending.grain
        _fill_second(arcs[i], d, second[i])


@uncounted_as_written
def _fill_control(arc: Floats, d: int, pascal: Floats, control: Floats) -> None:
    """Fill the control points of an arclet less its start, from its powers."""
    for axis in range(2):
        control[0, axis] = 0.0
        for k in range(1, d + 1):
            control[k, axis] = 0.0
            for j in range(1, k + 1):
                control[k, axis] += pascal[k, j] / pascal[d, j] * arc[3 + 2 * j + axis]


@uncounted_as_written
def _fill_tangents(arc: Floats, d: int, row: Floats) -> float:
    """Fill unit tangents at both ends; the smaller one of the speeds there."""
    slowest = np.inf
    for end in range(2):
        x = y = 0.0
        for k in range(d, 0, -1):
            x, y = x * end + k * arc[3 + 2 * k], y * end + k * arc[4 + 2 * k]
        slowest = min(slowest, math.hypot(x, y))
        if x == 0.0 and y == 0.0:
            x, y = arc[1] - arc[3], arc[2] - arc[4]
        length = math.hypot(x, y)
        row[5 + 2 * end], row[6 + 2 * end] = x / length, y / length
    return slowest


@uncounted_as_written
def _fill_curvature(d: int, bending: Bending, room: _Room, row: Floats) -> bool:
    """Fill the range of curvature and what it is at both ends; False if that is not finite."""
    control = room.control
    _fill_parts(control, d, room.parts)
    fill_curvature(room.parts, d, bending.pascal, room.rows, room.ranges)
    row[0], row[1] = np.inf, -np.inf
    for n in range(LANES):
        row[0], row[1] = min(row[0], room.ranges[0, n]), max(row[1], room.ranges[1, n])
        row[2] = max(row[2], room.ranges[2, n])
    for end in range(2):
        a, b, c = (0, 1, 2) if end == 0 else (d, d - 1, d - 2)
        x, y = d * (control[b, 0] - control[a, 0]), d * (control[b, 1] - control[a, 1])
        twice = d * (d - 1)
        u = twice * (control[c, 0] - 2.0 * control[b, 0] + control[a, 0])
        v = twice * (control[c, 1] - 2.0 * control[b, 1] + control[a, 1])
        value = (x * v - y * u) / math.hypot(x, y) ** 3
        # Backward the curve bends to the other side.
        row[3 + end] = value if end == 0 else -value
    largest = max(abs(row[0]), abs(row[1]), abs(row[2]))
    return bool(largest < np.inf and abs(row[3]) < np.inf and abs(row[4]) < np.inf)


@uncounted_as_written
def _fill_parts(control: Floats, d: int, parts: Floats) -> None:
    """Fill equal parts of an arc, by de Casteljau at their ends."""
    for axis in range(2):
        for j in range(d + 1):
            for n in range(LANES):
                parts[j, axis, n] = control[j, axis]
        for k in range(1, d + 1):
            for j in range(d, k - 1, -1):
                for n in range(LANES):
                    t = (n + 1) / LANES
                    before = parts[j - 1, axis, n]
                    parts[j, axis, n] = (1.0 - t) * before + t * parts[j, axis, n]
        for k in range(1, d + 1):
            for j in range(d + 1 - k):
                for n in range(LANES):
                    t = n / (n + 1)
                    after = parts[j + 1, axis, n]
                    parts[j, axis, n] = (1.0 - t) * parts[j, axis, n] + t * after


@uncounted_as_written
def _fill_second(arc: Floats, d: int, second: Floats) -> None:
    """Fill second differences of the coefficients of x, of y, and of squares, see `Bends`."""
    width = second.shape[1]
    count = 2 * d + 1
    for k in range(width):
        second[0, k] = np.inf
        second[1, k] = second[2, k] = second[3, k] = second[4, k] = 0.0
    if d == 1:
        return
    begin = 5 + 2 * d
    for k in range(width):
        second[4, k] = arc[begin + 3 * count - 1]
    for k in range(count - 2):
        for row in range(3):
            at = begin + row * count + k
            value = (arc[at + 2] - arc[at + 1]) - (arc[at + 1] - arc[at])
            second[(row + 1) % 3, k] = value
        second[3, k] = abs(second[1, k]) + abs(second[2, k])
