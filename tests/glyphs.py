"""A hundred glyphs of the DejaVu fonts that Matplotlib ships, composites and overlaps among them.

The outlines are quadratic (TrueType), in font units, 2048 to the em, filled by the nonzero rule.
"""

from __future__ import annotations

from functools import cache, partial
from pathlib import Path

import matplotlib
from fontTools.pens.svgPathPen import SVGPathPen
from fontTools.ttLib import TTFont

import splinesdf as ss
from tests.drawn_when_asked import Drawn

CHARACTERS = {
    "DejaVuSans": (
        "ABCDGKMOPQRSWXZabcdefghjkmpqrstwy"  # letters
        "0123456789"
        "&@%$#?!*§¶€©®½"  # signs, several contours each
        "ÀÅÇÉÑÖŠŽåçéğñøæßœ"  # accents, mostly composites
        "ΑΔΘΣΦΨΩαβδθλξφψω"  # Greek
    ),
    "DejaVuSerif-Italic": "Bgks&",
    "DejaVuSansMono-Oblique": "Жф8@∞",
}
EM = 2048


@cache
def glyphs() -> Drawn:
    """Shapes by name, such as ``DejaVuSans:Å``; the y axis points up."""
    return Drawn(
        {
            f"{font_name}:{character}": partial(_glyph, font_name, character)
            for font_name, characters in CHARACTERS.items()
            for character in characters
        }
    )


def _glyph(font_name: str, character: str) -> ss.Shape:
    path = glyph_path(_font(font_name), character)
    return ss.Shape.from_svg_path(path, name=f"{font_name}:{character}")


def glyph_path(font: TTFont, character: str) -> str:
    """The outline as SVG path data, references to other glyphs resolved."""
    glyph_set = font.getGlyphSet()
    pen = SVGPathPen(glyph_set)
    glyph_set[font.getBestCmap()[ord(character)]].draw(pen)
    return str(pen.getCommands())


@cache
def _font(name: str) -> TTFont:
    return TTFont(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"{name}.ttf")
