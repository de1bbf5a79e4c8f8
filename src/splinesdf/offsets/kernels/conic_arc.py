"""One conic arc in place of a part of a run of parallels: tangents kept, the deviation measured.

A conic with given ends and tangents has one number left, the weight of its middle control point;
with the curve's point nearest to that control point, it is determined:

    q = a P0 + b P1 + c P2, a + b + c = 1   lies on it if   b^2 = 4 w^2 a c

and any other point is off it by about |b^2 - 4 w^2 a c| over the length of that function's
gradient. The error falls with the fifth power of the length.

Used by `conic_fit`.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import uncounted
from splinesdf.offsets.kernels.parallels import parallel_point
from splinesdf.offsets.tables import Parallels, Path

# An arc turns by no more than this (radians). Larger: weights near zero, control points far off.
_TURN = 1.9
# Points of the curve at which an arc is measured, at least this many, and on each element.
_POINTS, _POINTS_EACH = 10, 3
# The longest step between them, as a share of the chord.
_STRIDE = 0.15
# A curve that is longer than so many chords is no arc that turns by less than `_TURN`, which is at
# most 1.72 of them: the sides of its triangle.
_LONGEST = 1.8
# Between those points the error may be this much larger.
_SAFE = 0.9
# Where a run bends by less than this (radians) from end to end it is straight: rounding decides
# where its tangents meet.
_FLAT = 1e-11


@uncounted
def run_point(
    parallels: Parallels, path: Path, place: float
) -> tuple[float, float, float, float, float, float]:
    """Point, tangent, speed and bend of a run at element + share of its span."""
    k = int(place)
    share = place - k
    if share == 0.0 and k > 0:
        # The end of the element before it: joints are smooth.
        k, share = k - 1, 1.0
    low, high = path.spans[k, 0], path.spans[k, 1]
    t = high if share == 1.0 else low + share * (high - low)
    element = (path.elements[k, 0], path.elements[k, 1])
    x, y, tx, ty, speed, bend = parallel_point(parallels, element, t)
    if element[1] == 0 and t in (0.0, 1.0):
        # The tangent that the neighbor has, too.
        side = 2 * int(t)
        tx, ty = parallels.tangents[element[0], side], parallels.tangents[element[0], side + 1]
    return x, y, tx, ty, speed * (high - low), bend


@uncounted
def conic_arc(
    parallels: Parallels,
    path: Path,
    span: tuple[float, float],
    ends: tuple[tuple[float, float, float, float], tuple[float, float, float, float]],
    tolerance: float,
    finer: float,
    points: Floats,
) -> tuple[float, float, float, float]:
    """How far one conic is off a part of a run; its middle control point and weight.

    Parameters
    ----------
    parallels : Parallels
    path : Path
        The run.
    span : tuple of float
        The places between which a conic is wanted.
    ends : tuple
        Point and unit tangent at both.
    tolerance : float
    finer : float
        How many times as many points as at least are looked at.
    points : ndarray, shape (room, 2)
        Room for them.

    Returns
    -------
    off : float
        As a share of what is allowed: it does if that is 1 or less. Infinite if there is no such
        conic.
    x, y, weight : float
    """
    limit = _SAFE * tolerance
    ax, ay, ux, uy = ends[0]
    bx, by, vx, vy = ends[1]
    cx, cy = bx - ax, by - ay
    cross = ux * vy - uy * vx
    turn = math.atan2(cross, ux * vx + uy * vy)
    chord = math.sqrt(cx * cx + cy * cy)
    nothing = (np.inf, 0.0, 0.0, 0.0)
    if abs(turn) > _TURN or chord == 0.0:
        return nothing
    count = look(parallels, path, span, (ax, ay), finer, chord, points)
    if count < 0:
        return nothing
    worst = 0.0
    if abs(turn) <= _FLAT:
        worst = abs(cx * uy - cy * ux)
        for k in range(count):
            worst = max(worst, abs((points[k, 0] - ax) * cy - (points[k, 1] - ay) * cx) / chord)
        return worst / limit, 0.5 * (ax + bx), 0.5 * (ay + by), 1.0
    early, late = (cx * vy - cy * vx) / cross, (ux * cy - uy * cx) / cross
    if not (early > 0.0 and late > 0.0):
        return nothing
    triangle = (ax, ay, early * ux, early * uy, cx, cy)
    # The weight, by the point that is nearest to P1.
    most = square = 0.0
    for k in range(count):
        a, b, c = _barycentric(triangle, points[k, 0], points[k, 1])
        if b > most and a > 0.0 and c > 0.0:
            most = b
            square = b * b / (4.0 * a * c)
    if not square > 0.0:
        return nothing
    for k in range(count - 1):
        off = _off(triangle, square, points[k, 0], points[k, 1])
        if off != off:
            return nothing
        worst = max(worst, off)
    return worst / limit, ax + early * ux, ay + early * uy, math.sqrt(square)


@uncounted
def look(
    parallels: Parallels,
    path: Path,
    span: tuple[float, float],
    start: tuple[float, float],
    finer: float,
    chord: float,
    points: Floats,
) -> int:
    """Fill points of a part of a run, the last one its end; how many, -1 if it is far too long.

    Where a short arclet turns fast its parallel is long, so that steps are bounded along both.
    """
    place, high = span
    x, y = start
    each = math.ceil(high) - int(place)
    step = (high - place) / (finer * max(_POINTS, _POINTS_EACH * each))
    longest = _STRIDE * chord / finer
    count = 0
    length_so_far = 0.0
    while place < high:
        if count == points.shape[0] or length_so_far > _LONGEST * chord:
            return -1
        length = step
        while True:
            at = min(place + length, high)
            if high - at < 0.01 * length:
                at = high
            row = run_point(parallels, path, at)
            if math.hypot(row[0] - x, row[1] - y) <= longest or place + 0.5 * length <= place:
                break
            length = 0.5 * length
        length_so_far += math.hypot(row[0] - x, row[1] - y)
        place, x, y = at, row[0], row[1]
        points[count, 0], points[count, 1] = x, y
        count += 1
    return count


@uncounted
def _barycentric(
    triangle: tuple[float, float, float, float, float, float], x: float, y: float
) -> tuple[float, float, float]:
    """The shares a, b, c of P0, P1, P2 in a point; a triangle is P0, P1 - P0, P2 - P0."""
    ax, ay, ex, ey, cx, cy = triangle
    area = ex * cy - ey * cx
    qx, qy = x - ax, y - ay
    b = (qx * cy - qy * cx) / area
    c = (ex * qy - ey * qx) / area
    return 1.0 - b - c, b, c


@uncounted
def _off(
    triangle: tuple[float, float, float, float, float, float], square: float, x: float, y: float
) -> float:
    """The distance of a point from a conic, by two steps of Newton's method toward it."""
    _, _, ex, ey, cx, cy = triangle
    area = ex * cy - ey * cx
    result = 0.0
    for _ in range(2):
        a, b, c = _barycentric(triangle, x, y)
        value = b * b - 4.0 * square * a * c
        gx = (2.0 * b * cy - 4.0 * square * (c * (ey - cy) - a * ey)) / area
        gy = (4.0 * square * (c * (ex - cx) - a * ex) - 2.0 * b * cx) / area
        squared = gx * gx + gy * gy
        x -= value * gx / squared
        y -= value * gy / squared
        result += abs(value) / math.sqrt(squared)
    return result
