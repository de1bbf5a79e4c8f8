"""Texts in fonts: outlines against FreeType's, places against HarfBuzz's sums, and refusals."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from fontTools.colorLib.builder import buildCOLR
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.t2CharStringPen import T2CharStringPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTFont
from fontTools.ttLib.tables.otTables import PaintFormat
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path as MplPath
from matplotlib.textpath import TextPath
from numpy.testing import assert_allclose

import splinesdf as ss
from tests.reading import areas, assert_one_line

FONTS = Path(__file__).parents[1] / "data" / "fonts"
DEJAVU = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
PACKED = sorted(FONTS.iterdir())


@pytest.mark.parametrize("character", "B8gßÅ%")
def test_regions_are_freetypes(character: str) -> None:
    shape = ss.read(DEJAVU, text=character, size=100.0)
    path = TextPath((0, 0), character, size=100.0, prop=FontProperties(fname=str(DEJAVU)))
    points = np.random.default_rng(1).random((4000, 2)) * [110.0, 120.0] - [5.0, 25.0]
    distance = ss.signed_distance(shape, points)
    inside = np.zeros(len(points), dtype=bool)
    for polygon in path.to_polygons():
        inside ^= MplPath(polygon).contains_points(points)
    clear = np.abs(distance) > 0.5  # hinted outlines are moved a little
    assert np.count_nonzero(inside) > 300
    assert np.array_equal((distance < 0)[clear], inside[clear])


@pytest.mark.parametrize("font", PACKED, ids=lambda font: font.stem)
def test_packed_fonts_are_read_with_kerning(font: Path) -> None:
    together, apart = (ss.read(font, text=text) for text in ("AVA", "A"))
    single = ss.read(font, text="V")
    width = [s.box[2] - s.box[0] for s in (apart, single, together)]
    assert together.notes == ()
    # A V A overlap in x where they are kerned.
    assert width[2] < 2 * width[0] + width[1]
    assert_allclose(np.sum(np.abs(areas(apart))) * 2 + np.sum(np.abs(areas(single))),
                    np.sum(np.abs(areas(together))), rtol=1e-9)  # fmt: skip


def test_without_harfbuzz_glyphs_follow_by_their_widths(monkeypatch: pytest.MonkeyPatch) -> None:
    font = FONTS / "inter-latin-wght-normal.woff2"
    kerned = ss.read(font, text="AVTo")
    monkeypatch.setitem(sys.modules, "uharfbuzz", None)
    plain = ss.read(font, text="AVTo")
    assert plain.box[2] > 1.03 * kerned.box[2]
    assert "no kerning" in plain.notes[0]
    assert ss.read(font, text="A").notes == ()


def test_the_location_moves_all_axes_between_their_ends() -> None:
    font = FONTS / "inter-latin-wght-normal.woff2"
    sizes = [
        float(np.sum(areas(ss.read(font, text="H", location={"wght": weight}))))
        for weight in (100, 400, 650.5, 900)
    ]
    assert (np.diff(np.abs(sizes)) > 0).all()
    for location, expected in (
        ({"wght": 1000}, "wght from 100 to 900, got 1000"),
        ({"slnt": 1}, "expected axes of wght, got 'slnt'"),
        ({"wght": "bold"}, "expected a number for wght"),
    ):
        with pytest.raises(ss.InputError, match=expected):
            ss.read(font, text="H", location=location)  # type: ignore[arg-type]


def test_lines_are_one_under_the_other_and_the_size_scales() -> None:
    one, two = (ss.read(DEJAVU, text=text, size=10.0) for text in ("H", "H\nH"))
    height = one.box[3] - one.box[1]
    assert two.loop_count == 2
    assert two.box[3] == pytest.approx(one.box[3])
    assert two.box[1] < one.box[1] - height
    units = ss.read(DEJAVU, text="H")
    assert_allclose(np.array(units.box) * 10.0 / 2048, one.box, rtol=1e-12)


def drawn(pen: Any, contours: list[list[tuple[int, int]]]) -> Any:
    for contour in contours:
        pen.moveTo(contour[0])
        for point in contour[1:]:
            pen.lineTo(point)
        pen.closePath()
    return pen


# Two squares that overlap, as in many variable fonts.
SQUARE = [(0, 0), (0, 600), (600, 600), (600, 0)]
OVERLAP = [SQUARE, [(x + 300, y + 300) for x, y in SQUARE]]


@pytest.fixture(params=["glyf", "CFF"])
def built(request: Any, tmp_path: Path) -> Callable[[], Path]:
    def build() -> Path:
        builder = FontBuilder(1000, isTTF=request.param == "glyf")
        builder.setupGlyphOrder([".notdef", "A", "space"])
        builder.setupCharacterMap({65: "A", 32: "space"})
        if request.param == "glyf":
            pens = {name: TTGlyphPen(None) for name in (".notdef", "A", "space")}
            drawn(pens["A"], OVERLAP)
            builder.setupGlyf({name: pen.glyph() for name, pen in pens.items()})
        else:
            strings = {name: T2CharStringPen(1000, None) for name in (".notdef", "A", "space")}
            drawn(strings["A"], OVERLAP)
            builder.setupCFF("Test", {}, {n: p.getCharString() for n, p in strings.items()}, {})
        builder.setupHorizontalMetrics(dict.fromkeys((".notdef", "A", "space"), (1000, 0)))
        builder.setupHorizontalHeader(ascent=900, descent=-100)
        builder.setupNameTable({"familyName": "Test", "styleName": "Regular"})
        builder.setupOS2()
        builder.setupPost()
        path = tmp_path / ("a.ttf" if request.param == "glyf" else "a.otf")
        builder.save(path)
        return path

    return build


def test_contours_of_a_glyph_that_overlap_are_united(built: Callable[[], Path]) -> None:
    shape = ss.read(built(), text="A A")
    assert ss.signed_distance(shape, [(450, 450), (2450, 450)]) == pytest.approx(
        [-150 * 2**0.5] * 2
    )
    assert shape.box == pytest.approx((0, 0, 2900, 900))


def test_damaged_fonts_are_refused_in_one_line(tmp_path: Path, built: Callable[[], Path]) -> None:
    content = built().read_bytes()
    random = np.random.default_rng(5)
    for number in range(60):
        damaged = bytearray(content)
        for place in random.integers(0, len(damaged), 12):
            damaged[place] = int(random.integers(256))
        file = tmp_path / "bad.ttf"
        file.write_bytes(bytes(damaged) if number % 2 else content[: int(random.integers(400))])
        try:
            ss.read(file, text="A")
        except ss.InputError as error:
            assert_one_line(error, "bad.ttf")


@pytest.mark.parametrize(
    ("module", "words"), [("fontTools.ttLib", "reading fonts needs"), ("brotli", "needs brotli")]
)
def test_what_is_missing_is_said_with_the_command_that_installs_it(
    monkeypatch: pytest.MonkeyPatch, module: str, words: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ss.MissingExtraError, match=rf"{words}.*pip install 'splinesdf\[fonts\]'"):
        ss.read(FONTS / "inter-latin-wght-normal.woff2", text="A")


SOLID = {"Format": PaintFormat.PaintSolid, "PaletteIndex": 0, "Alpha": 1.0}
LAYERS = {"Format": PaintFormat.PaintGlyph, "Paint": SOLID, "Glyph": "space"}


@pytest.mark.parametrize("layers", [[("space", 0)], LAYERS], ids=["version 0", "version 1"])
def test_glyphs_in_layers_of_colors_are_refused(built: Callable[[], Path], layers: Any) -> None:
    path = built()
    font = TTFont(path)
    font["COLR"] = buildCOLR({"A": layers})
    font.save(path)
    with pytest.raises(ss.InputError, match="got 'A' in layers of colors"):
        ss.read(path, text="A")
    font["COLR"] = buildCOLR({".notdef": layers})
    font.save(path)
    assert ss.read(path, text="A").box == pytest.approx((0, 0, 900, 900))


def test_without_a_space_and_harfbuzz_letters_follow_at_once(
    monkeypatch: pytest.MonkeyPatch, built: Callable[[], Path]
) -> None:
    path = built()
    font = TTFont(path)
    for table in font["cmap"].tables:
        table.cmap.pop(32, None)  # two tables may be one
    font.save(path)
    monkeypatch.setitem(sys.modules, "uharfbuzz", None)
    assert ss.read(path, text="A\tA").box == pytest.approx((0, 0, 1900, 900))


def test_cubics_and_points_that_are_there_twice(tmp_path: Path) -> None:
    """Four cubics around a disk, to 3e-4 of its radius, and a line of no length."""
    pen, k = T2CharStringPen(1000, None), 552
    pen.moveTo((1000, 0))
    pen.lineTo((1000, 0))
    pen.curveTo((1000, k), (k, 1000), (0, 1000))
    pen.curveTo((-k, 1000), (-1000, k), (-1000, 0))
    pen.curveTo((-1000, -k), (-k, -1000), (0, -1000))
    pen.curveTo((k, -1000), (1000, -k), (1000, 0))
    pen.closePath()
    nothing, point = T2CharStringPen(1000, None), T2CharStringPen(1000, None)
    point.moveTo((500, 500))
    point.lineTo((500, 500))
    point.closePath()
    builder = FontBuilder(1000, isTTF=False)
    builder.setupGlyphOrder([".notdef", "A", "B"])
    builder.setupCharacterMap({65: "A", 66: "B"})
    # As drawn: optimized, the lines would be gone.
    strings = {
        name: pen.getCharString(optimize=False)
        for name, pen in ((".notdef", nothing), ("A", pen), ("B", point))
    }
    builder.setupCFF("Test", {}, strings, {})
    builder.setupHorizontalMetrics(dict.fromkeys(strings, (1000, 0)))
    builder.setupHorizontalHeader(ascent=900, descent=-100)
    builder.setupPost()
    builder.save(tmp_path / "a.otf")
    with pytest.raises(ss.InputError, match="something to see"):
        ss.read(tmp_path / "a.otf", text="B")
    _, seen_not = ss.atlas(tmp_path / "a.otf", characters="AB").glyphs
    assert (seen_not.name, seen_not.cell) == ("B", None)
    shape = ss.read(tmp_path / "a.otf", text="A")
    assert shape.piece_count == 4
    around = np.linspace(0.0, 2.0 * np.pi, 99)
    points = 1000.0 * np.stack([np.cos(around), np.sin(around)], axis=1)
    assert np.abs(ss.signed_distance(shape, points)).max() <= 0.3


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({}, "expected a text to read from a font"),
        ({"text": "漢A"}, "no glyph for '漢'"),
        ({"text": "  "}, "something to see"),
        ({"text": "A" * 10_001}, "up to 10,000 characters"),
        ({"text": 5}, "expected text as a text"),
        ({"text": "A", "size": 0}, "size"),
        ({"text": "A", "location": {"wght": 1}}, "the font is not variable"),
    ],
)
def test_what_cannot_be_read_is_refused(options: dict[str, Any], expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected):
        ss.read(DEJAVU, **options)
