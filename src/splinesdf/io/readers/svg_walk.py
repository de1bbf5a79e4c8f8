"""The elements that an SVG document draws, each with its outline, paint and clips.

    root ──stack──> element: style, transform, viewport, clip ──> children, or an outline
                       ^                                              │
                       └──────── use: the element it refers to ───────┘

The stack is explicit because documents may be nested deeper than Python's calls.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from xml.etree import ElementTree

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.limits import TooMuch, check_limit
from splinesdf.io.readers.svg_clip import Clip, window
from splinesdf.io.readers.svg_context import Context, Drawn
from splinesdf.io.readers.svg_document import tag_of
from splinesdf.io.readers.svg_lengths import View, fitted, font_size, length, view_box
from splinesdf.io.readers.svg_outlines import OUTLINES, Outline, as_styled, outline
from splinesdf.io.readers.svg_paint import seen
from splinesdf.io.readers.svg_style import INHERITED, Styles, share
from splinesdf.io.readers.svg_transform import Matrix, mapped, parse_transform, product
from splinesdf.shapes.loops import check_count, check_place
from splinesdf.shapes.region import Loops
from splinesdf.shapes.sources.dashes import MOST_DASHES

_GROUPS = {"svg", "g", "a", "switch", "symbol", "use"}
# What is in these is drawn only where something refers to it, or never.
NO_DRAWING = frozenset(
    ("clipPath", "defs", "desc", "filter", "linearGradient", "marker", "mask", "metadata",
     "pattern", "radialGradient", "script", "style", "symbol", "title", "view")
)  # fmt: skip
# What Inkscape calls a layer, as its users do.
_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
_MARKERS = ("", "-start", "-mid", "-end")
_XLINK = "{http://www.w3.org/1999/xlink}href"


@dataclass(frozen=True)
class Found:
    """What is said of a document beside what it draws."""

    left_out: Counter[str] = field(default_factory=Counter)
    mended: list[str] = field(default_factory=list)  # errors that SVG itself passes over


# The document, an element, its own properties and its context in; its clips and masks out.
ClipsOf = Callable[["Document", ElementTree.Element, dict[str, str], Context], tuple[Clip, ...]]


class Document:
    """A document: its elements by id, its style sheets, and what is found on the way."""

    def __init__(
        self, root: ElementTree.Element, ignore: frozenset[str], clips_of: ClipsOf
    ) -> None:
        self.root, self.ignore, self.clips_of, self.found = root, ignore, clips_of, Found()
        self.styles = Styles(root)
        self._elements = self._pieces = self._cuts = self._dashes = 0
        self.by_id: dict[str, ElementTree.Element] = {}
        for element in root.iter():
            if name := element.get("id"):
                self.by_id.setdefault(name, element)
        self._parents: dict[ElementTree.Element, ElementTree.Element] | None = None

    def target(self, element: ElementTree.Element) -> ElementTree.Element | None:
        """The element that another one refers to."""
        name = element.get("href", element.get(_XLINK, "")).strip()
        return self.by_id.get(name[1:]) if name.startswith("#") else None

    def referred(self, value: str) -> ElementTree.Element | None:
        """The element that a value such as ``url(#a)`` refers to."""
        name = value.strip().removeprefix("url(").rstrip(")").strip().strip("\"'")
        return self.by_id.get(name[1:]) if name.startswith("#") else None

    def count(self, elements: int = 0, pieces: int = 0, cuts: int = 0, dashes: int = 0) -> None:
        """Refuse more than is drawn in a reasonable time, all uses and clips taken together."""
        self._elements += elements
        self._pieces += pieces
        self._cuts += cuts
        self._dashes += dashes
        check_limit("elements", self._elements, "elements drawn")
        check_limit("clips", self._cuts, "clips, all elements taken together")
        if self._dashes > MOST_DASHES:
            raise InputError(
                f"expected at most {MOST_DASHES:,} dashes in a drawing, got more: ignore='dashes' "
                "(--ignore dashes) reads strokes whole"
            )
        check_count(self._pieces)

    def around(self, element: ElementTree.Element) -> dict[str, str]:
        """What an element inherits where it stands, which is not where it is referred to."""
        if self._parents is None:
            self._parents = {child: parent for parent in self.root.iter() for child in parent}
        above = [element]
        while above[-1] in self._parents:
            above.append(self._parents[above[-1]])
        context = Context()
        for one in reversed(above[1:]):
            own = seen(self, self.styles.of(one))
            context = inside(one, {key: own[key] for key in own.keys() & INHERITED}, context)
        return context.style

    def outlines(self) -> Iterator[Drawn]:
        """The elements that draw an outline, in the document's order."""
        yield from walk(self, self.root, _root_context(self.root))


def walk(document: Document, start: ElementTree.Element, outer: Context) -> Iterator[Drawn]:
    """What an element and its children draw, in order."""
    stack = [(start, outer)]
    while stack:
        element, around = stack.pop()
        tag = tag_of(element)
        referred = bool(around.uses) and around.uses[-1] is element
        if tag is None or (tag in NO_DRAWING and not referred and element is not start):
            continue
        document.count(elements=1)
        with where(element, tag):
            if not passes(element):
                document.found.left_out[f"{tag[:40]} for other languages or programs"] += 1
                continue
            own = seen(document, document.styles.of(element))
            unseen = not around.clipping and share(own.get("opacity", "1")) <= 0.0
            if own.get("display", "").lower() == "none" or unseen:
                if tag in _GROUPS or tag in OUTLINES:
                    document.found.left_out[f"hidden {tag}"] += 1
                continue
            context = inside(element, own, around)
            if tag == "use":  # its place is part of its transform, and moves its clips
                shift = _place(element, context.view)
                context = replace(context, matrix=product(context.matrix, shift))
            clips = document.clips_of(document, element, own, context)
            if clips:
                context = replace(context, clips=context.clips + clips)
            if tag in _GROUPS:
                stack.extend(reversed(_children(document, element, tag, context, around)))
            elif not context.visible:
                document.found.left_out[f"hidden {tag[:40]}"] += 1
            elif tag not in OUTLINES:
                document.found.left_out[tag[:40]] += 1
            else:
                drawn = _drawn(document, as_styled(element, own), tag, context)
                if drawn is not None:
                    constant = own.get("vector-effect") == "non-scaling-stroke"
                    yield replace(drawn, own=None) if constant else drawn


def _children(
    document: Document, element: ElementTree.Element, tag: str, context: Context, outer: Context
) -> list[tuple[ElementTree.Element, Context]]:
    if tag == "switch":
        chosen = next((child for child in element if passes(child)), None)
        return [] if chosen is None else [(chosen, context)]
    if tag == "use":
        target = document.target(element)
        if target is None:
            document.found.left_out["use of nothing in the file"] += 1
            return []
        if any(target is one for one in context.uses) or target is element:
            document.found.left_out["use of itself"] += 1
            return []
        moved = replace(context, uses=(*context.uses, target))
        if tag_of(target) in ("symbol", "svg"):
            size = {key: value for key in ("width", "height") if (value := element.get(key))}
            own = seen(document, document.styles.of(target))
            if tag_of(target) == "svg":
                shift = _place(target, moved.view)
                moved = replace(moved, matrix=product(moved.matrix, shift))
            else:  # as programs draw it, a symbol has no size of its own
                size = {"width": "100%", "height": "100%"} | size
            moved = _in_view(target, own, inside(target, own, moved), size)
            return [(child, moved) for child in target]
        return [(target, moved)]
    if tag == "svg" and element is not document.root:
        shift = _place(element, outer.view)
        context = replace(context, matrix=product(context.matrix, shift))
        context = _in_view(element, document.styles.of(element), context, {})
    return [(child, context) for child in element]


def _place(element: ElementTree.Element, view: View) -> Matrix:
    """The shift by ``x`` and ``y``."""
    x, y = (length(element.get(key, "0"), key, view) for key in "xy")
    return Matrix(e=x, f=y)


def _in_view(
    element: ElementTree.Element, own: dict[str, str], context: Context, size: dict[str, str]
) -> Context:
    """The context in the viewport that an ``svg`` or a ``symbol`` opens at the origin."""
    width, height = (
        length(size.get(key, element.get(key, "100%")).replace("auto", "100%"), key, context.view)
        for key in ("width", "height")
    )
    box = view_box(element.get("viewBox", ""))
    if width <= 0.0 or height <= 0.0:
        return replace(context, clips=(*context.clips, Clip([])))
    overflow = own.get("overflow", "hidden")
    clips = context.clips
    if overflow not in ("visible", "auto"):
        clips = (*clips, window(context.matrix, width, height))
    view = context.view._replace(width=width, height=height)
    matrix = context.matrix
    if box is not None:
        how = element.get("preserveAspectRatio", "")
        matrix = product(matrix, fitted(box, width, height, how))
        view = view._replace(width=box[2], height=box[3])
    return replace(context, matrix=matrix, view=view, clips=clips)


def passes(element: ElementTree.Element) -> bool:
    """Whether an element may be drawn: in English, and with no extensions."""
    if tag_of(element) is None:
        return False
    languages = element.get("systemLanguage")
    if languages is not None:
        known = [word.strip().lower() for word in languages.split(",")]
        if not any(word == "en" or word.startswith("en-") for word in known):
            return False
    return element.get("requiredExtensions") is None


def _root_context(root: ElementTree.Element) -> Context:
    box = view_box(root.get("viewBox", ""))
    if box is not None:
        return Context(view=View(box[2], box[3]))
    sides = []
    for key in ("width", "height"):
        try:
            sides.append(length(root.get(key, "100"), key, View()))
        except InputError:
            sides.append(100.0)
    return Context(view=View(*sides))


def inside(element: ElementTree.Element, own: dict[str, str], outer: Context) -> Context:
    """The context of an element: what it inherits, its own style, font and transform."""
    changed = {
        key: value.lower() if "url" not in value else value
        for key, value in own.items()
        if key in INHERITED
    }
    style, view = outer.style, outer.view
    if changed:
        style = {**style, **changed}
    if "font-size" in changed:
        with suppress(InputError):  # a size that CSS does not know is none
            view = view._replace(font=font_size(changed["font-size"], view))
    matrix = outer.matrix
    if text := own.get("transform"):
        step = parse_transform(text)
        if origin := own.get("transform-origin"):
            x, y = _origin(origin, view)
            step = product(product(Matrix(e=x, f=y), step), Matrix(e=-x, f=-y))
        matrix = product(matrix, step)
    ids, layers = outer.ids, outer.layers
    if name := element.get("id", ""):
        ids = (*ids, name)
    if tag_of(element) == "g" and (name := element.get(_LABEL, name)):
        layers = (*layers, name)
    return replace(outer, matrix=matrix, style=style, view=view, ids=ids, layers=layers)


def _origin(text: str, view: View) -> tuple[float, float]:
    words = {"left": "0%", "right": "100%", "top": "0%", "bottom": "100%", "center": "50%"}
    parts = text.lower().split()[:2]
    if len(parts) == 1:
        parts = ["center", parts[0]] if parts[0] in ("top", "bottom") else [parts[0], "center"]
    elif parts[0] in ("top", "bottom") or parts[1] in ("left", "right"):
        parts.reverse()
    x, y = (words.get(part, part) for part in parts)
    return length(x, "x", view), length(y, "y", view)


def _drawn(
    document: Document, element: ElementTree.Element, tag: str, context: Context
) -> Drawn | None:
    found, label = document.found, label_of(element, tag)
    try:
        shape = outline(element, tag, context.view)
        loops = _mapped(shape, context.matrix)
        if context.filled:
            _check_not_lost(shape.loops, loops)
    except TooMuch:
        raise
    except InputError as error:
        found.mended.append(f"left out, as it has an error: {label}: {error}")
        return None
    if any(context.style.get(f"marker{end}", "none") != "none" for end in _MARKERS):
        found.left_out["markers of " + tag] += 1
    if shape.error:
        found.mended.append(f"drawn up to an error: {label}: {shape.error}")
    if not loops:
        if not shape.error:
            found.left_out[f"{tag} without area"] += 1
        return None
    document.count(pieces=sum(map(len, loops)), cuts=len(context.clips))
    said = element.get("pathLength", "")
    name = element.get("id", "") or element.get(_LABEL, "")
    return Drawn(tag, loops, context, label, shape.loops, shape.closed, said, name)


def _mapped(shape: Outline, matrix: Matrix) -> list[list[Floats]]:
    a, b, c, d, _, _ = matrix
    if a * d == b * c:
        return []
    loops = [mapped(loop, matrix) for loop in shape.loops]
    if not all(np.isfinite(piece).all() for loop in loops for piece in loop):
        raise InputError("expected finite coordinates, got NaN or infinity")
    return loops


def _check_not_lost(before: Loops, after: Loops) -> None:
    """Refuse what has a size and is next to nothing beside its coordinates, or becomes so."""
    if not before or not after:
        return
    given, points = (
        np.concatenate([p for loop in loops for p in loop]) for loops in (before, after)
    )
    if np.ptp(given, axis=0).any():
        check_place(float(np.ptp(points, axis=0).max()), float(np.abs(points).max()))


@contextmanager
def where(element: ElementTree.Element, tag: str) -> Iterator[None]:
    """The element's name in front of every error."""
    try:
        yield
    except InputError as error:
        raise type(error)(f"{label_of(element, tag)}: {error}") from error


def label_of(element: ElementTree.Element, tag: str) -> str:
    """What messages call an element."""
    name = element.get("id")
    return f"<{tag} id={name[:40]!r}>" if name else f"<{tag}>"
