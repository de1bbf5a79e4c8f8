"""Lengths of SVG in user units, and the boxes that views are fitted into."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from typing import NamedTuple

from splinesdf.errors import InputError
from splinesdf.io.readers.svg_transform import Matrix
from splinesdf.shapes.sources.svg_path import parse_numbers

# Millimeters, by the CSS definitions: a px is 1/96 inch, a point 1/72, a pica 12 points.
INCH = 25.4
MILLIMETERS = {
    "mm": 1.0,
    "cm": 10.0,
    "q": 0.25,
    "in": INCH,
    "pt": INCH / 72.0,
    "pc": INCH / 6.0,
}
PX = INCH / 96.0
# The size of a font that no one has given, in px.
_FONT = 16.0
_LENGTH = re.compile(r"\s*([-+.0-9]+(?:e[-+]?\d+)?)\s*(%|[a-z]*)\s*", re.IGNORECASE)


_ALIGNED = re.compile(r"(none|x(Min|Mid|Max)Y(Min|Mid|Max))( (meet|slice))?")


class View(NamedTuple):
    """What lengths are relative to."""

    width: float = 100.0
    height: float = 100.0
    font: float = _FONT


DEFAULT_VIEW = View()


def length(text: str, key: str, view: View) -> float:
    """A length in user units.

    Parameters
    ----------
    text : str
        A number, with or without a unit.
    key : str
        The attribute: percentages are of the width, of the height, or of both.
    view : View
    """
    match = _LENGTH.fullmatch(text)
    numbers: list[float] = []
    if match is not None:
        with suppress(InputError):
            numbers = parse_numbers(match[1])
    if match is None or len(numbers) != 1:
        raise InputError(f"expected {key} as a length, got {text[:30]!r}")
    value = numbers[0]
    unit = match[2].lower()
    if unit in ("", "px"):
        return value
    if unit == "%":
        return value * _reference(key, view) / 100.0
    if unit in MILLIMETERS:
        return value * MILLIMETERS[unit] / PX
    if unit in ("em", "ex", "rem", "ch"):
        font = _FONT if unit == "rem" else view.font
        return value * font * (1.0 if unit in ("em", "rem") else 0.5)
    raise InputError(
        f"expected {key} as a number, in px, mm, cm, in, pt, pc, em or %, got {text[:30]!r}"
    )


def font_size(text: str, view: View) -> float:
    """The size of a font, which percentages and em are of the surrounding one."""
    named = {
        **{"xx-small": 9.0, "x-small": 10.0, "small": 13.0, "medium": 16.0, "large": 18.0},
        **{
            "x-large": 24.0,
            "xx-large": 32.0,
            "larger": 1.2 * view.font,
            "smaller": view.font / 1.2,
        },
    }
    if text.lower() in named:
        return named[text.lower()]
    if text.endswith("%"):
        return length(text[:-1], "font-size", view) * view.font / 100.0
    return length(text, "font-size", view)


def _reference(key: str, view: View) -> float:
    if key in ("x", "cx", "x1", "x2", "width", "rx"):
        return view.width
    if key in ("y", "cy", "y1", "y2", "height", "ry"):
        return view.height
    return math.sqrt(0.5 * (view.width**2 + view.height**2))


def view_box(text: str) -> tuple[float, float, float, float] | None:
    """Corner, width and height; None if there is none that a browser would heed."""
    try:
        x, y, width, height = parse_numbers(text)
    except (InputError, ValueError):  # also not just four numbers
        return None
    return (x, y, width, height) if width > 0.0 and height > 0.0 else None


def fitted(box: tuple[float, float, float, float], width: float, height: float, how: str) -> Matrix:
    """The map that fits a view box into a width and a height, as preserveAspectRatio says."""
    x, y, across, down = box
    words = [word for word in how.split() if word != "defer"] or ["xMidYMid"]
    if not _ALIGNED.fullmatch(" ".join(words)):  # what is not known is as if it were not there
        words = ["xMidYMid"]
    sx, sy = width / across, height / down
    if words[0] == "none":
        return Matrix(sx, 0.0, 0.0, sy, -x * sx, -y * sy)
    scale = max(sx, sy) if "slice" in words else min(sx, sy)
    aligned = words[0].lower()
    places = {"min": 0.0, "mid": 0.5, "max": 1.0}
    at_x, at_y = places.get(aligned[1:4], 0.5), places.get(aligned[5:8], 0.5)
    return Matrix(
        scale,
        0.0,
        0.0,
        scale,
        at_x * (width - across * scale) - x * scale,
        at_y * (height - down * scale) - y * scale,
    )
