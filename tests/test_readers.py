"""Files of every kind, right and wrong, read through the public `read`."""

import itertools
import json
import math
import os
import time
from pathlib import Path

import numpy as np
import pytest
import svgelements
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import splinesdf as ss
from splinesdf.curves.shape import evaluate_bezier
from splinesdf.io.input import read_points
from splinesdf.io.readers import READERS
from tests.shapes import FORMULAS

DATA = Path(__file__).parent / "data"
SHIPPED = Path(ss.__file__).parent / "data"
GAUSS = np.polynomial.legendre.leggauss(8)  # exact up to degree 15, as x dy - y dx of degree 7 is
ROUNDING = 1e-12


@pytest.fixture
def svg(tmp_path: Path):
    def read(body: str, *, root: str = "", **options: object) -> ss.Shape:
        file = tmp_path / "drawing.svg"
        file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {root}>{body}</svg>', "utf-8")
        return ss.read(file, **options)

    return read


def areas(shape: ss.Shape) -> list[float]:
    """Each loop's signed area, exact up to rounding: half the integral of x dy - y dx."""
    nodes, weights = 0.5 + 0.5 * GAUSS[0], 0.5 * GAUSS[1]
    result = []
    for first, last in itertools.pairwise(shape.loops):
        total = 0.0
        for piece in (shape.piece(i) for i in range(first, last)):
            points = evaluate_bezier(piece, nodes)
            slopes = evaluate_bezier((len(piece) - 1) * np.diff(piece, axis=0), nodes)
            total += weights @ (points[:, 0] * slopes[:, 1] - points[:, 1] * slopes[:, 0])
        result.append(0.5 * float(total))
    return result


def corners(shape: ss.Shape) -> list[list[float]]:
    return [shape.piece(i)[0].tolist() for i in range(shape.piece_count)]


# --- SVG: real files ---------------------------------------------------------------------------


def test_the_part_has_its_holes() -> None:
    shape = ss.read(SHIPPED / "part.svg")
    assert (shape.name, shape.fill, shape.y_down, shape.notes) == ("part", "evenodd", True, ())
    assert shape.loop_count == 9
    # Outside the bolt circle, in the plate, in the bore, in a bolt hole, in the slot.
    points = [[1.0, 1.0], [100.0, 35.0], [38.0, 40.0], [56.4, 58.4], [88.0, 40.0]]
    assert np.sign(ss.signed_distance(shape, points)).tolist() == [1, -1, 1, 1, 1]
    assert_allclose(sorted(np.abs(areas(shape)))[2:6], math.pi * 3.5**2, rtol=1e-9)


@pytest.mark.parametrize(
    ("file", "inside", "hole"),
    [("gear-fill.svg", [8.0, 4.0], [8.0, 8.0]), ("geo-alt-fill.svg", [8.0, 2.0], [8.0, 6.0])],
)
def test_icons_have_one_hole(file: str, inside: list[float], hole: list[float]) -> None:
    shape = ss.read(DATA / file)
    assert shape.loop_count == 2
    assert shape.fill == "nonzero"
    assert np.sign(ss.signed_distance(shape, [inside, hole])).tolist() == [-1, 1]


def test_what_write_writes_can_be_read(tmp_path: Path) -> None:
    contours = ss.offset(ss.read(SHIPPED / "part.svg"), [-1.0], tolerance=1e-2)
    ss.write(tmp_path / "offset.svg", contours)
    shape = ss.read(tmp_path / "offset.svg")
    assert shape.fill == "evenodd"  # a drawing of outlines
    assert shape.loop_count == len(contours)
    assert_allclose(np.sum(np.abs(areas(shape))), sum(abs(c.area) for c in contours), rtol=1e-6)


# --- SVG: shapes -------------------------------------------------------------------------------


def test_circle_and_ellipse(svg) -> None:
    circle, ellipse = areas(svg('<circle cx="5" cy="-3" r="2px"/><ellipse rx="3" ry=".5"/>'))
    assert_allclose([circle, ellipse], [4 * math.pi, 1.5 * math.pi], rtol=ROUNDING)
    assert_allclose(
        svg('<circle cx="5" cy="-3" r="2"/>').box, (3, -5, 7, -1), rtol=0, atol=ROUNDING
    )


@pytest.mark.parametrize(
    ("radii", "rx", "ry"),
    [
        ("", 0, 0),
        ('rx="1"', 1, 1),
        ('ry="1"', 1, 1),
        ('rx="auto" ry="1"', 1, 1),
        ('rx="1" ry="2"', 1, 2),
        ('rx="99" ry="1"', 5, 1),
        ('rx="99"', 5, 3),
        ('rx="0" ry="2"', 0, 0),
    ],
)
def test_rect_follows_the_rules_for_its_radii(svg, radii: str, rx: float, ry: float) -> None:
    shape = svg(f'<rect x="1" y="2" width="10" height="6" {radii}/>')
    assert_allclose(shape.box, (1, 2, 11, 8), rtol=0, atol=ROUNDING)
    assert_allclose(areas(shape), 60 - (4 - math.pi) * rx * ry, rtol=ROUNDING)


def test_polygon_and_polyline(svg) -> None:
    for body in (
        '<polygon points="0,0 4,0 4,3"/>',
        '<polyline points="0 0 4 0 4 3"/>',
        '<polyline fill="none" points="0 0 4 0 4 3 0 0"/>',
    ):
        assert corners(svg(body)) == [[0, 0], [4, 0], [4, 3]]


def test_documents_without_namespace_and_with_a_plain_doctype(tmp_path: Path) -> None:
    file = tmp_path / "old.svg"
    file.write_text(
        '<?xml version="1.0" encoding="iso-8859-1"?>\n<!DOCTYPE svg PUBLIC '
        '"-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">'
        '<svg><circle r="1"/></svg>',
    )
    assert ss.read(file).loop_count == 1


# --- SVG: transforms ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("transform", "expected"),
    [
        ("", [1, 0]),
        ("none", [1, 0]),
        ("translate(3)", [4, 0]),
        ("translate(3-4)", [4, -4]),
        ("scale(2)", [2, 0]),
        ("scale(2,5) translate(1 1)", [4, 5]),
        ("translate(1 1) scale(2,5)", [3, 1]),
        ("rotate(90)", [0, 1]),
        ("rotate(90, 1, 1)", [2, 1]),
        ("skewX(45)", [1, 0]),
        ("skewY(45)", [1, 1]),
        ("matrix(1 2 3 4 5 6)", [6, 8]),
        (" translate( 1 , 2 )\n,rotate(180)", [0, 2]),
    ],
)
def test_transforms_by_hand(svg, transform: str, expected: list[float]) -> None:
    shape = svg(f'<path transform="{transform}" d="M1 0L0 1 0 0Z"/>')
    assert_allclose(corners(shape)[0], expected, rtol=0, atol=1e-15)


SMALL = st.integers(-300, 300).map(lambda n: n / 100)
STEP = st.one_of(
    st.builds("translate({},{})".format, SMALL, SMALL),
    st.builds("scale({} {})".format, SMALL, SMALL),
    st.builds("rotate({})".format, st.integers(-400, 400)),
    st.builds("rotate({} {} {})".format, st.integers(-400, 400), SMALL, SMALL),
    st.builds("skewX({})".format, st.integers(-60, 60)),
    st.builds("skewY({})".format, st.integers(-60, 60)),
    st.builds("matrix({} {} {} {} {} {})".format, *[SMALL] * 6),
)


@given(
    outer=st.lists(STEP, max_size=3).map(" ".join), inner=st.lists(STEP, max_size=3).map(" ".join)
)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_nested_transforms_agree_with_svgelements(svg, outer: str, inner: str) -> None:
    matrix = svgelements.Matrix(inner) * svgelements.Matrix(outer)
    triangle = [(1.0, 2.0), (5.0, 3.0), (4.0, 7.0)]
    expected = [list(matrix.point_in_matrix_space(point)) for point in triangle]
    size = np.abs(expected).max()
    if abs(matrix.a * matrix.d - matrix.b * matrix.c) < 1e-6 * max(size, 1.0) ** 2:
        return  # so flat that leaving it out would be right
    shape = svg(
        f'<g transform="{outer}"><g transform="{inner}"><path d="M1 2L5 3 4 7Z"/></g></g>',
    )
    assert_allclose(corners(shape), expected, rtol=0, atol=1e-13 * size)


def test_an_ellipse_under_a_skew_keeps_its_area(svg) -> None:
    shape = svg('<g transform="skewX(30) scale(-2 3)"><circle cx="1" r="2"/></g>')
    assert_allclose(areas(shape), -6 * 4 * math.pi, rtol=ROUNDING)


def test_groups_nested_deeper_than_pythons_calls(svg) -> None:
    depth = 5000
    body = '<g transform="translate(1)">' * depth + '<circle r="1"/>' + "</g>" * depth
    assert_allclose(svg(body).box, (depth - 1, -1, depth + 1, 1), rtol=ROUNDING)


# --- SVG: what is drawn ------------------------------------------------------------------------

CIRCLE = '<circle r="1"/>'


@pytest.mark.parametrize(
    "tag", ["defs", "clipPath", "mask", "marker", "pattern", "symbol", "metadata"]
)
def test_what_is_not_drawn_is_no_boundary(svg, tag: str) -> None:
    shape = svg(f"<{tag}><g>{CIRCLE}</g></{tag}>{CIRCLE}")
    assert shape.loop_count == 1
    assert shape.notes == ()


@pytest.mark.parametrize(
    "hidden",
    ['display="none"', 'style="fill:red; display : none !important"', 'visibility="hidden"'],
)
def test_hidden_elements_are_skipped_with_all_in_them(svg, hidden: str) -> None:
    assert svg(f"<g {hidden}><g>{CIRCLE}<text/></g></g>{CIRCLE}").loop_count == 1
    with pytest.raises(ss.InputError, match="got none"):
        svg(f"<g {hidden}>{CIRCLE}</g>")


def test_a_child_may_be_visible_in_a_hidden_group(svg) -> None:
    shape = svg(f'<g visibility="hidden">{CIRCLE}<circle r="2" visibility="visible"/></g>')
    assert_allclose(areas(shape), 4 * math.pi, rtol=ROUNDING)


def test_what_is_left_out_is_named(svg) -> None:
    shape = svg(
        f'<title/><g><text/><image/><text>a</text></g>{CIRCLE}<line x2="5"/><use href="#a"/>'
        '<svg viewBox="0 0 1 1"><circle r="9"/></svg><rect width="5"/><path d="M0 0H5"/>'
        '<defs><style>.a{fill:none}</style></defs><circle r="9" fill="none"/>'
        '<x:y xmlns:x="elsewhere"/>'
    )
    assert_allclose(areas(shape), math.pi, rtol=ROUNDING)
    assert shape.notes == (
        "left out: 2 text, 1 image, 1 line, 1 use, 1 svg with a viewBox, 1 rect without area, "
        "1 path without area, 1 style, 1 unpainted circle",
    )


def test_what_is_not_applied_is_named(svg) -> None:
    shape = svg(f'<g clip-path="url(#a)"><g style="mask:url(#b);transform:none">{CIRCLE}</g></g>')
    assert shape.notes == ("not applied: 1 clip-path, 1 mask, 1 transform in a style",)


def test_nested_svg_without_a_view_box_is_moved(svg) -> None:
    assert svg(f'<svg x="3" y="4px">{CIRCLE}</svg>').box == svg('<circle cx="3" cy="4" r="1"/>').box


# --- SVG: fill ---------------------------------------------------------------------------------

RING = '<path d="M0 0H3V3H0Z M1 1H2V2H1Z" {}/>'


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (RING.format(""), "nonzero"),
        (RING.format('fill-rule="evenodd"'), "evenodd"),
        (RING.format('style="fill-rule: evenodd"'), "evenodd"),
        (RING.format('fill-rule="nonzero" style="fill-rule:evenodd"'), "evenodd"),
        (f'<g fill-rule="evenodd"><g>{RING.format("")}</g></g>', "evenodd"),
        (f'<g fill-rule="evenodd">{RING.format("fill-rule=`nonzero`")}</g>', "nonzero"),
        (f'<g fill-rule="evenodd">{RING.format("fill-rule=`inherit`")}</g>', "evenodd"),
        (RING.format('fill="none"'), "evenodd"),
        (RING.format('fill="none" stroke="red"'), "evenodd"),
        (RING.format('style="fill:none"') + RING.format('fill="none"'), "evenodd"),
        (RING.format('fill="none" fill-rule="nonzero"'), "nonzero"),
        (RING.format('fill="none" stroke="red"') + RING.format(""), "nonzero"),
        (RING.format('fill-rule="evenodd"') + '<circle r="1"/>', "evenodd"),
    ],
)
def test_the_fill_rule_comes_from_the_file(svg, body: str, expected: str) -> None:
    shape = svg(body.replace("`", '"'))
    assert shape.fill == expected
    sign = 1 if expected == "evenodd" else -1
    if shape.loop_count == 2:  # both squares turn the same way
        assert np.sign(ss.signed_distance(shape, [1.5, 1.6])) == sign
    other = "nonzero" if expected == "evenodd" else "evenodd"
    assert svg(body.replace("`", '"'), fill=other).fill == other


def test_two_fill_rules_in_one_file_ask_for_a_choice(svg) -> None:
    body = RING.format('fill-rule="evenodd"') + RING.format("")
    with pytest.raises(ss.InputError, match="pass fill="):
        svg(body)
    assert svg(body, fill="evenodd").loop_count == 4


def test_a_fill_closes_open_subpaths_and_a_stroke_does_not(svg) -> None:
    assert corners(svg('<path d="M0 0H4V3"/>')) == [[0, 0], [4, 0], [4, 3]]
    for tag in ('path d="M0 0H4V3"', 'polyline points="0 0 4 0 4 3"'):
        for fill in ("none", 'none" stroke="red'):
            with pytest.raises(ss.OpenContourError, match=r"^drawing\.svg: .*contour 1 ends at"):
                svg(f'<{tag} fill="{fill}"/>')
        assert corners(svg(f'<{tag} fill="none"/>', close=True)) == [[0, 0], [4, 0], [4, 3]]


# --- SVG: bad input ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('<rect width="5mm" height="1"/>', "<rect>: expected width .* got '5mm'"),
        ('<rect width="50%" height="1"/>', "got '50%'"),
        ('<circle id="c\n1" r="1em"/>', "<circle id='c 1'>: expected r .* got '1em'"),
        ('<circle r="-1"/>', "expected r not to be negative, got -1"),
        ('<circle r="1 2"/>', "expected r as a number"),
        ('<circle r=""/>', "expected r as a number"),
        ('<circle cx="nan" r="1"/>', "expected cx as a number"),
        ('<rect width="5" height="5" rx="-1"/>', "expected rx not to be negative"),
        ('<path d="M0 0 L1"/>', "<path>: expected a number at character 8"),
        ('<polygon points="1 2 3"/>', "expected x and y of every point, got 3 numbers"),
        ('<polygon points="1 2 x"/>', "expected a number at character 5"),
        ('<g transform="turn(3)"/>', "<g>: expected the transform .* got turn with 1"),
        ('<g transform="scale(1 2 3)"/>', "got scale with 3"),
        ('<g transform="rotate(4deg)"/>', "expected a number at character 2"),
        ('<g transform="rotate 4"/>', "expected a list of transforms .* got 'rotate 4'"),
        ('<g transform="scale(2"/>', r"got 'scale\(2'"),
        ("", r"enclos\w+ something, got none$"),
        ("<text/><use/>", r"got none \(left out: 1 text, 1 use\)"),
        ('<circle r="0"/>', "1 circle without area"),
        ('<circle r="1" transform="scale(0)"/>', "1 circle without area"),
        ('<g transform="scale(1e99)"><g transform="scale(1e99)"><g transform="scale(1e99)">'
         '<g transform="scale(1e99)"><circle r="1"/></g></g></g></g>', "expected finite"),
        ("<g>", "no well-formed XML"),
        ("&auml;", "no well-formed XML"),
        ("\x01", "no well-formed XML"),
    ],
)  # fmt: skip
def test_bad_drawings_are_refused_in_one_line(svg, body: str, expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected) as caught:
        svg(body)
    assert_one_line(caught.value, "drawing.svg")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<html/>", "root <html>"),
        ('<svg xmlns="elsewhere"/>', "root <{elsewhere}svg>"),
        ("plain text", "no well-formed XML"),
        ('<!DOCTYPE svg [<!ENTITY a "b">]><svg/>', "entities"),
        ('<!DOCTYPE svg SYSTEM "a" [ ]><svg/>', "entities"),
        (
            '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;">]><svg>&b;</svg>',
            "entities",
        ),
    ],
)
def test_what_is_no_svg_is_refused(tmp_path: Path, text: str, expected: str) -> None:
    (tmp_path / "a.svg").write_text(text)
    with pytest.raises(ss.InputError, match=expected) as caught:
        ss.read(tmp_path / "a.svg")
    assert_one_line(caught.value, "a.svg")


def assert_one_line(error: Exception, name: str) -> None:
    assert str(error).startswith(f"{name}: ")
    assert "\n" not in str(error)
    assert len(str(error)) < 300


# --- formulas ----------------------------------------------------------------------------------


@pytest.fixture
def formulas(tmp_path: Path):
    def read(content: object, **options: object) -> ss.Shape:
        text = content if isinstance(content, str) else json.dumps(content)
        (tmp_path / "curve.json").write_text(text)
        return ss.read(tmp_path / "curve.json", **options)

    return read


@pytest.mark.parametrize("name", FORMULAS)
def test_the_shipped_formulas_are_the_papers(name: str) -> None:
    shape = ss.read(SHIPPED / f"{name}.json")
    expected = ss.Shape.from_formula(*FORMULAS[name])
    assert np.array_equal(shape.control, expected.control)
    assert (shape.name, shape.y_down) == (name, False)


def test_several_loops_and_a_default_range(formulas) -> None:
    ring = {
        "name": "ring",
        "fill": "evenodd",
        "loops": [
            {"x": "3*cos(t)", "y": "3*sin(t)"},
            {"x": "cos(2*t)", "y": "sin(2*t)", "t": ["-pi/2", 1.5707963267948966]},
        ],
    }
    shape = formulas(ring)
    assert (shape.name, shape.fill, shape.loop_count) == ("ring", "evenodd", 2)
    assert_allclose(areas(shape), [9 * math.pi, math.pi], rtol=ROUNDING)
    assert formulas(ring, fill="nonzero").fill == "nonzero"


def test_the_name_is_the_files_if_there_is_none_in_it(formulas) -> None:
    shape = formulas({"x": "cos(t)", "y": "sin(t)"})
    assert (shape.name, shape.fill) == ("curve", "nonzero")


def test_an_open_formula(formulas) -> None:
    half = {"x": "cos(t)", "y": "sin(t)", "t": [0, "pi"]}
    with pytest.raises(ss.OpenContourError):
        formulas(half)
    assert_allclose(areas(formulas(half, close=True)), math.pi / 2, rtol=ROUNDING)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("{", "as JSON"),
        ("[" * 100_000, "as JSON"),
        ("1" * 10_000, "as JSON|got a number"),
        ([], "JSON object .* got an empty list"),
        ("null", "got null"),
        ("true", "got true"),
        ({}, 'formula in quotes for "x", got nothing'),
        ({"x": "t"}, 'for "y", got nothing'),
        ({"x": 1, "y": "t"}, 'for "x", got a number'),
        ({"x": "cos(t)", "y": "sin(t)", "z": "0", "w": 1}, "only the keys x, .* got 'z', 'w'"),
        ({"x": "cos(t)", "y": "sin(t)", "t": [0]}, r"\[start, stop\]"),
        ({"x": "cos(t)", "y": "sin(t)", "t": [0, None]}, r"\[start, stop\]"),
        ({"x": "cos(t)", "y": "sin(t)", "t": [0, True]}, r"\[start, stop\]"),
        ({"x": "cos(t)", "y": "sin(t)", "t": [1, 0]}, "start < stop"),
        ('{"x": "cos(t)", "y": "sin(t)", "t": [0, NaN]}', "finite range"),
        ('{"x": "cos(t)", "y": "sin(t)", "t": [0, 1' + "0" * 400 + "]}", "range of t"),
        ({"x": "cos(t)", "y": "__import__('os')"}, "not allowed in a formula"),
        ({"x": "cos(t)", "y": "sin(t)", "fill": "odd"}, "nonzero"),
        ({"x": "cos(t)", "y": "sin(t)", "fill": 1}, 'text for "fill", got a number'),
        ({"x": "cos(t)", "y": "sin(t)", "name": []}, 'text for "name"'),
        ({"loops": []}, '"loops" to be a list of curves, got an empty list'),
        ({"loops": {"x": "t"}}, '"loops" to be a list of curves, got an object'),
        ({"loops": ["t"]}, "loop 1: expected an object .* got text"),
        ({"loops": [{"x": "cos(t)", "y": "sin(t)"}, {"x": "t"}]}, 'loop 2: .* "y"'),
        ({"loops": [{"x": "cos(t)", "y": "sin(t)", "name": "a"}]}, "loop 1: .* got 'name'"),
        ({"loops": [], "x": "t"}, "got 'x'"),
    ],
)
def test_bad_formulas_are_refused_in_one_line(formulas, content: object, expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected) as caught:
        formulas(content)
    assert_one_line(caught.value, "curve.json")


# --- points ------------------------------------------------------------------------------------


@pytest.fixture
def table(tmp_path: Path):
    def write(text: str, suffix: str = ".csv") -> Path:
        file = tmp_path / f"points{suffix}"
        file.write_bytes(text.encode())
        return file

    return write


@pytest.mark.parametrize(
    "text",
    [
        "0,0\n4,0\n4,3\n",
        "0 0\n4  0\n 4 3 ",
        "0;0\r\n4;0\r\n4;3",
        "0\t0\r4\t0\r4\t3",
        "\ufeffx,y\n0, 0\n4 ,0\n4,3\n0,0\n",
        "# corners\nx;y\n\n0,0 # the first\n# none here\n4,0\n4,3\n\n\n",
        "NACA 0012\n0 0\n4.0e0 -0\n+4 3\n",
    ],
)
@pytest.mark.parametrize("suffix", [".csv", ".DAT"])
def test_points_in_all_ways_of_writing(table, text: str, suffix: str) -> None:
    shape = ss.read(table(text, suffix))
    assert sorted(corners(shape)) == [[0, 0], [4, 0], [4, 3]]
    assert areas(shape) == [6.0]
    assert (shape.name, shape.fill, shape.y_down) == ("points", "nonzero", False)


def test_blank_lines_separate_loops(table) -> None:
    file = table("0,0\n4,0\n4,4\n0,4\n\n \n1,1\n2,1\n# no end\n2,2\n")
    assert_allclose(areas(ss.read(file, fill="evenodd")), [16.0, 0.5])
    assert len(read_points(file)) == 7


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0,0\n1,0\n1,x\n", "line 3: expected a number, got 'x'"),
        ("x,y\n\n1,2,3\n", "line 3: expected 2 columns, x and y, got 3"),
        ("1\n2\n", "line 1: expected 2 columns, x and y, got 1"),
        ("1,x\n2,3\n", "line 1: expected a number, got 'x'"),
        ("x,y\nz,w\n", "line 2: expected a number, got 'z'"),
        ("0,0\n1,\n", "line 2: expected a number, got ''"),
        ("1,5;2,5\n", "line 1: expected a number, got '1,5'"),
        ("0,0\n1,1\n0,1e999", "line 3: expected finite numbers"),
        ("0,0\nnan,1\n0,1", "line 2: expected finite numbers"),
        ("x,y\n# nothing", "expected points, .* got none"),
        ("0,0\n1,1\n", "points from line 1 on: expected at least 3 distinct points, got 2"),
        ("0,0\n1,1\n1,0\n\n5,5\n", "points from line 5 on: expected at least 3"),
    ],
)
def test_bad_points_are_refused_with_their_line(table, text: str, expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected) as caught:
        ss.read(table(text))
    assert_one_line(caught.value, "points.csv")


def test_points_to_ask_about_may_be_nan(table) -> None:
    points = read_points(table("x,y\n1,2\n\nnan,3\n1,inf\n"))
    assert points.shape == (3, 2)
    assert np.array_equal(points, [[1, 2], [np.nan, 3], [1, np.inf]], equal_nan=True)
    for bad in ("1,2\n1,2,3", "a,b\n", "1,2\n1,two"):
        with pytest.raises(ss.InputError, match=r"^points\.csv: "):
            read_points(table(bad))


def test_many_points_are_read_quickly(table) -> None:
    t = np.linspace(0.0, 2.0 * np.pi, 100_000, endpoint=False)
    file = table(
        "\n".join(
            f"{x!r},{y!r}" for x, y in zip(np.cos(t).tolist(), np.sin(t).tolist(), strict=True)
        )
    )
    begin = time.process_time()
    shape = ss.read(file)
    assert time.process_time() - begin < 3.0  # a third of that on an idle machine
    assert shape.piece_count == 100_000


# --- files -------------------------------------------------------------------------------------

PNG = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"


@pytest.mark.parametrize("suffix", READERS)
@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "empty"),
        (b"\xef\xbb\xbf \r\n\t", "empty"),
        (PNG, "expected text in UTF-8, got something else at byte 1"),
        ("<svg/>".encode("utf-16"), "UTF-8"),
        ("1,2 # caf\N{LATIN SMALL LETTER E WITH ACUTE}".encode("latin-1"), "at byte 10"),
        (b"PK\x03\x04\0\0", "binary data"),
    ],
)
def test_wrong_content_is_refused(
    tmp_path: Path, suffix: str, content: bytes, expected: str
) -> None:
    file = tmp_path / f"a{suffix}"
    file.write_bytes(content)
    with pytest.raises(ss.InputError, match=expected) as caught:
        ss.read(file)
    assert_one_line(caught.value, file.name)


def test_wrong_paths_are_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.svg").mkdir()
    os.mkfifo(tmp_path / "pipe.svg")
    (tmp_path / "loop.svg").symlink_to(tmp_path / "loop.svg")
    for name, expected in [
        ("nowhere.svg", "does not exist"),
        ("folder.svg", "got a folder"),
        ("pipe.svg", "pipe or a device"),
        ("loop.svg", "cannot be read"),
        ("folder.svg/a.svg/b.svg", "does not exist"),
        ("shape.docx", r"ending in \.csv, \.dat, \.json, \.svg, got '\.docx'"),
        ("shape", "got 'none'"),
    ]:
        with pytest.raises(ss.InputError, match=expected) as caught:
            ss.read(tmp_path / name)
        assert_one_line(caught.value, Path(name).name)
    for bad in (5, None, b"a.svg"):
        with pytest.raises(ss.InputError, match="expected a file's path, got"):
            ss.read(bad)  # type: ignore[arg-type]
    with pytest.raises(ss.InputError, match="null byte"):
        ss.read("a\0b.svg")
    with pytest.raises(ss.InputError, match="does not exist") as caught:
        ss.read("two\nlines.svg")
    assert "\n" not in str(caught.value)


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is unreadable to the superuser")
def test_an_unreadable_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.svg"
    file.write_text("<svg/>")
    file.chmod(0)
    with pytest.raises(ss.InputError, match="cannot be read: Permission denied"):
        ss.read(file)


def test_the_extension_may_be_in_capitals(tmp_path: Path) -> None:
    file = tmp_path / "A.SVG"
    file.write_text("<svg><circle r='1'/></svg>")
    assert ss.read(str(file)).name == "A"


def test_an_unknown_fill_is_refused(svg) -> None:
    for fill in ("odd", ""):
        with pytest.raises(ss.InputError, match="expected fill 'nonzero' or 'evenodd'"):
            svg(CIRCLE, fill=fill)


FRAGMENTS = st.lists(
    st.sampled_from(
        [
            "<svg>", "</svg>", "<g>", "</g>", "<path d='M0 0", "h1v1", "z'/>", "<circle r='", "1",
            "'/>", "<rect width='3' height='", "transform='scale(", ")'", " fill='none'", "<!--",
            "{", "}", '"x":', '"cos(t)"', '"y":', '"sin(t)"', '"t":', "[", "]", ",", "0", "1e9",
            "-2.5", "\n", " ", ";", "#", "nan", "1e-320", "1e300", "\t", "'",
        ]
    )
).map("".join)  # fmt: skip


@given(FRAGMENTS | st.text())
@example("<svg><path d='M0 0h1v1z' transform='scale(1e-320)'/></svg>")
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_text_is_read_or_refused(tmp_path: Path, text: str) -> None:
    for suffix in READERS:
        file = tmp_path / f"a{suffix}"
        file.write_bytes(text.encode("utf-8", "surrogatepass"))
        for content in (text, f"<svg>{text}</svg>"):
            file.write_bytes(content.encode("utf-8", "surrogatepass"))
            try:
                shape = ss.read(file, close=True)
            except ss.InputError:
                continue
            assert shape.piece_count > 0
