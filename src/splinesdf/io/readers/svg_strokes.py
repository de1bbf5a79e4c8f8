"""The region that an element's stroke covers, in the document's coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import NamedTuple

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.svg_context import Drawn
from splinesdf.io.readers.svg_dashes import WITHOUT, pattern_of
from splinesdf.io.readers.svg_lengths import length
from splinesdf.io.readers.svg_transform import mapped
from splinesdf.io.readers.svg_walk import Document
from splinesdf.shapes.region import Loops, region
from splinesdf.shapes.sources.dashes import dashed
from splinesdf.shapes.sources.pen import Pen
from splinesdf.shapes.sources.stroke import stroke_region


def stroked(drawn: Drawn, document: Document) -> Loops:
    """Loops around the stroke, cut to the element's clips, inside on the left.

    It is drawn in the element's own coordinates, so that a transform stretches it with the rest.

    Raises
    ------
    InputError
        If it has too many dashes, or its width is no length.
    """
    style, matrix = drawn.context.style, drawn.context.matrix
    try:
        width = length(style.get("stroke-width", "1"), "stroke-width", drawn.context.view)
    except InputError as error:
        raise InputError(f"{drawn.label}: {error}") from error
    if not width > 0.0:
        return []
    join = style.get("stroke-linejoin", "miter").strip()
    limit = 4.0
    with suppress(ValueError):
        limit = float(style.get("stroke-miterlimit", "4"))
    pen = Pen(
        width,
        style.get("stroke-linecap", "butt").strip(),
        "miter" if join in ("miter-clip", "arcs") else join,
        max(limit, 1.0),
    )
    paths = _paths(drawn, document)
    try:
        loops = stroke_region(paths.loops, paths.closed, pen, paths.along)
    except InputError as error:
        raise InputError(
            f"{drawn.label}: expected a line whose stroke has a border that curves follow: {error}"
        ) from error
    if drawn.own is not None:
        loops = [mapped(loop, matrix) for loop in loops]
        if matrix.a * matrix.d < matrix.b * matrix.c:  # mirrored: the inside is on the right
            loops = [[piece[::-1] for piece in reversed(loop)] for loop in loops]
    for clip in drawn.context.clips:
        loops = clip.cut(region(loops, "nonzero"))
    return loops


class _Paths(NamedTuple):
    """What a stroke follows."""

    loops: Loops
    closed: Sequence[bool]
    along: Sequence[Floats] | None = None


def _paths(drawn: Drawn, document: Document) -> _Paths:
    """An element's subpaths, or the dashes of each."""
    loops = drawn.loops if drawn.own is None else drawn.own
    try:
        pattern = pattern_of(drawn, loops, document)
    except InputError as error:
        raise InputError(f"{drawn.label}: {error}") from error
    if pattern is None:
        return _Paths(loops, drawn.closed)
    try:
        dashes = dashed(loops, drawn.closed, pattern)
    except InputError as error:
        raise InputError(f"{drawn.label}: {error}: {WITHOUT}") from error
    document.count(dashes=len(dashes.loops), pieces=sum(map(len, dashes.loops)))
    return _Paths(dashes.loops, [False] * len(dashes.loops), dashes.along)
