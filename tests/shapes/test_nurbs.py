"""B-splines and NURBS as polynomial pieces: round circles, SciPy's numbers, exact fractions."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.interpolate import BSpline

import splinesdf as ss
from splinesdf.arclets.points import evaluate_bezier
from splinesdf.shapes.sources.nurbs import nurbs_pieces
from tests.examples import examples

EPS = float(np.finfo(float).eps)
# Irrational steps, so that no sample is a node of an interpolant.
SAMPLES = np.sort((np.arange(1, 60) * (math.sqrt(5.0) - 1.0) / 2.0) % 1.0)

Points = np.ndarray
Nurbs = tuple[Points, np.ndarray, np.ndarray]  # control points, knots, weights

HALF, ROOT = math.sqrt(0.5), math.sqrt(3.0)
CIRCLES: dict[str, Nurbs] = {
    "9 points": (
        np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]),
        np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]) / 4,
        np.array([1, HALF, 1, HALF, 1, HALF, 1, HALF, 1]),
    ),
    "7 points": (
        np.array(
            [
                (ROOT / 2, 0.5),
                (0, 2),
                (-ROOT / 2, 0.5),
                (-ROOT, -1),
                (0, -1),
                (ROOT, -1),
                (ROOT / 2, 0.5),
            ]
        ),
        np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 3]) / 3,
        np.array([1, 0.5, 1, 0.5, 1, 0.5, 1]),
    ),
}


def elevated(curve: Nurbs, degree: int) -> Nurbs:
    """A degree 2 curve whose inner knots are double, raised span by span to a higher degree."""
    control, knots, weights = curve
    lifted = np.column_stack([control * weights[:, None], weights])
    spans = [lifted[i : i + 3] for i in range(0, len(lifted) - 1, 2)]
    zero = np.zeros((1, 3))
    for d in range(2, degree):
        share = np.arange(d + 2)[:, None] / (d + 1)
        spans = [
            share * np.vstack([zero, span]) + (1 - share) * np.vstack([span, zero])
            for span in spans
        ]
    raised = np.concatenate([spans[0][:1], *(span[1:] for span in spans)])
    inner = np.unique(knots)
    every = np.concatenate([inner[:1], np.repeat(inner, degree), inner[-1:]])
    return raised[:, :2] / raised[:, 2:], every, raised[:, 2]


def dense(pieces: list[Points], samples: np.ndarray = SAMPLES) -> Points:
    return np.concatenate([evaluate_bezier(piece, samples) for piece in pieces])


def assert_joined(pieces: list[Points]) -> None:
    for before, after in pairwise(pieces):
        assert np.array_equal(before[-1], after[0])
    assert all(np.any(piece != piece[0]) for piece in pieces)


def greville(knots: np.ndarray, degree: int) -> np.ndarray:
    """Abscissas of the control points with which a B-spline is its own parameter."""
    return np.array([knots[i + 1 : i + 1 + degree].mean() for i in range(len(knots) - degree - 1)])


@pytest.mark.parametrize("degree", [2, 3, 5, 9])
@pytest.mark.parametrize("name", CIRCLES)
def test_circles_are_round(name: str, degree: int) -> None:
    control, knots, weights = elevated(CIRCLES[name], degree)
    pieces = nurbs_pieces(control, degree=degree, knots=knots, weights=weights)
    assert_joined(pieces)
    # 4 ulp of agreement and up to 4 of the rounding of weights and points when the degree rises;
    # the 7 control points go out to 2.
    assert np.abs(np.hypot(*dense(pieces).T) - 1.0).max() < 8 * EPS
    assert len(pieces) <= 100


@pytest.mark.parametrize("name", CIRCLES)
def test_an_affine_image_of_a_circle_is_an_ellipse(name: str) -> None:
    control, knots, weights = CIRCLES[name]
    matrix, shift = np.array([[3.0, 1.0], [-0.5, 0.25]]), np.array([2.0, -1.0])
    pieces = nurbs_pieces(control @ matrix.T + shift, degree=2, knots=knots, weights=weights)
    back = np.linalg.solve(matrix, (dense(pieces) - shift).T)
    # As for circles, at coordinates up to 6 and through an inverse of norm 2.7.
    assert np.abs(np.hypot(*back) - 1.0).max() < 8 * 6 * 2.7 * EPS


def test_distance_to_a_circle() -> None:
    control, knots, weights = CIRCLES["9 points"]
    center = np.array([3.0, -2.0])
    shape = ss.Shape.from_nurbs(
        2.5 * control + center, degree=2, knots=knots, weights=weights, name="round"
    )
    points = center + np.random.default_rng(1).uniform(-5.0, 5.0, (2000, 2))
    expected = np.hypot(*(points - center).T) - 2.5
    assert np.abs(ss.signed_distance(shape, points) - expected).max() < 1e-13
    assert shape.name == "round"
    assert shape.loop_count == 1


@st.composite
def splines(draw: st.DrawFn) -> tuple[Points, np.ndarray, int]:
    """Control points, knots with repetitions and any ends, and a degree."""
    degree = draw(st.integers(1, 9))
    times = draw(st.lists(st.integers(1, degree), min_size=degree + 3, max_size=degree + 6))
    gaps = draw(st.lists(st.floats(0.1, 2.0), min_size=len(times), max_size=len(times)))
    knots = np.repeat(np.cumsum(gaps), times)
    count = len(knots) - degree - 1
    coordinate = st.floats(-3.0, 3.0)
    control = draw(st.lists(st.tuples(coordinate, coordinate), min_size=count, max_size=count))
    return np.array(control), knots, degree


def domain_spans(knots: np.ndarray, degree: int) -> list[tuple[float, float]]:
    inner = knots[degree : len(knots) - degree]
    return [(a, b) for a, b in pairwise(inner) if a < b]


@given(splines())
def test_polynomial_splines_are_scipys(spline: tuple[Points, np.ndarray, int]) -> None:
    control, knots, degree = spline
    spans = domain_spans(knots, degree)
    assume(spans)
    # Seen as a graph, the first coordinate of any point is its parameter.
    graph = np.column_stack([greville(knots, degree), control[:, 1]])
    pieces = nurbs_pieces(graph, degree=degree, knots=knots)
    assert_joined(pieces)
    expected = BSpline(knots, graph, degree)
    t, y = dense(pieces).T
    # At most 14 ulp of the largest number for each of both, where the abscissas go up to 30, and
    # slopes of at most degree * 6 / 0.1 turn an error of the abscissa into one of y.
    slope = np.abs(expected(np.clip(t, spans[0][0], spans[-1][1]), 1)[:, 1])
    allowed = 28 * EPS * (3.0 + np.abs(t) * (1.0 + slope))
    inside = np.clip(t, spans[0][0], spans[-1][1])
    assert np.all(np.abs(y - expected(inside)[:, 1]) <= allowed)
    assert {len(piece) for piece in pieces} <= ({degree + 1} if degree <= 7 else {2, 8})


@given(splines())
def test_up_to_degree_7_parameters_run_evenly_from_knot_to_knot(
    spline: tuple[Points, np.ndarray, int],
) -> None:
    control, knots, degree = spline
    spans = domain_spans(knots, degree)
    assume(spans and degree <= 7)
    pieces = nurbs_pieces(control, degree=degree, knots=knots)
    assert {len(piece) for piece in pieces} <= {degree + 1}
    assume(len(pieces) == len(spans))  # a span without an extent has no piece
    u = np.concatenate([a + (b - a) * SAMPLES for a, b in spans])
    curve = BSpline(knots, control, degree)
    # The parameter is rounded at up to 30, a slope is at most degree * 6 / 0.1.
    assert np.abs(dense(pieces) - curve(u)).max() <= 16 * EPS * (3.0 + 30.0 * degree * 60.0)


@given(splines(), st.floats(0.0, 6.3), st.floats(-5.0, 5.0))
def test_pieces_turn_with_the_control_points(
    spline: tuple[Points, np.ndarray, int], angle: float, shift: float
) -> None:
    control, knots, degree = spline
    assume(degree <= 7 and domain_spans(knots, degree))
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    before = nurbs_pieces(control, degree=degree, knots=knots)
    after = nurbs_pieces(control @ turn + shift, degree=degree, knots=knots)
    # Rounding may make a piece of length zero one that is not.
    assume(before and len(before) == len(after))
    found, expected = np.concatenate(after), np.concatenate(before) @ turn + shift
    # Two ulp a step of the blossom, at coordinates up to 10.
    assert np.abs(found - expected).max() <= 2 * 8 * EPS * 10.0


@given(splines())
def test_a_reversed_curve_has_the_same_pieces(spline: tuple[Points, np.ndarray, int]) -> None:
    control, knots, degree = spline
    assume(degree <= 7 and domain_spans(knots, degree))
    forward = nurbs_pieces(control, degree=degree, knots=knots)
    backward = nurbs_pieces(control[::-1], degree=degree, knots=-knots[::-1])
    assert len(forward) == len(backward)
    for piece, other in zip(forward, reversed(backward), strict=True):
        assert np.abs(piece - other[::-1]).max() <= 2 * 8 * EPS * 3.0


@given(splines(), st.floats(1e-200, 1e200))
def test_equal_weights_are_no_weights(
    spline: tuple[Points, np.ndarray, int], weight: float
) -> None:
    control, knots, degree = spline
    assume(domain_spans(knots, degree))
    plain = nurbs_pieces(control, degree=degree, knots=knots)
    weighted = nurbs_pieces(
        control, degree=degree, knots=knots, weights=np.full(len(control), weight)
    )
    assert len(plain) == len(weighted)
    assert all(np.array_equal(a, b) for a, b in zip(plain, weighted, strict=True))


def exact_height(t: float, heights: list[float], masses: list[float]) -> tuple[float, float]:
    """Value and slope of a rational Bézier graph over [0, 1], in fractions."""

    def value(at: Fraction) -> Fraction:
        degree = len(heights) - 1
        basis = [
            Fraction(mass) * math.comb(degree, i) * at**i * (1 - at) ** (degree - i)
            for i, mass in enumerate(masses)
        ]
        total = sum(b * Fraction(h) for b, h in zip(basis, heights, strict=True))
        return total / sum(basis)

    step = Fraction(1, 2**30)
    at = Fraction(t)
    return float(value(at)), float((value(at + step) - value(at)) / step)


@examples(40)  # fractions are slow
@given(
    st.lists(st.tuples(st.floats(-3.0, 3.0), st.integers(-6, 6)), min_size=3, max_size=12),
)
def test_rational_spans_are_exact(rows: list[tuple[float, int]]) -> None:
    heights = [height for height, _ in rows]
    degree = len(rows) - 1
    # With the weights of w(t), of one degree less, and the abscissas of t w(t) / w(t), the first
    # coordinate of any point is its parameter.
    inner = [2.0**power for _, power in rows[1:]]
    left = [i * inner[i - 1] if i else 0.0 for i in range(degree + 1)]
    right = [(degree - i) * inner[i] if i < degree else 0.0 for i in range(degree + 1)]
    masses = [a + b for a, b in zip(left, right, strict=True)]
    control = [(a / m, h) for a, m, h in zip(left, masses, heights, strict=True)]
    knots = [0.0] * (degree + 1) + [1.0] * (degree + 1)
    pieces = nurbs_pieces(control, degree=degree, knots=knots, weights=masses)
    assert_joined(pieces)
    assert np.array_equal(pieces[0][0], control[0])
    assert np.array_equal(pieces[-1][-1], control[-1])
    for t, y in dense(pieces, SAMPLES[20:21]):
        expected, slope = exact_height(t, heights, masses)
        # 4 ulp of agreement and up to 8 of a formula of degree 11, at coordinates up to 3; the
        # abscissa is as uncertain.
        assert abs(y - expected) <= 12 * EPS * 3.0 * (1.0 + abs(slope))


@pytest.mark.parametrize("ratio", [1e3, 1e6, 1e12])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_very_different_weights(place: int, ratio: float) -> None:
    weights = np.ones(3)
    weights[place] = ratio
    for mass in (weights, 1.0 / weights):
        pieces = nurbs_pieces([(0, 1), (0, 0), (1, 0)], degree=2, weights=mass)
        assert_joined(pieces)
        x, y = dense(pieces).T
        # The conic x y = (1 - x - y)² w0 w2 / (4 w1²), divided by its largest coefficient.
        factor = mass[0] * mass[2] / (4.0 * mass[1] ** 2)
        assert np.abs(x * y - factor * (1 - x - y) ** 2).max() <= 32 * EPS * max(1.0, factor)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 7, 9])
def test_periodic_curves_are_smooth_and_closed(degree: int) -> None:
    # Around the origin, so that the curve does not cross itself and is all boundary.
    angle = 2.0 * np.pi * np.arange(6) / 6.0
    radius = np.random.default_rng(degree).uniform(0.5, 1.0, (6, 1))
    control = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    pieces = nurbs_pieces(control, degree=degree, periodic=True)
    assert_joined([*pieces, pieces[0] + (pieces[-1][-1] - pieces[0][0])])
    assert np.abs(pieces[-1][-1] - pieces[0][0]).max() <= 2 * degree * EPS
    wrapped = np.concatenate([control, control, control])[: 6 + degree]
    curve = BSpline(np.arange(-degree, 7.0 + degree), wrapped, degree)
    if degree <= 7:
        u = (np.arange(6)[:, None] + SAMPLES).ravel()
        assert np.abs(dense(pieces) - curve(u)).max() <= 32 * EPS
    for order in range(degree if degree <= 7 else 1):
        differences = [np.diff(piece, n=order, axis=0) for piece in pieces]
        for before, after in zip(differences, differences[1:] + differences[:1], strict=True):
            # Each difference doubles the rounding.
            assert np.abs(before[-1] - after[0]).max() <= 2.0**order * 2 * degree * EPS
    shape = ss.Shape.from_nurbs(control, degree=degree, periodic=True)
    samples = curve(np.linspace(0.0, 6.0, 500))
    assert np.abs(ss.signed_distance(shape, samples)).max() < 32 * EPS


def test_periodic_knots_with_weights() -> None:
    random = np.random.default_rng(7)
    control, weights = random.uniform(-1.0, 1.0, (7, 2)), random.uniform(0.3, 3.0, 7)
    # A double knot inside and one at the seam, written once at the start and twice at the end.
    knots = np.array([0.0, 1.0, 2.5, 2.5, 4.0, 4.5, 6.0, 6.0])
    full = np.concatenate([knots[-4:-1] - 6.0, knots, knots[1:4] + 6.0])
    lifted = np.column_stack([control * weights[:, None], weights])
    curve = BSpline(full, np.concatenate([lifted, lifted[:3]]), 3)
    for offset in (0.0, 0.1):  # where 0.1 + 6 - 6 is not 0.1, the double knot must stay double
        shape = ss.Shape.from_nurbs(
            control, degree=3, knots=knots + offset, weights=weights, periodic=True
        )
        # Not at 6 itself, where SciPy sees nothing beyond the double knot.
        samples = curve(np.linspace(0.0, 6.0, 1000, endpoint=False))
        distance = ss.signed_distance(shape, samples[:, :2] / samples[:, 2:])
        # 4 ulp of agreement and as much for the samples; knots moved by 0.1 are rounded.
        assert np.abs(distance).max() < 16 * EPS


def test_wrapped_control_points_need_no_periodic() -> None:
    control = np.random.default_rng(3).uniform(-1.0, 1.0, (8, 2))
    plain = nurbs_pieces(control, degree=3, periodic=True)
    wrapped = nurbs_pieces(
        np.concatenate([control, control[:3]]), degree=3, knots=np.arange(-3.0, 12.0)
    )
    assert all(np.array_equal(a, b) for a, b in zip(plain, wrapped, strict=True))


def test_without_knots_ends_are_control_points() -> None:
    control = np.random.default_rng(4).uniform(-1.0, 1.0, (9, 2))
    pieces = nurbs_pieces(control, degree=3)
    assert len(pieces) == 6
    assert np.array_equal(pieces[0][0], control[0])
    assert np.array_equal(pieces[-1][-1], control[-1])
    assert np.array_equal(
        nurbs_pieces(control, degree=1), np.stack([control[:-1], control[1:]], axis=1)
    )


def test_straight_and_empty_spans() -> None:
    # Spans without weights of their own stay exact beside rational ones, as in a rounded slot.
    slot = [(1, -1), (2, -1), (2, 0), (2, 1), (1, 1), (-1, 1), (-1, -1)]
    weights = [1, HALF, 1, HALF, 1, 1, 1]
    knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 3]
    pieces = nurbs_pieces(slot, degree=2, knots=knots, weights=weights)
    assert np.array_equal(pieces[-1], slot[-3:])
    assert {len(piece) for piece in pieces[:-1]} == {8}
    # A line is the same line with any weights.
    line = nurbs_pieces([(0, 0), (1, 0), (1, 1)], degree=1, weights=[1, 2, 3])
    assert np.array_equal(line, [[(0, 0), (1, 0)], [(1, 0), (1, 1)]])
    # A span in one point is dropped, and a knot repeated degree + 1 times at one point is no jump.
    lazy = [(0, 0), (1, 0), (1, 0), (1, 0), (1, 0), (0, 1)]
    pieces = nurbs_pieces(lazy, degree=2, knots=[0, 0, 0, 1, 1, 1, 2, 2, 2])
    assert_joined(pieces)
    assert nurbs_pieces([(1, 1)] * 4, degree=3) == []
