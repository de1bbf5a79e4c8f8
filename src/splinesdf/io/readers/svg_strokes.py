"""The region that an element's stroke covers, in the document's coordinates."""

from __future__ import annotations

from contextlib import suppress

from splinesdf.errors import InputError
from splinesdf.io.readers.svg_context import Drawn
from splinesdf.io.readers.svg_lengths import length
from splinesdf.io.readers.svg_transform import mapped
from splinesdf.shapes.region import Loops, region
from splinesdf.shapes.sources.stroke import Pen, stroke_region


def stroked(drawn: Drawn, ignore: frozenset[str]) -> Loops:
    """Loops around the stroke, cut to the element's clips, inside on the left.

    It is drawn in the element's own coordinates, so that a transform stretches it with the rest.

    Raises
    ------
    InputError
        If it is dashed, and that is not to be ignored; or its width is no length.
    """
    style, matrix = drawn.context.style, drawn.context.matrix
    try:
        width = length(style.get("stroke-width", "1"), "stroke-width", drawn.context.view)
    except InputError as error:
        raise InputError(f"{drawn.label}: {error}") from error
    if not width > 0.0:
        return []
    dashes = style.get("stroke-dasharray", "none").strip()
    if dashes not in ("none", "", "0") and "dashes" not in ignore:
        raise InputError(
            f"{drawn.label}: expected a stroke without dashes, got {dashes[:30]!r}: "
            "ignore='dashes' (--ignore dashes) reads it whole"
        )
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
    try:
        loops = stroke_region(drawn.loops if drawn.own is None else drawn.own, drawn.closed, pen)
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
