"""`to_arrays`, by the evaluator on the site that others copy: it shares no code with ours."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid, Quadtree
from splinesdf.splines.quasi import quasi_interpolate
from tests.docs.pages import DOCS, blocks_of
from tests.named_shapes import gamma

PAGE = DOCS / "howto" / "elsewhere.md"


@cache
def evaluate() -> Callable[..., tuple[np.ndarray, np.ndarray]]:
    names: dict[str, Any] = {}
    exec(evaluator(), names)
    return names["evaluate"]


def evaluator() -> str:
    (text,) = (block.text for block in blocks_of(PAGE) if "def evaluate" in block.text)
    return text


def wavy(points: np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(3.0 * points[:, 0]) + np.cos(5.0 * points[:, 1]) * points[:, 0])


def tree(x: float = 0.0, y: float = 0.0) -> ss.SplineSDF:
    split = np.array([1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0] + 5 * [0, 0, 0, 0], dtype=bool)
    mesh = Quadtree.from_splits((x, y, x + 3.0, y + 2.0), (3, 2), split[:26])
    return quasi_interpolate(wavy, mesh, "W")


def grid() -> ss.SplineSDF:
    lines = np.linspace(0.0, 1.0, 12) ** 1.5, np.linspace(-0.2, 1.0, 9)
    return ss.interpolate(gamma("gamma2"), lines).spline


MADE: dict[str, Callable[[], ss.SplineSDF]] = {
    "tree": tree,
    "far": lambda: tree(1e6, -2e6),
    "grid": grid,
    "equal": lambda: ss.interpolate(gamma("gamma1"), (7, 5)).spline,
    "one cell": lambda: ss.SplineSDF(
        Grid.uniform((-1.0, 2.0, 5.0, 3.0), 1, 1), np.array([[1.0, -2, 3, 0, 2, 1, -1, 4]])
    ),
    "fit": lambda: ss.fit(gamma("gamma1"), tolerance=2e-3).spline,
}


@pytest.mark.parametrize("name", MADE)
def test_the_evaluator_agrees_to_rounding(name: str) -> None:
    spline = MADE[name]()
    low, high = np.reshape(spline.domain, (2, 2))
    boxes, rng = spline.mesh.boxes, np.random.default_rng(5)
    cells = boxes[rng.integers(0, len(boxes), 3000)]
    points = np.concatenate(
        [
            cells[:, :2] + rng.random((3000, 2)) * (cells[:, 2:] - cells[:, :2]),
            boxes[:, :2],  # corners, sides and diagonals, where cells and triangles meet
            boxes[:, 2:],
            0.5 * (boxes[:, :2] + boxes[:, 2:]),
            np.column_stack([boxes[:, 0], 0.5 * (boxes[:, 1] + boxes[:, 3])]),
            [low, high],
        ]
    )
    points = np.clip(points, low, high)
    value, gradient = evaluate()(spline.to_arrays(), points)
    wanted, slopes = spline.value_and_gradient(points)
    # A place in the plane is rounded to 2^-53 of its coordinates, and so is the way to a cell; the
    # value follows by the slope, the gradient by the second derivative, both of which are at hand.
    shift = 4.0 * 2.0**-53 * max(map(abs, spline.domain))
    steep = 1.0 + np.abs(slopes).max()
    bend = np.abs(spline.hessian(0.5 * (boxes[:, :2] + boxes[:, 2:]) + 1e-3)).max()
    assert np.abs(value - wanted).max() <= shift * steep + 1e-15 * np.abs(spline.ordinates).max()
    thin = np.min(boxes[:, 2:] - boxes[:, :2])
    rounding = 1e-14 * np.abs(spline.ordinates).max() / thin
    assert np.abs(gradient - slopes).max() <= 4.0 * shift * (bend + steep / thin) + rounding


def test_beyond_and_not_a_number() -> None:
    points = np.array([[-0.1, 1.0], [3.1, 1.0], [1.0, -0.1], [1.0, 2.1], [np.nan, 1.0], [1.0, 1.0]])
    value, gradient = evaluate()(tree().to_arrays(), points)
    assert (
        np.isnan(value).tolist() == np.isnan(gradient).any(axis=1).tolist() == [True] * 5 + [False]
    )


def test_arrays_are_plain_and_the_evaluator_is_short() -> None:
    for name, make in MADE.items():
        spline = make()
        arrays = spline.to_arrays()
        kept = {key: array.copy() for key, array in arrays.items()}
        for key, array in arrays.items():
            assert array.flags.c_contiguous, (name, key)
            assert array.dtype == (np.int64 if key == "child" else np.float64), (name, key)
            array[:] = 0  # they are the caller's own
        assert all(np.array_equal(kept[key], array) for key, array in spline.to_arrays().items())
        cells = -1 - kept["child"][kept["child"] < 0]
        assert np.array_equal(np.sort(cells), np.arange(len(kept["cells"]))), name
    assert len(evaluator().splitlines()) <= 60
    assert "splinesdf" not in evaluator()


def test_cubic_splines_are_refused() -> None:
    cubic = ss.interpolate(gamma("gamma1"), (4, 4), element="cubic").spline
    with pytest.raises(ss.InputError, match="expected a quadratic spline, got a cubic one"):
        cubic.to_arrays()
