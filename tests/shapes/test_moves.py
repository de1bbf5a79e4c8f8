"""Shapes moved, turned, scaled, mirrored, united, cut: areas and places by their own formulas."""

from __future__ import annotations

import contextlib
import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
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


@settings(max_examples=30)
@given(NUMBER, NUMBER, st.floats(0.3, 3.0))
def test_areas_of_disk_and_rectangle_together_as_shapely_has_them(
    x: float, y: float, radius: float
) -> None:
    disk, block = ss.Shape.circle((x, y), radius), ss.Shape.rectangle(0.0, 0.0, 2.0, 1.0)
    disk_there, block_there = Point(x, y).buffer(radius, 256), box(0.0, 0.0, 2.0, 1.0)
    expected = {
        "|": disk_there.union(block_there).area,
        "&": disk_there.intersection(block_there).area,
        "-": disk_there.difference(block_there).area,
    }
    made = {"|": (disk | block).area, "&": 0.0, "-": 0.0}
    for sign, combined in (("&", disk.intersection), ("-", disk.difference)):
        with contextlib.suppress(ss.InputError):  # nothing in common, nothing left
            made[sign] = combined(block).area
    chords = math.pi * radius**2 * 2e-5
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


SHARE = st.sampled_from([0.0, 0.25, 1 / 3, 0.5, 0.7, 1.0])
FACTOR = st.sampled_from([1.0, 1.33333, 0.7, 3.1])
RADIUS = st.sampled_from([0.0, 0.0125, 0.1, 0.25, 0.5])


def rounded(box_: tuple[float, ...], rx: float, ry: float) -> ss.Shape:
    """A rectangle with corners of quarters of ellipses, which touch its sides tangentially."""
    x0, y0, x1, y1 = box_
    if not (rx and ry):
        return ss.Shape.rectangle(*box_)
    arc = f"A{rx!r} {ry!r} 0 0 1"
    return ss.Shape.from_svg_path(
        f"M{x0 + rx!r} {y0!r}H{x1 - rx!r}{arc}{x1!r} {y0 + ry!r}V{y1 - ry!r}{arc}{x1 - rx!r} {y1!r}"
        f"H{x0 + rx!r}{arc}{x0!r} {y1 - ry!r}V{y0 + ry!r}{arc}{x0 + rx!r} {y0!r}Z"
    )


def there(shape: ss.Shape) -> shapely.Polygon:
    """The polygon of its chords, whole also where sides of no length cross by rounding."""
    made = shapely.make_valid(shapely.Polygon(shape.sample(8)[0]))
    return shapely.union_all([one for one in shapely.get_parts(made) if one.area])


@settings(max_examples=30)
@given(st.tuples(SHARE, SHARE), st.tuples(SHARE, SHARE), st.tuples(*4 * [RADIUS]), FACTOR, FACTOR)
def test_rounded_rectangles_with_sides_in_common(
    xs: tuple[float, float],
    ys: tuple[float, float],
    radii: tuple[float, float, float, float],
    fx: float,
    fy: float,
) -> None:
    """Corners that leave a common side tangentially: a flag of flag-icons lost one of its own."""
    assume(xs[0] != xs[1] and ys[0] != ys[1])
    width, height = 384.0, 512.0
    (left, right), (low, high) = sorted(width * x for x in xs), sorted(height * y for y in ys)
    outer = rounded((0.0, 0.0, width, height), radii[0] * width, radii[1] * height)
    inner = rounded((left, low, right, high), radii[2] * (right - left), radii[3] * (high - low))
    one, other = outer.scale((fx, fy)), replace(inner.scale((fx, fy)), y_down=outer.y_down)
    a, b = there(one), there(other)
    both = shapely.intersection(a, b, grid_size=1e-6 * one.size).area
    allowed = 1e-3 * one.size * one.size
    assert (one | other).area == pytest.approx(a.area + b.area - both, abs=allowed)
    for combined, expected in (
        (one.intersection, both),
        (one.difference, a.area - both),
    ):
        try:
            area = combined(other).area
        except ss.InputError as error:
            area = 0.0 if "got nothing" in str(error) else math.nan
        assert area == pytest.approx(expected, abs=allowed)


@pytest.mark.parametrize(("rx", "ry"), [(4.6, 7.6), (0.61, 140.8), (22.25, 166.4)])
def test_a_flag_keeps_its_corner(rx: float, ry: float) -> None:
    flag = rounded((0.0, 0.0, 384.0, 512.0), rx, ry).scale((1.33333, 1.0))
    stripe = ss.Shape.rectangle(0.0, 0.0, 512.0, 171.4).scale((1.33333, 1.0))
    corner = (1.0 - math.pi / 4) * 1.33333 * rx * ry
    common = flag & replace(stripe, y_down=True)
    assert common.area == pytest.approx(384 * 1.33333 * 171.4 - 2 * corner, rel=1e-9)
    assert len(common) == 1
