"""Clips, masks, style sheets and references of SVG: against resvg's picture, or refused."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest

import splinesdf as ss
from tests.drawings import wrong_pixels

HEAD = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>"
SMALL, DISC = "<rect width='50' height='50'/>", "<circle cx='80' cy='80' r='9'/>"
CLIPPED = "<rect width='100' height='100' clip-path='url(#c)'/>"
MASKED = "<rect width='100' height='100' mask='url(#m)'/>"
WHITE = "<rect width='80' height='80' fill='#fff'/>"
BLACK = "<circle cx='40' cy='40' r='30'/>"
SELF = "<linearGradient id='g' href='#g'/>"
CHAIN = "".join(f"<linearGradient id='g{k}' href='#g{k + 1}'/>" for k in range(4))

CASES = {
    "a clip that is missing": f"<rect width='50' height='50' clip-path='url(#z)'/>{DISC}",
    "titles and comments in a clip": (
        f"<clipPath id='c'><title>a</title><!-- b --><desc>c</desc>{SMALL}</clipPath>{CLIPPED}"
    ),
    "a clip that is clipped": (
        "<clipPath id='d'><circle cx='50' cy='50' r='30'/></clipPath>"
        f"<clipPath id='c' clip-path='url(#d)'>{SMALL}</clipPath>{CLIPPED}"
    ),
    "a clip of what has no area": (
        f"<clipPath id='c'>{SMALL}</clipPath><path d='M10 10H40Z' clip-path='url(#c)'/>{DISC}"
    ),
    "a clip in units of a box without area": (
        "<clipPath id='c' clipPathUnits='objectBoundingBox'><rect width='1' height='1'/></clipPath>"
        f"<rect width='0' height='9' clip-path='url(#c)'/>{DISC}"
    ),
    "white, black, white in a mask": (
        f"<mask id='m'>{WHITE}{BLACK}<rect x='35' y='30' width='10' height='60' fill='white'/>"
        f"</mask>{MASKED}"
    ),
    "black before white in a mask": f"<mask id='m'>{BLACK}{WHITE}</mask>{MASKED}",
    "two blacks in a mask": (
        f"<mask id='m'>{WHITE}{BLACK}<circle cx='60' cy='50' r='15' fill='#000'/></mask>{MASKED}"
    ),
    "a black that is all around": (
        "<mask id='m'><circle cx='40' cy='40' r='20' fill='#fff'/>"
        f"<rect width='100' height='100'/></mask>{MASKED}{DISC}"
    ),
    "nothing in a mask": f"<mask id='m'/>{MASKED}{DISC}",
    "what is not painted in a mask": (
        f"<mask id='m'>{WHITE}<rect width='50' height='50' fill='none'/></mask>{MASKED}"
    ),
    "a mask that is masked": (
        "<mask id='n'><circle cx='40' cy='40' r='30' fill='white'/></mask>"
        f"<mask id='m' mask='url(#n)'>{WHITE}</mask>{MASKED}"
    ),
    "a mask's frame in the user's units": (
        f"<mask id='m' maskUnits='userSpaceOnUse' x='10' y='20%' width='30%' height='50'>{WHITE}"
        f"</mask>{MASKED}"
    ),
    "a mask's frame without area": f"<mask id='m' width='0'>{WHITE}</mask>{MASKED}{DISC}",
    "a mask's frame that is less than nothing": (
        f"<mask id='m' x='.5' width='-.3'>{WHITE}</mask>{MASKED}{DISC}"
    ),
    "rules of media and fonts": (
        "<style>@font-face{font-family:a}rect{fill:none}@page{margin:0}</style>"
        f"{SMALL}{DISC}"
    ),
    "a selector that nobody knows": (
        f"<style>rect:foo(1){{display:none}} circle{{display:none}}</style>{SMALL}{DISC}"
    ),
    "a selector of what is before an element": (
        f"<style>rect::before{{display:none}} circle{{display:none}}</style>{SMALL}{DISC}"
    ),
    "properties of style sheets that do not matter here": (
        f"<style>rect{{cursor:grab;stroke-width:3;fill:none}}</style>{SMALL}{DISC}"
    ),
    "an opacity that is no number": f"<rect width='50' height='50' opacity='foo'/>{DISC}",
    "an opacity in percent": f"<rect width='50' height='50' fill-opacity='0%'/>{DISC}",
    **{
        f"the color {color}": f"<rect width='50' height='50' fill='{color}'/>{DISC}"
        for color in (
            *("#0000", "#00f0", "#000f", "#00000000", "#000000ff", "#ff000080", "rgba(0,0,0,0)"),
            *("rgba(9,9,9,1)", "rgb(0 0 0 / 1)", "hsla(0,0%,0%,0)", "hsl(0,0%,9%)"),
        )
    },
    "a gradient that refers to one of nothing": (
        "<linearGradient id='h'><stop stop-opacity='0'/></linearGradient>"
        "<radialGradient id='g' href='#h'/>"
        f"<rect width='50' height='50' fill='url(#g)'/>{DISC}"
    ),
    "a gradient that refers to one of colors": (
        f"{CHAIN}<linearGradient id='g4'><stop/><stop offset='1'/></linearGradient>"
        f"<rect width='50' height='50' fill='url(#g0)'/>{DISC}"
    ),
    "a gradient that refers to itself": (
        f"{SELF}<rect width='50' height='50' fill='url(#g)'/>{DISC}"
    ),
    "a text that is hidden": f"<text display='none'>a</text>{SMALL}",
    "a use of itself": f"<g id='a'><use href='#a'/>{SMALL}</g>{DISC}",
    "a view beside the clip around it": (
        f"<clipPath id='c'>{SMALL}</clipPath><g clip-path='url(#c)'><svg x='60' width='30' "
        f"height='30'><rect width='9' height='9'/></svg></g>{DISC}"
    ),
    "comments in a switch": f"<switch><!-- a -->{SMALL}{DISC}</switch>",
    "a move and no more": f"<path d='M5 5Z'/>{DISC}",
    "a font in percent": "<g font-size='150%'><rect width='2em' height='1em'/></g>",
    "a radius in percent": (
        "<svg viewBox='0 0 200 100' width='100' height='50'><circle cx='50%' cy='50%' r='20%'/>"
        "</svg>"
    ),
    "no aspect kept": (
        "<svg x='5' y='5' width='60' height='30' viewBox='0 0 10 10' preserveAspectRatio='none'>"
        "<circle cx='5' cy='5' r='5'/></svg>"
    ),
}  # fmt: skip


def _read(tmp_path: Path, inner: str, **options: str) -> ss.Shape:
    (tmp_path / "a.svg").write_text(f"{HEAD}{inner}</svg>")
    return ss.read(tmp_path / "a.svg", **options)


@pytest.mark.parametrize("name", CASES)
def test_what_is_filled_is_what_a_renderer_paints(tmp_path: Path, name: str) -> None:
    shape = _read(tmp_path, CASES[name])
    assert wrong_pixels(f"{HEAD}{CASES[name]}</svg>", shape, 200) == 0


@pytest.mark.parametrize(
    "inner",
    [
        f"<clipPath id='c'>{SMALL}</clipPath><path d='M10 10L90 60' stroke='red' stroke-width='9' "
        f"clip-path='url(#c)'/>",
        "<rect x='20' y='20' width='50' height='50' stroke='red' stroke-width='0'/>",
        # As wide as twice the radius at its vertex: there the inner parallel just has a cusp.
        "<path d='M10 10Q50 90 90 10' fill='none' stroke='red' stroke-width='40'/>",
    ],
)
def test_strokes_are_what_a_renderer_paints(tmp_path: Path, inner: str) -> None:
    shape = _read(tmp_path, inner, stroke="outline")
    assert wrong_pixels(f"{HEAD}{inner}</svg>", shape, 200, strokes=True) == 0


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        ("<rect style='transform:translateX(10px)' width='5' height='7'/>", (10, 0, 15, 7)),
        ("<rect style='transform:translateY(10px)' width='5' height='7'/>", (0, 10, 5, 17)),
        ("<rect style='transform:scaleX(3)' width='5' height='7'/>", (0, 0, 15, 7)),
        ("<rect style='transform:scaleY(3)' width='5' height='7'/>", (0, 0, 5, 21)),
        # Of 100 x 100: right is (100, 50), top is (50, 0), bottom right is (100, 100).
        ("<rect transform='scale(.5)' transform-origin='right' width='40' height='40'/>",
         (50, 25, 70, 45)),
        ("<rect transform='scale(.5)' transform-origin='top' width='40' height='40'/>",
         (25, 0, 45, 20)),
        ("<rect transform='scale(.5)' transform-origin='bottom right' width='40' height='40'/>",
         (50, 50, 70, 70)),
        # A map whose determinant is beyond the largest float.
        ("<g transform='scale(1e80) scale(1e80)'><svg width='5e-159' height='5e-159'>"
         "<rect width='9e-159' height='3e-159'/></svg></g>", (0, 0, 50, 30)),
        # CSS drops what is no declaration, and SVG what has no area, and en-US is English:
        # resvg heeds none of these.
        ("<rect width='9' height='9' style='fill;foo:bar;fill:none'/>"
         "<rect x='60' width='30' height='30' style='fill:none!foo'/>", (60, 0, 90, 30)),
        (f"<rect width='9' height='9' fill='rgb(0 0 0 / 0%)'/>{DISC}", (71, 71, 89, 89)),
        (f"<svg width='0' height='9'>{SMALL}</svg>{DISC}", (71, 71, 89, 89)),
        (f"<switch><rect systemLanguage='de, en-US' width='9' height='7'/>{DISC}</switch>",
         (0, 0, 9, 7)),
        # Up to what is no number.
        ("<polygon points='0,0 50,0 50,30 foo 9,9'/>", (0, 0, 50, 30)),
        ("<polygon points='0,0 50,0 50,30 9'/>", (0, 0, 50, 30)),
    ],
)  # fmt: skip
def test_boxes_are_as_the_specification_says(
    tmp_path: Path, inner: str, expected: tuple[float, ...]
) -> None:
    assert _read(tmp_path, inner).box == pytest.approx(expected)


def test_a_size_that_is_no_length_is_a_hundred(tmp_path: Path) -> None:
    head = "<svg xmlns='http://www.w3.org/2000/svg' width='foo' height='40'>"
    (tmp_path / "a.svg").write_text(f"{head}<rect width='50%' height='50%'/></svg>")
    assert ss.read(tmp_path / "a.svg").box == (0.0, 0.0, 50.0, 20.0)


@pytest.mark.parametrize(
    ("key", "inner"),
    [
        ("clip-path", f"<clipPath id='c'>{SMALL}</clipPath>{CLIPPED}"),
        ("mask", f"<mask id='m'>{SMALL}</mask>{MASKED}"),
    ],
)
def test_what_is_to_be_ignored_cuts_nothing(tmp_path: Path, key: str, inner: str) -> None:
    shape = _read(tmp_path, inner, ignore=key)
    assert shape.box == (0.0, 0.0, 100.0, 100.0)
    assert f"1 {key}, as asked" in " ".join(shape.notes)


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        (f"<mask id='c'>{WHITE}</mask>{CLIPPED}", "expected clip-path to refer to a clipPath, got"),
        (f"<clipPath id='c' clip-path='url(#c)'>{SMALL}</clipPath>{CLIPPED}",
         "expected a clip-path that is a region, got one that clips itself"),
        (f"<clipPath id='c'><text>a</text></clipPath>{CLIPPED}", "got <text> in it"),
        (f"<mask id='m'><g mask='url(#m)'>{WHITE}</g></mask>{MASKED}", "one that masks itself"),
        (f"<mask id='m'><path d='M0 0H9V9Z' stroke='#fff'/></mask>{MASKED}", "got a stroke in it"),
        (f"<mask id='m' fill-opacity='.5'>{WHITE}</mask>{MASKED}", "got an opacity in it"),
        (f"<mask id='m'><g fill='red'>{SMALL}</g></mask>{MASKED}", "got the color 'red' in it"),
        (f"<mask id='m'>{WHITE}<text>a</text></mask>{MASKED}", "got texts, images or others in it"),
        ("<clipPath id='c' clipPathUnits='objectBoundingBox'><rect width='1' height='1'/>"
         f"</clipPath><g clip-path='url(#c)'>{SMALL}</g>", "one in units of the box of <g>"),
        (f"<style>{'a{fill:red}' * 10_001}</style>{SMALL}", "expected at most 10,000 rules"),
    ],
)  # fmt: skip
def test_what_cannot_be_told_is_refused_in_a_line(
    tmp_path: Path, inner: str, expected: str
) -> None:
    with pytest.raises(ss.InputError) as raised:
        _read(tmp_path, inner)
    assert expected in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_width_of_a_stroke_that_is_no_length_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ss.InputError, match="expected stroke-width as a length, got 'foo'"):
        _read(tmp_path, "<path d='M0 0H9' stroke='red' stroke-width='foo'/>", stroke="outline")


ENTITIES = "<!DOCTYPE svg [<!-- sizes --> <!ENTITY side '50'> <!-- end --> ]>"
PLAIN = f"{HEAD}{SMALL}</svg>"


def test_comments_beside_entities(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text(f"{ENTITIES}{HEAD}<rect width='&side;' height='9'/></svg>")
    assert ss.read(tmp_path / "a.svg").box == (0.0, 0.0, 50.0, 9.0)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (gzip.compress(PLAIN.encode(), mtime=0)[:-20], "cut short"),
        (gzip.compress(PLAIN.encode(), mtime=0)[:15] + b"\xff" * 40, "got a damaged one"),
        (b"<?xml version='1.0' encoding='foo'?>" + PLAIN.encode(), "got 'foo': save it as UTF-8"),
        (PLAIN.replace("<rect", "<!ENTITY a 'b'><rect").encode(), "a document's type only"),
        ((ENTITIES + PLAIN.replace("<rect", "<!ENTITY a 'b'><rect")).encode(), "type only"),
    ],
)
def test_damaged_documents_are_refused_in_a_line(
    tmp_path: Path, content: bytes, expected: str
) -> None:
    (tmp_path / "a.svg").write_bytes(content)
    with pytest.raises(ss.InputError) as raised:
        ss.read(tmp_path / "a.svg")
    assert expected in str(raised.value)
    assert "\n" not in str(raised.value)
