"""The page's text without a browser: what is refused, its digests, the distances that lie ready."""

from __future__ import annotations

import base64
import hashlib
import re
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid, Quadtree
from splinesdf.web import block
from splinesdf.web.levels import Level, level_at, level_file, level_files, ready_distances
from splinesdf.web.page import MODULES, page_text, write_page
from tests.named_shapes import gamma

_ASSETS = Path(ss.__file__).parent / "web" / "assets"


def test_every_module_is_joined_after_those_it_imports() -> None:
    assert {path.stem for path in _ASSETS.glob("*.js")} == set(MODULES)
    for number, name in enumerate(MODULES):
        imported = re.findall(r"^import .* from '\./(\w+)\.js';$", _read(name), flags=re.MULTILINE)
        assert set(imported) <= set(MODULES[:number]), name
        # Nothing that joining would not take for an import or an export.
        assert len(imported) == len(re.findall(r"^\s*import\b", _read(name), flags=re.MULTILINE))
        assert "export default" not in _read(name)


def _read(name: str) -> str:
    return (_ASSETS / f"{name}.js").read_text(encoding="utf-8")


def test_policy_names_what_the_page_holds() -> None:
    text = page_text(ss.fit(gamma("gamma1"), tolerance=0.1).spline, [])
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)
    assert policy is not None
    assert policy[1].startswith("default-src 'none'; ")
    assert "connect-src" not in policy[1]
    assert "unsafe" not in policy[1]
    for directive, tag in (("script-src", '<script id="code">'), ("style-src", "<style>")):
        start = text.index(tag) + len(tag)
        body = text[start : text.index("</", start)]
        digest = base64.b64encode(hashlib.sha256(body.encode()).digest()).decode()
        assert f"{directive} 'sha256-{digest}'" in policy[1]


def test_no_address_of_anybody_else() -> None:
    text = page_text(ss.fit(gamma("gamma1"), tolerance=0.1).spline, [])
    assert re.findall(r"(?:https?:)?//[a-z][\w.-]*\.[a-z]{2,}", text) == []


def test_ready_distances_are_round() -> None:
    spline = ss.fit(gamma("gamma1"), tolerance=1e-2).spline
    distances = ready_distances(spline)
    assert 0.0 in distances
    assert distances == sorted(set(distances))
    assert min(distances) < 0.0 < max(distances)
    step = np.diff(distances)
    assert step == pytest.approx(step[0])
    assert f"{step[0]:.0e}"[0] in "125"
    shape = spline.shape
    assert shape is not None
    for distance in distances:
        level = level_at(shape, distance)
        assert level.contours
        assert level.deviation <= level.tolerance
    assert min(distances) > -0.5
    assert max(distances) < float(spline(spline.domain[:2]))


def test_refused(tmp_path: Path) -> None:
    spline = ss.fit(gamma("gamma1"), tolerance=0.1).spline
    with pytest.raises(ss.InputError, match=r"ending in \.html"):
        write_page(tmp_path / "page.txt", spline)
    with pytest.raises(ss.InputError, match="finite distance"):
        write_page(tmp_path / "page.html", spline, distances=[np.nan])
    with pytest.raises(ss.InputError, match="up to 200 distances"):
        write_page(tmp_path / "page.html", spline, distances=np.linspace(0.0, 0.1, 300))
    cubic = ss.interpolate(gamma("gamma1"), (8, 8), element="cubic").spline
    with pytest.raises(ss.InputError, match="quadratic spline"):
        write_page(tmp_path / "page.html", cubic)
    bare = ss.SplineSDF(spline.mesh, spline.ordinates)
    with pytest.raises(ss.InputError, match="holds its shape"):
        write_page(tmp_path / "page.html", bare, distances=[0.1])
    write_page(tmp_path / "page.html", bare)
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_more_cells_than_a_page_can_hold_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spline = ss.fit(gamma("gamma1"), tolerance=0.1).spline
    monkeypatch.setattr(block, "_MOST_CELLS", 3)
    with pytest.raises(
        ss.InputError, match=r"expected at most 3 cells for the page, got \d+: raise"
    ):
        write_page(tmp_path / "page.html", spline)
    assert not list(tmp_path.iterdir())


def test_the_lines_of_the_coarsest_level_are_those_of_the_mesh() -> None:
    ordinates = np.ones((6, 8))
    lines = np.array([0.0, 1.0, 3.0]), np.array([-1.0, 0.0, 0.5, 2.0])
    for spline, expected in (
        (ss.SplineSDF(Grid.from_lines(*lines), ordinates), lines),
        (
            ss.SplineSDF(Quadtree.uniform((0.0, -1.0, 3.0, 2.0), 2, 3), ordinates),
            ([0.0, 1.5, 3.0], [-1.0, 0.0, 1.0, 2.0]),
        ),
    ):
        found = block._lines(spline)
        assert [line.tolist() for line in found] == [list(line) for line in expected]


def test_where_nothing_is_inside_only_the_shape_itself_lies_ready() -> None:
    mesh = Grid.uniform((0.0, 0.0, 1.0, 1.0), 2, 2)
    assert ready_distances(ss.SplineSDF(mesh, np.ones((4, 8)))) == [0.0]


def test_kinds_of_files_whose_library_is_missing_are_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    levels = [level_at(gamma("gamma1"), 0.1)]
    assert set(level_files(levels)) == {"svg", "dxf"}

    def without_ezdxf(level: Level, kind: str) -> str:
        if kind == "dxf":
            raise ss.MissingExtraError("DXF needs ezdxf")
        return level_file(level, kind)

    monkeypatch.setattr("splinesdf.web.levels.level_file", without_ezdxf)
    assert set(level_files(levels)) == {"svg"}
