"""Strokes of what goes nowhere, or straight back: against resvg's picture, and numbers.

Subpaths that go nowhere are dots, as wide as the stroke (SVG 2, 13.5.1 and 9.5.1).
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import splinesdf as ss
from tests.drawings import wrong_pixels

HEAD = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>"
PEN = "fill='none' stroke='#000' stroke-width='10' stroke-linecap='{}'"
AREA = {"round": 25.0 * math.pi, "square": 100.0}
# How many dots (60, 32) has, which all are the same one.
NOWHERE = {
    "M60 32z": 1,
    "M60 32 Z": 1,
    "M60 32zz": 1,
    "M60 32L60 32": 1,
    "M60 32 h0z": 1,
    "M60 32A5 5 0 0 0 60 32": 1,
    "m60 32a5 5 0 0 0 0 0z": 1,
    "M9 9M60 32z": 1,
    "M60 32": 0,
    "M60 32M60 32": 0,
}


def drawing(folder: Path, body: str, cap: str) -> tuple[Path, str]:
    text = f"{HEAD}<g {PEN.format(cap)}>{body}</g></svg>"
    (folder / "dots.svg").write_text(text)
    return folder / "dots.svg", text


@pytest.mark.parametrize("cap", ["butt", "round", "square"])
@pytest.mark.parametrize("d", NOWHERE)
def test_a_subpath_that_goes_nowhere_is_a_dot(tmp_path: Path, d: str, cap: str) -> None:
    path, text = drawing(tmp_path, f"<path d='{d}'/>", cap)
    if not NOWHERE[d] or cap == "butt":
        assert wrong_pixels(text, None, strokes=True) == 0
        with pytest.raises(ss.InputError, match="encloses something"):
            ss.read(path, stroke="outline")
        return
    shape = ss.read(path, stroke="outline")
    assert wrong_pixels(text, shape, strokes=True) == 0
    assert abs(sum(c.area for c in ss.offset(shape, 0.0, tolerance=1e-6)) - AREA[cap]) < 1e-4
    assert shape.box == pytest.approx((55.0, 27.0, 65.0, 37.0), abs=1e-9)


@pytest.mark.parametrize("cap", ["butt", "round", "square"])
@pytest.mark.parametrize(
    "d",
    [
        "M20 20 40 20 40 40zM60 70z",
        "M60 70zM20 20 40 20 40 40z",
        "M20 20H40zL20 20",
        "M20 20H40zz",
        "M20 20H40v20zz",
        "M20 20H40zM60 70zm20 0zh-9",
        "M60 70zL80 80",
    ],
)
def test_dots_beside_lines_are_as_a_renderer_paints_them(tmp_path: Path, d: str, cap: str) -> None:
    path, text = drawing(tmp_path, f"<path d='{d}'/>", cap)
    assert wrong_pixels(text, ss.read(path, stroke="outline"), strokes=True) == 0


def test_an_arc_of_no_length_in_a_line_is_omitted(tmp_path: Path) -> None:
    """As the specification has it: resvg leaves out the cap there."""
    path, text = drawing(tmp_path, "<path d='M20 20a5 5 0 0 0 0 0H40'/>", "round")
    shape = ss.read(path, stroke="outline")
    assert wrong_pixels(text.replace("a5 5 0 0 0 0 0", ""), shape, strokes=True) == 0


def test_a_dot_is_stretched_as_its_element_is(tmp_path: Path) -> None:
    body = "<path d='M30 20z' transform='rotate(30) scale(2 1)'/><path d='M80 70z'/>"
    path, text = drawing(tmp_path, body, "square")
    assert wrong_pixels(text, ss.read(path, stroke="outline"), strokes=True) == 0


@pytest.mark.parametrize(("offset", "there"), [(0, True), (5, False)])
def test_a_dot_is_dashed_by_what_is_at_its_start(tmp_path: Path, offset: int, there: bool) -> None:
    body = f"<path d='M80 70z' stroke-dasharray='4 3' stroke-dashoffset='{offset}'/>"
    path, _ = drawing(tmp_path, f"<line x2='9'/>{body}", "square")
    shape = ss.read(path, stroke="outline")
    assert bool(ss.signed_distance(shape, (84.0, 74.0)) < 0.0) == there
    assert shape.box[2] == pytest.approx(85.0 if there else 14.0)


@pytest.mark.parametrize(("tag", "there"), [("polygon", True), ("polyline", False)])
def test_a_polygon_of_a_point_is_closed_and_a_polyline_is_not(
    tmp_path: Path, tag: str, there: bool
) -> None:
    """As the specification has it: resvg draws neither."""
    path, _ = drawing(tmp_path, f"<line x2='9'/><{tag} points='60,32'/>", "square")
    shape = ss.read(path, stroke="outline")
    assert bool(ss.signed_distance(shape, (64.0, 36.0)) < 0.0) == there
    assert shape.box[2] == pytest.approx(65.0 if there else 14.0)


@pytest.mark.parametrize("stroke", ["none", "centre"])
def test_where_nothing_is_stroked_a_dot_is_nothing(tmp_path: Path, stroke: str) -> None:
    path = tmp_path / "dots.svg"
    square = "<path d='M60 32zM10 10H20V20H10zM70 70z'/><path d='M1 1z'/>"
    path.write_text(f"{HEAD}{square}<path d='M80 5z' fill='none' stroke='red'/></svg>")
    shape = ss.read(path, stroke=stroke)
    assert shape.loop_count == 1
    assert shape.box == (10.0, 10.0, 20.0, 20.0)
    assert any("1 path without area" in note for note in shape.notes) == (stroke == "none")
    assert any("2 path without area" in note for note in shape.notes) == (stroke == "centre")


@pytest.mark.parametrize("join", ["miter", "round", "bevel"])
@pytest.mark.parametrize("cap", ["butt", "round", "square"])
@pytest.mark.parametrize(
    "d",
    [
        "M20 20c0 0 40 30 0 0",  # there and back
        "M20.1 20.3c0 0-5.8 2.1 0 0",
        "M20 20c0 0 40 30 0 0z",
        "M20 20c40 30 20 15 10 7.5",
        "M20 20q40 30 10 7.5",
        "M20 20c80 60-40-30 40 30",  # there, back, and there
        "M20 50H40c30 0 30 0 10 0v20",
        "M20 20c0 0 0 0 40 30",  # handles of no length
        "M20 20c40 30 40 30 40 30",
    ],
)
def test_straight_curves_are_as_a_renderer_paints_them(
    tmp_path: Path, d: str, cap: str, join: str
) -> None:
    path, text = drawing(tmp_path, f"<path stroke-linejoin='{join}' d='{d}'/>", cap)
    assert wrong_pixels(text, ss.read(path, stroke="outline"), 256, strokes=True) == 0


@pytest.mark.parametrize("steps", ["0.4-1.9-2.4 2.1", "1.5 3.1-3.5-2.9"])
def test_a_handle_that_rounding_made_is_none(tmp_path: Path, steps: str) -> None:
    """Where the sum of steps misses a path's start, its end is moved there, and no handle is."""
    pen = "fill='none' stroke='#000' stroke-width='.9'"
    path = f"<path {pen} d='M339.1-458.3l{steps}c1.3-.5 2-.2 2-.2z'/>"
    text = f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='330 -465 15 15'>{path}</svg>"
    (tmp_path / "handle.svg").write_text(text)
    assert wrong_pixels(text, ss.read(tmp_path / "handle.svg", stroke="outline"), strokes=True) == 0


@pytest.mark.parametrize("width", ["0", "0px", "0mm", "0%"])
def test_a_stroke_of_no_width_covers_nothing(tmp_path: Path, width: str) -> None:
    body = f"<path stroke-width='{width}' d='M20 20H80'/><path d='M20 50H40'/>"
    path, text = drawing(tmp_path, body, "butt")
    shape = ss.read(path, stroke="outline")
    assert wrong_pixels(text, shape, strokes=True) == 0
    assert shape.box == pytest.approx((20.0, 45.0, 40.0, 55.0))


def test_a_mirrored_stroke_has_its_inside_inside(tmp_path: Path) -> None:
    body = "<path transform='matrix(-1 .2 0 1 100 0)' d='M20 20H60V50M30 70h20v20h-20z'/>"
    path, text = drawing(tmp_path, body, "round")
    assert wrong_pixels(text, ss.read(path, stroke="outline"), strokes=True) == 0


def test_a_stroke_with_a_cusp_is_refused_by_its_name(tmp_path: Path) -> None:
    path, _ = drawing(tmp_path, "<path id='beak' d='M20 20C80 80 20 80 80 20'/>", "butt")
    with pytest.raises(ss.InputError, match=r"<path id='beak'>: expected a line whose stroke has"):
        ss.read(path, stroke="outline")
