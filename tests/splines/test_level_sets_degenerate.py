"""Level sets where things coincide: plateaus, saddles, ridges and vertices at the level."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy import ndimage

from splinesdf.contours.contour import Contour, evaluate
from splinesdf.meshes import Grid, Quadtree
from splinesdf.spaces.tensor import tensor_ordinates
from splinesdf.splines.quasi import quasi_interpolate
from splinesdf.splines.spline import SplineSDF
from tests.examples import examples
from tests.naive_tree import refine
from tests.trees import hierarchical_ordinates

Coefficients = Callable[[np.random.Generator, tuple[int, ...]], np.ndarray]

# Where the level touches an edge, rounding in the values moves the crossing by its square root,
# and an arc shorter than 1e-9 is left out: with gradients up to about 10 the value is off by 1e-8.
TOUCHING = 1e-8
PIXELS = 300


def uniform(random: np.random.Generator, draw: Coefficients) -> SplineSDF:
    grid = Grid.uniform((0.0, 0.0, 1.0, 1.0), 6, 5)
    return SplineSDF(grid, tensor_ordinates(grid, draw(random, (8, 7))))


def tensor(random: np.random.Generator, draw: Coefficients) -> SplineSDF:
    grid = Grid.from_lines([0.0, 0.3, 0.4, 0.8, 1.0], [0.0, 0.1, 0.5, 0.55, 1.0])
    return SplineSDF(grid, tensor_ordinates(grid, draw(random, (6, 6))))


def hierarchical(random: np.random.Generator, draw: Coefficients) -> SplineSDF:
    mesh = Quadtree.uniform((0.0, 0.0, 1.0, 1.0), 3, 4)
    for _ in range(3):
        mesh = refine(mesh, random.random(len(mesh.leaves)) < 0.08)
    return SplineSDF(
        mesh, hierarchical_ordinates(mesh, lambda _, cells: draw(random, (len(cells),)))
    )


def few_whole_numbers(random: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    return random.integers(-1, 2, shape).astype(float)


def whole_numbers(random: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    return random.integers(-4, 5, shape).astype(float)


def normal(random: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    return random.normal(size=shape)


SPACES = {"uniform": uniform, "tensor": tensor, "hierarchical": hierarchical}
DRAWS = {"few": few_whole_numbers, "whole": whole_numbers, "normal": normal}


def pixel_values(spline: SplineSDF, count: int) -> np.ndarray:
    line = (np.arange(count) + 0.5) / count
    return spline(np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1))


def scattered_values(spline: SplineSDF, count: int) -> np.ndarray:
    """One in each pixel, not in rows: a straight border cannot run along all of them."""
    i, j = np.indices((count, count))
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    return spline(np.stack([i + golden * j % 1.0, j + golden * i % 1.0], axis=-1) / count)


def area_below(contours: list[Contour], right_border_below: float) -> float:
    """Green's theorem on the unit square: the integral of x dy around all that lies below.

    Along the bottom and the top dy is zero, along the left x is; what remains beside the contours
    is how much of the right border lies below.
    """
    total = right_border_below
    for contour in contours:
        x, y = contour.points(1e-7).T
        total += float(np.sum(0.5 * (x[1:] + x[:-1]) * np.diff(y)))
    return total


def check_values_and_ends(spline: SplineSDF, contours: list[Contour], tolerance: float) -> None:
    level = contours[0].distance if contours else 0.0
    for contour in contours:
        points = evaluate(contour.arcs, contour.weights, np.linspace(0.0, 1.0, 7))
        assert np.abs(spline(np.clip(points, 0.0, 1.0)) - level).max() < tolerance
        # Ends a rounding apart are joined; what is left has a direction.
        assert np.linalg.norm(contour.arcs[:, 2] - contour.arcs[:, 0], axis=1).min() > 1e-12
        if not contour.closed:
            ends = contour.arcs[[0, -1], [0, 2]]
            assert np.minimum(np.abs(ends), np.abs(1.0 - ends)).min(axis=1).max() < 1e-15


@examples(60)
@given(
    st.integers(0, 10**6),
    st.sampled_from(sorted(SPACES)),
    st.sampled_from(sorted(DRAWS)),
    st.sampled_from([0.0, 0.25, 0.5, -1.0]),
)
# Each of these once had arcs that went astray, far around a conic of which they are a point.
@example(3, "uniform", "few", 0.0)  # a ridge at the level along a diagonal of cells
@example(14, "uniform", "few", 0.5)
@example(94, "uniform", "few", 0.5)  # crossings a rounding apart, in the wrong order
@example(54, "uniform", "whole", -1.0)
@example(135537, "uniform", "few", 0.25)  # a hyperbola through a vertex, once around
@example(2013, "hierarchical", "few", 0.0)  # a saddle at the level, on a side
@example(828091, "uniform", "whole", 0.25)  # an ellipse that touches a diagonal
@example(647311, "uniform", "few", 0.0)  # a plateau at the level
@example(931157, "uniform", "whole", 0.5)  # an ellipse through a center and a vertex
@example(561577, "uniform", "whole", 0.5)  # an ellipse through a center that fills a triangle
@example(749330, "tensor", "whole", -1.0)  # the same
@example(768250, "hierarchical", "whole", 0.5)  # an ellipse that is a point
@example(15, "hierarchical", "whole", 0.5)  # a saddle at the level inside a triangle
@example(999999, "hierarchical", "whole", 0.5)  # an ellipse that touches a side in a vertex
def test_area_below_the_level_is_what_pixels_say(
    seed: int, space: str, draw: str, level: float
) -> None:
    spline = SPACES[space](np.random.default_rng(seed), DRAWS[draw])
    contours = spline.contours(level)
    check_values_and_ends(spline, contours, TOUCHING)
    values = scattered_values(spline, PIXELS)
    border = spline(np.stack([np.ones(20_000), (np.arange(20_000) + 0.5) / 20_000], axis=-1))
    # A plateau at the level may count as below or not, as rounding has it.
    least, most = level - 1e-9, level + 1e-9
    areas = [area_below(contours, np.mean(border < bound)) for bound in (least, most)]
    # A pixel that the contour crosses is right or wrong by up to half its area, and about
    # length * PIXELS of them are crossed; they cancel but for a fifth at worst, measured 0.08.
    slack = 0.1 * sum(contour.length for contour in contours) / PIXELS + 1e-4
    assert max(areas) > np.mean(values < least) - slack
    assert min(areas) < np.mean(values < most) + slack


@given(
    st.integers(0, 10**6),
    st.sampled_from(sorted(SPACES)),
    st.sampled_from(sorted(DRAWS)),
    st.sampled_from([0.0, 0.25, 0.3, 0.5, -1.0]),
    st.sampled_from([-60, -30, 30, 60]),
)
@example(3, "hierarchical", "few", 0.25, 30)  # open parts of rings, if slack is absolute
def test_level_sets_scale_with_the_values(
    seed: int, space: str, draw: str, level: float, power: int
) -> None:
    """Times a power of two nothing is rounded otherwise: the same contours, to the bit."""
    spline = SPACES[space](np.random.default_rng(seed), DRAWS[draw])
    scaled = replace(spline, ordinates=2.0**power * spline.ordinates)
    found, other = spline.contours(level), scaled.contours(2.0**power * level)
    assert [contour.closed for contour in found] == [contour.closed for contour in other]
    for contour, image in zip(found, other, strict=True):
        assert np.array_equal(contour.arcs, image.arcs)
        assert np.array_equal(contour.weights, image.weights)


@pytest.mark.parametrize("space", SPACES)
def test_every_contour_parts_two_regions(space: str) -> None:
    """Regions below and above, joined by contours as edges, form a tree: the square has no hole."""
    clear = 0
    for seed in range(12):
        spline = SPACES[space](np.random.default_rng(seed), normal)
        for level in (-0.4, 0.1):
            values = pixel_values(spline, 500)
            # Regions no wider than a few pixels, or nearly joined, are no matter for pixels.
            counts = {
                ndimage.label(values < level + shift, structure)[1]
                + ndimage.label(values >= level + shift, structure)[1]
                for shift in (-0.03, 0.0, 0.03)
                for structure in (None, np.ones((3, 3)))
            }
            if len(counts) == 1:
                clear += 1
                assert len(spline.contours(level)) == counts.pop() - 1
    assert clear >= 5


@pytest.mark.parametrize("space", SPACES)
def test_lower_values_lie_to_the_left(space: str) -> None:
    for seed in range(5):
        spline = SPACES[space](np.random.default_rng(seed), normal)
        for contour in spline.contours(0.1):
            points = evaluate(contour.arcs, contour.weights, np.array([0.2, 0.5, 0.8]))
            early, late = (
                evaluate(contour.arcs, contour.weights, t + np.array([0.2, 0.5, 0.8]))
                for t in (-1e-4, 1e-4)
            )
            ahead = (late - early) / np.linalg.norm(late - early, axis=-1)[..., None]
            left = np.stack([-ahead[..., 1], ahead[..., 0]], axis=-1)
            steep = np.linalg.norm(spline.gradient(points), axis=-1) > 0.1
            # A hair of 1e-5, with second derivatives up to 1e3: the slope decides.
            lower, higher = (
                spline(np.clip(points + side * 1e-5 * left, 0.0, 1.0)) for side in (1.0, -1.0)
            )
            assert (lower < higher)[steep].all()


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_nearly_straight_arcs_in_any_unit(size: float) -> None:
    """They once bulged by a fixed length, whatever the shape's size."""
    grid = Grid.uniform((0.0, 0.0, size, size), 4, 4)

    def parabola(points: np.ndarray) -> np.ndarray:
        x, y = points.T / size
        return x + 1e-8 * y * y

    for level in (0.31, 0.62):
        (line,) = quasi_interpolate(parabola, grid, "W").contours(level)
        points = evaluate(line.arcs, line.weights, np.linspace(0.0, 1.0, 7)).reshape(-1, 2)
        # Rounding of coefficients of order one, and of the points.
        assert np.abs(parabola(points) - level).max() < 1e-15


@pytest.mark.parametrize("angle", np.linspace(0.1, 3.0, 12))
def test_valley_above_the_level(angle: float) -> None:
    """The Hessian is singular: exactly so after rounding, in one triangle or another."""
    along = np.array([np.cos(angle), np.sin(angle)])
    grid = Grid.uniform((-1.0, -1.0, 1.0, 1.0), 9, 7)
    spline = quasi_interpolate(lambda points: (points @ along - 0.123) ** 2, grid, "W")
    # Ordinates lie below the level in some cells, so that they are looked at; values do not.
    assert spline.ordinates.min() < -1e-3
    assert spline.contours(-1e-3) == []
    assert len(spline.contours(1e-3)) == 2


def test_plateau_at_the_level() -> None:
    grid = Grid.uniform((0.0, 0.0, 1.0, 1.0), 8, 8)
    coefficients = np.zeros((10, 10))
    coefficients[4, 4] = -1.0
    # One B-spline on a plateau: its support is an octagon in 3 x 3 cells, and all of its border
    # touches the level. Its four corners are cut off by half a cell each: 7 cells.
    (hole,) = SplineSDF(grid, tensor_ordinates(grid, coefficients)).contours(0.0)
    assert hole.closed
    assert hole.area == pytest.approx(7.0 / 64.0, rel=1e-7)
    bump = SplineSDF(grid, tensor_ordinates(grid, -coefficients)).contours(0.0)
    assert bump == []


def test_level_that_leaves_the_domain() -> None:
    grid = Grid.uniform((0.0, 0.0, 2.0, 1.0), 5, 3)
    spline = quasi_interpolate(lambda points: np.hypot(*points.T) ** 2, grid, "W")
    (quarter,) = spline.contours(0.64)
    assert not quarter.closed
    # The inside on the left: from the x axis to the y axis.
    assert quarter.arcs[0, 0] == pytest.approx((0.8, 0.0), abs=1e-15)
    assert quarter.arcs[-1, 2] == pytest.approx((0.0, 0.8), abs=1e-15)
    assert quarter.length == pytest.approx(0.4 * np.pi, rel=1e-13)
    two_ways_out = spline.contours(1.44)
    assert [contour.closed for contour in two_ways_out] == [False]
    assert spline.contours(-0.1) == []
    assert spline.contours(5.1) == []
