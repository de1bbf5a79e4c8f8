"""A spline in scikit-fem: the same values, gradients and integrals."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import skfem
from skfem.helpers import dot

import splinesdf as ss
from splinesdf.meshes import Grid
from splinesdf.splines.quasi import quasi_interpolate
from tests.named_shapes import gamma


def wavy(points: np.ndarray) -> np.ndarray:
    x, y = points[:, 0], points[:, 1]
    return np.asarray(np.sin(3.0 * x) + np.cos(5.0 * y) * x + y)


@pytest.fixture(scope="module", params=["tree", "grid"])
def spline(request: pytest.FixtureRequest) -> ss.SplineSDF:
    if request.param == "tree":
        return ss.fit(gamma("gamma2"), tolerance=0.01).spline
    x, y = np.array([0.1, 0.2, 0.7, 0.8, 2.0]), np.array([-1.0, -0.9, 0.3, 0.301])
    return quasi_interpolate(wavy, Grid.from_lines(x, y), "W")


def by_cells(spline: ss.SplineSDF, power: int) -> tuple[float, float]:
    """The integrals of s^power and |grad s|² by Gauss points in the four triangles of each cell.

    On the square (u, v) -> (u, u v) is a triangle with its tip at the origin, and u the area's
    factor. Four points each way are exact up to degree 7 in u, which is 4 + 1 here.
    """
    nodes, weights = np.polynomial.legendre.leggauss(4)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    u, v = (axis.ravel() for axis in np.meshgrid(nodes, nodes))
    weight = np.outer(weights, weights).ravel() * u
    boxes = spline.mesh.boxes
    center, half = 0.5 * (boxes[:, :2] + boxes[:, 2:]), 0.5 * (boxes[:, 2:] - boxes[:, :2])
    total = np.zeros(2)
    for tip in (
        (u, u * (2 * v - 1)),
        (-u, u * (2 * v - 1)),
        (u * (2 * v - 1), u),
        (u * (2 * v - 1), -u),
    ):
        at = center[:, None] + half[:, None] * np.stack(tip, axis=-1)
        area = 2.0 * np.prod(half, axis=1)[:, None] * weight
        value, gradient = spline.value_and_gradient(at)
        total += (area * value**power).sum(), (area * (gradient**2).sum(axis=-1)).sum()
    return float(total[0]), float(total[1])


def test_the_interpolator_is_the_spline(spline: ss.SplineSDF) -> None:
    basis, vector = spline.to_skfem()
    low, high = np.reshape(spline.domain, (2, 2))
    points = np.random.default_rng(3).uniform(low, high, (500, 2))
    assert np.max(np.abs(basis.interpolator(vector)(points.T) - spline(points))) <= 1e-13
    # Every triangle is asked, at every point of its quadrature.
    inside = np.moveaxis(np.asarray(basis.global_coordinates()), 0, -1)
    field = basis.interpolate(vector)
    assert len(inside) == len(spline.triangles().triangles)
    assert np.max(np.abs(np.asarray(field) - spline(inside))) <= 1e-13
    gradient = np.moveaxis(np.asarray(field.grad), 0, -1)
    scale = np.max(np.abs(gradient))
    assert np.max(np.abs(gradient - spline.gradient(inside))) <= 1e-10 * scale


def test_all_coefficients_are_values_where_they_are(spline: ss.SplineSDF) -> None:
    basis, vector = spline.to_skfem()
    assert isinstance(basis.elem, skfem.ElementTriP2)
    assert len(vector) == basis.N == len(spline.triangles().points)
    assert np.max(np.abs(spline(basis.doflocs.T, outside="nan") - vector)) <= 1e-13


def test_integrals(spline: ss.SplineSDF) -> None:
    basis, vector = spline.to_skfem()
    field = basis.interpolate(vector)
    area = skfem.Functional(lambda w: 1.0 + 0.0 * w.x[0]).assemble(basis)
    whole = skfem.Functional(lambda w: w.s).assemble(basis, s=field)
    square = skfem.Functional(lambda w: w.s**2).assemble(basis, s=field)
    energy = skfem.Functional(lambda w: dot(w.s.grad, w.s.grad)).assemble(basis, s=field)
    xmin, ymin, xmax, ymax = spline.domain
    assert abs(area - (xmax - xmin) * (ymax - ymin)) <= 1e-13 * area
    wanted, slopes = by_cells(spline, 1)
    assert abs(whole - wanted) <= 1e-12 * abs(wanted)
    assert abs(energy - slopes) <= 1e-11 * slopes
    wanted, _ = by_cells(spline, 2)
    assert abs(square - wanted) <= 1e-12 * wanted


def test_without_scikit_fem(spline: ss.SplineSDF, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "skfem", None)
    with pytest.raises(ss.MissingExtraError, match=r'pip install "splinesdf\[fem\]"'):
        spline.to_skfem()
