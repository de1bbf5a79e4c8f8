"""The outlines of SVG's basic shapes and paths, in the element's own coordinates."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.svg_lengths import View, length
from splinesdf.io.readers.svg_style import GEOMETRY
from splinesdf.shapes.loops import check_place
from splinesdf.shapes.region import Loops
from splinesdf.shapes.sources.compiled import compile_arc
from splinesdf.shapes.sources.svg_path import closing_piece, parse_numbers, parse_path, parse_until

_CSS_PATH = re.compile(r"""path\(\s*(["'])(.*)\1\s*\)""", re.DOTALL)


class Outline(NamedTuple):
    """An element's subpaths, and what is wrong with the rest of it."""

    loops: Loops
    closed: Sequence[bool]  # of each: where its ends meet a stroke has a join, else caps
    error: str = ""


def outline(element: ElementTree.Element, tag: str, view: View) -> Outline:
    """The subpaths of a path or basic shape, as far as they are without an error.

    Raises
    ------
    InputError
        If nothing of it may be drawn.
    """
    found = OUTLINES[tag](element, view)
    kept = [k for k, loop in enumerate(found.loops) if loop]
    return Outline([found.loops[k] for k in kept], [found.closed[k] for k in kept], found.error)


def as_styled(element: ElementTree.Element, own: dict[str, str]) -> ElementTree.Element:
    """The element with the numbers that style sheets give it, which go before its attributes."""
    given = {key: own[key] for key in GEOMETRY if key in own}
    if not given:
        return element
    if path := _CSS_PATH.fullmatch(given.get("d", "")):
        given["d"] = path[2]
    return ElementTree.Element(element.tag, {**element.attrib, **given})


def _path(element: ElementTree.Element, view: View) -> Outline:
    loops, closed, dots, error = parse_until(element.get("d", ""))
    still = [[np.stack([place, place])] for place in dots]
    return Outline([*loops, *still], [*closed, *(True for _ in still)], str(error) if error else "")


def _polyline(element: ElementTree.Element, view: View) -> Outline:
    corners, error = _corners(element)
    return Outline([_sides(corners)], [False], error)


def _corners(element: ElementTree.Element) -> tuple[Floats, str]:
    """The points that are without an error, and the error."""
    text, error = element.get("points", ""), ""
    try:
        numbers = parse_numbers(text)
    except InputError as first:
        numbers, error = _numbers_before(text), str(first)
    if len(numbers) % 2:
        error = error or f"expected x and y of every point, got {len(numbers)} numbers"
        numbers = numbers[:-1]
    return np.array(numbers, dtype=np.float64).reshape(-1, 2), error


def _sides(corners: Floats) -> list[Floats]:
    return list(np.stack([corners[:-1], corners[1:]], axis=1))


def _numbers_before(text: str) -> list[float]:
    """The numbers before the first thing that is none."""
    low, high = 0, len(text)
    while high - low > 1:  # what is right up to a place is right up to all places before it
        middle = (low + high) // 2
        try:
            parse_numbers(text[:middle].rstrip(", \t\n\r\f"))
            low = middle
        except InputError:
            high = middle
    return parse_numbers(text[:low].rstrip(", \t\n\r\f"))


def _polygon(element: ElementTree.Element, view: View) -> Outline:
    corners, error = _corners(element)
    if len(corners) == 1:  # as the path M, Z: a stroke shows where it is
        corners = corners.repeat(2, axis=0)
    sides = _sides(corners)
    return Outline([sides + closing_piece(sides)], [True], error)


def _line(element: ElementTree.Element, view: View) -> Outline:
    ends = np.array(
        [
            [_length(element, x, view), _length(element, y, view)]
            for x, y in (("x1", "y1"), ("x2", "y2"))
        ]
    )
    return Outline([[ends]], [False])


def _circle(element: ElementTree.Element, view: View) -> Outline:
    radius = _size(element, "r", view)
    return _whole_ellipse(element, radius, radius, view)


def _ellipse(element: ElementTree.Element, view: View) -> Outline:
    rx, ry = _radii(element, view)
    return _whole_ellipse(element, rx, ry, view)


def _whole_ellipse(element: ElementTree.Element, rx: float, ry: float, view: View) -> Outline:
    if not rx or not ry:
        return Outline([], [])
    center = _length(element, "cx", view), _length(element, "cy", view)
    check_place(2.0 * max(rx, ry), max(map(abs, center)))
    return Outline([compile_arc(center, (rx, 0.0), (0.0, ry), 0.0, 2.0 * math.pi)], [True])


def _rect(element: ElementTree.Element, view: View) -> Outline:
    """The path that the SVG specification gives for a rectangle."""
    x, y = _length(element, "x", view), _length(element, "y", view)
    width, height = _size(element, "width", view), _size(element, "height", view)
    if not width or not height:
        return Outline([], [])
    check_place(max(width, height), max(abs(x), abs(y)))
    rx, ry = _radii(element, view)
    rx, ry = min(rx, 0.5 * width), min(ry, 0.5 * height)
    return Outline(rectangle(x, y, width, height, rx, ry), [True])


def rectangle(
    x: float, y: float, width: float, height: float, rx: float = 0.0, ry: float = 0.0
) -> Loops:
    """The outline of a rectangle, its corners rounded by quarters of an ellipse."""
    right, bottom = x + width, y + height
    if not rx or not ry:
        return parse_path(f"M{x!r} {y!r}H{right!r}V{bottom!r}H{x!r}Z")
    arc = f"A{rx!r} {ry!r} 0 0 1"
    return parse_path(
        f"M{x + rx!r} {y!r}H{right - rx!r}{arc} {right!r} {y + ry!r}"
        f"V{bottom - ry!r}{arc} {right - rx!r} {bottom!r}"
        f"H{x + rx!r}{arc} {x!r} {bottom - ry!r}V{y + ry!r}{arc} {x + rx!r} {y!r}Z"
    )


OUTLINES: dict[str, Callable[[ElementTree.Element, View], Outline]] = {
    "circle": _circle,
    "ellipse": _ellipse,
    "line": _line,
    "path": _path,
    "polygon": _polygon,
    "polyline": _polyline,
    "rect": _rect,
}


def _radii(element: ElementTree.Element, view: View) -> tuple[float, float]:
    """``rx`` and ``ry``; one that is missing or ``auto`` is as the other."""
    given = [
        None if element.get(key, "auto").strip() == "auto" else _length(element, key, view)
        for key in ("rx", "ry")
    ]
    # As it says, one that is negative is as one that is not given.
    given = [None if radius is None or radius < 0.0 else radius for radius in given]
    rx = given[0] if given[0] is not None else given[1] or 0.0
    ry = given[1] if given[1] is not None else rx
    return rx, ry


def _size(element: ElementTree.Element, key: str, view: View) -> float:
    value = _length(element, key, view)
    if value < 0.0:
        raise InputError(f"expected {key} not to be negative, got {value:g}")
    return value


def _length(element: ElementTree.Element, key: str, view: View) -> float:
    """A length in user units, 0 if it is missing."""
    return length(element.get(key, "0"), key, view)
