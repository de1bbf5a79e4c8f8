"""How far inside the deepest point of a shape is: what is farther inside than that does not exist.

the box ─→ squares ─→ of each the exact distance at its center, and half its diagonal, by which any
other point of it can be deeper ─→ those that may be deeper than the deepest so far, halved again
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.distance.exact import signed_distance
from splinesdf.shapes.shape import Shape

# Squares along the larger side at first. More: work for nothing; fewer: one more round.
_FIRST = 16
# Halvings and squares after which what is known must do. More: time, where the deepest points are a
# whole line, as in a slot of equal width; fewer: a question near to the truth is left open.
_ROUNDS = 40
_MOST = 200_000
# How close the bounds come, as a share of the depth, if it is less than what is asked. Closer: more
# squares; farther: a message names a depth that nobody can work with.
_CLOSE = 0.01


def deepest(shape: Shape, asked: float) -> tuple[float, float]:
    """Bounds of how deep inside the deepest point is, close enough to compare with a depth.

    Parameters
    ----------
    shape : Shape
    asked : float
        The depth to compare with, in the shape's unit.

    Returns
    -------
    low, high : float
        To rounding. Either ``asked`` is not above ``low``, so there are points that deep; or it is
        above ``high``, so there is none, and the two differ by a hundredth at most; or it is in
        between, where 200,000 squares do not tell.
    """
    xmin, ymin, xmax, ymax = shape.box
    side = max(xmax - xmin, ymax - ymin) / _FIRST
    x, y = (
        low + side * (np.arange(max(1, math.ceil((high - low) / side))) + 0.5)
        for low, high in ((xmin, xmax), (ymin, ymax))
    )
    centers = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    low, high = 0.0, math.inf
    for _ in range(_ROUNDS):
        depth = -signed_distance(shape, centers)
        reach = side / math.sqrt(2.0)
        low = max(low, float(depth.max()))
        high = max(low, float(depth.max()) + reach)
        may = depth + reach > low
        known = low >= asked or (high < asked and high - low <= _CLOSE * high)
        if known or 4 * np.count_nonzero(may) > _MOST:
            break
        side *= 0.5
        quarters = 0.5 * side * np.array([(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)])
        centers = (centers[may][:, None] + quarters).reshape(-1, 2)
    return low, high
