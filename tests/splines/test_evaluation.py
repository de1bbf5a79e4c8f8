"""How a spline is evaluated: naive = fast in its domain, and the extension beyond it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.meshes import Grid, Mesh, Quadtree
from splinesdf.spaces.quadratic import TRIANGLES, center_ordinates
from splinesdf.spaces.tensor import tensor_ordinates
from splinesdf.splines.spline import SplineSDF
from tests.examples import examples
from tests.naive_tree import cells_at, refine
from tests.named_shapes import UNIT, gamma
from tests.spaces.test_spaces import random_quadtree
from tests.trees import hierarchical_ordinates

RANDOM = np.random.default_rng(5)
TOLERANCE = 2e-3
MESHES: dict[str, Callable[[], Mesh]] = {
    "one cell": lambda: Grid.uniform((-1.0, 2.0, 3.0, 3.0), 1, 1),
    "equal cells": lambda: Grid.uniform((-1.0, 2.0, 3.0, 3.0), 7, 4),
    "lines": lambda: Grid.from_lines([0.0, 0.3, 0.4, 0.8, 1.0], [0.0, 0.1, 0.5, 0.7, 1.0]),
    "roots": lambda: Quadtree.uniform(UNIT, 3, 2),
    "quadtree": lambda: random_quadtree(3),
    # Halved in one corner only: most places of the entry are leaves of higher levels.
    "deep": lambda: corner_quadtree(9),
}


def corner_quadtree(levels: int) -> Quadtree:
    mesh = Quadtree.uniform((0.0, 0.0, 2.0, 1.0), 2, 1)
    for _ in range(levels):
        mesh = refine(
            mesh, np.arange(len(mesh.leaves)) == cells_at(mesh, np.array([[2.0, 0.0]]))[0]
        )
    return mesh


@cache
def rough(name: str) -> SplineSDF:
    """A spline with a coefficient at random for every function: C¹, but no distance."""
    mesh = MESHES[name]()
    random = np.random.default_rng(7)
    if isinstance(mesh, Grid):
        m, n = mesh.shape
        return SplineSDF(mesh, tensor_ordinates(mesh, random.normal(size=(m + 2, n + 2))))
    assert isinstance(mesh, Quadtree)
    return SplineSDF(
        mesh, hierarchical_ordinates(mesh, lambda level, cells: random.normal(size=len(cells)))
    )


@cache
def fitted(name: str = "gamma2") -> SplineSDF:
    return ss.fit(gamma(name), tolerance=TOLERANCE, domain=UNIT).spline


def beyond(spline: SplineSDF, count: int, far: float = 2.0, seed: int = 0) -> np.ndarray:
    """Random points outside the domain, up to so many of its sizes away."""
    low, high = np.array(spline.domain[:2]), np.array(spline.domain[2:])
    points = np.random.default_rng(seed).uniform(
        low - far * (high - low), high + far * (high - low), (count, 2)
    )
    return points[((points < low) | (points > high)).any(axis=1)]


def bernstein(spline: SplineSDF, cells: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Values, gradients, and second derivatives as xx, xy, yy, of cells at points: (n, 6).

    By the definition: Bernstein-Bézier quadratics on the triangle whose weights are positive.
    """
    boxes, ordinates = spline.mesh.boxes[cells], spline.ordinates[cells]
    beside, center = center_ordinates(ordinates)
    corner = np.stack([boxes[:, [i, j]] for j in (1, 3) for i in (0, 2)], axis=1)
    middle = corner.mean(axis=1)
    best = np.full(len(points), -np.inf)
    result = np.empty((len(points), 6))
    for first, side, second in TRIANGLES:
        triangle = np.stack([corner[:, first], corner[:, second], middle], axis=1)
        # Gradients of the weights from the inverse of [1 x y]; rows are the three corners.
        inverse = np.linalg.inv(np.concatenate([np.ones((len(points), 3, 1)), triangle], axis=2))
        slope = inverse[:, 1:].transpose(0, 2, 1)
        weights = np.einsum("nij,nj->ni", slope, points - middle) + np.array([0.0, 0.0, 1.0])
        form = np.empty((len(points), 3, 3))
        form[:, 0, 0], form[:, 1, 1] = ordinates[:, first], ordinates[:, second]
        form[:, 2, 2] = center
        form[:, 0, 1] = form[:, 1, 0] = ordinates[:, side]
        form[:, 0, 2] = form[:, 2, 0] = beside[:, first]
        form[:, 1, 2] = form[:, 2, 1] = beside[:, second]
        value = np.einsum("ni,nij,nj->n", weights, form, weights)
        gradient = 2.0 * np.einsum("ni,nij,njk->nk", weights, form, slope)
        second_derivative = 2.0 * np.einsum("nia,nij,njb->nab", slope, form, slope)
        here = weights.min(axis=1) > best
        best[here] = weights.min(axis=1)[here]
        result[here, 0], result[here, 1:3] = value[here], gradient[here]
        result[here, 3:] = second_derivative.reshape(-1, 4)[here][:, [0, 1, 3]]
    return result


@pytest.mark.parametrize("name", MESHES)
def test_values_gradients_and_hessians_are_those_of_the_cells_bernstein_forms(name: str) -> None:
    spline = rough(name)
    low, high = np.array(spline.domain[:2]), np.array(spline.domain[2:])
    boxes = spline.mesh.boxes
    inner = boxes[:, :2] + RANDOM.uniform(0.05, 0.95, (20, len(boxes), 2)) * (
        boxes[:, 2:] - boxes[:, :2]
    )
    # Anywhere, in every cell however small, and on vertices, some of them on the border.
    points = np.concatenate(
        [RANDOM.uniform(low, high, (3000, 2)), inner.reshape(-1, 2), boxes[:, :2], boxes[:, 2:]]
    )
    cells = cells_at(spline.mesh, points)
    expected = bernstein(spline, cells, points)
    side = (boxes[:, 2:] - boxes[:, :2]).min(axis=1)[cells]
    # Rounding: ordinates of a few units; each derivative divides by the cell's side.
    assert np.max(np.abs(spline(points) - expected[:, 0])) < 1e-13
    value, gradient = spline.value_and_gradient(points)
    assert np.array_equal(value, spline(points))
    assert np.max(np.abs(gradient - expected[:, 1:3]) * side[:, None]) < 1e-12
    smooth = slice(0, -2 * len(boxes))  # in a vertex any triangle's will do
    hessian = spline.hessian(points)[smooth].reshape(-1, 4)[:, [0, 1, 3]]
    scaled = np.abs(hessian - expected[smooth, 3:]) * side[smooth, None] ** 2
    assert np.max(scaled) < 1e-11


@pytest.mark.parametrize("name", ["lines", "quadtree"])
def test_answers_do_not_depend_on_the_company_or_the_order_of_points(name: str) -> None:
    # Blocks of 256 and of 8192: a point's place in them must not matter.
    spline = rough(name)
    points = RANDOM.uniform(-0.2, 1.2, (20_001, 2))
    points[::97] = np.nan
    value, gradient = spline.value_and_gradient(points)
    order = RANDOM.permutation(len(points))
    assert np.array_equal(spline(points[order]), value[order], equal_nan=True)
    assert np.array_equal(spline.gradient(points[order]), gradient[order], equal_nan=True)
    for k in (0, 1, 97, 8191, 8192, 20_000):
        assert np.array_equal(spline(points[k]), value[k], equal_nan=True)
    assert spline(np.empty((0, 2))).shape == (0,)
    assert spline.hessian(np.zeros((3, 4, 2))).shape == (3, 4, 2, 2)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("outside", ["extend", "nan"])
def test_a_grid_is_the_values_at_its_nodes(name: str, outside: Any) -> None:
    # To rounding: a node between two cells may count for either.
    spline = rough(name)
    xmin, ymin, xmax, ymax = spline.domain
    larger = (xmin - 0.3, ymin - 0.1, xmax, ymax + 0.2)
    for domain in (None, larger, (xmax + 1.0, ymin, xmax + 2.0, ymax)):
        for nx, ny in ((2, 3), (129, 201)):  # from node to node, and from cell to cell
            grid = spline.grid(nx, ny, domain=domain, outside=outside)
            box = domain or spline.domain
            assert np.array_equal(grid.x, np.linspace(box[0], box[2], nx))
            assert np.array_equal(grid.y, np.linspace(box[1], box[3], ny))
            nodes = np.stack(np.meshgrid(grid.x, grid.y), axis=-1)
            expected = spline(nodes, outside=outside)
            assert grid.distance == pytest.approx(expected, abs=1e-13, nan_ok=True)
            assert np.isnan(expected).any() == (outside == "nan" and domain is not None)


@pytest.mark.parametrize("name", MESHES)
def test_extension_is_the_least_of_border_value_plus_distance(name: str) -> None:
    spline = rough(name)
    xmin, ymin, xmax, ymax = spline.domain
    size = max(xmax - xmin, ymax - ymin)
    share = np.linspace(0.0, 1.0, 20_001)
    x, y = xmin + share * (xmax - xmin), ymin + share * (ymax - ymin)
    border = np.concatenate(
        [
            np.column_stack(np.broadcast_arrays(a, b))
            for a, b in ((x, ymin), (x, ymax), (xmin, y), (xmax, y))
        ]
    )
    on_border = spline(border)
    points = beyond(spline, 400, far=1.0)
    low, high = np.array([xmin, ymin]), np.array([xmax, ymax])
    off = np.maximum(low - points, points - high).max(axis=1)
    points = points[off > 0.01 * size]
    naive = np.array([(on_border + np.hypot(*(border - p).T)).min() for p in points])
    found, gradient = spline.value_and_gradient(points)
    # Samples h apart miss a minimum in between by f'' h² / 8 at most.
    bend = np.abs(spline.hessian(border)).max() + 1.0 / (0.01 * size)
    assert np.max(found - naive) < 1e-12
    assert np.max(naive - found) < bend * (size / 20_000) ** 2 / 8.0 + 1e-12
    assert np.max(np.abs(np.hypot(*gradient.T) - 1.0)) < 1e-14


@pytest.mark.parametrize("name", ["equal cells", "quadtree"])
def test_extension_of_a_rough_spline_has_these_derivatives(name: str) -> None:
    spline = rough(name)
    points = beyond(spline, 4000, far=0.3)
    h = 1e-6
    wrong = np.zeros((2, len(points)))
    gradient, hessian = spline.gradient(points), spline.hessian(points)
    for axis in (0, 1):
        step = h * np.eye(2)[axis]
        slope = (spline(points + step) - spline(points - step)) / (2.0 * h)
        bend = (spline.gradient(points + step) - spline.gradient(points - step)) / (2.0 * h)
        wrong[0] += np.abs(gradient[:, axis] - slope)
        wrong[1] += np.abs(hessian[:, axis] - bend).max(axis=1)
    # Beside a ridge, where two points of the border tie, or where q leaves a corner, differences
    # straddle two answers, and next to the border bends are large: a few points in a thousand.
    assert (wrong[0] > 1e-5).mean() < 5e-3
    assert (wrong[1] > 1e-3 * (1.0 + np.abs(hessian).max(axis=(1, 2)))).mean() < 5e-3
    assert np.abs(hessian).max() > 1.0  # else the line above says nothing


@pytest.mark.parametrize("far", [0.1, 3.0, 1e3, 1e9])
@pytest.mark.parametrize("name", ["gamma1", "gamma2"])
def test_a_fit_keeps_its_tolerance_in_the_whole_plane(name: str, far: float) -> None:
    points = beyond(fitted(name), 5000, far)
    exact = ss.signed_distance(gamma(name), points)
    rounding = 4e-16 * np.abs(exact).max()
    assert np.max(np.abs(fitted(name)(points) - exact)) <= TOLERANCE + rounding


def test_far_points_are_answered_as_long_as_they_are_finite() -> None:
    spline = fitted()
    points = [(1e100, 3.0), (-1e200, 1e200), (0.5, -1e-320), (0.0, np.nextafter(1.0, 2.0))]
    value, gradient = spline.value_and_gradient(points)
    assert value[:2] == pytest.approx([1e100, np.sqrt(2.0) * 1e200])
    assert np.isfinite(value).all()
    assert np.hypot(*gradient.T) == pytest.approx(1.0)
    assert np.isnan(spline([(np.inf, 0.0), (0.0, np.nan)])).all()


PLACE = st.tuples(*(st.floats(-2.0, 3.0, allow_subnormal=False),) * 2)


@given(PLACE, PLACE)
@examples(300)
def test_extension_is_1_lipschitz_and_with_the_spline_to_twice_its_error(
    p: tuple[float, float], q: tuple[float, float]
) -> None:
    apart = np.hypot(p[0] - q[0], p[1] - q[1])
    # |F - u| <= tolerance at both ends.
    assert abs(np.diff(fitted()([p, q]))[0]) <= apart + 2.0 * TOLERANCE + 1e-14
    # Outside, F is a least of 1-Lipschitz functions, whatever the spline.
    wild = rough("lines")
    if all(not (0.0 <= x <= 1.0 and 0.0 <= y <= 1.0) for x, y in (p, q)):
        assert abs(np.diff(wild([p, q]))[0]) <= apart + 1e-13


def test_at_the_border_the_extension_steps_down_by_twice_the_error_at_most() -> None:
    share = RANDOM.uniform(0.0, 1.0, 5000)
    for axis, at, off in ((0, 0.0, -1e-12), (0, 1.0, 1e-12), (1, 0.0, -1e-12), (1, 1.0, 1e-12)):
        inner = np.column_stack([share, share])
        inner[:, axis] = at
        outer = inner.copy()
        outer[:, axis] += off
        step = fitted()(inner) - fitted()(outer)
        assert step.min() > -2e-12
        assert step.max() <= 2.0 * TOLERANCE


def test_a_closest_point_from_outside_lies_on_the_curve() -> None:
    points = beyond(fitted("gamma1"), 5000, 1.0)
    landed = fitted("gamma1").closest_point(points)
    exact = ss.closest_point(gamma("gamma1"), points)
    assert np.max(np.abs(ss.signed_distance(gamma("gamma1"), landed))) <= 3.0 * TOLERANCE
    # From the distance d the direction is known to the root of tolerance / d.
    assert np.max(np.hypot(*(landed - exact).T)) < 2.0 * np.sqrt(TOLERANCE * 2.0)
    far = fitted("gamma1").normal([(3.0, 0.5)])
    assert far == pytest.approx(np.array([[1.0, 0.0]]), abs=np.sqrt(TOLERANCE))
    assert not fitted("gamma1").inside(points).any()


def test_a_shape_that_leaves_the_domain_gets_some_1_lipschitz_function() -> None:
    spline = ss.fit(gamma("gamma1"), tolerance=0.01, domain=(0.4, 0.4, 1.2, 1.2)).spline
    points = beyond(spline, 3000, 1.0)
    value, other = spline(points), spline(points[::-1])
    apart = np.hypot(*(points - points[::-1]).T)
    assert np.isfinite(value).all()
    assert np.max(np.abs(value - other) - apart) < 1e-14
    assert (value < 0.0).any()


METHODS: dict[str, Callable[..., Any]] = {
    "values": SplineSDF.__call__,
    "gradient": SplineSDF.gradient,
    "hessian": SplineSDF.hessian,
    "normal": SplineSDF.normal,
    "curvature": SplineSDF.curvature,
    "closest_point": SplineSDF.closest_point,
}


@pytest.mark.parametrize("method", METHODS)
def test_outside_is_nan_for_those_who_ask(method: str) -> None:
    ask, spline = METHODS[method], fitted()
    points = np.array([(1.1, 0.5), (0.5, 0.3), (0.5, -1e-9), (np.nan, 0.5), (np.inf, 0.0)])
    extended = ask(spline, points).reshape(5, -1)
    assert np.isfinite(extended[:3]).all()
    assert np.isnan(extended[3:]).all()
    answered = ask(spline, points, outside="nan").reshape(5, -1)
    assert np.isnan(answered[[0, 2, 3, 4]]).all()
    assert np.array_equal(answered[1], extended[1])
    with pytest.raises(ss.InputError, match="expected outside 'extend' or 'nan', got 'zero'"):
        ask(spline, points, outside="zero")


def test_nothing_is_inside_outside_the_domain_for_those_who_ask() -> None:
    everywhere = SplineSDF(Grid.uniform(UNIT, 2, 2), np.full((4, 8), -1.0))
    points = [(0.5, 0.5), (1.5, 0.5), (3.0, 0.5), (np.nan, 0.0)]
    assert everywhere.inside(points).tolist() == [True, True, False, False]
    assert everywhere.inside(points, outside="nan").tolist() == [True, False, False, False]


@pytest.mark.parametrize(
    ("arguments", "options", "says"),
    [
        ((1, 5), {}, "at least 2 nodes"),
        ((2.5, 5), {}, "number of nodes"),
        ((5, 5), {"domain": (0, 0, 0, 1)}, "xmin < xmax"),
        ((5, 5), {"outside": None}, "outside 'extend' or 'nan'"),
    ],
)
def test_grids_that_cannot_be_are_refused(
    arguments: tuple[Any, ...], options: dict[str, Any], says: str
) -> None:
    with pytest.raises(ss.InputError, match=says):
        fitted().grid(*arguments, **options)
