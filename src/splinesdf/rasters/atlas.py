"""`atlas`: the glyphs of a font, or drawings, in one picture of signed distances.

font or drawings ──> shapes ──cells of whole texels──> packed ──exact distances──> `Atlas`

A cell is so large that in all texels along its border the distance is at least half the range.
These are 0 in 8 and 16 bits, so that no glyph is seen in another's cell.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from splinesdf.distance.exact import signed_distance_grid
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, positive, shown
from splinesdf.ground.paths import as_path
from splinesdf.rasters.drawn import (
    Drawings,
    Drawn,
    DrawnSet,
    drawn_characters,
    drawn_folder,
    drawn_shapes,
    upright,
)
from splinesdf.rasters.images import MOST_TEXELS
from splinesdf.rasters.layout import Atlas, AtlasGlyph, Cell
from splinesdf.rasters.packing import packed
from splinesdf.shapes.shape import Shape

# Texels in an em. More: one glyph fills the largest picture; fewer: nothing can be seen of any.
_LARGEST_EM = 8192.0
_SMALLEST_EM = 1.0


def atlas(
    source: str | os.PathLike[str] | Drawings,
    *,
    size: float = 32.0,
    range: float = 4.0,  # noqa: A002
    characters: str | None = None,
    location: Mapping[str, float] | None = None,
    em: float | Literal["each"] | None = None,
    stroke: str | None = None,
) -> Atlas:
    """One picture of the signed distances to all glyphs of a font, or to drawings.

    Parameters
    ----------
    source : str, path, mapping or iterable
        A font (``.ttf``, ``.otf``, ``.ttc``, ``.woff``, ``.woff2``), a folder of drawings, paths
        of drawings or shapes, or shapes by name.
    size : float
        Texels in an em.
    range : float
        The width of the distances that 8 or 16 bits span, in texels, as msdf-atlas-gen's
        ``-pxrange``; from 1 on.
    characters : str, optional
        Of a font; those of ASCII unless given, as far as it has them.
    location : mapping of str to float, optional
        Where on the axes of a variable font, as ``{"wght": 650}``.
    em : float or "each", optional
        Of drawings: how many of their units an em is, the same for all; "each": the larger side of
        each. Unless given, the larger side of the box around all as they lie one over the other.
    stroke : {"none", "outline", "centre"}, optional
        Of drawings that are files: what becomes of strokes, as in `splinesdf.read`. Icons made of
        strokes only need "outline".

    Returns
    -------
    Atlas
        Its distances are exact. A drawing's origin is the lower left corner of the box around all,
        or of its own (``em="each"``).

    Raises
    ------
    InputError
        If a file cannot be read, a character that was given is not in the font, an argument cannot
        be used, or the picture would have more than 16,384 texels along a side.
    MissingExtraError
        For fonts without fontTools.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> found = ss.atlas({"square": square}, size=8, range=2)
    >>> found.glyphs[0].cell
    Cell(column=0, row=0, left=-2, bottom=-2, width=12, height=12)
    """
    texels, width = positive(size, "size"), positive(range, "range")
    if not _SMALLEST_EM <= texels <= _LARGEST_EM:
        raise InputError(f"expected a size of 1 to {_LARGEST_EM:g} texels in an em, got {texels:g}")
    if not 1.0 <= width <= MOST_TEXELS:
        raise InputError(f"expected a range of 1 to {MOST_TEXELS:,} texels, got {width:g}")
    for_font = {"characters": characters, "location": location}
    found = _found(source, for_font, {"em": em, "stroke": stroke})
    frames = [None if one.shape is None else _frame(one, texels, width) for one in found.drawn]
    sides, places = packed(
        [(frame.width, frame.height) for frame in frames if frame is not None], MOST_TEXELS
    )
    values = np.full((sides[1], sides[0]), 0.5 * width)
    place = iter(places)
    glyphs = []
    for one, frame in zip(found.drawn, frames, strict=True):
        cell = None
        if frame is not None:
            column, row = next(place)
            cell = frame._replace(column=column, row=row)
            part = np.s_[row : row + cell.height, column : column + cell.width]
            values[part] = _distances(one, cell, texels)
        glyphs.append(AtlasGlyph(one.name, one.advance, cell))
    return Atlas(
        values=values,
        size=texels,
        range=width,
        glyphs=tuple(glyphs),
        characters=found.characters,
        lines=found.lines,
        kerning=tuple(found.kerning),
        name=found.name,
        notes=found.notes,
    )


def _found(
    source: str | os.PathLike[str] | Drawings,
    for_font: dict[str, Any],
    for_drawings: dict[str, Any],
) -> DrawnSet:
    """What the atlas is of, or an `InputError`; options are for a font or for drawings."""
    if isinstance(source, Shape):
        raise InputError("expected drawings, got one Shape: put it in brackets")
    path = source if isinstance(source, str | os.PathLike) else None
    folder = path is not None and _is_folder(path)
    a_font = path is not None and not folder
    wanted, got = ("drawings", "a font") if a_font else ("a font", "drawings")
    for name, value in (for_drawings if a_font else for_font).items():
        if value is not None:
            raise InputError(f"expected {name} only for {wanted}, got it for {got}: leave it out")
    if a_font:
        return drawn_characters(path, **for_font)  # type: ignore[arg-type]
    em = for_drawings["em"]
    if em is not None and not (isinstance(em, str) and em == "each"):
        for_drawings = for_drawings | {"em": positive(em, "em")}
    if folder:
        return drawn_folder(path, **for_drawings)  # type: ignore[arg-type]
    try:
        iter(source)  # type: ignore[arg-type]
    except TypeError as error:
        raise InputError(f"expected a font, a folder, or drawings, got {shown(source)}") from error
    return drawn_shapes(source, **for_drawings)  # type: ignore[arg-type]


def _is_folder(path: str | os.PathLike[str]) -> bool:
    try:
        return as_path(path).is_dir()
    except (OSError, ValueError):  # what reads it says why
        return False


def _frame(one: Drawn, size: float, range: float) -> Cell:  # noqa: A002
    """The texels around a glyph, not yet in a place.

    Their edges are whole numbers of texels from the glyph's origin, so that all glyphs are sampled
    alike. The centers of those along the border are half the range or more away from its box.
    """
    assert one.shape is not None
    scale = size / one.em
    box = upright(one.shape)
    if not scale * max(box[2] - box[0], box[3] - box[1]) < MOST_TEXELS:
        raise InputError(
            f"expected pictures of up to {MOST_TEXELS:,} texels, got {one.name!r:.40} larger: ask "
            "for a smaller size, or a larger em"
        )
    low = [math.floor(scale * (box[k] - one.origin[k]) - 0.5 * range - 0.5) for k in (0, 1)]
    high = [math.ceil(scale * (box[k + 2] - one.origin[k]) + 0.5 * range + 0.5) for k in (0, 1)]
    return Cell(0, 0, low[0], low[1], high[0] - low[0], high[1] - low[1])


def _distances(one: Drawn, cell: Cell, size: float) -> Floats:
    """Distances to a glyph in texels, its upper row first."""
    assert one.shape is not None
    unit = one.em / size
    x, y = one.origin
    left, right = (x + unit * (cell.left + k) for k in (0.5, cell.width - 0.5))
    low, high = (y + unit * (cell.bottom + k) for k in (0.5, cell.height - 0.5))
    down = one.shape.y_down
    domain = (left, -high, right, -low) if down else (left, low, right, high)
    found = signed_distance_grid(one.shape, cell.width, cell.height, domain=domain).distance
    return (found if down else found[::-1]) / unit
