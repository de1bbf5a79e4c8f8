"""Ranges of curvature that are claimed of arclets hold at hundreds of parameters of each."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.points import derivatives_at, points_at
from splinesdf.arclets.tangents import end_tangents
from tests.named_shapes import gamma
from tests.real_shapes import SMOOTH, formula_shape, icons

SHAPES = {
    **{name: lambda name=name: formula_shape(name) for name in SMOOTH},
    "cubic": lambda: ss.Shape.from_svg_path("M0 0C3 0 -1 2 2 2C2 5 0 5 0 3z"),
    "quadratic": lambda: ss.Shape.from_svg_path("M0 0Q1 0 1 1Q1 3 0 1z"),
    "apple": lambda: icons()["apple"],
}


@pytest.mark.parametrize("name", SHAPES)
def test_curvature_stays_in_its_range(name: str) -> None:
    shape = SHAPES[name]()
    boundary, rows = shape.boundary, shape.bends.rows
    every = np.arange(len(boundary.start))
    low, high, change = rows[:, :3].T
    speed, bulge = rows[:, 9], rows[:, 10]
    chord = boundary.end - boundary.start
    length = np.hypot(*chord.T)
    before = None
    for t in np.linspace(0.0, 1.0, 201):
        first, second = derivatives_at(boundary, every, np.full(len(every), t))
        pace = np.hypot(*first.T)
        assert np.all(pace <= speed)
        moving = pace > 0.0
        with np.errstate(invalid="ignore", divide="ignore"):
            bend = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / pace**3
        # Rounding in the curvature itself, where control points of small arcs nearly cancel.
        noise = 1e-9 * (1.0 + np.abs(bend)) + 1e-14 / np.maximum(length, 1e-300) ** 2
        assert np.all((bend >= low - noise)[moving])
        assert np.all((bend <= high + noise)[moving])
        if before is not None:
            step = 0.5 * (pace + before[1]) / 200.0
            rise = np.abs(bend - before[0]) - 2.0 * noise
            # The mean pace over a step is that of its ends but for a thousandth.
            assert np.all((rise <= 1.01 * change * step)[moving & (before[1] > 0.0)])
        before = bend, pace
        offset = points_at(boundary, every, np.full(len(every), t)) - boundary.start
        across = np.abs(offset[:, 0] * chord[:, 1] - offset[:, 1] * chord[:, 0])
        assert np.all(across <= bulge * length * (1.0 + 1e-12) + 1e-300)


def test_ends_and_neighbors() -> None:
    shape = gamma("gamma2")
    boundary, bends = shape.boundary, shape.bends
    leaving, arriving = end_tangents(boundary)
    for columns, tangent in ((slice(5, 7), leaving), (slice(7, 9), arriving)):
        unit = bends.rows[:, columns]
        assert np.hypot(*unit.T) == pytest.approx(1.0, abs=1e-15)
        assert np.all(np.sum(unit * tangent, axis=1) > 0.0)
    every = np.arange(len(boundary.start))
    assert np.array_equal(boundary.following[bends.previous], every)
    # Compiled pieces go on with the same curvature.
    gap = bends.rows[:, 4] - bends.rows[boundary.following, 3]
    assert np.abs(gap).max() < 1e-6 * np.abs(bends.rows[:, 3]).max()


def test_only_tiny_arclets_at_a_cusp_have_no_range() -> None:
    shape = formula_shape("astroid")
    unknown = ~np.isfinite(shape.bends.rows[:, 0])
    length = np.hypot(*(shape.boundary.end - shape.boundary.start).T)
    assert 0 < np.count_nonzero(unknown) <= 48
    assert length[unknown].max() < 1e-6
