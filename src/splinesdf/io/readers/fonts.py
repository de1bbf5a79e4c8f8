"""Fonts: a text as a shape, each glyph filled by the rule nonzero, y pointing up.

    text ──shaping: glyphs and places──> outlines at a variable font's location ──> regions, united

fontTools reads outlines; uharfbuzz, if it is installed, places glyphs as programs for writing do,
with kerning and ligatures. Without it glyphs follow one another by their widths, and a note says
so.
"""

from __future__ import annotations

import io
import logging
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from splinesdf.errors import InputError, MissingExtraError
from splinesdf.io.readers.fonts_packed import check_unpacked
from splinesdf.io.readers.reading import Part, Reading
from splinesdf.io.readers.source import Options, Source, printable
from splinesdf.shapes.loops import check_count
from splinesdf.shapes.region import Loops, region

# Characters of a text. More: a novel by mistake; each glyph is a dozen curves.
_MOST_CHARACTERS = 10_000
_COLORED = {
    "COLR": "layers of colors",
    "SVG ": "SVG drawings",
    "CBDT": "pictures",
    "sbix": "pictures",
}


class _Placed(NamedTuple):
    """A glyph and where its origin is, in font units."""

    name: str
    x: float
    y: float
    text: str  # the characters that it stands for


def font_reading(source: Source, options: Options) -> Reading:
    """The text in the font, an element for each glyph that is placed."""
    if options.text is None:
        raise InputError("expected a text to read from a font: pass text='...' (--text)")
    if len(options.text) > _MOST_CHARACTERS:
        raise InputError(
            f"expected a text of up to {_MOST_CHARACTERS:,} characters, got {len(options.text):,}"
        )
    with readable():
        font = opened(source.content)
        names, parts, notes = _parts(font, source.content, options)
    text = options.text[:40]
    nothing = f"expected a text with something to see, got {text!r}"
    return Reading(text, names, parts, [], notes=notes, nothing=nothing)


@contextmanager
def readable() -> Iterator[None]:
    """An `InputError` for whatever a damaged font makes its reader run into."""
    try:
        yield
    except (InputError, MissingExtraError):
        raise
    except Exception as error:
        raise InputError(
            f"expected a font, got one that cannot be read ({type(error).__name__})"
        ) from error


def _parts(
    font: Any, content: bytes, options: Options
) -> tuple[list[str], list[Part], tuple[str, ...]]:
    """What the glyphs are called, each one's loops, inside on the left, and what is to be said."""
    assert options.text is not None
    location = checked_location(font, options.location)
    _check_characters(font, options.text)
    placed, notes = _placed(font, content, options.text, location)
    check_colors(font, {glyph.name for glyph in placed})
    glyphs = font.getGlyphSet(location=location)
    units = float(font["head"].unitsPerEm)
    scale = 1.0 if options.size is None else options.size / units
    regions: dict[str, Loops] = {}
    parts: list[Part] = []
    pieces = 0
    for number, (name, x, y, _) in enumerate(placed):
        if name not in regions:
            regions[name] = region(outline(glyphs, name), options.fill or "nonzero")
        shift = np.array([x, y])
        loops = [[scale * (piece + shift) for piece in loop] for loop in regions[name]]
        if loops:
            parts.append(Part(number, loops))
        pieces += sum(map(len, regions[name]))
        check_count(pieces)
    return [glyph.text for glyph in placed], parts, notes


def opened(content: bytes) -> Any:
    """The font, as fontTools reads it, or an `InputError`."""
    try:
        from fontTools.ttLib import TTFont, TTLibError
    except ImportError as error:
        raise MissingExtraError(
            "reading fonts needs fontTools: pip install 'splinesdf[fonts]'"
        ) from error
    # What it says of a damaged font goes to the screen otherwise.
    logging.getLogger("fontTools").setLevel(logging.CRITICAL)
    try:
        check_unpacked(content)
        font = TTFont(io.BytesIO(content), fontNumber=0, lazy=True)
        font["head"], font["cmap"], font["hmtx"]
    except ImportError as error:
        raise MissingExtraError(
            "reading woff2 fonts needs brotli: pip install 'splinesdf[fonts]'"
        ) from error
    except (TTLibError, KeyError) as error:
        raise InputError(
            f"expected a font, got a damaged one or none: {printable(error, 80)}"
        ) from error
    if not any(table in font for table in ("glyf", "CFF ", "CFF2")):
        kinds = [words for table, words in _COLORED.items() if table in font]
        raise InputError(f"expected a font with outlines, got {kinds[0] if kinds else 'none'}")
    return font


def checked_location(font: Any, asked: Mapping[str, float] | None) -> dict[str, float]:
    """The location of a variable font, or an `InputError`."""
    if not asked:
        return {}
    axes = {axis.axisTag: axis for axis in font["fvar"].axes} if "fvar" in font else {}
    for tag, value in asked.items():
        if tag not in axes:
            known = ", ".join(axes) or "none, as the font is not variable"
            raise InputError(f"expected axes of {known}, got {tag!r:.20}")
        low, high = axes[tag].minValue, axes[tag].maxValue
        if not low <= value <= high:
            raise InputError(f"expected {tag} from {low:g} to {high:g}, got {value:g}")
    return dict(asked)


def _check_characters(font: Any, text: str) -> None:
    known = font.getBestCmap() or {}
    missing = sorted({c for c in text if ord(c) not in known and not c.isspace()})
    if missing:
        raise InputError(f"the font has no glyph for {', '.join(map(repr, missing[:5]))}")


def check_colors(font: Any, names: set[str]) -> None:
    """Refuse glyphs that are drawn in colors: their outline may be anything."""
    if "COLR" not in font:
        return
    table = font["COLR"]
    if table.version == 0:
        colored = names & set(table.ColorLayers)
    else:
        records = getattr(table.table, "BaseGlyphList", None)
        colored = names & {r.BaseGlyph for r in records.BaseGlyphPaintRecord} if records else set()
    if colored:
        raise InputError(f"expected glyphs of one color, got {min(colored)!r} in layers of colors")


def _placed(
    font: Any, content: bytes, text: str, location: dict[str, float]
) -> tuple[list[_Placed], tuple[str, ...]]:
    """Glyphs in order, line under line, and what is to be said."""
    head = font["hhea"]
    below = float(head.ascent - head.descent + head.lineGap)
    lines = text.replace("\r\n", "\n").split("\n")
    try:
        import uharfbuzz
    except ImportError:
        glyphs, known = font.getGlyphSet(location=location), font.getBestCmap()
        placed = []
        for number, line in enumerate(lines):
            x = 0.0
            for character in line:
                name = known.get(ord(character), known.get(32))
                if name is None:
                    continue
                placed.append(_Placed(name, x, -number * below, character))
                x += float(glyphs[name].width)
        note = "no kerning or ligatures: glyphs are placed by their widths, as uharfbuzz is missing"
        return placed, (note,) if len(text) > 1 else ()
    order = font.getGlyphOrder()
    shaper = uharfbuzz.Font(uharfbuzz.Face(unpacked(font, content)))
    if location:
        shaper.set_variations(location)
    placed = []
    for number, line in enumerate(lines):
        buffer = uharfbuzz.Buffer()
        buffer.add_str(line)
        buffer.guess_segment_properties()
        uharfbuzz.shape(shaper, buffer)
        x, y = 0.0, -number * below
        infos = buffer.glyph_infos or []
        # Each glyph stands for the characters from its cluster on to the next one.
        clusters = [*sorted({info.cluster for info in infos}), len(line)]
        stops = dict(pairwise(clusters))
        for info, at in zip(infos, buffer.glyph_positions or [], strict=True):
            characters = line[info.cluster : stops[info.cluster]]
            place = x + at.x_offset, y + at.y_offset
            placed.append(_Placed(order[info.codepoint], *place, characters))
            x, y = x + at.x_advance, y + at.y_advance
    return placed, ()


def unpacked(font: Any, content: bytes) -> bytes:
    """The font as HarfBuzz reads it, which knows no packed ones."""
    if content[:4] not in (b"wOFF", b"wOF2"):
        return content
    plain = io.BytesIO()
    flavor, font.flavor = font.flavor, None
    font.save(plain, reorderTables=False)
    font.flavor = flavor
    return plain.getvalue()


def outline(glyphs: Any, name: str) -> Loops:
    """A glyph's contours, components and implied points resolved."""
    from fontTools.pens.basePen import BasePen

    loops: Loops = []
    counts = {"parts": 0}

    def count() -> None:
        counts["parts"] += 1
        check_count(counts["parts"])

    class Pen(BasePen):  # type: ignore[misc]
        def addComponent(self, *arguments: Any, **named: Any) -> None:  # noqa: N802
            count()  # a few lines of glyphs within glyphs take all time
            super().addComponent(*arguments, **named)

        def _moveTo(self, point: tuple[float, float]) -> None:  # noqa: N802
            loops.append([])

        def _lineTo(self, point: tuple[float, float]) -> None:  # noqa: N802
            self._piece(point)

        def _curveToOne(self, *points: tuple[float, float]) -> None:  # noqa: N802
            self._piece(*points)

        def _qCurveToOne(self, *points: tuple[float, float]) -> None:  # noqa: N802
            self._piece(*points)

        def _piece(self, *points: tuple[float, float]) -> None:
            count()
            # Of no length, too: whoever makes a shape of it leaves that out.
            loops[-1].append(np.array([self._getCurrentPoint(), *points], dtype=np.float64))

    glyphs[name].draw(Pen(glyphs))
    return [loop for loop in loops if loop]
