"""Exact edges: between two lines, circles or points the axis is one conic in (x, y, r).

The distance from a point, or from a circle, is a cone in (x, y, r) whose opening is a right angle;
from a line it is a plane with the same slope. Two such cones meet in a plane, so that an edge is a
plane section of a cone: one rational quadratic, given by its ends, the tangents there, and the
cone.
"""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.medial.tables import FAN, FREE, STRAIGHT, Walk

# Directions that differ by less (the square of the sine) are parallel to rounding.
_PARALLEL = 1e-26
# A control point that is off the chord's middle by less than this share of the chord bends nothing.
_FLAT = 1e-15
# An arc turns by no more than this cosine says. Larger turns have control points far away.
_TURN = -0.8


def slopes(normal: Floats) -> Floats:
    """Directions of the axis in (x, y, r) at disks, from both arms (n, 2, 2): (n, 3).

    Forward means with the first foot on the right.
    """
    right, left = normal[:, 0], normal[:, 1]
    apart = left - right
    along = np.column_stack([-apart[:, 1], apart[:, 0]])
    length = np.hypot(along[:, 0], along[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        along = along / length[:, None]
    # Where both feet are one, as at the end in a maximum of curvature, the axis goes on along the
    # arm: the caller says which way.
    along = np.where((length > 1e-7)[:, None], along, np.nan)
    mean = 0.5 * (right + left)
    return np.column_stack([along, np.sum(mean * along, axis=1)])


def controls(start: Floats, end: Floats, leaving: Floats, arriving: Floats) -> tuple[Floats, Bools]:
    """Where tangents at both ends meet, (n, 3), and whether an arc that turns little has it."""
    apart = end - start
    a, b, c = (
        np.sum(one * other, axis=1)
        for one, other in ((leaving, leaving), (leaving, arriving), (arriving, arriving))
    )
    e, f = np.sum(leaving * apart, axis=1), np.sum(arriving * apart, axis=1)
    det = a * c - b * b
    parallel = det <= _PARALLEL * a * c
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = (e * c - f * b) / det, (f * a - e * b) / det
        meeting = 0.5 * (start + s[:, None] * leaving + end - t[:, None] * arriving)
    middle = 0.5 * (start + end)
    result = np.where(parallel[:, None], middle, meeting)
    chord = np.sqrt(np.sum(apart * apart, axis=1))
    straight = np.sqrt(np.sum((result - middle) ** 2, axis=1)) <= _FLAT * chord
    good = parallel | straight | ((s > 0.0) & (t > 0.0))
    good &= (b >= _TURN * np.sqrt(a * c)) & np.isfinite(result).all(axis=1)
    return result, good


def weights(start: Floats, end: Floats, control: Floats, apex: Floats) -> tuple[Floats, Bools]:
    """Weights of control points by the cone with an apex, (n, 3); NaN apexes are planes."""
    middle = 0.5 * (start + end)
    from_apex, along = middle - apex, control - middle
    sign = np.array([1.0, 1.0, -1.0])
    q0 = np.sum(sign * from_apex * from_apex, axis=1)
    q1 = np.sum(sign * from_apex * along, axis=1)
    q2 = np.sum(sign * along * along, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(q1 * q1 - q0 * q2, 0.0))
        big = -(q1 + np.copysign(root, q1))
        both = np.stack([q0 / big, big / q2])
        inside = (both > 0.0) & (both < 1.0)
        share = np.where(inside[0], both[0], both[1])
        flat = np.sum(along * along, axis=1) <= (_FLAT**2) * np.sum((end - start) ** 2, axis=1)
        plane = np.isnan(apex[:, 0]) | flat
        weight = np.where(plane, 1.0, share / (1.0 - share))
    good = plane | inside.any(axis=0)
    return np.where(good, weight, 1.0), good


def apexes(walk: Walk, element: Ints) -> Floats:
    """Apexes of the cones of elements, (n, 3); NaN for lines."""
    kind = walk.element[element, 0]
    from splinesdf.medial.feet import points_and_normals

    corner, _ = points_and_normals(walk, element, np.zeros(len(element)))
    rows = walk.numbers[element]
    point = (kind == FAN)[:, None]
    result = np.where(point, np.column_stack([corner, np.zeros(len(element))]), rows[:, 4:7])
    result[(kind == STRAIGHT) | (kind == FREE)] = np.nan
    return np.asarray(result)


def off_sites(walk: Walk, element: Ints, disks: Floats) -> Floats:
    """How far the radius of disks (n, 3) is off the distance from the site of elements: (n,)."""
    apex = apexes(walk, element)
    with np.errstate(invalid="ignore"):
        cone = np.hypot(*(disks[:, :2] - apex[:, :2]).T) - np.abs(disks[:, 2] - apex[:, 2])
    foot = _starts(walk, element)
    normal = np.column_stack([-walk.numbers[element, 1], walk.numbers[element, 0]])
    plane = np.sum((disks[:, :2] - foot) * normal, axis=1) - disks[:, 2]
    return np.asarray(np.abs(np.where(np.isnan(apex[:, 0]), plane, cone)))


def _starts(walk: Walk, element: Ints) -> Floats:
    from splinesdf.medial.feet import points_and_normals

    points, _ = points_and_normals(walk, element, np.zeros(len(element)))
    return points


def conic_points(arcs: Floats, weight: Floats, t: float | Floats) -> Floats:
    """Points of rational quadratics (n, 3, k) at one parameter each: (n, k)."""
    t = np.broadcast_to(np.asarray(t, dtype=np.float64), (len(arcs),))
    a, b, c = (1.0 - t) ** 2, 2.0 * weight * t * (1.0 - t), t * t
    total = a + b + c
    top = a[:, None] * arcs[:, 0] + b[:, None] * arcs[:, 1] + c[:, None] * arcs[:, 2]
    return np.asarray(top / total[:, None])


def conic_velocities(arcs: Floats, weight: Floats, t: float) -> Floats:
    """Derivatives of rational quadratics (n, 3, k) at a parameter: (n, k)."""
    a, b, c = (1.0 - t) ** 2, 2.0 * weight * t * (1.0 - t), t * t
    da, db, dc = -2.0 * (1.0 - t), 2.0 * weight * (1.0 - 2.0 * t), 2.0 * t
    total, slope = a + b + c, da + db + dc
    top = a * arcs[:, 0] + b[:, None] * arcs[:, 1] + c * arcs[:, 2]
    rise = da * arcs[:, 0] + db[:, None] * arcs[:, 1] + dc * arcs[:, 2]
    return np.asarray((rise - slope[:, None] * top / total[:, None]) / total[:, None])
