"""Curves compiled into polynomial pieces, and the pieces that go through given points."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

import splinesdf as ss
from splinesdf.arclets.points import evaluate_bezier
from splinesdf.shapes.sources.compiled import (
    compile_arc,
    compile_curve,
    periodic_cubic_spline,
    polygon,
)
from splinesdf.shapes.sources.formula import parse_curve
from tests.named_shapes import FORMULAS, curve

EPS = float(np.finfo(float).eps)
# Irrational steps, so that no sample is a node of an interpolant.
SAMPLES = np.sort((np.arange(1, 40) * (math.sqrt(5.0) - 1.0) / 2.0) % 1.0)


@dataclass(frozen=True)
class Given:
    """A curve from any function."""

    function: Callable[[np.ndarray], np.ndarray]
    start: float = 0.0
    stop: float = 2.0 * math.pi

    def __call__(self, t: np.ndarray) -> np.ndarray:
        return self.function(t)


def dense(pieces: list[np.ndarray], samples: np.ndarray = SAMPLES) -> np.ndarray:
    return np.concatenate([evaluate_bezier(piece, samples) for piece in pieces])


def assert_joined(pieces: list[np.ndarray]) -> None:
    for before, after in pairwise(pieces):
        assert np.array_equal(before[-1], after[0])


def circle(t: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(t), np.sin(t)], axis=-1)


def test_circle_takes_few_pieces_and_is_round() -> None:
    pieces = compile_curve(Given(circle))
    assert 24 <= len(pieces) <= 40
    assert all(len(piece) == 8 for piece in pieces)
    assert_joined(pieces)
    # The noise of cos and sin over the whole range, 8 ulp, and de Casteljau's own rounding.
    assert np.abs(np.hypot(*dense(pieces).T) - 1.0).max() < 16 * EPS
    assert np.array_equal(pieces[0][0], (1.0, 0.0))
    assert pieces[-1][-1] == pytest.approx((1.0, 0.0), abs=2 * EPS)


@pytest.mark.parametrize("name", FORMULAS)
def test_pieces_lie_on_the_papers_curves(name: str) -> None:
    pieces = compile_curve(parse_curve(*FORMULAS[name], (0.0, "2*pi")))
    assert_joined(pieces)
    # The parameter runs evenly along a piece: each is the curve between two parameters, which
    # are found from its ends here. Pieces come in order, so the parameters increase.
    fine = np.linspace(0.0, 2.0 * np.pi, 200_001)
    points = curve(name, fine)
    position = 0
    ends = [0.0]
    for piece in pieces:
        apart = np.linalg.norm(points[position : position + 20_000] - piece[-1], axis=1)
        # The first close approach: Γ₃ is traced twice.
        close = np.flatnonzero(apart < 2.0 * np.abs(np.diff(points, axis=0)).max())[:50]
        position += int(close[np.argmin(apart[close])]) if len(close) else int(np.argmin(apart))
        ends.append(fine[position])
    assert np.all(np.diff(ends) > 0.0)
    for piece, low, high in zip(pieces, ends[:-1], ends[1:], strict=True):
        found = evaluate_bezier(piece, SAMPLES)
        t = low + (high - low) * SAMPLES
        for _ in range(4):  # Newton steps onto the foot of each point
            h = 1e-6
            slope = (curve(name, t + h) - curve(name, t - h)) / (2.0 * h)
            apart = found - curve(name, t)
            t = t + np.sum(apart * slope, axis=1) / np.sum(slope * slope, axis=1)
        # Γ₃ with its cos(3 t) has three times the noise of a circle, 8 ulp.
        assert np.abs(found - curve(name, t)).max() < 32 * EPS


@pytest.mark.parametrize(
    ("x", "y", "most"),
    [
        ("cos(t)", "abs(sin(t))", 40),
        ("t", "abs(t - 1)", 8),
        ("t", "abs(t - 1) + abs(t - sqrt(2))", 12),
        ("cos(t)", "abs(cos(3*t + 0.1))", 110),
        ("t", "abs(t - pi)^3", 8),
    ],
)
def test_corners_are_found(x: str, y: str, most: int) -> None:
    function = parse_curve(x, y, (0.0, "2*pi"))
    pieces = compile_curve(function)
    assert_joined(pieces)
    # Corners cost a few pieces each, not the fifty that splitting down to them takes.
    assert len(pieces) <= most
    points = dense(pieces)
    if x == "t":
        expected = function(np.clip(points[:, 0], 0.0, 2.0 * np.pi))[:, 1]
        # Rounding of t up to 6.3 and of its functions, the third power up to 31.
        assert np.abs(points[:, 1] - expected).max() < 16 * EPS * max(1.0, np.abs(expected).max())
    elif y == "abs(sin(t))":
        assert np.abs(np.hypot(*points.T) - 1.0).max() < 16 * EPS
        assert points[:, 1].min() > -1e-15
        ends = np.array([piece[0] for piece in pieces])
        assert np.linalg.norm(ends - (-1.0, 0.0), axis=1).min() < 1e-15


def test_straight_parts_are_lines() -> None:
    pieces = compile_curve(parse_curve("t", "2*t + 1", (0.0, 1.0)))
    assert {len(piece) for piece in pieces} == {2}
    assert len(pieces) <= 4
    assert_joined(pieces)


def test_high_frequency_is_resolved_as_well_as_its_argument_allows() -> None:
    pieces = compile_curve(parse_curve("cos(t)*(2 + sin(100*t))", "sin(t)", (0.0, "2*pi")))
    x, y = dense(pieces).T
    # On the right half: t = asin(y), whose error near the poles grows as 1 / cos(t).
    right = np.abs(y) < 0.9
    candidates = [np.arcsin(y), np.pi - np.arcsin(y)]
    apart = np.min([np.abs(np.cos(t) * (2 + np.sin(100 * t)) - x) for t in candidates], axis=0)
    # The argument 100 t <= 630 is rounded to 1e-13, and t itself costs 100 / 0.43 ulp.
    assert apart[right].max() < 1e-12


@pytest.mark.parametrize(
    ("y", "message"),
    [
        ("sqrt(abs(t - 1))", r"near t = 1\.00.*noise"),
        ("abs(t - 1)/(t - 1)", "t = 1"),
        ("atan(1/(t - 1.1))", "cannot be resolved near t = 1.1"),
        ("1/(t - 3)", "not finite at t = 3"),
        ("log(t - 1)", "not finite at t = "),
        ("sqrt(1 - t)", "not finite at t = "),
        ("tan(t)", "near t = 1.57"),
        ("sin(1/(t + 1e-9))", "near t = 0"),
        ("sin(1e9*t)", "oscillates too often"),
    ],
)
def test_what_cannot_be_resolved_is_refused_in_one_line(y: str, message: str) -> None:
    with pytest.raises(ss.InputError, match=message) as caught:
        compile_curve(parse_curve("t", y, (0.0, 4.0)))
    text = str(caught.value)
    assert text.startswith("the curve ")
    assert "\n" not in text


def test_noise_is_refused() -> None:
    random = np.random.default_rng(1)

    def noisy(t: np.ndarray) -> np.ndarray:
        return circle(t) + 1e-6 * random.uniform(-1.0, 1.0, (len(t), 2))

    with pytest.raises(ss.InputError, match="noise"):
        compile_curve(Given(noisy))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_single_bad_value_is_named(bad: float) -> None:
    def broken(t: np.ndarray) -> np.ndarray:
        points = circle(t)
        points[(t > 2.0) & (t < 3.0)] = bad
        return points

    with pytest.raises(ss.InputError, match=r"not finite at t = 2\.|not finite at t = 3"):
        compile_curve(Given(broken))


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("stop", [1e-3, 1.0, 1e3])
def test_unit_and_speed_of_the_parameter_do_not_matter(size: float, stop: float) -> None:
    def scaled(t: np.ndarray) -> np.ndarray:
        return size * circle(t * (2.0 * math.pi / stop))

    pieces = compile_curve(Given(scaled, 0.0, stop))
    assert 24 <= len(pieces) <= 40
    assert np.abs(np.hypot(*dense(pieces).T) / size - 1.0).max() < 16 * EPS


@example((0.0, 0.0), (0.0, 0.0), (0.0, 2.225e-311), 0.0, 1.0, False)  # numbers without digits
@given(
    st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
    st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
    st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
    st.floats(-7, 7),
    st.floats(0.01, 12.0),
    st.booleans(),
)
def test_elliptic_arc(
    center: tuple[float, float],
    x_axis: tuple[float, float],
    y_axis: tuple[float, float],
    start: float,
    sweep: float,
    backward: bool,
) -> None:
    sweep = -sweep if backward else sweep
    pieces = compile_arc(center, x_axis, y_axis, start, sweep)
    assert_joined(pieces)
    axes = np.array([x_axis, y_axis])

    def exact(angle: np.ndarray) -> np.ndarray:
        return np.array(center) + circle(angle) @ axes

    scale = np.abs(axes).max() + np.abs(center).max()
    # A few ulp of the largest coordinates; angles up to 19 are rounded themselves.
    # Below 1e-308 numbers are rounded to whole multiples of the smallest one.
    tolerance = 24 * EPS * scale + 19 * EPS * np.abs(axes).max() + 24 * 5e-324
    share = (np.arange(len(pieces))[:, None] + SAMPLES).ravel() / len(pieces)
    # The angle runs along each piece as the parameter does, but for the interpolation.
    assert np.abs(dense(pieces) - exact(start + sweep * share)).max() <= tolerance
    assert np.abs(pieces[0][0] - exact(np.array(start))).max() <= tolerance
    assert np.abs(pieces[-1][-1] - exact(np.array(start + sweep))).max() <= tolerance


def test_whole_circle_takes_forty_pieces() -> None:
    pieces = compile_arc((0, 0), (1, 0), (0, 1), 0.0, 2.0 * math.pi)
    assert len(pieces) == 40
    assert np.abs(np.hypot(*dense(pieces).T) - 1.0).max() < 4 * EPS


@pytest.mark.parametrize(
    ("start", "sweep"), [(0.0, 0.0), (np.nan, 1.0), (0.0, np.inf), (np.inf, 1.0), (0.0, np.nan)]
)
def test_arcs_without_extent_are_refused(start: float, sweep: float) -> None:
    with pytest.raises(ss.InputError, match="finite arc"):
        compile_arc((0, 0), (1, 0), (0, 1), start, sweep)


@st.composite
def corner_lists(draw: st.DrawFn) -> np.ndarray:
    """Distinct corners of a star-shaped polygon, turned so that nothing is aligned."""
    count = draw(st.integers(3, 30))
    radius = np.array(draw(st.lists(st.floats(0.1, 2.0), min_size=count, max_size=count)))
    gaps = np.array(draw(st.lists(st.floats(0.05, 1.0), min_size=count, max_size=count)))
    angle = 2.0 * np.pi * np.cumsum(gaps) / gaps.sum()
    return radius[:, None] * circle(angle)


@given(corner_lists(), st.sampled_from([1e-6, 1.0, 1e6]))
def test_periodic_spline_is_scipys(corners: np.ndarray, size: float) -> None:
    corners = size * corners
    pieces = periodic_cubic_spline(corners)
    closed = np.concatenate([corners, corners[:1]])
    chords = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    expected = CubicSpline(chords, closed, bc_type="periodic")
    t = (chords[:-1, None] + np.diff(chords)[:, None] * SAMPLES).ravel()
    # Two ways to solve the same system; its condition is at most that of the chords' lengths.
    steps = np.diff(chords)
    tolerance = 50 * EPS * np.abs(dense(pieces)).max() * steps.max() / steps.min()
    assert np.abs(dense(pieces) - expected(t)).max() <= tolerance
    assert np.array_equal([piece[0] for piece in pieces], corners)
    assert_joined([*pieces, pieces[0]])


@given(corner_lists())
def test_periodic_spline_has_two_continuous_derivatives(corners: np.ndarray) -> None:
    pieces = np.array(periodic_cubic_spline(corners))
    steps = np.linalg.norm(pieces[:, 3] - pieces[:, 0], axis=1)[:, None]
    before, after = np.roll(pieces, 1, axis=0), pieces
    step_before, step_after = np.roll(steps, 1, axis=0), steps
    slope_before = 3.0 * (before[:, 3] - before[:, 2]) / step_before
    slope_after = 3.0 * (after[:, 1] - after[:, 0]) / step_after
    # Differences of coordinates up to the largest, divided by the shortest step, once and twice.
    size, shortest = np.abs(pieces).max(), steps.min()
    assert np.abs(slope_before - slope_after).max() <= 20 * EPS * size / shortest
    bend_before = 6.0 * (before[:, 3] - 2.0 * before[:, 2] + before[:, 1]) / step_before**2
    bend_after = 6.0 * (after[:, 2] - 2.0 * after[:, 1] + after[:, 0]) / step_after**2
    assert np.abs(bend_before - bend_after).max() <= 200 * EPS * size / shortest**2


def test_polygon_joins_the_corners_and_drops_repeats() -> None:
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    expected = polygon(square)
    assert len(expected) == 4
    assert_joined([*expected, expected[0]])
    assert np.array_equal([piece[0] for piece in expected], square)
    repeated = [(0, 0), (0, 0), (1, 0), (1, 1), (1, 1), (1, 1), (0, 1), (0, 0)]
    assert np.array_equal(polygon(repeated), expected[:4]) or np.array_equal(
        np.roll(polygon(repeated), 1, axis=0), expected
    )
    # A corner that comes again later is no repeat.
    assert len(polygon([(0, 0), (1, 0), (0, 1), (0, 0), (-1, 0), (0, -1)])) == 6


@pytest.mark.parametrize("through", [polygon, periodic_cubic_spline])
@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([], "points"),
        ([(0, 0)], "at least 3 distinct points, got "),
        ([(0, 0), (1, 1)], "at least 3 distinct points, got 2"),
        ([(0, 0), (1, 1), (0, 0), (1, 1)], "at least 3 distinct points, got 2"),
        ([(0, 0), (1, 1), (np.nan, 0)], "finite"),
        ([(0, 0), (1, 1), (np.inf, 0)], "finite"),
        ([(0, 0, 0), (1, 1, 1), (2, 0, 0)], "shape"),
        ([0, 1], "shape"),
        ("text", "points"),
        (None, "points"),
        ([[(0, 0), (1, 1), (1, 0)]], "shape"),
    ],
)
def test_bad_points_are_refused(
    through: Callable[[ArrayLike], list[np.ndarray]], points: ArrayLike, message: str
) -> None:
    with pytest.raises(ss.InputError, match=message):
        through(points)
