"""How much arclets bend: proved ranges of curvature, for bounds of a distance's derivatives.

With u the signed distance to a smooth arc, negative on its left, s its arc length and kappa its
curvature, u has the second derivative k = kappa / (1 + kappa u) along its level sets, none across
them, and k changes along a level set by (d kappa / ds) / (1 + kappa u)^3: ranges of kappa and of
d kappa / ds are all that bounds of a distance's derivatives need.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from splinesdf.arclets.crossings import control_points, degrees
from splinesdf.arclets.points import previous_of
from splinesdf.arclets.tables import Arclets, Bends
from splinesdf.arclets.tangents import end_tangents
from splinesdf.ground.arrays import Floats, Ints

# Equal parts of an arclet that are bounded one by one. More: closer ranges where the parameter's
# speed varies; each costs once, when the shape is first fitted.
_PARTS = 4
# An arclet whose speed at an end is below this share of its piece, as in a cusp, or a straight one
# that is shorter, has directions that are half rounding: nothing is claimed of it. Nor of one below
# the third share of the drawing, which is what rounding leaves of ends. Smaller: proofs rest on
# directions that are wrong by 1e-16 over this; larger: more small arclets whose neighborhoods need
# a closer look.
_SLOW, _SHORT, _LOST = 2e-7, 1e-8, 1e-11
_UNKNOWN = (-np.inf, np.inf, np.inf, np.inf, np.inf)
# Bounds are widened by this share of the largest terms that went into them, against rounding.
_SLACK = 1e-12


def bends(arclets: Arclets) -> Bends:
    """Ranges of curvature and unit tangents of all arclets."""
    degree = degrees(arclets)
    count = len(degree)
    curvature = np.zeros((count, 5))
    largest = float(np.abs(arclets.boxes[0]).max())
    own = _piece_sizes(arclets)
    for d in np.unique(degree):
        rows = np.flatnonzero(degree == d)
        power = arclets.power[rows, 1 : d + 1]
        if d > 1:
            curvature[rows] = _curvatures(control_points(arclets.power[rows, : d + 1]))
        steps = np.stack([power[:, 0], np.sum(np.arange(1, d + 1)[:, None] * power, axis=1)])
        speed = np.hypot(steps[..., 0], steps[..., 1]).min(axis=0)
        least = np.maximum((_SLOW if d > 1 else _SHORT) * own[rows], _LOST * largest)
        curvature[rows[speed < least]] = _UNKNOWN
    leaving, arriving = (
        vectors / np.hypot(vectors[:, 0], vectors[:, 1])[:, None]
        for vectors in end_tangents(arclets)
    )
    previous = previous_of(arclets.following)
    rows = np.concatenate([curvature, leaving, arriving, _extents(arclets, degree)], axis=1)
    return Bends(np.ascontiguousarray(rows), _second_differences(arclets, degree), previous)


def _piece_sizes(arclets: Arclets) -> Floats:
    """Half the size of each arclet's piece, as far as it is there: (n,)."""
    count = int(arclets.piece.max()) + 1
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    for points in (arclets.start, arclets.end):
        np.minimum.at(low, arclets.piece, points)
        np.maximum.at(high, arclets.piece, points)
    return np.asarray(0.5 * (high - low).max(axis=1)[arclets.piece])


def _second_differences(arclets: Arclets, degree: Ints) -> Floats:
    """See `Bends`."""
    result = np.zeros((len(degree), 5, max(2 * int(degree.max()) - 1, 1)))
    result[:, 0] = np.inf
    for d in np.unique(degree[degree > 1]):
        rows = np.flatnonzero(degree == d)
        m = 2 * d + 1
        table = arclets.arcs[rows, 5 + 2 * d : 5 + 2 * d + 3 * m].reshape(len(rows), 3, m)
        x, y, squares = np.moveaxis(np.diff(table, n=2, axis=2), 1, 0)
        result[rows, :4, : m - 2] = np.stack([squares, x, y, np.abs(x) + np.abs(y)], axis=1)
        result[rows, 4] = table[:, 2, -1:]
    return result


def _extents(arclets: Arclets, degree: Ints) -> Floats:
    """The largest speed on each arclet (none is longer), and how far it bulges, (n, 2)."""
    result = np.empty((len(degree), 2))
    # Rounding in points of the curve.
    grain = 16.0 * np.finfo(np.float64).eps * float(np.abs(arclets.boxes[0]).max())
    for d in np.unique(degree):
        rows = np.flatnonzero(degree == d)
        control = control_points(arclets.power[rows, : d + 1])
        steps = d * np.diff(control, axis=1)
        result[rows, 0] = np.hypot(steps[..., 0], steps[..., 1]).max(axis=1) * (1.0 + _SLACK)
        result[rows, 1] = thickness(control) * (1.0 + _SLACK) + grain
    return result


def _curvatures(control: Floats) -> Floats:
    """Smallest and largest curvature, largest |d kappa / ds|, curvature at both ends, (n, 5).

    Parameters
    ----------
    control : ndarray, shape (n, d + 1, 2)
        Bézier arcs. Infinite ranges where the speed may vanish.
    """
    count, d = len(control), control.shape[1] - 1
    result = np.empty((count, 5))
    pieces = _in_parts(d) @ control.transpose(1, 2, 0).reshape(d + 1, -1)
    pieces = pieces.reshape(_PARTS, d + 1, 2, count).transpose(1, 2, 0, 3).reshape(d + 1, 2, -1)
    low, high, slope = (values.reshape(_PARTS, count) for values in _ranges(pieces))
    result[:, 0], result[:, 1] = low.min(axis=0), high.max(axis=0)
    result[:, 2] = slope.max(axis=0)
    for column, ends in ((3, control), (4, control[:, ::-1])):
        first = d * (ends[:, 1] - ends[:, 0])
        second = d * (d - 1) * (ends[:, 2] - 2.0 * ends[:, 1] + ends[:, 0])
        cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            value = cross / np.hypot(first[:, 0], first[:, 1]) ** 3
        # Backwards the curve bends to the other side.
        result[:, column] = value if column == 3 else -value
    unknown = ~np.isfinite(result).all(axis=1)
    result[unknown] = _UNKNOWN
    return result


def curvature_ranges(control: Floats) -> tuple[Floats, Floats, Floats]:
    """Least and largest curvature and largest change of it with arc length, as far as is proved.

    Parameters
    ----------
    control : ndarray, shape (n, d + 1, 2)
        Bézier arcs. Where the speed may vanish the ranges are infinite.

    Returns
    -------
    low, high, change : ndarray, shape (n,)
    """
    return _ranges(np.ascontiguousarray(control.transpose(1, 2, 0)))


def _ranges(control: Floats) -> tuple[Floats, Floats, Floats]:
    """As `curvature_ranges`, of arcs (d + 1, 2, n): sums of coefficients are sums of long rows."""
    first = derivative(control)
    second = derivative(first)
    third = derivative(second)
    cross = product(first[:, 0], second[:, 1]) - product(first[:, 1], second[:, 0])
    noise = _SLACK * np.abs(first).max(axis=(0, 1)) * np.abs(second).max(axis=(0, 1))
    cross_low, cross_high = cross.min(axis=0) - noise, cross.max(axis=0) + noise
    squared = product(first[:, 0], first[:, 0]) + product(first[:, 1], first[:, 1])
    speed_low = squared.min(axis=0) - _SLACK * squared.max(axis=0)
    speed_high = squared.max(axis=0) * (1.0 + _SLACK)
    cross_third = product(first[:, 0], third[:, 1]) - product(first[:, 1], third[:, 0])
    along = product(first[:, 0], second[:, 0]) + product(first[:, 1], second[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        slowest = np.where(speed_low > 0.0, speed_low, 0.0) ** 1.5
        fastest = speed_high**1.5
        low = cross_low / np.where(cross_low < 0.0, slowest, fastest)
        high = cross_high / np.where(cross_high > 0.0, slowest, fastest)
        # d kappa / dt = (c' x c''') / |c'|^3 - 3 (c' x c'') (c' . c'') / |c'|^5
        change = np.abs(cross_third).max(axis=0) * (1.0 + _SLACK) / slowest
        both = np.maximum(np.abs(cross_low), np.abs(cross_high)) * np.abs(along).max(axis=0)
        change += 3.0 * (1.0 + _SLACK) * both / (slowest * speed_low)
        change /= np.sqrt(np.where(speed_low > 0.0, speed_low, 0.0))
    standing = speed_low <= 0.0
    return (
        np.where(standing, -np.inf, low),
        np.where(standing, np.inf, high),
        np.where(standing, np.inf, change),
    )


def derivative(points: Floats) -> Floats:
    """Control points of the derivatives: (d + 1, 2, n) -> (d, 2, n), but (1, 2, n) for d = 0."""
    degree = len(points) - 1
    if degree == 0:
        return np.zeros_like(points)
    return np.asarray(degree * np.diff(points, axis=0))


def product(one: Floats, other: Floats) -> Floats:
    """Bernstein coefficients (a + b + 1, n) of products of polynomials (a + 1, n), (b + 1, n)."""
    a, b = len(one) - 1, len(other) - 1
    result = np.zeros((a + b + 1, one.shape[1]))
    scaled = other * _binomials(b)
    for i in range(a + 1):
        result[i : i + b + 1] += math.comb(a, i) * one[i] * scaled
    return np.asarray(result / _binomials(a + b))


def _binomials(n: int) -> Floats:
    return np.array([[math.comb(n, k)] for k in range(n + 1)], dtype=np.float64)


@cache
def _in_parts(degree: int) -> Floats:
    """The matrix that takes control points to those of all equal parts, one after the other."""
    every = np.eye(degree + 1)
    parts = [
        _head(_head(every, (k + 1) / _PARTS)[::-1], 1.0 - k / (k + 1))[::-1] for k in range(_PARTS)
    ]
    return np.concatenate(parts)


def _head(control: Floats, at: float) -> Floats:
    """Control points of the part of an arc from 0 to a parameter, by de Casteljau."""
    result = np.empty_like(control)
    points = control
    for k in range(len(control)):
        result[k] = points[0]
        points = (1.0 - at) * points[:-1] + at * points[1:]
    return result


def thickness(arcs: Floats) -> Floats:
    """Largest distance of a control point from the chord's segment."""
    chord = arcs[:, -1] - arcs[:, 0]
    squared = np.maximum(np.sum(chord * chord, axis=1), np.finfo(np.float64).tiny)
    offset = arcs - arcs[:, :1]
    share = np.sum(offset * chord[:, None], axis=2) / squared[:, None]
    rest = offset - np.clip(share, 0.0, 1.0)[..., None] * chord[:, None]
    return np.asarray(np.hypot(rest[..., 0], rest[..., 1]).max(axis=1))
