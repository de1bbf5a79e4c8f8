"""The programs of docs/fields.md run as they stand, and its evaluation in plain Python is right."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from splinesdf.meshes import Grid, Quadtree
from splinesdf.splines.quasi import quasi_interpolate

PAGE = Path(__file__).parents[2] / "docs" / "fields.md"
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)
UNIT = (0.0, 0.0, 1.0, 1.0)


def wavy(points: np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(3.0 * points[:, 0]) + np.cos(5.0 * points[:, 1]) * points[:, 0])


def the_program() -> Callable[[dict[str, Any], float, float], float]:
    (text,) = (text for text in BLOCK.findall(PAGE.read_text("utf-8")) if "def evaluate" in text)
    assert "import" not in text
    names: dict[str, Any] = {}
    exec(text, names)
    evaluate: Callable[[dict[str, Any], float, float], float] = names["evaluate"]
    return evaluate


def test_all_programs_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    blocks = BLOCK.findall(PAGE.read_text("utf-8"))
    for text in blocks:
        exec(text, names)
    assert len(blocks) == 7
    assert meshio.read("field.vtu").cells[0].type == "triangle6"
    assert abs(names["area"] - names["exact"]) < 1e-3
    assert abs(names["exact"] - 0.345575) < 1e-2  # that of a limaçon: 11 π / 100


def trees() -> dict[str, Any]:
    deep = np.zeros(2 + 4 * 12, dtype=bool)
    deep[0] = True
    deep[2 + 4 * np.arange(11) + 3 * (np.arange(11) % 2)] = True
    x, y = np.array([0.1, 0.2, 0.7, 0.8, 2.0]), np.array([-1.0, -0.9, 0.3, 0.301])
    split = np.array([1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0] + 5 * [0, 0, 0, 0], dtype=bool)
    return {
        "grid": Grid.from_lines(x, y),
        "equal": Grid.uniform((-1.0, 0.0, 2.0, 1.0), 5, 2),
        "deep": Quadtree.from_splits((0.0, 1.0, 3.0, 2.0), (1, 2), deep),
        "tree": Quadtree.from_splits((0.0, 0.0, 3.0, 2.0), (3, 2), split[: 6 + 4 * 5]),
    }


@pytest.mark.parametrize("kind", ["grid", "equal", "deep", "tree"])
def test_plain_python_is_the_spline(kind: str) -> None:
    mesh = trees()[kind]
    spline = quasi_interpolate(wavy, mesh, "W")
    fit, evaluate = spline.to_dict(), the_program()
    low, high = np.reshape(spline.domain, (2, 2))
    rng = np.random.default_rng(5)
    cells = mesh.boxes[rng.integers(0, mesh.cell_count, 500)]
    # In every cell, however small, on the border of the domain, and at vertices.
    inside = cells[:, :2] + rng.random((500, 2)) * (cells[:, 2:] - cells[:, :2])
    border = low + np.round(rng.random((100, 2))) * (high - low)
    border[:50, 0] = rng.uniform(low[0], high[0], 50)
    points = np.concatenate([inside, border, rng.uniform(low, high, (500, 2)), cells[:200, :2]])
    found = [evaluate(fit, x, y) for x, y in points.tolist()]
    assert np.max(np.abs(np.array(found) - spline(points, outside="nan"))) <= 2e-14
