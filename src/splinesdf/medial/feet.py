"""Points and normals of a walk at many places at once."""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.medial.tables import FAN, ROUND, Walk


def points_and_normals(walk: Walk, element: Ints, at: Floats) -> tuple[Floats, Floats]:
    """Points (n, 2) of a walk at places (n,), and unit normals there, into the region."""
    from splinesdf.medial.kernels.disks import frames

    rows = np.empty((len(element), 4))
    frames(walk, np.ascontiguousarray(element), np.ascontiguousarray(at), rows)
    return rows[:, :2], rows[:, 2:]


def arms(
    walk: Walk, element: Ints, at: Floats, center: Floats, size: float
) -> tuple[Floats, Floats]:
    """Feet (n, 2), and unit vectors from them to the centers of disks that touch there.

    These are the normals; around a corner, and along a circle, they are better known by the center.
    """
    foot, normal = points_and_normals(walk, element, at)
    kind, numbers = walk.element[element, 0], walk.numbers[element]
    round_ = kind == ROUND
    arm = np.where(round_[:, None], numbers[:, 4:6] - center, center - foot)
    arm = np.where((round_ & (numbers[:, 6] < 0.0))[:, None], -arm, arm)
    length = np.hypot(arm[:, 0], arm[:, 1])
    clear = (round_ | (kind == FAN)) & (length > 1e-6 * size)
    with np.errstate(divide="ignore", invalid="ignore"):
        return foot, np.where(clear[:, None], arm / length[:, None], normal)
