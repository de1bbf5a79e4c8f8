"""Readers by extension: a file and the options of `splinesdf.read` in, its parts out."""

from __future__ import annotations

from collections.abc import Callable

from splinesdf.io.readers.airfoils import airfoil_reading
from splinesdf.io.readers.dxf import dxf_reading
from splinesdf.io.readers.fonts import font_reading
from splinesdf.io.readers.formulas import json_reading
from splinesdf.io.readers.maps import geojson_reading, wkt_reading
from splinesdf.io.readers.points import points_reading
from splinesdf.io.readers.reading import Reading
from splinesdf.io.readers.source import Options, Source
from splinesdf.io.readers.svg import svg_reading

Reader = Callable[[Source, Options], Reading]

# Options that some have a use for; `fill` and `close` all have.
USED: dict[str, tuple[str, ...]] = {
    ".csv": ("columns",),
    ".dat": ("columns",),
    ".dxf": ("ignore", "layers", "gap"),
    ".geojson": (),
    ".json": (),
    ".wkt": (),
    **dict.fromkeys((".svg", ".svgz"), ("stroke", "ignore", "layers", "ids", "stroke_color")),
    **dict.fromkeys((".otf", ".ttc", ".ttf", ".woff", ".woff2"), ("text", "size", "location")),
}

READERS: dict[str, Reader] = {
    ".csv": points_reading,
    ".dat": airfoil_reading,
    ".dxf": dxf_reading,
    ".geojson": geojson_reading,
    ".json": json_reading,
    ".svg": svg_reading,
    ".svgz": svg_reading,
    ".wkt": wkt_reading,
    **dict.fromkeys((".otf", ".ttc", ".ttf", ".woff", ".woff2"), font_reading),
}
