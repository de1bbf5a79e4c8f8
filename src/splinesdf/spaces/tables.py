"""Named bundles of arrays that the kernels of this folder read."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.ground.arrays import Ints


class Nodes(NamedTuple):
    """A quadtree that grows, see `splinesdf.spaces.kernels.hierarchical`."""

    shape: Ints  # (2,) roots each way in the domain; one more on each side around it
    level: Ints  # (n,)
    place: Ints  # (n, 2) the cell of its level, from -1 on
    child: Ints  # (n,) first of four children, -1 for none
    near: Ints  # (n, 9) the 3 x 3 nodes around, negative where there is none
