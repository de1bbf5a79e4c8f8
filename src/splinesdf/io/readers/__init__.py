"""Readers by extension: a file and the options of `splinesdf.read` in, a shape out."""

from __future__ import annotations

from collections.abc import Callable

from splinesdf.io.readers.airfoils import airfoil_shape
from splinesdf.io.readers.dxf import dxf_shape
from splinesdf.io.readers.fonts import font_shape
from splinesdf.io.readers.formulas import json_shape
from splinesdf.io.readers.maps import geojson_shape, wkt_shape
from splinesdf.io.readers.points import points_shape
from splinesdf.io.readers.source import Options, Source
from splinesdf.io.readers.svg import svg_shape
from splinesdf.shapes.shape import Shape

Reader = Callable[[Source, Options], Shape]

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
    ".csv": points_shape,
    ".dat": airfoil_shape,
    ".dxf": dxf_shape,
    ".geojson": geojson_shape,
    ".json": json_shape,
    ".svg": svg_shape,
    ".svgz": svg_shape,
    ".wkt": wkt_shape,
    **dict.fromkeys((".otf", ".ttc", ".ttf", ".woff", ".woff2"), font_shape),
}
