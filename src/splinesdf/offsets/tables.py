"""Named bundles of arrays that the kernels of this folder read."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.ground.arrays import Bools, Floats, Ints


class Trimming(NamedTuple):
    """What is asked of an offset."""

    distance: float  # positive to the right of the boundary, which is outward
    bends: Floats  # rows of `Bends`
    smooth: float  # a joint that turns by less (radians) is none
    cusp: float  # one that turns by half a turn within this (radians) is a cusp
    grain: float  # what is not farther than the distance by more is nearer
    shortest: float  # a stretch that reaches no farther counts as its middle does


class Runs(NamedTuple):
    """Stretches of an offset between breaks, see `splinesdf.offsets.runs`."""

    elements: Ints  # (n, 2) the arclet, and 1 for the arc around its end, else 0
    spans: Floats  # (n, 2) parameters at start and end
    start: Floats  # (n, 2) points
    end: Floats  # (n, 2)
    first: Ints  # (n_runs + 1,) run r has the stretches first[r]:first[r + 1]
    kind: Ints  # (n_runs,) as in `Kinds`
    center: Floats  # (n_runs, 2) of a round one
    sweep: Floats  # (n_runs,) of a round one, positive to the left
    closed: Bools  # (n_runs,) it is a whole loop without a corner
