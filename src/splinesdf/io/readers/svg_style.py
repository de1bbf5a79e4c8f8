"""Properties of SVG elements: attributes, style sheets by specificity, and ``style``.

CSS is parsed by tinycss2, selectors are matched by cssselect2, both only where a document has a
style sheet or a ``style``.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any
from xml.etree import ElementTree

from splinesdf.errors import InputError
from splinesdf.io.readers.svg_document import tag_of

# Properties that are read, and may stand as attributes.
PROPERTIES = (
    *("clip-path", "clip-rule", "color", "display", "fill", "fill-opacity", "fill-rule", "filter"),
    *("font-size", "marker", "marker-end", "marker-mid", "marker-start", "mask", "mask-type"),
    *("opacity", "overflow", "stop-color", "stop-opacity", "stroke", "stroke-dasharray"),
    *("stroke-dashoffset", "stroke-linecap", "stroke-linejoin", "stroke-miterlimit"),
    *("stroke-opacity", "stroke-width", "transform", "transform-origin", "vector-effect"),
    "visibility",
)
# Numbers of shapes, which style sheets may give as well.
GEOMETRY = ("cx", "cy", "d", "height", "r", "rx", "ry", "width", "x", "y")
_READ = frozenset((*PROPERTIES, *GEOMETRY))
# Those that children have from their parents.
INHERITED = frozenset(
    ("clip-rule", "color", "fill", "fill-opacity", "fill-rule", "font-size", "marker", "marker-end",
     "marker-mid", "marker-start", "stroke", "stroke-dasharray", "stroke-dashoffset",
     "stroke-linecap", "stroke-linejoin", "stroke-miterlimit", "stroke-opacity", "stroke-width",
     "visibility")
)  # fmt: skip
# Rules of style sheets. More: each is tried on each element; none that a program writes has more.
_MOST_RULES = 10_000
# Selectors, other than by different names, times elements: each is half a microsecond.
_MOST_MATCHES = 50_000_000

Declaration = tuple[str, str, bool]  # name, value, whether it is important


class Styles:
    """The style sheets of a document, by element."""

    def __init__(self, root: ElementTree.Element) -> None:
        sheets = [e for e in root.iter() if tag_of(e) == "style"]
        text = "\n".join("".join(e.itertext()) for e in sheets if _is_css(e))
        self.unread = sum(not _is_css(e) for e in sheets)
        self._matched: dict[ElementTree.Element, list[tuple[Any, list[Declaration]]]] = {}
        if text.strip():
            self._match(root, text)

    def _match(self, root: ElementTree.Element, text: str) -> None:
        import cssselect2
        import tinycss2

        matcher = cssselect2.Matcher()
        count = 0
        for rule in tinycss2.parse_stylesheet(text, skip_comments=True, skip_whitespace=True):
            if rule.type != "qualified-rule":
                continue  # @media, @font-face and such
            count += 1
            if count > _MOST_RULES:
                raise InputError(
                    f"expected at most {_MOST_RULES:,} rules in style sheets, got more"
                )
            declarations = list(_declarations(rule.content))
            try:
                selectors = cssselect2.compile_selector_list(rule.prelude)
            except cssselect2.SelectorError:
                continue  # as CSS says: a rule with a selector that is not known is dropped
            for selector in selectors:
                if selector.pseudo_element is None:
                    matcher.add_selector(selector, declarations)
        _check_work(matcher, sum(1 for _ in root.iter()))
        for wrapper in cssselect2.ElementWrapper.from_xml_root(root).iter_subtree():
            found = matcher.match(wrapper)
            if found:
                self._matched[wrapper.etree_element] = [
                    ((specificity, order), declarations)
                    for specificity, order, _, declarations in found
                ]

    def of(self, element: ElementTree.Element) -> dict[str, str]:
        """The element's own properties; ``inherit`` ones are left out."""
        found = {key: value for key in PROPERTIES if (value := element.get(key)) is not None}
        layers = sorted(self._matched.get(element, ()), key=lambda layer: layer[0])
        declared = [d for _, declarations in layers for d in declarations]
        if style := element.get("style"):
            declared += _inline(style)
        for important in (False, True):
            found.update({name: value for name, value, is_so in declared if is_so == important})
        found = {key: value.strip() for key, value in found.items()}
        return {key: value for key, value in found.items() if value.lower() != "inherit"}


def _check_work(matcher: Any, elements: int) -> None:
    """Refuse style sheets that would take minutes to match."""
    named = (matcher.class_selectors, matcher.id_selectors, matcher.lower_local_name_selectors)
    longest = sum(max(map(len, by_name.values()), default=0) for by_name in named)
    if (longest + len(matcher.other_selectors)) * elements > _MOST_MATCHES:
        raise InputError(
            f"expected style sheets with up to {_MOST_MATCHES:,} matches of rules and elements to "
            "try, got more: give elements attributes instead"
        )


def _is_css(element: ElementTree.Element) -> bool:
    return element.get("type", "text/css").strip().lower() in ("", "text/css")


def _declarations(content: Any) -> Iterator[Declaration]:
    import tinycss2

    for node in tinycss2.parse_blocks_contents(content, skip_comments=True, skip_whitespace=True):
        if node.type == "declaration" and node.lower_name in _READ:
            yield node.lower_name, tinycss2.serialize(node.value), node.important


def _inline(style: str) -> list[Declaration]:
    """Declarations of a ``style`` attribute; simple ones need no parser."""
    if "/*" in style or "\\" in style or "(" in style or '"' in style or "'" in style:
        return list(_declarations(style))
    result = []
    for declaration in style.split(";"):
        key, colon, value = declaration.partition(":")
        name = key.strip().lower()
        if colon and name in _READ:
            value, mark, word = value.partition("!")
            if not mark or word.strip().lower() == "important":
                result.append((name, value, bool(mark)))
    return result


def is_painted(paint: str, *opacities: str) -> bool:
    """Whether a fill or a stroke is seen: not none, nor transparent, nor of no opacity."""
    value = paint.strip().lower()
    if value in ("none", "transparent", "") or _alpha(value) == 0.0:
        return False
    return all(share(opacity) > 0.0 for opacity in opacities)


def share(text: str) -> float:
    """An opacity, as a number or in percent; 1 if it is neither."""
    text = text.strip()
    try:
        return float(text[:-1]) / 100.0 if text.endswith("%") else float(text)
    except ValueError:
        return 1.0


def _alpha(value: str) -> float:
    """The opacity that a color has in itself."""
    if value.startswith("#") and len(value) in (5, 9):
        digits = value[4:] if len(value) == 5 else value[7:]
        return 0.0 if set(digits) == {"0"} else 1.0
    name, bracket, inner = value.partition("(")
    if not bracket or name.strip() not in ("rgb", "rgba", "hsl", "hsla"):
        return 1.0
    inner = inner.partition(")")[0]
    parts = inner.split("/") if "/" in inner else inner.split(",")
    return share(parts[-1]) if len(parts) == (2 if "/" in inner else 4) else 1.0
