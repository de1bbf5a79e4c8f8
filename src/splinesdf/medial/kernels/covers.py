"""Places of closest points, and largest disks that cover points."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.nearest import room_to_search, search
from splinesdf.arclets.tables import Searched
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel
from splinesdf.medial.kernels.frames import NONE, ROOT
from splinesdf.medial.tables import Walk


@kernel
def places(searched: Searched, walk: Walk, points: Floats, element: Ints, at: Floats) -> None:
    """Fill the elements and parameters of the closest points of points, in the first column."""
    scratch = room_to_search(searched.arcs)
    for i in range(points.shape[0]):
        scratch.nodes[0] = 0
        _, arclet, t = search(
            searched.tree,
            searched.arcs,
            (points[i, 0], points[i, 1]),
            np.inf,
            ROOT,
            NONE,
            -1.0,
            scratch,
        )
        element[i, 0], at[i, 0] = walk.of_arclet[arclet, 0], t


@kernel
def largest_cover(disks: Floats, points: Floats, slack: float, radius: Floats) -> None:
    """Fill the radius of the first disk (x, y, r) that covers a point, or misses it by little."""
    for i in range(points.shape[0]):
        for k in range(disks.shape[0]):
            dx, dy = points[i, 0] - disks[k, 0], points[i, 1] - disks[k, 1]
            if math.sqrt(dx * dx + dy * dy) <= disks[k, 2] + slack:
                radius[i] = disks[k, 2]
                break
