"""Distances to curves with 40 digits, by mpmath: the measure for what is claimed to rounding.

    samples ─ keep what may hold the minimum ─→ finer, twice ─→ local minima ─→ Newton, 40 digits

The samples are float64 and only choose where Newton starts. A stretch is left out only where its
length proves that no point of it can beat the best sample.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Protocol

import mpmath
import numpy as np

MP = mpmath.MPContext()
MP.dps = 40
Number = mpmath.mpf
# Samples of a curve at first, and of each stretch that is kept, two times over. The last step is
# then 1e-6 of a curve: two minima that fall into one step differ by less than the step's fourth
# power.
_FIRST, _FINER = 32, 64
_NEWTON_STEPS = 60
# A step so short ends it. Newton squares it then: what is left is 1e-32 of a curve.
_CLOSE = MP.mpf(10) ** -16
# The float64 samples carry rounding, so stretches that miss by this share of the size stay in.
_ROUNDING = 1e-12


class Curve(Protocol):
    """A smooth curve over parameters in [0, 1]."""

    speed: float  # an upper bound of the derivative's length

    def points(self, t: np.ndarray, origin: np.ndarray) -> np.ndarray:
        """Places in float64 relative to a point nearby: (n,), (2,) -> (n, 2)."""

    def exact(self, t: Number) -> list[tuple[Number, Number]]:
        """Place, first and second derivative."""


class Bezier:
    """A Bézier piece whose control points are taken as exact."""

    def __init__(self, control: np.ndarray) -> None:
        self.control = control
        degree = len(control) - 1
        self.speed = degree * float(np.linalg.norm(np.diff(control, axis=0), axis=1).max())
        exact = [[Fraction(float(v)) for v in column] for column in control.T]
        self._power = [[_mp(c) for c in _monomials(column)] for column in exact]

    def points(self, t: np.ndarray, origin: np.ndarray) -> np.ndarray:
        s = t[:, None, None]
        points = np.broadcast_to(self.control - origin, (len(t), *self.control.shape))
        while points.shape[1] > 1:
            points = (1.0 - s) * points[:, :-1] + s * points[:, 1:]
        return points[:, 0]

    def exact(self, t: Number) -> list[tuple[Number, Number]]:
        columns = []
        for coefficients in self._power:
            value = slope = bend = MP.mpf(0)
            for c in reversed(coefficients):
                bend, slope, value = bend * t + slope, slope * t + value, value * t + c
            columns.append((value, slope, 2 * bend))
        return list(zip(*columns, strict=True))


class Fourier:
    """x(s), y(s) = Σ a cos(ks) + b sin(ks) over one stretch of s.

    Parameters
    ----------
    x, y : dict of int to pair of Fraction
        (a, b) by frequency k.
    start, stop : float
        The stretch; its ends are taken as exact.
    """

    def __init__(
        self,
        x: dict[int, tuple[Fraction, Fraction]],
        y: dict[int, tuple[Fraction, Fraction]],
        start: float,
        stop: float,
    ) -> None:
        self._series, self._start, self._width = (x, y), start, stop - start
        self._exact = [
            [(k, _mp(a), _mp(b)) for k, (a, b) in series.items()] for series in self._series
        ]
        sizes = [k * math.hypot(*ab) for series in (x, y) for k, ab in series.items()]
        self.speed = self._width * sum(sizes)

    def points(self, t: np.ndarray, origin: np.ndarray) -> np.ndarray:
        s = self._start + self._width * t
        columns = [
            sum(float(a) * np.cos(k * s) + float(b) * np.sin(k * s) for k, (a, b) in series.items())
            for series in self._series
        ]
        return np.stack(columns, -1) - origin

    def exact(self, t: Number) -> list[tuple[Number, Number]]:
        w = MP.mpf(self._width)
        s = MP.mpf(self._start) + w * t
        turns = {k: MP.cos_sin(k * s) for k in {k for series in self._series for k in series}}
        columns = []
        for series in self._exact:
            value = slope = bend = MP.mpf(0)
            for k, a, b in series:
                cos, sin = turns[k]
                even, odd = a * cos + b * sin, b * cos - a * sin
                value, slope, bend = value + even, slope + k * odd, bend - k * k * even
            columns.append((value, slope * w, bend * w * w))
        return list(zip(*columns, strict=True))


def precise_distance(curves: Sequence[Curve], points: np.ndarray) -> np.ndarray:
    """Unsigned distance to the nearest of the curves, rounded once: (n, 2) -> (n,)."""
    t = np.linspace(0.0, 1.0, _FIRST + 1)
    origin = curves[0].points(t[:1], np.zeros(2))[0]
    samples = np.stack([curve.points(t, origin) for curve in curves])
    slack = np.array([curve.speed for curve in curves])[:, None] / _FIRST
    size = float(np.abs(samples).max())
    return np.array([_distance(curves, samples, slack, size, origin, p) for p in points])


def _distance(
    curves: Sequence[Curve],
    samples: np.ndarray,
    slack: np.ndarray,
    size: float,
    origin: np.ndarray,
    point: np.ndarray,
) -> float:
    away = np.linalg.norm(samples - (point - origin), axis=-1)
    rounding = _ROUNDING * size
    limit = away.min() + rounding
    # No point of a stretch is nearer than the mean of its ends less half its length.
    kept = np.argwhere(0.5 * (away[:, :-1] + away[:, 1:] - slack) <= limit)
    starts: list[tuple[float, int, float, float]] = []
    for which in np.unique(kept[:, 0]):
        cells = kept[kept[:, 0] == which, 1] / _FIRST
        minima = _minima(curves[which], cells, point, limit, rounding)
        starts += [(d, which, t, h) for d, t, h in minima]
    limit = min(d for d, *_ in starts) + rounding
    near = sorted(s for s in starts if s[0] - curves[s[1]].speed * s[3] <= limit)
    # At the center of a circle all samples tie: the rest is no better than rounding.
    return min(_newton(curves[which], point, t, h) for _, which, t, h in near[:20])


def _minima(
    curve: Curve, cells: np.ndarray, point: np.ndarray, limit: float, rounding: float
) -> list[tuple[float, float, float]]:
    """Local minima among finer samples of the cells: distance, parameter, step."""
    width = 1.0 / _FIRST
    for _ in range(2):
        width /= _FINER
        t = cells[:, None] + width * np.arange(_FINER + 1)
        away = np.linalg.norm(curve.points(t.ravel(), point), axis=-1).reshape(t.shape)
        ends = np.pad(away, ((0, 0), (1, 1)), constant_values=np.inf)
        lowest = (ends[:, 1:-1] <= ends[:, :-2]) & (ends[:, 1:-1] <= ends[:, 2:])
        lowest &= away - curve.speed * width <= limit
        found_t, found = t[lowest], away[lowest]
        if len(found) == 0:
            return []
        limit = min(limit, found.min() + rounding)
        # Many only at the center of a circle, where all are as good.
        found_t, found = found_t[:200], found[:200]
        cells = np.clip(np.concatenate([found_t - width, found_t]), 0.0, 1.0 - width)
        cells = np.unique(cells)
    return [(float(d), float(t), width) for d, t in zip(found, found_t, strict=True)]


def _newton(curve: Curve, point: np.ndarray, start: float, step: float) -> float:
    """The distance at the foot near a parameter; the ends of the curve stop it."""
    at = MP.mpf(float(point[0])), MP.mpf(float(point[1]))
    low, high = MP.mpf(max(start - step, 0.0)), MP.mpf(min(start + step, 1.0))
    t = MP.mpf(start)
    at_low, at_t, at_high = (_squared(curve, at, s) for s in (low, t, high))
    best = min(at_low[0], at_high[0])
    # Where it rises all the way, or falls, that is the least: halving would take long to end there.
    if (at_low[1] >= 0) == (at_t[1] >= 0) == (at_high[1] >= 0):
        return float(MP.sqrt(best))
    for _ in range(_NEWTON_STEPS):
        square, h, slope = at_t
        best = min(best, square)
        low, high = (t, high) if h < 0 else (low, t)
        moved = t - h / slope if slope > 0 else low - 1
        if not low <= moved <= high:
            moved = (low + high) / 2
        close, t = abs(moved - t) < _CLOSE, moved
        at_t = _squared(curve, at, t)
        if close:
            break
    return float(MP.sqrt(min(best, at_t[0])))


def _squared(curve: Curve, at: tuple[Number, Number], t: Number) -> tuple[Number, Number, Number]:
    """The squared distance and halves of its derivatives: D, D' / 2, D'' / 2."""
    (x, y), (dx, dy), (ddx, ddy) = curve.exact(t)
    x, y = x - at[0], y - at[1]
    return x * x + y * y, x * dx + y * dy, dx * dx + dy * dy + x * ddx + y * ddy


def _mp(value: Fraction) -> Number:
    return MP.mpf(value.numerator) / value.denominator


def _monomials(bernstein: list[Fraction]) -> list[Fraction]:
    """Coefficients of 1, t, t², ... from Bernstein-Bézier ones: binomial times differences."""
    degree = len(bernstein) - 1
    result, row = [], bernstein
    for k in range(degree + 1):
        result.append(math.comb(degree, k) * row[0])
        row = [b - a for a, b in pairwise(row)]
    return result
