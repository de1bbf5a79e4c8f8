"""Named bundles of arrays that the kernels of this folder read."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.arclets.tables import Scratch
from splinesdf.ground.arrays import Bools, Floats, Ints


class Parallels(NamedTuple):
    """Parallels of arclets at a distance, and arcs around their ends: what their points are of."""

    distance: float  # positive to the right of the boundary, which is outward
    arcs: Floats  # of `Joints`, as are the others
    turn: Floats
    tangents: Floats


class Walls(NamedTuple):
    """Arclets that may be nearer to parallels than their distance."""

    tree: Floats  # of `Arclets`
    arcs: Floats  # of `Arclets`
    bends: Floats  # rows of `Bends`
    touch: Ints  # of `Joints`
    grain: float  # what is not farther than the distance by more is nearer


class Turns(NamedTuple):
    """How a boundary turns, loop after loop: all of `Joints`."""

    order: Ints
    loops: Ints
    turn: Floats
    turning: Floats


class Chains(NamedTuple):
    """How far each arclet's own chain reaches, loop after loop."""

    order: Ints  # of `Joints`, as are loops and place
    loops: Ints
    place: Ints
    bent: Bools  # from `splinesdf.offsets.kernels.safe_chains`, as is reach
    reach: Ints


class Trimmed(NamedTuple):
    """Stretches of parallels that are left, as the kernel fills them in."""

    elements: Ints  # (room, 2) the arclet, and 1 for the arc around its end, else 0
    spans: Floats  # (room, 2) parameters at start and end
    # (3,) how many there are, even if there is no room for all; how many there were before those
    # of the present element; how many stretches have been looked at
    counts: Ints


class Workroom(NamedTuple):
    """Room that trimming uses again and again."""

    parts: Floats  # (n, 2) of an arclet, where its parallel runs forward
    near: Ints  # (n,) arclets that may be near to a stretch
    stack: Floats  # (n, 4) stretches still to be looked at
    spans: Floats  # (n, 2) the same, of those to which something is near at both ends
    scratch: Scratch


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


class Path(NamedTuple):
    """One of `Runs`, as conic arcs are fitted to it."""

    elements: Ints  # (n, 2) of its stretches
    spans: Floats  # (n, 2)
    start: tuple[float, float]  # point
    end: tuple[float, float]
    closed: bool


class Fitted(NamedTuple):
    """Conic arcs of runs, as the kernel fills them in."""

    arcs: Floats  # (room, 3, 2)
    weights: Floats  # (room,)
    owner: Ints  # (room,) the run
    total: Ints  # (1,) how many there are, even if there is no room for all
