"""`interpolate`: the spline on a mesh that is given, its errors and its proved bound."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf import plot
from splinesdf.cli import report
from splinesdf.cli.console import Took
from splinesdf.fits.fit import require_reached
from splinesdf.meshes import Grid
from splinesdf.paper import tables as paper
from splinesdf.splines.quasi import quasi_interpolate
from tests.named_shapes import UNIT, gamma, paper_rows

SQUARE = ss.Shape.from_points([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
SHAPES = [gamma("gamma1"), gamma("gamma2"), gamma("gamma3"), SQUARE]


@pytest.fixture(scope="module")
def rows() -> list[paper.Row]:
    return list(paper_rows())


def test_every_row_of_the_paper_comes_out_by_the_front_door(rows: list[paper.Row]) -> None:
    grids = {
        (name, mesh, operator, k): step.grid
        for name, mesh, operator in {(r.curve, r.mesh, r.operator) for r in rows}
        for k, step in enumerate(paper.rounds(name, mesh, operator))
    }
    assert len(rows) == 42
    for row in rows:
        grid = grids[row.curve, row.mesh, row.operator, row.k]
        shape = paper.shape(row.curve)
        if row.mesh == "uniform":
            result = ss.interpolate(
                shape, (row.m, row.n), operator=row.operator, domain=paper.DOMAIN
            )
        else:
            result = ss.interpolate(shape, (grid.x, grid.y), operator=row.operator)
        assert result.spline.mesh.shape == (row.m, row.n)
        assert result.cells == row.m * row.n
        assert f"{result.centre_error:.6e}" == f"{row.error:.6e}"
        # Both are brackets of the same maximum, each half a percent wide.
        assert row.true_error / 1.0051 <= result.error <= result.bound <= 1.0051 * result.error
        assert result.error <= 1.0051 * row.true_error
        assert result.spline.made.space == row.mesh


def steps(least: int, most: int) -> st.SearchStrategy[list[float]]:
    """Widths of columns that differ by up to 20 times."""
    return st.lists(st.floats(0.05, 1.0), min_size=least, max_size=most)


@given(
    shape=st.sampled_from(SHAPES),
    operator=st.sampled_from("WVSP"),
    m=st.integers(1, 9),
    n=st.integers(1, 9),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=40)
def test_no_point_of_a_uniform_mesh_is_worse_than_the_bound(
    shape: ss.Shape, operator: str, m: int, n: int, seed: int
) -> None:
    check(shape, ss.interpolate(shape, (m, n), operator=operator), seed)


@given(
    shape=st.sampled_from(SHAPES),
    operator=st.sampled_from("WV"),
    columns=steps(1, 8),
    rows=steps(1, 8),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=40)
def test_no_point_of_a_tensor_mesh_is_worse_than_the_bound(
    shape: ss.Shape, operator: str, columns: list[float], rows: list[float], seed: int
) -> None:
    knots = [
        low + np.cumsum([0.0, *widths])
        for low, widths in zip(shape.box[:2], (columns, rows), strict=True)
    ]
    result = ss.interpolate(shape, knots, operator=operator)
    assert np.array_equal(result.spline.mesh.x, knots[0])
    assert np.array_equal(result.spline.mesh.y, knots[1])
    check(shape, result, seed)


def check(shape: ss.Shape, result: ss.FitResult, seed: int) -> None:
    """Random points, the centers, and every line of the mesh against error and bound."""
    xmin, ymin, xmax, ymax = result.spline.domain
    random = np.random.default_rng(seed).uniform((xmin, ymin), (xmax, ymax), (20_000, 2))
    boxes = result.spline.mesh.boxes
    middles = 0.5 * (boxes[:, :2] + boxes[:, 2:])
    points = np.concatenate([random, middles, boxes[:, :2], boxes[:, 2:]])
    error = np.abs(result.spline(points) - ss.signed_distance(shape, points))
    # Rounding of two distances of up to 10 and of their difference: 1e-14.
    rounding = 1e-14 * max(map(abs, (*result.spline.domain, *shape.box)))
    assert error.max() <= result.bound + rounding
    assert result.error <= result.bound <= 1.0051 * result.error + rounding
    # The bracket's lower end was seen at a point, and dense points come near it.
    assert error.max() >= 0.8 * result.error - rounding
    found = error[len(random) : len(random) + len(middles)].max()
    assert result.centre_error == pytest.approx(found, abs=rounding)
    assert result.centre_error <= result.error


@given(
    operator=st.sampled_from("WVSP"),
    m=st.integers(1, 6),
    n=st.integers(1, 6),
    low=st.tuples(st.floats(1.6, 1.8), st.floats(-4.0, 0.4)),
    size=st.tuples(st.floats(0.1, 0.3), st.floats(0.1, 0.3)),
)
@settings(max_examples=30)
def test_a_distance_that_is_linear_comes_back_exactly(
    operator: str, m: int, n: int, low: tuple[float, float], size: tuple[float, float]
) -> None:
    # Below y = 1.3, with a ring of one and a half cells of 0.3 more, only the lowest side of the
    # square is nearest, at u = -y.
    box = (*low, low[0] + size[0], low[1] + size[1])
    result = ss.interpolate(SQUARE, (m, n), operator=operator, domain=box)
    assert result.error < 1e-14
    assert result.bound < 1e-12  # the proof allows for 256 units in the last place of 8
    points = np.random.default_rng(m).uniform(box[:2], box[2:], (1000, 2))
    assert np.abs(result.spline(points) + points[:, 1]).max() < 1e-14


@pytest.mark.parametrize("operator", ["W", "V", "S", "P"])
def test_it_is_the_quasi_interpolant_of_the_exact_distance(operator: str) -> None:
    shape, asked = gamma("gamma2"), []

    def distance(points: np.ndarray) -> np.ndarray:
        asked.append(len(points))
        return ss.signed_distance(shape, points)

    expected = quasi_interpolate(distance, Grid.uniform(UNIT, 7, 9), operator)
    result = ss.interpolate(shape, (7, 9), operator=operator, domain=UNIT)
    assert np.array_equal(result.spline.ordinates, expected.ordinates)
    assert result.evaluations == sum(asked) + 7 * 9  # and the centers
    # One round of a fit is the same.
    first = ss.fit(shape, tolerance=1.0, space="uniform", operator=operator, domain=UNIT)
    again = ss.interpolate(shape, first.spline.mesh.shape, operator=operator, domain=UNIT)
    assert np.array_equal(first.spline.ordinates, again.spline.ordinates)


def test_the_error_of_w_falls_with_the_cube_of_the_side_where_the_distance_is_smooth() -> None:
    # A ring about the upper end of gamma1, without its medial axis.
    box = (0.3, 0.85, 0.7, 1.05)
    errors = [
        ss.interpolate(gamma("gamma1"), (2 * k, k), operator="W", domain=box).bound
        for k in (4, 8, 16)
    ]
    slopes = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(slopes > 2.7)


def test_equal_knots_take_every_operator_and_others_do_not() -> None:
    even = np.linspace(0.0, 1.0, 6)
    for operator in "WVSP":
        by_knots = ss.interpolate(gamma("gamma1"), (even, even), operator=operator)
        by_count = ss.interpolate(gamma("gamma1"), (5, 5), operator=operator, domain=UNIT)
        assert np.array_equal(by_knots.spline.ordinates, by_count.spline.ordinates)
    for operator in "SP":
        with pytest.raises(ss.InputError, match="use W or V on a tensor grid"):
            ss.interpolate(gamma("gamma1"), (even, even**2), operator=operator)


def test_w_and_the_domain_of_a_fit_are_the_defaults() -> None:
    shape = gamma("gamma2")
    result = ss.interpolate(shape, (4, 3))
    assert result.spline.domain == shape.default_domain(0.0)
    assert (result.spline.made.operator, result.spline.made.space) == ("W", "uniform")


def test_knots_are_copied() -> None:
    x = np.linspace(0.0, 1.0, 4)
    result = ss.interpolate(gamma("gamma1"), (x, x))
    x[:] = 7.0
    assert result.spline.domain == UNIT


def test_what_takes_a_fit_takes_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shape = gamma("gamma2")
    result = ss.interpolate(shape, (16, 16), domain=UNIT)
    assert require_reached(result) is result
    assert (result.tolerance, result.stopped, result.bands) == (None, "given", ())
    (step,) = result.history
    assert (step.cells, step.error, step.centre_error) == (256, result.error, result.centre_error)
    report.print_fit(result, shape, Took(1.0, 0.0))
    assert "none was asked for" in capsys.readouterr().out
    assert report.fit_figures(result, shape, Took(1.0, 0.0))["tolerance"] is None
    plot.save_figure(plot.overview(result, shape, result.spline.contours(0.0)), tmp_path / "a.png")
    result.spline.save(tmp_path / "a.npz")
    loaded = ss.load(tmp_path / "a.npz")
    assert loaded.made == result.spline.made
    assert loaded.made.tolerance is None
    assert report.provenance(loaded.made)["tolerance"] == "none was asked for"
    assert np.array_equal(loaded.ordinates, result.spline.ordinates)


LONG = np.linspace(0.0, 1.0, 2000)


@pytest.mark.parametrize(
    ("mesh", "options", "words"),
    [
        ((0, 4), {}, "1 to 1,000,000 cells, got 0 x 4"),
        ((-2, -2), {}, "got -2 x -2"),
        ((10**9, 10**9), {}, "1 to 1,000,000 cells"),
        ((4.5, 3), {}, r"whole numbers of cells each way, got \(4.5, 3\)"),
        (("4", "4"), {}, "whole numbers"),
        ("ab", {}, "whole numbers"),
        ((4,), {}, "a mesh"),
        (5, {}, "a mesh"),
        (None, {}, "a mesh"),
        ((4, LONG), {}, "a mesh"),
        (([[0.0, 1.0]], [[0.0, 1.0]]), {}, "a mesh"),
        (([[0.0, 1.0], [2.0]], [0.0, 1.0]), {}, "a mesh"),
        ((LONG, LONG), {}, "1 to 1,000,000 cells, got 1999 x 1999"),
        ((LONG, LONG[::-1]), {}, "grid lines in y that increase"),
        (([0.0, 0.5, 0.5, 1.0], [0.0, 1.0]), {}, "grid lines in x .* got 0.5 and then 0.5"),
        (([0.0, 1e-18, 1.0], [0.0, 1.0]), {}, "grid lines in x"),
        (([0.0, np.nan], [0.0, 1.0]), {}, "finite knots in x"),
        (([0.0, 1.0], [0.0, np.inf]), {}, "finite knots in y"),
        (([0.0], [0.0, 1.0]), {}, "two knots in x"),
        ((["a", "b"], [0.0, 1.0]), {}, "knots in x as numbers"),
        (([0.0, 1e200], [0.0, 1.0]), {}, "domain"),
        (([0.0, 1.0], [0.0, 1.0]), {"domain": UNIT}, "no domain beside knots"),
        ((3, 3), {"domain": (1.0, 0.0, 0.0, 1.0)}, "domain"),
        ((9, 9), {"domain": (1e16, 0.0, 1e16 + 4.0, 4.0)}, "grid lines in x"),
        ((3, 3), {"operator": "Q"}, "an operator of V, W, S, P"),
    ],
)
def test_bad_meshes_are_refused_in_one_line(
    mesh: object, options: dict[str, object], words: str
) -> None:
    with pytest.raises(ss.InputError, match=words) as caught:
        ss.interpolate(gamma("gamma2"), mesh, **options)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


def test_what_is_no_shape_is_refused() -> None:
    with pytest.raises(ss.InputError, match="expected a Shape, got str"):
        ss.interpolate("part.svg", (4, 4))
