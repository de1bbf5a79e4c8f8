r"""The fewest biarcs along a smooth run of conic arcs, found by going as far as each one can.

A biarc is two circular arcs with a common tangent where they meet, between two points with given
tangents:

        Q0 ---- J ---- Q1          |P0 Q0| = |Q0 J| = |J Q1| = |Q1 P2| = d
       /                 \         tangents along P0 Q0 and Q1 P2
     P0                   P2
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import kernel, uncounted

# Points of the run at which a biarc is measured, and at the least so many on each conic. The
# deviation along a biarc has up to four bumps: with eight points each, what lies between two
# is 2 % larger than what is seen. More points are only slower.
_MEASURED = 32
_LEAST_EACH = 4
# What is left for those 2 %. Nearer to 1, and the tolerance is missed between the points.
_MARGIN = 0.97
# Halvings between a span that fits and one that does not: the last one moves an end by 1 % of
# the span. Fewer make more arcs, more are slower and gain nothing.
_HALVINGS = 7
# If no span of this share of a conic fits, the rest of the conic is one: it is a cusp, all of it no
# longer than rounding. Larger, and a coarse conic would be let through with a fine tolerance.
_SHORTEST = 2.0**-30


@uncounted
def _point(arcs: Floats, weights: Floats, u: float) -> tuple[float, float, float, float]:
    """Where the run is at a parameter, conic i having [i, i + 1], and its unit tangent."""
    i = min(int(u), arcs.shape[0] - 1)
    t = u - i
    w = weights[i]
    first, middle, last = (1.0 - t) * (1.0 - t), 2.0 * w * t * (1.0 - t), t * t
    # About P0, so that coordinates far from the origin cancel first.
    x1, y1 = arcs[i, 1, 0] - arcs[i, 0, 0], arcs[i, 1, 1] - arcs[i, 0, 1]
    x2, y2 = arcs[i, 2, 0] - arcs[i, 0, 0], arcs[i, 2, 1] - arcs[i, 0, 1]
    total = first + middle + last
    x = arcs[i, 0, 0] + (middle * x1 + last * x2) / total
    y = arcs[i, 0, 1] + (middle * y1 + last * y2) / total
    a, b, c = w * first, t * (1.0 - t), w * last
    tx = a * x1 + b * x2 + c * (x2 - x1)
    ty = a * y1 + b * y2 + c * (y2 - y1)
    speed = math.sqrt(tx * tx + ty * ty)
    if speed > 0.0:
        tx, ty = tx / speed, ty / speed
    return x, y, tx, ty


# Counted, so that it is not compiled into its callers: there sums are added up in another order,
# and last bits of arcs change. Hence the same with `_farthest`, which calls it.
@kernel
def _knot(arcs: Floats, weights: Floats, tangents: Floats, u: float, knot: Floats) -> None:
    """Fill u, the point there, and the tangent: in joints that of both sides."""
    i = int(u)
    x, y, tx, ty = _point(arcs, weights, u)
    if u == i:
        tx, ty = tangents[i, 0], tangents[i, 1]
        if i == arcs.shape[0]:
            x, y = arcs[i - 1, 2, 0], arcs[i - 1, 2, 1]
    knot[0], knot[1], knot[2], knot[3], knot[4] = u, x, y, tx, ty


@uncounted
def _biarc(start: Floats, end: Floats) -> float:
    """The d of the biarc between two knots, 0 if there is none of two quarter turns at most."""
    vx, vy = end[1] - start[1], end[2] - start[2]
    squared = vx * vx + vy * vy
    along = vx * (start[3] + end[3]) + vy * (start[4] + end[4])
    # 1 - cos of the angle between the tangents, without cancellation.
    cx, cy = end[3] - start[3], end[4] - start[4]
    turn = 0.5 * (cx * cx + cy * cy)
    root = along + math.sqrt(along * along + 2.0 * turn * squared)
    if not root > 0.0:
        return 0.0
    d = squared / root
    # The tangent in the joint.
    jx, jy = vx - d * (start[3] + end[3]), vy - d * (start[4] + end[4])
    if jx * start[3] + jy * start[4] < 0.0 or jx * end[3] + jy * end[4] < 0.0:
        return 0.0
    return d if d < np.inf else 0.0


@uncounted
def _off(vx: float, vy: float, nx: float, ny: float, bend: float) -> float:
    """How far a point is from a circle, both seen from a point of it with the normal n.

    Infinite for points near the center: their nearest points leap about.
    """
    inner = bend * (vx * vx + vy * vy) - 2.0 * (nx * vx + ny * vy)
    square = 1.0 + bend * inner
    if square < 0.25:
        return np.inf
    return abs(inner / (1.0 + math.sqrt(square)))


@uncounted
def _fits(arcs: Floats, weights: Floats, start: Floats, end: Floats, tolerance: float) -> bool:
    """Whether the run between two knots is within the tolerance of their biarc.

    Each point of the run is measured to its nearest on the biarc. This is continuous along the
    run and goes from end to end, so each point of the biarc is such a nearest one: it is as near
    to the run.
    """
    d = _biarc(start, end)
    if d == 0.0:
        return False
    x0, y0, x2, y2 = start[1], start[2], end[1], end[2]
    tx, ty = x2 - x0 - d * (start[3] + end[3]), y2 - y0 - d * (start[4] + end[4])
    length = math.sqrt(tx * tx + ty * ty)
    if length == 0.0:
        return False
    tx, ty = tx / length, ty / length
    jx, jy = 0.5 * (x0 + x2 + d * (start[3] - end[3])), 0.5 * (y0 + y2 + d * (start[4] - end[4]))
    # A circle through its tangent's point: curvature 2 sin(half) / chord = tan(half) / d.
    sine, cosine = start[3] * ty - start[4] * tx, start[3] * tx + start[4] * ty
    early = sine / (1.0 + cosine) / d
    sine, cosine = tx * end[4] - ty * end[3], tx * end[3] + ty * end[4]
    late = sine / (1.0 + cosine) / d
    limit = _MARGIN * tolerance
    first, last = int(start[0]), min(math.ceil(end[0]), arcs.shape[0])
    spacing = math.sqrt((x2 - x0) * (x2 - x0) + (y2 - y0) * (y2 - y0)) / _MEASURED
    ax, ay = x0, y0
    for i in range(first, last):
        low, high = max(start[0], float(i)), min(end[0], i + 1.0)
        bx, by, _, _ = _point(arcs, weights, high)
        portion = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
        ax, ay = bx, by
        count = max(_LEAST_EACH, min(math.ceil(portion / spacing), 2 * _MEASURED))
        for k in range(count):
            if k + 1 == count and i + 1 == last:
                break
            x, y, _, _ = _point(arcs, weights, low + (high - low) * (k + 1) / count)
            if (x - jx) * tx + (y - jy) * ty <= 0.0:
                off = _off(x - x0, y - y0, -start[4], start[3], early)
                if (x - x0) * start[3] + (y - y0) * start[4] < 0.0:
                    off = max(off, math.sqrt((x - x0) * (x - x0) + (y - y0) * (y - y0)))
            else:
                off = _off(x - x2, y - y2, -end[4], end[3], late)
                if (x - x2) * end[3] + (y - y2) * end[4] > 0.0:
                    off = max(off, math.sqrt((x - x2) * (x - x2) + (y - y2) * (y - y2)))
            if not off <= limit:
                return False
    return True


@kernel
def _farthest(
    arcs: Floats,
    weights: Floats,
    tangents: Floats,
    tolerance: float,
    start: Floats,
    step: float,
    end: Floats,
) -> None:
    """Fill the farthest knot that a biarc from this one reaches, trying the step first."""
    n = float(arcs.shape[0])
    u = start[0]
    near, far = u, min(u + step, n)
    _knot(arcs, weights, tangents, far, end)
    while _fits(arcs, weights, start, end, tolerance):
        near = far
        if far == n:
            return
        step *= 2.0
        far = min(u + step, n)
        _knot(arcs, weights, tangents, far, end)
    while near == u:
        step = 0.5 * (far - u)
        _knot(arcs, weights, tangents, u + step, end)
        if _fits(arcs, weights, start, end, tolerance):
            near = u + step
        else:
            far = u + step
            if step < _SHORTEST or far == u:
                _knot(arcs, weights, tangents, math.floor(u) + 1.0, end)
                return
    for _ in range(_HALVINGS):
        middle = 0.5 * (near + far)
        _knot(arcs, weights, tangents, middle, end)
        if _fits(arcs, weights, start, end, tolerance):
            near = middle
        else:
            far = middle
    _knot(arcs, weights, tangents, near, end)


@kernel
def find_knots(arcs: Floats, weights: Floats, tangents: Floats, tolerance: float) -> Floats:
    """Where biarcs that follow a run within a tolerance begin and end.

    Parameters
    ----------
    arcs, weights : ndarray, shapes (n, 3, 2), (n,)
        Conics that turn little each and whose speed is nearly even.
    tangents : ndarray, shape (n + 1, 2)
        Unit tangents where they are joined.

    Returns
    -------
    ndarray, shape (k + 1, 5)
        Parameter, point and unit tangent, from 0 to n.
    """
    n = float(arcs.shape[0])
    knots = np.zeros((16, 5))
    _knot(arcs, weights, tangents, 0.0, knots[0])
    k, step = 0, 1.0
    while knots[k, 0] < n:
        if k + 1 == knots.shape[0]:
            longer = np.zeros((2 * (k + 1), 5))
            longer[: k + 1] = knots
            knots = longer
        _farthest(arcs, weights, tangents, tolerance, knots[k], step, knots[k + 1])
        step = max(knots[k + 1, 0] - knots[k, 0], _SHORTEST)
        k += 1
    if k > 1:
        # The last one has what was left: it takes half of both, if it can.
        other = np.zeros(5)
        _knot(arcs, weights, tangents, 0.5 * (knots[k - 2, 0] + n), other)
        if _fits(arcs, weights, knots[k - 2], other, tolerance) and _fits(
            arcs, weights, other, knots[k], tolerance
        ):
            knots[k - 1] = other
    return knots[: k + 1]


@kernel
def fill_biarcs(knots: Floats, arcs: Floats) -> None:
    """Fill the control points of two arcs for each two knots; of lines where there is none."""
    for k in range(knots.shape[0] - 1):
        start, end = knots[k], knots[k + 1]
        d = _biarc(start, end)
        for c in range(2):
            x0, x2 = start[1 + c], end[1 + c]
            early, late = x0 + d * start[3 + c], x2 - d * end[3 + c]
            if d == 0.0:
                early, late = x0 + 0.25 * (x2 - x0), x2 - 0.25 * (x2 - x0)
            joint = 0.5 * (early + late)
            arcs[2 * k, 0, c], arcs[2 * k, 1, c], arcs[2 * k, 2, c] = x0, early, joint
            arcs[2 * k + 1, 0, c], arcs[2 * k + 1, 1, c], arcs[2 * k + 1, 2, c] = joint, late, x2
