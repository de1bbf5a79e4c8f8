"""How the distance to an arclet changes along a stretch of a parallel, against the offset's own.

The gap, that distance less |d|, has a known value and slope in the middle of the stretch, and its
second derivative has a known range, from those of both curvatures. That proves the gap positive,
or not, or monotone: then it passes zero once, and where is found by iteration.

Used by `trim`.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.arclet import point_on
from splinesdf.arclets.kernels.nearest import closest_on
from splinesdf.arclets.tables import Scratch
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import uncounted
from splinesdf.offsets.kernels.parallels import parallel_point
from splinesdf.offsets.tables import Parallels, Walls

# A point this share of its distance beside the end of an arclet, or more, stays on that side where
# the second derivative of its distance is bounded, as it moves by less than half of its distance.
_BESIDE = 0.7
# Steps to where the offset is left. Bisection alone would need 53; the secants need about 8.
_STEPS = 80


@uncounted
def clip(
    parallels: Parallels,
    walls: Walls,
    stretch: tuple[tuple[int, int], float, float, float],
    listed: tuple[int, int, int],
    near: Ints,
    scratch: Scratch,
) -> tuple[float, float, int, bool]:
    """Cut off what some arclet is surely nearer to; list those of which nothing is proved.

    Returns
    -------
    low, high : float
        What is left of the stretch as far as is known.
    left : int
        How many arclets are not done with; they stand in ``near`` from ``listed[2]`` on.
    gone : bool
        Nothing is left.
    """
    element, a, b, reach = stretch
    base, number, top = listed
    arcs = walls.arcs
    distance = parallels.distance
    radius = abs(distance)
    m = 0.5 * (a + b)
    x, y, tx, ty, _, bend = parallel_point(parallels, element, m)
    low, high = a, b
    left = 0
    # A stretch that turns by at most half a turn is at most this much longer than its chords.
    length = 1.12 * reach
    least, most = bend_range(walls.bends, distance, element, bend, b - a)
    for k in range(number):
        j = near[base + k]
        squared, t = closest_on(arcs, j, x, y, (radius + reach) ** 2, scratch)
        far = math.sqrt(squared)
        if not far < radius + reach:
            continue
        if far + reach <= radius:
            return a, b, 0, True
        px, py = point_on(arcs, j, t)
        gx, gy = (x - px) / far, (y - py) / far
        gap = far - radius - _grain(walls, element, j)
        slope = gx * tx + gy * ty
        under, over, slack = _second_range(
            walls.bends[j], (far, gx, gy, t), (tx, ty, least, most), length
        )
        if gap + abs(slope) * length + 0.5 * max(over, 0.0) * length * length <= 0.0:
            return a, b, 0, True
        if gap <= 0.0 and _stays_nearer(
            arcs,
            walls.bends[j],
            j,
            (far, gx, gy, t),
            (tx, ty, least, most),
            (gap, slope),
            length,
        ):
            return a, b, 0, True
        bent = max(abs(least), abs(most))
        if gap <= 0.0 and is_nearer_at_its_ends(
            parallels, walls, (element, a, b), j, (bent, length), scratch
        ):
            return a, b, 0, True
        steepest = abs(slope) + slack
        lowest = gap - steepest * length + 0.5 * min(under, 0.0) * length * length
        if under > 0.0 and steepest < under * length:
            lowest = gap - 0.5 * steepest * steepest / under
        if lowest > 0.0:
            continue
        if abs(slope) > slack + max(abs(under), abs(over)) * length:
            at_a = clearance_at(parallels, walls, element, j, a, scratch)
            at_b = clearance_at(parallels, walls, element, j, b, scratch)
            if at_a <= 0.0 and at_b <= 0.0:
                return a, b, 0, True
            if at_a < 0.0 < at_b:
                low = max(low, _passes(parallels, walls, element, j, (a, b), scratch))
                continue
            if at_b < 0.0 < at_a:
                high = min(high, _passes(parallels, walls, element, j, (b, a), scratch))
                continue
            if at_a > 0.0 and at_b > 0.0:
                continue
        near[top + left] = j
        left += 1
    return low, high, left, not low < high


@uncounted
def _stays_nearer(
    arcs: Floats,
    row: Floats,
    j: int,
    foot: tuple[float, float, float, float],
    along: tuple[float, float, float, float],
    now: tuple[float, float],
    length: float,
) -> bool:
    """Whether the gap to an arclet stays below zero, as its foot stays within the arclet.

    As in `_second_range`, but with the largest curvature of the wall's own distance instead of that
    of a point's. Walls just twice the distance apart have a gap of a few roundings all along: the
    point's would halve them into a million stretches.
    """
    far, gx, gy, t = foot
    tx, ty, least, most = along
    gap, slope = now
    vx, vy = row[5] + row[7], row[6] + row[8]
    right = gx * vy - gy * vx
    if abs(right) <= _BESIDE * math.sqrt(vx * vx + vy * vy) or far <= 2.0 * length:
        return False
    low, high = (row[0], row[1]) if right > 0.0 else (-row[1], -row[0])
    if not (-np.inf < min(low, least) and max(high, most) < np.inf):
        return False
    # The foot moves by no more than this, and its way to an end is no shorter than the chord.
    width = 1.0 + min(low * (far + length), 0.0)
    if width <= 0.0:
        return False
    travel = length / width
    px, py = point_on(arcs, j, t)
    for k in (1, 3):
        if math.sqrt((px - arcs[j, k]) ** 2 + (py - arcs[j, k + 1]) ** 2) <= travel:
            return False
    side = gy * tx - gx * ty
    straight, bend = (least, most) if side > 0.0 else (-most, -least)
    # |g.n| is between u and 1, and the distance changes by no more than ``change``. Where wall and
    # stretch turn about one center both hardly change, as the first round shows the second.
    u, change = 0.0, length
    over = np.inf
    for _ in range(2):
        # Curvatures of the wall's level sets are kappa / (1 + kappa far): increasing with kappa,
        # decreasing with the distance.
        h_low = low / (1.0 + low * (far + change))
        h_high = high / (1.0 + high * (far - change))
        # T turns against g by k + h (g.n).
        turn = max(bend + max(h_high * u, h_high), -straight - min(h_low * u, h_low)) * length
        u = abs(side) * (1.0 - 0.5 * turn * turn) - abs(slope) * turn
        if u <= 0.0:
            return False
        over, under = _largest(h_high, bend, u), _largest(-h_low, -straight, u)
        change = abs(slope) * length + 0.5 * max(over, under, 0.0) * length * length
        change = min(change, length)
    return bool(gap + abs(slope) * length + 0.5 * max(over, 0.0) * length * length <= 0.0)


@uncounted
def is_nearer_at_its_ends(
    parallels: Parallels,
    walls: Walls,
    stretch: tuple[tuple[int, int], float, float],
    j: int,
    bounds: tuple[float, float],
    scratch: Scratch,
) -> bool:
    """Whether the gap to an arclet is below zero at both ends, by more than between them.

    Chord of the stretch and chord of the arclet between the ends' feet are nowhere farther apart
    than at their ends, and either curve is no farther from its chord than the eighth of its
    curvature times its length squared.
    """
    element, a, b = stretch
    bend, length = bounds
    row = walls.bends[j]
    other = max(abs(row[0]), abs(row[1]))
    if not (bend < np.inf and other < np.inf):
        return False
    x, y, _, _, _, _ = parallel_point(parallels, element, a)
    squared, t = closest_on(walls.arcs, j, x, y, np.inf, scratch)
    px, py = point_on(walls.arcs, j, t)
    far = math.sqrt(squared)
    x, y, _, _, _, _ = parallel_point(parallels, element, b)
    squared, t = closest_on(walls.arcs, j, x, y, np.inf, scratch)
    qx, qy = point_on(walls.arcs, j, t)
    far = max(far, math.sqrt(squared))
    # An arclet turns by so little that it is at most a fifth longer than its chord.
    across = 0.125 * other * 1.44 * ((qx - px) ** 2 + (qy - py) ** 2)
    gap = far - abs(parallels.distance) - _grain(walls, element, j)
    return bool(gap + across + 0.5 * bend * length * length <= 0.0)


@uncounted
def _largest(a: float, b: float, low: float) -> float:
    """The largest value of a x^2 + b x for x from ``low`` to 1."""
    result = max(a * low * low + b * low, a + b)
    if a < 0.0 and -2.0 * a * low < b < -2.0 * a:
        result = max(result, -0.25 * b * b / a)
    return result


@uncounted
def bend_range(
    bends: Floats, d: float, element: tuple[int, int], bend: float, width: float
) -> tuple[float, float]:
    """The range of the curvature of a stretch at d, of which that in the middle is ``bend``.

    It increases with the curvature kappa of the arclet: kappa / (1 + kappa d).
    """
    i, corner = element
    if corner:
        return bend, bend
    low, high = bends[i, 0], bends[i, 1]
    middle = bend / (1.0 - bend * d)
    change = 0.5 * width * bends[i, 9] * bends[i, 2]
    if change < np.inf and middle == middle:
        low, high = max(low, middle - change), min(high, middle + change)
    if 1.0 + low * d > 0.0 and 1.0 + high * d > 0.0:
        return low / (1.0 + low * d), high / (1.0 + high * d)
    return -np.inf, np.inf


@uncounted
def _second_range(
    row: Floats,
    foot: tuple[float, float, float, float],
    along: tuple[float, float, float, float],
    length: float,
) -> tuple[float, float, float]:
    """The range of the second derivative of the distance to an arclet along a stretch.

    With h the curvature of the distance's level sets, g its gradient, T and n tangent and left
    normal of the stretch, k its curvature: h (1 - (g.T)^2) + k (g.n). If h has no lower bound,
    that of the distance to any one point of the arclet, for which h >= 0, and by how much the
    slope toward that may differ from g.T.
    """
    far, gx, gy, _ = foot
    tx, ty, least, most = along
    if not (-np.inf < least and most < np.inf):
        return -np.inf, np.inf, 0.0
    if far <= 2.0 * length:
        # It may pass the arclet, in any direction.
        h_low = min(row[0], -row[1], 0.0)
        width = 1.0 + h_low * (far + length)
        under = h_low / width - max(abs(least), abs(most)) if width > 0.0 else -np.inf
        return under, np.inf, 0.0
    # how much the angle between g and T changes
    change = length / (far - length) + max(abs(least), abs(most)) * length
    across, side = abs(gx * ty - gy * tx), gy * tx - gx * ty
    square_low = max(across - change, 0.0) ** 2
    square_high = min(across + change, 1.0) ** 2
    side_low, side_high = max(side - change, -1.0), min(side + change, 1.0)
    h_low, slack = _least_bend(row, foot, length), 0.0
    if h_low == -np.inf:
        h_low, slack = 0.0, row[9] / far
    # The distance to a set bends by no more than that to a point.
    over = square_high / (far - length)
    over += max(max(least * side_low, least * side_high), max(most * side_low, most * side_high))
    under = h_low * (square_high if h_low < 0.0 else square_low)
    under += min(min(least * side_low, least * side_high), min(most * side_low, most * side_high))
    return under, over, slack


@uncounted
def _least_bend(row: Floats, foot: tuple[float, float, float, float], length: float) -> float:
    """A lower bound, not above 0, of the curvature of an arclet's distance within ``length``."""
    far, gx, gy, t = foot
    # Curvature toward the point is positive on the right of the arclet.
    dx, dy = row[5] + row[7], row[6] + row[8]
    if t <= 0.0:
        dx, dy = row[5], row[6]
    elif t >= 1.0:
        dx, dy = row[7], row[8]
    right = gx * dy - gy * dx
    if abs(right) > _BESIDE * math.sqrt(dx * dx + dy * dy):
        least = row[0] if right > 0.0 else -row[1]
    else:
        # The foot is an end, and the point ahead of it: those of neighbors may be on both sides.
        least = min(row[0], -row[1])
    if least >= 0.0:
        return 0.0
    width = 1.0 + least * (far + length)
    return least / width if width > 0.0 else -np.inf


@uncounted
def clearance_at(
    parallels: Parallels,
    walls: Walls,
    element: tuple[int, int],
    j: int,
    t: float,
    scratch: Scratch,
) -> float:
    """How much farther than |d| the arclet j is from a point of the parallel."""
    point = parallel_point(parallels, element, t)
    squared, _ = closest_on(walls.arcs, j, point[0], point[1], np.inf, scratch)
    far = math.sqrt(squared)
    return far - abs(parallels.distance) - _grain(walls, element, j)


@uncounted
def _grain(walls: Walls, element: tuple[int, int], j: int) -> float:
    """By how much an arclet may be farther than the distance and still count as nearer.

    One that meets the element's arclet in a point is as near as that point, no nearer: what decides
    there is which branches bound which wedge, see `splinesdf.arclets.vertices`.
    """
    i, corner = element
    touch = walls.touch
    for end in range(corner, 2):
        v = touch[i, end]
        if v >= 0 and (touch[j, 0] == v or touch[j, 1] == v):
            return -walls.grain
    return walls.grain


@uncounted
def _passes(
    parallels: Parallels,
    walls: Walls,
    element: tuple[int, int],
    j: int,
    ends: tuple[float, float],
    scratch: Scratch,
) -> float:
    """Where the gap to arclet j, below zero at the first end, is zero: secants in a bracket."""
    low, high = ends
    f_low = clearance_at(parallels, walls, element, j, low, scratch)
    f_high = clearance_at(parallels, walls, element, j, high, scratch)
    side = 0
    t = high
    for step in range(_STEPS):
        t = low - f_low * (high - low) / (f_high - f_low)
        # every fourth step halves, so that the bracket shrinks whatever the function
        if step % 4 == 3 or not min(low, high) < t < max(low, high):
            t = 0.5 * (low + high)
        if t in (low, high):
            break
        f = clearance_at(parallels, walls, element, j, t, scratch)
        if f == 0.0:
            break
        # Illinois: an end that stays loses half of its weight
        if f < 0.0:
            low, f_low = t, f
            f_high = 0.5 * f_high if side < 0 else f_high
            side = -1
        else:
            high, f_high = t, f
            f_low = 0.5 * f_low if side > 0 else f_low
            side = 1
    return t
