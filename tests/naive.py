"""Slow and obvious versions of what the package does fast; they share no code with it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree

Curve = Callable[[np.ndarray], np.ndarray]


def curve_distance(
    curve: Curve, start: float, stop: float, points: np.ndarray, samples: int = 200_000
) -> np.ndarray:
    """Unsigned distance to a smooth closed curve: nearest of many samples, then golden section.

    The samples on both sides of the nearest one bracket a minimum; 45 golden cuts narrow it to
    rounding. Only where two minima tie to within the squared sample step can it take the other.
    """
    step = (stop - start) / samples
    t = start + step * np.arange(samples)
    _, nearest = cKDTree(curve(t)).query(points)
    low, high = t[nearest] - step, t[nearest] + step
    ratio = (np.sqrt(5.0) - 1.0) / 2.0

    def distance(parameter: np.ndarray) -> np.ndarray:
        return np.linalg.norm(curve(parameter) - points, axis=-1)

    for _ in range(45):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        left = distance(a) < distance(b)
        low, high = np.where(left, low, a), np.where(left, b, high)
    return np.minimum(distance(0.5 * (low + high)), distance(t[nearest]))


def winding_number(polyline: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Sum of the angles under which the closed polyline's sides are seen, in turns."""
    result = np.zeros(len(points))
    for a, b in zip(polyline, np.roll(polyline, -1, axis=0), strict=True):
        u, v = a - points, b - points
        result += np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], np.sum(u * v, axis=1))
    return np.rint(result / (2.0 * np.pi)).astype(int)
