from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import splinesdf as ss
from tests import naive
from tests.named_shapes import FORMULAS, curve, gamma

# Rounding in both computations of a distance on curves of size one: a few units in the last place
# of coordinates, and of the compiled curve (4 ulp).
ROUNDING = 1e-14

finite = st.floats(-3.0, 3.0)


@pytest.mark.parametrize("name", FORMULAS)
def test_distance_equals_naive_search(name: str) -> None:
    points = np.random.default_rng(1).uniform(-0.5, 1.5, (20_000, 2))
    expected = naive.curve_distance(lambda t: curve(name, t), 0.0, 2 * np.pi, points)
    found = np.abs(ss.signed_distance(gamma(name), points))
    assert np.max(np.abs(found - expected)) < ROUNDING


@pytest.mark.parametrize("name", FORMULAS)
def test_sign_equals_sum_of_angles(name: str) -> None:
    points = np.random.default_rng(2).uniform(-0.2, 1.2, (4000, 2))
    polyline = curve(name, np.linspace(0.0, 2 * np.pi, 4001)[:-1])
    distance = ss.signed_distance(gamma(name), points)
    clear = np.abs(distance) > 1e-5  # the polyline is within (2π/4000)² of the curve
    inside = naive.winding_number(polyline, points) != 0
    assert np.array_equal(distance[clear] < 0, inside[clear])


def test_circle_center_where_every_point_is_closest() -> None:
    circle = ss.Shape.from_formula("3*cos(t)", "3*sin(t)")
    assert ss.signed_distance(circle, (0.0, 0.0)) == pytest.approx(-3.0, abs=ROUNDING)


def test_square_by_hand() -> None:
    square = ss.Shape.from_points([(0, 0), (1, 0), (1, 1), (0, 1)])
    points = [(0.5, 0.5), (2, 2), (1, 1), (0.5, 1), (0.25, 0.5), (-1, 0.5)]
    expected = [-0.5, np.sqrt(2), 0, 0, -0.25, 1]
    assert ss.signed_distance(square, points) == pytest.approx(expected, abs=1e-15)
    assert ss.closest_point(square, (2, 2)) == pytest.approx((1, 1))


def test_curve_traced_twice_is_filled_by_nonzero_and_by_evenodd_not_at_all() -> None:
    x, y = FORMULAS["gamma3"]
    petal = (0.75, 0.45)
    assert ss.signed_distance(ss.Shape.from_formula(x, y), petal) < 0
    with pytest.raises(ss.InputError, match="fill nothing under the rule 'evenodd'"):
        ss.signed_distance(ss.Shape.from_formula(x, y, fill="evenodd"), petal)


def test_points_that_are_not_finite_give_nan_and_disturb_no_other() -> None:
    points = np.random.default_rng(3).uniform(0, 1, (100, 2))
    expected = ss.signed_distance(gamma("gamma2"), points)
    spoiled = points.copy()
    spoiled[10], spoiled[20, 1], spoiled[30] = np.nan, np.inf, -np.inf
    found = ss.signed_distance(gamma("gamma2"), spoiled)
    bad = np.isin(np.arange(100), [10, 20, 30])
    assert np.isnan(found[bad]).all()
    assert np.max(np.abs(found - expected)[~bad]) < ROUNDING


def test_shapes_of_arrays() -> None:
    assert ss.signed_distance(gamma("gamma1"), np.empty((0, 2))).shape == (0,)
    assert ss.signed_distance(gamma("gamma1"), np.zeros((3, 4, 2))).shape == (3, 4)
    assert ss.closest_point(gamma("gamma1"), np.zeros((3, 4, 2))).shape == (3, 4, 2)
    with pytest.raises(ss.InputError, match="shape"):
        ss.signed_distance(gamma("gamma1"), np.zeros(3))


@given(finite, finite, finite, finite, st.sampled_from(sorted(FORMULAS)))
def test_distance_is_1_lipschitz(a: float, b: float, c: float, d: float, name: str) -> None:
    one, other = ss.signed_distance(gamma(name), [(a, b), (c, d)])
    assert abs(one - other) <= np.hypot(a - c, b - d) + ROUNDING


@st.composite
def polygons(draw: st.DrawFn) -> np.ndarray:
    """Star-shaped polygons of 3 to 12 corners, so that they do not cross themselves."""
    count = draw(st.integers(3, 12))
    radius = np.array(draw(st.lists(st.floats(0.2, 1.0), min_size=count, max_size=count)))
    angle = 2 * np.pi * np.arange(count) / count
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], -1)


PROBES = np.random.default_rng(4).uniform(-1.5, 1.5, (200, 2))


@given(polygons(), st.booleans(), st.integers(0, 11))
def test_start_point_and_direction_change_nothing(
    corners: np.ndarray, smooth: bool, start: int
) -> None:
    shape = ss.Shape.from_points(corners, smooth=smooth)
    other = ss.Shape.from_points(np.roll(corners[::-1], start, axis=0), smooth=smooth)
    difference = ss.signed_distance(shape, PROBES) - ss.signed_distance(other, PROBES)
    assert np.max(np.abs(difference)) < 1e-13  # the spline through the corners is solved anew


@given(polygons(), st.floats(0, 6.3), finite, finite, st.floats(1e-3, 1e3))
def test_rigid_motion_and_scale(
    corners: np.ndarray, angle: float, dx: float, dy: float, scale: float
) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def move(points: np.ndarray) -> np.ndarray:
        return scale * (points @ turn.T + (dx, dy))

    shape, moved = ss.Shape.from_points(corners), ss.Shape.from_points(move(corners))
    expected = scale * ss.signed_distance(shape, PROBES)
    # Coordinates reach about 6 * scale: a few of their units in the last place.
    assert np.max(np.abs(ss.signed_distance(moved, move(PROBES)) - expected)) < 1e-14 * scale


def enclosed_area(cubic: np.ndarray) -> float:
    """Of the loop of a cubic and its chord, by the trapezoidal rule."""
    t = np.linspace(0, 1, 400)[:, None]
    weights = [(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3]
    x, y = sum(w * p for w, p in zip(weights, cubic, strict=True)).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


# Coarse, because a sliver thinner than rounding is part of the shape or not as rounding has it.
thousandths = st.integers(-3000, 3000).map(lambda n: n / 1000)


@given(st.floats(0.05, 0.95), st.lists(thousandths, min_size=8, max_size=8))
def test_cutting_a_cubic_changes_nothing(t: float, numbers: list[float]) -> None:
    cubic = np.array(numbers).reshape(4, 2)
    levels = [cubic]
    while len(levels[-1]) > 1:
        levels.append((1 - t) * levels[-1][:-1] + t * levels[-1][1:])
    left, right = [level[0] for level in levels], [level[-1] for level in reversed(levels)]
    # Else next to nothing is filled: a distance to it is refused, or all rounding.
    assume(abs(enclosed_area(cubic)) >= 1e-3)
    whole = ss.Shape.from_pieces([[cubic]], close=True)
    halves = ss.Shape.from_pieces([[left, right]], close=True)
    distance, other = ss.signed_distance(whole, PROBES), ss.signed_distance(halves, PROBES)
    assert np.max(np.abs(np.abs(distance) - np.abs(other))) < 1e-13


def test_closest_point_lies_on_the_curve_at_the_distance() -> None:
    points = np.random.default_rng(5).uniform(0, 1, (1000, 2))
    shape = gamma("gamma2")
    closest = ss.closest_point(shape, points)
    distance = np.abs(ss.signed_distance(shape, points))
    assert np.max(np.abs(np.linalg.norm(points - closest, axis=1) - distance)) < ROUNDING
    assert np.max(np.abs(ss.signed_distance(shape, closest))) < ROUNDING


def test_cubic_with_a_cusp_near_its_tip() -> None:
    # (t², t³) on [-1, 1] has a cusp at the origin; from (-r, 0) the tip is r away.
    cubic = np.array([(1, -1), (-1 / 3, 1), (-1 / 3, -1), (1, 1)])
    shape = ss.Shape.from_pieces([[cubic]], close=True)
    for r in (1e-3, 1e-9, 1e-12):
        assert ss.signed_distance(shape, (-r, 0.0)) == pytest.approx(r, abs=ROUNDING)
