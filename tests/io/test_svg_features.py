"""Details of SVG that decide what is filled: against resvg's picture, and where that differs or
says nothing, against numbers from the specification."""

from __future__ import annotations

from pathlib import Path

import pytest

import splinesdf as ss
from tests.drawings import wrong_pixels

HEAD = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>"
STAR = "<path d='M50 5 79 95 3 38H97L21 95Z'/>"
SMALL, DISC = "<rect width='50' height='50'/>", "<circle cx='80' cy='80' r='9'/>"
CLIPPED = "<rect width='100' height='100' clip-path='url(#c)'/>"
MASKED = "<rect width='100' height='100' mask='url(#m)'/>"
VIEW = (
    "<svg x='5' y='5' width='60' height='30' viewBox='0 0 10 10' preserveAspectRatio='{}'>{}</svg>"
)
FITTED = "<circle cx='5' cy='5' r='5'/><rect width='3' height='3'/>"

CASES = {
    "clip-rule of the clip": f"<clipPath id='c' clip-rule='evenodd'>{STAR}</clipPath>{CLIPPED}",
    "clip-rule from where the clip stands": (
        f"<g clip-rule='evenodd'><clipPath id='c'>{STAR}</clipPath></g>{CLIPPED}"
    ),
    "clip-rule not from what is clipped": (
        f"<clipPath id='c'>{STAR}</clipPath><g clip-rule='evenodd'>{CLIPPED}</g>"
    ),
    "no groups in clips": (
        f"<clipPath id='c'><g>{SMALL}</g><rect x='60' width='20' height='20'/></clipPath>{CLIPPED}"
    ),
    "no use of groups in clips": (
        f"<defs><g id='r'>{SMALL}</g></defs><clipPath id='c'><use href='#r'/>{DISC}</clipPath>"
        f"{CLIPPED}"
    ),
    "no opacity in clips": (
        f"<clipPath id='c'><rect width='50' height='50' opacity='0'/></clipPath>{CLIPPED}"
    ),
    "a transform around units of the box": (
        "<clipPath id='c' clipPathUnits='objectBoundingBox' transform='scale(.5)'><rect width='1' "
        "height='1'/></clipPath><rect x='10' y='20' width='80' height='40' clip-path='url(#c)'/>"
    ),
    "a clip moves with a use": (
        f"<defs><g id='r'>{SMALL}</g></defs><clipPath id='c'><circle cx='20' cy='20' r='20'/>"
        "</clipPath><use href='#r' x='30' y='30' clip-path='url(#c)'/>"
    ),
    "a mask's frame in units of the box": (
        "<mask id='m' x='.2' y='.2' width='.5' height='.5'><rect width='100' height='100' "
        f"fill='#fff'/></mask>{MASKED}"
    ),
    "mask-type in a style sheet": (
        f"<style>#m{{mask-type:alpha}}</style><mask id='m'>{SMALL}</mask>{MASKED}"
    ),
    "a mask inherits where it stands": f"<g fill='white'><mask id='m'>{SMALL}</mask></g>{MASKED}",
    "a mask of the current color": (
        "<mask id='m' color='white'><rect width='70' height='70' fill='currentColor'/></mask>"
        f"{MASKED}"
    ),
    "no extensions": f"<switch><rect requiredExtensions='' width='50' height='50'/>{DISC}</switch>",
    "a language without switch": f"<rect systemLanguage='de' width='50' height='50'/>{DISC}",
    "an extension without switch": f"<rect requiredExtensions='a' width='50' height='50'/>{DISC}",
    "a paint instead of one that is missing": (
        "<rect width='50' height='50' fill='url(#z) none'/>"
        "<circle cx='80' cy='80' r='9' fill='url(#z) red'/>"
    ),
    "a paint that is missing": f"<rect width='50' height='50' fill='url(#z)'/>{DISC}",
    "a gradient of nothing": (
        "<linearGradient id='g'><stop stop-opacity='0'/></linearGradient>"
        f"<rect width='50' height='50' fill='url(#g)'/>{DISC}"
    ),
    "a gradient of another one": (
        "<linearGradient id='h'><stop/><stop offset='1' stop-opacity='.5'/></linearGradient>"
        "<radialGradient id='g' href='#h'/><rect width='50' height='50' fill='url(#g)'/>"
    ),
    "a transparent current color": (
        f"<g color='transparent'><rect width='50' height='50' fill='currentColor'/></g>{DISC}"
    ),
    "opacities below zero": (
        f"<rect width='50' height='50' opacity='-1'/>{DISC}"
        "<rect x='60' width='30' height='30' fill-opacity='-1'/>"
    ),
    "a negative radius": "<rect width='50' height='20' rx='-5'/>",
    "a use of an svg with a place": (
        "<defs><svg id='r' x='10' y='20' width='30' height='30'><rect width='60' height='60'/>"
        "</svg></defs><use href='#r' x='20'/>"
    ),
    "symbols without a size": (
        "<symbol id='s' width='30' height='20'><rect width='60' height='70'/></symbol>"
        "<use href='#s' x='10' y='10'/>"
    ),
    "overflow of a symbol in a style sheet": (
        "<style>symbol{overflow:visible}</style><symbol id='s' viewBox='0 0 10 10'><rect "
        "width='20' height='5'/></symbol><use href='#s' x='10' y='10' width='20' height='20'/>"
    ),
    "overflow of an svg in a style": (
        "<svg x='10' y='10' width='30' height='30' style='overflow:visible'><rect width='60' "
        "height='60'/></svg>"
    ),
    "an element of another program in a switch": (
        f"<switch><a xmlns='urn:x'/><!-- b -->{SMALL}{DISC}</switch>"
    ),
    "an origin in two words": (
        "<rect width='40' height='20' transform='rotate(30)' transform-origin='50 40'/>"
    ),
    "an origin in two words, y first": (
        "<rect width='40' height='20' transform='rotate(30)' transform-origin='bottom left'/>"
    ),
    "a larger font": "<g font-size='larger'><rect width='2em' height='1em'/></g>",
    **{
        f"aspect {how}": VIEW.format(how, FITTED)
        for how in ("defer xMinYMin", "XMINYMIN", "xMinYMin foo", "slice", "xMaxYMid slice")
    },
}  # fmt: skip


def _read(tmp_path: Path, inner: str) -> ss.Shape:
    (tmp_path / "a.svg").write_text(f"{HEAD}{inner}</svg>")
    return ss.read(tmp_path / "a.svg")


@pytest.mark.parametrize("name", CASES)
def test_what_is_filled_is_what_a_renderer_paints(tmp_path: Path, name: str) -> None:
    shape = _read(tmp_path, CASES[name])
    assert wrong_pixels(f"{HEAD}{CASES[name]}</svg>", shape, 200) == 0


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        ("<style>rect{width:40px;x:10px;height:20px}</style><rect/>", (10, 0, 50, 20)),
        ("<circle cx='50' cy='50' r='5' style='r:30px'/>", (20, 20, 80, 80)),
        ("<path d='M0 0H9V9' style='d:path(\"M0 0H90V80\")'/>", (0, 0, 90, 80)),
        # A clip of a use is in the use's own place, whatever it refers to.
        ("<symbol id='s'><rect width='90' height='90'/></symbol><clipPath id='c'><rect width='20' "
         "height='10'/></clipPath><use href='#s' x='30' y='40' clip-path='url(#c)'/>",
         (30, 40, 50, 50)),
    ],
)  # fmt: skip
def test_boxes_are_as_the_specification_says(
    tmp_path: Path, inner: str, expected: tuple[float, ...]
) -> None:
    assert _read(tmp_path, inner).box == pytest.approx(expected)


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        ("<pattern id='p'/><rect width='50' height='50' fill='url(#p)'/>",
         "1 pattern of a fill, which counts as one color"),
        ("<filter id='f'/><rect width='50' height='50' filter='url(#f)'/>", "1 filter"),
        ("<path d='M10 10H60V50' marker-start='url(#m)'/>", "1 markers of path"),
        (f"<clipPath id='c'><g>{SMALL}</g>{DISC}</clipPath>{CLIPPED}", "1 g in a clip-path"),
        (f"<rect systemLanguage='de' width='5' height='5'/>{DISC}", "1 rect for other languages"),
        (f"<style type='text/less'>@a:1</style>{DISC}", "1 style that is no CSS"),
        ("<path d='M0 0L'/>" * 5 + DISC, "and 2 more elements with errors"),
    ],
)  # fmt: skip
def test_what_is_passed_over_is_named(tmp_path: Path, inner: str, expected: str) -> None:
    assert expected in " ".join(_read(tmp_path, inner).notes)


@pytest.mark.parametrize(
    ("inner", "count"),
    [
        (f"{DISC}<rect width='50' height='50' fill='#FFF'/>", "1 rect"),
        (f"<rect width='50' height='50' style='fill: rgb(255, 255, 255)'/>{DISC}", "1 rect"),
        (f"<g fill='white'>{SMALL}{DISC}</g>{STAR}", "1 rect, 1 circle"),
        (f"<g fill='white'>{SMALL}{DISC}</g>", None),  # nothing else: white is the drawing
        (f"{SMALL}{DISC}", None),
        (f"{SMALL}<circle cx='80' cy='80' r='9' fill='#fffffe'/>", None),
    ],
)
def test_white_beside_other_paint_is_noted(tmp_path: Path, inner: str, count: str | None) -> None:
    (tmp_path / "a.svg").write_text(f"{HEAD}{inner}</svg>")
    notes = [note for note in ss.read(tmp_path / "a.svg").notes if "white is a paint" in note]
    if count is None:
        assert not notes
    else:
        (note,) = notes
        assert f": {count}; ids=" in note
