"""Bernstein polynomials of arcs: products, ranges of curvature, halves, and how thick arcs are.

Binomial coefficients come as a table, Pascal's triangle (m, m).
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import uncounted_as_written

# Bounds are widened by this share of the largest terms that went into them, against rounding.
SLACK = 1e-12
# Arcs side by side: as many numbers as a processor adds at once.
LANES = 4
_TINY = 2.2250738585072014e-308


@uncounted_as_written
def fill_curvature(control: Floats, d: int, pascal: Floats, room: Floats, ranges: Floats) -> None:
    """Fill least and largest curvature and largest change of it with arc length: ranges (3, 4).

    Of four arcs of degree d side by side, (m, 2, 4), which takes as long as of one. Infinite where
    the speed may vanish. The rows of ``room`` (10, 2 m, 4) are x and y of the first three
    derivatives, two products, and least and largest coefficients.
    """
    _fill_derivatives(control, d, room)
    a, b, c = d - 1, max(d - 2, 0), max(d - 3, 0)
    x, y, x2, y2, x3, y3 = room[0], room[1], room[2], room[3], room[4], room[5]
    # Rows of their own: there is one of each at least, as d is 2 or more.
    large, low, high, most = room[8, 0], room[8, 1], room[9, 0], room[9, 1]
    for n in range(LANES):
        first = second = 0.0
        for k in range(a + 1):
            first = max(first, abs(room[0, k, n]), abs(room[1, k, n]))
        for k in range(b + 1):
            second = max(second, abs(room[2, k, n]), abs(room[3, k, n]))
        large[n] = SLACK * first * second
    for axis in range(2):
        _scale(pascal, room[axis], a)
        _scale(pascal, room[2 + axis], b)
        _scale(pascal, room[4 + axis], c)
    _range(pascal, room, (x, y2, y, x2), -1.0, (a, b), low, high)
    for n in range(LANES):
        ranges[0, n], ranges[1, n] = low[n] - large[n], high[n] + large[n]
    _range(pascal, room, (x, x2, y, y2), 1.0, (a, b), low, high)
    for n in range(LANES):
        cross = max(abs(ranges[0, n]), abs(ranges[1, n]))
        ranges[2, n] = cross * max(abs(low[n]), abs(high[n]))
    _range(pascal, room, (x, y3, y, x3), -1.0, (a, c), low, high)
    for n in range(LANES):
        large[n] = max(abs(low[n]), abs(high[n]))
    _range(pascal, room, (x, x, y, y), 1.0, (a, a), low, most)
    for n in range(LANES):
        speed_low, speed_high = low[n] - SLACK * most[n], most[n] * (1.0 + SLACK)
        if not speed_low > 0.0:
            ranges[0, n], ranges[1, n], ranges[2, n] = -np.inf, np.inf, np.inf
            continue
        slowest, fastest = speed_low**1.5, speed_high**1.5
        # d kappa / dt = (c' x c''') / |c'|^3 - 3 (c' x c'') (c' . c'') / |c'|^5
        change = large[n] * (1.0 + SLACK) / slowest
        change += 3.0 * (1.0 + SLACK) * ranges[2, n] / (slowest * speed_low)
        ranges[0, n] /= slowest if ranges[0, n] < 0.0 else fastest
        ranges[1, n] /= slowest if ranges[1, n] > 0.0 else fastest
        ranges[2, n] = change / math.sqrt(speed_low)


@uncounted_as_written
def _fill_derivatives(control: Floats, d: int, room: Floats) -> None:
    """Fill the control points of the first three derivatives, a point for those that vanish."""
    degree = d
    for order in range(3):
        for axis in range(2):
            row, above = room[2 * order + axis], room[max(2 * order - 2, 0) + axis]
            for k in range(max(degree, 1)):
                for n in range(LANES):
                    if degree == 0:
                        row[k, n] = 0.0
                    elif order == 0:
                        row[k, n] = degree * (control[k + 1, axis, n] - control[k, axis, n])
                    else:
                        row[k, n] = degree * (above[k + 1, n] - above[k, n])
        degree = max(degree - 1, 0)


@uncounted_as_written
def _scale(pascal: Floats, row: Floats, degree: int) -> None:
    for k in range(degree + 1):
        for n in range(LANES):
            row[k, n] = pascal[degree, k] * row[k, n]


@uncounted_as_written
def _range(
    pascal: Floats,
    room: Floats,
    rows: tuple[Floats, Floats, Floats, Floats],
    sign: float,
    degrees: tuple[int, int],
    low: Floats,
    high: Floats,
) -> None:
    """Fill least and largest coefficient of p q + sign r s, of rows scaled by binomials."""
    p, q, r, s = rows
    one, other = room[6], room[7]
    a, b = degrees
    for k in range(a + b + 1):
        for n in range(LANES):
            one[k, n] = other[k, n] = 0.0
    for i in range(a + 1):
        for j in range(b + 1):
            for n in range(LANES):
                one[i + j, n] += p[i, n] * q[j, n]
                other[i + j, n] += r[i, n] * s[j, n]
    for n in range(LANES):
        low[n], high[n] = np.inf, -np.inf
    for k in range(a + b + 1):
        scale = pascal[a + b, k]
        for n in range(LANES):
            value = one[k, n] / scale + sign * (other[k, n] / scale)
            low[n], high[n] = min(low[n], value), max(high[n], value)


@uncounted_as_written
def thickness(control: Floats, d: int) -> float:
    """Largest distance of a control point from the chord's segment."""
    x, y = control[0, 0], control[0, 1]
    cx, cy = control[d, 0] - x, control[d, 1] - y
    squared = max(cx * cx + cy * cy, _TINY)
    result = 0.0
    for k in range(d + 1):
        ox, oy = control[k, 0] - x, control[k, 1] - y
        share = min(max((ox * cx + oy * cy) / squared, 0.0), 1.0)
        result = max(result, math.hypot(ox - share * cx, oy - share * cy))
    return result


@uncounted_as_written
def split(whole: Floats, d: int, t: float, first: Floats, second: Floats) -> None:
    """Fill both parts of an arc by de Casteljau; the second may take the place of the whole."""
    for k in range(d + 1):
        for axis in range(2):
            second[k, axis] = whole[k, axis]
    for k in range(d + 1):
        for axis in range(2):
            first[k, axis] = second[0, axis]
            # The ones from d - k on are done, and are those of the second part.
            for j in range(d - k):
                second[j, axis] = (1.0 - t) * second[j, axis] + t * second[j + 1, axis]


@uncounted_as_written
def extent(control: Floats, d: int) -> float:
    """The larger side of the box of the control points."""
    result = 0.0
    for axis in range(2):
        low, high = control[0, axis], control[0, axis]
        for k in range(1, d + 1):
            low, high = min(low, control[k, axis]), max(high, control[k, axis])
        result = max(result, high - low)
    return result
