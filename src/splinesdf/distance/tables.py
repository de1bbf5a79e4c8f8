"""Named bundles of arrays that the kernels of this folder read."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.ground.arrays import Floats, Ints


class Bent(NamedTuple):
    """Arclets, their curvature bounds, and their order along the boundary."""

    arcs: Floats  # as in `Arclets`
    following: Ints
    rows: Floats  # as in `Bends`
    second: Floats
    previous: Ints
