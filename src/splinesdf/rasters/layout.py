"""`Atlas`: many glyphs in one picture, and where each is, as the JSON that msdf-atlas-gen writes.

The rules of that, by its exporter (json-export.cpp, GlyphGeometry.cpp):

- lengths of writing are in ems, places in the picture in texels;
- the bounds of a glyph go through the *centers* of the texels at its cell's border, in ems
  (``planeBounds``) and in texels (``atlasBounds``, where texel i has its center at i + 1/2);
- what has nothing to see has neither;
- with y counted from the top, y of all lines and bounds changes its sign in ems.
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, shown
from splinesdf.ground.atomic import atomic_file
from splinesdf.ground.brief import brief, counted
from splinesdf.ground.paths import as_path
from splinesdf.io.readers.fonts_glyphs import Kern, Lines
from splinesdf.rasters.images import Codes, checked_format, coded, write_image


class Cell(NamedTuple):
    """Where a glyph is, its texels from edge to edge.

    Attributes
    ----------
    column, row : int
        Of its upper left texel in the picture, whose upper row is row 0.
    left, bottom : int
        Of its lower left texel, counted from the glyph's origin, y pointing up: it covers
        ``left`` to ``left + 1`` texels, that is ``left / size`` ems and on.
    width, height : int
    """

    column: int
    row: int
    left: int
    bottom: int
    width: int
    height: int


@dataclass(frozen=True, eq=False)
class AtlasGlyph:
    """A glyph or a drawing of an atlas.

    Attributes
    ----------
    name : str
        The character, or the drawing's name.
    advance : float
        How far the next one is, in ems.
    cell : Cell or None
        None if there is nothing to see, as of a space.
    """

    name: str
    advance: float
    cell: Cell | None


@dataclass(frozen=True, eq=False)
class Atlas:
    """Signed distances to many glyphs, side by side.

    Attributes
    ----------
    values : ndarray, shape (height, width)
        Distances in texels, negative inside, at the centers of texels; row 0 is the upper one.
        Within a cell that to its glyph, between cells half the range.
    size : float
        Texels in an em.
    range : float
        The width of the distances that 8 or 16 bits span, in texels.
    glyphs : tuple of AtlasGlyph
        Characters in the order of their code points; drawings in that of their names.
    characters : bool
        Whether they are characters of a font.
    lines : Lines
        Where lines of writing are, in ems.
    kerning : tuple of Kern
        Pairs of characters that are nearer or farther than by their advance.
    name : str
    notes : tuple of str

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> disk = ss.Shape.from_formula("2 + 2*cos(t)", "2 + 2*sin(t)")
    >>> icons = ss.atlas({"square": square, "disk": disk}, size=16, range=4)
    >>> import json
    >>> [glyph["name"] for glyph in json.loads(icons.layout())["glyphs"]]
    ['square', 'disk']
    >>> icons.pixels().dtype
    dtype('uint8')
    >>> icons.save("icons.png").name
    'icons.json'
    """

    values: Floats
    size: float
    range: float
    glyphs: tuple[AtlasGlyph, ...]
    characters: bool
    lines: Lines
    kerning: tuple[Kern, ...] = ()
    name: str = ""
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        height, width = self.values.shape
        glyphs = counted(len(self.glyphs), "glyph" if self.characters else "drawing")
        return brief("Atlas", self.name, glyphs, f"{width} x {height} texels")

    def pixels(self, bits: int = 8) -> Codes:
        """The distances as whole numbers, as `Texture.pixels`."""
        return coded(self.values, self.range, bits)

    def layout(self, *, y_origin: Literal["bottom", "top"] = "bottom") -> str:
        """Where each glyph is, as the JSON of msdf-atlas-gen.

        Parameters
        ----------
        y_origin : {"bottom", "top"}
            From where y is counted, in ems and in texels, as its ``-yorigin``.
        """
        return _layout_text(self, y_origin)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        bits: int | None = None,
        y_origin: Literal["bottom", "top"] = "bottom",
    ) -> Path:
        """Write the picture, and beside it the layout as ``.json``: both or neither.

        Parameters
        ----------
        path : str or path
            ``.png``, ``.tif``, ``.tiff`` or ``.npy``, as `Texture.save`.
        bits : int, optional
            As of `Texture.save`.
        y_origin : {"bottom", "top"}
            As of `layout`. The picture is the same.

        Returns
        -------
        Path
            Of the layout.

        Raises
        ------
        InputError
            If a file cannot be written, or the format has no such bits.
        MissingExtraError
            For PNG and TIFF without Pillow.
        """
        suffix, depth = checked_format(path, bits)
        beside = as_path(path).with_suffix(".json")
        text = self.layout(y_origin=y_origin)
        said = {
            "values": "1/2 - distance / range" if suffix == ".png" else "distance",
            "range": self.range,
            "unit": "texel",
            "layout": beside.name,
        }
        with atomic_file(beside) as layout, atomic_file(path) as picture:
            layout.write(text.encode("utf-8"))
            # On the disk before the picture takes its name: what is left is to rename it.
            layout.flush()
            os.fsync(layout.fileno())
            write_image(
                picture, suffix, self.values, bits=depth, range=self.range, description=said
            )
        return beside


def _layout_text(atlas: Atlas, y_origin: str) -> str:
    """The layout, a glyph a line."""
    if y_origin not in ("bottom", "top"):
        raise InputError(f"expected y_origin 'bottom' or 'top', got {shown(y_origin)}")
    top = y_origin == "top"
    lines, sign = atlas.lines, -1.0 if top else 1.0
    height, width = atlas.values.shape
    head = {
        "atlas": {
            "type": "sdf",
            "distanceRange": _number(atlas.range),
            "distanceRangeMiddle": 0,
            "size": _number(atlas.size),
            "width": width,
            "height": height,
            "yOrigin": y_origin,
        },
        "name": atlas.name,
        "metrics": {
            "emSize": 1,
            "lineHeight": _number(lines.height),
            "ascender": _number(sign * lines.ascender),
            "descender": _number(sign * lines.descender),
            "underlineY": _number(sign * lines.underline),
            "underlineThickness": _number(lines.thickness),
        },
    }
    glyphs = []
    for index, glyph in enumerate(atlas.glyphs):
        entry: dict[str, Any] = (
            {"unicode": ord(glyph.name)}
            if atlas.characters
            else {"index": index, "name": glyph.name}
        )
        entry["advance"] = _number(glyph.advance)
        if glyph.cell is not None:
            plane, place = _bounds(glyph.cell, atlas.size, height)
            entry["planeBounds"] = _turned(plane, 0.0) if top else plane
            entry["atlasBounds"] = _turned(place, float(height)) if top else place
        glyphs.append(entry)
    kerning = [
        {
            "unicode1": ord(kern.first),
            "unicode2": ord(kern.second),
            "advance": _number(kern.advance),
        }
        for kern in atlas.kerning
    ]
    parts = [f'"{key}": {json.dumps(value)}' for key, value in head.items()]
    parts += [f'"glyphs": {_listed(glyphs)}', f'"kerning": {_listed(kerning)}']
    return "{\n" + ",\n".join(parts) + "\n}\n"


def _bounds(cell: Cell, size: float, height: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """A cell from center to center, in ems and in texels, y counted from the bottom."""
    below = height - cell.row - cell.height
    return tuple(  # type: ignore[return-value]
        {
            "left": _number((left + 0.5) / unit),
            "bottom": _number((bottom + 0.5) / unit),
            "right": _number((left + cell.width - 0.5) / unit),
            "top": _number((bottom + cell.height - 0.5) / unit),
        }
        for left, bottom, unit in ((cell.left, cell.bottom, size), (cell.column, below, 1.0))
    )


def _turned(bounds: dict[str, Any], height: float) -> dict[str, Any]:
    """Bounds with y counted from the top of a height."""
    return {
        "left": bounds["left"],
        "top": _number(height - bounds["top"]),
        "right": bounds["right"],
        "bottom": _number(height - bounds["bottom"]),
    }


def _number(value: float) -> float | int:
    """A whole number without a point, as C prints it: readers of it may want an integer."""
    return int(value) if float(value).is_integer() else float(value)


def _listed(entries: list[dict[str, Any]]) -> str:
    inner = ",\n".join(f"  {json.dumps(entry)}" for entry in entries)
    return f"[\n{inner}\n]" if entries else "[]"
