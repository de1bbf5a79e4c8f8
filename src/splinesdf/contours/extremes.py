"""Where conic arcs reach farthest along the axes."""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats


def extremes(arcs: Floats, weights: Floats) -> Floats:
    """Ends of arcs and points with a tangent along an axis: (n, 3, 2), (n,) -> (m, 2).

    With u = t / (1 - t) the derivative is a + b u + c u², divided by what is positive.
    """
    first, w = arcs[:, 0], weights[:, None]
    b = arcs[:, 2] - first
    a = w * (arcs[:, 1] - first)
    c = w * b - a
    root = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
    q = -0.5 * (b + np.where(b < 0.0, -root, root))  # the larger one: nothing cancels
    points = [arcs[:, 0], arcs[:, 2]]
    with np.errstate(divide="ignore", invalid="ignore"):
        # t = u / (1 + u) of the roots u = q / c and a / q; 0 / 0 where all is zero.
        for t in (q / (q + c), a / (q + a)):
            inner = np.where((t > 0.0) & (t < 1.0), t, 0.0)
            for axis in (0, 1):
                points.append(evaluate_each(arcs, weights, inner[:, axis]))
    return np.concatenate(points)


def evaluate_each(arcs: Floats, weights: Floats, parameters: Floats) -> Floats:
    """One point of each arc, at its own parameter: (n, 3, 2), (n,), (n,) -> (n, 2)."""
    t = parameters[:, None]
    middle, last = 2.0 * weights[:, None] * t * (1.0 - t), t**2
    total = (1.0 - t) ** 2 + middle + last
    first = arcs[:, 0]
    result: Floats = first + (middle * (arcs[:, 1] - first) + last * (arcs[:, 2] - first)) / total
    return result
