"""Files that ask for more time and memory than there is: refused early, in one line."""

from __future__ import annotations

import dataclasses
import gzip
import io
import json
import math
import random
import re
import struct
import subprocess
import sys
import time
import zlib
from itertools import combinations, pairwise
from pathlib import Path

import brotli
import pytest
import shapely

import splinesdf as ss
from splinesdf.io.readers import svg_style
from tests.reading import assert_one_line

FONTS = Path(__file__).parents[1] / "data" / "fonts"


def _refused(file: Path, content: str | bytes, expected: str, **options: object) -> None:
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(ss.InputError, match=expected) as caught:
        ss.read(file, **options)
    assert_one_line(caught.value, file.name)


def _limited(file: Path, content: str | bytes, name: str, most: int, **options: object) -> None:
    """Read a file that asks for so much at that limit, and refuse it one below, by its name."""
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    ss.read(file, limits=ss.Limits(**{name: most}), **options)
    expected = re.escape(f"raise the limit: limits=Limits({name}=...), --limit {name}=...")
    limits = ss.Limits(**{name: most - 1})
    _refused(file, content, f"up to {most - 1:,} .*{expected}", limits=limits, **options)


POINTS = [(k, k * k % 97) for k in range(60)]


@pytest.mark.parametrize(
    ("name", "content", "limit", "most"),
    [
        ("a.csv", "\n".join(f"{x} {y}" for x, y in POINTS), "pieces", 60),
        ("a.dat", "\n".join(f"{x} {y}" for x, y in POINTS), "pieces", 60),
        ("a.wkt", f"POLYGON (({','.join(f'{x} {y}' for x, y in POINTS)}))", "pieces", 60),
        ("a.geojson", json.dumps({"type": "Polygon", "coordinates": [POINTS]}), "pieces", 60),
        ("a.svg", f"<svg><path d='M{' '.join(f'{x} {y}' for x, y in POINTS)}'/></svg>",
         "pieces", 60),
        ("a.svg", "<svg>" + "".join(f"<rect x='{3 * k}' width='1' height='1'/>"
                                    for k in range(15)) + "</svg>", "pieces", 60),
        ("a.svg", "<svg><path id='a' d='M0 0H1V1Z'/><use href='#a' x='3'/></svg>", "pieces", 6),
        ("a.svg", "<svg><clipPath id='a'><rect width='9' height='9'/></clipPath><path "
         "d='M0 0H1V1Z' clip-path='url(#a)'/></svg>", "pieces", 7),
        ("a.wkt", "POLYGON((0 0,1 0,0 1))", "bytes", 22),
        ("a.svgz", gzip.compress(b"<svg><path d='M0 0H1V1Z'/></svg>", mtime=0), "expanded", 32),
        ("a.svg", "<svg><path d='M0 0H1V1Z'/></svg>", "tags", 3),
        ("a.svg", "<svg><g a='' b='' c='' d=''><path d='M0 0H1V1Z'/></g></svg>", "tags", 5),
        ("a.wkt", "GEOMETRYCOLLECTION(" * 40 + "POLYGON((0 0,1 0,0 1))" + ")" * 40,
         "nesting", 40),
        ("a.geojson", '{"type":"GeometryCollection","geometries":[' * 40 + json.dumps(
            {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1]]]}) + "]}" * 40,
         "nesting", 40),
    ],
)  # fmt: skip
def test_a_file_is_read_up_to_each_limit(
    tmp_path: Path, name: str, content: str | bytes, limit: str, most: int
) -> None:
    _limited(tmp_path / name, content, limit, most)


def test_formulas_are_limited_in_sum(tmp_path: Path) -> None:
    circle = '{"x":"cos(t)+%d","y":"sin(t)"}'
    content = '{"loops":[' + ",".join(circle % (3 * k) for k in range(5)) + "]}"
    (tmp_path / "all.json").write_text(content)
    pieces = ss.read(tmp_path / "all.json").piece_count
    _limited(tmp_path / "a.json", content, "formulas", pieces)


def test_a_text_of_many_pieces(tmp_path: Path) -> None:
    name = "roboto-latin-400-normal.woff2"
    content = (FONTS / name).read_bytes()
    pieces = ss.read(FONTS / name, text="8888").piece_count
    _limited(tmp_path / name, content, "pieces", pieces, text="8888")


def test_a_path_of_many_commands_is_not_left_out_as_a_broken_one(tmp_path: Path) -> None:
    path = "<path d='M0 0" + "l1 1" * 30 + "'/><rect width='9' height='9'/>"
    (tmp_path / "a.svg").write_text(f"<svg xmlns='http://www.w3.org/2000/svg'>{path}</svg>")
    with pytest.raises(ss.InputError, match=r"Limits\(pieces="):
        ss.read(tmp_path / "a.svg", limits=ss.Limits(pieces=20))


def test_crossings_are_counted_before_there_is_memory_for_them() -> None:
    dice = random.Random(1)
    corners = [(dice.random(), dice.random()) for _ in range(3000)]  # 2,000,000 crossings
    began = time.process_time()
    with pytest.raises(ss.InputError, match="up to 300,000 crossings") as caught:
        _ = ss.Shape.from_points(corners).boundary
    assert "\n" not in str(caught.value)
    assert time.process_time() - began < 10.0


STAR = [(round(9 * math.cos(2.4 * k), 3), round(9 * math.sin(2.4 * k), 3)) for k in range(40)]


def _crossings(corners: list[tuple[float, float]]) -> int:
    """Of a polygon's sides, by shapely; none passes through a corner here."""
    lines = [shapely.LineString([a, b]) for a, b in pairwise([*corners, corners[0]])]
    return sum(a.crosses(b) for a, b in combinations(lines, 2))


def test_a_shape_keeps_the_limit_of_its_crossings(tmp_path: Path) -> None:
    file, count = tmp_path / "a.csv", _crossings(STAR)
    file.write_text("\n".join(f"{x} {y}" for x, y in STAR))
    tight = ss.read(file, limits=ss.Limits(crossings=count - 1))
    message = f"up to {count - 1:,} crossings and touching places.*Limits.crossings=...., --limit c"
    for _ in range(2):  # not only when it is first asked for
        with pytest.raises(ss.InputError, match=message):
            ss.signed_distance(tight, [0.0, 0.0])
    roomy = ss.read(file, limits=ss.Limits(crossings=count))
    assert ss.signed_distance(roomy, [0.0, 0.0]) == ss.signed_distance(
        ss.Shape.from_points(STAR), [0.0, 0.0]
    )
    mended = dataclasses.replace(tight, limits=ss.Limits(crossings=count))
    assert len(mended.boundary.start) == len(roomy.boundary.start)


def test_a_saved_fit_has_the_limits_of_who_reads_it(tmp_path: Path) -> None:
    """Not those of who wrote it: a file would raise them by itself."""
    file, count = tmp_path / "a.npz", _crossings(STAR)
    shape = ss.Shape.from_points(STAR)
    made = dataclasses.replace(shape, limits=ss.Limits(crossings=10**9, pieces=10**9))
    dataclasses.replace(ss.interpolate(shape, (2, 2)).spline, shape=made).save(file)
    usual, tight, roomy = (
        ss.load(file, limits=limits).shape
        for limits in (None, ss.Limits(crossings=count - 1), ss.Limits(crossings=count))
    )
    assert usual is not None
    assert tight is not None
    assert roomy is not None
    assert usual.limits == ss.Limits()
    with pytest.raises(ss.InputError, match=f"up to {count - 1:,} crossings"):
        ss.signed_distance(tight, [0.0, 0.0])
    assert ss.signed_distance(roomy, [0.0, 0.0]) == ss.signed_distance(shape, [0.0, 0.0])
    with pytest.raises(ss.InputError, match="expected limits such as"):
        ss.load(file, limits=9)  # type: ignore[arg-type]


def test_pairs_side_by_side_are_counted() -> None:
    corners = [
        corner
        for k in range(100)
        for corner in ((k * 1e-3, -k * 1e-3), (9 + k * 1e-3, 9 - k * 1e-3))
    ]
    shape = ss.Shape.from_points(corners)
    with pytest.raises(ss.InputError, match=r"1,000 pairs of arcs side by side.*--limit pairs="):
        _ = dataclasses.replace(shape, limits=ss.Limits(pairs=1000)).boundary
    _ = shape.boundary


def test_limits_are_those_of_one_reading(tmp_path: Path) -> None:
    file = tmp_path / "a.wkt"
    file.write_text("POLYGON((0 0,1 0,0 1))")
    for limits in (ss.Limits(pieces=2), ss.Limits(bytes=5)):
        with pytest.raises(ss.InputError):
            ss.read(file, limits=limits)
        assert ss.Shape.from_points(POINTS).limits == ss.Limits()
        assert ss.read(file).limits == ss.Limits()
    with pytest.raises(ss.InputError, match="limits such as"):
        ss.read(file, limits={"pieces": 5})
    with pytest.raises(ss.InputError, match="limits such as"):
        dataclasses.replace(ss.read(file), limits=5)
    for wrong in ({"pieces": 0}, {"bytes": 1.5}, {"nesting": 5000}, {"crossings": math.nan}):
        with pytest.raises(ss.InputError, match=f"the limit '{min(wrong)}'"):
            ss.Limits(**wrong)


def test_the_usual_limits_are_those_of_the_docs() -> None:
    page = (Path(__file__).parents[2] / "docs" / "files.md").read_text()
    rows = dict(re.findall(r"^\| `(\w+)` \|.*\| ([\d,]+) \|$", page, re.MULTILINE))
    assert {name: int(number.replace(",", "")) for name, number in rows.items()} == (
        dataclasses.asdict(ss.Limits())
    )


def test_uses_of_uses_are_counted(tmp_path: Path) -> None:
    groups = "".join(f"<g id='a{k + 1}'>" + f"<use href='#a{k}'/>" * 20 + "</g>" for k in range(9))
    content = (
        f"<svg><defs><rect id='a0' width='1' height='1'/>{groups}</defs><use href='#a9'/></svg>"
    )
    _refused(tmp_path / "a.svg", content, "2,000 elements", limits=ss.Limits(elements=2000))


def test_clips_within_clips_are_counted(tmp_path: Path) -> None:
    content = (
        "<svg><clipPath id='c'><rect width='99' height='99'/></clipPath>"
        + "<g clip-path='url(#c)'>" * 200
        + "<rect width='5' height='5'/>" * 600
        + "</g>" * 200
        + "</svg>"
    )
    _refused(tmp_path / "a.svg", content, "up to 100,000 clips")
    clip = "<clipPath id='c'><rect width='9' height='9'/></clipPath>"
    group = "<g clip-path='url(#c)'><rect width='5' height='5'/><rect width='7' height='7'/></g>"
    _limited(tmp_path / "b.svg", f"<svg>{clip}{group * 3}</svg>", "clips", 6)


def test_rules_times_elements_are_counted(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(svg_style, "_MOST_MATCHES", 1000)
    rules = "*{fill:red}" * 40
    content = f"<svg><style>{rules}</style>{'<g/>' * 40}</svg>"
    _refused(tmp_path / "a.svg", content, "up to 1,000 matches of rules and elements")


# Reads each file with so many more bytes of memory than it has, and so many seconds of processor.
_READ = """
import pathlib, resource, sys
import splinesdf as ss
triangle = ss.Shape.from_points([(0, 0), (1, 0), (0, 1)])
ss.signed_distance(triangle, (0.0, 0.0))  # loads what is loaded when it is used
have = int(pathlib.Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (have + int(sys.argv[1]), have + int(sys.argv[1])))
resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
for name in sys.argv[2:]:
    try:
        ss.signed_distance(ss.read(name, **({"text": "A"} if "woff" in name else {})), (0.0, 0.0))
        print("read")
    except ss.InputError as error:
        print(error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited as Linux does it")
def test_small_files_that_ask_for_much_are_refused_before_the_memory_is_gone(
    tmp_path: Path,
) -> None:
    dice = random.Random(1)
    chords = " ".join(f"{dice.random():.3f} {dice.random():.3f}" for _ in range(3000))
    files = {
        "crossings.svg": (f"<svg><path d='M{chords}'/></svg>", "up to 300,000 crossings"),
        "packed.svgz": (_packed(b"<svg>", 300_000_000), "up to 100,000,000 bytes, unpacked"),
        "packed.woff": (_packed_font(300_000_000), "up to 100,000,000 bytes of a font"),
        "deep.wkt": ("GEOMETRYCOLLECTION(" * 100_000, "up to 100 geometries"),
        "deep.geojson": ("[" * 100_000, "expected GeoJSON"),
        "entities.svg": ("<!DOCTYPE svg [<!ENTITY a 'aaaaaaaaaa'>" + "".join(
            f"<!ENTITY {b} '&{a};&{a};&{a};&{a};&{a};&{a};'>" for a, b in pairwise("abcdefghijkl"))
            + "]><svg>&l;</svg>", "entities that are plain texts"),
    }  # fmt: skip
    for name, (content, _) in files.items():
        (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    with (tmp_path / "long.csv").open("wb") as file:
        file.truncate(2**40)
    names = [*files, "long.csv"]
    command = [sys.executable, "-W", "error", "-c", _READ, "400000000"]
    done = subprocess.run(
        [*command, *(str(tmp_path / name) for name in names)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    expected = [words for _, words in files.values()] + ["up to 50,000,000 bytes"]
    for line, words in zip(done.stdout.splitlines(), expected, strict=True):
        assert words in line


def _packed(start: bytes, spaces: int, wbits: int = 31) -> bytes:
    """Packed text that ends in many spaces; there is never all of it."""
    pack = zlib.compressobj(1, wbits=wbits)
    blocks = [pack.compress(b" " * 1_000_000) for _ in range(spaces // 1_000_000)]
    return pack.compress(start) + b"".join(blocks) + pack.flush()


def _packed_font(size: int) -> bytes:
    """The header of a packed font, and a table that unpacks to so much."""
    table = _packed(b"", size, wbits=15)
    head = struct.pack(">4sIIHHIHHIIIII", b"wOFF", 0x10000, 64 + len(table), 1, *[0] * 9)
    return head + struct.pack(">4sIIII", b"glyf", 64, len(table), size, 0) + table


@pytest.mark.parametrize(
    "name", ["roboto-latin-400-normal.woff2", "noto-serif-latin-400-normal.woff"]
)
def test_a_packed_font_that_is_too_large(tmp_path: Path, name: str) -> None:
    content, tight = (FONTS / name).read_bytes(), ss.Limits(expanded=10_000)
    _refused(tmp_path / name, content, "up to 10,000 bytes of a font", text="A", limits=tight)


def test_a_packed_font_is_unpacked_in_parts_up_to_the_limit(tmp_path: Path) -> None:
    """Three million zeros in a few bytes; and bytes that are not packed."""
    file = tmp_path / "a.woff2"
    for packed, expected in (
        (brotli.compress(bytes(3_000_000)), r"up to 2,000,000 bytes of a font"),
        (b"not packed by brotli", "expected a font, got one that cannot be read"),
    ):
        header = b"wOF2" + bytes(16) + len(packed).to_bytes(4, "big") + bytes(24)
        file.write_bytes(header + packed)
        with pytest.raises(ss.InputError, match=expected):
            ss.read(file, text="A", limits=ss.Limits(expanded=2_000_000))


def test_glyphs_within_glyphs_are_counted(tmp_path: Path) -> None:
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
    tight = ss.Limits(pieces=5000)
    _refused(tmp_path / "a.ttf", plain.getvalue(), "up to 5,000 pieces", text="A", limits=tight)


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
    _refused(tmp_path / "a.dxf", content, "up to 200,000 entities")


def test_entities_of_a_drawing_are_counted(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new()
    for k in range(7):
        document.modelspace().add_circle((3 * k, 0), 1)
    document.saveas(tmp_path / "source.dxf")
    content = (tmp_path / "source.dxf").read_bytes()
    _limited(tmp_path / "a.dxf", content, "elements", 7)


def test_a_damaged_drawing_is_refused_in_words_that_can_be_printed(tmp_path: Path) -> None:
    _refused(tmp_path / "a.svg", "<svg xmlns='a\x7fb'/>", "with the root <{a[?]b}svg>")
    _refused(tmp_path / "a.dxf", b"9\n\x7f\x01\xff\xffMFERC\n4 \n$", "damaged one")
    with pytest.raises(ss.InputError) as caught:
        ss.read(tmp_path / "a.dxf")
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("limit", [f.name for f in dataclasses.fields(ss.Limits)])
def test_a_limit_beyond_all_files_costs_nothing(tmp_path: Path, limit: str) -> None:
    file = tmp_path / "a.svgz"
    file.write_bytes(gzip.compress(b"<svg><path d='M0 0H1V1Z'/></svg>", mtime=0))
    most = 300 if limit == "nesting" else 2**53
    shape = ss.read(file, limits=ss.Limits(**{limit: most}))
    assert ss.signed_distance(shape, (1.0, 0.5)) == 0.0
    with pytest.raises(ss.InputError, match=f"the limit '{limit}' from 1 to {most:,}, got"):
        ss.Limits(**{limit: 1e30})


def test_a_file_that_is_too_long_is_told_nothing_else(tmp_path: Path) -> None:
    _refused(tmp_path / "a.wkt", "POLYGON((0 0,1 0,0 1))", r"^a.wkt: expected a file of up to 9 b",
             limits=ss.Limits(bytes=9))  # fmt: skip
    _refused(tmp_path / "a.json", '{"x": "cos(t)", "y": "sin(t)"}', "up to 9 pieces of all form",
             limits=ss.Limits(formulas=9))  # fmt: skip
