"""Points of the untrimmed offset: parallel curves of arclets, and arcs around corners.

The parallel of an arclet c at the distance d is c + d N, with N its unit normal to the right; it
moves with the velocity c' (1 + kappa d). Where the curve turns away from the offset's side, an arc
of radius |d| around the corner leads from one parallel to the next.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.offsets.tables import Parallels

# Of an arclet's larger control step: slower than this, its direction is half rounding, and that
# of its end is taken. Only within 1e-8 of a cusp.
_STANDS = 1e-8


@uncounted
def parallel_point(
    parallels: Parallels, element: tuple[int, int], t: float
) -> tuple[float, float, float, float, float, float]:
    """Point, unit tangent of the shape there, speed and curvature of the parallel.

    Parameters
    ----------
    parallels : Parallels
    element : tuple of int
        The arclet, and whether its parallel (0) or the arc around its end (1) is meant.
    t : float
        Parameter in [0, 1].

    Returns
    -------
    x, y, tx, ty, speed, curvature
        The speed is negative where the parallel runs backward. The curvature is that of the
        parallel, positive to the left, and infinite where the speed is zero.
    """
    i, corner = element
    arcs, distance = parallels.arcs, parallels.distance
    if corner:
        angle = t * parallels.turn[i]
        c, s = math.cos(angle), math.sin(angle)
        ax, ay = parallels.tangents[i, 2], parallels.tangents[i, 3]
        tx, ty = c * ax - s * ay, c * ay + s * ax
        x, y = arcs[i, 1] + distance * ty, arcs[i, 2] - distance * tx
        return x, y, tx, ty, distance * parallels.turn[i], 1.0 / distance
    degree = int(arcs[i, 0])
    x = y = dx = dy = ddx = ddy = 0.0
    for k in range(3 + 2 * degree, 3, -2):
        # As `arclet.derivatives`, but ddx is half of the second: to call that from here changes the
        # last bits of offsets.
        ddx, ddy = ddx * t + dx, ddy * t + dy
        dx, dy = dx * t + x + arcs[i, k], dy * t + y + arcs[i, k + 1]
        x, y = (x + arcs[i, k]) * t, (y + arcs[i, k + 1]) * t
    if t == 1.0:
        x, y = arcs[i, 1], arcs[i, 2]
    else:
        x, y = arcs[i, 3] + x, arcs[i, 4] + y
    speed = math.sqrt(dx * dx + dy * dy)
    extent = abs(arcs[i, 1] - arcs[i, 3]) + abs(arcs[i, 2] - arcs[i, 4])
    if speed <= _STANDS * extent:
        first = 0 if t < 0.5 else 2
        tx, ty = parallels.tangents[i, first], parallels.tangents[i, first + 1]
        return x + distance * ty, y - distance * tx, tx, ty, 0.0, np.inf
    tx, ty = dx / speed, dy / speed
    curvature = 2.0 * (dx * ddy - dy * ddx) / (speed * speed * speed)
    width = 1.0 + curvature * distance
    return x + distance * ty, y - distance * tx, tx, ty, speed * width, curvature / width


@kernel
def parallel_points(parallels: Parallels, elements: Ints, at: Floats, rows: Floats) -> None:
    """Fill what `parallel_point` returns, for elements (n, 2) at parameters (n,): (n, 6)."""
    for k in range(elements.shape[0]):
        element = (elements[k, 0], elements[k, 1])
        x, y, tx, ty, speed, curvature = parallel_point(parallels, element, at[k])
        rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3] = x, y, tx, ty
        rows[k, 4], rows[k, 5] = speed, curvature
