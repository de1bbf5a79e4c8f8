"""Drawings of lines: what is open is joined, left out or refused; and what one unit is."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import splinesdf as ss
from tests.reading import ROUNDING, areas, corners

Svg = Callable[..., ss.Shape]


@pytest.fixture
def svg(tmp_path: Path) -> Svg:
    def read(body: str, *, root: str = "", **options: object) -> ss.Shape:
        file = tmp_path / "drawing.svg"
        file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {root}>{body}</svg>', "utf-8")
        return ss.read(file, **{"stroke": "centre", **options})

    return read


def stroked(*paths: str) -> str:
    return "".join(f'<path fill="none" stroke="red" d="{d}"/>' for d in paths)


# --- joined end to end -------------------------------------------------------------------------


@pytest.mark.parametrize(
    "body",
    [
        stroked("M0 0H4", "M4 0V3", "M4 3H0V0"),
        stroked("M0 0H4 M4 3V0 M4 3H0V0"),
        stroked("M4 3H0V0", "M4 0H0", "M4 0V3"),
        stroked("M0 0H4", "M4 3H0V0 M4 3V0"),
        '<g fill="none" stroke="red"><path d="M0 0H4"/><polyline points="0 0 0 3 4 3"/>'
        '<path transform="translate(4 0)" d="M0 0V3"/></g>',
        stroked("M0 0H4", "M4.000003 0V3", "M4 3H0V0"),
    ],
)
def test_paths_whose_ends_meet_are_one_loop(svg: Svg, body: str) -> None:
    shape = svg(body, close=True)
    assert_allclose(np.abs(areas(shape)), [12.0], rtol=1e-6)
    assert shape.notes == ("joined end to end: 3 open paths, to 1",)


def test_a_chain_runs_as_the_first_path_of_it_does(svg: Svg) -> None:
    shape = svg(stroked("M4 0H0", "M4 0V3", "M0 0V3H4"), close=True)
    assert corners(shape) == [[4, 0], [0, 0], [0, 3], [4, 3]]


def test_what_is_open_after_that_is_closed_by_a_straight_piece(svg: Svg) -> None:
    body = stroked("M4 3V0", "M0 0H4", "M9 9H8V7", "M20 0h1v1h-1z")
    shape = svg(body, close=True)
    assert_allclose(np.abs(areas(shape)), [6.0, 1.0, 1.0], rtol=ROUNDING)
    assert shape.notes == ("joined end to end: 2 open paths, to 1; closed by straight pieces: 2",)


def test_ends_farther_apart_than_printed_digits_are_not_joined(svg: Svg) -> None:
    shape = svg(stroked("M0 0H4", "M4.00001 0L4 3", "M4 3H0V0.00001"), close=True)
    assert shape.notes == ("joined end to end: 2 open paths, to 1; closed by straight pieces: 2",)


def test_nothing_to_join_is_no_note(svg: Svg) -> None:
    assert svg(stroked("M0 0H4V3", "M9 9H8V7"), close=True).notes == ()


def test_spokes_of_a_wheel_are_joined_two_by_two(svg: Svg) -> None:
    """Many ends at one point: each is paired once, in the file's order."""
    rim = [(3.0 * math.cos(k), 3.0 * math.sin(k)) for k in range(6)]
    shape = svg(stroked(*(f"M0 0L{x!r} {y!r}" for x, y in rim)), close=True)
    assert shape.loop_count == 3
    assert shape.notes == ("joined end to end: 6 open paths, to 3; closed by straight pieces: 3",)


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_polygons_in_bits_are_whole_again(svg: Svg, data: st.DataObject) -> None:
    """Cut anywhere, turned round, shuffled, with ends printed to seven digits of the size."""
    random = np.random.default_rng(data.draw(st.integers(0, 2**32)))
    count, paths, wanted = data.draw(st.integers(1, 4)), [], []
    for number in range(count):
        corner = data.draw(st.integers(3, 9))
        angles = 2.0 * math.pi * (np.arange(corner) + random.uniform(0.0, 0.5, corner)) / corner
        radii = random.uniform(1.0, 3.0, corner)
        points = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
        points += [10.0 * number, random.uniform(-5.0, 5.0)]
        x, y = points.T
        wanted.append(0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))))
        cuts = np.sort(random.choice(corner, data.draw(st.integers(2, corner)), replace=False))
        for first, last in zip(cuts, [*cuts[1:], cuts[0] + corner], strict=True):
            run = points[np.arange(first, last + 1) % corner]
            run = run + random.uniform(-1e-7, 1e-7, run.shape)
            paths.append(run[::-1] if random.integers(2) else run)
    random.shuffle(order := list(range(len(paths))))
    lines = ["M" + "L".join(f"{x!r} {y!r}" for x, y in paths[k].tolist()) for k in order]
    shape = svg(stroked(*lines), close=True)
    assert shape.loop_count == count
    assert_allclose(sorted(np.abs(areas(shape))), sorted(wanted), rtol=1e-5)
    assert shape.notes == (f"joined end to end: {len(paths)} open paths, to {count}",)


# --- left out ----------------------------------------------------------------------------------


def test_open_paths_beside_closed_ones_are_left_out_and_named(svg: Svg) -> None:
    body = stroked("M0 0H4V3H0Z M1 1H2") + '<path id="cut" fill="none" d="M5 5V6"/>'
    shape = svg(body + '<rect width="1" height="1" fill="none"/>')
    assert_allclose(np.abs(areas(shape)), [12.0], rtol=ROUNDING)
    assert shape.notes == (
        "left out: 1 unpainted path, 1 unpainted rect",
        "left out: 1 open path, <path> from (1, 1) to (2, 1): close=True (--close) closes such",
    )
    body = '<path id="cut" fill="none" stroke="red" d="M5 5V6"/>' + stroked("M0 0H4V3H0Z M1 1H2")
    assert svg(body).notes == (
        "left out: 2 open paths, the first <path id='cut'> from (5, 5) to (5, 6): "
        "close=True (--close) closes such",
    )
    assert svg(body, close=True).notes == ()
    assert svg(body, close=True).loop_count == 1 + 2


def test_what_is_left_out_has_no_say_in_the_fill_rule(svg: Svg) -> None:
    line = '<path fill="none" stroke="red" fill-rule="evenodd" d="M5 5V6"/>'
    assert svg(line + '<path d="M0 0H3V3H0Z"/>').fill == "nonzero"


@pytest.mark.parametrize("point", ["", "M7 7L7 7"])
def test_nothing_closed_is_refused(svg: Svg, point: str) -> None:
    with pytest.raises(ss.OpenContourError, match=r"contour 1 ends at \(4, 3\)"):
        svg(stroked("M0 0H4V3", "M9 9H8V7", *filter(None, [point])))


def test_a_gap_that_is_small_only_beside_what_is_left_out(svg: Svg) -> None:
    """Closed beside a line of 1e4, open by itself: left out, too, or all is refused."""
    body = stroked("M0 0H4V3H0V0.001", "M0 0H10000")
    with pytest.raises(ss.OpenContourError, match="contour 2"):
        svg(body)
    shape = svg(body + stroked("M9 9h4v4h-4z"))
    assert shape.loop_count == 1
    assert shape.notes[0].startswith("left out: 2 open paths, the first <path> from (0, 0) to (10")


def test_paths_given_one_by_one_are_not_left_out() -> None:
    with pytest.raises(ss.OpenContourError, match="contour 2"):
        ss.Shape.from_svg_path("M0 0H4V3H0Z M1 1H2")


# --- what one unit is --------------------------------------------------------------------------

SQUARE = '<rect width="9" height="9"/>'


@pytest.mark.parametrize(
    ("root", "said", "length"),
    [
        ('width="100mm" height="50mm" viewBox="0 0 378 189"', "100mm for 378 units", "0.26455 mm"),
        ('width="10cm" viewBox="0 0 10 10"', "10cm for 10 units", "10 mm"),
        ('height="72pt" viewBox="-3,5 10 36"', "72pt for 36 units", "0.70556 mm"),
        ('width="6PC" viewBox="0 0 1 1"', "6pc for 1 units", "25.4 mm"),
        ('width="400Q" viewBox="0 0 50 1"', "400q for 50 units", "2 mm"),
        ('width="2in" height="2in" viewBox="0 0 144 144"', "2in for 144 units", "0.013889 inch"),
        ('width="210mm"', "210mm without a viewBox", "0.26458 mm"),
        ('width="1e2mm" viewBox="0 0 0 9"', "100mm without a viewBox", "0.26458 mm"),
        ('width="8in" viewBox="bad"', "8in without a viewBox", "0.010417 inch"),
        # The drawing fits into the smaller side, or covers the larger one.
        ('width="90mm" height="20mm" viewBox="0 0 10 10"', "20mm for 10 units", "2 mm"),
        (
            'width="90mm" height="20mm" viewBox="0 0 10 10" preserveAspectRatio="xMidYMid slice"',
            "90mm for 10 units",
            "9 mm",
        ),
    ],
)
def test_a_unit_that_files_cannot_have_is_told_once(
    svg: Svg, root: str, said: str, length: str
) -> None:
    assert svg(SQUARE, root=root).notes == (
        f"the drawing says {said}: one unit is {length}; DXF and G-code are written in "
        "millimeters, or inches (--units inch)",
    )


def test_a_stretched_drawing_has_two_factors(svg: Svg) -> None:
    root = 'width="20mm" height="90mm" viewBox="0 0 10 10" preserveAspectRatio="none"'
    (note,) = svg(SQUARE, root=root).notes
    assert "20mm for 10 units across and 90mm for 10 units down" in note


@pytest.mark.parametrize(
    "root",
    [
        "",
        'viewBox="0 0 9 9"',
        'width="100" height="50" viewBox="0 0 378 189"',
        'width="100px" viewBox="0 0 378 189"',
        'width="100%" height="100%" viewBox="0 0 378 189"',
        'width="3em" viewBox="0 0 378 189"',
        'width="120mm" height="80mm" viewBox="0 0 120 80"',
        'width="209.99999mm" viewBox="0 0 210 297"',
        'width="4in" height="3in" viewBox="0 0 4 3"',
        'width="mm" viewBox="0 0 4 3"',
        'width="-4mm" viewBox="0 0 4 3"',
        'width="1 2mm" viewBox="0 0 4 3"',
        'width="1,2mm" viewBox="0 0 4 3"',
        'width="0mm" viewBox="0 0 4 3"',
    ],
)
def test_no_note_where_there_is_nothing_to_convert(svg: Svg, root: str) -> None:
    assert svg(SQUARE, root=root).notes == ()
