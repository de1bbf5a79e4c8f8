"""Small drawings of eight sets of icons, against the pictures that resvg makes of them."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import pytest

import splinesdf as ss
from tests.drawings import judged, wrong_pixels

DRAWINGS = Path(__file__).parents[1] / "data" / "drawings"
SETS = sorted(folder.name for folder in DRAWINGS.iterdir())
# Files that are not right, by name and reason.
KNOWN: dict[str, str] = {}


def test_every_set_is_there() -> None:
    assert len(SETS) == 8
    assert all(len(list((DRAWINGS / name).glob("*.svg"))) >= 60 for name in SETS)


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("part", range(3))
def test_drawings_are_filled_as_a_renderer_fills_them(name: str, part: int) -> None:
    wrong = {
        file.name: found
        for file in sorted((DRAWINGS / name).glob("*.svg"))[part::3]
        if (found := judged(file, 192))
    }
    assert {file: reason for file, reason in wrong.items() if file not in KNOWN} == {}


def test_the_judge_sees_a_part_that_is_missing_and_one_too_many() -> None:
    text = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 10">{}</svg>'
    one, other = '<rect x="1" y="1" width="6" height="6"/>', '<circle cx="14" cy="5" r="3"/>'
    both = text.format(one + other)
    shapes = {
        body: ss.Shape.from_pieces(ss_loops(text.format(body)), once=False)
        for body in (one, other, one + other)
    }
    assert wrong_pixels(both, shapes[one + other], 200) == 0
    assert wrong_pixels(both, shapes[one], 200) > 1000
    assert wrong_pixels(text.format(other), shapes[one + other], 200) > 1000
    assert wrong_pixels(both, None, 200) > 3000


def ss_loops(text: str) -> list[list[object]]:
    """The loops of a document of one or more elements."""
    from splinesdf.io.readers.reading import united
    from splinesdf.io.readers.source import Options, Source
    from splinesdf.io.readers.svg import svg_reading

    shape = united(svg_reading(Source(Path("a.svg"), text.encode(), "a", ".svg"), Options()))
    return [
        [shape.piece(k) for k in range(first, last)]
        for first, last in zip(shape.loops[:-1], shape.loops[1:], strict=True)
    ]


@pytest.mark.parametrize("name", SETS)
def test_every_element_is_drawn_or_named(name: str) -> None:
    """Elements with an outline that are neither in the shape nor counted in a note."""
    for file in sorted((DRAWINGS / name).glob("*.svg"))[::4]:
        root = ElementTree.fromstring(file.read_text("utf-8"))
        drawn = Counter(
            _name(element)
            for element in root.iter()
            if _name(element)
            in ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")
        )
        if any(_name(e) in ("use", "clipPath", "mask", "symbol") for e in root.iter()):
            continue
        try:
            shape = ss.read(file)
            loops, said = shape.loop_count, shape.notes
        except ss.InputError as error:
            loops, said = 0, (str(error),)
        named = Counter[str]()
        for note in said:
            for number, tag in re.findall(r"(\d+) (?:unpainted |hidden )?(\w+)", note):
                named[tag] += int(number)
            if "counted once" in note:
                named["path"] += len(re.findall(r"path \d+ as", note))
        # Every other element has at least a loop of its own.
        assert loops >= (drawn - named).total(), file.name


def _name(element: ElementTree.Element) -> str:
    return element.tag.split("}")[-1]
