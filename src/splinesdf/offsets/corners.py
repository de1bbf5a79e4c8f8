"""Corners of an offset, in which two parallels cross: solved by Newton's method.

Trimming leaves the end of a segment and the start of the next at nearly the same point, each to
rounding over the sine of the angle between the parallels; here both are moved until they meet.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.arclets.points import angles
from splinesdf.arclets.thresholds import OVERLAP
from splinesdf.distance.exact import signed_distance
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.offsets.tables import POINT, SPEED, TANGENT, OffsetSegments
from splinesdf.offsets.trimmed import joints_at, parallels
from splinesdf.shapes.shape import Shape

# Steps of Newton's method from where trimming left two segments to their crossing. Where parallels
# nearly touch, steps go too far and are halved. Fewer: such corners stay where trimming left them.
_STEPS = 24
# Where two parallels cross at an angle of 1e-8, trimming may leave a gap of this share of the size.
# Smaller: gaps between segments that are nearly on one line stay open, and get bridges.
_SHALLOW = 1e-5
# A parallel whose distance from the boundary is off by less than this share of the size was cut by
# rounding only. Larger: points to which the boundary is nearer by as much stay in.
_ROUNDING = 1e-12
# Parallels may cross so far (in the parameter) beyond the end of an arclet, on its continuation.
_BEYOND = 1e-3
# Gaps below this share of the tolerance are closed by moving both ends, wider gaps by bridges.
_MOVED = 1e-3


class Corners(NamedTuple):
    """Ends of segments, and the starts of other segments that they are to meet."""

    ending: Ints  # (m,) the segment that ends in the corner
    starting: Ints  # (m,) the segment that starts there, each once
    size: Floats  # (m,) of the boundary's loop that the ending segment is about


class Bridges(NamedTuple):
    """Straight lines and circular arcs over gaps in corners."""

    after: Ints  # (k,) the segment that ends there
    center: Floats  # (k, 2) of an arc, NaN for a line
    smooth: Bools  # (k,) whether the tangent is continuous at its ends


def solved(
    shape: Shape, segments: OffsetSegments, corners: Corners, distance: float, smooth: float
) -> OffsetSegments:
    """Move the ends and starts of corners to where their parallels cross or run on."""
    segments = _drawn_back(shape, segments, corners, distance)
    segments = _to_crossings(shape, segments, corners, distance)
    return _filled_in(shape, segments, corners, distance, smooth)


def _drawn_back(
    shape: Shape, segments: OffsetSegments, corners: Corners, distance: float
) -> OffsetSegments:
    """Shorten segments that overlap, nearly on one line: the quicker of two begins later.

    Next to a cusp parallels turn back so shortly that rounding hides where they cross.
    """
    ending, starting, size = corners
    gap = segments.start[starting, POINT] - segments.end[ending, POINT]
    length = np.hypot(*gap.T)
    arriving, leaving = segments.end[ending, TANGENT], segments.start[starting, TANGENT]
    back = (np.sum(gap * arriving, axis=1) < -0.5 * length) & (length <= _SHALLOW * size)
    back &= np.abs(angles(arriving, leaving)) <= OVERLAP
    if not back.any():
        return segments
    spans, frames = segments.spans.copy(), (segments.start.copy(), segments.end.copy())
    for a, b, away in zip(ending[back], starting[back], length[back], strict=True):
        late = abs(frames[0][b, SPEED]) >= abs(frames[1][a, SPEED])
        row, side, fixed = (b, 0, frames[1][a]) if late else (a, 1, frames[0][b])
        t, at = spans[row, side], frames[side][row]
        for _ in range(_STEPS):
            if at[SPEED] == 0.0:  # a point that stands still
                break
            t += float((fixed[POINT] - at[POINT]) @ at[TANGENT] / at[SPEED])
            if not 0.0 < t < 1.0:
                break
            at = parallels(shape, segments.elements[[row]], np.array([t]), distance)[0]
        shorter = spans[b, 0] < t < spans[b, 1] if late else spans[a, 0] < t < spans[a, 1]
        if shorter and np.hypot(*(at[POINT] - fixed[POINT])) < 0.01 * away:
            spans[row, side], frames[side][row] = t, at
    return OffsetSegments(segments.elements, spans, *frames)


def _to_crossings(
    shape: Shape, segments: OffsetSegments, corners: Corners, distance: float
) -> OffsetSegments:
    """Move ends and starts to the crossings of their parallels, by Newton's method."""
    ending, starting, _ = corners
    spans = segments.spans
    a, b = spans[ending, 1], spans[starting, 0]
    at_a, at_b = segments.end[ending], segments.start[starting]
    gap = at_b[:, POINT] - at_a[:, POINT]
    part = np.ones(len(ending))
    for _ in range(_STEPS):
        va, vb = (at[:, TANGENT] * at[:, SPEED, None] for at in (at_a, at_b))
        cross = va[:, 0] * vb[:, 1] - va[:, 1] * vb[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            step_a = part * (gap[:, 0] * vb[:, 1] - gap[:, 1] * vb[:, 0]) / cross
            step_b = part * (gap[:, 0] * va[:, 1] - gap[:, 1] * va[:, 0]) / cross
        new_a, new_b = a + step_a, b + step_b
        usable = (new_a > spans[ending, 0]) & (new_a <= 1.0 + _BEYOND)
        usable &= (new_b < spans[starting, 1]) & (new_b >= -_BEYOND)
        # A crossing beyond both ends would be a miter.
        usable &= (new_a <= 1.0) | (new_b >= 0.0)
        usable &= (new_a != a) | (new_b != b)
        if not usable.any():
            break
        new_a, new_b = np.where(usable, new_a, a), np.where(usable, new_b, b)
        new_at_a = parallels(shape, segments.elements[ending], new_a, distance)
        new_at_b = parallels(shape, segments.elements[starting], new_b, distance)
        new_gap = new_at_b[:, POINT] - new_at_a[:, POINT]
        better = np.hypot(*new_gap.T) < np.hypot(*gap.T)
        part = np.where(better, 1.0, 0.5 * part)
        a, b = np.where(better, new_a, a), np.where(better, new_b, b)
        at_a = np.where(better[:, None], new_at_a, at_a)
        at_b = np.where(better[:, None], new_at_b, at_b)
        gap = np.where(better[:, None], new_gap, gap)
    return _moved(segments, corners, (a, b), (at_a, at_b))


def _moved(
    segments: OffsetSegments,
    corners: Corners,
    at: tuple[Floats, Floats],
    frames: tuple[Floats, Floats],
) -> OffsetSegments:
    """Put ends and starts of corners at parameters, with the frames there."""
    spans, start, end = segments.spans.copy(), segments.start.copy(), segments.end.copy()
    spans[corners.ending, 1], spans[corners.starting, 0] = at
    end[corners.ending], start[corners.starting] = frames
    return OffsetSegments(segments.elements, spans, start, end)


def _filled_in(
    shape: Shape, segments: OffsetSegments, corners: Corners, distance: float, smooth: float
) -> OffsetSegments:
    """Let smooth parallels run on where only rounding has cut them.

    That happens beside a point of the shape in which another branch touches this one.
    """
    ending, starting, size = corners
    elements, spans = segments.elements, segments.spans
    (i, corner), (j, other_corner) = elements[ending].T, elements[starting].T
    end, start = spans[ending, 1], spans[starting, 0]
    same = (i == j) & (end < start)
    joints = joints_at(shape, distance)
    next_ = (joints.following[i] == j) & (np.abs(joints.turn[i]) <= smooth)
    gap = np.hypot(*(segments.start[starting, POINT] - segments.end[ending, POINT]).T)
    cut = (corner + other_corner == 0) & (same | next_) & (gap > 0.0)
    cut &= gap <= _SHALLOW * size
    if not cut.any():
        return segments
    corners = Corners(ending[cut], starting[cut], size[cut])
    same, middle = same[cut], 0.5 * (end + start)[cut]
    at = np.where(same, middle, 1.0), np.where(same, middle, 0.0)
    ends = parallels(shape, elements[corners.ending], at[0], distance)
    starts = parallels(shape, elements[corners.starting], at[1], distance)
    exact = signed_distance(shape, ends[:, POINT] + shape.boundary.origin)
    near = np.abs(exact - distance) <= _ROUNDING * (shape.size + abs(distance))
    near &= ends[:, SPEED] > 0.0
    corners = Corners(corners.ending[near], corners.starting[near], corners.size[near])
    return _moved(segments, corners, (at[0][near], at[1][near]), (ends[near], starts[near]))


def bridged(
    shape: Shape, segments: OffsetSegments, corners: Corners, distance: float, tolerance: float
) -> Bridges | None:
    """Bridge gaps that are still open; None if a bridge would leave the tolerance."""
    gap = np.hypot(
        *(segments.start[corners.starting, POINT] - segments.end[corners.ending, POINT]).T
    )
    wide = gap > _MOVED * tolerance
    if not wide.any():
        none = np.empty(0, dtype=np.int64)
        return Bridges(none, np.empty((0, 2)), none.astype(np.bool_))
    end, start = segments.end[corners.ending[wide]], segments.start[corners.starting[wide]]
    # The points of the shape whose parallels these are.
    foot, other_foot = (
        at[:, POINT] - distance * np.stack([at[:, 3], -at[:, 2]], axis=-1) for at in (end, start)
    )
    apart = np.hypot(*(other_foot - foot).T)
    turn = angles(end[:, TANGENT], start[:, TANGENT])
    # Both ends belong to one point of the shape: next to a corner too small for its tangents.
    around = (apart <= _MOVED * tolerance) & (turn * distance > 0.0)
    center = np.where(around[:, None], 0.5 * (other_foot + foot), np.nan)
    middle = 0.5 * (end[:, POINT] + start[:, POINT])
    bulge = middle - center
    with np.errstate(divide="ignore", invalid="ignore"):
        bulge *= (abs(distance) / np.hypot(bulge[:, 0], bulge[:, 1]))[:, None]
    middle = np.where(around[:, None], center + bulge, middle)
    exact = signed_distance(shape, middle + shape.boundary.origin)
    if not (np.abs(exact - distance) <= 0.5 * tolerance).all():
        return None
    return Bridges(corners.ending[wide], center, around)
