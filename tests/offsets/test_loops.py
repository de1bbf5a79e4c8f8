"""How stretches are joined where trimming leaves them apart."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.thresholds import SMOOTH
from splinesdf.offsets.corners import Corners, _drawn_back, _filled_in
from splinesdf.offsets.loops import loops_of
from splinesdf.offsets.tables import OffsetSegments
from splinesdf.offsets.trimmed import (
    loop_sizes,
    parallels,
    segments_at,
    selected,
    trimmed,
)
from tests.named_shapes import gamma

SQUARE = ss.Shape.from_svg_path("M-1 -1H1V1H-1Z")


@pytest.mark.parametrize("corner", range(4))
def test_an_arc_that_is_missing_is_bridged_around_its_corner(corner: int) -> None:
    segments = trimmed(SQUARE, 0.3, 1e-3)
    others = (segments.elements != [corner, 1]).any(axis=1)
    loops = loops_of(SQUARE, selected(segments, others), 0.3, 1.0)
    assert loops is not None
    bridge = loops.segments.elements[:, 0] < 0
    # Where the arc was, between the same points, and smooth at both ends.
    whole = loops_of(SQUARE, segments, 0.3, 1.0)
    assert whole is not None
    assert np.array_equal(bridge, (whole.segments.elements == [corner, 1]).all(axis=1))
    starts = [table.segments.start[:, :2] for table in (loops, whole)]
    assert np.allclose(*starts, rtol=0.0, atol=1e-15)
    center = SQUARE.boundary.end[corner]
    assert np.allclose(loops.center[bridge], center, rtol=0.0, atol=1e-15)
    assert np.isnan(loops.center[~bridge]).all()
    assert loops.smooth.all()


def test_what_is_too_far_apart_for_the_tolerance_is_not_bridged() -> None:
    segments = trimmed(SQUARE, 0.3, 1e-3)
    others = (segments.elements != [0, 1]).any(axis=1)
    assert loops_of(SQUARE, selected(segments, others), 0.3, 0.1) is None


def test_corners_are_not_smooth() -> None:
    loops = loops_of(SQUARE, trimmed(SQUARE, -0.3, 1e-3), -0.3, 1e-3)
    assert loops is not None
    assert len(loops.smooth) == 4
    assert not loops.smooth.any()


@pytest.mark.parametrize(("name", "share"), [("gamma2", 0.1), ("gamma3", 0.1), ("gamma3", -0.05)])
@pytest.mark.parametrize("inside", [False, True])
def test_smooth_parallels_run_on_where_nothing_is_nearer(
    name: str, share: float, inside: bool
) -> None:
    shape = gamma(name)
    distance, count = share * shape.size, len(shape.boundary.start)
    # All parallels, cut within every third arclet, or between it and the next.
    one = np.arange(0, count - 1, 3)
    elements = np.column_stack([np.arange(count), np.zeros(count, dtype=np.int64)])
    spans = np.tile([0.0, 1.0], (count, 1))
    middle = np.where(inside, 0.5, [1.0, 0.0])
    if inside:
        elements, spans = np.repeat(elements, 2, axis=0), np.repeat(spans, 2, axis=0)
        one = 2 * one
    other = one + 1
    spans[one, 1], spans[other, 0] = middle[0] - 1e-7, middle[1] + 1e-7
    segments = segments_at(shape, elements, spans, distance)
    # Not across the corners where the curve crosses itself.
    gap = segments.end[one, :2] - segments.start[other, :2]
    near = np.hypot(*gap.T) < 1e-6 * shape.size
    one, other, before = one[near], other[near], spans.copy()
    corners = Corners(one, other, loop_sizes(shape, distance)[elements[one, 0]])
    found = _filled_in(shape, segments, corners, distance, SMOOTH)
    # The exact distance decides where they were cut.
    cut = parallels(shape, elements[one], np.full(len(one), middle[0]), distance)
    exact = ss.signed_distance(shape, cut[:, :2] + shape.boundary.origin)
    filled = (np.abs(exact - distance) < 1e-12 * shape.size) & (cut[:, 4] > 0.0)
    assert filled.any()
    assert filled.all() == (name == "gamma2")
    a, b = one[filled], other[filled]
    assert np.allclose(found.spans[a, 1], middle[0], rtol=0.0, atol=1e-15)
    assert np.allclose(found.spans[b, 0], middle[1], rtol=0.0, atol=1e-15)
    assert np.allclose(found.end[a, :2], cut[filled, :2], rtol=0.0, atol=1e-15)
    assert np.allclose(found.start[b, :2], cut[filled, :2], rtol=0.0, atol=1e-11)
    assert np.array_equal(found.spans[one[~filled]], before[one[~filled]])
    assert np.array_equal(found.spans[other[~filled]], before[other[~filled]])


def test_what_has_one_end_too_many_is_not_joined() -> None:
    segments = trimmed(SQUARE, 0.3, 1e-3)
    twice = np.append(np.arange(len(segments.spans)), 3)
    assert loops_of(SQUARE, segments, 0.3, 1e-3) is not None
    assert loops_of(SQUARE, selected(segments, twice), 0.3, 1e-3) is None


def test_a_bridge_that_leaves_the_tolerance_is_none() -> None:
    """Over the foot of a bump: near enough for its ends, but through the shape."""
    bump = ss.Shape.from_points(
        [(-1, -1), (1, -1), (1, -4e-6), (1 + 4e-6, 0), (1, 4e-6), (1, 1), (-1, 1)]
    )
    segments = trimmed(bump, 1e-7, 1e-9)
    left = ~np.isin(segments.elements[:, 0], [2, 3])
    for tolerance, joined in ((1e-9, False), (1e-4, True)):
        loops = loops_of(bump, selected(segments, left), 1e-7, tolerance)
        assert (loops is not None) == joined


def test_specks_are_left_out() -> None:
    """A loop far smaller than the tolerance, of which another one tells where it was."""
    path = "M-1 -1H1V1H-1Z M2 2H2.0001V2.0001H2Z"
    shape = ss.Shape.from_svg_path(path)
    (large,) = ss.offset(shape, 1e-5, tolerance=0.2, coarse=True)
    assert large.area == pytest.approx(4.0, abs=1e-3)
    assert len(ss.offset(shape, 1e-5, tolerance=1e-7)) == 2


def test_segments_that_overlap_on_one_line_are_shortened_where_they_can_be() -> None:
    """Of three: one that can; one whose line ends before; one that stands still."""
    sides = np.array([[0, 0], [0, 0], [1, 0], [1, 0], [2, 0], [2, 0]])
    spans = np.array([[0.0, 0.5], [0.5, 1.0]] * 3)
    spans[0, 1] += 2e-6
    spans[2, 1], spans[3, 0] = 1.0, 1.0 - 1e-6
    segments = segments_at(SQUARE, sides, spans, -0.25)
    segments.end[2, 1] += 1e-6  # beyond what follows
    segments.end[4, 0] -= 3e-6
    segments.end[4, 4] = segments.start[5, 4] = 0.0
    before = OffsetSegments(*(column.copy() for column in segments))
    corners = Corners(np.array([0, 2, 4]), np.array([1, 3, 5]), np.full(3, 2.0))
    found = _drawn_back(SQUARE, segments, corners, -0.25)
    # The later of two equally quick ones begins where the other one ends.
    assert found.start[1, :2] == pytest.approx(before.end[0, :2], abs=1e-15)
    assert found.spans[1, 0] == pytest.approx(0.5 + 2e-6, abs=1e-15)
    others = np.arange(6) != 1
    assert np.array_equal(found.start[others], before.start[others])
    assert np.array_equal(found.end, before.end)
    assert np.array_equal(found.spans[others], before.spans[others])
