"""Writers by extension: contours and options in, the file's text out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from splinesdf.contours.contour import Contour
from splinesdf.io.writers.dxf import dxf_text
from splinesdf.io.writers.gcode import gcode_text
from splinesdf.io.writers.options import GCODE, Options
from splinesdf.io.writers.polygons import geojson_text, wkt_text
from splinesdf.io.writers.svg import svg_text
from splinesdf.io.writers.table import csv_text

Writer = Callable[[Sequence[Contour], Options], str]

WRITERS: Mapping[str, Writer] = {
    ".csv": csv_text,
    ".dxf": dxf_text,
    ".geojson": geojson_text,
    ".svg": svg_text,
    ".wkt": wkt_text,
} | dict.fromkeys(GCODE, gcode_text)
