"""Atlases of drawings, decoded by Pillow: against resvg and GEOS."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import splinesdf as ss
from tests.drawings import picture
from tests.rasters.glyphs_by_freetype import sampled

DATA = Path(__file__).parents[1] / "data"


def framed(folder: Path, names: list[str]) -> Path:
    """A folder of icons, and a square that all of their view boxes are."""
    for name in names:
        (folder / f"{name}.svg").write_bytes((DATA / "icons" / f"{name}.svg").read_bytes())
    square = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 16 16">'
    (folder / "frame.svg").write_text(f'{square}<path d="M0 0h16v16H0z"/></svg>')
    (folder / "readme.txt").write_text("no drawing")
    return folder


NAMES = ["airplane", "rocket-takeoff", "scissors", "umbrella-fill"]


def test_icons_are_upright_and_where_resvg_paints_them(tmp_path: Path, saved: Any) -> None:
    folder = tmp_path / "icons"
    folder.mkdir()
    atlas = ss.atlas(framed(folder, NAMES), size=64, range=4)
    assert "1 in the folder is no drawing, left out" in atlas.notes
    values, layout = saved(atlas, bits=16)
    assert layout["name"] == "icons"
    names = sorted([*NAMES, "frame"])
    assert [(e["index"], e["name"]) for e in layout["glyphs"]] == list(enumerate(names))
    across = (np.arange(256) + 0.5) / 256
    x, y = np.meshgrid(across, across[::-1])  # row by row from the top
    for entry in layout["glyphs"]:
        # One icon is wider than its view box by 2e-4.
        assert entry["advance"] == pytest.approx(1.0, abs=2e-5)
        plane, place = entry["planeBounds"], entry["atlasBounds"]
        column, row = (
            place[low] + (at - plane[low]) * 64 for low, at in (("left", x), ("bottom", y))
        )
        found = sampled(values, column, row)
        within = (x > plane["left"]) & (x < plane["right"])
        within &= (y > plane["bottom"]) & (y < plane["top"])
        paint = picture((folder / f"{entry['name']}.svg").read_text(), 256)
        clear = np.abs(found - 0.5) * 4 > 0.6
        assert np.array_equal((found > 0.5)[within & clear], paint[within & clear])
        assert not paint[~within].any()
        assert np.count_nonzero(paint & within) > 2000


def test_icons_of_strokes_are_what_the_strokes_cover() -> None:
    files = sorted((DATA / "drawings" / "feather").iterdir())[:4]
    with pytest.raises(ss.InputError, match="stroke"):
        ss.atlas(files)
    atlas = ss.atlas(files, size=48, em=24, stroke="outline")
    assert [glyph.name for glyph in atlas.glyphs] == [path.stem for path in files]
    for path, glyph in zip(files, atlas.glyphs, strict=True):
        cell = glyph.cell
        assert cell is not None
        part = np.s_[cell.row : cell.row + cell.height, cell.column : cell.column + cell.width]
        covered = np.count_nonzero(atlas.values[part] < 0.0)
        paint = np.count_nonzero(picture(path.read_text(), 480, strokes=True)) / 100
        assert covered == pytest.approx(paint, rel=0.1)


def test_drawings_are_on_one_scale_or_each_on_its_own() -> None:
    small, large = (
        ss.Shape.from_points(np.array([[0, 0], [2, 0], [2, 1], [0, 1]]) * k + 5 * k, name=f"x{k}")
        for k in (1.0, 3.0)
    )
    one = ss.atlas([small, large], size=20, range=2)
    # All lie in [5, 21] x [5, 18]: an em is 16.
    assert [g.advance for g in one.glyphs] == [1.0, 1.0]
    assert one.lines.height == 13 / 16
    cells = [g.cell for g in one.glyphs]
    assert [c and (c.left, c.bottom) for c in cells] == [(-2, -2), (11, 11)]
    each = ss.atlas({"a": small, "b": large}, size=20, range=2, em="each")
    assert [g.name for g in each.glyphs] == ["a", "b"]
    first, second = (g.cell for g in each.glyphs)
    assert first is not None
    assert second is not None
    assert first[2:] == second[2:] == (-2, -2, 24, 14)
    fixed = ss.atlas([small, large], size=20, range=2, em=4.0)
    assert fixed.glyphs[0].advance == 4.0


def test_drawings_of_different_units_are_named() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    loops = [[np.array(p) for p in zip(square, np.roll(square, -1, 0), strict=True)]]
    shapes = {str(unit): ss.Shape.from_pieces(loops, unit=unit) for unit in (1.0, 25.4)}
    assert "units differ in length" in ss.atlas(shapes).notes[0]
    assert ss.atlas(shapes, em="each").notes == ()


def test_shapely_is_the_judge_of_the_example() -> None:
    square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    atlas = ss.atlas({"square": square}, size=8, range=2)
    cell = atlas.glyphs[0].cell
    assert cell == (0, 0, -2, -2, 12, 12)
    assert cell is not None
    at = (np.arange(12) - 2 + 0.5) / 2  # two texels a unit
    points = shapely.points(*np.meshgrid(at, at[::-1]))
    ring = shapely.box(0, 0, 4, 4)
    expected = (
        2
        * np.where(shapely.contains(ring, points), -1, 1)
        * shapely.distance(ring.exterior, points)
    )
    assert np.abs(atlas.values - expected).max() < 1e-14
