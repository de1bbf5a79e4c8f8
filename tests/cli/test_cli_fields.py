"""Fits as JSON and as fields: `splinesdf fit`, `info` and `query`."""

from __future__ import annotations

import json
from pathlib import Path

import meshio
import numpy as np
import pytest

import splinesdf as ss
from tests.cli.test_cli import Command, run

__all__ = ["run"]


def test_one_fit_to_several_files(run: Command, tmp_path: Path) -> None:
    files = ["fit.npz", "fit.json", "fit.vtu"]
    outputs = [word for file in files for word in ("-o", file)]
    done = run("fit", "gamma1", "--tolerance", "0.05", *outputs)
    assert done.status == 0, done.err
    assert [line.split()[1] for line in done.out.splitlines() if "written" in line] == files
    spline = ss.load(tmp_path / "fit.npz")
    assert ss.load(tmp_path / "fit.json").to_dict() == spline.to_dict()
    field = meshio.read(tmp_path / "fit.vtu")
    assert np.max(np.abs(spline(field.points[:, :2]) - field.point_data["distance"])) <= 1e-13


def test_info_and_query_of_json(run: Command, tmp_path: Path) -> None:
    run("fit", "gamma1", "--tolerance", "0.05", "-o", "fit.npz", "-o", "fit.json")
    (tmp_path / "points.csv").write_text("0.5,0.5\n0.1,0.2\n")
    one, other = (run("info", f"fit.{ending}") for ending in ("npz", "json"))
    assert (one.status, other.status) == (0, 0)
    # All but the file's own size.
    lines = [
        [line for line in done.out.splitlines() if "bytes" not in line] for done in (one, other)
    ]
    assert lines[0] == lines[1]
    assert len(lines[0]) > 8
    one, other = (run("query", f"fit.{ending}", "points.csv") for ending in ("npz", "json"))
    assert one.out == other.out
    assert one.out.startswith("x,y,distance,gx,gy\n0.5,0.5,-0.4")


def test_info_of_formulas_and_of_sorted_json(run: Command, tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"x": "cos(t)", "y": "sin(t)"}')
    assert "pieces" in run("info", "a.json").out
    content = ss.interpolate(ss.Shape.from_points(np.eye(3)[:, :2]), (2, 2)).spline.to_dict()
    (tmp_path / "b.json").write_text(json.dumps(content, sort_keys=True, indent=1))
    assert "4 (grid)" in run("info", "b.json").out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["fit", "gamma1", "-o", "fit.npz", "-o", "fit.txt"], ".json, .npz, .vtu"),
        (
            ["fit", "gamma1", "--element", "cubic", "--space", "uniform", "-o", "a.glsl"],
            "quadratic or quartic element for .glsl, got cubic: save the fit as .npz or .json",
        ),
        (["fit", "gamma1", "--element", "sextic", "-o", "a.vtu"], "sextic"),
        (["offset", "gamma1", "-d", "1", "-o", "a.vtu"], "expected a spline for .vtu"),
        (["fit", "fit.json", "-o", "a.vtu"], "got a saved fit"),
        (["fit", "fit.json", "-o", "fit.json"], "saved fit"),
        (["info", "cut.json"], "damaged"),
        (["query", "cut.json", "points.csv"], "damaged"),
        (["query", "points.csv", "fit.json"], "give the points last"),
        (["info", "missing.json"], "does not exist"),
    ],
)
def test_what_cannot_be_is_one_line(
    run: Command, tmp_path: Path, arguments: list[str], says: str
) -> None:
    shape = ss.Shape.from_points(np.eye(3)[:, :2])
    ss.interpolate(shape, (2, 2)).spline.save(tmp_path / "fit.json")
    whole = (tmp_path / "fit.json").read_bytes()
    (tmp_path / "cut.json").write_bytes(whole[:-100])
    (tmp_path / "points.csv").write_text("0,0\n1,1\n")
    done = run(*arguments)
    assert (done.status, done.out) == (2, "")
    (line,) = (line for line in done.err.splitlines() if not line.startswith("tolerance "))
    assert line.startswith("splinesdf: ")
    assert says in line
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == ["cut.json", "fit.json", "points.csv"]
    assert (tmp_path / "fit.json").read_bytes() == whole


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--stroke", "outline"], "--stroke"),
        (["--close"], "--close"),
        (["--fill", "evenodd"], "--fill"),
        (["--gap", "0"], "--gap"),
        (["--layer", "a"], "--layer"),
        (["--stroke-color", "red"], "--stroke-color"),
        (["--axis", "wght=1"], "--axis"),
        (["--columns", "0", "1"], "--columns"),
        (["--text", ""], "--text"),
    ],
)
@pytest.mark.parametrize("command", ["info", "query", "texture", "view"])
def test_a_saved_fit_is_not_read_with_options(
    run: Command, tmp_path: Path, command: str, options: list[str], named: str
) -> None:
    square = ss.Shape.from_points([(0, 0), (1, 0), (1, 1), (0, 1)])
    ss.interpolate(square, (2, 2)).spline.save(tmp_path / "fit.npz")
    (tmp_path / "points.csv").write_text("0.5,0.5\n")
    rest = {
        "query": ["points.csv"],
        "texture": ["-o", "out.png", "--range", "1"],
        "view": ["--html", "out.html"],
    }
    done = run(command, "fit.npz", *rest.get(command, []), *options, "--limit", "crossings=9")
    assert done.status == 2
    assert done.err.startswith(f"splinesdf: expected a shape for {named}, got a saved fit")
    assert len(done.err.splitlines()) == 1
    assert not list(tmp_path.glob("out*"))
