"""Dashes of SVG strokes: against resvg's picture, and where it differs or says nothing, numbers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import splinesdf as ss
from splinesdf.io.readers import svg_walk
from tests.drawings import wrong_pixels
from tests.shapes.test_boundary import area, loops

HEAD = (
    "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>"
    "<g fill='none' stroke='red' stroke-width='6'>"
)
Read = Callable[..., ss.Shape]

CASES = {
    "line": "<path d='M5 50H95' stroke-dasharray='10 5'/>",
    "an odd list": "<path d='M5 50H95' stroke-dasharray='10 5 3'/>",
    "an offset": "<path d='M5 50H95' stroke-dasharray='10 5' stroke-dashoffset='7'/>",
    "a negative offset": "<path d='M5 50H95' stroke-dasharray='10 5' stroke-dashoffset='-47.5'/>",
    "a rectangle": "<rect x='10' y='10' width='80' height='60' stroke-dasharray='25 15'/>",
    "over a corner at the start": (
        "<rect x='10' y='10' width='80' height='60' stroke-dasharray='25 15' "
        "stroke-dashoffset='10'/>"
    ),
    "over a corner with bevels": (
        "<rect x='10' y='10' width='80' height='60' stroke-linejoin='bevel' "
        "stroke-dasharray='20' stroke-dashoffset='-5'/>"
    ),
    "sides that dashes end on": "<rect x='10' y='10' width='80' height='60' "
    "stroke-dasharray='40' />",
    "longer than the outline": "<rect x='10' y='10' width='80' height='60' "
    "stroke-dasharray='400 10' />",
    "longer than the outline, from within": (
        "<rect x='10' y='10' width='80' height='60' stroke-dasharray='400 10' "
        "stroke-dashoffset='10' />"
    ),
    "round corners": (
        "<rect x='10' y='10' width='80' height='60' rx='20' ry='10' "
        "stroke-dasharray='25 9' stroke-linecap='square'/>"
    ),
    "circle": "<circle cx='50' cy='50' r='40' stroke-dasharray='20 7'/>",
    "a circle with round caps": (
        "<circle cx='50' cy='50' r='40' stroke-dasharray='20 15' stroke-linecap='round'/>"
    ),
    "ellipse": "<ellipse cx='50' cy='50' rx='40' ry='20' stroke-dasharray='11 6'/>",
    "cubic": "<path d='M10 90C10 -40 90 140 90 10' stroke-dasharray='11 6 2'/>",
    "quad": (
        "<path d='M10 90Q50 -60 90 80T50 50' stroke-dasharray='11 6 2 5' stroke-linejoin='round'/>"
    ),
    "arc": "<path d='M10 50A40 20 30 1 1 60 70L30 30Z' stroke-dasharray='11 6 2 5'/>",
    "several subpaths": (
        "<path d='M10 10H90M10 30H50V60M60 60h20v20h-20z' stroke-dasharray='13 6' "
        "stroke-dashoffset='4'/>"
    ),
    "round dots": "<path d='M10 10H90L10 60' stroke-dasharray='0 10' stroke-linecap='round'/>",
    "square dots": (
        "<path d='M10 10H90M20 20V90' stroke-dasharray='0 10' stroke-linecap='square'/>"
    ),
    "no dots with butt caps": "<path d='M10 10H90M20 20V90' stroke-dasharray='0 10 5 10' />",
    "percentages": (
        "<path d='M10 10H90M20 20V90' stroke-dasharray='10% 5%' stroke-dashoffset='3%' />"
    ),
    "stretched": "<path transform='scale(2 .5)' d='M5 50H40V150' stroke-dasharray='7 4' />",
    "skewed": (
        "<circle transform='skewX(30) rotate(20)' cx='50' cy='20' r='20' stroke-dasharray='7 4' />"
    ),
    "a style sheet": (
        "<style>.a{stroke-dasharray:9 4;stroke-dashoffset:3px}</style><circle class='a' "
        "cx='50' cy='50' r='30'/>"
    ),
    "polygon": (
        "<polygon points='10,10 90,20 50,90' stroke-dasharray='30 10' stroke-dashoffset='12'/>"
    ),
    "polyline": (
        "<polyline points='10,10 90,20 50,90 10,10' stroke-dasharray='30 10' "
        "stroke-dashoffset='12'/>"
    ),
    "a line element": (
        "<line x1='10' y1='10' x2='90' y2='70' stroke-dasharray='30 10' stroke-linecap='square'/>"
    ),
    "no gaps": "<path d='M10 10H90V90' stroke-dasharray='40 0'/>",
    "from the end of a dash": (
        "<path d='M10 10H90' stroke-dasharray='8 12' stroke-dashoffset='8' stroke-linecap='round'/>"
    ),
    "from the end of a gap": (
        "<path d='M10 10H90' stroke-dasharray='8 12 0 10' stroke-dashoffset='20' "
        "stroke-linecap='round'/>"
    ),
    "up to a corner": "<path d='M10 10H90V90' stroke-dasharray='80 20'/>",
    "a dot at a corner": (
        "<path d='M10 10H90V90' stroke-dasharray='40 40 0 10' stroke-linecap='round'/>"
    ),
    "a far offset": "<path d='M5 50H95' stroke-dasharray='10 5' stroke-dashoffset='1000007'/>",
    "beside a fill": (
        "<circle cx='50' cy='50' r='30' fill='blue' stroke-dasharray='10 5' "
        "stroke-dashoffset='1000007'/>"
    ),
    "handed down": "<g stroke-dasharray='9 4'><path d='M5 5L90 40' stroke-dashoffset='3'/></g>",
    "all zeros": "<path d='M10 10H90' stroke-dasharray='0 0'/>",
}


@pytest.fixture
def read(tmp_path: Path) -> Read:
    def read_body(body: str, **options: str) -> ss.Shape:
        file = tmp_path / "drawing.svg"
        file.write_text(f"{HEAD}{body}</g></svg>", "utf-8")
        return ss.read(file, **{"stroke": "outline", **options})

    return read_body


@pytest.mark.parametrize("name", CASES)
def test_dashes_are_as_painted(name: str, read: Read) -> None:
    shape = read(CASES[name])
    assert shape.notes == ()
    assert wrong_pixels(f"{HEAD}{CASES[name]}</g></svg>", shape, 512, strokes=True) == 0


def test_the_judge_sees_a_dash_that_is_missing(read: Read) -> None:
    body = "<path d='M5 50H95' stroke-dasharray='4 16'/>"
    fewer = read(body.replace("H95", "H80"))
    assert wrong_pixels(f"{HEAD}{body}</g></svg>", fewer, 512, strokes=True) > 300


LINE = "<path d='M10 50H90' stroke-width='2' {}/>"
# Attributes of a line of 80, and how many dashes of which length together it has.
NUMBERS = {
    "pathLength": ("pathLength='8' stroke-dasharray='1'", 4, 40.0),
    "an offset of pathLength": (
        "pathLength='8' stroke-dasharray='3 1' stroke-dashoffset='1'",
        3,
        60.0,
    ),
    "none of it": ("pathLength='0' stroke-dasharray='1 1'", 1, 80.0),
    "none of it, from a gap": (
        "pathLength='0' stroke-dasharray='0 1 5 5' stroke-linecap='round'",
        1,
        1.5707963,
    ),
    "in millimeters": ("stroke-dasharray='5mm'", 3, 80.0 - 10.0 * 96.0 / 25.4),
    "in em of a font": ("font-size='20' stroke-dasharray='.5em'", 4, 40.0),
    "in a box of 100": ("stroke-dasharray='10%'", 4, 40.0),
    "with commas": ("stroke-dasharray=' 10 , 10 '", 4, 40.0),
    "in a style": ("style='stroke-dasharray:10px 10px;stroke-dashoffset:10%'", 4, 40.0),
    "no list": ("style='stroke-dasharray:none'", 1, 80.0),
    "not smaller than the stroke": ("stroke-dasharray='.5 .5'", 80, 40.0),
}


@pytest.mark.parametrize("name", NUMBERS)
def test_dashes_by_number_and_length(name: str, read: Read) -> None:
    attributes, count, length = NUMBERS[name]
    shape = read(LINE.format(attributes))
    assert shape.notes == ()
    assert len(loops(shape.boundary)) == count
    assert area(shape.boundary) == pytest.approx(2.0 * length, rel=1e-7)


def test_the_length_said_is_that_of_all_subpaths(read: Read) -> None:
    shape = read("<path d='M10 10H50M10 30H90' pathLength='12' stroke-dasharray='2 1'/>")
    assert area(shape.boundary) == pytest.approx(6.0 * (30.0 + 60.0), rel=1e-12)


def test_dashes_are_in_units_of_what_is_stroked(read: Read) -> None:
    """A transform stretches them, unless it does not stretch the stroke."""
    path = "<path d='M10 10H40' transform='scale(2 3)' stroke-width='2' stroke-dasharray='5'{}/>"
    shape = read(path.format(""))
    assert area(shape.boundary) == pytest.approx(3 * 10.0 * 6.0, rel=1e-12)
    shape = read(path.format(" vector-effect='non-scaling-stroke'"))
    assert area(shape.boundary) == pytest.approx(6 * 5.0 * 2.0, rel=1e-12)


ERRORS = {
    "stroke-dasharray='5 -1'": ("stroked without dashes, as they have an error: <path>", 80.0),
    "stroke-dasharray='5 apples'": ("stroked without dashes, as they have an error", 80.0),
    "stroke-dasharray='10' stroke-dashoffset='x'": ("dashed from the start, as it has", 40.0),
    "stroke-dasharray='10' pathLength='-2'": ("dashed by its real length, as it has", 40.0),
    "stroke-dasharray='10' pathLength='8 8'": ("dashed by its real length, as it has", 40.0),
    "stroke-dasharray='10' pathLength='long'": ("dashed by its real length, as it has", 40.0),
}


@pytest.mark.parametrize("attributes", ERRORS)
def test_errors_are_passed_over_as_svg_says_and_noted(attributes: str, read: Read) -> None:
    said, length = ERRORS[attributes]
    shape = read(LINE.format(attributes))
    (note,) = shape.notes
    assert note.startswith(said)
    assert area(shape.boundary) == pytest.approx(2.0 * length, rel=1e-12)


def test_what_is_worked_out_is_refused(read: Read) -> None:
    path = LINE.format("style='stroke-dasharray:calc(1px + 2%)'")
    with pytest.raises(ss.InputError, match=r"^.*<path>: expected dashes as .*ignore='dashes'"):
        read(path)
    assert area(read(path, ignore="dashes").boundary) == pytest.approx(160.0, rel=1e-12)


def test_dashes_may_be_ignored(read: Read) -> None:
    shape = read(LINE.format("stroke-dasharray='1 2'"), ignore="dashes")
    assert area(shape.boundary) == pytest.approx(160.0, rel=1e-12)


def test_more_dashes_than_can_be_drawn_are_refused(
    read: Read, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ss.InputError, match=r"<path>: expected at most .* dashes.*--ignore dashes"):
        read(LINE.format("stroke-dasharray='1e-9'"))
    monkeypatch.setattr(svg_walk, "MOST_DASHES", 30)
    some = LINE.format("stroke-dasharray='2'")
    read(some)
    with pytest.raises(ss.InputError, match=r"at most 30 dashes in a drawing.*--ignore dashes"):
        read(some + some)


def test_the_closed_line_itself_has_no_dashes(read: Read) -> None:
    shape = read("<circle cx='50' cy='50' r='10' stroke-dasharray='1 2'/>", stroke="centre")
    assert len(loops(shape.boundary)) == 1
    assert area(shape.boundary) == pytest.approx(314.1592653589793, rel=1e-12)


def test_nothing_but_gap_paints_nothing(read: Read) -> None:
    gap = LINE.format("stroke-dasharray='1 200' stroke-dashoffset='5'")
    with pytest.raises(ss.InputError, match="encloses something"):
        read(gap)
    shape = read(gap + "<rect width='4' height='5' fill='red' stroke='none'/>")
    assert area(shape.boundary) == pytest.approx(20.0, rel=1e-12)
