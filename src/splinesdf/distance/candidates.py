"""Candidates: the few parts of a boundary that can be closest in a cell."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Ints, as_floats
from splinesdf.shapes.shape import Shape


def closest_candidates(shape: Shape, boxes: ArrayLike) -> tuple[Ints, Ints]:
    """The arclets that can be closest to some point of each box.

    Parameters
    ----------
    shape : Shape
    boxes : array_like, shape (n, 4)
        xmin, ymin, xmax, ymax of each.

    Returns
    -------
    starts : ndarray, shape (n + 1,)
    arclets : ndarray, shape (starts[n],)
        Box ``i`` has ``arclets[starts[i]:starts[i + 1]]``, numbers of arclets of
        ``shape.boundary``. For every point of the box, the closest arclet is among them. Where
        the box is small and no medial axis near, they are one or two, seldom more.
    """
    from splinesdf.arclets.kernels.culling import (  # Numba loads only when it is used
        MOST_KEPT,
        cull_boxes,
    )

    array = as_floats(boxes, "boxes")
    if array.ndim != 2 or array.shape[1] != 4:
        raise InputError(f"expected boxes of shape (n, 4), got shape {array.shape}")
    boundary = shape.boundary
    count = len(array)
    starts = np.empty(count + 1, dtype=np.int64)
    nodes = np.empty(count * MOST_KEPT, dtype=np.int64)
    local = array - np.tile(boundary.origin, 2)
    cull_boxes(boundary.tree, boundary.arcs, local, starts, nodes)
    first, end = boundary.range[nodes[: starts[-1]]].T
    sizes = end - first
    ends = np.concatenate([[0], np.cumsum(sizes)])
    arclets = np.arange(ends[-1]) + np.repeat(first - ends[:-1], sizes)
    return ends[starts], arclets
