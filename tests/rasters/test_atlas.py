"""Atlases of fonts, decoded by Pillow: against FreeType, GEOS, HarfBuzz and fontTools."""

from __future__ import annotations

import io
import json
import sys
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
import svgelements
import uharfbuzz
from fontTools.ttLib import TTFont
from matplotlib.ft2font import FT2Font
from PIL import Image

import splinesdf as ss
from splinesdf.rasters import layout as layout_module
from tests.glyphs import glyph_path
from tests.oracles import is_filled, polyline_distance, winding_number
from tests.rasters.glyphs_by_freetype import between, sampled, wrong_points

DATA = Path(__file__).parents[1] / "data"
DEJAVU = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
SANS = DEJAVU / "DejaVuSans.ttf"
INTER = DATA / "fonts" / "inter-latin-wght-normal.woff2"
ASCII = [chr(code) for code in range(32, 127)]
# Composites, several contours, and what hangs below or stands above everything.
MORE = "ÀÅÇÉÑÖŠåçéñœ&@%§¶½ßΩФ∞"


@cache
def sans() -> ss.Atlas:
    return ss.atlas(SANS)


def test_every_glyph_is_where_the_layout_says(saved: Any) -> None:
    values, layout = saved(sans())
    assert [chr(entry["unicode"]) for entry in layout["glyphs"]] == ASCII
    wrong = {
        chr(entry["unicode"]): count
        for entry in layout["glyphs"]
        if (count := wrong_points(values, layout, entry, SANS))
    }
    assert wrong == {}


@pytest.mark.parametrize(
    ("font", "characters", "size"),
    [(SANS, MORE, 45.3), (INTER, "AWgÅß@&8", 32), (DEJAVU / "DejaVuSerif-Italic.ttf", "fjQ", 24)],
    ids=["composites", "overlaps", "slanted"],
)
def test_glyphs_of_other_fonts(font: Path, characters: str, size: float, saved: Any) -> None:
    atlas = ss.atlas(font, characters=characters + characters[::-1], size=size, range=5)
    values, layout = saved(atlas, bits=16)
    assert len(layout["glyphs"]) == len(characters)
    wrong = [wrong_points(values, layout, entry, font) for entry in layout["glyphs"]]
    assert wrong == [0] * len(characters)


def test_distances_are_within_half_a_step(saved: Any) -> None:
    """Of GEOS to fine polylines through the outlines as fontTools writes them as SVG paths."""
    values, layout = saved(sans())
    font = TTFont(SANS)
    width = layout["atlas"]["distanceRange"]
    size, units = layout["atlas"]["size"], font["head"].unitsPerEm
    for entry in layout["glyphs"]:
        if chr(entry["unicode"]) not in "B8%&@gj{":
            continue
        path = svgelements.Path(glyph_path(font, chr(entry["unicode"])))
        rings = [
            np.concatenate([np.array(segment.npoint(np.linspace(0, 1, 65))) for segment in part])
            for part in map(svgelements.Path, path.as_subpaths())
        ]
        plane, place = entry["planeBounds"], entry["atlasBounds"]
        counts = [round(place[a] - place[b]) + 1 for a, b in (("right", "left"), ("top", "bottom"))]
        shares = np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in counts))
        points = units * np.stack(between(plane, *shares), axis=-1).reshape(-1, 2)
        lines = [ring for ring in rings if len(ring)]
        inside = is_filled(winding_number(lines, points), "nonzero")
        away = polyline_distance(lines, points) * size / units
        expected = np.clip(0.5 - np.where(inside, -away, away) / width, 0.0, 1.0)
        found = sampled(values, *between(place, *shares)).ravel()
        # Half a step of 8 bits, and what chords of 64 to a curve leave: 1e-4 texels.
        assert np.abs(found - expected).max() <= 0.5 / 255 + 1e-4 / width
        assert np.count_nonzero(found > 0.5) > 20


def test_no_cell_touches_another_and_between_them_is_nothing() -> None:
    atlas = sans()
    codes = atlas.pixels()
    owners = np.zeros(codes.shape, dtype=int)
    for glyph in atlas.glyphs:
        if glyph.cell is None:
            assert glyph.name == " "
            continue
        cell = glyph.cell
        part = np.s_[cell.row : cell.row + cell.height, cell.column : cell.column + cell.width]
        owners[part] += 1
        own = codes[part]
        assert own.max() > 127
        # All of the range is in the cell: along its border the least number is found.
        border = np.concatenate([own[[0, -1]].ravel(), own[:, [0, -1]].ravel()])
        assert border.max() == 0
    assert owners.max() == 1
    assert codes[owners == 0].max() == 0
    assert atlas.values[owners == 0].min() == atlas.values[owners == 0].max() == 2.0


@pytest.mark.parametrize("size", [32, 33.3])
def test_bounds_in_texels_are_those_in_ems_times_the_size(size: float, saved: Any) -> None:
    values, layout = saved(ss.atlas(SANS, size=size, characters="Ajq{%"))
    assert (layout["atlas"]["height"], layout["atlas"]["width"]) == values.shape
    for entry in layout["glyphs"]:
        plane, place = entry["planeBounds"], entry["atlasBounds"]
        for first, last in (("left", "right"), ("bottom", "top")):
            wanted, got = size * (plane[last] - plane[first]), place[last] - place[first]
            assert got == (wanted if size == 32 else pytest.approx(wanted, rel=1e-13))
            # Centers of texels, of the picture's and of those counted from the glyph's origin.
            assert place[first] % 1.0 == place[last] % 1.0 == 0.5
            assert (size * plane[first]) % 1.0 == pytest.approx(0.5, abs=1e-12)


def test_y_from_the_top_turns_lines_and_bounds_over(saved: Any) -> None:
    values, below = saved(sans())
    same, above = saved(sans(), y_origin="top")
    assert np.array_equal(values, same)
    assert (below["atlas"]["yOrigin"], above["atlas"]["yOrigin"]) == ("bottom", "top")
    for name in ("ascender", "descender", "underlineY"):
        assert above["metrics"][name] == -below["metrics"][name] != 0
    assert above["metrics"]["lineHeight"] == below["metrics"]["lineHeight"]
    for one, other in zip(below["glyphs"], above["glyphs"], strict=True):
        if "planeBounds" not in one:
            continue
        for side in ("left", "right", "top", "bottom"):
            sign = -1 if side in ("top", "bottom") else 1
            from_top = len(values) if sign < 0 else 0
            assert other["planeBounds"][side] == sign * one["planeBounds"][side]
            assert other["atlasBounds"][side] == from_top + sign * one["atlasBounds"][side]


def test_the_layout_has_the_keys_of_msdf_atlas_gen_in_their_order(saved: Any) -> None:
    _, layout = saved(sans())
    assert list(layout) == ["atlas", "name", "metrics", "glyphs", "kerning"]
    assert layout["atlas"] == {
        **{"type": "sdf", "distanceRange": 4, "distanceRangeMiddle": 0, "size": 32},
        **{"width": sans().values.shape[1], "height": sans().values.shape[0]},
        "yOrigin": "bottom",
    }
    # A whole number is written as one: some readers take nothing else.
    assert all(isinstance(layout["atlas"][key], int) for key in ("distanceRange", "size"))
    assert list(layout["metrics"]) == [
        *("emSize", "lineHeight", "ascender", "descender", "underlineY", "underlineThickness")
    ]
    space, mark = layout["glyphs"][:2]
    assert list(space) == ["unicode", "advance"]
    assert list(mark) == ["unicode", "advance", "planeBounds", "atlasBounds"]
    assert list(mark["planeBounds"]) == ["left", "bottom", "right", "top"]
    assert list(mark["atlasBounds"]) == ["left", "bottom", "right", "top"]


@pytest.mark.parametrize("font", ["DejaVuSans", "DejaVuSansMono-Bold", "STIXGeneral", "cmr10"])
def test_lines_of_writing_are_freetypes(font: str, saved: Any) -> None:
    path = DEJAVU / f"{font}.ttf"
    _, layout = saved(ss.atlas(path, characters="A1"))
    face, found = FT2Font(str(path)), layout["metrics"]
    em = face.units_per_EM
    assert found["emSize"] == 1
    assert found["ascender"] == face.ascender / em
    assert found["descender"] == face.descender / em
    assert found["lineHeight"] == face.height / em
    assert found["underlineY"] == face.underline_position / em
    assert found["underlineThickness"] == face.underline_thickness / em


@pytest.mark.parametrize(
    ("hhea", "typo", "selected"),
    [((800, -200, 90), (700, -300, 10), 0), ((800, -200, 90), (700, -300, 10), 128),
     ((0, 0, 0), (700, -300, 10), 0), ((0, 0, 0), (0, 0, 0), 0)],
)  # fmt: skip
def test_lines_come_from_the_table_that_counts(
    hhea: Any, typo: Any, selected: int, tmp_path: Path
) -> None:
    font = TTFont(SANS)
    font["hhea"].ascent, font["hhea"].descent, font["hhea"].lineGap = hhea
    os2 = font["OS/2"]
    os2.sTypoAscender, os2.sTypoDescender, os2.sTypoLineGap = typo
    os2.fsSelection = selected | (os2.fsSelection & ~128)
    path = tmp_path / "font.ttf"
    font.save(path)
    face, lines = FT2Font(str(path)), ss.atlas(path, characters="1").lines
    assert [1000 * x for x in (lines.ascender, lines.descender, lines.height)] == pytest.approx(
        [1000 * x / 2048 for x in (face.ascender, face.descender, face.height)]
    )


def test_advances_and_kerning_are_the_fonts(saved: Any) -> None:
    _, layout = saved(sans())
    font = TTFont(SANS)
    units, names = font["head"].unitsPerEm, font.getBestCmap()
    for entry in layout["glyphs"]:
        assert entry["advance"] == font["hmtx"][names[entry["unicode"]]][0] / units
    # DejaVu has the same pairs in its old table, which fontTools reads into a dictionary.
    table = font["kern"].kernTables[0].kernTable
    codes = {names[ord(character)]: ord(character) for character in ASCII}
    expected = {
        (codes[first], codes[second]): value / units
        for (first, second), value in table.items()
        if first in codes and second in codes and value
    }
    found = {(k["unicode1"], k["unicode2"]): k["advance"] for k in layout["kerning"]}
    assert found == expected
    assert len(found) == 220


def test_without_harfbuzz_there_is_no_kerning_and_it_says_so(
    monkeypatch: pytest.MonkeyPatch, saved: Any
) -> None:
    monkeypatch.setitem(sys.modules, "uharfbuzz", None)
    atlas = ss.atlas(SANS, characters="AV")
    assert "no kerning, as uharfbuzz is missing" in atlas.notes[0]
    assert saved(atlas)[1]["kerning"] == []


def test_a_location_moves_outlines_and_advances() -> None:
    font = TTFont(INTER)
    font.flavor = None
    plain = io.BytesIO()
    font.save(plain, reorderTables=False)
    area = []
    for weight in (100, 400, 900):
        atlas = ss.atlas(INTER, characters="HM", location={"wght": weight})
        shaper = uharfbuzz.Font(uharfbuzz.Face(plain.getvalue()))
        shaper.set_variations({"wght": weight})
        for glyph in atlas.glyphs:
            index = shaper.get_nominal_glyph(ord(glyph.name))
            # HarfBuzz rounds advances to whole units.
            assert abs(glyph.advance * shaper.face.upem - shaper.get_glyph_h_advance(index)) <= 0.51
        area.append(np.count_nonzero(atlas.values < 0.0))
    assert area[0] < 0.6 * area[1] < 0.6 * area[2]


def test_what_the_font_lacks_is_named() -> None:
    font = DATA / "fonts" / "roboto-latin-400-normal.woff2"
    with pytest.raises(ss.InputError, match=r"no glyph for '\\u0416', '\\u0436'") as caught:
        ss.atlas(font, characters="AЖж")
    assert str(caught.value).startswith("roboto-latin")
    with pytest.raises(ss.InputError, match="and 3 more"):
        ss.atlas(font, characters="ЖжбгдеёЩ")


def test_ascii_is_what_is_there_of_it(tmp_path: Path) -> None:
    font = TTFont(DEJAVU / "cmr10.ttf")
    for table in font["cmap"].tables:
        for code in map(ord, "Q~"):
            table.cmap.pop(code, None)
    font.save(tmp_path / "less.ttf")
    atlas = ss.atlas(tmp_path / "less.ttf", size=8, range=1)
    assert [glyph.name for glyph in atlas.glyphs] == [c for c in ASCII if c not in "Q~"]
    assert "the font has no glyph for 'Q', '~'" in atlas.notes


def test_a_glyph_that_fills_nothing_is_a_space(tmp_path: Path) -> None:
    from fontTools.pens.ttGlyphPen import TTGlyphPen

    font = TTFont(DEJAVU / "cmr10.ttf")
    pen = TTGlyphPen(None)
    pen.moveTo((0, 0))
    pen.lineTo((500, 500))
    pen.closePath()
    font["glyf"]["A"] = pen.glyph()
    font.save(tmp_path / "line.ttf")
    atlas = ss.atlas(tmp_path / "line.ttf", characters="AB")
    assert [glyph.cell is None for glyph in atlas.glyphs] == [True, False]
    with pytest.raises(ss.InputError, match="something to see"):
        ss.atlas(tmp_path / "line.ttf", characters="A")


@pytest.mark.parametrize("suffix", [".tif", ".npy"])
def test_other_formats_hold_distances_in_texels(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"atlas{suffix}"
    beside = sans().save(path)
    assert beside == path.with_suffix(".json")
    values = np.load(path) if suffix == ".npy" else np.asarray(Image.open(path))
    assert np.array_equal(values, sans().values.astype(values.dtype))
    assert json.loads(beside.read_text())["atlas"]["type"] == "sdf"


def test_both_files_are_written_or_neither(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.png").write_text("old")
    (tmp_path / "a.json").mkdir()  # not to be written
    with pytest.raises(ss.InputError, match=r"a\.json"):
        sans().save(tmp_path / "a.png")
    (tmp_path / "b.json").write_text("old")
    (tmp_path / "b.png").mkdir()
    with pytest.raises(ss.InputError, match=r"b\.png"):
        sans().save(tmp_path / "b.png")

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(layout_module, "write_image", full)
    (tmp_path / "c.json").write_text("old")
    with pytest.raises(ss.InputError, match="No space left"):
        sans().save(tmp_path / "c.png")
    assert {p.name: p.read_text() for p in tmp_path.iterdir() if p.is_file()} == {
        **{"a.png": "old", "b.json": "old", "c.json": "old"}
    }


@pytest.mark.parametrize(
    ("source", "options", "expected"),
    [
        (SANS, {"size": 0.5}, "a size of 1 to 8192 texels"),
        (SANS, {"range": 0.5}, "a range of 1 to 16,384 texels"),
        (
            SANS,
            {"size": 8000, "characters": "ABCDEFGHIJKLMNOPQRSTU"},
            "fit into 16,384 x 16,384 texels",
        ),
        (SANS, {"characters": ""}, "at least one character"),
        (SANS, {"characters": " "}, "something to see"),
        (SANS, {"characters": 5}, "characters as a text"),
        (SANS, {"em": 5}, "em only for drawings"),
        (SANS, {"stroke": "outline"}, "stroke only for drawings"),
        ([None], {}, "a file's path"),
        ({5: None}, {}, "a file's path"),
        (SANS, {"location": {"wght": 5}}, "not variable"),
        (SANS.with_name("none.ttf"), {}, "does not exist"),
        (DATA / "gear-fill.svg", {}, "expected a font ending in"),
        (DATA / "icons", {"characters": "a"}, "characters only for a font"),
        (DATA / "icons", {"em": "one"}, "em"),
        ([DATA / "gear-fill.svg"], {"em": 1e-3}, "larger"),
        ([DATA / "gear-fill.svg"], {"em": 1e-320}, "larger"),
        (DATA / "outlines", {}, "expected drawings in the folder"),
        ([], {}, "at least one drawing"),
        (5, {}, "a font, a folder, or drawings"),
        ([DATA / "gear-fill.svg"] * 2, {}, "different names, got 'gear-fill' twice"),
        (ss.Shape.from_points([[0, 0], [1, 0], [1, 1]]), {}, "put it in brackets"),
    ],
)
def test_refused_in_one_line(source: Any, options: dict[str, Any], expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected) as caught:
        ss.atlas(source, **options)
    assert "\n" not in str(caught.value)


def test_kerning_by_classes_is_what_harfbuzz_adds_between_two() -> None:
    font = DATA / "fonts" / "noto-serif-latin-400-normal.woff"
    characters = "AVTfilo."  # with ligatures, which an atlas has none of
    found = {(k.first, k.second): k.advance for k in ss.atlas(font, characters=characters).kerning}
    plain = io.BytesIO()
    opened_font = TTFont(font)
    opened_font.flavor = None
    opened_font.save(plain)
    shaper = uharfbuzz.Font(uharfbuzz.Face(plain.getvalue()))
    kerned = 0
    for first in characters:
        for second in characters:
            widths = []
            for on in (True, False):
                buffer = uharfbuzz.Buffer()
                buffer.add_str(first + second)
                buffer.guess_segment_properties()
                uharfbuzz.shape(shaper, buffer, {"kern": on, "liga": False})
                widths.append(sum(at.x_advance for at in buffer.glyph_positions))
            expected = (widths[0] - widths[1]) / shaper.face.upem
            assert found.get((first, second), 0.0) == expected
            kerned += expected != 0.0
    assert kerned > 5
