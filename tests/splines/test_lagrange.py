"""Cubic and quartic splines as Lagrange triangles: VTK's order, one node a place, the function."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid, Quadtree
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.splines.quasi import quasi_interpolate
from splinesdf.splines.triangles import Triangles
from tests import naive_tree
from tests.triangle_meshes import signed_areas

# Barycentric coordinates of nodes, in VTK's order, times the degree.
ORDER = {
    3: ["300", "030", "003", "210", "120", "021", "012", "102", "201", "111"],
    4: [
        *("400", "040", "004", "310", "220", "130", "031", "022", "013", "103", "202", "301"),
        *("211", "121", "112"),
    ],
}


def waves(points: np.ndarray) -> np.ndarray:
    x, y = points.T
    return np.asarray(np.sin(5 * x + 1) * np.cos(3 * y) + 0.2 * x)


def tree(corner: float) -> ss.SplineSDF:
    mesh = Quadtree.uniform((corner, 0.0, corner + 3.0, 2.0), 3, 2)
    for seed in range(3):
        marked = np.random.default_rng(seed).random(len(mesh.leaves)) < 0.3
        mesh = naive_tree.refine(mesh, marked)
    return quasi_interpolate(lambda p: waves(p - [corner, 0.0]), mesh, "O", ELEMENTS["quartic"])


def spline(name: str) -> ss.SplineSDF:
    if name == "tree":
        return tree(0.0)
    if name == "far":
        return tree(1e6)
    if name == "far grid":
        mesh = Grid.uniform((1e6 - 1.5, 1e6 - 0.3, 1e6 + 5.4, 1e6 + 3.1), 6, 5)
        return quasi_interpolate(lambda p: waves(p - 1e6), mesh, None, ELEMENTS["cubic"])
    return quasi_interpolate(waves, Grid.uniform((0.0, -1.0, 1.0, 1.0), 5, 4), None, ELEMENTS[name])


@pytest.mark.parametrize("name", ["tree", "far", "far grid", "cubic", "S31", "M222", "M1122"])
def test_nodes_are_in_order_once_each_and_make_the_function(name: str) -> None:
    own = spline(name)
    mesh, degree = own.triangles(), own.element.degree
    assert mesh.degree == degree
    share = np.array([[int(digit) for digit in text] for text in ORDER[degree]]) / degree
    assert mesh.triangles.shape[1] == len(share)
    corners = mesh.points[mesh.triangles[:, :3]]
    rounding = 8.0 * float(np.spacing(np.abs(mesh.points).max()))
    there = np.einsum("nk,mkx->mnx", share, corners)
    assert np.abs(mesh.points[mesh.triangles] - there).max() <= rounding
    assert len(np.unique(mesh.points, axis=0)) == len(mesh.points)
    assert np.array_equal(np.unique(mesh.triangles), np.arange(len(mesh.points)))
    check_tiling(mesh, own)
    # None is beyond the border.
    assert np.abs(own(mesh.points, outside="nan") - mesh.values).max() <= 1e-12 + 10.0 * rounding
    # By solving for the polynomial that has the values at the nodes.
    powers = [(a, b) for a in range(degree + 1) for b in range(degree + 1 - a)]
    terms = np.stack([share[:, 0] ** a * share[:, 1] ** b for a, b in powers], axis=1)
    coefficients = np.linalg.solve(terms, mesh.values[mesh.triangles].T)
    for place in np.random.default_rng(1).dirichlet((1.0, 1.0, 1.0), 40):
        value = np.array([place[0] ** a * place[1] ** b for a, b in powers]) @ coefficients
        at = np.einsum("k,mkx->mx", place, corners)
        assert np.abs(value - own(at)).max() <= 1e-12 + 10.0 * rounding


def check_tiling(mesh: Triangles, own: ss.SplineSDF) -> None:
    """Each edge with all its nodes belongs to two triangles, or to one at the border."""
    degree = own.element.degree
    used: Counter[tuple[int, ...]] = Counter()
    for row in mesh.triangles.tolist():
        for k in range(3):
            inner = row[3 + k * (degree - 1) : 3 + (k + 1) * (degree - 1)]
            nodes = (row[k], *inner, row[(k + 1) % 3])
            used[min(nodes, nodes[::-1])] += 1
    assert set(used.values()) <= {1, 2}
    areas = signed_areas(mesh)
    xmin, ymin, xmax, ymax = own.domain
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx((xmax - xmin) * (ymax - ymin), rel=1e-8)
    border = sum(
        float(np.hypot(*(mesh.points[nodes[0]] - mesh.points[nodes[-1]])))
        for nodes, times in used.items()
        if times == 1
    )
    assert border == pytest.approx(2.0 * (xmax - xmin + ymax - ymin), rel=1e-8)


def test_cells_that_do_not_fit_together_are_refused() -> None:
    own = spline("cubic")
    numbers = own.ordinates.copy()
    numbers[7] += 1e-3
    with pytest.raises(ss.InputError, match="expected a continuous spline"):
        replace(own, ordinates=numbers).triangles()
    numbers[7] = np.nan
    with pytest.raises(ss.InputError, match="expected finite ordinates"):
        replace(own, ordinates=numbers).triangles()
