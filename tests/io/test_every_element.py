"""Every element of real drawings is drawn or named; counted here by what XML alone says."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import pytest

from splinesdf.io.readers.svg_document import parse_document
from splinesdf.io.readers.svg_regions import clips_of
from splinesdf.io.readers.svg_walk import Document

DRAWINGS = Path(__file__).parents[1] / "data" / "drawings"
SHAPES = {"path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "text", "image"}
CONTAINERS = {"svg", "g", "a", "switch"}
# What draws nothing by itself.
SILENT = {"defs", "symbol", "clipPath", "mask", "pattern", "marker", "linearGradient", "style"}
SILENT |= {"radialGradient", "filter", "title", "desc", "metadata", "script", "foreignObject"}
UNSEEN = re.compile(
    r"display\s*[:=]\s*[\"']?none|(?<![-\w])opacity\s*[:=]\s*[\"']?0+(\.0*)?[;\"' ]"
)


def drawn_by(root: ElementTree.Element) -> int:
    """How many elements there are to draw; those used elsewhere once for each use."""
    by_id = {element.get("id"): element for element in root.iter() if element.get("id")}
    count, stack = 0, [(root, False)]
    while stack:
        element, used = stack.pop()
        tag = element.tag.rpartition("}")[2]
        if "}" in element.tag and "svg" not in element.tag:
            continue
        own = " ".join(f'{key}="{value}"' for key, value in element.attrib.items()) + " "
        if UNSEEN.search(own):
            count += 1  # with all that is in it
        elif tag in SHAPES:
            count += 1
        elif tag == "use":
            name = next(value for key, value in element.attrib.items() if key.endswith("href"))
            stack.append((by_id[name[1:]], True))
        elif tag in CONTAINERS or (tag == "symbol" and used):
            stack += [(child, False) for child in element]
        else:
            assert tag in SILENT, tag
    return count


@pytest.mark.parametrize("folder", sorted(path.name for path in DRAWINGS.iterdir()))
def test_every_element_is_drawn_or_named(folder: str) -> None:
    files = sorted((DRAWINGS / folder).glob("*.svg"))
    assert len(files) >= 60
    wrong: Counter[str] = Counter()
    for file in files:
        content = file.read_bytes()
        document = Document(parse_document(content), frozenset(), clips_of)
        drawn = len(list(document.outlines()))
        broken = sum(note.startswith("left out") for note in document.found.mended)
        named = document.found.left_out.total() + broken
        expected = drawn_by(ElementTree.fromstring(content))
        if drawn + named != expected:
            wrong[f"{file.name}: {expected} there, {drawn} drawn, {named} named"] += 1
    assert not wrong
