"""The dashes of a stroke, as an SVG element says them: in its own units, or of its `pathLength`."""

from __future__ import annotations

import math
import re

from splinesdf.errors import InputError
from splinesdf.io.readers.svg_context import Drawn
from splinesdf.io.readers.svg_lengths import length
from splinesdf.io.readers.svg_walk import Document
from splinesdf.shapes.region import Loops
from splinesdf.shapes.sources.dashes import Pattern, path_length
from splinesdf.shapes.sources.svg_path import parse_numbers

# How messages say what to do.
WITHOUT = "ignore='dashes' (--ignore dashes) reads the stroke whole"
_APART = re.compile(r"\s*,\s*|\s+")


def pattern_of(drawn: Drawn, loops: Loops, document: Document) -> Pattern | None:
    """The dashes of an element's stroke; None if it has none, or is to be read without.

    What is no length is passed over and noted, as SVG says: no dashes, an offset of 0.

    Raises
    ------
    InputError
        If a length is worked out, as by ``calc``.
    """
    style = drawn.context.style
    text = style.get("stroke-dasharray", "none").strip()
    if text in ("none", "") or "dashes" in document.ignore:
        return None
    mended = document.found.mended
    try:
        lengths = [_length(part, "stroke-dasharray", drawn) for part in _APART.split(text)]
        if min(lengths) < 0.0:
            raise InputError(f"expected stroke-dasharray not to be negative, got {text[:30]!r}")
    except InputError as error:
        _check_known(text)
        mended.append(f"stroked without dashes, as they have an error: {drawn.label}: {error}")
        return None
    offset, text = 0.0, style.get("stroke-dashoffset", "0").strip()
    try:
        offset = _length(text, "stroke-dashoffset", drawn)
    except InputError as error:
        _check_known(text)
        mended.append(f"dashed from the start, as it has an error: {drawn.label}: {error}")
    scale = _scale(drawn, loops, mended)
    if len(lengths) % 2:
        lengths *= 2
    if math.isinf(scale) and any(lengths):  # as SVG says, nothing remains nothing
        return Pattern(tuple(math.inf if one > 0.0 else 0.0 for one in lengths))
    pattern = Pattern(tuple(scale * one for one in lengths), scale * offset)
    return pattern if any(pattern.lengths) else None  # as SVG says, of zeros only there are none


def _length(text: str, key: str, drawn: Drawn) -> float:
    return length(text, key, drawn.context.view)


def _check_known(text: str) -> None:
    """Refuse what is right in SVG, and not read."""
    if "(" in text:
        raise InputError(f"expected dashes as numbers or lengths, got {text[:30]!r}: {WITHOUT}")


def _scale(drawn: Drawn, loops: Loops, mended: list[str]) -> float:
    """How long a unit of ``pathLength`` is; 1 if there is none that counts, infinite if it is 0."""
    if not drawn.said_length.strip():
        return 1.0
    try:
        (said,) = parse_numbers(drawn.said_length)
    except ValueError:  # also not just one number
        said = -1.0
    if said < 0.0:
        got = f"expected pathLength as a number not below 0, got {drawn.said_length[:30]!r}"
        mended.append(f"dashed by its real length, as it has an error: {drawn.label}: {got}")
        return 1.0
    return path_length(loops) / said if said > 0.0 else math.inf
