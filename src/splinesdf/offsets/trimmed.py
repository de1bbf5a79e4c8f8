"""Segments of parallels that nothing is nearer to, see `splinesdf.offsets.kernels.trim`."""

from __future__ import annotations

import numpy as np

from splinesdf.arclets.tables import Joints
from splinesdf.arclets.thresholds import SMOOTH, TANGENT_NOISE
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.offsets.tables import Chains, OffsetSegments, Parallels, Turns, Walls
from splinesdf.shapes.shape import Shape

# Rounding in a distance, as a share of the largest number around. Walls whose distance exceeds that
# of the parallels by no more count as nearer, so that walls just twice the distance apart leave
# nothing between them. Smaller: rounding decides there; larger: slots nearly as narrow are lost.
_GRAIN = 64 * 2.220446049250313e-16
# Segments shorter than this share of the tolerance are judged by their middles.
_SHORTEST = 1e-3
# Joints that turn by less than `SMOOTH` are smooth only if they leave open or doubled less of the
# offset, along its tangent, than this share of the tolerance. Larger: gaps and overlaps are seen;
# smaller: far out, rounding in tangents makes corners.
_DOUBLED = 1e-3
# Room for segments at first, 32 KB. Fewer: segments that do not fit are found, and counted one by
# one where they would be joined, and all are looked for once more; more: memory is touched in vain.
_ROOM = 1024


def trimmed(
    shape: Shape, distance: float, tolerance: float, smooth: float = SMOOTH
) -> OffsetSegments:
    """Trim all parallels at a distance: segments to which nothing is nearer, in order along loops.

    Parameters
    ----------
    shape : Shape
    distance : float
        Not 0.
    tolerance : float
        Segments far shorter than it may be missing.
    smooth : float
        Joints that turn by less (radians) have no corner, see `smooth_turn`.

    Raises
    ------
    InputError
        If that takes too long.
    """
    from splinesdf.offsets.kernels.safe_chains import own_chains  # Numba loads only when it is used
    from splinesdf.offsets.kernels.trim import MOST_LOOKS, trim

    joints, walls = joints_at(shape, distance), walls_at(shape, distance)
    shortest = max(_SHORTEST * tolerance, walls.grain)
    count = len(walls.bends)
    bent, reach = np.empty(count, dtype=np.bool_), np.empty((count, 3), dtype=np.int64)
    turns = Turns(joints.order, joints.loops, joints.turn, joints.turning)
    own_chains(turns, walls.bends, distance, bent, reach)
    chains = Chains(joints.order, joints.loops, joints.place, bent, reach)
    room = 2 * count + _ROOM
    while True:
        elements, spans = np.empty((room, 2), dtype=np.int64), np.empty((room, 2))
        found = trim(
            parallels_at(shape, distance), walls, chains, smooth, shortest, elements, spans
        )
        if found < 0:
            raise InputError(
                f"expected a distance whose parallels are told apart by {MOST_LOOKS:,} looks, got "
                f"{distance:g}, which takes more: ask for another, or offset loops by themselves"
            )
        if found <= room:
            return segments_at(shape, elements[:found], spans[:found], distance)
        room = found


def whole(shape: Shape) -> OffsetSegments:
    """Take the boundary itself: the offset at the distance 0."""
    order = shape.joints.order
    elements = np.column_stack([order, np.zeros_like(order)])
    return segments_at(shape, elements, np.tile([0.0, 1.0], (len(order), 1)), 0.0)


def segments_at(shape: Shape, elements: Ints, spans: Floats, distance: float) -> OffsetSegments:
    """Make segments of parallels between parameters (n, 2) of their elements (n, 2)."""
    start, end = (parallels(shape, elements, at, distance) for at in spans.T)
    return OffsetSegments(elements, spans, start, end)


def selected(segments: OffsetSegments, rows: Ints | Bools) -> OffsetSegments:
    """Take some rows of the table, in the order given."""
    elements, spans, start, end = segments
    return OffsetSegments(elements[rows], spans[rows], start[rows], end[rows])


def stacked(first: OffsetSegments, second: OffsetSegments) -> OffsetSegments:
    """Append the rows of a second table to those of a first."""
    elements, spans, start, end = (
        np.concatenate(columns) for columns in zip(first, second, strict=True)
    )
    return OffsetSegments(elements, spans, start, end)


def joints_at(shape: Shape, distance: float) -> Joints:
    """Take the joints as seen from the side that an offset is on."""
    return shape.joints_outside if distance > 0.0 else shape.joints


def loop_sizes(shape: Shape, distance: float) -> Floats:
    """Measure the larger side of each arclet's loop: (n,)."""
    joints, boundary = joints_at(shape, distance), shape.boundary
    low = np.minimum(boundary.start, boundary.end)[joints.order]
    high = np.maximum(boundary.start, boundary.end)[joints.order]
    first = joints.loops[:-1]
    size = np.maximum.reduceat(high, first) - np.minimum.reduceat(low, first)
    result = np.empty(len(low))
    result[joints.order] = np.repeat(size.max(axis=1), np.diff(joints.loops))
    return result


def parallels(shape: Shape, elements: Ints, at: Floats, distance: float) -> Floats:
    """Evaluate frames, see `OffsetSegments`, at parameters (n,) of elements (n, 2): (n, 6)."""
    from splinesdf.offsets.kernels.parallels import (
        parallel_points,  # Numba loads only when it is used
    )

    rows = np.empty((len(at), 6))
    parallel_points(parallels_at(shape, distance), elements, np.ascontiguousarray(at), rows)
    return rows


def smooth_turn(distance: float, tolerance: float) -> float:
    """Bound the turn (radians) up to which a joint counts as smooth."""
    if not distance:
        return SMOOTH
    return min(SMOOTH, max(_DOUBLED * tolerance / abs(distance), TANGENT_NOISE))


def parallels_at(shape: Shape, distance: float) -> Parallels:
    """Gather what kernels read of the parallels at a distance."""
    joints = joints_at(shape, distance)
    return Parallels(distance, joints.arcs, joints.turn, joints.tangents)


def walls_at(shape: Shape, distance: float) -> Walls:
    """Gather what kernels read of the arclets that trim parallels at a distance."""
    boundary = shape.boundary
    size = float(np.abs(boundary.boxes[0]).max()) + abs(distance)
    touch = joints_at(shape, distance).touch
    return Walls(shape.search_tree.tree, boundary.arcs, shape.bends.rows, touch, _GRAIN * size)
