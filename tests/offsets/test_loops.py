"""How stretches are joined where trimming leaves them apart."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.thresholds import SMOOTH
from splinesdf.offsets.corners import Corners, _filled_in
from splinesdf.offsets.loops import loops_of
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
