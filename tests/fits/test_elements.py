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
def test_brackets_of_cubic_cells_hold(shape: ss.Shape, factor: float) -> None:
    mesh = Grid.uniform(shape.default_domain(), 7, 6)
    spline = quasi_interpolate(lambda p: ss.signed_distance(shape, p), mesh, "S", CUBIC)
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


def test_quadratic_pieces_miss_no_more_than_they_say() -> None:
    random = np.random.default_rng(0)
    numbers = random.normal(size=(6, CUBIC.numbers))
    mesh = Grid.uniform((0, 0, 3, 1), 3, 2)
    spline = ss.SplineSDF(mesh, numbers, element=CUBIC)
    for threshold in (1e3, 30.0, 1.0):  # one to four quarterings
        found = pieces(CUBIC, mesh.boxes, numbers, threshold)
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


@pytest.mark.parametrize("band", [None, (-0.1, 0.05)])
def test_a_cubic_fit_keeps_its_tolerance(band: tuple[float, float] | None, tmp_path: Path) -> None:
    tolerance = 0.04 if band is None else 1e-3
    result = ss.fit(CIRCLE, tolerance=tolerance, space="uniform", element="cubic", band=band)
    spline = result.spline
    assert spline.element.name == "cubic"
    assert result.stopped == "reached"
    assert result.bound is not None
    assert result.error <= result.bound <= tolerance
    low, high = np.array(spline.domain[:2]), np.array(spline.domain[2:])
    points = np.random.default_rng(1).random((100_000, 2)) * (high - low) + low
    exact, value = 1.0, spline(points)
    exact = np.hypot(*points.T) - 1.0
    counts = np.ones(len(points), dtype=bool)
    if band is not None:
        counts = (exact >= band[0]) & (exact <= band[1]) | (value >= band[0]) & (value <= band[1])
    assert 0.5 * result.error <= np.abs(value - exact)[counts].max() <= result.bound
    spline.save(tmp_path / "cubic.npz")
    again = ss.load(tmp_path / "cubic.npz")
    assert again.element is CUBIC
    assert np.array_equal(again(points), value)
    assert again.made == spline.made


def test_what_a_cubic_spline_does_not_answer_is_said() -> None:
    spline = ss.interpolate(CIRCLE, (8, 8), element="cubic").spline
    with pytest.raises(ss.InputError, match="level sets, got a cubic one"):
        spline.contours(0.0)
    with pytest.raises(ss.InputError, match='outside="nan" of it, got a cubic one'):
        spline([(9.0, 9.0)])
    assert np.isnan(spline([(9.0, 9.0)], outside="nan")).all()
    grid = spline.grid(5, 4)
    nodes = np.stack(np.meshgrid(grid.x, grid.y), axis=-1)
    assert np.array_equal(grid.distance, spline(nodes))
    with pytest.raises(ss.InputError, match="uniform for the cubic element"):
        ss.fit(CIRCLE, tolerance=0.1, element="cubic")
    with pytest.raises(ss.InputError, match="uniform for the cubic element, got 'tensor'"):
        ss.fit(CIRCLE, tolerance=0.1, element="cubic", space="tensor")
    with pytest.raises(ss.InputError, match="element of quadratic, cubic, quartic, got 'septic'"):
        ss.fit(CIRCLE, tolerance=0.1, element="septic")
    with pytest.raises(TypeError, match="unexpected keyword argument 'bands'"):
        ss.fit(CIRCLE, tolerance=0.1, bands=(0, 1))  # type: ignore[call-arg]
