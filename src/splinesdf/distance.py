"""Exact signed distance and closest point of a `Shape`: the ground of every number here.

points ─ blocks ─→ kernels.nearest (distance, closest point) ─→ kernels.winding (side)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from splinesdf._arrays import Floats, as_points
from splinesdf._blocks import in_blocks
from splinesdf.curves.shape import Shape

# Closer to the boundary than this share of the size, the vector from the closest point is mostly
# rounding. Larger: good directions are withheld; smaller: noise is given as a direction.
_NO_DIRECTION = 1e-12


def signed_distance(shape: Shape, points: ArrayLike) -> Floats:
    """Distance to the boundary of the shape, negative inside.

    Parameters
    ----------
    shape : Shape
    points : array_like, shape (..., 2)

    Returns
    -------
    ndarray, shape (...,)
        In the unit of ``points``: the global minimum over the boundary to rounding, about 1e-15
        of the larger of distance and size. Points that are not finite give NaN. On the medial
        axis the gradient does not exist; the distance does.

    References
    ----------
    [Wang2014] Definition 2; negative inside, unlike its introduction.
    """
    array = as_points(points)
    distance, _ = _project(shape, array.reshape(-1, 2), sign=True)
    return distance.reshape(array.shape[:-1])


def closest_point(shape: Shape, points: ArrayLike) -> Floats:
    """The boundary point nearest to each point; on the medial axis one of several.

    Parameters
    ----------
    shape : Shape
    points : array_like, shape (..., 2)

    Returns
    -------
    ndarray, shape (..., 2)
        NaN where the point is not finite.
    """
    array = as_points(points)
    _, closest = _project(shape, array.reshape(-1, 2), sign=False)
    return closest.reshape(array.shape)


def distance_and_gradient(shape: Shape, points: ArrayLike) -> tuple[Floats, Floats]:
    """Signed distance and its gradient, the unit vector away from the inside.

    Parameters
    ----------
    shape : Shape
    points : array_like, shape (..., 2)

    Returns
    -------
    distance : ndarray, shape (...,)
    gradient : ndarray, shape (..., 2)
        Good to about 1e-16 × size / distance; NaN within 1e-12 × size of the boundary, where no
        digit is left. On the medial axis one of several.
    """
    array = as_points(points)
    distance, closest = _project(shape, array.reshape(-1, 2), sign=True)
    lost = np.abs(distance) <= _NO_DIRECTION * shape.size
    gradient = (array.reshape(-1, 2) - closest) / np.where(lost, np.nan, distance)[:, None]
    return distance.reshape(array.shape[:-1]), gradient.reshape(array.shape)


def _project(shape: Shape, points: Floats, *, sign: bool) -> tuple[Floats, Floats]:
    from splinesdf.kernels.nearest import nearest, winding  # Numba loads only when it is used

    arclets = shape.arclets
    local = points - arclets.origin
    count = len(local)
    distance, closest = np.empty(count), np.empty((count, 2))

    def work(part: slice) -> None:
        size = part.stop - part.start
        arclet, at = np.empty(size, dtype=np.int64), np.empty(size)
        nearest(arclets, local[part], distance[part], closest[part], arclet, at)
        if sign:
            number = np.empty(size, dtype=np.int64)
            winding(arclets, local[part], distance[part], number)
            inside = number != 0 if shape.fill == "nonzero" else number % 2 != 0
            distance[part][inside] *= -1.0

    in_blocks(count, work)
    closest += arclets.origin
    return distance, closest
