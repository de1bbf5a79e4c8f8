"""Area and length of what is filled, against closed forms and against polygons by Shapely."""

from __future__ import annotations

import itertools
import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon

import splinesdf as ss
from splinesdf.shapes import measures
from tests.named_shapes import gamma

ELLIPSE = (3.0, 1.0)


def ellipse() -> ss.Shape:
    return ss.Shape.from_formula("3*cos(t)", "sin(t)")


def disk(radius: float) -> ss.Shape:
    return ss.Shape.circle((0.0, 0.0), radius)


def perimeter(a: float, b: float) -> float:
    """Of an ellipse, by the arithmetic-geometric mean; to rounding."""
    x, y, total, power = a, b, a * a - (a * a - b * b) / 2.0, 1.0
    while x - y > 1e-15 * a:
        x, y, total, power = (
            (x + y) / 2,
            math.sqrt(x * y),
            total - power * (x - y) ** 2 / 4,
            2 * power,
        )
    return 2.0 * math.pi * total / x


CASES = {
    # shape, area, length
    "disk": (lambda: ss.Shape.circle((1.0, 2.0), 0.5), math.pi / 4, math.pi),
    "ellipse": (ellipse, 3.0 * math.pi, perimeter(*ELLIPSE)),
    "rectangle": (lambda: ss.Shape.rectangle(-1, 2, 3, 5), 12.0, 14.0),
    # (1 + cos t) (cos t, sin t): its cusp is where the speed vanishes
    "cardioid": (
        lambda: ss.Shape.from_formula("(1+cos(t))*cos(t)", "(1+cos(t))*sin(t)"),
        1.5 * math.pi,
        8.0,
    ),
    "astroid": (lambda: ss.Shape.from_formula("cos(t)^3", "sin(t)^3"), 3 * math.pi / 8, 6.0),
    "far": (lambda: ss.Shape.rectangle(1e8, 1e8, 1e8 + 2, 1e8 + 3), 6.0, 10.0),
    # two disks of which one lies in the other count once; a frame is what is between
    "nested": (
        lambda: ss.Shape.circle((0, 0), 2) | ss.Shape.circle((0, 0), 1),
        4 * math.pi,
        4 * math.pi,
    ),
    "frame": (
        lambda: ss.Shape.circle((0, 0), 2) - ss.Shape.circle((0, 0), 1),
        3 * math.pi,
        6 * math.pi,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_closed_forms(name: str) -> None:
    make, area, length = CASES[name]
    shape = make()
    assert shape.area == pytest.approx(area, rel=2e-14)
    assert shape.length == pytest.approx(length, rel=2e-14)


# Cubics that turn back so fast that one rule misses how short they are there.
NEAR_CUSPS = [[(0.0, 0.0), (1.0, 1.0), (gap, 1.0), (1.0, 0.0)] for gap in (1e-2, 1e-5, 1e-9, 0.0)]


def near_cusp(corners: list[tuple[float, float]]) -> tuple[ss.Shape, float]:
    """A cubic and its chord, and their length by mpmath, cut where the speed is least."""
    steps = [
        [3 * mpmath.mpf(b[k]) - 3 * mpmath.mpf(a[k]) for a, b in itertools.pairwise(corners)]
        for k in (0, 1)
    ]

    def speed(t: mpmath.mpf) -> mpmath.mpf:
        x, y = ((1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c for a, b, c in steps)
        return mpmath.sqrt(x * x + y * y)

    with mpmath.workdps(20):
        places = [0.5 + way * 10.0**-k for k in range(2, 11, 2) for way in (-1, 1)]
        exact = mpmath.quad(speed, [0, *sorted([*places, 0.5]), 1])
    line = [corners[-1], corners[0]]
    return ss.Shape.from_pieces([[corners, line]]), float(exact) + math.dist(*line)


@pytest.mark.parametrize("corners", NEAR_CUSPS)
def test_arcs_that_nearly_stand_still_are_as_long_as_they_are(
    corners: list[tuple[float, float]],
) -> None:
    shape, length = near_cusp(corners)
    assert shape.length == pytest.approx(length, rel=2e-14)


def test_no_part_is_lost_where_halving_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    shape, length = near_cusp(NEAR_CUSPS[1])
    monkeypatch.setattr(measures, "_HALVINGS", 1)
    assert shape.length == pytest.approx(length, rel=1e-9)


# Whole numbers: what Shapely takes for valid by 1e-133 is a slit to us.
CORNER = st.tuples(*2 * [st.integers(-10, 10)])


@given(st.lists(CORNER, min_size=3, max_size=8, unique=True))
def test_polygons_as_shapely_measures_them(corners: list[tuple[int, int]]) -> None:
    other = Polygon(corners)
    try:
        shape = ss.Shape.from_points(corners)
        shape.boundary  # noqa: B018
    except ss.InputError:  # nothing filled, to rounding
        assert other.area < 1e-6 or not other.is_valid
        return
    if other.is_valid:
        assert shape.area == pytest.approx(other.area, abs=1e-9)
        assert shape.length == pytest.approx(other.length, abs=1e-7)


@pytest.mark.parametrize("name", ["gamma1", "gamma2", "gamma3"])
def test_curves_as_many_chords(name: str) -> None:
    shape = gamma(name)
    (line,) = shape.sample(4000)
    other = Polygon(line)
    times = 2.0 if name == "gamma3" else 1.0  # it is traced twice, and bounds its inside once
    assert times * shape.area == pytest.approx(other.area, rel=1e-7)
    assert times * shape.length == pytest.approx(other.length, rel=1e-7)


def test_contains_is_the_sign_of_the_distance() -> None:
    shape = ss.Shape.circle((1.0, 2.0), 0.5)
    points = np.array([[1.0, 2.0], [1.4, 2.0], [1.6, 2.0], [np.nan, 0.0]])
    assert shape.contains(points).tolist() == [True, True, False, False]
    assert (1.0, 2.0) in shape
    assert (3.0, 2.0) not in shape
    assert shape.bounds == shape.box


def test_loops_are_iterated_over() -> None:
    shape = ss.example("part")
    assert len(shape) == len(list(shape)) == 9
    assert [len(loop) for loop in shape] == np.diff(shape.loops).tolist()
    for loop in shape:
        assert np.array_equal(loop[0][0], loop[-1][-1])
