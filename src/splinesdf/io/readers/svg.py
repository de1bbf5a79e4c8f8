"""SVG documents: outlines of paths and basic shapes, in user units, y pointing down.

    text ──XML──> elements ──walk down: transform, fill, visibility──> outlines ──> one shape

What a shape cannot hold (texts, images, open paths, ...) is counted and named in the shape's notes.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.svg_open import joined_loops, without_open
from splinesdf.io.readers.svg_transform import IDENTITY, Matrix, mapped, parse_transform, product
from splinesdf.io.readers.svg_units import unit_note
from splinesdf.shapes.repeats import drawn_once, first_of_each, repeats_note
from splinesdf.shapes.shape import Shape
from splinesdf.shapes.sources.compiled import compile_arc
from splinesdf.shapes.sources.svg_path import closing_piece, parse_numbers, parse_path

_NAMESPACE = "{http://www.w3.org/2000/svg}"
# Entities can be made to expand without end, and a drawing needs none.
_ENTITIES = re.compile(r"<!ENTITY|<!DOCTYPE[^<>\[]*\[")
_GROUPS = {"svg", "g", "a", "switch"}
# What is in these is drawn only where something refers to it, or never.
_NO_DRAWING = {
    "clipPath",
    "defs",
    "desc",
    "filter",
    "linearGradient",
    "marker",
    "mask",
    "metadata",
    "pattern",
    "radialGradient",
    "symbol",
    "title",
}
_PROPERTIES = ("clip-path", "display", "fill", "fill-rule", "mask", "stroke", "visibility")
# A loop flatter than this share of its length is a line there and back: beyond rounding, and
# far thinner than anything that a person draws.
_FLAT = 1e-12


@dataclass(frozen=True)
class _Context:
    """Properties that an element hands down to its children."""

    matrix: Matrix = IDENTITY
    filled: bool = True
    stroked: bool = False
    rule: str | None = None
    visible: bool = True


class _Outline(NamedTuple):
    """One element's loops, and how it is painted."""

    tag: str
    loops: list[list[Floats]]
    context: _Context
    label: str


def svg_shape(text: str, stem: str, fill: str | None, close: bool) -> Shape:
    """The shape bounded by all outlines that the document draws."""
    root = _root(text)
    left_out: Counter[str] = Counter()
    not_applied: Counter[str] = Counter()
    outlines = list(_outlines(root, left_out, not_applied))
    styles = sum(1 for element in root.iter() if _tag(element) == "style")
    if styles:
        left_out["style"] = styles
    # An icon often holds an unpainted frame. If nothing at all is painted, outlines are meant.
    painted = [o for o in outlines if o.context.filled or o.context.stroked]
    if painted:
        left_out.update(
            f"unpainted {o.tag}" for o in outlines if not (o.context.filled or o.context.stroked)
        )
    else:
        painted = outlines
    notes = tuple(
        f"{what}: {', '.join(f'{count} {name}' for name, count in names.items())}"
        for what, names in (("left out", left_out), ("not applied", not_applied))
        if names
    )
    if not painted:
        raise InputError(
            "expected a path, rect, circle, ellipse, polygon or polyline that encloses something, "
            f"got none{f' ({notes[0]})' if notes else ''}"
        )
    about_open = None
    if not close:
        kept, about_open = without_open([(o.label, o.loops) for o in painted])
        painted = [o._replace(loops=k) for o, k in zip(painted, kept, strict=True) if k]
    rule = fill if fill is not None else _fill_rule(painted)
    if fill is None:
        painted, repeated = _drawn_once(painted)
        notes = (*notes, *repeats_note(repeated))
    loops = [loop for outline in painted for loop in outline.loops]
    if close:
        loops, about_open = joined_loops(loops)
    notes += tuple(note for note in (about_open, unit_note(root)) if note)
    return Shape.from_pieces(
        loops, fill=rule, close=close, y_down=True, name=stem, notes=notes, once=False
    )


def _drawn_once(outlines: list[_Outline]) -> tuple[list[_Outline], list[str]]:
    """Outlines without what repeats something; that in words.

    A contour counts once in its element, and once an element that repeats another one as a whole:
    what two different elements share may be a hole of one that the other fills. In a drawing of
    mere outlines, which fill nothing, a contour counts once wherever it is.
    """
    names = [f"{outline.tag} {k}" for k, outline in enumerate(outlines, 1)]
    left, again = [], []
    for name, outline in zip(names, outlines, strict=True):
        loops, repeated = drawn_once(outline.loops)
        left.append(outline._replace(loops=loops))
        again += [f"{name}: {words}" for words in repeated]
    first = first_of_each([loop for outline in left for loop in outline.loops])
    ends = np.cumsum([len(outline.loops) for outline in left])
    mere = not any(outline.context.filled for outline in outlines)
    result: list[_Outline] = []
    seen: dict[frozenset[int], str] = {}
    for name, outline, end in zip(names, left, ends.tolist(), strict=True):
        numbers = range(end - len(outline.loops), end)
        contours = frozenset(first[numbers].tolist())
        if contours in seen:
            again.append(f"{name} as {seen[contours]}")
            continue
        seen[contours] = name
        new = [loop for k, loop in zip(numbers, outline.loops, strict=True) if first[k] == k]
        if mere and len(new) < len(numbers):
            again.append(f"{len(numbers) - len(new)} in {name}")
            outline = outline._replace(loops=new)
        result.append(outline)
    return result, again


def _root(text: str) -> ElementTree.Element:
    if _ENTITIES.search(text):
        raise InputError("an SVG document that defines entities is refused: save it as plain SVG")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise InputError(f"expected an SVG document, got no well-formed XML: {error}") from error
    if _tag(root) != "svg":
        raise InputError(f"expected an SVG document, got XML with the root <{root.tag[:60]}>")
    return root


def _tag(element: ElementTree.Element) -> str | None:
    """The element's name, or None if it is not SVG's. Documents without namespace are common."""
    name = element.tag.removeprefix(_NAMESPACE)
    return None if name.startswith("{") else name


def _outlines(
    root: ElementTree.Element, left_out: Counter[str], not_applied: Counter[str]
) -> Iterator[_Outline]:
    """The elements that draw an outline, in the document's order.

    The stack is explicit because documents may be nested deeper than Python's calls.
    """
    stack = [(root, _Context())]
    while stack:
        element, outer = stack.pop()
        tag = _tag(element)
        if tag is None or tag in _NO_DRAWING or tag == "style":
            continue
        with _where(element, tag):
            properties = _properties(element)
            if properties.get("display") == "none":
                continue
            context = _inside(element, properties, outer)
            not_applied.update(
                key for key in ("clip-path", "mask") if properties.get(key, "none") != "none"
            )
            if "transform" in properties:
                not_applied["transform in a style"] += 1
            if tag == "svg" and element is not root:
                if "viewBox" in element.attrib:
                    left_out["svg with a viewBox"] += 1
                    continue
                shift = Matrix(e=_length(element, "x"), f=_length(element, "y"))
                context = replace(context, matrix=product(context.matrix, shift))
            if tag in _GROUPS:
                stack.extend((child, context) for child in reversed(element))
            elif not context.visible:
                continue
            elif tag not in _OUTLINES:
                left_out[tag[:40]] += 1
            else:
                loops = _loops(element, tag, context)
                if loops:
                    yield _Outline(tag, loops, context, _label(element, tag))
                else:
                    left_out[f"{tag} without area"] += 1


@contextmanager
def _where(element: ElementTree.Element, tag: str) -> Iterator[None]:
    """The element's name in front of every error."""
    try:
        yield
    except InputError as error:
        raise type(error)(f"{_label(element, tag)}: {error}") from error


def _label(element: ElementTree.Element, tag: str) -> str:
    name = element.get("id")
    return f"<{tag} id={name[:40]!r}>" if name else f"<{tag}>"


def _properties(element: ElementTree.Element) -> dict[str, str]:
    """Presentation attributes, overruled by the ``style`` attribute."""
    found = {key: value for key in _PROPERTIES if (value := element.get(key)) is not None}
    for declaration in element.get("style", "").split(";"):
        key, colon, value = declaration.partition(":")
        if colon:
            found[key.strip().lower()] = value.replace("!important", "")
    found = {key: value.strip().lower() for key, value in found.items()}
    return {key: value for key, value in found.items() if value != "inherit"}


def _inside(element: ElementTree.Element, properties: dict[str, str], outer: _Context) -> _Context:
    def either(key: str, inherited: bool, no: tuple[str, ...]) -> bool:
        return properties[key] not in no if properties.get(key) else inherited

    rule = properties.get("fill-rule")
    return _Context(
        matrix=product(outer.matrix, parse_transform(element.get("transform", ""))),
        filled=either("fill", outer.filled, ("none",)),
        stroked=either("stroke", outer.stroked, ("none",)),
        rule=rule if rule in ("nonzero", "evenodd") else outer.rule,
        visible=either("visibility", outer.visible, ("hidden", "collapse")),
    )


def _fill_rule(outlines: list[_Outline]) -> str:
    """The rule that the elements share; those it makes no difference to are not asked."""
    simple = ("rect", "circle", "ellipse")
    rules = {
        o.context.rule or "nonzero"
        for o in outlines
        if o.context.rule or (o.context.filled and o.tag not in simple)
    }
    if len(rules) > 1:
        raise InputError(
            "expected one fill rule, got nonzero for some elements and evenodd for others: "
            "pass fill='nonzero' or fill='evenodd'"
        )
    if rules:
        return rules.pop()
    return "nonzero" if any(o.context.filled for o in outlines) else "evenodd"


# --- outlines ----------------------------------------------------------------------------------


def _loops(element: ElementTree.Element, tag: str, context: _Context) -> list[list[Floats]]:
    """The element's loops in the document's coordinates; none if it encloses nothing.

    A fill closes every subpath and shows nothing of those that are straight lines. An outline
    that is only stroked stays as it is.
    """
    loops = [loop for loop in _OUTLINES[tag](element) if loop]
    a, b, c, d, _, _ = context.matrix
    if a * d == b * c:
        return []
    if context.filled:
        loops = [loop + closing_piece(loop) for loop in loops if not _is_flat(loop)]
    return [mapped(loop, context.matrix) for loop in loops]


def _is_flat(loop: list[Floats]) -> bool:
    """Whether all control points lie on one line, so that a fill shows nothing."""
    points = np.concatenate(loop)
    points = points - points[0]
    far = points[np.argmax(np.hypot(*points.T))]
    aside = np.abs(far[0] * points[:, 1] - far[1] * points[:, 0]).max()
    return bool(aside <= _FLAT * float(far @ far))


def _path(element: ElementTree.Element) -> list[list[Floats]]:
    return parse_path(element.get("d", ""))


def _polyline(element: ElementTree.Element) -> list[list[Floats]]:
    numbers = parse_numbers(element.get("points", ""))
    if len(numbers) % 2:
        raise InputError(f"expected x and y of every point, got {len(numbers)} numbers")
    corners = np.array(numbers, dtype=np.float64).reshape(-1, 2)
    return [list(np.stack([corners[:-1], corners[1:]], axis=1))]


def _polygon(element: ElementTree.Element) -> list[list[Floats]]:
    return [loop + closing_piece(loop) for loop in _polyline(element)]


def _circle(element: ElementTree.Element) -> list[list[Floats]]:
    radius = _size(element, "r")
    return _whole_ellipse(element, radius, radius)


def _ellipse(element: ElementTree.Element) -> list[list[Floats]]:
    rx, ry = _radii(element)
    return _whole_ellipse(element, rx, ry)


def _whole_ellipse(element: ElementTree.Element, rx: float, ry: float) -> list[list[Floats]]:
    if not rx or not ry:
        return []
    center = _length(element, "cx"), _length(element, "cy")
    return [compile_arc(center, (rx, 0.0), (0.0, ry), 0.0, 2.0 * math.pi)]


def _rect(element: ElementTree.Element) -> list[list[Floats]]:
    """The path that the SVG specification gives for a rectangle."""
    x, y = _length(element, "x"), _length(element, "y")
    width, height = _size(element, "width"), _size(element, "height")
    if not width or not height:
        return []
    rx, ry = _radii(element)
    rx, ry = min(rx, 0.5 * width), min(ry, 0.5 * height)
    right, bottom = x + width, y + height
    if not rx or not ry:
        return parse_path(f"M{x!r} {y!r}H{right!r}V{bottom!r}H{x!r}Z")
    arc = f"A{rx!r} {ry!r} 0 0 1"
    return parse_path(
        f"M{x + rx!r} {y!r}H{right - rx!r}{arc} {right!r} {y + ry!r}"
        f"V{bottom - ry!r}{arc} {right - rx!r} {bottom!r}"
        f"H{x + rx!r}{arc} {x!r} {bottom - ry!r}V{y + ry!r}{arc} {x + rx!r} {y!r}Z"
    )


_OUTLINES: dict[str, Callable[[ElementTree.Element], list[list[Floats]]]] = {
    "circle": _circle,
    "ellipse": _ellipse,
    "path": _path,
    "polygon": _polygon,
    "polyline": _polyline,
    "rect": _rect,
}


def _radii(element: ElementTree.Element) -> tuple[float, float]:
    """``rx`` and ``ry``; one that is missing or ``auto`` is as the other."""
    given = [
        None if element.get(key, "auto").strip() == "auto" else _size(element, key)
        for key in ("rx", "ry")
    ]
    rx = given[0] if given[0] is not None else given[1] or 0.0
    ry = given[1] if given[1] is not None else rx
    return rx, ry


def _size(element: ElementTree.Element, key: str) -> float:
    value = _length(element, key)
    if value < 0.0:
        raise InputError(f"expected {key} not to be negative, got {value:g}")
    return value


def _length(element: ElementTree.Element, key: str) -> float:
    """A length in user units, 0 if it is missing."""
    text = element.get(key, "0").strip()
    try:
        (value,) = parse_numbers(text.removesuffix("px"))
    except ValueError:  # also not just one number
        raise InputError(
            f"expected {key} as a number without a unit or in px, got {text[:30]!r}"
        ) from None
    return value
