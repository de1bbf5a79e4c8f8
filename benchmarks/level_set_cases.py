"""Functions with a known zero set that are no distances, for `level_sets`.

Nothing here calls the package: distances are closed formulas, or for the ellipse a bisection of its
own. Most shapes are beside the middle of their grid, so that symmetry puts no node on a curve.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.stats import ncx2

Array = np.ndarray
# Halvings of the bracket of an ellipse's foot: it is then closed to the last bit.
_HALVINGS = 110
_ALONG = 4000  # points of each true curve


@dataclass(frozen=True)
class Case:
    """A function on a square around the origin and what is true of its zero set."""

    name: str
    half: float  # of the square's side
    function: Callable[[Array, Array], Array]
    distance: Callable[[Array, Array], Array]  # exact, negative inside
    curve: Array  # (n, 2), points of the zero set
    area: float

    def nodes(self, count: int) -> Array:
        """So many steps along a side, nodes at both ends."""
        return np.linspace(-self.half, self.half, count + 1)


def wavy(x: Array, y: Array) -> Array:
    """Positive, from 0.13 to 7.4: what takes the slope away."""
    return np.asarray(np.exp(1.2 * np.sin(2.0 * x + 0.3) + 0.8 * np.cos(3.0 * y - x)))


def ring(center: tuple[float, float], a: float, b: float | None = None) -> Array:
    t = 2.0 * np.pi * np.arange(_ALONG) / _ALONG
    return np.stack([center[0] + a * np.cos(t), center[1] + (b or a) * np.sin(t)], axis=1)


def ellipse_distance(x: Array, y: Array, a: float, b: float) -> Array:
    """The foot is (a² x / (t + a²), b² y / (t + b²)), t > -b² the root of a falling function."""
    x, y = np.abs(x), np.abs(y)
    # In units of b² the root lies between the two t at which one term alone is one.
    ratio = (a / b) ** 2
    p, q = a * x / b**2, y / b
    low, high = q - 1.0, np.hypot(p, q) - 1.0
    for _ in range(_HALVINGS):
        t = 0.5 * (low + high)
        with np.errstate(divide="ignore", invalid="ignore"):
            more = (p / (t + ratio)) ** 2 + np.where(q > 0.0, (q / (t + 1.0)) ** 2, 0.0) > 1.0
        low, high = np.where(more, t, low), np.where(more, high, t)
    t = 0.5 * (low + high)
    foot_x = ratio * x / (t + ratio)
    # Near the long axis the quotient is 0 / 0, near the curve's ends the root has half the digits.
    root = b * np.sqrt(np.maximum(1.0 - (foot_x / a) ** 2, 0.0))
    foot_y = np.where(t > -0.9, y / np.maximum(t + 1.0, 0.1), root)
    inside = (x / a) ** 2 + (y / b) ** 2 < 1.0
    return np.where(inside, -1.0, 1.0) * np.hypot(x - foot_x, y - foot_y)


def circle() -> Case:
    cx, cy, radius = 0.0371, -0.0233, 1.0371

    def distance(x: Array, y: Array) -> Array:
        return np.hypot(x - cx, y - cy) - radius

    def function(x: Array, y: Array) -> Array:
        return ((x - cx) ** 2 + (y - cy) ** 2 - radius**2) * wavy(x, y)

    return Case("circle", 2.0, function, distance, ring((cx, cy), radius), np.pi * radius**2)


def ellipse() -> Case:
    """Russo and Smereka's: the slope is from a tenth to fifty times that of a distance."""
    a, b = 4.0, 2.0

    def function(x: Array, y: Array) -> Array:
        factor = 0.1 + (x - 3.5) ** 2 + (y - 2.0) ** 2
        return factor * (np.sqrt((x / a) ** 2 + (y / b) ** 2) - 1.0)

    def distance(x: Array, y: Array) -> Array:
        return ellipse_distance(x, y, a, b)

    return Case("ellipse", 5.0, function, distance, ring((0.0, 0.0), a, b), np.pi * a * b)


def two_disks(name: str, apart: float) -> Case:
    """The union of two unit disks so far apart: corners below 2, a gap above."""
    centers = np.array([[-0.5 * apart + 0.0137, 0.0219], [0.5 * apart + 0.0137, 0.0219]])
    # Half the angle of each circle that the other disk takes, and the corners there.
    taken = np.arccos(min(1.0, 0.5 * apart))
    corners = centers.mean(axis=0) + np.sin(taken) * np.array([[0.0, 1.0], [0.0, -1.0]])

    def each(x: Array, y: Array) -> Array:
        return np.stack([np.hypot(x - cx, y - cy) - 1.0 for cx, cy in centers])

    def function(x: Array, y: Array) -> Array:
        squares = [(x - cx) ** 2 + (y - cy) ** 2 - 1.0 for cx, cy in centers]
        return np.minimum(*squares) * wavy(x, y)

    def distance(x: Array, y: Array) -> Array:
        far = np.abs(each(x, y))
        for index, way in ((0, 1.0), (1, -1.0)):
            # The foot on a circle counts where the other disk does not cover it.
            across = np.arctan2(np.abs(y - centers[index, 1]), way * (x - centers[index, 0]))
            far[index] = np.where((across < taken) & (taken > 0.0), np.inf, far[index])
        if taken > 0.0:
            far = np.concatenate([far, [np.hypot(x - cx, y - cy) for cx, cy in corners]])
        return np.asarray(np.where(each(x, y).min(axis=0) < 0.0, -1.0, 1.0) * far.min(axis=0))

    both = [ring((cx, cy), 1.0) for cx, cy in centers]
    curve = np.concatenate([one[each(*one.T)[1 - k] >= 0.0] for k, one in enumerate(both)])
    curve = np.concatenate([curve, corners]) if taken > 0.0 else curve
    area = 2.0 * np.pi - (2.0 * taken - np.sin(2.0 * taken))
    return Case(name, 2.5, function, distance, curve, area)


def blurred() -> Case:
    """A grey picture: a disk blurred by a Gaussian. Gray is flat but for a band about the curve.

    What a Gaussian of width s puts within the radius R, from the distance r of its middle, is the
    noncentral chi-square distribution of (R/s)² at (r/s)², so the radius where it is a half is a
    root of one equation.
    """
    cx, cy, radius, width = 0.0371, -0.0233, 1.0371, 0.15

    def gray(r: Array | float) -> Array:
        return np.asarray(ncx2.cdf((radius / width) ** 2, 2, (np.asarray(r) / width) ** 2))

    half = brentq(lambda r: float(gray(r)) - 0.5, 0.5 * radius, radius, xtol=1e-15)

    def distance(x: Array, y: Array) -> Array:
        return np.hypot(x - cx, y - cy) - half

    def function(x: Array, y: Array) -> Array:
        return 0.5 - gray(np.hypot(x - cx, y - cy))

    return Case("gray picture", 2.0, function, distance, ring((cx, cy), half), np.pi * half**2)


def mask() -> Case:
    """The sides of the ellipse and nothing else."""
    of = ellipse()

    def function(x: Array, y: Array) -> Array:
        return np.where(of.function(x, y) < 0.0, -1.0, 1.0)

    return Case("mask", of.half, function, of.distance, of.curve, of.area)


def cases() -> list[Case]:
    overlapping, near = two_disks("corners", 1.3), two_disks("gap of 0.1", 2.1)
    return [circle(), ellipse(), overlapping, near, blurred(), mask()]
