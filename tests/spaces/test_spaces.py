from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid, Quadtree
from splinesdf.splines.quasi import bspline, quasi_interpolate
from splinesdf.splines.spline import SplineSDF
from tests.naive_tree import refine
from tests.named_shapes import UNIT

DATA = Path(__file__).parents[1] / "data"
GRID = Grid.from_lines([0.0, 0.3, 0.4, 0.8, 1.0], [0.0, 0.1, 0.5, 0.7, 1.0])
POINTS = np.random.default_rng(0).uniform(0, 1, (20_000, 2))


def random_quadtree(seed: int, rounds: int = 4) -> Quadtree:
    random = np.random.default_rng(seed)
    mesh = Quadtree.uniform(UNIT, 4, 5)
    for _ in range(rounds):
        mesh = refine(mesh, random.random(len(mesh.leaves)) < 0.08)
    return mesh


def quadratic(points: np.ndarray) -> np.ndarray:
    x, y = points.T
    return 1 + 2 * x - y + 3 * x * x - 2 * x * y + 0.7 * y * y


def test_nonuniform_bspline_at_its_85_nodes() -> None:
    nodes = np.genfromtxt(
        DATA / "bspline_nonuniform_values.csv", delimiter=",", skip_header=1, usecols=(0, 1, 3)
    )
    assert len(nodes) == 85
    spline = bspline(Grid.from_lines([0, 1, 3, 3.5], [0, 3, 4, 6]), 1, 1)
    # The file was solved numerically and is printed to 15 digits.
    assert np.max(np.abs(spline(nodes[:, :2]) - nodes[:, 2])) < 4e-15


def test_uniform_bspline_at_center_corners_and_sides() -> None:
    spline = bspline(Grid.uniform((0, 0, 3, 3), 3, 3), 1, 1)
    assert spline([(1.5, 1.5), (1, 1), (2, 1), (1.5, 1), (2, 1.5)]) == pytest.approx(
        [1 / 2, 1 / 4, 1 / 4, 3 / 8, 3 / 8], abs=1e-15
    )


def all_bsplines(mesh: Grid) -> dict[tuple[int, int], SplineSDF]:
    m, n = mesh.shape
    return {(i, j): bspline(mesh, i, j) for i in range(-1, m + 1) for j in range(-1, n + 1)}


def test_bsplines_are_a_partition_of_unity_and_not_negative() -> None:
    values = np.array([b(POINTS) for b in all_bsplines(GRID).values()])
    assert np.max(np.abs(values.sum(axis=0) - 1.0)) < 1e-14
    assert values.min() > -1e-15


def test_bspline_is_positive_just_inside_its_octagon_and_zero_outside() -> None:
    mesh = Grid.uniform((0, 0, 3, 3), 3, 3)
    value = bspline(mesh, 1, 1)(3.0 * POINTS)
    x, y = np.abs(3.0 * POINTS - 1.5).T
    inside = (x < 1.5) & (y < 1.5) & (x + y < 2.0)
    assert (value[inside] > 0).all()
    assert np.max(np.abs(value[~inside])) < 1e-15


def test_the_one_linear_dependence_and_the_dimension() -> None:
    m, n = GRID.shape
    h = np.concatenate([[GRID.x[1] - GRID.x[0]], np.diff(GRID.x), [GRID.x[-1] - GRID.x[-2]]])
    k = np.concatenate([[GRID.y[1] - GRID.y[0]], np.diff(GRID.y), [GRID.y[-1] - GRID.y[-2]]])
    bsplines = all_bsplines(GRID)
    total = sum((-1) ** (i + j) * h[i + 1] * k[j + 1] * b(POINTS) for (i, j), b in bsplines.items())
    assert np.max(np.abs(total)) < 1e-14
    ordinates = np.array([b.ordinates.ravel() for b in bsplines.values()])
    assert np.linalg.matrix_rank(ordinates) == (m + 2) * (n + 2) - 1


def test_cells_ordinates_equal_the_four_bernstein_quadratics() -> None:
    # The power form against the definition: barycentric coordinates in each of the triangles.
    from splinesdf.spaces.quadratic import TRIANGLES, center_ordinates

    random = np.random.default_rng(1)
    ordinates = random.normal(size=(1, 8))
    spline = SplineSDF(Grid.uniform((0, 0, 2, 1), 1, 1), ordinates)
    corner = np.array([(0, 0), (2, 0), (0, 1), (2, 1)], dtype=float)
    beside, center = center_ordinates(ordinates)
    for first, side, second in TRIANGLES:
        weights = random.dirichlet((1, 1, 1), size=500)
        a, b, c = weights.T
        points = weights @ np.array([corner[first], corner[second], (1.0, 0.5)])
        expected = (
            ordinates[0, first] * a * a
            + ordinates[0, second] * b * b
            + center[0] * c * c
            + 2
            * (ordinates[0, side] * a * b + beside[0, first] * a * c + beside[0, second] * b * c)
        )
        assert np.max(np.abs(spline(points) - expected)) < 1e-14


@pytest.mark.parametrize("operator", ["W", "S", "P"])
def test_quadratics_are_reproduced_on_uniform_grids(operator: str) -> None:
    spline = quasi_interpolate(quadratic, Grid.uniform(UNIT, 7, 9), operator)
    assert np.max(np.abs(spline(POINTS) - quadratic(POINTS))) < 1e-14


def test_w_reproduces_quadratics_and_v_bilinears_on_nonuniform_grids() -> None:
    assert (
        np.max(np.abs(quasi_interpolate(quadratic, GRID, "W")(POINTS) - quadratic(POINTS))) < 1e-14
    )

    def bilinear(points: np.ndarray) -> np.ndarray:
        return 1 + 2 * points[:, 0] - points[:, 1] + 3 * points[:, 0] * points[:, 1]

    assert np.max(np.abs(quasi_interpolate(bilinear, GRID, "V")(POINTS) - bilinear(POINTS))) < 1e-14


@pytest.mark.parametrize("seed", range(4))
def test_parity_diagonal_functional_reproduces_quadratics_across_levels(seed: int) -> None:
    mesh = random_quadtree(seed)
    assert mesh.depth >= 3
    spline = quasi_interpolate(quadratic, mesh, "P")
    assert np.max(np.abs(spline(POINTS) - quadratic(POINTS))) < 1e-13
    # W does not, which shows that the test can fail.
    other = quasi_interpolate(quadratic, mesh, "W")
    assert np.max(np.abs(other(POINTS) - quadratic(POINTS))) > 1e-5


def smooth(points: np.ndarray) -> np.ndarray:
    return np.sin(3 * points[:, 0]) * np.exp(points[:, 1])


@pytest.mark.parametrize(("operator", "order"), [("V", 2), ("W", 3), ("S", 3), ("P", 3)])
@pytest.mark.parametrize("mesh_type", [Grid, Quadtree])
def test_order_of_convergence(operator: str, order: int, mesh_type: type) -> None:
    counts = np.array([16, 32, 64, 128])
    errors = [
        np.max(
            np.abs(
                quasi_interpolate(smooth, mesh_type.uniform(UNIT, n, n), operator)(POINTS)
                - smooth(POINTS)
            )
        )
        for n in counts
    ]
    slope = np.polyfit(np.log(1 / counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=0.1)


def test_gradient_and_hessian_are_the_derivatives() -> None:
    spline = quasi_interpolate(smooth, random_quadtree(7), "W")
    inner = POINTS[(np.abs(POINTS - 0.5) < 0.49).all(axis=1)]
    h = 1e-6
    for axis in (0, 1):
        step = h * np.eye(2)[axis]
        difference = (spline(inner + step) - spline(inner - step)) / (2 * h)
        # Central differences: h times the jump of the second derivative where they straddle one.
        assert np.max(np.abs(spline.gradient(inner)[:, axis] - difference)) < 2e-5
    hessian = spline.hessian(inner)
    second = (
        spline.gradient(inner + np.array([h, 0])) - spline.gradient(inner - np.array([h, 0]))
    ) / (2 * h)
    # Points within h of a triangle's border see two Hessians; they are under 1 in 1000 here.
    wrong = np.abs(hessian[:, :, 0] - second).max(axis=1) > 1e-4
    assert wrong.mean() < 1e-3


def test_operators_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ss.InputError, match="equal cells"):
        quasi_interpolate(smooth, GRID, "S")
    with pytest.raises(ss.InputError, match="operator"):
        quasi_interpolate(smooth, GRID, "Q")
