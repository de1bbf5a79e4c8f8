"""Named bundles of arrays that the kernels of this folder read."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.ground.arrays import Floats, Ints


class Border(NamedTuple):
    """A spline along the border of its domain, see `splinesdf.splines.kernels.extension`."""

    starts: Ints  # (5,) side k has the knots starts[k] to starts[k + 1] - 1
    # (n_knots, 3) where it is from the side's start, the spline there, and the ordinate in the
    # middle of the edge that begins there.
    edges: Floats
    drops: Floats  # (4, n_nodes) how far the spline falls below the chord of a node's edges
