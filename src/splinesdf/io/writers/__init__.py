"""Writers by extension: contours and a tolerance in, the file's text out."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from splinesdf.contour import Contour
from splinesdf.io.writers.dxf import dxf_text
from splinesdf.io.writers.geojson import geojson_text
from splinesdf.io.writers.points import csv_text, wkt_text
from splinesdf.io.writers.svg import svg_text

Writer = Callable[[Sequence[Contour], float], str]

WRITERS: dict[str, Writer] = {
    ".csv": csv_text,
    ".dxf": dxf_text,
    ".geojson": geojson_text,
    ".svg": svg_text,
    ".wkt": wkt_text,
}
