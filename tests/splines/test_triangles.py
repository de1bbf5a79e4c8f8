"""A spline as quadratic triangles: the same function, on a mesh in which nothing hangs."""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.meshes import Grid, Mesh, Quadtree
from splinesdf.splines.quasi import quasi_interpolate
from splinesdf.splines.triangles import Triangles
from tests.examples import examples
from tests.named_shapes import UNIT, gamma
from tests.saving import before_line, full_tree
from tests.triangle_meshes import at_random, check_conforming


def wavy(points: np.ndarray) -> np.ndarray:
    x, y = points[:, 0], points[:, 1]
    return np.asarray(np.sin(3.0 * x) + np.cos(5.0 * y) * x + y)


def random_tree(seed: int, m: int, n: int, levels: int, share: float) -> Quadtree:
    """Any cells are split, so that large ones have very small neighbors."""
    rng = np.random.default_rng(seed)
    flags, count = [], m * n
    for level in range(levels + 1):
        split = rng.random(count) < share if level < levels else np.zeros(count, dtype=bool)
        flags.append(split)
        count = 4 * np.count_nonzero(split)
        if count == 0:
            break
    return Quadtree.from_splits((-0.3, 0.1, 0.8, 0.7), (m, n), np.concatenate(flags))


@cache
def splines() -> dict[str, ss.SplineSDF]:
    x, y = np.array([0.1, 0.2, 0.7, 0.8, 2.0]), np.array([-1.0, -0.9, 0.3, 0.301])
    unequal, deep = Grid.from_lines(x, y), random_tree(4, 2, 1, 6, 0.6)
    return {
        "fit": ss.fit(gamma("gamma2"), tolerance=3e-3).spline,
        "band": ss.fit(gamma("gamma3"), tolerance=1e-3, band=(-0.01, 0.01)).spline,
        "tensor": ss.fit(gamma("gamma1"), tolerance=0.02, space="tensor").spline,
        "uniform": ss.interpolate(gamma("gamma1"), (7, 4), operator="W").spline,
        "unequal": quasi_interpolate(wavy, unequal, "W"),
        "one cell": quasi_interpolate(wavy, Grid.uniform(UNIT, 1, 1), "V"),
        "deep": quasi_interpolate(wavy, deep, "P"),
    }


NAMES = ("fit", "band", "tensor", "uniform", "unequal", "one cell", "deep")


def naive_count(mesh: Mesh) -> int:
    """Four triangles a cell, and one more for each corner of any cell within one of its sides."""
    boxes = [[Fraction(c) for c in row] for row in mesh.corners.tolist()]
    places = {(x, y) for x0, y0, x1, y1 in boxes for x in (x0, x1) for y in (y0, y1)}
    total = 0
    for x0, y0, x1, y1 in boxes:
        on_x = sum(1 for x, y in places if y in (y0, y1) and x0 < x < x1)
        on_y = sum(1 for x, y in places if x in (x0, x1) and y0 < y < y1)
        total += 4 + on_x + on_y
    return total


def check_same_function(spline: ss.SplineSDF, mesh: Triangles, count: int) -> None:
    points, values = at_random(mesh, count)
    size = max(float(np.max(np.abs(mesh.values))), 1e-300)
    # Steep where coordinates are large: a point is as far off as they are rounded.
    slope = float(np.max(np.linalg.norm(spline.gradient(points), axis=1)))
    rounding = 4.0 * slope * float(np.spacing(np.max(np.abs(points))))
    assert np.max(np.abs(values - spline(points))) <= 1e-13 * size + rounding
    # Nodes are in the domain, its border included.
    at_nodes = spline(mesh.points, outside="nan")
    assert np.max(np.abs(at_nodes - mesh.values)) <= 1e-13 * size + rounding


@pytest.mark.parametrize("name", NAMES)
def test_the_function_is_the_spline(name: str) -> None:
    check_same_function(splines()[name], splines()[name].triangles(), 100_000)


@pytest.mark.parametrize("name", NAMES)
def test_the_mesh_conforms(name: str) -> None:
    spline = splines()[name]
    check_conforming(spline.triangles(), spline.domain)


@pytest.mark.parametrize("name", ["tensor", "unequal", "one cell", "deep"])
def test_as_many_triangles_as_needed(name: str) -> None:
    spline = splines()[name]
    mesh = spline.triangles()
    assert len(mesh.triangles) == naive_count(spline.mesh)
    if name == "deep":
        assert len(mesh.triangles) > 4.2 * spline.mesh.cell_count  # many vertices hang


def test_the_corners_of_a_cell_and_its_center() -> None:
    mesh = splines()["one cell"].triangles()
    assert mesh.points[:5].tolist() == [[0, 0], [0, 1], [1, 0], [1, 1], [0.5, 0.5]]
    assert mesh.triangles[:, :3].tolist() == [[0, 2, 4], [2, 3, 4], [3, 1, 4], [1, 0, 4]]
    middles = mesh.points[mesh.triangles[0, 3:]]
    assert middles.tolist() == [[0.5, 0.0], [0.75, 0.25], [0.25, 0.25]]


@given(
    seed=st.integers(0, 10**6),
    m=st.integers(1, 3),
    n=st.integers(1, 3),
    share=st.floats(0.1, 0.7),
    x=st.sampled_from([0.0, 0.1, -1e3, 1e7]),
    width=st.sampled_from([1e-3, 1 / 3, 7.0]),
)
@examples(20)
def test_any_tree(seed: int, m: int, n: int, share: float, x: float, width: float) -> None:
    tree = random_tree(seed, m, n, 4, share)
    domain = (x, -0.1, x + width, -0.1 + 3.0 * width)
    tree = Quadtree(domain, tree.shape, tree.level, tree.index, tree.child)
    spline = quasi_interpolate(wavy, tree, "P")
    mesh = spline.triangles()
    check_conforming(mesh, domain)
    check_same_function(spline, mesh, 500)
    assert len(mesh.triangles) == naive_count(tree)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("low", "high", "roots"), [(-3.0, 4.36, 3), (0.5, 7.91, 7)])
def test_nodes_on_the_border_are_on_it(low: float, high: float, roots: int, turned: bool) -> None:
    """Where the last cell's end is rounded to beyond the domain, and to before its end."""
    domain = (0.0, low, 1.0, high) if turned else (low, 0.0, high, 1.0)
    tree = Quadtree.uniform(domain, *((1, roots) if turned else (roots, 1)))
    assert tree.boxes[:, 2 + turned].max() != high
    spline = quasi_interpolate(wavy, tree, "P")
    mesh = spline.triangles()
    check_conforming(mesh, domain)
    assert np.isfinite(spline(mesh.points, outside="nan")).all()


def test_a_lattice_beyond_the_products_of_two_integers() -> None:
    """The finest cells would be 2 ** 38 columns and 2 ** 26 rows."""
    roots = 2**12
    split = np.zeros(roots + 26 * 4, dtype=bool)
    split[7] = True
    split[roots + 4 * np.arange(25)] = True
    tree = Quadtree.from_splits((0.0, 0.0, roots, 1.0), (roots, 1), split)
    spline = quasi_interpolate(lambda points: points[:, 0] - 2.0 * points[:, 1], tree, "P")
    mesh = spline.triangles()
    corners = mesh.points[: int(mesh.triangles[:, :3].max()) + 1]
    # Vertices of the roots, centers, and what each of 26 halvings adds.
    wanted = 2 * (roots + 1) + tree.cell_count + 5 * 26
    assert len(corners) == len(np.unique(corners, axis=0)) == wanted
    assert np.allclose(mesh.values, mesh.points @ [1.0, -2.0], rtol=0.0, atol=1e-10)


def test_no_line_is_run_for_each_cell() -> None:
    tree = full_tree(6)
    spline = ss.SplineSDF(tree, np.zeros((tree.cell_count, 8)))
    many = 10**9
    with before_line(many, lambda: None) as left:
        mesh = spline.triangles()
    assert len(mesh.triangles) == 4 * tree.cell_count
    assert 30 < many - left[0] < 1000


def test_a_constant_and_zero() -> None:
    for value in (0.0, 3.0):
        mesh = ss.SplineSDF(full_tree(1), np.full((16, 8), value)).triangles()
        assert np.array_equal(mesh.values, np.full(len(mesh.points), value))


@pytest.mark.parametrize("where", [(3, 0), (7, 5), (10, 7)])
@pytest.mark.parametrize("tree", [False, True])
def test_what_is_not_continuous_is_refused(where: tuple[int, int], tree: bool) -> None:
    mesh: Mesh = full_tree(1) if tree else Grid.uniform(UNIT, 4, 4)
    spline = quasi_interpolate(wavy, mesh, "W")
    ordinates = spline.ordinates.copy()
    ordinates[where] += 1e-6
    broken = dataclasses.replace(spline, ordinates=ordinates)
    with pytest.raises(ss.InputError, match="continuous spline"):
        broken.triangles()


def test_cells_that_differ_in_a_corner_only() -> None:
    """The middles of the sides are as they were: what V gains, E loses twice."""
    spline = quasi_interpolate(wavy, Grid.uniform(UNIT, 4, 4), "W")
    ordinates = spline.ordinates.copy()
    ordinates[5, [0, 4, 7]] += 1e-6 * np.array([1.0, -0.5, -0.5])
    with pytest.raises(ss.InputError, match="continuous spline"):
        dataclasses.replace(spline, ordinates=ordinates).triangles()


def test_what_has_no_such_mesh_is_refused() -> None:
    grid = Grid.uniform(UNIT, 2, 2)
    nan = np.zeros((4, 8))
    nan[1, 2] = np.nan
    for spline, message in (
        (ss.SplineSDF(grid, nan), "finite"),
        (ss.SplineSDF(grid, np.full((4, 8), 1e308)), r"up to 1e\+100"),
        (ss.SplineSDF(grid, np.zeros((3, 8))), "4 cells, got of 3"),
        (ss.SplineSDF("mesh", np.zeros((4, 8))), "Grid or a Quadtree"),  # type: ignore[arg-type]
    ):
        with pytest.raises(ss.InputError, match=message) as caught:
            spline.triangles()
        assert "\n" not in str(caught.value)
