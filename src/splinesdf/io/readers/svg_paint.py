"""What paints are that refer to others: gradients, patterns, and those that are not there."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from splinesdf.io.readers.svg_document import tag_of
from splinesdf.io.readers.svg_style import is_painted

if TYPE_CHECKING:
    from splinesdf.io.readers.svg_walk import Document

_REFERENCE = re.compile(r"\s*(url\([^)]*\))\s*(.*)", re.DOTALL)
# Gradients that refer to gradients. More: nothing that is drawn has more.
_DEEPEST = 20


def seen(document: Document, own: dict[str, str]) -> dict[str, str]:
    """An element's own properties, those that paint with a reference as what is seen of it.

    A reference to nothing is the color after it, or none; so is a gradient of nothing but
    transparent colors. What else is left out is counted: filters, and what a pattern leaves open.
    """
    result = own
    for key in ("fill", "stroke"):
        match = _REFERENCE.fullmatch(own.get(key, ""))
        if match is None:
            continue
        target, other = document.referred(match[1]), match[2].strip() or "none"
        tag = None if target is None else tag_of(target)
        if target is None or tag not in ("linearGradient", "radialGradient", "pattern"):
            result = result | {key: other}
        elif tag == "pattern":
            document.found.left_out[f"pattern of a {key}, which counts as one color"] += 1
        elif not _has_color(document, target):
            result = result | {key: "none"}
    if own.get("filter", "none").lower() not in ("none", ""):
        document.found.left_out["filter"] += 1
    return result


def _has_color(document: Document, gradient: ElementTree.Element) -> bool:
    """Whether some stop of a gradient is seen."""
    for _ in range(_DEEPEST):
        stops = [stop for stop in gradient if tag_of(stop) == "stop"]
        following = document.target(gradient)
        if stops or following is None:
            break
        gradient = following
    return any(_is_seen(document, stop) for stop in stops)


def _is_seen(document: Document, stop: ElementTree.Element) -> bool:
    own = document.styles.of(stop)
    return is_painted(own.get("stop-color", "black"), own.get("stop-opacity", "1"))
