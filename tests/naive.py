"""Slow and obvious versions of what the package does fast; they share no code with it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree

Curve = Callable[[np.ndarray], np.ndarray]


def curve_distance(
    curve: Curve, start: float, stop: float, points: np.ndarray, samples: int = 200_000
) -> np.ndarray:
    """Unsigned distance to a smooth closed curve: nearest of many samples, then two parabolas.

    A parabola through the squared distances at a parameter and a sample step on both sides has
    its lowest point within the squared step of the true foot; a narrower one about that point is
    right to rounding. Only where two minima tie to within the squared step can it take the other.
    """
    step = (stop - start) / samples
    t = start + step * np.arange(samples)
    # Nearly equidistant samples are many; of trees that find the same, this one is quickest there.
    tree = cKDTree(curve(t), compact_nodes=False, balanced_tree=False)
    nearest, sample = tree.query(points)
    foot = t[sample]
    for width in (step, step / 30.0):
        before, at, after = (
            np.sum((curve(foot + shift) - points) ** 2, axis=-1) for shift in (-width, 0.0, width)
        )
        bend = np.maximum(before - 2.0 * at + after, np.finfo(float).tiny)
        foot += np.clip(0.5 * (before - after) / bend, -1.0, 1.0) * width
    return np.minimum(nearest, np.linalg.norm(curve(foot) - points, axis=-1))


def winding_number(polyline: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Sum of the angles under which the closed polyline's sides are seen, in turns."""
    result = np.zeros(len(points))
    for a, b in zip(polyline, np.roll(polyline, -1, axis=0), strict=True):
        u, v = a - points, b - points
        result += np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], np.sum(u * v, axis=1))
    return np.rint(result / (2.0 * np.pi)).astype(int)
