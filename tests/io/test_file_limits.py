"""Files that ask for more time and memory than there is: refused early, in one line."""

from __future__ import annotations

import gzip
import io
import json
import random
import time
from pathlib import Path

import pytest

import splinesdf as ss
from splinesdf.arclets import crossings
from splinesdf.io.readers import dxf, fonts_packed, formulas, svg_document, svg_style, svg_walk
from splinesdf.shapes import loops
from tests.reading import assert_one_line

FONTS = Path(__file__).parents[1] / "data" / "fonts"


def _refused(file: Path, content: str | bytes, expected: str, **options: object) -> None:
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(ss.InputError, match=expected) as caught:
        ss.read(file, **options)
    assert_one_line(caught.value, file.name)


POINTS = [(k, k * k % 97) for k in range(60)]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.csv", "\n".join(f"{x} {y}" for x, y in POINTS)),
        ("a.dat", "\n".join(f"{x} {y}" for x, y in POINTS)),
        ("a.wkt", f"POLYGON (({','.join(f'{x} {y}' for x, y in POINTS)}))"),
        ("a.geojson", json.dumps({"type": "Polygon", "coordinates": [POINTS]})),
        ("a.svg", f"<svg><path d='M{' '.join(f'{x} {y}' for x, y in POINTS)}'/></svg>"),
        ("a.svg", "<svg>" + "<rect width='1' height='1'/>" * 15 + "</svg>"),
        ("a.svg", "<svg><circle id='a' r='1'/><use href='#a'/></svg>"),
        ("b.svg", "<svg><clipPath id='a'><circle r='1'/></clipPath>"
         + "<path d='M0 0H1V1' clip-path='url(#a)'/>" * 2 + "</svg>"),
        ("a.json", '{"loops":[{"x":"cos(t)","y":"sin(t)"},{"x":"9+cos(t)","y":"sin(t)"}]}'),
    ],
)  # fmt: skip
def test_pieces_are_counted(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str, content: str
) -> None:
    monkeypatch.setattr(loops, "MOST_PIECES", 50)
    monkeypatch.setattr(formulas, "_MOST_PIECES", 20)
    expected = "up to 20 pieces in all" if name == "a.json" else "at most 50 pieces and corners"
    _refused(tmp_path / name, content, expected)


def test_a_text_of_many_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loops, "MOST_PIECES", 60)
    with pytest.raises(ss.InputError, match="at most 60 pieces"):
        ss.read(FONTS / "roboto-latin-400-normal.woff2", text="8888")


def test_crossings_are_counted_before_there_is_memory_for_them() -> None:
    dice = random.Random(1)
    corners = [(dice.random(), dice.random()) for _ in range(3000)]  # 2,000,000 crossings
    began = time.process_time()
    with pytest.raises(ss.InputError, match="up to 300,000 crossings") as caught:
        _ = ss.Shape.from_points(corners).boundary
    assert "\n" not in str(caught.value)
    assert time.process_time() - began < 10.0


def test_pairs_side_by_side_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crossings, "_MOST", (300_000, 1000))
    corners = [
        corner
        for k in range(100)
        for corner in ((k * 1e-3, -k * 1e-3), (9 + k * 1e-3, 9 - k * 1e-3))
    ]
    with pytest.raises(ss.InputError, match="1,000 pairs of arcs side by side"):
        _ = ss.Shape.from_points(corners).boundary


def test_uses_of_uses_are_counted(tmp_path: Path) -> None:
    groups = "".join(f"<g id='a{k + 1}'>" + f"<use href='#a{k}'/>" * 20 + "</g>" for k in range(9))
    content = (
        f"<svg><defs><rect id='a0' width='1' height='1'/>{groups}</defs><use href='#a9'/></svg>"
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(svg_walk, "_MOST_DRAWN", 2000)
        _refused(tmp_path / "a.svg", content, "at most 2,000 elements drawn")


def test_clips_within_clips_are_counted(tmp_path: Path) -> None:
    content = (
        "<svg><clipPath id='c'><rect width='99' height='99'/></clipPath>"
        + "<g clip-path='url(#c)'>" * 200
        + "<rect width='5' height='5'/>" * 600
        + "</g>" * 200
        + "</svg>"
    )
    _refused(tmp_path / "a.svg", content, "clipped up to 100,000 times")


@pytest.mark.parametrize(
    ("names", "content", "expected"),
    [
        ("_MOST_TAGS", "<svg>" + "<g/>" * 200 + "</svg>", "up to 100 tags"),
        ("_MOST_ATTRIBUTES", "<svg>" + "<g a='1' b='2'/>" * 80 + "</svg>", "up to 100 attributes"),
    ],
)
def test_tags_and_attributes_are_counted(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, names: str, content: str, expected: str
) -> None:
    monkeypatch.setattr(svg_document, names, (100, expected.split()[-1]))
    _refused(tmp_path / "a.svg", content, expected)


def test_rules_times_elements_are_counted(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(svg_style, "_MOST_MATCHES", 1000)
    rules = "*{fill:red}" * 40
    content = f"<svg><style>{rules}</style>{'<g/>' * 40}</svg>"
    _refused(tmp_path / "a.svg", content, "up to 1,000 matches of rules and elements")


def test_a_packed_drawing_that_is_too_large(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(svg_document, "_MOST_UNPACKED", 1000)
    content = gzip.compress(b"<svg>" + b" " * 2000 + b"</svg>")
    _refused(tmp_path / "a.svgz", content, "up to 1,000 bytes")


@pytest.mark.parametrize(
    "name", ["roboto-latin-400-normal.woff2", "noto-serif-latin-400-normal.woff"]
)
def test_a_packed_font_that_is_too_large(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str
) -> None:
    content = (FONTS / name).read_bytes()
    monkeypatch.setattr(fonts_packed, "_MOST_UNPACKED", 10_000)
    _refused(tmp_path / name, content, "packed font of up to 10,000 bytes", text="A")


def test_glyphs_within_glyphs_are_counted(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from fontTools.fontBuilder import FontBuilder
    from fontTools.pens.ttGlyphPen import TTGlyphPen

    glyphs = {".notdef": TTGlyphPen(None).glyph()}  # empty: there are no pieces to count
    for k in range(6):
        pen = TTGlyphPen(glyphs)
        for _ in range(10):
            pen.addComponent(".notdef" if k == 0 else f"g{k - 1}", (1, 0, 0, 1, 0, 0))
        glyphs[f"g{k}"] = pen.glyph()
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder(list(glyphs))
    builder.setupCharacterMap({65: "g5"})
    builder.setupGlyf(glyphs)
    builder.setupHorizontalMetrics(dict.fromkeys(glyphs, (500, 0)))
    builder.setupHorizontalHeader()
    builder.setupMaxp()
    plain = io.BytesIO()
    builder.save(plain)
    monkeypatch.setattr(loops, "MOST_PIECES", 5000)
    _refused(tmp_path / "a.ttf", plain.getvalue(), "at most 5,000 pieces", text="A")


@pytest.mark.parametrize("depth", [1, 6])
def test_arrays_of_blocks_are_counted(tmp_path: Path, depth: int) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new()
    document.blocks.new("B0")  # empty: no entity would ever come
    count = {
        "row_count": 30_000 if depth == 1 else 10,
        "column_count": 30_000 if depth == 1 else 10,
    }
    space = {"row_spacing": 1, "column_spacing": 1}
    for k in range(1, depth):
        document.blocks.new(f"B{k}").add_blockref(f"B{k - 1}", (0, 0), dxfattribs=count | space)
    document.modelspace().add_blockref(f"B{depth - 1}", (0, 0), dxfattribs=count | space)
    document.saveas(tmp_path / "source.dxf")
    content = (tmp_path / "source.dxf").read_bytes()
    _refused(tmp_path / "a.dxf", content, f"at most {dxf._MOST_ENTITIES:,} entities")


def test_a_damaged_drawing_is_refused_in_words_that_can_be_printed(tmp_path: Path) -> None:
    _refused(tmp_path / "a.svg", "<svg xmlns='a\x7fb'/>", "with the root <{a[?]b}svg>")
    _refused(tmp_path / "a.dxf", b"9\n\x7f\x01\xff\xffMFERC\n4 \n$", "damaged one")
    with pytest.raises(ss.InputError) as caught:
        ss.read(tmp_path / "a.dxf")
    assert str(caught.value).isprintable()
