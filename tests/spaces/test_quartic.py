"""The quartic element: reproduction, smoothness, orders, its hierarchy against the slow way."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid, Quadtree
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.spaces.hierarchical import HierarchicalSpace
from splinesdf.spaces.space import interpolated, space_on
from splinesdf.splines.quasi import bspline, quasi_interpolate
from splinesdf.splines.spline import SplineSDF
from tests import naive_tree
from tests.named_shapes import UNIT, gamma

QUARTIC = ELEMENTS["quartic"]
POINTS = np.random.default_rng(3).random((20_000, 2))


def cubic(points: np.ndarray) -> np.ndarray:
    x, y = points.T
    return np.asarray(
        1
        + 2 * x
        - y
        + 3 * x * x
        - 2 * x * y
        + 0.7 * y * y
        + x**3
        - 2 * x * x * y
        + x * y * y
        - y**3
    )


def random_tree(seed: int, shape: tuple[int, int], domain: tuple[float, ...] = UNIT) -> Quadtree:
    random = np.random.default_rng(seed)
    mesh = Quadtree.uniform(domain, *shape)
    for _ in range(4):
        mesh = naive_tree.refine(mesh, random.random(len(mesh.leaves)) < 0.12)
    return mesh


def test_values_of_the_b_spline_and_its_support() -> None:
    spline = bspline(Grid.uniform((0, 0, 6, 6), 6, 6), 3, 3, QUARTIC)
    at = [(3, 3), (4, 3), (3, 2), (4, 4), (2, 4), (3.5, 3.5), (2.5, 3.5), (4.5, 3.5), (3.5, 1.5)]
    exact = [5 / 12, 1 / 8, 1 / 8, 1 / 48, 1 / 48, 11 / 48, 11 / 48, 1 / 96, 1 / 96]
    assert spline(at) == pytest.approx(exact, abs=1e-16)
    x, y = np.abs(6.0 * POINTS - 3.0).T
    inside = (x < 2.0) & (y < 2.0) & (x + y < 3.0)
    value = spline(6.0 * POINTS)
    assert (value[inside] > 0.0).all()
    assert np.abs(value[~inside]).max() <= 1e-15


def test_b_splines_sum_to_one_and_have_one_dependence() -> None:
    mesh = Grid.uniform((0, 0, 3, 2), 3, 2)
    every = {
        (i, j): bspline(mesh, i, j, QUARTIC).ordinates.ravel()
        for i in range(-1, 5)
        for j in range(-1, 4)
    }
    assert len(every) == len(space_on(mesh, QUARTIC).places)
    assert np.linalg.matrix_rank(np.array(list(every.values()))) == len(every) - 1
    total = sum((-1.0) ** (i + j) * numbers for (i, j), numbers in every.items())
    assert np.abs(total).max() <= 1e-15
    one = np.zeros((6, 15))
    one[:, 0] = 1.0
    assert np.abs(sum(every.values()) - one.ravel()).max() <= 1e-15
    with pytest.raises(ss.InputError, match="i"):
        bspline(mesh, 5, 0, QUARTIC)


@pytest.mark.parametrize("operator", "OCD")
@pytest.mark.parametrize("seed", range(3))
def test_cubics_are_reproduced_across_levels(operator: str, seed: int) -> None:
    mesh = random_tree(seed, (2 + seed, 3))
    assert mesh.depth >= 3
    spline = quasi_interpolate(cubic, mesh, operator, QUARTIC)
    assert np.abs(spline(POINTS) - cubic(POINTS)).max() <= 1e-13
    # A quartic is not, which shows that the test can fail.
    fourth = quasi_interpolate(lambda p: p[:, 0] ** 4, mesh, operator, QUARTIC)
    assert np.abs(fourth(POINTS) - POINTS[:, 0] ** 4).max() > 1e-7


def test_v_reproduces_bilinear_functions() -> None:
    def bilinear(points: np.ndarray) -> np.ndarray:
        return np.asarray(1 + 2 * points[:, 0] - points[:, 1] + 3 * points[:, 0] * points[:, 1])

    for mesh in (Grid.uniform(UNIT, 7, 4), random_tree(5, (3, 3))):
        spline = quasi_interpolate(bilinear, mesh, "V", QUARTIC)
        assert np.abs(spline(POINTS) - bilinear(POINTS)).max() <= 1e-14


def smooth(points: np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(3 * points[:, 0]) * np.exp(points[:, 1]))


def slow_numbers(mesh: Quadtree) -> np.ndarray:
    """The cells' numbers by the definition: every vertex of every level asked for by name."""
    m, n = mesh.shape
    weights = {(0, 0): 193 / 90}
    for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        weights |= {(a, b): -25 / 72, (2 * a, 2 * b): 7 / 240, (a + b, b - a): 23 / 720}
    rows = [(0, 1, 2, 1, 0), (1, 4, 6, 4, 1), (2, 6, 8, 6, 2), (1, 4, 6, 4, 1), (0, 1, 2, 1, 0)]
    there = {tuple(key) for key in np.column_stack([mesh.level, mesh.index]).tolist()}

    def refined(level: int, i: int, j: int) -> bool:
        cells = ((level, i + a, j + b) for a in range(-2, 2) for b in range(-2, 2))
        return all(
            cell in there
            for cell in cells
            if 0 <= cell[1] < m << level and 0 <= cell[2] < n << level
        )

    @cache
    def coefficient(level: int, i: int, j: int) -> float:
        if level == 0 or refined(level, i, j):
            h = 2.0**-level
            points = np.array([((i + a) * h / m, (j + b) * h / n) for a, b in weights])
            return float(np.dot(smooth(points), list(weights.values())))
        total = 0.0
        for a in range(-2, 3):
            for b in range(-2, 3):
                if (i - a) % 2 == 0 and (j - b) % 2 == 0 and rows[a + 2][b + 2]:
                    coarse = coefficient(level - 1, (i - a) // 2, (j - b) // 2)
                    total += rows[a + 2][b + 2] / 16 * coarse
        return total

    blocks = [
        [coefficient(level, i + a, j + b) for a in range(-1, 3) for b in range(-1, 3)]
        for level, i, j in np.column_stack([mesh.level, mesh.index])[mesh.leaves].tolist()
    ]
    return np.array(blocks) @ QUARTIC.from_coefficients.T


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("shape", [(1, 1), (3, 2)])
def test_coefficients_on_trees_are_those_of_the_definition(
    seed: int, shape: tuple[int, int]
) -> None:
    mesh = random_tree(seed, shape)
    fast = interpolated(HierarchicalSpace(mesh, QUARTIC), smooth, "O")
    assert np.abs(fast - slow_numbers(mesh)).max() <= 1e-12


@pytest.mark.parametrize("seed", range(2))
def test_second_derivatives_go_on_across_sides_and_levels(seed: int) -> None:
    mesh = random_tree(seed, (3, 3))
    spline = quasi_interpolate(smooth, mesh, "O", QUARTIC)
    boxes = mesh.boxes[mesh.boxes[:, 2] < 1.0]
    u = np.random.default_rng(seed).uniform(0.01, 0.99, len(boxes))
    side = np.stack([boxes[:, 2], boxes[:, 1] + u * (boxes[:, 3] - boxes[:, 1])], axis=1)
    step = np.array([1e-13, 0.0])
    before, after = spline.hessian(side - step), spline.hessian(side + step)
    assert np.abs(before - after).max() <= 1e-10 * np.abs(before).max()
    assert not np.array_equal(before, after)
    turned = SplineSDF(mesh, spline.ordinates * np.where(np.arange(15) == 5, 1.0001, 1.0),
                       element=QUARTIC)  # fmt: skip
    jump = np.abs(turned.hessian(side - step) - turned.hessian(side + step)).max()
    assert jump > 1e-6


def test_third_derivatives_go_on_across_diagonals() -> None:
    mesh = Grid.uniform(UNIT, 3, 3)
    values = np.random.default_rng(2).normal(size=36)
    spline = SplineSDF(mesh, space_on(mesh, QUARTIC).numbers(values), element=QUARTIC)
    u = np.random.default_rng(4).uniform(0.05, 0.45, 200)[:, None]
    for toward in ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)):
        at = (np.array([4.5, 4.5]) + u * 3.0 * toward) / 9.0
        across, step = np.array([toward[1], -toward[0]]), 1e-6
        near, far = (spline.hessian(at + k * step * across) for k in (1, 2))
        back, beyond = (spline.hessian(at - k * step * across) for k in (1, 2))
        # One-sided differences of the second derivatives.
        one, other = (far - near) / step, (back - beyond) / step
        assert np.abs(one - other).max() <= 1e-3 * np.abs(one).max()


def test_orders_in_a_smooth_band() -> None:
    shape = ss.Shape.circle((0.5, 0.5), 0.3)
    angle, off = np.random.default_rng(5).random((2, 20_000))
    radius = 0.3 + 0.04 * (2.0 * off - 1.0)
    ray = np.stack([np.cos(2 * np.pi * angle), np.sin(2 * np.pi * angle)], axis=1)
    points = 0.5 + radius[:, None] * ray
    across = np.stack([-ray[:, 1], ray[:, 0]], axis=1)
    second = across[:, :, None] * across[:, None] / radius[:, None, None]
    errors = []
    for count in (48, 96, 192):
        mesh = Grid.uniform(UNIT, count, count)
        spline = quasi_interpolate(lambda p: ss.signed_distance(shape, p), mesh, "O", QUARTIC)
        value, gradient = spline.value_and_gradient(points)
        bend = spline.curvature(points)
        errors.append(
            [
                np.abs(value - radius + 0.3).max(),
                np.abs(gradient - ray).max(),
                np.abs(spline.hessian(points) - second).max(),
                np.abs(bend - 1.0 / radius).max(),
            ]
        )
    slopes = np.polyfit(np.log([1.0, 0.5, 0.25]), np.log(errors), 1)[0]
    assert slopes == pytest.approx([4.0, 3.0, 2.0, 2.0], abs=0.15)


def test_gamma_1_on_128_cells_each_way() -> None:
    shape = gamma("gamma1")
    mesh = Grid.uniform(UNIT, 128, 128)
    spline = quasi_interpolate(lambda p: ss.signed_distance(shape, p), mesh, "O", QUARTIC)
    found = ss.project(shape, POINTS)
    band = np.abs(found.distance) <= 0.02
    points, exact = POINTS[band], found.distance[band]
    value, gradient = spline.value_and_gradient(points)
    assert len(points) > 500
    assert np.abs(value - exact).max() <= 6e-10
    away = (points - found.point[band]) / exact[:, None]
    far = np.abs(exact) > 1e-3
    assert np.abs(gradient - away)[far].max() <= 3e-7
    bend = found.curvature[band]
    laplacian = np.trace(spline.hessian(points), axis1=1, axis2=2)
    assert np.abs(laplacian - bend / (1.0 + bend * exact)).max() <= 6e-4


def test_derivatives_are_those_of_the_values() -> None:
    spline = quasi_interpolate(smooth, random_tree(7, (3, 4)), "O", QUARTIC)
    inner = POINTS[(np.abs(POINTS - 0.5) < 0.49).all(axis=1)]
    h = 1e-5
    for axis in (0, 1):
        step = h * np.eye(2)[axis]
        difference = (spline(inner + step) - spline(inner - step)) / (2 * h)
        assert np.abs(spline.gradient(inner)[:, axis] - difference).max() <= 1e-8
        second = (spline.gradient(inner + step) - spline.gradient(inner - step)) / (2 * h)
        assert np.abs(spline.hessian(inner)[:, axis] - second).max() <= 1e-3


def test_the_power_form_is_the_road_of_any_degree() -> None:
    from splinesdf.spaces.element import Element

    mesh = Grid.uniform((-1.0, 0.0, 2.0, 1.0), 9, 7)
    spline = quasi_interpolate(smooth, mesh, "O", QUARTIC)
    fields = {name: getattr(QUARTIC, name) for name in Element.__dataclass_fields__}
    plain = Element(**{**fields, "power_form": None})
    other = SplineSDF(mesh, spline.ordinates, element=plain)
    points = POINTS * [3.0, 1.0] - [1.0, 0.0]
    for order in range(3):
        for found, expected in zip(
            other._evaluate(points, order, "nan"),
            spline._evaluate(points, order, "nan"),
            strict=True,
        ):
            assert found == pytest.approx(expected, abs=1e-10)
    assert np.isnan(spline([(2.5, 0.5), (np.nan, 0.5)], outside="nan")).all()


def test_where_there_are_no_such_b_splines() -> None:
    uneven = Grid.from_lines([0.0, 0.3, 1.0], [0.0, 0.5, 1.0])
    with pytest.raises(ss.InputError, match="hierarchical, uniform for the quartic element"):
        quasi_interpolate(smooth, uneven, "O", QUARTIC)
    with pytest.raises(ss.InputError, match="hierarchical, uniform for the quartic element"):
        ss.fit(gamma("gamma1"), tolerance=0.01, element="quartic", space="tensor")
    with pytest.raises(ss.InputError, match="operator of O, C, D, V"):
        quasi_interpolate(smooth, Grid.uniform(UNIT, 4, 4), "S", QUARTIC)
