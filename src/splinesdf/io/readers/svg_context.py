"""What an SVG element is drawn with: what its parents hand down, and its own subpaths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from xml.etree import ElementTree

from splinesdf.io.readers.svg_clip import Clip
from splinesdf.io.readers.svg_lengths import DEFAULT_VIEW, View
from splinesdf.io.readers.svg_style import is_painted, share
from splinesdf.io.readers.svg_transform import IDENTITY, Matrix
from splinesdf.shapes.region import Loops


@dataclass(frozen=True)
class Context:
    """What an element hands down to its children."""

    matrix: Matrix = IDENTITY
    style: dict[str, str] = field(default_factory=dict)
    view: View = DEFAULT_VIEW
    clips: tuple[Clip, ...] = ()
    # The elements that are referred to around this one: none may refer to itself.
    uses: tuple[ElementTree.Element, ...] = ()
    # Of the element and those around it: ids, and what groups are called as layers.
    ids: tuple[str, ...] = ()
    layers: tuple[str, ...] = ()
    clipping: bool = False  # whether it is a clip that is drawn, where opacity says nothing

    def paint(self, key: str, default: str) -> str:
        """What a fill or a stroke is painted with."""
        found = self.style.get(key, default)
        return self.style.get("color", "black") if found == "currentcolor" else found

    @property
    def filled(self) -> bool:
        """Whether a fill is seen."""
        return is_painted(self.paint("fill", "black"), self.style.get("fill-opacity", "1"))

    @property
    def stroked(self) -> bool:
        """Whether a stroke is seen."""
        style = self.style
        if not is_painted(self.paint("stroke", "none"), style.get("stroke-opacity", "1")):
            return False
        width = style.get("stroke-width", "1")
        return share(width.removesuffix("px")) > 0.0 if not width.endswith("%") else True

    @property
    def rule(self) -> str | None:
        """The fill rule, if one is given."""
        found = self.style.get("fill-rule")
        return found if found in ("nonzero", "evenodd") else None

    @property
    def visible(self) -> bool:
        """Whether it is not hidden."""
        return self.style.get("visibility", "visible") not in ("hidden", "collapse")


@dataclass(frozen=True)
class Drawn:
    """One element's subpaths in the document's coordinates, and how it is painted."""

    tag: str
    loops: Loops
    context: Context
    label: str
    # The same in the element's own coordinates, in which it is stroked: none if the transform does
    # not stretch its stroke.
    own: Loops | None
    closed: Sequence[bool]
    said_length: str = ""  # its pathLength, as written
    name: str = ""  # its id or its label, if it has one
    number: int = 0  # its place among all that are read
