"""SVG documents, right and wrong, read through the public `read`."""

import math
from pathlib import Path

import numpy as np
import pytest
import svgelements
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import splinesdf as ss
from tests.reading import ROUNDING, areas, assert_one_line, corners

DATA = Path(__file__).parents[1] / "data"
SHIPPED = Path(ss.__file__).parent / "data"


@pytest.fixture
def svg(tmp_path: Path):
    def read(body: str, *, root: str = "", **options: object) -> ss.Shape:
        file = tmp_path / "drawing.svg"
        file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {root}>{body}</svg>', "utf-8")
        return ss.read(file, **options)

    return read


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
        assert corners(svg(body, stroke="centre")) == [[0, 0], [4, 0], [4, 3]]


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
    # Flatter, leaving it out would be right.
    assume(abs(matrix.a * matrix.d - matrix.b * matrix.c) >= 1e-6 * max(size, 1.0) ** 2)
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
        '<rect width="5"/><path d="M0 0H5"/><g display="none"/><circle r="9" visibility="hidden"/>'
        '<defs><style>.a{fill:none}</style></defs><circle r="9" fill="none"/>'
        '<x:y xmlns:x="elsewhere"/>'
    )
    assert_allclose(areas(shape), math.pi, rtol=ROUNDING)
    assert shape.notes == (
        "left out: 2 text, 1 image, 1 use of nothing in the file, 1 rect without area, 1 hidden g, "
        "1 hidden circle, 1 line without area, 1 path without area, 1 unpainted circle",
    )


def test_nested_svg_without_a_view_box_is_moved(svg) -> None:
    moved = svg(f'<svg x="3" y="4px" overflow="visible">{CIRCLE}</svg>')
    assert moved.box == svg('<circle cx="3" cy="4" r="1"/>').box


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
        (RING.format('fill="none" stroke="red"') + RING.format(""), "nonzero"),
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


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (RING.format('fill="none"'), "evenodd"),
        (RING.format('fill="none" stroke="red"'), "evenodd"),
        (RING.format('style="fill:none"') + RING.format('fill="none"'), "evenodd"),
        (RING.format('fill="none" fill-rule="nonzero"'), "nonzero"),
    ],
)
def test_the_rule_of_lines_is_evenodd_unless_they_say_otherwise(svg, body, expected) -> None:
    shape = svg(body, stroke="centre")
    assert shape.fill == expected
    assert shape.loop_count == 2
    with pytest.raises(ss.InputError, match=r"stroke='centre' \(--stroke centre\)"):
        svg(body)


def test_a_fill_closes_open_subpaths_and_a_stroke_does_not(svg) -> None:
    assert corners(svg('<path d="M0 0H4V3"/>')) == [[0, 0], [4, 0], [4, 3]]
    for tag in ('path d="M0 0H4V3"', 'polyline points="0 0 4 0 4 3"'):
        for fill in ("none", 'none" stroke="red'):
            body = f'<{tag} fill="{fill}"/>'
            with pytest.raises(ss.OpenContourError, match=r"^drawing\.svg: .*contour 1 ends at"):
                svg(body, stroke="centre")
            closed = svg(body, close=True, stroke="centre")
            assert corners(closed) == [[0, 0], [4, 0], [4, 3]]


# --- SVG: bad input ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('<rect width="5furlong" height="1"/>', "<rect>: expected width .* got '5furlong'"),
        ('<circle id="c\n1" r="1m"/>', "<circle id='c 1'>: expected r .* got '1m'"),
        ('<circle r="-1"/>', "expected r not to be negative, got -1"),
        ('<circle r="1 2"/>', "expected r as a length"),
        ('<circle r=""/>', "expected r as a length"),
        ('<circle cx="nan" r="1"/>', "expected cx as a length"),
        ('<path d="M0 0 L1"/>', "<path>: expected a number at character 8"),
        ('<polygon points="1 2 3"/>', "expected x and y of every point, got 3 numbers"),
        ('<polygon points="1 2 x"/>', "expected a number at character 5"),
        ('<g transform="turn(3)"/>', "<g>: expected the transform .* got turn with 1"),
        ('<g transform="scale(1 2 3)"/>', "got scale with 3"),
        ('<g transform="rotate(4ell)"/>', "expected a number at character 2"),
        ('<g transform="rotate 4"/>', "expected a list of transforms .* got 'rotate 4'"),
        ('<g transform="scale(2"/>', r"got 'scale\(2'"),
        ("", r"enclos\w+ something, got none$"),
        ("<text/><use/>", r"got none \(left out: 1 text, 1 use of nothing in the file\)"),
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
        ('<!DOCTYPE svg [<!ENTITY a SYSTEM "b">]><svg/>', "entities"),
        ('<!DOCTYPE svg [<!ENTITY % a "b">]><svg/>', "entities"),
        (f'<!DOCTYPE svg [<!ENTITY a "{"b" * 1001}">]><svg/>', "entities"),
        ("<!DOCTYPE svg [" + '<!ENTITY a "b">' * 65 + "]><svg/>", "entities"),
        ('<svg><!DOCTYPE a [<!ENTITY a "b">]></svg>', "well-formed"),
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
