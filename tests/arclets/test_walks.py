"""The walk down the tree from point to point: how often it has to look."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.kernels import nearest
from splinesdf.arclets.tables import NOTHING, Candidates, Cells, Feet, Searched
from tests.compiled import from_python
from tests.glyphs import glyphs
from tests.named_shapes import gamma

SHAPES = {"gamma2": lambda: gamma("gamma2"), "glyph": lambda: glyphs()["DejaVuSans:g"]}
search = from_python(nearest.search)


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_known_from_the_point_before_bounds_the_distance(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that one look is enough for each point, whichever way it lies."""
    shape = SHAPES[name]()
    boundary = shape.boundary
    random = np.random.default_rng(6)
    steps = random.normal(size=(300, 2)) * 10.0 ** random.uniform(-4.0, -1.0, (300, 1))
    points = shape.size * np.cumsum(steps, axis=0)
    bounds = []

    def look(*arguments: float) -> tuple[float, int, float]:
        bounds.append(arguments[3])
        distance, found, t = search(*arguments)
        return float(distance), int(found), float(t)

    monkeypatch.setattr(nearest, "search", look)
    count = len(points)
    starts = np.array([0, count])
    largest = float(np.abs(boundary.start).max())
    feet = Feet(np.empty(count), np.empty(count, dtype=np.int64), np.empty(count), np.inf)
    nearest._walk.py_func(
        Searched(boundary.tree, boundary.arcs, largest),
        Cells(np.array([0.0, 0.0, 1.0, 1.0]), 0, starts, points),
        Candidates(np.array([0, 1]), np.array([0])),
        0,
        NOTHING,
        feet,
        nearest.room_to_search(boundary.arcs),
    )
    exact = np.abs(ss.signed_distance(shape, points + boundary.origin))
    assert feet.distance == pytest.approx(exact, rel=1e-13, abs=1e-14 * shape.size)
    assert len(bounds) == count
    # Nor is the bound larger than the step says.
    before, step = exact[:-1], np.hypot(*np.diff(points, axis=0).T)
    assert bounds[1:] == pytest.approx(before + step, rel=1e-11)
