"""Edges of DXF drawings that are drawn again, and others that have ends and middles in common."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.interpolate import BSpline
from shapely.geometry import Polygon

import splinesdf as ss
from tests.reading import areas

Draw = Callable[[Any], object]


@pytest.fixture(scope="module")
def read(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Draw], ss.Shape]:
    path: Path = tmp_path_factory.mktemp("again") / "a.dxf"

    def read(draw: Draw) -> ss.Shape:
        document = ezdxf.new(units=4)
        draw(document.modelspace())
        document.saveas(path)
        return ss.read(path)

    return read


def _wave(space: Any, height: float, knots: Any = (0, 0, 0, 0, 1, 1, 1, 1)) -> None:
    """An S from (0, 0) to (6, 0), whose mean is that of its ends."""
    spline = space.add_spline(degree=3)
    spline.control_points = [(0, 0, 0), (2, height, 0), (4, -height, 0), (6, 0, 0)]
    spline.knots = knots


@settings(max_examples=10)
@given(ratios=st.lists(st.floats(0.01, 1.0), min_size=2, max_size=4), turn=st.floats(0.0, 7.0))
def test_ellipses_with_one_major_axis_are_several(read, ratios, turn) -> None:
    ratios = sorted({round(ratio, 6) for ratio in ratios})
    axis = 5.0 * math.cos(turn), 5.0 * math.sin(turn)
    shape = read(lambda space: [space.add_ellipse((1, 2), axis, ratio) for ratio in ratios])
    assert_allclose(np.sort(np.abs(areas(shape))), [25.0 * math.pi * r for r in ratios], rtol=1e-9)
    assert not any("again" in note for note in shape.notes)


def test_a_circle_and_an_ellipse_that_touches_it_from_within_are_two(read) -> None:
    shape = read(
        lambda space: [space.add_circle((0, 0), 5), space.add_ellipse((0, 0), (5, 0), 0.8)]
    )
    assert_allclose(ss.signed_distance(shape, [[0.0, 4.5], [0.0, 0.0]]), [-0.5, 4.0], rtol=1e-12)


def test_polygons_that_differ_in_one_corner_are_two(read) -> None:
    angles = np.linspace(0.0, 2.0 * math.pi, 20, endpoint=False)
    one = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    for k in (1, 5, 10):
        other = one.copy()
        other[k] *= 0.9
        shape = read(lambda space: [space.add_lwpolyline(c, close=True) for c in (one, other)])  # noqa: B023
        assert_allclose(ss.signed_distance(shape, [0.95 * one[k], [0.0, 0.0]]) < 0.0, [True, False])
        assert not any("again" in note for note in shape.notes)


def test_a_wave_is_neither_its_chord_nor_its_mirror_image(read) -> None:
    points = BSpline([0, 0, 0, 0, 1, 1, 1, 1], [(0, 0), (2, 3), (4, -3), (6, 0)], 3)(
        np.linspace(0.0, 0.5, 4001)
    )
    lobe = Polygon(points).area
    over_chord = read(lambda space: [space.add_line((0, 0), (6, 0)), _wave(space, 3.0)])
    both = read(lambda space: [_wave(space, 3.0), _wave(space, -3.0)])
    at = (float(points[2000, 0]), 0.5 * float(points[2000, 1]))
    assert lobe > 1.0
    assert ss.signed_distance(over_chord, at) < 0.0
    assert_allclose(ss.signed_distance(over_chord, (at[0], -at[1])) < 0.0, False)
    assert_allclose(ss.signed_distance(both, [at, (at[0], -at[1])]) < 0.0, True)


@settings(max_examples=10)
@given(
    digits=st.integers(0, 400),
    noise=st.lists(st.sampled_from([-1.0, 0.0, 1.0]), min_size=16, max_size=16),
)
def test_edges_drawn_again_in_other_last_digits_count_once(read, digits, noise) -> None:
    # Numbers halfway between two steps of what counts as the same, where rounding splits them.
    half = 1e-9 * 2000.0 * (digits + 0.5)
    corners = np.array([(half, half), (2000.0 + half, half), (2000.0, 1000.0), (half, 1000.0)])
    sides = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    again = sides + 1e-12 * np.reshape(noise, (4, 2, 2))

    def draw(space: Any) -> None:
        for a, b in sides:
            space.add_line(a, b)
        for a, b in again:
            space.add_line(b, a)

    shape = read(draw)
    assert shape.notes[0] == "drawn again, counted once: 4 edges"
    assert_allclose(np.abs(areas(shape)), Polygon(corners).area, rtol=1e-9)


@pytest.mark.parametrize("period", [1.0, 5e-3, 1e-8])
def test_knots_are_those_of_the_file_however_short_their_range(read, period: float) -> None:
    control = np.array([(0, 0), (3, -1), (5, 2), (2, 6), (-2, 3), (0, 0)], dtype=np.float64)
    knots = period * np.array([0, 0, 0, 0, 1 / 3, 0.7123456789, 1, 1, 1, 1])

    def draw(space: Any) -> None:
        spline = space.add_spline(degree=3)
        spline.control_points, spline.knots = [(x, y, 0) for x, y in control], knots
        spline.dxf.knot_tolerance = 1e-7  # AutoCAD's

    points = BSpline(knots, control, 3)(period * np.linspace(0.0, 1.0, 200))
    assert np.abs(ss.signed_distance(read(draw), points)).max() < 1e-13
