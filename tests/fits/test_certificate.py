"""Brackets of the error hold for splines that are no fits: errors large and of both signs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.fits import certificate as measure
from splinesdf.fits.kernels.enclosure import steepest
from splinesdf.fits.target import ShapeTarget
from splinesdf.meshes import Quadtree
from splinesdf.splines.quasi import quasi_interpolate

NO_BANDS = np.empty((0, 2))
SIDE = 41
# Sums of numbers of size one that go into values and distances.
ROUNDING = 1e-13


def test_the_slope_of_a_quadratic_is_that_at_a_corner() -> None:
    """Regression: at the first two corners one derivative was that at the other one."""
    rng = np.random.default_rng(1)
    corners = rng.uniform(-1.0, 1.0, (500, 3, 2))
    power = rng.normal(size=(500, 6))
    x, y = corners[..., 0], corners[..., 1]

    def value(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        terms = (np.ones_like(x), x, y, x * x, x * y, y * y)
        return sum(power[:, k, None] * term for k, term in enumerate(terms))

    at = value(x, y)
    a, b = x, y
    after_x, after_y = np.roll(a, -1, axis=1), np.roll(b, -1, axis=1)
    middle = value(0.5 * (a + after_x), 0.5 * (b + after_y))
    sides = 2.0 * middle - 0.5 * (at + np.roll(at, -1, axis=1))  # AB BC CA
    triangles = np.concatenate([corners.reshape(-1, 6), at, sides], axis=1)
    gx = power[:, 1, None] + 2.0 * power[:, 3, None] * x + power[:, 4, None] * y
    gy = power[:, 2, None] + power[:, 4, None] * x + 2.0 * power[:, 5, None] * y
    # Thin triangles lose digits.
    slopes = np.empty(len(triangles))
    steepest(triangles, slopes)
    assert slopes == pytest.approx(np.hypot(gx, gy).max(axis=1), rel=1e-9)


CIRCLE = "M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0z"
SHAPES = {
    "cusps": (ss.Shape.from_formula("cos(t)^3", "sin(t)^3"), (-1.0, 0.0)),
    "corner": (ss.Shape.from_points([(0, 0), (4, 1), (1, 3)]), (0.0, 0.0)),
    "circle": (ss.Shape.from_svg_path(CIRCLE), (0.0, 0.0)),
    "touching": (ss.Shape.from_points([(0, 0), (1, 0), (0, 1), (0, 0), (-1, 0), (0, -1)]), (0, 0)),
}


def sampled(shape: ss.Shape, spline: ss.SplineSDF) -> np.ndarray:
    """The largest error at 41 x 41 points of each cell; its corners are among them."""
    boxes = spline.mesh.boxes
    share = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, SIDE)] * 2), axis=-1).reshape(-1, 2)
    points = boxes[:, None, :2] + share * (boxes[:, 2:] - boxes[:, :2])[:, None]
    # Rounding must not lead out of the domain, where the spline is continued otherwise.
    points = np.clip(points, spline.domain[:2], spline.domain[2:]).reshape(-1, 2)
    error = np.abs(spline(points) - ss.signed_distance(shape, points))
    return error.reshape(len(boxes), -1).max(axis=1)


@pytest.mark.parametrize("factor", [-1.0, -0.3, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("name", SHAPES)
def test_brackets_hold_in_every_cell(name: str, factor: float) -> None:
    """Regression: beside a cusp the side was told from a tangent that is all rounding."""
    shape, place = SHAPES[name]
    rng = np.random.default_rng(7)
    for half in (0.3, 0.03, 3e-3, 3e-4):
        x, y = np.array(place) + half * rng.uniform(-0.5, 0.5, 2)
        mesh = Quadtree.uniform((x - half, y - half, x + half, y + half), 6, 6)
        spline = quasi_interpolate(lambda p: ss.signed_distance(shape, p), mesh, "S")
        spline = replace(spline, ordinates=factor * spline.ordinates)
        boxes = mesh.boxes
        center = ss.signed_distance(shape, 0.5 * (boxes[:, :2] + boxes[:, 2:]))
        threshold = 1e-3 * half
        wanted = measure.Wanted(threshold)
        known = measure.cell_errors(
            ShapeTarget(shape), spline, np.arange(len(boxes)), center, NO_BANDS, wanted
        )
        found = sampled(shape, spline)
        assert (found <= known.high + ROUNDING).all()
        # Some point is within 0.5 / 40 of a side's share, both ways, of the worst one.
        slope = 1.0 + np.hypot(*np.moveaxis(spline.gradient(boxes[:, :2]), -1, 0)).max() + 2.0
        gap = slope * np.sqrt(0.5) * (2.0 * half / 6.0) / (SIDE - 1)
        assert (known.low <= found + gap).all()
