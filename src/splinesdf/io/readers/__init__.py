"""Readers by extension: a file's text, its stem, the fill rule and ``close`` in, a shape out."""

from __future__ import annotations

from collections.abc import Callable

from splinesdf.io.readers.formulas import formula_shape
from splinesdf.io.readers.points import points_shape
from splinesdf.io.readers.svg import svg_shape
from splinesdf.shapes.shape import Shape

Reader = Callable[[str, str, str | None, bool], Shape]

READERS: dict[str, Reader] = {
    ".csv": points_shape,
    ".dat": points_shape,
    ".json": formula_shape,
    ".svg": svg_shape,
}
