"""The quadratic of each triangle, and which of its zero set's ends in the triangle belong together.

Where a quadratic is negative (or where it is positive) consists of one or two convex parts; a
convex part cuts a triangle in a convex region, whose boundary is one ring.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.meshes.mesh import frames
from splinesdf.spaces.quadratic import power_form

# An eigenvalue of the Hessian below this share of the other counts as zero (a parabola): the
# center of such a hyperbola lies too far away to tell its branches apart, and only one is near.
_FLAT = 1e-9
# Points this share of a cell's side beside a triangle count as in it: rounding moves a crossing
# by up to about the root of it where the level touches a side.
_BESIDE = 1e-6


class Quadratics(NamedTuple):
    """Functions constant + gradient x + xᵀ hessian x / 2, with x measured from the center."""

    sides: Floats  # (n, 2) of the cell
    number: Ints  # (n,) which triangle of the cell: bottom, right, top, left
    center: Floats  # (n, 2)
    constant: Floats  # (n,)
    gradient: Floats  # (n, 2)
    hessian: Floats  # (n, 2, 2)

    def take(self, rows: Ints) -> Quadratics:
        """Some of them."""
        return Quadratics(
            self.sides[rows],
            self.number[rows],
            self.center[rows],
            self.constant[rows],
            self.gradient[rows],
            self.hessian[rows],
        )

    def value_at(self, points: Floats) -> Floats:
        """Value of each at its own point, (n, 2) -> (n,)."""
        x = points - self.center
        mean = self.gradient + 0.5 * np.einsum("nij,nj->ni", self.hessian, x)
        return np.asarray(self.constant + np.sum(mean * x, axis=1))

    def gradient_at(self, points: Floats) -> Floats:
        """Gradient of each at its own point, (n, 2) -> (n, 2)."""
        x = points - self.center
        return np.asarray(self.gradient + np.einsum("nij,nj->ni", self.hessian, x))

    def contains(self, points: Floats) -> Bools:
        """Whether each triangle contains its own point, (n, 2) -> (n,)."""
        s, t = ((points - self.center) / self.sides).T
        outward = np.choose(self.number, [-t, s, t, -s])
        across = np.abs(np.where(self.number % 2 == 0, s, t))
        return np.asarray((outward <= 0.5 + _BESIDE) & (outward >= across - _BESIDE))

    def extremes(self) -> tuple[Floats, Floats]:
        """Where each has no slope, measured from the center, and its value there: (n, 2), (n,)."""
        step = np.asarray(np.linalg.solve(self.hessian, -self.gradient[..., None])[..., 0], float)
        return step, np.asarray(self.constant + 0.5 * np.sum(self.gradient * step, axis=1))

    def contains_ellipse(self) -> Bools:
        """Whether each triangle contains all of its zero set, and that is an ellipse: (n,)."""
        determinant = np.linalg.det(self.hessian)
        result = determinant > _FLAT * np.trace(self.hessian, axis1=1, axis2=2) ** 2
        f = self.take(np.flatnonzero(result))
        inverse = np.linalg.inv(f.hessian)
        middle, extreme = f.extremes()
        outward = np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])[f.number]
        across = outward[:, ::-1]
        there = np.ones(len(middle), dtype=np.bool_)
        for normal, most in ((outward, 0.5), (across - outward, 0.0), (-across - outward, 0.0)):
            slope = normal / f.sides
            # How far the ellipse reaches along this normal of a side of the triangle.
            squared = -2.0 * extreme * np.einsum("ni,nij,nj->n", slope, inverse, slope)
            reach = np.sum(slope * middle, axis=1) + np.sqrt(np.maximum(squared, 0.0))
            there &= (squared > 0.0) & (reach <= most + _BESIDE)
        result[result] = there
        return np.asarray(result)


def triangle_quadratics(boxes: Floats, ordinates: Floats, level: float) -> Quadratics:
    """The spline minus the level in the bottom, right, top, left triangle of each cell."""
    count = len(boxes)
    frame, power = frames(boxes), power_form(ordinates)
    # Which truncated powers act: (s - t)₊² in bottom and right, (s + t)₊² in right and top.
    across = np.repeat(power[:, 6:7], 4, axis=1) * [1.0, 1.0, 0.0, 0.0]
    along = np.repeat(power[:, 7:8], 4, axis=1) * [0.0, 1.0, 1.0, 0.0]
    hessian = np.empty((count, 4, 2, 2))
    hessian[..., 0, 0] = 2.0 * (power[:, 3:4] + across + along)
    hessian[..., 1, 1] = 2.0 * (power[:, 5:6] + across + along)
    hessian[..., 0, 1] = hessian[..., 1, 0] = power[:, 4:5] - 2.0 * across + 2.0 * along
    inverse = frame[:, None, 2:]
    hessian *= inverse[..., :, None] * inverse[..., None, :]
    return Quadratics(
        np.repeat(boxes[:, 2:] - boxes[:, :2], 4, axis=0),
        np.tile(np.arange(4), count),
        np.repeat(frame[:, :2], 4, axis=0),
        np.repeat(power[:, 0] - level, 4),
        np.repeat(power[:, 1:3] * frame[:, 2:], 4, axis=0),
        hessian.reshape(-1, 2, 2),
    )


def pair(quadratic: Quadratics, points: Floats, leaving: Bools) -> tuple[Ints, Ints]:
    """Which crossings of one triangle's boundary are joined by an arc of the zero set.

    Parameters
    ----------
    quadratic : Quadratics
        Of the one triangle.
    points : ndarray, shape (2 k, 2)
        The crossings, counterclockwise.
    leaving : ndarray, shape (2 k,)
        Alternately true and false: the boundary leaves the negative side there.

    Returns
    -------
    tuple of ndarray, shape (k,)
        Where the arcs start and end, as rows of ``points``. An arc starts where the boundary
        leaves the negative side, and has that side on its left.
    """
    count = len(points)
    negative, part = _convex_part(quadratic)
    # Intervals of the boundary on the convex side start where that side is entered.
    opens = np.flatnonzero(leaving != negative)
    closes = (opens + 1) % count
    # The middle of an interval's ends lies in the same convex part as the interval.
    label = part(0.5 * (points[opens] + points[closes]))
    following = np.empty(len(opens), dtype=np.int64)
    for value in np.unique(label):
        members = np.flatnonzero(label == value)
        following[members] = np.roll(members, -1)
    # Around a convex part: along an interval to where it closes, then by an arc to the next one.
    start, end = closes, opens[following]
    return (start, end) if negative else (end, start)


def _convex_part(quadratic: Quadratics) -> tuple[bool, Callable[[Floats], Ints]]:
    """Whether the negative side is the one with convex parts, and which part a point is in."""
    values, axes = np.linalg.eigh(quadratic.hessian[0])
    small, large = sorted(values, key=abs)

    def whole(where: Floats) -> Ints:
        return np.zeros(len(where), dtype=np.int64)

    if small * large >= 0.0 or abs(small) <= _FLAT * abs(large):
        return bool(large >= 0.0), whole
    center = quadratic.center[0] - np.linalg.solve(quadratic.hessian[0], quadratic.gradient[0])
    negative = bool(quadratic.value_at(center[None])[0] >= 0.0)
    axis = axes[:, 0] if negative else axes[:, 1]

    def branch(where: Floats) -> Ints:
        return np.asarray((where - center) @ axis > 0.0, dtype=np.int64)

    return negative, branch


def whole_ellipses(quadratics: Quadratics) -> tuple[Ints, Floats]:
    """Ellipses that lie inside their triangle.

    Parameters
    ----------
    quadratics : Quadratics
        Of n triangles whose boundaries have no crossings.

    Returns
    -------
    tuple of ndarray, shapes (k,) and (k, 4, 2)
        Which of the n, and the ends of the ellipses' axes in order, the negative side on the left.
    """
    rows = np.flatnonzero(quadratics.contains_ellipse())
    f = quadratics.take(rows)
    step, extreme = f.extremes()
    center = f.center + step
    values, axes = np.linalg.eigh(f.hessian)
    radius = np.sqrt(-2.0 * extreme[:, None] / values)
    first, second = (radius[:, k, None] * axes[:, :, k] for k in (0, 1))
    turn = np.sign(np.linalg.det(axes)) * np.where(f.hessian[:, 0, 0] > 0.0, 1.0, -1.0)
    second *= turn[:, None]
    ring = np.stack([center + first, center + second, center - first, center - second], axis=1)
    return rows, ring
