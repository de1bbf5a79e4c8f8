"""Level sets of random and of degenerate splines: on the level, closed, oriented, complete."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy import ndimage

import splinesdf as ss
from splinesdf.contours.contour import Contour, evaluate
from splinesdf.meshes import Grid, Quadtree
from splinesdf.splines.level_sets import arcs as level_set_arcs
from splinesdf.splines.quasi import quasi_interpolate
from splinesdf.splines.spline import SplineSDF
from tests.naive_tree import refine
from tests.trees import hierarchical_ordinates

PARAMETERS = np.linspace(0.0, 1.0, 7)


class Jump(NamedTuple):
    """What happens where one arc ends and the next begins."""

    angle: np.ndarray  # (n,) between the tangents, radians
    at: np.ndarray  # (n, 2)


def random_spline(seed: int, *, coarse: bool = False) -> SplineSDF:
    """Random coefficients on a random quadtree with hanging vertices.

    ``coarse`` rounds the coefficients to sixteenths: then many ordinates are exactly a level.
    """
    random = np.random.default_rng(seed)
    m, n = (int(count) for count in random.integers(2, 5, 2))
    mesh = Quadtree.uniform((0.0, 0.0, float(m), float(n)), m, n)
    for _ in range(random.integers(0, 4)):
        mesh = refine(mesh, random.random(len(mesh.leaves)) < 0.15)

    def coefficients(_level: int, cells: np.ndarray) -> np.ndarray:
        values = random.normal(size=len(cells))
        return np.round(16.0 * values) / 16.0 if coarse else values

    return SplineSDF(mesh, hierarchical_ordinates(mesh, coefficients))


def on_domain(spline: SplineSDF, points: np.ndarray) -> np.ndarray:
    """Points moved into the domain, which rounding may have left by an ulp."""
    return np.clip(points, spline.domain[:2], spline.domain[2:])


def sample(spline: SplineSDF, contour: Contour) -> np.ndarray:
    points = evaluate(contour.arcs, contour.weights, PARAMETERS).reshape(-1, 2)
    return on_domain(spline, points)


def jumps(contour: Contour) -> Jump:
    leaving = contour.arcs[:, 2] - contour.arcs[:, 1]
    entering = np.roll(contour.arcs[:, 1] - contour.arcs[:, 0], -1, axis=0)
    cross = leaving[:, 0] * entering[:, 1] - leaving[:, 1] * entering[:, 0]
    angle = np.abs(np.arctan2(cross, np.sum(leaving * entering, axis=1)))
    end = len(angle) if contour.closed else -1
    return Jump(angle[:end], contour.arcs[:end, 2])


def grid_values(spline: SplineSDF, count: int) -> np.ndarray:
    xmin, ymin, xmax, ymax = spline.domain
    x = xmin + (xmax - xmin) * (np.arange(count) + 0.5) / count
    y = ymin + (ymax - ymin) * (np.arange(count) + 0.5) / count
    return spline(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1))


@settings(max_examples=150)
@given(st.integers(0, 10**9), st.booleans(), st.sampled_from([0.0, 0.125, -0.25, 0.3]))
@example(562377058, True, -0.25)  # arcs once went to and fro along the lines of a saddle
def test_random_splines(seed: int, coarse: bool, level: float) -> None:
    spline = random_spline(seed, coarse=coarse)
    found = spline.contours(level)
    xmin, ymin, xmax, ymax = spline.domain
    for contour in found:
        points = sample(spline, contour)
        # Coefficients are of order one. Where the gradient vanishes on the level a crossing is
        # known to half the digits only, and the value off by its square: 1e-8 leaves room.
        assert np.abs(spline(points) - level).max() < 1e-8
        assert contour.distance == level
        if not contour.closed:
            for end in (contour.arcs[0, 0], contour.arcs[-1, 2]):
                border = np.abs(
                    np.array([end[0] - xmin, end[0] - xmax, end[1] - ymin, end[1] - ymax])
                )
                assert border.min() < 1e-12
        gradient = spline.gradient(on_domain(spline, contour.arcs[:, 0]))
        tangent = contour.arcs[:, 1] - contour.arcs[:, 0]
        steep = np.linalg.norm(gradient, axis=1) > 1e-4
        # Lower values on the left: the tangent is the gradient turned by a quarter to the left.
        left = tangent[:, 1] * gradient[:, 0] - tangent[:, 0] * gradient[:, 1]
        length = np.linalg.norm(tangent, axis=1) * np.linalg.norm(gradient, axis=1)
        assert (left[steep] > 0.999 * length[steep]).all()
        jump = jumps(contour)
        steep = np.linalg.norm(spline.gradient(on_domain(spline, jump.at)), axis=1) > 1e-2
        assert (jump.angle[steep] < 1e-6).all()
    if all(contour.closed for contour in found):
        # Nothing is missed: the area below the level is what pixels say, to their size.
        area = (xmax - xmin) * (ymax - ymin)
        corner_below = spline(on_domain(spline, np.array([xmin, ymin]))) < level
        enclosed = sum(contour.area for contour in found) + (area if corner_below else 0.0)
        pixels = area * np.mean(grid_values(spline, 300) < level)
        length = sum(contour.length for contour in found)
        assert abs(enclosed - pixels) < 1e-3 * area + 0.02 * length


def components(mask: np.ndarray, least: int) -> int:
    """How many connected parts of a picture have at least so many pixels."""
    labels, _ = ndimage.label(mask)
    return int(np.sum(np.bincount(labels.ravel())[1:] >= least))


@pytest.mark.parametrize("seed", range(12))
def test_as_many_contours_as_pixels_say(seed: int) -> None:
    """Rings that overlap, 0.06 wide at the level 0; high values all along the border."""
    centers = np.random.default_rng(seed).uniform(-0.6, 0.6, (6, 2))

    def rings(points: np.ndarray) -> np.ndarray:
        apart = np.linalg.norm(points[:, None] - centers, axis=-1)
        return np.min(np.abs(apart - 0.25), axis=1) - 0.06

    spline = quasi_interpolate(rings, Grid.uniform((-1.0, -1.0, 1.0, 1.0), 64, 64), "W")
    pixels, least = 1500, 20  # what is smaller than 20 pixels is not counted, here nor there
    values = grid_values(spline, pixels)
    for level in (-0.02, 0.0, 0.01):
        found = spline.contours(level)
        assert all(contour.closed for contour in found)
        areas = np.array([contour.area for contour in found]) * (pixels / 2.0) ** 2
        assert np.sum(areas >= least) == components(values < level, least)
        assert np.sum(areas <= -least) == components(values >= level, least) - 1  # the outside


def polynomial_spline(function: object, cells: int = 4) -> SplineSDF:
    """A spline that is a given quadratic: W reproduces them."""
    return quasi_interpolate(function, Grid.uniform((-1.0, -1.0, 1.0, 1.0), cells, cells), "W")


def test_circle_is_one_closed_chain_with_its_length_and_area() -> None:
    spline = polynomial_spline(lambda p: np.sum(p * p, axis=-1))
    (ring,) = spline.contours(0.49)
    assert ring.closed
    assert ring.length == pytest.approx(1.4 * np.pi, rel=1e-13)
    assert ring.area == pytest.approx(0.49 * np.pi, rel=1e-13)


def test_level_through_vertices() -> None:
    # |p|² = 1/4 passes through the vertices (±1/2, 0) and (0, ±1/2), x = 0 through whole sides.
    spline = polynomial_spline(lambda p: np.sum(p * p, axis=-1))
    (ring,) = spline.contours(0.25)
    assert ring.closed
    assert ring.area == pytest.approx(0.25 * np.pi, rel=1e-13)
    (line,) = polynomial_spline(lambda p: p[..., 0]).contours(0.0)
    assert not line.closed
    assert line.length == pytest.approx(2.0, rel=1e-13)
    assert np.abs(line.arcs[..., 0]).max() < 1e-15
    (diagonal,) = polynomial_spline(lambda p: p[..., 0] - p[..., 1]).contours(0.0)
    assert diagonal.length == pytest.approx(np.sqrt(8.0), rel=1e-13)


def test_whole_ellipse_inside_a_triangle() -> None:
    # Of the triangles of the cell [0, 1/2]², the lower one holds the ellipse about (1/4, 1/10).
    center, radii = np.array([0.25, 0.1]), np.array([0.02, 0.01])
    spline = polynomial_spline(lambda p: np.sum(((p - center) / radii) ** 2, axis=-1))
    (ring,) = spline.contours(1.0)
    assert ring.closed
    # Coefficients reach 1e4, of which the value 1 is the small difference: 1e-11 of it.
    assert ring.area == pytest.approx(np.pi * radii.prod(), rel=1e-10)
    (turned,) = polynomial_spline(lambda p: -np.sum(((p - center) / radii) ** 2, axis=-1)).contours(
        -1.0
    )
    assert turned.area == pytest.approx(-np.pi * radii.prod(), rel=1e-10)


def test_critical_level_of_a_minimum_gives_nothing_that_counts() -> None:
    spline = polynomial_spline(lambda p: np.sum((p - 0.21) ** 2, axis=-1))
    assert sum(contour.length for contour in spline.contours(0.0)) < 1e-6
    assert spline.contours(-1e-3) == []


def test_saddle_at_its_level() -> None:
    spline = polynomial_spline(lambda p: (p[..., 0] - 0.1) * (p[..., 1] - 0.05))
    found = spline.contours(0.0)
    # The two lines x = 0.1 and y = 0.05 across the domain, however they are cut and joined.
    assert sum(contour.length for contour in found) == pytest.approx(4.0, abs=1e-6)
    for contour in found:
        x, y = sample(spline, contour).T
        assert np.minimum(np.abs(x - 0.1), np.abs(y - 0.05)).max() < 1e-7


def test_ridge_that_touches_the_level() -> None:
    # The quadratic has a singular Hessian and its minimum along a line: x = 0.3 at level 0.
    spline = polynomial_spline(lambda p: (p[..., 0] - 0.3) ** 2)
    for contour in spline.contours(0.0):
        assert np.abs(sample(spline, contour)[:, 0] - 0.3).max() < 1e-7
    two = spline.contours(0.01)
    assert sorted(np.round(c.arcs[0, 0, 0], 12) for c in two) == [0.2, 0.4]
    assert all(c.length == pytest.approx(2.0, rel=1e-12) for c in two)


def test_constant_spline_has_no_contours() -> None:
    spline = polynomial_spline(lambda p: np.full(p.shape[:-1], 2.0))
    for level in (1.0, 2.0, 3.0):
        assert spline.contours(level) == []


def test_level_that_is_no_number_is_refused() -> None:
    with pytest.raises(ss.InputError, match="finite level"):
        random_spline(0).contours(np.nan)


def test_arcs_at_the_last_cut_are_exact(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nearly a whole circle in one triangle, which two cuts make short enough."""
    center, radius = np.array([0.5, 0.19]), 0.1901
    grid = Grid.uniform((0.0, -1.0, 1.0, 1.0), 1, 2)
    spline = quasi_interpolate(lambda p: np.sum((p - center) ** 2, axis=1) - radius**2, grid)
    monkeypatch.setattr(level_set_arcs, "_CUTS", 2)
    (contour,) = spline.contours(0.0)
    assert contour.closed
    # 1e-13: rounding of values below 1, divided by a gradient of 0.38.
    at = evaluate(contour.arcs, contour.weights, PARAMETERS)
    assert np.abs(np.linalg.norm(at - center, axis=-1) - radius).max() < 1e-13
    assert contour.area == pytest.approx(np.pi * radius**2, rel=1e-12)
