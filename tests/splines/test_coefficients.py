"""B-spline coefficients of splines on grids: the sum of B-splines, evaluated, is the spline."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.spaces.space import space_on
from splinesdf.spaces.tensor import tensor_ordinates
from splinesdf.splines.quasi import bspline, quasi_interpolate
from splinesdf.splines.spline import SplineSDF

GRIDS = [
    Grid.from_lines(np.linspace(0.0, 1.0, 2), np.linspace(0.0, 1.0, 2)),
    Grid.from_lines(np.linspace(-1.0, 1.0, 6), np.linspace(0.0, 1.0, 5)),
    Grid.from_lines([0.0, 0.1, 0.5, 0.6, 2.0], [3.0, 3.5, 3.6, 5.0]),
    Grid.from_lines([0.0, 1e-3, 1.0], np.linspace(0.0, 1.0, 9) ** 2),
]


def null(mesh: Grid) -> np.ndarray:
    """The spline of these coefficients is zero."""
    sides = [np.diff(lines) for lines in (mesh.x, mesh.y)]
    h, k = (np.concatenate([side[:1], side, side[-1:]]) for side in sides)
    signs = np.array([[(-1.0) ** (i + j) for j in range(len(k))] for i in range(len(h))])
    return np.asarray(signs * h[:, None] * k)


@pytest.mark.parametrize("mesh", GRIDS)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_sum_of_bsplines_is_the_spline(mesh: Grid, seed: int) -> None:
    random = np.random.default_rng(seed)
    m, n = mesh.shape
    drawn = random.normal(size=(m + 2, n + 2))
    spline = SplineSDF(mesh, tensor_ordinates(mesh, drawn))
    found = spline.coefficients()
    xmin, ymin, xmax, ymax = mesh.domain
    points = [xmin, ymin] + random.uniform(size=(300, 2)) * [xmax - xmin, ymax - ymin]
    total = sum(
        found[i + 1, j + 1] * bspline(mesh, i, j)(points)
        for i in range(-1, m + 1)
        for j in range(-1, n + 1)
    )
    np.testing.assert_allclose(total, spline(points), rtol=0, atol=1e-11)
    away = null(mesh)
    assert abs(np.sum(found * away)) <= 1e-11 * np.abs(away).sum()
    given = drawn - away * np.sum(drawn * away) / np.sum(away * away)
    np.testing.assert_allclose(found, given, rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", ["quartic", "cubic"])
@pytest.mark.parametrize("shape", [(1, 1), (4, 1), (5, 6)])
def test_sum_of_others_is_the_spline(name: str, shape: tuple[int, int]) -> None:
    element, mesh = ELEMENTS[name], Grid.uniform((-1.0, 0.0, 2.0, 1.0), *shape)
    random = np.random.default_rng(5)
    beyond = {"quartic": 2, "cubic": 1}[name]
    drawn = random.normal(size=(shape[0] + 1 + beyond, shape[1] + 1 + beyond))
    every = {
        (i, j): bspline(mesh, i - 1, j - 1, element).ordinates for i, j in np.ndindex(drawn.shape)
    }
    numbers = sum(drawn[place] * ordinates for place, ordinates in every.items())
    found = SplineSDF(mesh, np.asarray(numbers), element=element).coefficients()
    signs = (-1.0) ** np.add.outer(*map(np.arange, drawn.shape))
    away = signs * (signs * drawn).mean() if name == "quartic" else 0.0
    np.testing.assert_allclose(found, drawn - away, rtol=0, atol=1e-12)


def test_of_many_quartic_cells_far_from_the_origin() -> None:
    mesh = Grid.uniform((1e6, 1e6, 1e6 + 2.0, 1e6 + 2.0), 160, 150)
    made = quasi_interpolate(
        lambda p: np.hypot(*(p - 1e6 - 1.0).T) - 0.7, mesh, "O", ELEMENTS["quartic"]
    )
    found = made.coefficients()
    assert found.shape == (163, 153)
    again = space_on(made.mesh, made.element).numbers(found.reshape(-1))
    np.testing.assert_allclose(again, made.ordinates, rtol=0, atol=1e-11)


def test_of_a_shape() -> None:
    made = ss.interpolate(ss.Shape.circle((0, 0), 1), (40, 30)).spline
    again = tensor_ordinates(made.mesh, made.coefficients())
    np.testing.assert_allclose(again, made.ordinates, rtol=0, atol=1e-12)


def test_sides_of_many_sizes() -> None:
    mesh = Grid.from_lines(np.geomspace(1e-6, 1.0, 60), np.geomspace(1.0, 1e6, 50))
    drawn = np.random.default_rng(7).normal(size=(61, 51))
    made = SplineSDF(mesh, tensor_ordinates(mesh, drawn))
    again = tensor_ordinates(mesh, made.coefficients())
    np.testing.assert_allclose(again, made.ordinates, rtol=0, atol=1e-12)


def test_refused() -> None:
    disk = ss.Shape.circle((0, 0), 1)
    tree = ss.fit(disk, tolerance=0.05).spline
    mean = ss.interpolate(disk, (6, 6), element="S31").spline
    for spline in (tree, mean):
        with pytest.raises(ss.InputError, match="element quadratic, quartic, cubic on a grid"):
            spline.coefficients()
    made = ss.interpolate(disk, (6, 6)).spline
    changed = made.ordinates.copy()
    changed[7, 3] += 1e-6
    with pytest.raises(ss.InputError, match="do not fit together"):
        SplineSDF(made.mesh, changed).coefficients()
    quartic = ss.interpolate(disk, (6, 6), element="quartic").spline
    changed = quartic.ordinates.copy()
    changed[7, 13] += 1e-6
    with pytest.raises(ss.InputError, match="do not fit together"):
        SplineSDF(made.mesh, changed, element=quartic.element).coefficients()
