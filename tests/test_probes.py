"""Small parts of a shape, far smaller than a mesh's first cells, are never stepped over."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.contour import Contour
from splinesdf.curves.interpolate import polygon
from splinesdf.probes import probes

Small = Callable[[float, float], np.ndarray]

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
CIRCLE = "M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0z"


def turned(corners: np.ndarray, angle: float) -> np.ndarray:
    cosine, sine = np.cos(angle), np.sin(angle)
    return corners @ np.array([[cosine, sine], [-sine, cosine]])


def small_square(size: float, angle: float) -> np.ndarray:
    return turned(size * (2.0 * SQUARE - 1.0), angle)


def small_triangle(size: float, angle: float) -> np.ndarray:
    return turned(size * np.array([[-1.0, -1.0], [1.0, -1.0], [0.7, 1.0]]), angle)


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
    hole = small_square(0.3 * depth, 0.4) + center
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
@pytest.mark.parametrize("small", [small_square, small_triangle])
def test_a_grain_beside_a_side_shows_in_a_far_offset(small: Small, gap: float) -> None:
    """Its cap is a gap high and sqrt(8 gap distance) wide: 1/30 of a first cell, and 1/300."""
    random = np.random.default_rng(3)
    for _ in range(8):
        y, far, angle = random.uniform([0.2, 0.05, 0.0], [0.8, 0.4, 6.28])
        grain = small(0.3 * gap, angle) + np.array([-gap, y])
        shape = ss.Shape.from_pieces([polygon(SQUARE), polygon(grain)])
        tolerance = 0.2 * gap
        (contour,) = ss.offset(shape, far, tolerance=tolerance)
        points = nearby(contour, y, 3.0 * np.sqrt(2.0 * gap * far) + 0.01, tolerance)
        assert len(points) > 100
        assert np.abs(ss.signed_distance(shape, points) - far).max() < tolerance


def test_probes_of_a_square() -> None:
    shape = ss.Shape.from_points(SQUARE)
    found = probes(lambda points: ss.signed_distance(shape, points), shape, [-0.25, 0.25])
    distances = ss.signed_distance(shape, found)
    # On the outside every probe is at its distance: of ends, middles and fans' middles.
    outside = distances > 0.0
    assert distances[outside] == pytest.approx(0.25, abs=1e-15)
    assert np.count_nonzero(outside) == 12 + 4
    diagonal = 0.25 * np.sqrt(0.5)
    expected = SQUARE + diagonal * np.sign(SQUARE - 0.5)
    for corner in expected:
        assert np.linalg.norm(found - corner, axis=1).min() < 1e-5
    # On the boundary itself each point is named, however often.
    on_curve = probes(lambda points: ss.signed_distance(shape, points), shape, [0.0])
    assert np.abs(ss.signed_distance(shape, on_curve)).max() == 0.0
    assert {tuple(corner) for corner in SQUARE} <= {tuple(point) for point in on_curve}


def test_probes_of_a_cusp_are_finite() -> None:
    shape = ss.Shape.from_formula("cos(t)^3", "sin(t)^3")
    found = probes(lambda points: ss.signed_distance(shape, points), shape, [0.0, 0.1])
    assert np.isfinite(found).all()
