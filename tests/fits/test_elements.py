"""Fits with another element than the quadratic one: proved, kept in files, refused in words."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.fits.certificate import Wanted, cell_errors
from splinesdf.fits.pieces import pieces
from splinesdf.fits.target import ShapeTarget
from splinesdf.meshes import Grid
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.splines.quasi import quasi_interpolate
from tests.named_shapes import gamma

CUBIC = ELEMENTS["cubic"]
CIRCLE = ss.Shape.from_svg_path("M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0z")
CORNER = ss.Shape.from_points([(0, 0), (4, 1), (1, 3)])


def sampled(shape: ss.Shape, spline: ss.SplineSDF, side: int) -> np.ndarray:
    """The largest error at side x side points of each cell."""
    boxes = spline.mesh.boxes
    share = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, side)] * 2), axis=-1).reshape(-1, 2)
    points = boxes[:, None, :2] + share * (boxes[:, 2:] - boxes[:, :2])[:, None]
    points = np.clip(points, spline.domain[:2], spline.domain[2:]).reshape(-1, 2)
    error = np.abs(spline(points) - ss.signed_distance(shape, points))
    return error.reshape(len(boxes), -1).max(axis=1)


@pytest.mark.parametrize("shape", [CIRCLE, CORNER, gamma("gamma3")], ids=["circle", "corner", "Γ3"])
@pytest.mark.parametrize("factor", [-0.3, 1.0, 3.0])
@pytest.mark.parametrize("element", ["cubic", "quartic"])
def test_brackets_of_cells_hold(shape: ss.Shape, factor: float, element: str) -> None:
    mesh, kind = Grid.uniform(shape.default_domain(), 7, 6), ELEMENTS[element]
    spline = quasi_interpolate(lambda p: ss.signed_distance(shape, p), mesh, None, kind)
    spline = replace(spline, ordinates=factor * spline.ordinates)
    centers = 0.5 * (mesh.boxes[:, :2] + mesh.boxes[:, 2:])
    known = cell_errors(
        ShapeTarget(shape), spline, np.arange(42), ss.signed_distance(shape, centers),
        np.empty((0, 2)), Wanted(1e-3 * shape.size),
    )  # fmt: skip
    side = 41
    found = sampled(shape, spline, side)
    assert (found <= known.high + 1e-13).all()
    boxes = mesh.boxes
    reach = np.hypot(*(boxes[0, 2:] - boxes[0, :2])) / 2 / (side - 1)
    slope = 1.0 + 2.0 * np.hypot(*np.moveaxis(spline.gradient(boxes[:, :2]), -1, 0)).max() + 2.0
    assert (known.low <= found + slope * reach).all()


@pytest.mark.parametrize("element", ["cubic", "quartic", "S31", "M222", "M1122"])
def test_quadratic_pieces_miss_no_more_than_they_say(element: str) -> None:
    random, kind = np.random.default_rng(0), ELEMENTS[element]
    numbers = random.normal(size=(6, kind.numbers))
    mesh = Grid.uniform((0, 0, 3, 1), 3, 2)
    spline = ss.SplineSDF(mesh, numbers, element=kind)
    for threshold in (1e3, 30.0, 1.0):  # one to four quarterings
        found = pieces(kind, mesh.boxes, numbers, np.full(6, 2e-3 * threshold))
        corners = found.triangles[:, :6].reshape(-1, 3, 2)
        aa, bb, cc, ab, bc, ca = found.triangles[:, 6:].T
        worst = np.zeros(6)
        for _ in range(20):
            a, b, c = random.dirichlet((1, 1, 1))
            points = np.einsum("k,nkx->nx", (a, b, c), corners)
            squares = aa * a * a + bb * b * b + cc * c * c
            values = squares + 2 * (ab * a * b + bc * b * c + ca * c * a)
            error = np.abs(values - spline(points))
            np.maximum.at(worst, found.halves[:, 0] // 8, error)
        assert (worst <= found.missed + 1e-14).all()
        assert (worst >= 0.02 * found.missed).all()
        # Each eighth has its triangles, and together they are the cell.
        assert (np.bincount(found.halves.ravel(), minlength=48) > 0).all()
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = 0.5 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        cell = np.bincount(found.halves[:, 0] // 8, weights=area)
        assert cell == pytest.approx(np.full(6, 0.5), rel=1e-12)


def test_pieces_in_bands_leave_out_what_does_not_count() -> None:
    kind = ELEMENTS["quartic"]
    numbers = np.random.default_rng(1).normal(size=(6, kind.numbers))
    mesh = Grid.uniform((0, 0, 3, 1), 3, 2)
    asked = []

    def counts(
        cell: np.ndarray, corners: np.ndarray, low: np.ndarray, high: np.ndarray
    ) -> np.ndarray:
        asked.append((cell, corners, low, high))
        return (low <= 0.1) & (high >= 0.1)

    spline = ss.SplineSDF(mesh, numbers, element=kind)
    found = pieces(kind, mesh.boxes, numbers, np.full(6, 2e-3), counts)
    for cell, corners, low, high in asked:
        for share in np.random.default_rng(2).dirichlet((1, 1, 1), 10):
            at = np.einsum("c,ncx->nx", share, corners.reshape(-1, 3, 2))
            value = spline(at)
            assert ((low - 1e-12 <= value) & (value <= high + 1e-12)).all()
            assert np.all((mesh.boxes[cell, :2] <= at) & (at <= mesh.boxes[cell, 2:]))
    # Every point at the level is in a triangle.
    points = np.random.default_rng(3).random((40_000, 2)) * [3.0, 1.0]
    points = points[np.abs(spline(points) - 0.1) < 1e-3]
    a, b, c = np.moveaxis(found.triangles[:, :6].reshape(-1, 3, 2), 1, 0)

    def left(p: np.ndarray, q: np.ndarray) -> np.ndarray:
        u, v = q - p, points[:, None] - p
        return np.asarray(u[:, 0] * v[..., 1] - u[:, 1] * v[..., 0] >= -1e-9)

    turned = np.sign((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert (turned > 0).all()
    near = left(a, b) & left(b, c) & left(c, a)
    assert len(points) > 50
    assert near.any(axis=1).all()


CASES = [
    ("cubic", "uniform", None, 0.04),
    ("cubic", "uniform", (-0.1, 0.05), 1e-3),
    ("S31", "uniform", (-0.01, 0.01), 1e-4),
    ("M1122", "uniform", (0.01, 0.02), 1e-4),
    ("quartic", "uniform", (0.01, 0.02), 1e-4),
    ("quartic", "hierarchical", None, 0.04),
    ("quartic", "hierarchical", (-0.01, -0.01), 1e-6),
]


@pytest.mark.parametrize(("element", "space", "band", "tolerance"), CASES)
def test_a_fit_keeps_its_tolerance(
    element: str,
    space: str,
    band: tuple[float, float] | None,
    tolerance: float,
    tmp_path: Path,
) -> None:
    result = ss.fit(CIRCLE, tolerance=tolerance, space=space, element=element, band=band)
    spline = result.spline
    assert spline.element.name == element
    assert result.stopped == "reached"
    assert result.bound is not None
    assert result.error <= result.bound <= tolerance
    low, high = np.array(spline.domain[:2]), np.array(spline.domain[2:])
    points = np.random.default_rng(1).random((100_000, 2)) * (high - low) + low
    if band is not None:  # as many in it
        angle, along = 2.0 * np.pi * points[:, 0], np.random.default_rng(2).random(100_000)
        radius = 1.0 + band[0] + (band[1] - band[0]) * along
        beside = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
        points = np.concatenate([points, beside])
    value, exact = spline(points), np.hypot(*points.T) - 1.0
    counts = np.ones(len(points), dtype=bool)
    if band is not None:
        counts = (exact >= band[0] - 1e-15) & (exact <= band[1] + 1e-15) | (value >= band[0]) & (
            value <= band[1]
        )
    assert 0.5 * result.error <= np.abs(value - exact)[counts].max() <= result.bound
    for name in ("fit.npz", "fit.json"):
        spline.save(tmp_path / name)
        again = ss.load(tmp_path / name)
        assert again.element is ELEMENTS[element]
        assert np.array_equal(again(points[:1000]), value[:1000])
        assert again.made == spline.made


@pytest.mark.parametrize("element", ["cubic", "quartic"])
def test_what_such_a_spline_does_not_answer_is_said(element: str) -> None:
    from splinesdf.web.page import write_page

    spline = ss.interpolate(CIRCLE, (8, 8), element=element).spline
    with pytest.raises(ss.InputError, match="expected a quadratic spline for scikit-fem"):
        spline.to_skfem()
    with pytest.raises(ss.InputError, match="expected a quadratic spline, got"):
        spline.to_arrays()
    with pytest.raises(ss.InputError, match="expected a quadratic spline for the page"):
        write_page("never.html", spline)
    assert np.isnan(spline([(9.0, 9.0)], outside="nan")).all()
    grid = spline.grid(5, 4)
    nodes = np.stack(np.meshgrid(grid.x, grid.y), axis=-1)
    assert np.array_equal(grid.distance, spline(nodes))
    with pytest.raises(ss.InputError, match="uniform for the cubic element"):
        ss.fit(CIRCLE, tolerance=0.1, element="cubic")
    with pytest.raises(ss.InputError, match="uniform for the cubic element, got 'tensor'"):
        ss.fit(CIRCLE, tolerance=0.1, element="cubic", space="tensor")
    with pytest.raises(
        ss.InputError, match="element of quadratic, cubic, quartic, S31, M222, M1122, got 'septic'"
    ):
        ss.fit(CIRCLE, tolerance=0.1, element="septic")
    with pytest.raises(TypeError, match="unexpected keyword argument 'bands'"):
        ss.fit(CIRCLE, tolerance=0.1, bands=(0, 1))  # type: ignore[call-arg]
