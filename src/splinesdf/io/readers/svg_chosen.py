"""Which of a drawing's elements are read: by layer, by id, by the color of their stroke."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from splinesdf.errors import InputError
from splinesdf.io.readers.source import Options
from splinesdf.io.readers.svg_context import Drawn
from splinesdf.io.readers.svg_walk import Document


def chosen(elements: Sequence[Drawn], document: Document, options: Options) -> list[Drawn]:
    """The elements asked for; how many others there are is noted.

    Raises
    ------
    InputError
        If what is asked for is not in the drawing, or is hidden.
    """
    result = list(elements)
    if options.layers is not None:
        _check("layers", options.layers, (name for d in elements for name in d.context.layers))
        asked = set(options.layers)
        result = [drawn for drawn in result if not asked.isdisjoint(drawn.context.layers)]
    if options.ids is not None:
        _check("ids", options.ids, (name for d in elements for name in d.context.ids))
        asked = set(options.ids)
        result = [drawn for drawn in result if not asked.isdisjoint(drawn.context.ids)]
    if options.stroke_color is not None:
        stroked = [drawn for drawn in elements if drawn.context.stroked]
        paints = [drawn.context.paint("stroke", "none") for drawn in stroked]
        known = {_color(paint): paint for paint in paints}
        color = _color(options.stroke_color)
        if color not in known:
            _check("stroke colors", (options.stroke_color,), known.values())
        result = [
            drawn
            for drawn in result
            if drawn.context.stroked and _color(drawn.context.paint("stroke", "none")) == color
        ]
    if others := len(elements) - len(result):
        document.found.left_out["elements that were not asked for"] += others
    if elements and not result:
        raise InputError("expected elements that are all that was asked for, got none")
    return result


def _check(what: str, asked: Sequence[str], known: Iterable[str]) -> None:
    names = sorted(set(known))
    for name in asked:
        if name not in names:
            shown = ", ".join(names) or "none"
            raise InputError(f"expected {what} that are seen, of {shown:.200}, got {name!r:.60}")


def _color(text: str) -> Any:
    """A color's red, green, blue and alpha; else the paint as it is."""
    from tinycss2.color3 import parse_color

    return parse_color(text) or text.strip()
