"""Calls that newcomers try first: answered, or refused in one line that says what to do."""

from __future__ import annotations

import copy
import html
import pickle
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.ground import card

CORNERS = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]

SVG = '<svg xmlns="http://www.w3.org/2000/svg"><rect width="3" height="2"/></svg>'


@cache
def shape() -> ss.Shape:
    return ss.Shape.from_points(CORNERS, name="bar")


@cache
def result() -> ss.FitResult:
    return ss.fit(shape(), 0.1)


REFUSED: dict[str, tuple[Callable[[], Any], type[Exception], str]] = {
    "fit of a name": (lambda: ss.fit("part.svg"), ss.InputError, "Shape, got str: read one by"),
    "offset of points": (lambda: ss.offset(CORNERS, 2), ss.InputError, "Shape, got list"),
    "distance to points": (
        lambda: ss.signed_distance(CORNERS, CORNERS),
        ss.InputError,
        "Shape, got list",
    ),
    "grid of a spline": (
        lambda: ss.signed_distance_grid(result().spline, 8),
        ss.InputError,
        "Shape, got SplineSDF",
    ),
    "closest point": (lambda: ss.closest_point(None, CORNERS), ss.InputError, "got NoneType"),
    "mesh of a name": (lambda: ss.interpolate("part", (4, 4)), ss.InputError, "Shape, got str"),
    "arcs of a list": (lambda: ss.as_arcs([], tolerance=1.0), ss.InputError, "Contour, got list"),
    "fit's gradient": (lambda: result().gradient, AttributeError, "result.spline.gradient"),
    "fit's typing slip": (lambda: result().gradeint, AttributeError, "no 'gradeint'$"),
    "three counts": (lambda: shape_grid((8, 8, 8)), ss.InputError, "pair of node counts"),
    "two pairs": (lambda: shape_grid((8, 8), 8), ss.InputError, "pair of node counts"),
    "progress": (lambda: ss.fit(shape(), 0.1, progress=3), ss.InputError, "function for progress"),
    "x and y": (
        lambda: ss.signed_distance(shape(), [1.0, 2.0], [1.0, 2.0, 3.0]),
        ss.InputError,
        "x and y of shapes that broadcast, got \\(2,\\) and \\(3,\\)$",
    ),
    "x and no y": (lambda: result()(1.0, "b"), ss.InputError, "expected y as numbers, got 'b'$"),
}


def shape_grid(*counts: Any) -> ss.DistanceGrid:
    return ss.signed_distance_grid(shape(), *counts)


@pytest.mark.parametrize("name", REFUSED)
def test_one_line_says_what_to_do(name: str) -> None:
    call, kind, message = REFUSED[name]
    with pytest.raises(kind, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("counts", [(5, 4), ((5, 4),), ([5, 4],)])
def test_grids_take_two_numbers_or_a_pair(counts: Any) -> None:
    for grid in (shape_grid(*counts), result().spline.grid(*counts)):
        assert (len(grid.x), len(grid.y), grid.distance.shape) == (5, 4, (4, 5))


def test_grids_take_one_number_for_both_sides() -> None:
    for grid in (shape_grid(5), result().spline.grid(5)):
        assert grid.distance.shape == (5, 5)


def test_methods_are_the_functions() -> None:
    points = np.random.default_rng(1).uniform(-1, 3, (50, 2))
    assert np.array_equal(shape().signed_distance(points), ss.signed_distance(shape(), points))
    near = shape().signed_distance(points, max_distance=0.1)
    assert np.array_equal(near, ss.signed_distance(shape(), points, max_distance=0.1))
    assert shape().offset(0.1, tolerance=1e-3) == ss.offset(shape(), 0.1, tolerance=1e-3)
    assert shape().fit(0.1).spline == result().spline
    assert np.array_equal(result()(points), result().spline(points))


def test_defaults_are_those_of_the_command_line() -> None:
    assert result().spline.contours() == result().spline.contours(0.0)
    assert ss.fit(shape()).tolerance == pytest.approx(2e-3)
    assert ss.offset(shape(), 0.5)[0].tolerance == pytest.approx(2e-3)
    circle = ss.Shape.circle((5.0, 5.0), 2.0).offset(0.0)[0]
    off = np.abs(np.hypot(*(circle.points() - 5.0).T) - 2.0).max()
    chords = circle.points()
    middles = 0.5 * (chords[1:] + chords[:-1])
    assert off < 1e-12  # the corners lie on it
    assert 1e-4 < np.abs(np.hypot(*(middles - 5.0).T) - 2.0).max() <= 4e-3


def test_progress_is_told_round_by_round_and_may_stop_the_work() -> None:
    told: list[ss.Progress] = []
    fitted = ss.fit(shape(), 0.05, progress=told.append)
    assert [one.done for one in told] == list(range(1, len(fitted.history) + 1))
    assert str(told[-1]) == f"{len(told)}: {fitted.cells:,} cells, error {fitted.error:.2e}"
    told.clear()
    ss.offset(shape(), [-0.1, 0.2], progress=told.append)
    assert list(map(str, told)) == [
        "1 of 2: offset by -0.1, 1 contour",
        "2 of 2: offset by 0.2, 1 contour",
    ]
    told.clear()
    ss.offset(shape(), step=-0.2, progress=told.append)
    assert [(one.done, one.total) for one in told] == [(1, None), (2, None)]

    def stop(_: ss.Progress) -> None:
        raise KeyboardInterrupt

    for work in (
        lambda: ss.fit(shape(), 0.1, progress=stop),
        lambda: ss.offset(shape(), 1, progress=stop),
    ):
        with pytest.raises(KeyboardInterrupt):
            work()


def test_equal_values_are_equal_and_hash_alike(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg"><rect width="3" height="2"/></svg>'
    )
    assert ss.read(tmp_path / "a.svg") == ss.read(tmp_path / "a.svg")
    for one in (shape(), result().spline, result().spline.mesh, shape().offset(-0.1)[0]):
        for other in (copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
            assert other is not one
            assert other == one
            assert hash(other) == hash(one)
            assert len({one, other}) == 1
        assert one != "bar"
    assert shape() != replace(shape(), name="other")
    assert shape() != shape().translate(1e-15, 0.0).translate(1.0, 0.0)
    assert result().spline != replace(result().spline, ordinates=result().spline.ordinates + 1e-16)
    assert hash(shape().scale((-1, 1))) == hash(shape().scale((-1, 1)).translate(0.0, -0.0))


def test_a_shape_is_written_as_its_boundary(tmp_path: Path) -> None:
    part = ss.example("part")
    for name in ("a.svg", "a.dxf", "a.geojson"):
        ss.write(tmp_path / name, part)
        again = ss.read(tmp_path / name)
        assert len(again) == len(part)
        assert again.area == pytest.approx(part.area, abs=1e-6 * part.size * part.length)
    one = part.offset(-1.0)[0]
    ss.write(tmp_path / "b.svg", one)
    ss.write(tmp_path / "c.svg", [one])
    assert (tmp_path / "b.svg").read_text() == (tmp_path / "c.svg").read_text()


def test_path_data_is_the_contour() -> None:
    contour = ss.Shape.circle((1.0, 2.0), 0.5).offset(0.25)[0]
    again = ss.Shape.from_svg_path(contour.svg_path())
    assert again.area == pytest.approx(np.pi * 0.75**2, rel=1e-12)
    assert again.box == pytest.approx((0.25, 1.25, 1.75, 2.75), abs=1e-12)
    assert contour.bounds == pytest.approx(again.box, abs=1e-12)


@pytest.mark.parametrize("name", ["bar", "<b>&amp;</b>", "x" * 300])
def test_cards_are_markup_that_shows_names_as_text(name: str) -> None:
    named = replace(shape(), name=name)
    spline = replace(result().spline, shape=named, name=name)
    for one in (named, spline, ss.FitResult(spline, result().history)):
        text = one._repr_html_()
        tree = ElementTree.fromstring(text)
        assert name in "".join(tree.itertext())
        assert html.escape(name) in text
        assert len(text) < 3000
        (path,) = tree.iter("path")
        assert path.get("d", "").count("M") == 1
    assert "0.1" in ElementTree.fromstring(shape().offset(0.1)[0]._repr_html_()).find(
        "div/table"
    ).findtext("tr/td[2]")


@pytest.mark.parametrize("point", [False, True])
def test_a_card_of_what_cannot_be_drawn_has_its_figures(
    point: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A contour that is a point, and one of more points than a page takes."""
    if point:
        contour = ss.Contour(np.full((2, 3, 2), 5.0), np.ones(2))
    else:
        (contour,) = shape().offset(0.1)
        assert "<svg" in contour._repr_html_()
        monkeypatch.setattr(card, "_MOST_POINTS", 7)
    tree = ElementTree.fromstring(contour._repr_html_())
    assert tree.find("svg") is None
    assert tree.findtext("div/table/tr[2]/td[2]") == f"{len(contour.arcs)} (closed)"


def test_a_card_shows_the_shape_upright_and_whole() -> None:
    """The picture's path, read as a shape, is the shape with y down, in eighths of a dot."""
    for y_down in (False, True):
        part = replace(ss.example("part"), y_down=y_down)
        (path,) = ElementTree.fromstring(part._repr_html_()).iter("path")
        drawn = ss.Shape.from_svg_path(path.get("d", ""), fill="evenodd", close=True)
        steps = 120 * 8 / part.size
        assert drawn.area == pytest.approx(part.area * steps**2, rel=0.01)
        left, top = np.array(part.box[:2]), part.box[3]
        middle_of_slot = np.array([90.0, 40.0])
        for point in (
            *np.random.default_rng(3).uniform(part.box[:2], part.box[2:], (200, 2)),
            middle_of_slot,
        ):
            across = (point - left) * steps
            across[1] = across[1] if y_down else (top - point[1]) * steps
            if abs(part.signed_distance(point)) > 0.5:
                assert (across in drawn) == (point in part)


def test_x_and_y_apart_are_points() -> None:
    x, y = np.linspace(-1.0, 3.0, 5), np.linspace(-1.0, 2.0, 4)[:, None]
    points = [[(a, b) for a in x] for b in y[:, 0]]
    spline = result().spline
    for answer in (
        lambda *at: ss.signed_distance(shape(), *at),
        lambda *at: shape().signed_distance(*at, max_distance=0.5),
        lambda *at: spline(*at, outside="nan"),
        lambda *at: result()(*at),
    ):
        apart = answer(x, y)
        assert apart.shape == (4, 5)
        assert np.array_equal(apart, answer(points), equal_nan=True)
    assert ss.signed_distance(shape(), 1.0, 0.5) == -0.5


def test_a_contour_is_its_arcs() -> None:
    (contour,) = ss.offset(shape(), 0.5)
    arcs = list(contour)
    assert len(contour) == len(arcs) == 8
    for (points, weight), control, middle in zip(arcs, contour.arcs, contour.weights, strict=True):
        assert np.array_equal(points, control)
        assert weight == middle
