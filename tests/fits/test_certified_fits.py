"""Fits of nasty and real shapes: what is proved of them holds at points by the hundred thousand."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.contours.contour import Contour
from splinesdf.shapes.sources.compiled import polygon
from tests.glyphs import glyphs
from tests.named_shapes import UNIT, gamma
from tests.real_shapes import beside, formula_shape, icons

CIRCLE = "M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0z"
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
SHAPES: dict[str, Callable[[], ss.Shape]] = {
    "spike": lambda: ss.Shape.from_points([(0, 0), (5, 0.01), (0, 0.02), (-1, 1)]),
    "astroid": lambda: formula_shape("astroid"),
    "circle": lambda: ss.Shape.from_svg_path(CIRCLE),
    "touching": lambda: ss.Shape.from_points([(0, 0), (1, 0), (0, 1), (0, 0), (-1, 0), (0, -1)]),
    "tangent": lambda: ss.Shape.from_svg_path(CIRCLE + "M3 0A1 1 0 0 1 1 0A1 1 0 0 1 3 0z"),
    # A cusp that turns back: seen from inside, though its tangents cannot tell.
    "yin-yang": lambda: icons()["yin-yang"],
    # Nearly circular, of quadratics that meet in corners of a degree or so.
    "DejaVuSans:?": lambda: glyphs()["DejaVuSans:?"],
    # Control points that nearly coincide make spikes of curvature.
    "apple": lambda: icons()["apple"],
    "nintendo-switch": lambda: icons()["nintendo-switch"],
}


def random_error(result: ss.FitResult, shape: ss.Shape) -> float:
    """The largest |s - u| at random points of the domain, many of them beside the boundary."""
    domain = np.array(result.spline.domain)
    points = np.random.default_rng(8).uniform(domain[:2], domain[2:], (200_000, 2))
    points = np.concatenate([points, beside(shape, 50_000, 4)])
    points = points[np.all((points >= domain[:2]) & (points <= domain[2:]), axis=1)]
    return float(np.abs(result.spline(points) - ss.signed_distance(shape, points)).max())


def assert_proved(result: ss.FitResult, shape: ss.Shape) -> None:
    assert result.bound is not None
    found = random_error(result, shape)
    assert found <= result.bound <= result.tolerance
    assert 0.99 * found <= result.error <= result.bound <= 1.0051 * result.error


@pytest.mark.parametrize("name", SHAPES)
def test_bounds_hold(name: str) -> None:
    shape = SHAPES[name]()
    for share in (0.05, 0.005):
        assert_proved(ss.fit(shape, tolerance=share * shape.size), shape)


@pytest.mark.parametrize("space", ["tensor", "uniform"])
def test_grids_have_bounds_too(space: str) -> None:
    shape = gamma("gamma2")
    assert_proved(ss.fit(shape, tolerance=1e-2, space=space, domain=UNIT), shape)


def test_without_a_proof_there_is_no_bound() -> None:
    shape = gamma("gamma1")
    proved = ss.fit(shape, tolerance=1e-4, domain=UNIT)
    believed = ss.fit(shape, tolerance=1e-4, domain=UNIT, certify=False)
    assert believed.bound is None
    assert believed.cells <= proved.cells
    assert random_error(believed, shape) <= 1e-4
    assert believed.error <= 1e-4


def test_a_fit_says_how_it_was_made() -> None:
    shape = gamma("gamma1")
    result = ss.fit(shape, tolerance=1e-2, band=[(-0.1, 0.0), (0.05, 0.05)])
    made = result.spline.made
    assert result.spline.shape is shape
    assert made is not None
    assert (made.tolerance, made.error, made.bound) == (1e-2, result.error, result.bound)
    assert (made.bands, made.space, made.operator) == (result.bands, "hierarchical", "P")
    assert (made.stopped, made.evaluations) == ("reached", result.evaluations)


def turned(corners: np.ndarray, angle: float) -> np.ndarray:
    cosine, sine = np.cos(angle), np.sin(angle)
    return corners @ np.array([[cosine, sine], [-sine, cosine]])


@pytest.mark.parametrize("depth", [1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("at", [0.16, 0.33, 0.6577, 0.84])
@pytest.mark.parametrize("outer", ["square", "circle"])
def test_a_tiny_hole_beside_a_side_is_a_loop(outer: str, at: float, depth: float) -> None:
    if outer == "square":
        big, center = polygon(SQUARE), np.array([depth, at])
    else:
        circle = ss.Shape.from_svg_path(CIRCLE)
        big = [circle.piece(i) for i in range(circle.piece_count)]
        center = (1.0 - depth) * np.array([np.cos(7.0 * at), np.sin(7.0 * at)])
    hole = turned(0.3 * depth * (2.0 * SQUARE - 1.0), 0.4) + center
    shape = ss.Shape.from_pieces([big, polygon(hole)], fill="evenodd")
    found = ss.offset(shape, 0.0, tolerance=0.2 * depth)
    assert len(found) == 2
    assert min(abs(contour.area) for contour in found) == pytest.approx((0.6 * depth) ** 2, rel=0.5)


def nearby(contour: Contour, y: float, width: float, tolerance: float) -> np.ndarray:
    """Points left of x = 0 and around a height, close together."""
    line = contour.points(0.02 * tolerance)
    chosen = np.flatnonzero((line[:, 0] < 0.0) & (np.abs(line[:, 1] - y) < width))
    chosen = chosen[chosen < len(line) - 1]
    steps = np.linspace(0.0, 1.0, 40)[:, None]
    return (line[chosen, None] + steps * (line[chosen + 1] - line[chosen])[:, None]).reshape(-1, 2)


@pytest.mark.parametrize("gap", [1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("corners", [2.0 * SQUARE - 1.0, [[-1.0, -1.0], [1.0, -1.0], [0.7, 1.0]]])
def test_a_grain_beside_a_side_shows_in_a_far_offset(corners: np.ndarray, gap: float) -> None:
    """Its cap is a gap high and sqrt(8 gap distance) wide: 1/30 of a first cell, and 1/300."""
    random = np.random.default_rng(3)
    for _ in range(8):
        y, far, angle = random.uniform([0.2, 0.05, 0.0], [0.8, 0.4, 6.28])
        grain = turned(0.3 * gap * np.array(corners), angle) + np.array([-gap, y])
        shape = ss.Shape.from_pieces([polygon(SQUARE), polygon(grain)])
        tolerance = 0.2 * gap
        (contour,) = ss.offset(shape, far, tolerance=tolerance)
        points = nearby(contour, y, 3.0 * np.sqrt(2.0 * gap * far) + 0.01, tolerance)
        assert len(points) > 100
        assert np.abs(ss.signed_distance(shape, points) - far).max() < tolerance
