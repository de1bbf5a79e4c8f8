"""Shapes moved, turned, scaled, mirrored, united, cut: areas and places by their own formulas."""

from __future__ import annotations

import contextlib
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import Point, box

import splinesdf as ss

POINTS = np.random.default_rng(5).uniform(-4.0, 6.0, (400, 2))
NUMBER = st.floats(-5.0, 5.0)


def bracket() -> ss.Shape:
    """No symmetry at all, so that no wrong turn or mirror goes unseen."""
    corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]
    shape = ss.Shape.from_points(corners, name="bracket")
    return replace(shape, unit=25.4, page=(0.0, 0.0, 4.0, 3.0), y_down=True, notes=("a note",))


def distances(shape: ss.Shape, points: np.ndarray) -> np.ndarray:
    return ss.signed_distance(shape, points)


@given(NUMBER, NUMBER)
def test_a_translated_shape_has_the_distances_of_moved_points(dx: float, dy: float) -> None:
    moved = bracket().translate(dx, dy)
    expected = distances(bracket(), POINTS - [dx, dy])
    assert np.abs(distances(moved, POINTS) - expected).max() < 1e-13


@given(st.floats(-720.0, 720.0), NUMBER, NUMBER)
def test_a_rotated_shape_turns_from_x_to_y(degrees: float, x: float, y: float) -> None:
    turned = bracket().rotate(degrees, about=(x, y))
    angle = math.radians(degrees)
    about = (POINTS - [x, y]) @ [1.0, 1j]
    back = about * np.exp(-1j * angle)
    expected = distances(bracket(), np.column_stack([back.real + x, back.imag + y]))
    assert np.abs(distances(turned, POINTS) - expected).max() < 1e-12


@given(st.sampled_from([-3.0, -1.0, 0.25, 2.0, 1e6]), NUMBER, NUMBER)
def test_distances_scale_with_a_shape_and_mirrors_keep_the_inside(
    factor: float, x: float, y: float
) -> None:
    scaled = bracket().scale(factor, about=(x, y))
    points = (POINTS - [x, y]) * factor + [x, y]
    expected = abs(factor) * distances(bracket(), POINTS)
    assert np.abs(distances(scaled, points) - expected).max() < 1e-13 * abs(factor) * 10


@given(st.sampled_from([(-1.0, 1.0), (2.0, 0.5), (1.0, -3.0)]))
def test_two_factors_are_those_of_x_and_y(factors: tuple[float, float]) -> None:
    scaled = bracket().scale(factors)
    assert scaled.area == pytest.approx(4.0 * abs(factors[0] * factors[1]), rel=1e-14)
    low, high = np.sort(np.array([[0.0, 0.0], [3.0, 2.0]]) * factors, axis=0)
    assert scaled.box == pytest.approx((*low, *high), abs=1e-14)


@pytest.mark.parametrize("degrees", [0, 90, -90, 180, 270, 360, -180, 450])
def test_quarter_turns_are_exact(degrees: int) -> None:
    corners = bracket().rotate(degrees).control
    assert np.array_equal(corners, np.rint(corners))
    back = bracket().rotate(degrees).rotate(-degrees)
    assert back == bracket()


def test_what_is_known_of_a_shape_goes_with_it() -> None:
    shape = replace(bracket(), limits=ss.Limits(crossings=77))
    for moved in (
        shape.translate(1, 2),
        shape.scale(3),
        shape.rotate(40),
        shape | shape.translate(1, 1),
    ):
        known = (moved.name, moved.unit, moved.page, moved.y_down, moved.limits.crossings)
        assert known == ("bracket", 25.4, (0.0, 0.0, 4.0, 3.0), True, 77)
        assert "a note" in moved.notes


def test_a_move_so_far_that_rounding_eats_the_shape_is_refused() -> None:
    with pytest.raises(ss.InputError, match="lost beside"):
        bracket().translate(1e17, 0.0)


@given(NUMBER, NUMBER, st.floats(0.3, 3.0))
def test_areas_of_disk_and_rectangle_together_as_shapely_has_them(
    x: float, y: float, radius: float
) -> None:
    disk, block = ss.Shape.circle((x, y), radius), ss.Shape.rectangle(0.0, 0.0, 2.0, 1.0)
    disk_there, block_there = Point(x, y).buffer(radius, 512), box(0.0, 0.0, 2.0, 1.0)
    expected = {
        "|": disk_there.union(block_there).area,
        "&": disk_there.intersection(block_there).area,
        "-": disk_there.difference(block_there).area,
    }
    made = {"|": (disk | block).area, "&": 0.0, "-": 0.0}
    for sign, combined in (("&", disk.intersection), ("-", disk.difference)):
        with contextlib.suppress(ss.InputError):  # nothing in common, nothing left
            made[sign] = combined(block).area
    chords = math.pi * radius**2 * 5e-6
    assert made == pytest.approx(expected, abs=chords)
    assert made["|"] + made["&"] == pytest.approx(disk.area + block.area, rel=1e-9)


def test_holes_that_overlap_or_stick_out_are_cut_once() -> None:
    shell = [(0, 0), (4, 0), (4, 4), (0, 4)]
    holes = [[(1, 1), (1, 3), (3, 3), (3, 1)], [(2, 2), (5, 2), (5, 3), (2, 3)]]
    for turned in (holes, [hole[::-1] for hole in holes]):
        shape = ss.Shape.polygon(shell, turned)
        assert shape.area == pytest.approx(16 - 4 - 1, rel=1e-14)
        assert not shape.contains([[2.5, 2.5], [4.5, 2.5], [3.5, 2.5]]).any()
        assert shape.contains([[0.5, 0.5], [3.5, 1.5], [2.0, 3.5]]).all()
    with pytest.raises(ss.InputError, match="beside its holes"):
        ss.Shape.polygon(shell, [[(-1, -1), (5, -1), (5, 5), (-1, 5)]])


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (lambda: bracket().scale(0.0), "factor"),
        (lambda: bracket().scale((1.0, np.inf)), "factor"),
        (lambda: bracket().scale((1.0, 2.0, 3.0)), "factor"),
        (lambda: bracket().rotate(10, about=(1.0,)), "about"),
        (lambda: bracket() | "disk", "another Shape, got str"),
        (lambda: bracket() & ss.Shape.circle((0, 0), 1), "y the same way"),
        (lambda: bracket() - replace(bracket(), unit=1.0), "25.4 mm and 1 mm"),
        (lambda: bracket() & bracket().translate(50, 0), "got nothing"),
        (lambda: bracket() - bracket(), "got nothing"),
        (lambda: ss.Shape.circle((0.0, 0.0, 0.0), 1.0), r"center \(x, y\)|points of shape"),
        (lambda: ss.Shape.circle((0.0, 0.0), -1.0), "positive radius"),
        (lambda: ss.Shape.rectangle(0, 0, -1, 1), "xmin < xmax"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(bad: object, message: str) -> None:
    with pytest.raises(ss.InputError, match=message) as caught:
        bad()  # type: ignore[operator]
    assert "\n" not in str(caught.value)


def test_shapely_moves_the_same_way() -> None:
    there = box(0.0, 0.0, 2.0, 1.0)
    here = ss.Shape.rectangle(0.0, 0.0, 2.0, 1.0)
    turned = affinity.rotate(there, 30.0, origin=(1.0, 5.0))
    assert here.rotate(30.0, about=(1.0, 5.0)).box == pytest.approx(turned.bounds, abs=1e-14)
    grown = affinity.scale(there, 3.0, -2.0, origin=(1.0, 5.0))
    assert here.scale((3.0, -2.0), about=(1.0, 5.0)).box == pytest.approx(grown.bounds, abs=1e-14)
