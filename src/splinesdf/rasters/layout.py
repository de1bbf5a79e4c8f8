"""Where the glyphs of an atlas are, as the JSON that msdf-atlas-gen writes.

Its rules, by its exporter (json-export.cpp, GlyphGeometry.cpp):

- lengths of writing are in ems, places in the picture in texels;
- the bounds of a glyph go through the *centers* of the texels at its cell's border, in ems
  (``planeBounds``) and in texels (``atlasBounds``, where texel i has its center at i + 1/2);
- what has nothing to see has neither;
- with y counted from the top, y of all lines and bounds changes its sign in ems.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from splinesdf.errors import InputError
from splinesdf.ground.arrays import shown

if TYPE_CHECKING:
    from splinesdf.rasters.atlas import Atlas, Cell


def layout_text(atlas: Atlas, y_origin: str) -> str:
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
