"""Smooth curves compiled into polynomial pieces, and the pieces that go through given points.

    callable ──4 intervals──> sample ──agrees to 4 ulp?──yes──> piece of degree 7 (or a line)
                                ^               └─no──> split ─┐
                                └──────────────────────────────┘

A corner is found by splitting down to an interval that is straight to rounding. Then the whole
curve is compiled once more with the corner as a fixed end, so that few pieces lie around it.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.arclets.interpolation import NODES, TO_CONTROL
from splinesdf.errors import InputError
from splinesdf.ground.arrays import NOTHING, Bools, Floats, as_points, largest_coordinate
from splinesdf.shapes.loops import check_count
from splinesdf.shapes.sources.resolution import (
    CORNER,
    FIRST_INTERVALS,
    SHORT,
    agreement,
    interpolate,
    interval_parameters,
    noise_parameters,
    split,
)

# A curve that needs more than this is noise or oscillates without end.
_MOST_PIECES = 20_000

# A circle takes 40 pieces. The error of one is about turn^8 / 1.3e9 of the radius, here 1 ulp.
_ARC_TURN = 2.0 * math.pi / 40.0


class Curve(Protocol):
    """A curve to compile: points at parameters between two ends."""

    @property
    def start(self) -> float:
        """The first parameter."""

    @property
    def stop(self) -> float:
        """The last parameter."""

    def __call__(self, t: Floats) -> Floats:
        """Points at the parameters: (n,) -> (n, 2)."""


def compile_curve(curve: Curve, *, scale: float = 0.0) -> list[Floats]:
    """Cut a curve into polynomial pieces that agree with it to about 4 ulp.

    Parameters
    ----------
    curve : callable with ``start`` and ``stop``
        (n,) parameters to (n, 2) points; smooth but for corners, where its slope may jump.
    scale : float
        Taken as the largest coordinate if it is larger than what samples show: for one part of a
        larger curve, or where a curve goes far within a tiny part of its range.

    Returns
    -------
    list of ndarray, shape (8, 2) or (2, 2)
        Control points; each piece starts exactly where the last one ended. The error is a few
        units in the last place of the largest coordinate, or of the formula's own rounding.

    Raises
    ------
    InputError
        If the curve is not finite somewhere, or cannot be resolved (jump, infinite slope, noise).
    """
    tolerance, scale = _tolerance(curve, scale)
    ends = np.linspace(curve.start, curve.stop, FIRST_INTERVALS + 1)
    left, pieces = _refine(curve, ends, tolerance, scale)
    corners = _corners(left, curve)
    if len(corners):
        bounds = np.concatenate([[curve.start], corners, [curve.stop]])
        ends = np.unique(
            np.concatenate([np.linspace(a, b, FIRST_INTERVALS + 1) for a, b in pairwise(bounds)])
        )
        left, pieces = _refine(curve, ends, tolerance, scale)
    pieces = [pieces[i] for i in np.argsort(left[:, 0])]
    for before, after in pairwise(pieces):
        after[0] = before[-1]
    return pieces


def _tolerance(curve: Curve, scale: float) -> tuple[float, float]:
    """The error to accept, and the largest coordinate, from samples all over the curve."""
    points = _evaluate(curve, noise_parameters(curve.start, curve.stop))
    tolerance, largest = agreement(np.moveaxis(points, -1, 0).copy(), scale)
    return float(tolerance), float(largest)


def _evaluate(curve: Curve, t: Floats) -> Floats:
    points = curve(np.ascontiguousarray(t.ravel())).reshape(*t.shape, 2)
    bad = ~np.isfinite(points).all(axis=-1)
    if bad.any():
        raise InputError(f"the curve is not finite at t = {float(t[bad][0]):.6g}")
    largest_coordinate(points)
    return points


def _refine(
    curve: Curve, ends: Floats, tolerance: float, scale: float
) -> tuple[Floats, list[Floats]]:
    """Split until every interval is resolved; intervals (n, 2) and pieces, in no order."""
    intervals = np.column_stack([ends[:-1], ends[1:]])
    narrowest = 4.0 * np.spacing(max(abs(curve.start), abs(curve.stop)))
    done: list[Floats] = []
    pieces: list[Floats] = []
    while len(intervals):
        points = _evaluate(curve, interval_parameters(intervals))
        control, straight, error = interpolate(np.swapaxes(points, 1, 2).copy(), tolerance)
        good = straight | (error <= tolerance)
        done.append(intervals[good])
        pieces += [control[i, [0, -1]] if straight[i] else control[i] for i in np.flatnonzero(good)]
        _check_progress(intervals, good, len(pieces), narrowest)
        intervals, _ = split(intervals[~good], error[~good], tolerance, scale)
    return np.concatenate(done), pieces


def _check_progress(intervals: Floats, good: Bools, count: int, narrowest: float) -> None:
    stuck = ~good & (intervals[:, 1] - intervals[:, 0] <= narrowest)
    if stuck.any():
        raise InputError(
            f"the curve cannot be resolved near t = {float(intervals[stuck][0, 0]):.6g}: it jumps, "
            f"has an infinite slope, or is noise there"
        )
    if count + np.count_nonzero(~good) > _MOST_PIECES:
        raise InputError(
            f"the curve needs more than {_MOST_PIECES} pieces (near t = "
            f"{float(intervals[~good][0, 0]) if not good.all() else 0.0:.6g}): it is noise or "
            f"oscillates too often"
        )


def _corners(intervals: Floats, curve: Curve) -> Floats:
    """Where splitting ran down to very short intervals: one parameter for each such place."""
    width = curve.stop - curve.start
    small = intervals[intervals[:, 1] - intervals[:, 0] < CORNER * width]
    small = small[np.argsort(small[:, 0])]
    corners = []
    while len(small):
        near = small[:, 0] - small[0, 0] < 1e3 * CORNER * width
        group, small = small[near], small[~near]
        widths = group[:, 1] - group[:, 0]
        finest = group[widths <= 2.0 * widths.min()]
        corners.append(_meeting(curve, float(finest[0, 0]), float(finest[-1, 1])))
    inside = np.array(corners)
    return inside[(inside > curve.start) & (inside < curve.stop)]


def _meeting(curve: Curve, low: float, high: float) -> float:
    """Where the tangents before ``low`` and after ``high`` meet: the corner between them."""
    reach = SHORT * (curve.stop - curve.start)
    t = np.array([max(low - reach, curve.start), low, high, min(high + reach, curve.stop)])
    points = _evaluate(curve, t)
    with np.errstate(invalid="ignore", divide="ignore"):
        before, after = (points[[1, 3]] - points[[0, 2]]) / (t[[1, 3]] - t[[0, 2]])[:, None]
        turn = before - after
        gap = points[2] - points[1] - after * (high - low)
        step = float(np.sum(gap * turn) / np.sum(turn * turn))
    return low + step if 0.0 <= step <= high - low else 0.5 * (low + high)


def compile_arc(
    centre: ArrayLike, x_axis: ArrayLike, y_axis: ArrayLike, start_angle: float, sweep: float
) -> list[Floats]:
    """Pieces of the elliptic arc centre + x_axis cos(a) + y_axis sin(a).

    Parameters
    ----------
    centre, x_axis, y_axis : array_like, shape (2,)
        The axes are conjugate half diameters; they need not be orthogonal.
    start_angle, sweep : float
        The angle a runs from ``start_angle`` by ``sweep`` (either sign), in radians.

    Returns
    -------
    list of ndarray, shape (8, 2)
        Good to about 4 ulp of the axes' length; each starts exactly where the last one ended.
    """
    if not sweep or not np.isfinite([start_angle, sweep]).all():
        raise InputError(f"expected a finite arc, got {sweep} radians from {start_angle}")
    count = math.ceil(abs(sweep) / _ARC_TURN)
    half = 0.5 * sweep / count
    # One piece about the angle 0, as the difference to (1, 0) so that rounding stays small;
    # all others are it, turned. Compiling each arc anew would cost ten times as much.
    angles = half * (2.0 * NODES - 1.0)
    across = TO_CONTROL @ (-2.0 * np.sin(0.5 * angles) ** 2)
    along = TO_CONTROL @ np.sin(angles)
    middle, x, y = as_points(centre), as_points(x_axis), as_points(y_axis)
    steps = start_angle + half * np.arange(2 * count + 1)  # ends and middles in turn
    outward = np.cos(steps)[:, None] * x + np.sin(steps)[:, None] * y
    onward = np.cos(steps)[:, None] * y - np.sin(steps)[:, None] * x
    control = middle + (
        (1.0 + across[:, None]) * outward[1::2, None] + along[:, None] * onward[1::2, None]
    )
    control[:, 0], control[:, -1] = middle + outward[:-1:2], middle + outward[2::2]
    return list(control)


def polygon(points: ArrayLike) -> list[Floats]:
    """Straight pieces that join the points in order, and the last to the first.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Repeated neighbours, and a last point that repeats the first, are dropped.

    Raises
    ------
    InputError
        If fewer than 3 distinct points are left or a coordinate is not finite.
    """
    corners = _distinct(points)
    check_count(len(corners))
    following = np.roll(corners, -1, axis=0)
    return list(np.stack([corners, following], axis=1))


def periodic_cubic_spline(points: ArrayLike) -> list[Floats]:
    """The closed C² cubic spline through the points, parameterized by chord length.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        In order; repeated neighbours are dropped as in `polygon`.

    Returns
    -------
    list of ndarray, shape (4, 2)
        Cubic Bézier pieces, one between each two points.
    """
    corners = _distinct(points)
    following = np.roll(corners, -1, axis=0)
    step = np.hypot(*(following - corners).T)
    slope = (following - corners) / step[:, None]
    # Equal second derivatives at point i, divided by two:
    # m[i-1]/h[i-1] + 2 (1/h[i-1] + 1/h[i]) m[i] + m[i+1]/h[i]
    #     = 3 (slope[i-1]/h[i-1] + slope[i]/h[i])
    # Scaled by the mean step, so that tiny units do not overflow.
    after = np.mean(step) / step
    before = np.roll(after, 1)
    right = 3.0 * (before[:, None] * np.roll(slope, 1, axis=0) + after[:, None] * slope)
    tangent = _solve_cyclic(2.0 * (before + after), after, right)
    reach = step[:, None] / 3.0
    inner = corners + reach * tangent, following - reach * np.roll(tangent, -1, axis=0)
    return list(np.stack([corners, *inner, following], axis=1))


def _distinct(points: ArrayLike) -> Floats:
    corners = as_points(points)
    if corners.ndim != 2:
        raise InputError(f"expected points of shape (n, 2), got shape {corners.shape}")
    if not np.isfinite(corners).all():
        raise InputError("expected finite points, got NaN or infinity")
    if not len(corners):
        raise InputError("expected at least 3 distinct points, got none")
    largest_coordinate(corners)
    near = NOTHING * float(np.ptp(corners, axis=0).max())
    some = np.any(np.abs(corners - np.roll(corners, 1, axis=0)) > near, axis=1)
    # A single place is left if there is no other.
    corners = corners[some] if some.any() else corners[:1]
    count = len(np.unique(corners, axis=0))
    if count < 3:
        raise InputError(f"expected at least 3 distinct points, got {count}")
    return corners


def _solve_cyclic(diagonal: Floats, after: Floats, right: Floats) -> Floats:
    """Solve a symmetric cyclic tridiagonal system with two right sides.

    ``after[i]`` couples i and i + 1, the last one the last unknown and the first. The matrix is
    diagonally dominant, so elimination needs no pivots. The corner entries are split off as a
    rank-one change (Sherman-Morrison).
    """
    last = len(diagonal) - 1
    corner = float(after[last])
    gamma = -float(diagonal[0])
    main = [float(d) for d in diagonal]
    main[0] -= gamma
    main[last] -= corner * corner / gamma
    # x and y as one complex number: plain scalars are far faster than tiny arrays in a loop.
    plain = [complex(x, y) for x, y in right]
    change = [0.0] * (last + 1)
    change[0], change[last] = gamma, corner
    for i in range(1, last + 1):
        ratio = float(after[i - 1]) / main[i - 1]
        main[i] -= ratio * float(after[i - 1])
        plain[i] -= ratio * plain[i - 1]
        change[i] -= ratio * change[i - 1]
    plain[last] /= main[last]
    change[last] /= main[last]
    for i in range(last - 1, -1, -1):
        plain[i] = (plain[i] - float(after[i]) * plain[i + 1]) / main[i]
        change[i] = (change[i] - float(after[i]) * change[i + 1]) / main[i]
    share = (plain[0] + corner / gamma * plain[last]) / (
        1.0 + change[0] + corner / gamma * change[last]
    )
    solution = np.array(plain) - share * np.array(change)
    return np.column_stack([solution.real, solution.imag])


def point_loops(points: object, *, smooth: bool) -> list[list[Floats]]:
    """Closed polygons through points (n, 2) or several of these, or smooth curves through them."""
    several = isinstance(points, list | tuple) and len(points) and np.ndim(points[0]) == 2
    loops = []
    for each in points if several else [points]:  # type: ignore[attr-defined]
        corners = as_points(each)
        if corners.ndim != 2:
            raise InputError(f"expected points of shape (n, 2), got shape {corners.shape}")
        loops.append(periodic_cubic_spline(corners) if smooth else polygon(corners))
    return loops
