"""Named tables of arrays that the stages of an offset, and their kernels, hand on."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.arclets.tables import Scratch
from splinesdf.ground.arrays import Bools, Floats, Ints

# Columns of a frame, see `OffsetSegments`.
POINT, TANGENT, SPEED = slice(0, 2), slice(2, 4), 4


class OffsetSegments(NamedTuple):
    """Directed segments of an offset: parts of parallels, of arcs around corners, and bridges.

    Every stage of an offset is handed this table and hands one on: `trimmed` makes it, `loops`
    moves ends and orders rows, `runs` groups rows, the fit reads it. Lengths are in the shape's
    unit. A frame is the point, relative to the boundary's origin, the unit tangent of the shape
    there, the parallel's speed (by the parameter) and its curvature (1 / unit): x, y, tx, ty,
    speed, curvature; of a bridge it is the point and NaN.
    """

    elements: Ints  # (n, 2) the arclet, -1 for a bridge; 1 for the arc around its end, else 0
    spans: Floats  # (n, 2) parameters of the element at start and end, mostly in [0, 1]
    start: Floats  # (n, 6) frames where segments start
    end: Floats  # (n, 6) frames where they end


class Loops(NamedTuple):
    """Closed loops of segments, one after the other."""

    segments: OffsetSegments  # n rows, each ending where the next of its loop starts, to the bit
    center: Floats  # (n, 2) of a bridge that is a circular arc, NaN for all others
    smooth: Bools  # (n,) whether the tangent is continuous where the segment ends
    first: Ints  # (n_loops + 1,) loop j has the rows first[j]:first[j + 1]


class Parallels(NamedTuple):
    """Parallels of arclets at a distance, and arcs around the arclets' ends."""

    distance: float  # positive to the right of the boundary, which is outward
    arcs: Floats  # of `Joints`, as are turn and tangents
    turn: Floats
    tangents: Floats


class Walls(NamedTuple):
    """Arclets that parallels are trimmed by, where these are nearer than the distance."""

    tree: Floats  # of `Arclets`
    arcs: Floats  # of `Arclets`
    bends: Floats  # rows of `Bends`
    touch: Ints  # of `Joints`
    grain: float  # distances that exceed that of the parallels by no more count as nearer


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
    """Columns of the segments that are left of parallels, as the kernel fills them in."""

    elements: Ints  # (room, 2) of `OffsetSegments`, as are spans
    spans: Floats  # (room, 2)
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
    """Segments of an offset between breaks, see `splinesdf.offsets.runs`."""

    segments: OffsetSegments  # n rows
    first: Ints  # (n_runs + 1,) run r has the rows first[r]:first[r + 1]
    kind: Ints  # (n_runs,) as in `Kinds`
    center: Floats  # (n_runs, 2) of a round run
    sweep: Floats  # (n_runs,) radians, of a round run, positive to the left
    closed: Bools  # (n_runs,) whether it is a whole loop without a corner


class Path(NamedTuple):
    """A run of `Runs`, as conic arcs are fitted to it."""

    elements: Ints  # (n, 2) rows of `OffsetSegments`, as are spans
    spans: Floats  # (n, 2)
    start: tuple[float, float]  # point
    end: tuple[float, float]
    closed: bool


class RunArcs(NamedTuple):
    """Conic arcs fitted to runs, in the order of the runs."""

    arcs: Floats  # (n, 3, 2) control points, relative to the boundary's origin
    weights: Floats  # (n,) of the middle control points
    owner: Ints  # (n,) the run


class Fitted(NamedTuple):
    """Conic arcs of runs, as the kernel fills them in."""

    room: RunArcs
    total: Ints  # (1,) how many there are, even if there is no room for all
