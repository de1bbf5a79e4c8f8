"""Readers by extension: a file and the options of `splinesdf.read` in, a shape out."""

from __future__ import annotations

from collections.abc import Callable

from splinesdf.io.readers.formulas import formula_shape
from splinesdf.io.readers.points import points_shape
from splinesdf.io.readers.source import Options, Source
from splinesdf.io.readers.svg import svg_shape
from splinesdf.shapes.shape import Shape

Reader = Callable[[Source, Options], Shape]

READERS: dict[str, Reader] = {
    ".csv": points_shape,
    ".dat": points_shape,
    ".json": formula_shape,
    ".svg": svg_shape,
    ".svgz": svg_shape,
}
