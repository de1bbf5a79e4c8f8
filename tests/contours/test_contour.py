"""The geometry of a chain of conic arcs, against closed formulas and dense sampling."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from splinesdf.contours.contour import (
    Contour,
    box,
    evaluate,
    halve,
    mirrored,
    smallest_tolerance,
)
from splinesdf.errors import InputError
from tests.chains import circle, mixed_chain


def test_circle_has_its_area_and_length() -> None:
    # A few ulp of the sum of 32 terms.
    ring = circle(radius=3.0, center=(10.0, -20.0))
    assert ring.area == pytest.approx(9.0 * math.pi, rel=1e-14)
    assert ring.length == pytest.approx(6.0 * math.pi, rel=1e-14)


@pytest.mark.parametrize("height", [1e-3, 1.0, 30.0])
def test_parabola_has_its_area_and_length(height: float) -> None:
    arc = Contour(np.array([[[-1.0, 0.0], [0.0, 2.0 * height], [1.0, 0.0]]]), np.ones(1), False)
    # y = h (1 - x²), from -1 to 1; the area is to the right of the way, so negative.
    slope = 2.0 * height
    length = math.sqrt(1 + slope**2) + math.asinh(slope) / slope
    assert arc.length == pytest.approx(length, rel=1e-14)
    assert arc.area == pytest.approx(-4.0 / 3.0 * height, rel=1e-14)


@pytest.mark.parametrize("weight", [0.01, 0.3, 1.0, 2.0, 50.0])
def test_area_and_length_agree_with_a_fine_polyline(weight: float) -> None:
    arc = Contour(np.array([[[0.0, 0], [3, 4], [5, 1]]]), np.array([weight]), closed=False)
    tolerance = 1e-8
    line = arc.points(tolerance)
    # A polyline is shorter by the second order of its sag's slope; its area is off by at most
    # length times tolerance.
    lengths = np.linalg.norm(np.diff(line, axis=0), axis=1)
    assert 0.0 <= arc.length - lengths.sum() < 1e-6
    x, y = line.T
    shoelace = 0.5 * (np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) + x[-1] * y[0] - x[0] * y[-1])
    assert arc.area == pytest.approx(shoelace, abs=arc.length * tolerance)


def test_area_does_not_lose_digits_far_from_the_origin() -> None:
    far = circle(center=(1e6, 1e6))
    # The coordinates themselves are rounded at 1e6 * 1e-16.
    assert far.area == pytest.approx(math.pi, abs=1e-9)


@given(tolerance=st.floats(1e-6, 10.0))
def test_polyline_is_within_the_tolerance(tolerance: float) -> None:
    chain = mixed_chain()
    line = chain.points(tolerance)
    assert np.array_equal(line[0], line[-1])
    dense = evaluate(chain.arcs, chain.weights, np.linspace(0, 1, 60)).reshape(-1, 2)
    # Rounding of coordinates below 100.
    assert distance_to_polyline(dense, line).max() <= tolerance + 1e-13


def test_halving_keeps_the_curve() -> None:
    chain = mixed_chain()
    arcs, weights = halve(chain.arcs, chain.weights, np.arange(len(chain.weights)) % 2 == 0)
    assert np.array_equal(arcs[:-1, 2], arcs[1:, 0])
    halves = Contour(arcs, weights)
    assert halves.area == pytest.approx(chain.area, rel=1e-14)
    assert halves.length == pytest.approx(chain.length, rel=1e-14)


def test_box_and_mirror() -> None:
    ring = circle(radius=2.0, center=(5.0, 1.0))
    assert_allclose(box([ring]), (3.0, -1.0, 7.0, 3.0), atol=1e-14)
    dense = evaluate(mixed_chain().arcs, mixed_chain().weights, np.linspace(0.0, 1.0, 10_001))
    low, high = dense.min(axis=(0, 1)), dense.max(axis=(0, 1))
    assert_allclose(box([mixed_chain()]), (*low, *high), atol=1e-6)
    flipped = mirrored(ring)
    assert flipped.y_down
    assert flipped.area == pytest.approx(-ring.area, rel=1e-14)
    assert_allclose(mirrored(flipped).arcs, ring.arcs)
    # About a page from y = -1 to 11: its lower edge comes to where its upper edge was.
    paged = mirrored(Contour(ring.arcs, ring.weights, page=(0.0, -1.0, 8.0, 11.0)), 10.0)
    assert paged.page == (0.0, -1.0, 8.0, 11.0)
    assert_allclose(box([paged]), (3.0, 7.0, 7.0, 11.0), atol=1e-14)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.nan, math.inf])
def test_a_tolerance_must_be_positive(tolerance: float) -> None:
    with pytest.raises(InputError, match="expected a positive tolerance"):
        circle().points(tolerance)


def test_a_tolerance_below_rounding_is_refused() -> None:
    with pytest.raises(InputError, match="rounding of the coordinates"):
        circle(center=(1e9, 0.0)).points(1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"arcs": np.zeros((0, 3, 2)), "weights": np.zeros(0)}, "n > 0"),
        ({"weights": np.ones(3)}, "one weight for each of the 4 arcs"),
        ({"weights": np.array([1.0, 1.0, 1.0, 0.0])}, "positive weights"),
        ({"weights": np.array([1.0, 1.0, 1.0, math.nan])}, "finite"),
        ({"arcs": circle().arcs[::-1]}, "start exactly where"),
        ({"weights": np.array([1.0, 1.0, 1.0, 1e-300])}, "from 1e-60 to 1e\\+60, got 1e-300"),
        ({"weights": np.array([1.0, 1.0, 1.0, 1e300])}, "an arc is its chord or its legs"),
        ({"arcs": 1e100 * circle().arcs}, "use another unit"),
        ({"arcs": 1e-100 * circle().arcs}, "use another unit"),
    ],
)
def test_a_broken_chain_is_refused(change: dict[str, np.ndarray], message: str) -> None:
    ring = circle()
    with pytest.raises(InputError, match=message):
        Contour(**{"arcs": ring.arcs, "weights": ring.weights, **change})


def test_a_chain_that_does_not_close_is_refused() -> None:
    ring = circle()
    with pytest.raises(InputError, match="end exactly where it starts"):
        Contour(ring.arcs[:3], ring.weights[:3])


def distance_to_polyline(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    starts, steps = line[:-1], np.diff(line, axis=0)
    apart = points[:, None] - starts
    squares = np.maximum(np.sum(steps**2, axis=1), 1e-300)
    along = np.clip(np.sum(apart * steps, axis=2) / squares, 0.0, 1.0)
    return np.linalg.norm(apart - along[..., None] * steps, axis=2).min(axis=1)


@pytest.mark.parametrize("weight", [1e-59, 1e-9, 1.0, 1e9, 1e59])
@pytest.mark.parametrize("middle", [(0.0, 0.0), (1.0, 0.0), (-3.0, 0.0), (1.0, 1e-9), (0.5, 1e6)])
def test_halving_ends_at_rounding(weight: float, middle: tuple[float, float]) -> None:
    """Arcs that turn back or all but reach their middle, to the smallest tolerance there is."""
    arcs = np.array([[(0.0, 0.0), middle, (1.0, 0.0)]])
    contour = Contour(arcs + np.array([100.0, 7.0]), np.array([weight]), closed=False)
    least = smallest_tolerance(contour.arcs)
    line = contour.points(least)
    reach = evaluate(contour.arcs, contour.weights, np.linspace(0.0, 1.0, 99)).reshape(-1, 2)
    assert distance_to_polyline(reach, line).max() <= 4.0 * least
    # Lengths of the polyline grow to that of the arc.
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert contour.length == pytest.approx(length, rel=1e-5, abs=1e-12)
