"""`read_glyphs`: the glyphs of a font file one by one, as an atlas needs them."""

from __future__ import annotations

import os
from collections.abc import Mapping

from splinesdf.errors import InputError
from splinesdf.ground.limits import limits_in_use
from splinesdf.io.input import content_of, named
from splinesdf.io.readers.fonts_glyphs import FontGlyphs, font_glyphs
from splinesdf.io.readers.source import Source, checked_options

FONTS = (".otf", ".ttc", ".ttf", ".woff", ".woff2")


def read_glyphs(
    path: str | os.PathLike[str],
    characters: str,
    *,
    location: Mapping[str, float] | None = None,
) -> FontGlyphs:
    """Glyphs of a font, which is opened once.

    Parameters
    ----------
    path : str or path
        ``.ttf``, ``.otf``, ``.ttc`` (the first font), ``.woff`` or ``.woff2``.
    characters : str
        Each counts once.
    location : mapping of str to float, optional
        Where on the axes of a variable font, as ``{"wght": 650}``.

    Raises
    ------
    InputError
        If the file cannot be read, or a glyph is drawn in colors.
    MissingExtraError
        Without fontTools.
    """
    place = checked_options({"location": location}).location
    with named(path) as file:
        suffix = file.suffix.lower()
        if suffix not in FONTS:
            raise InputError(
                f"expected a font ending in {', '.join(FONTS)}, got {suffix or 'none'!r}"
            )
        return font_glyphs(
            Source(file, content_of(file, limits_in_use().bytes), file.stem, suffix),
            characters,
            place,
        )
