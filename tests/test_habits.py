"""What notebooks ask of every object: a line about it, and pickles of its own numbers only."""

from __future__ import annotations

import copy
import inspect
import pickle
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.fits.fit import FitStep, fit_steps
from splinesdf.fits.request import request_of
from splinesdf.fits.target import ShapeTarget
from splinesdf.meshes import Grid, Quadtree
from splinesdf.splines.provenance import Provenance

CORNERS = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
MADE = Provenance(1e-3, 9.8e-4, 9.85e-4, (), "uniform", "W", "reached", 42)


def bar(name: str = "bar") -> ss.Shape:
    return ss.Shape.from_points(CORNERS, name=name)


def spline(made: Provenance | None = MADE) -> ss.SplineSDF:
    mesh = Grid.uniform((0.0, 0.0, 2.0, 1.0), 40, 30)
    return ss.SplineSDF(mesh, np.zeros((1200, 8)), shape=bar(), made=made)


def result(made: Provenance = MADE) -> ss.FitResult:
    fitted = spline(made)
    return ss.FitResult(fitted, (FitStep(fitted.mesh, 1200, 1e-3, 1e-4, 42),))


def contour(count: int = 3) -> ss.Contour:
    ends = np.column_stack([np.arange(count + 1.0), np.zeros(count + 1)])
    arcs = np.stack([ends[:-1], (ends[:-1] + ends[1:]) / 2, ends[1:]], axis=1)
    return ss.Contour(arcs, np.ones(count), closed=False, distance=-0.5)


def tree() -> Quadtree:
    return Quadtree.from_splits((0.0, 0.0, 1.0, 1.0), (3, 4), np.zeros(12, dtype=bool))


LINES = {
    "<Shape bar: 1 loop, 4 pieces, nonzero>": bar,
    "<SplineSDF bar: 1,200 cells, grid, error 9.80e-04 ≤ bound 9.85e-04>": spline,
    "<SplineSDF bar: 1,200 cells, grid>": lambda: spline(None),
    "<FitResult bar: 1,200 cells, error 9.80e-04 ≤ bound 9.85e-04>": result,
    "<FitResult bar: 1,200 cells, error 9.80e-04 not proved>": lambda: result(
        replace(MADE, bound=None)
    ),
    "<FitResult bar: 1,200 cells, error 4.00e-03 ≤ bound 9.85e-04>": lambda: result(
        replace(MADE, tolerance=None, error=4e-3, stopped="given")
    ),
    "<FitResult bar: 1,200 cells, error 5.00e-01 not proved > tolerance 1.00e-03>": lambda: result(
        replace(MADE, error=0.5, bound=None, stopped="max_cells")
    ),
    "<Contour: at -0.5, 3 arcs, open>": contour,
    "<Contour: at -0.5, 1 arc, open, in another>": lambda: replace(contour(1), parent=contour()),
    "<Grid: 40 x 30 cells>": lambda: spline().mesh,
    "<Quadtree: 12 cells, quadtree of 1 levels>": tree,
    "<Texture: 3 x 2 texels, range 0.5>": lambda: ss.Texture(
        np.zeros((2, 3)), (0.0, 0.0, 3.0, 2.0), 0.5
    ),
    "<Triangles: 1 triangle, 6 nodes>": lambda: ss.Triangles(
        np.zeros((6, 2)), np.zeros((1, 6), dtype=np.int64), np.zeros(6)
    ),
    "<DistanceGrid: 3 x 2 nodes>": lambda: ss.DistanceGrid(
        np.zeros(3), np.zeros(2), np.zeros((2, 3))
    ),
    "<Projection: 2 points>": lambda: ss.Projection(
        np.zeros(2), np.zeros((2, 2)), np.zeros(2, dtype=int), np.zeros(2), np.zeros(2)
    ),
}


@pytest.mark.parametrize("line", LINES)
def test_a_line_says_what_it_is(line: str) -> None:
    one = LINES[line]()  # type: ignore[operator]
    assert repr(one) == str(one) == line


def test_lists_of_them_stay_short() -> None:
    assert len(repr([contour(10_000)] * 100)) < 6_000


@pytest.mark.parametrize("name", ["a\nb", "\x1b[31mred", "x" * 500, "<b>", ""])
def test_names_neither_break_the_line_nor_fill_it(name: str) -> None:
    line = repr(bar(name))
    assert line.isprintable()
    assert len(line) < 100
    assert line.endswith(": 1 loop, 4 pieces, nonzero>")


@pytest.mark.parametrize("make", [bar, spline, tree, lambda: spline().mesh])
def test_pickles_and_copies_hold_the_fields_and_no_cache(make: object) -> None:
    one = make()  # type: ignore[operator]
    before = pickle.dumps(one)
    for name in ("box", "kinds", "boundary", "local_boxes", "boxes", "leaves", "_frames", "_table"):
        getattr(one, name, None)  # cached from now on
    own = {field.name for field in fields(one)}
    assert set(vars(one)) > own
    assert len(pickle.dumps(one)) <= len(before) + 8
    for other in (pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one)):
        assert set(vars(other)) == own
        assert repr(other) == repr(one)


def test_a_pickled_shape_answers_as_before() -> None:
    shape = bar()
    box = shape.box
    other = pickle.loads(pickle.dumps(shape))
    assert (other.box, other.name, other.fill) == (box, "bar", "nonzero")
    assert np.array_equal(other.control, shape.control)


@pytest.mark.parametrize(("name", "pieces"), [("part", 9), ("gamma1", 1), ("gamma3", 1)])
def test_examples_need_no_file(
    name: str, pieces: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shape = ss.example(name)
    assert (shape.name, shape.loop_count) == (name, pieces)


@pytest.mark.parametrize("name", ["gamma4", "", "part.svg", None, 3, ["part"]])
def test_an_unknown_example_is_told_which_there_are(name: object) -> None:
    with pytest.raises(ss.InputError, match="part, gamma1, gamma2, gamma3, got "):
        ss.example(name)  # type: ignore[arg-type]


def test_reading_the_name_of_an_example_says_how() -> None:
    with pytest.raises(ss.InputError, match=r"splinesdf\.example\('part'\)"):
        ss.read("part")


def test_a_fit_needs_no_tolerance_and_takes_it_second() -> None:
    assert request_of(ShapeTarget(bar()), None, {}).tolerance == pytest.approx(2e-3)  # of 2 by 1
    for function in (ss.fit, fit_steps):
        assert inspect.signature(function).bind(bar(), 0.1).arguments["tolerance"] == 0.1


@pytest.mark.parametrize("given", ["part.svg", CORNERS, None])
def test_a_fit_of_no_shape_says_what_makes_one(given: object) -> None:
    with pytest.raises(
        ss.InputError, match=r"expected a Shape, got \w+: read one by splinesdf.read"
    ):
        ss.fit(given, 0.1)  # type: ignore[arg-type]
