"""The unit and the page of an SVG document: its size, and a viewBox in units of the drawing."""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

from splinesdf.errors import InputError
from splinesdf.ground.arrays import as_page
from splinesdf.io.readers.svg_lengths import INCH, MILLIMETERS, PX, View, length, view_box
from splinesdf.shapes.sources.svg_path import parse_numbers

_SIZE = re.compile(r"\s*([^\s%a-z]+(?:e[-+]?\d+)?)\s*(mm|cm|q|in|pt|pc)\s*", re.IGNORECASE)
# Factors that differ by this share are one: it is what the six printed digits of a size leave.
# Larger: a drawing that is off by a hair of every length is not told; smaller: "209.99999mm" is.
_PRINTED = 1e-6


def page_of(root: ElementTree.Element) -> tuple[float, float, float, float] | None:
    """The page in user units: the viewBox, else width and height, else none.

    A file may say itself which page its numbers are of, or that they are of none, as those of
    `write` do: their viewBox is around what is drawn.
    """
    said = root.get("data-page")
    if said == "none":
        return None
    box = None if said is None else view_box(said)
    if box is None:
        box = view_box(root.get("viewBox", "")) or _sheet(root)
    if box is None:
        return None
    x, y, width, height = box
    try:
        return as_page((x, y, x + width, y + height))
    except InputError:  # its sides are lost in the rounding of its corner
        return None


def _sheet(root: ElementTree.Element) -> tuple[float, float, float, float] | None:
    """The corner, width and height that a document without a viewBox says; None if in percent."""
    sides = []
    for key in ("width", "height"):
        text = root.get(key, "")
        try:
            sides.append(math.nan if "%" in text else length(text, key, View()))
        except InputError:
            return None
    return (0.0, 0.0, sides[0], sides[1]) if min(sides) > 0.0 else None


def unit_length(root: ElementTree.Element) -> float | None:
    """How many millimeters one unit is; None if the document does not say, or stretches it."""
    sizes = [_size(root, "width"), _size(root, "height")]
    if sizes == [None, None]:
        return None
    view = _view_box(root)
    if view is None:
        return PX
    found = [size[1] / units for size, units in zip(sizes, view, strict=True) if size is not None]
    aspect = root.get("preserveAspectRatio", "").split()
    if "none" in aspect and max(found) > (1.0 + _PRINTED) * min(found):
        return None
    return max(found) if "slice" in aspect else min(found)


def unit_note(root: ElementTree.Element) -> str | None:
    """A line that says how long one unit is, if the document has a physical size.

    None if it has none, or if one unit is a millimeter, or is an inch and the size is in inches:
    those are the units that files for machines can be in, so nothing has to be converted.
    """
    sizes = [_size(root, "width"), _size(root, "height")]
    if sizes == [None, None]:
        return None
    view = _view_box(root)
    if view is None:
        size = next(size for size in sizes if size is not None)
        said, factor = f"{size[0]} without a viewBox", PX
        inches = size[2]
    else:
        found = [
            (size[1] / units, f"{size[0]} for {units:.6g} units", size[2])
            for size, units in zip(sizes, view, strict=True)
            if size is not None
        ]
        aspect = root.get("preserveAspectRatio", "").split()
        # The drawing is scaled evenly until it fits into the size, or covers it.
        choose = max if "slice" in aspect else min
        factor, said, inches = choose(found)
        if "none" in aspect and max(found)[0] > (1.0 + _PRINTED) * min(found)[0]:
            return (
                f"the drawing says {found[0][1]} across and {found[1][1]} down, which stretches "
                "it; nothing is converted, give the factors to your CAM program"
            )
    name, length = ("inch", factor / INCH) if inches else ("mm", factor)
    if abs(length - 1.0) <= _PRINTED:
        return None
    return (
        f"the drawing says {said}: one unit is {length:.5g} {name}; DXF and G-code are written "
        "in millimeters, or inches (--units inch)"
    )


def _size(root: ElementTree.Element, key: str) -> tuple[str, float, bool] | None:
    """A physical size as written, in millimeters, and whether it is in inches."""
    match = _SIZE.fullmatch(root.get(key, ""))
    if match is None:
        return None
    try:
        (value,) = parse_numbers(match[1])
    except ValueError:  # also not just one number
        return None
    unit = match[2].lower()
    millimeters = value * MILLIMETERS[unit]
    if not 0.0 < millimeters < math.inf:
        return None
    return f"{value:.6g}{unit}", millimeters, unit == "in"


def _view_box(root: ElementTree.Element) -> tuple[float, float] | None:
    """Its width and height, or None if there is none that a browser would heed."""
    box = view_box(root.get("viewBox", ""))
    return None if box is None else box[2:]
