"""The good files that `benchmarks.fuzz` breaks, of each reader: tests/data and a few of its own."""

from __future__ import annotations

import gzip
import io
import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import splinesdf as ss
from benchmarks.mutations import FONTS

_DATA = Path(__file__).parents[1] / "tests" / "data"
_SHIPPED = Path(ss.__file__).parent / "data"
# Files longer than this are no seeds: most of a time limit would go to what is right in them.
_LONGEST = 20_000

_SVG = (
    "<svg viewBox='0 0 9 9'><path d='M0 0H4V4H0Z'/><rect x='5' width='3' height='3' rx='1'/></svg>",
    "<svg viewBox='0 0 9 9'><clipPath id='a'><circle cx='4' cy='4' r='3'/></clipPath>"
    "<g clip-path='url(#a)' transform='rotate(30 4 4)'><rect width='5' height='9'/></g></svg>",
    "<svg viewBox='0 0 9 9'><mask id='a'><rect width='9' height='9' fill='white'/><circle cx='4' "
    "cy='4' r='2'/></mask><ellipse cx='4' cy='4' rx='4' ry='3' mask='url(#a)'/></svg>",
    "<svg><symbol id='a' viewBox='0 0 2 2'><polygon points='0,0 2,0 1,2'/></symbol><use href='#a' "
    "x='1' width='3' height='4'/><svg x='2' width='50%' height='2em'><circle r='1'/></svg></svg>",
    "<svg><style>.a{fill:none;stroke:red}#b{fill:#000!important}</style><path class='a' d='M0 0L4 "
    "0 0 4'/><path id='b' class='a' d='m1 1a2 1 30 1 0 2 2q1 1 2 0t2 0s1 1 2 2c0 1 2 3 4 "
    "4z'/></svg>",
)  # fmt: skip
_JSON = (
    {"x": "cos(t)", "y": "sin(t)"},
    {"x": "2*cos(t)^3", "y": "abs(sin(t))^1.5*sin(t)", "t": [0, "2*pi"], "fill": "evenodd"},
    {"sections": [{"x": "t", "y": "t^2", "t": [-1, 1]}, {"x": "1-t", "y": "1", "t": [0, 2]}]},
    {"loops": [{"x": "3*cos(t)", "y": "3*sin(t)"}, {"x": "cos(t)/2", "y": "min(sin(t), 0.5)"}]},
)
_GEOJSON = (
    '{"type":"Polygon","coordinates":[[[0,0],[9,0],[9,9],[0,9],[0,0]],[[2,2],[2,3],[3,3],[2,2]]]}',
    '{"type":"FeatureCollection","features":[{"type":"Feature","geometry":{"type":"MultiPolygon",'
    '"coordinates":[[[[0,0],[4,0],[4,4],[0,0]]],[[[2,0],[6,0],[6,4],[2,0]]]]},"properties":{}}]}',
)  # fmt: skip
_WKT = (
    "POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (2 2, 3 2, 3 3, 2 2))",
    "SRID=4326;GEOMETRYCOLLECTION(MULTIPOLYGON(((0 0,4 0,4 4,0 0)),((2 0,6 0,6 4,2 "
    "0))),POINT(1 1))",
)  # fmt: skip
_CSV = ("x,y\n0,0\n4,0\n4,3\n\n1,1\n2,1\n2,2\n", "0;0\n4,5;0\n4;3\n", "0 0\n4 0\n4 4\n0 4\n")
# Of the first kind that programs wrote, which needs no tables: short, so that numbers are struck.
_DXF = tuple(
    "0\nSECTION\n2\n" + "ENDSEC\n0\nSECTION\n2\n".join(sections) + "ENDSEC\n0\nEOF\n"
    for sections in (
        (
            "ENTITIES\n0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n5\n0\nLINE\n8\na\n10\n9\n20\n0\n11\n12\n21"
            "\n0\n0\nLINE\n8\na\n10\n12\n20\n0\n11\n9\n21\n4\n0\nARC\n8\na\n10\n9\n20\n2\n40\n2\n50\n90\n"
            "51\n270\n0\n",
        ),
        (
            "BLOCKS\n0\nBLOCK\n8\n0\n2\nb\n70\n0\n10\n0\n20\n0\n0\nCIRCLE\n8\n0\n10\n1\n20\n0\n40\n1\n"
            "0\nENDBLK\n0\n",
            "ENTITIES\n0\nINSERT\n8\n0\n2\nb\n10\n3\n20\n4\n41\n2\n42\n-1\n50\n30\n70\n2\n44\n5\n0\n",
        ),
        (
            "ENTITIES\n0\nPOLYLINE\n8\n0\n66\n1\n70\n1\n0\nVERTEX\n8\n0\n10\n0\n20\n0\n42\n0.5\n0\nVERTEX"
            "\n8\n0\n10\n4\n20\n0\n0\nVERTEX\n8\n0\n10\n4\n20\n3\n42\n-0.2\n0\nSEQEND\n0\n",
        ),
        (
            "ENTITIES\n0\nLWPOLYLINE\n8\n0\n90\n3\n70\n1\n10\n0\n20\n0\n10\n4\n20\n0\n42\n1\n10\n4\n20\n3\n0"
            "\nELLIPSE\n8\n0\n10\n9\n20\n0\n30\n0\n11\n2\n21\n1\n31\n0\n40\n0.5\n41\n0\n42\n6.283185307179586"
            "\n0\nSPLINE\n8\n0\n70\n8\n71\n3\n72\n8\n73\n4\n40\n0\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1"
            "\n40\n1\n10\n0\n20\n5\n10\n9\n20\n5\n10\n0\n20\n9\n10\n0\n20\n5\n0\n",
        ),
    )
)  # fmt: skip
_DAT = ("NACA\n1 0\n0.5 0.1\n0 0\n0.5 -0.1\n1 0\n", "a\n1 0\n0 1\n0 0\n999. 999.\n3 3\n4 3\n3 4\n")


def seeds(reader: str) -> list[bytes]:
    """Files of a reader, by its ending; ``.npz`` is `load`."""
    files = [*sorted(_DATA.glob("files/*" + reader)), *sorted(_SHIPPED.glob("*" + reader))]
    if reader == ".svg":
        files += [f for f in sorted(_DATA.glob("drawings/*/*.svg"))[::5] if _fills(f)] + sorted(
            _DATA.glob("*.svg")
        )
    found = [content for file in files if len(content := file.read_bytes()) <= _LONGEST]
    if reader in (".csv", ".dat"):
        found = [content for content in found if len(content) <= _LONGEST // 4]
    own: dict[str, list[bytes]] = {
        ".svg": [text.encode() for text in _SVG],
        ".json": [json.dumps(content).encode() for content in _JSON],
        ".geojson": [text.encode() for text in _GEOJSON],
        ".wkt": [text.encode() for text in _WKT],
        ".csv": [text.encode() for text in _CSV],
        ".dat": [text.encode() for text in _DAT],
    }
    if reader == ".svgz":
        found += [gzip.compress(text.encode(), mtime=0) for text in _SVG]
    if reader == ".npz":
        found += _saved()
    if reader in FONTS:
        found = _fonts(reader)
    if reader == ".dxf":
        found += 4 * [text.encode() for text in _DXF]
    return found + own.get(reader, [])


# Fonts of two kinds of outlines: one that is variable, and one that is not.
_FONTS = ("inter-latin-wght-normal.woff2", "roboto-latin-400-normal.woff2")
_FLAVORS = {".woff": "woff", ".woff2": "woff2"}


def _fonts(reader: str) -> list[bytes]:
    """Fonts of a few letters: what a changed byte strikes is then often what is read."""
    from fontTools import subset
    from fontTools.ttLib import TTCollection, TTFont

    fonts = []
    for name in _FONTS:
        font = TTFont(_DATA / "fonts" / name)
        chosen = subset.Subsetter()
        chosen.populate(text="Ag8\u00e9 ")
        chosen.subset(font)
        font.flavor = None
        fonts.append(font)
    if reader == ".otf":
        fonts = [_with_cubics(font) for font in fonts]
    if reader == ".ttc":
        collection = TTCollection()
        collection.fonts = fonts[::-1]
        return [_bytes_of(collection)]
    for font in fonts:
        font.flavor = _FLAVORS.get(reader)
    return [_bytes_of(font) for font in fonts]


def _bytes_of(font: Any) -> bytes:
    result = io.BytesIO()
    font.save(result)
    return result.getvalue()


def _with_cubics(font: Any) -> Any:
    """A font of the same letters with the outlines of PostScript."""
    from fontTools.fontBuilder import FontBuilder
    from fontTools.pens.qu2cuPen import Qu2CuPen
    from fontTools.pens.t2CharStringPen import T2CharStringPen

    glyphs, drawn = font.getGlyphSet(), {}
    for name in font.getGlyphOrder():
        pen = T2CharStringPen(glyphs[name].width, glyphs)
        glyphs[name].draw(Qu2CuPen(pen, 1.0, all_cubic=True))
        drawn[name] = pen.getCharString()
    builder = FontBuilder(font["head"].unitsPerEm, isTTF=False)
    builder.setupGlyphOrder(font.getGlyphOrder())
    builder.setupCharacterMap(font.getBestCmap())
    builder.setupCFF("Test", {}, drawn, {})
    builder.setupHorizontalMetrics({name: (int(glyphs[name].width), 0) for name in drawn})
    head = font["hhea"]
    builder.setupHorizontalHeader(ascent=head.ascent, descent=head.descent)
    builder.setupNameTable({"familyName": "Test", "styleName": "Regular"})
    builder.setupOS2()
    builder.setupPost()
    return builder.font


def _saved() -> list[bytes]:
    """Saved fits: on a quadtree, on a grid, and one of version 1."""
    disc = ss.Shape.from_formula("cos(t)", "sin(t)")
    found = [(_DATA / "saved_version_1.npz").read_bytes()]
    with tempfile.TemporaryDirectory() as folder:
        for k, fit in enumerate(
            (ss.fit(disc, tolerance=0.05), ss.fit(disc, tolerance=0.2, space="tensor"))
        ):
            path = Path(folder) / f"{k}.npz"
            fit.spline.save(path)
            found.append(path.read_bytes())
    return found


def as_member(content: bytes) -> bytes:
    """Bytes as the ``.npy`` of an array of bytes."""
    result = io.BytesIO()
    np.lib.format.write_array(result, np.frombuffer(content, dtype=np.uint8), allow_pickle=False)
    return result.getvalue()


def _fills(file: Path) -> bool:
    """Whether a drawing is more than strokes, which are refused."""
    return file.parent.name not in ("feather", "tabler-outline")
