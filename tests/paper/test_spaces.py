"""The table and the figures of the spaces that the paper's Section 8 names."""

from __future__ import annotations

import json
import math
import re
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import LineCollection

import splinesdf as ss
from splinesdf.meshes import Grid
from splinesdf.paper import space_figures, spaces
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.splines.quasi import quasi_interpolate
from tests.cli.test_cli import Command, run
from tests.named_shapes import UNIT, curve, gamma, paper_rows

__all__ = ["run"]

DATA = json.loads((Path(__file__).parents[1] / "data" / "box_splines.json").read_text())
OPERATORS = {"S21": "VWSP", "S31": "VS", "S42": "VCDO"}
ELEMENT = {"S21": "quadratic", "S31": "S31", "S42": "quartic"}


@pytest.fixture(scope="module")
def rows() -> list[spaces.SpaceRow]:
    return list(spaces.space_rows(("gamma1", "gamma3"), (8, 16)))


def test_there_is_a_row_for_each_curve_operator_and_mesh(rows: list[spaces.SpaceRow]) -> None:
    expected = [
        (name, space, operator, n)
        for name, (space, operators) in product(("gamma1", "gamma3"), OPERATORS.items())
        for operator, n in product(operators, (8, 16))
    ]
    assert [(row.curve, row.space, row.operator, row.n) for row in rows] == expected
    assert spaces.COUNTS == (4, 8, 16, 32, 64, 128)


def test_quadratic_rows_are_those_of_the_paper_s_tables(rows: list[spaces.SpaceRow]) -> None:
    known = {(row.curve, row.operator, row.n): row for row in paper_rows() if row.mesh == "uniform"}
    seen = [row for row in rows if (row.curve, row.operator, row.n) in known and row.space == "S21"]
    assert len(seen) == 4
    for row in seen:
        other = known[row.curve, row.operator, row.n]
        assert row.error == pytest.approx(other.error, rel=1e-12)
        assert row.true_error == pytest.approx(other.true_error, rel=5e-3)


def test_errors_are_those_of_points_of_their_own(rows: list[spaces.SpaceRow]) -> None:
    points = np.random.default_rng(5).random((20_000, 2))
    t = np.linspace(0.0, 2.0 * np.pi, 4000)
    for name in ("gamma1", "gamma3"):
        shape = gamma(name)
        exact = ss.signed_distance(shape, points)
        # Near the curve by the distances to points of it.
        beside = curve(name, t)[::8] + np.random.default_rng(6).uniform(-0.014, 0.014, (500, 2))
        if name == "gamma3":
            beside = beside[np.hypot(*(beside - 0.45).T) > 0.15]
        beside = beside[np.all((beside > 0.0) & (beside < 1.0), axis=1)]
        near = ss.signed_distance(shape, beside)
        for row in (row for row in rows if row.curve == name):
            mesh = Grid.uniform(UNIT, row.n, row.n)

            def distance(p: np.ndarray, shape: ss.Shape = shape) -> np.ndarray:
                return ss.signed_distance(shape, p)

            spline = quasi_interpolate(distance, mesh, row.operator, ELEMENTS[ELEMENT[row.space]])
            middle = 0.5 * (mesh.boxes[:, :2] + mesh.boxes[:, 2:])
            assert row.error == pytest.approx(np.abs(spline(middle) - distance(middle)).max())
            assert 0.9 * row.true_error <= np.abs(spline(points) - exact).max() + 1e-3
            assert np.abs(spline(points) - exact).max() <= 1.005 * row.true_error
            off = float(np.abs(spline(beside) - near).max())
            assert 0.6 * row.near_error <= off <= 1.03 * row.near_error


def test_orders_are_of_the_row_before(rows: list[spaces.SpaceRow]) -> None:
    for first, second in zip(rows[::2], rows[1::2], strict=True):
        assert first.order is first.near_order is None
        assert second.order == pytest.approx(math.log2(first.true_error / second.true_error))
        assert second.near_order == pytest.approx(math.log2(first.near_error / second.near_error))


@pytest.mark.parametrize("options", [("--spaces",), ("--spaces", "--tables")])
def test_the_command_prints_the_rows(
    options: tuple[str, ...],
    rows: list[spaces.SpaceRow],
    run: Command,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(spaces, "space_rows", lambda: iter(rows))
    monkeypatch.setattr("splinesdf.paper.tables.tables", lambda: iter(paper_rows()))
    out = run("paper", *options).out
    shown = [line.split() for line in out.splitlines() if re.match(r" gamma\d +S\d\d ", line)]
    assert len(shown) == len(rows)
    assert shown[1][:3] == ["gamma1", "S21", "V"]
    assert shown[1][6] == f"{rows[1].error:.3e}"
    assert shown[1][-1] == f"{rows[1].near_order:.2f}"
    found = json.loads(run("paper", *options, "--json").out)
    listed = found["spaces"] if "--tables" in options else found
    assert listed[1]["true_error"] == rows[1].true_error
    assert len(listed) == len(rows)
    assert ("Tables 1-7" in out) == ("--tables" in options)
    if "--tables" in options:
        assert len(found["tables"]) == 42


def test_figures_show_b_splines_with_their_supports() -> None:
    made = space_figures.space_figure("bsplines")
    titles = [ax.get_title(loc="left") for ax in made.axes]
    names = ("M_1111", "M_2210", "M_2211", "M_2120", "M_2220", "M_1122")
    counts = [DATA["bsplines"][name]["support_triangles"] for name in names]
    assert [int(re.findall(r"(\d+) triangles", text)[0]) for text in titles if "tri" in text] == (
        counts
    )
    assert len(titles) == 9
    flat = [ax for ax in made.axes if "triangles" in ax.get_title(loc="left")]
    for ax, name in zip(flat, names, strict=True):
        border = ax.collections[-1].get_paths()[0].vertices
        low, high = support(DATA["bsplines"][name])
        assert border.min(axis=0) == pytest.approx(low, abs=0.05)
        assert border.max(axis=0) == pytest.approx(high, abs=0.05)


def support(bspline: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """The corners of the box around a support, from its center: half its directions' sum."""
    vectors = {"(1,0)": (1, 0), "(0,1)": (0, 1), "(1,1)": (1, 1), "(1,-1)": (1, -1)}
    half = 0.5 * sum(times * np.abs(vectors[name]) for name, times in bspline["directions"].items())
    return -half, half


def test_figures_of_a_curve_say_what_they_show() -> None:
    made = space_figures.space_figure("offsets_gamma1")
    assert [ax.get_title(loc="left")[:3] for ax in made.axes] == ["(a)", "(b)", "(c)", "(d)"]
    for ax, (sign, most) in zip(made.axes, product((1, -1), (1e-5, 2e-6)), strict=True):
        off = float(re.findall(r"by (\S+) at most", ax.get_xlabel())[0])
        assert off <= most
        lines = [
            np.asarray(segment)
            for drawn in ax.collections
            if isinstance(drawn, LineCollection)
            for segment in drawn.get_segments()
        ]
        found = np.concatenate(lines)
        assert np.abs(ss.signed_distance(gamma("gamma1"), found) - sign * 0.01).max() <= 1e-4
        # All around the curve.
        angles = np.sort(np.arctan2(*(found - 0.5).T[::-1]))
        assert np.diff(angles, append=angles[0] + 2.0 * np.pi).max() <= 0.2
    solid = space_figures.space_figure("surfaces_gamma1")
    assert [ax.get_title(loc="left")[5:7] for ax in solid.axes] == ["th", "S(", "O("]
    with pytest.raises(ss.InputError, match="expected a figure of bsplines, surfaces_gamma1"):
        space_figures.space_figure("offsets")
