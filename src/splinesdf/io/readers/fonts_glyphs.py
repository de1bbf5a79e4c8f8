"""Glyphs of a font one by one: outlines, widths, lines of writing and kerning, read at once.

fontTools reads them; kerning is what HarfBuzz adds between two characters, by the tables GPOS or
kern, whichever the font has.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

from splinesdf.errors import InputError
from splinesdf.io.readers.fonts import (
    check_colors,
    checked_location,
    opened,
    outline,
    readable,
    unpacked,
)
from splinesdf.io.readers.source import Source
from splinesdf.shapes.region import Loops

# All that a font can hold. More characters: there is none of them.
MOST_GLYPHS = 65_536
# Pieces of all glyphs together. More: a kilobyte each, gigabytes; fewer: fonts of all of Chinese,
# of 30,000 glyphs by a hundred pieces, are refused.
_MOST_PIECES = 5_000_000
# Pairs of characters whose kerning is asked for, some microseconds each. More: seconds, without a
# word; fewer: the letters of several alphabets together have none.
_MOST_PAIRS = 250_000
# What HarfBuzz does beside kerning, which would make one glyph of two, or others of them.
_UNWANTED = ("calt", "ccmp", "clig", "dlig", "liga", "locl", "mark", "mkmk", "rclt", "rlig")


class Glyph(NamedTuple):
    """A character of a font, in the font's units, y pointing up."""

    character: str
    advance: float
    loops: Loops  # as drawn, to be filled by the rule nonzero; none of a space


class Lines(NamedTuple):
    """Where lines of writing are, in ems, y pointing up from the baseline."""

    height: float  # from one baseline to the next
    ascender: float
    descender: float  # below zero
    underline: float  # its middle
    thickness: float  # of the underline


class Kern(NamedTuple):
    """How much farther the second character comes after the first, in ems."""

    first: str
    second: str
    advance: float


class FontGlyphs(NamedTuple):
    """Characters of a font.

    Attributes
    ----------
    units : float
        The font's units in an em.
    glyphs : list of Glyph
        In the order of their code points.
    lines : Lines
    kerning : list of Kern
    missing : list of str
        Characters that the font does not have.
    notes : tuple of str
    """

    units: float
    glyphs: list[Glyph]
    lines: Lines
    kerning: list[Kern]
    missing: list[str]
    notes: tuple[str, ...]


def font_glyphs(
    source: Source, characters: str, location: Mapping[str, float] | None
) -> FontGlyphs:
    """The glyphs of characters, each once."""
    wanted = sorted(set(characters))
    if len(wanted) > MOST_GLYPHS:
        raise InputError(
            f"expected up to {MOST_GLYPHS:,} different characters, got {len(wanted):,}"
        )
    with readable():
        font = opened(source.content)
        place = checked_location(font, location)
        names = font.getBestCmap() or {}
        known = [character for character in wanted if ord(character) in names]
        check_colors(font, {names[ord(character)] for character in known})
        units = float(font["head"].unitsPerEm)
        glyphs = _glyphs(font, names, known, place)
        kerning, notes = _kerning(font, source.content, names, known, place)
        return FontGlyphs(
            units,
            glyphs,
            _lines(font, units),
            kerning,
            [character for character in wanted if ord(character) not in names],
            notes,
        )


def _glyphs(
    font: Any, names: Mapping[int, str], known: Sequence[str], location: dict[str, float]
) -> list[Glyph]:
    drawn = font.getGlyphSet(location=location)
    glyphs = []
    pieces = 0
    for character in known:
        name = names[ord(character)]
        loops = outline(drawn, name)
        pieces += sum(map(len, loops))
        if pieces > _MOST_PIECES:
            raise InputError(
                f"expected glyphs of up to {_MOST_PIECES:,} pieces together, got more: ask for "
                "fewer characters"
            )
        # Of a variable font it is known only once the glyph is drawn.
        glyphs.append(Glyph(character, float(drawn[name].width), loops))
    return glyphs


def _lines(font: Any, units: float) -> Lines:
    """The lines of writing by the tables that FreeType takes them from, and as it does."""
    head, os2 = font["hhea"], font.get("OS/2")
    ascender, descender, gap = head.ascent, head.descent, head.lineGap
    typographic = os2 is not None and bool(os2.fsSelection & 128)
    if os2 is not None and (typographic or not (ascender or descender)):
        ascender, descender, gap = os2.sTypoAscender, os2.sTypoDescender, os2.sTypoLineGap
        if not (typographic or ascender or descender):
            ascender, descender, gap = os2.usWinAscent, -os2.usWinDescent, 0
    post = font.get("post")
    thickness = 0 if post is None else post.underlineThickness
    # The table has the upper edge of the underline.
    middle = 0 if post is None else post.underlinePosition - int(thickness / 2)
    return Lines(
        (ascender - descender + gap) / units,
        ascender / units,
        descender / units,
        middle / units,
        thickness / units,
    )


def _kerning(
    font: Any,
    content: bytes,
    names: Mapping[int, str],
    known: Sequence[str],
    location: dict[str, float],
) -> tuple[list[Kern], tuple[str, ...]]:
    """How much nearer or farther pairs of characters are than by their widths."""
    if not any(table in font for table in ("GPOS", "kern")) or not known:
        return [], ()
    try:
        import uharfbuzz
    except ImportError:
        return [], ("no kerning, as uharfbuzz is missing: pip install 'splinesdf[fonts]'",)
    if len(known) ** 2 > _MOST_PAIRS:
        most = int(_MOST_PAIRS**0.5)
        return [], (f"no kerning, as it is read for up to {most} characters only",)
    face = uharfbuzz.Face(unpacked(font, content))
    shaper = uharfbuzz.Font(face)
    if location:
        shaper.set_variations(location)
    order = font.getReverseGlyphMap()
    index = {character: order[names[ord(character)]] for character in known}
    width = {character: shaper.get_glyph_h_advance(index[character]) for character in known}
    features = {"kern": True} | dict.fromkeys(_UNWANTED, False)
    found = []
    buffer = uharfbuzz.Buffer()
    for first, second in product(known, repeat=2):
        buffer.reset()
        buffer.add_str(first + second)
        buffer.guess_segment_properties()
        buffer.direction = "ltr"
        uharfbuzz.shape(shaper, buffer, features)
        codes = [info.codepoint for info in buffer.glyph_infos or []]
        if codes != [index[first], index[second]]:
            continue  # the two are written as something else
        advance = buffer.glyph_positions[0].x_advance - width[first]
        if advance:
            found.append(Kern(first, second, advance / face.upem))
    return found, ()
