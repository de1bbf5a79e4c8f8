"""A contour that is drawn twice counts once, but for a rule that is asked for; by shapely."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

import splinesdf as ss
from splinesdf.shapes.repeats import same_curve
from splinesdf.shapes.sources.compiled import polygon

OUTER = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.0, 8.0]])
HOLE = np.array([[2.0, 2.0], [5.0, 2.5], [4.0, 6.0]])
# More corners on the same sides.
CUT = np.array([[2.0, 2.0], [3.5, 2.25], [5.0, 2.5], [4.5, 4.25], [4.0, 6.0]])
OTHER = np.array([[6.0, 2.0], [8.0, 2.0], [8.0, 4.0]])
MOVED = np.array([7.0, -3.0])
PLATE = shapely.Polygon(OUTER, [HOLE])
TWO_HOLES = shapely.Polygon(OUTER, [HOLE, OTHER])
COPIES = {
    "as it is": HOLE,
    "another start": np.roll(HOLE, 1, axis=0),
    "reversed": HOLE[::-1],
    "reversed, another start": np.roll(HOLE[::-1], 1, axis=0),
    "cut": CUT,
    "cut, reversed": CUT[::-1],
    "to rounding": HOLE * (1.0 + 4e-16) + 4e-16,
}


def same_region(shape: ss.Shape, region: shapely.Polygon) -> None:
    """The shape fills the region, by the area of its boundary and the side of many points."""
    grid = np.stack(np.meshgrid(np.linspace(-1, 11, 61), np.linspace(-1, 9, 53)), -1).reshape(-1, 2)
    grid += np.array([0.0123, 0.0456])
    inside = ss.signed_distance(shape, grid) < 0.0
    assert np.array_equal(inside, shapely.contains_xy(region, grid[:, 0], grid[:, 1]))
    contours = ss.offset(shape, 0.0, tolerance=1e-9)
    assert sum(contour.area for contour in contours) == pytest.approx(region.area, rel=1e-9)
    assert len(contours) == 1 + len(region.interiors)


def d(*rings: np.ndarray) -> str:
    return "".join(
        "M" + "L".join(f"{float(x)!r} {float(y)!r}" for x, y in ring) + "Z" for ring in rings
    )


def drawing(*elements: str) -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg">{"".join(elements)}</svg>'


def read(folder: Path, name: str, text: str, **options: object) -> ss.Shape:
    path = folder / name
    path.write_text(text)
    return ss.read(path, **options)


def table(*rings: np.ndarray) -> str:
    return "\n\n".join("\n".join(f"{x!r} {y!r}" for x, y in ring.tolist()) for ring in rings)


def wound(*rings: np.ndarray) -> shapely.Polygon:
    """What contours as OUTER or HOLE fill under nonzero, by how often each winds around."""
    turns = [
        (1 if shapely.LinearRing(ring).is_ccw else -1, bool(np.ptp(ring[:, 0]) > 5))
        for ring in rings
    ]
    ring = sum(turn for turn, outer in turns if outer)
    hole = ring + sum(turn for turn, outer in turns if not outer)
    filled = ([PLATE] if ring else []) + ([shapely.Polygon(HOLE)] if hole else [])
    return shapely.union_all(filled)


@pytest.mark.parametrize("name", COPIES)
def test_a_drawing_under_nonzero_is_filled_as_it_is_shown(name: str, tmp_path: Path) -> None:
    """createreactapp.svg of simple-icons draws contours again, so that its petals are empty."""
    again = np.where(OUTER > 0.0, OUTER, 0.0) if name == "as it is" else OUTER[::-1]
    for rings in ((OUTER, HOLE[::-1], COPIES[name]), (OUTER, HOLE[::-1], again)):
        shape = read(tmp_path, "plate.svg", drawing(f'<path d="{d(*rings)}"/>'))
        assert shape.notes == ()
        same_region(shape, wound(*rings))


@pytest.mark.parametrize("name", COPIES)
def test_a_hole_drawn_twice_is_a_hole(name: str, tmp_path: Path) -> None:
    rings = OUTER, HOLE[::-1], COPIES[name]
    text = drawing(f'<path fill-rule="evenodd" d="{d(*rings)}"/>')
    shape = read(tmp_path, "plate.svg", text)
    assert shape.loop_count == 2
    (note,) = shape.notes
    assert "counted once: 1 (path 1: contour 3 as 2)" in note
    same_region(shape, PLATE)


@pytest.mark.parametrize("name", COPIES)
@pytest.mark.parametrize("times", [2, 3])
def test_an_outer_contour_drawn_again_is_one(name: str, times: int, tmp_path: Path) -> None:
    """Outside and hole would change sides."""
    shift = COPIES[name] - HOLE if name == "to rounding" else 0.0
    again = {
        "cut": np.insert(OUTER, 1, [[3.0, 0.0]], axis=0),
        "cut, reversed": np.insert(OUTER, 1, [[3.0, 0.0]], axis=0)[::-1],
        "another start": np.roll(OUTER, 1, axis=0),
        "reversed": OUTER[::-1],
        "reversed, another start": np.roll(OUTER[::-1], 1, axis=0),
    }.get(name, OUTER + np.max(shift))
    rings = [OUTER, HOLE[::-1], *[again] * (times - 1)]
    shape = read(tmp_path, "plate.svg", drawing(f'<path fill-rule="evenodd" d="{d(*rings)}"/>'))
    assert shape.loop_count == 2
    assert f"counted once: {times - 1} (" in shape.notes[0]
    same_region(shape, PLATE)
    shape = read(tmp_path, "plate.csv", table(*rings))
    same_region(shape, PLATE)


def test_opposite_contours_are_one_unless_the_rule_is_asked_for() -> None:
    path = d(OUTER, OUTER[::-1])
    shape = ss.Shape.from_svg_path(path)
    same_region(shape, shapely.Polygon(OUTER))
    assert "contour 2 as 1" in shape.notes[0]
    for rule in ("nonzero", "evenodd"):
        asked = ss.Shape.from_svg_path(path, fill=rule)
        assert (asked.loop_count, asked.notes) == (2, ())
        with pytest.raises(ss.InputError, match="fill nothing"):
            ss.signed_distance(asked, (1.0, 1.0))


def test_every_way_in(tmp_path: Path) -> None:
    rings = OUTER, HOLE[::-1], HOLE[::-1]
    loops = [polygon(ring) for ring in rings]
    outlines = "".join(f'<path fill="none" stroke="red" d="{d(ring)}"/>' for ring in rings)
    whole = f'<path fill-rule="evenodd" d="{d(OUTER, HOLE)}"/>'
    formulas = (
        '{"fill": "evenodd", "loops": [{"x": "5*cos(t)", "y": "5*sin(t)"}, '
        '{"x": "cos(t)", "y": "2*sin(t)"}, {"x": "sin(t)", "y": "2*cos(t)", "t": [1, "1+2*pi"]}]}'
    )
    ways = {
        "pieces": ss.Shape.from_pieces(loops),
        "svg path": ss.Shape.from_svg_path(d(*rings)),
        "csv": read(tmp_path, "a.csv", table(*rings)),
        "dat": read(tmp_path, "a.dat", table(*rings)),
        "mere outlines": read(tmp_path, "a.svg", drawing(outlines), stroke="centre"),
        "mere outlines, in one and apart": read(
            tmp_path,
            "c.svg",
            drawing(f'<path fill="none" stroke="red" d="{d(OUTER, HOLE)}"/>', outlines),
            stroke="centre",
        ),
        "an element again": read(tmp_path, "b.svg", drawing(whole, whole)),
        "an element again, moved": read(
            tmp_path,
            "d.svg",
            drawing(
                whole,
                f'<g transform="translate(-7 3)"><path fill-rule="evenodd" '
                f'd="{d(HOLE[::-1] + MOVED, OUTER + MOVED)}"/></g>',
            ),
        ),
    }
    for name, shape in ways.items():
        assert shape.loop_count == 2, name
        assert len(shape.notes) == 1, name
        same_region(shape, PLATE)
    ring = read(tmp_path, "a.json", formulas)
    assert ring.loop_count == 2
    assert "contour 3 as 2" in ring.notes[0]
    assert ss.signed_distance(ring, (0.0, 0.0)) == pytest.approx(1.0, abs=1e-12)


def test_what_one_element_fills_of_another_stays_filled(tmp_path: Path) -> None:
    """An enclave: the hole of a country is the border of another one."""
    for rule in ("nonzero", "evenodd"):
        country = f'<path fill-rule="{rule}" d="{d(OUTER, HOLE[::-1])}"/>'
        enclave = f'<path fill-rule="{rule}" d="{d(HOLE)}"/>'
        shape = read(tmp_path, "map.svg", drawing(country, enclave))
        assert shape.notes == ()
        same_region(shape, shapely.Polygon(OUTER))


@pytest.mark.parametrize(
    "second", ["M8 3A3 3 0 0 1 2 3A3 3 0 0 1 8 3Z", "M5 6A3 3 0 0 0 5 0A3 3 0 1 0 5 6Z"]
)
def test_a_circle_started_elsewhere_is_the_same(second: str, tmp_path: Path) -> None:
    hole = '<path fill="none" stroke="red" d="{}"/>'
    text = drawing(
        '<rect width="10" height="8" fill="none" stroke="red"/>',
        '<circle cx="5" cy="3" r="3" fill="none" stroke="red"/>',
        hole.format(second),
    )
    shape = read(tmp_path, "round.svg", text, stroke="centre")
    assert shape.loop_count == 2
    assert "path 3 as circle 2" in shape.notes[0]
    assert ss.signed_distance(shape, (5.0, 3.0)) == pytest.approx(3.0, abs=1e-12)


def test_a_hole_traced_twice_in_itself_is_a_hole() -> None:
    twice = np.concatenate([HOLE[::-1], HOLE[::-1]])
    shape = ss.Shape.from_pieces([polygon(OUTER), polygon(twice)])
    assert "contour 2 in itself" in shape.notes[0]
    same_region(shape, PLATE)


@pytest.mark.parametrize("shift", [1e-9, 1e-12])
def test_what_is_nearly_the_same_is_not_the_same(shift: float) -> None:
    """Far beyond rounding, a copy beside it is a contour of its own."""
    shape = ss.Shape.from_pieces([polygon(OUTER), polygon(HOLE[::-1]), polygon(HOLE[::-1] + shift)])
    assert shape.loop_count == 3
    assert shape.notes == ()


def test_many_holes_of_one_form_are_told_apart() -> None:
    """A perforated sheet: equal areas; one hole of 900 is drawn twice."""
    places = np.stack(np.meshgrid(np.arange(30.0), np.arange(30.0)), -1).reshape(-1, 2)
    square = np.array([[0.2, 0.2], [0.2, 0.8], [0.8, 0.8], [0.8, 0.2]])
    holes = [square + place for place in places]
    sheet = np.array([[-1.0, -1.0], [31.0, -1.0], [31.0, 31.0], [-1.0, 31.0]])
    shape = ss.Shape.from_pieces([polygon(ring) for ring in (sheet, *holes, holes[417])])
    assert shape.loop_count == 901
    assert "contour 902 as 419" in shape.notes[0]
    again = ss.Shape.from_pieces([polygon(ring) for ring in (sheet, *holes[::-1], *holes)])
    assert again.loop_count == 901
    assert "counted once: 900 (" in again.notes[0]


def test_the_rule_that_is_asked_for_is_kept(tmp_path: Path) -> None:
    rings = OUTER, HOLE, HOLE
    text = drawing(f'<path fill-rule="evenodd" d="{d(*rings)}"/>')
    shape = read(tmp_path, "plate.svg", text, fill="evenodd")
    assert (shape.loop_count, shape.notes) == (3, ())
    same_region(shape, shapely.Polygon(OUTER))
    (tmp_path / "plate.csv").write_text(table(*rings))
    assert ss.read(tmp_path / "plate.csv", fill="evenodd").loop_count == 3


def test_far_from_the_origin_rounding_is_that_of_the_coordinates() -> None:
    """Copies that went through other sums differ by units in the last place of 5e6."""
    far = np.array([512345.678, 5412345.678])
    copy = (CUT + far * 0.7) + far * 0.3
    shape = ss.Shape.from_pieces([polygon(OUTER + far), polygon(HOLE[::-1] + far), polygon(copy)])
    assert shape.loop_count == 2


def test_curves_of_pieces_of_other_degrees_are_the_same_curve() -> None:
    """A quadratic piece, again as the cubic that it is, in the other direction."""
    arch = np.array([[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]])
    cubic = np.array([arch[0], (arch[0] + 2.0 * arch[1]) / 3.0, (2.0 * arch[1] + arch[2]) / 3.0,
                      arch[2]])  # fmt: skip
    base, bent = arch[[2, 0]], cubic.copy()
    bent[1, 1] += 1e-9
    for other, count in ((cubic, 1), (bent, 2)):
        again = [base[::-1], other[::-1]]
        shape = ss.Shape.from_pieces([[arch, base], again])
        assert shape.loop_count == count
        assert ("drawn again" in " ".join(shape.notes)) == (count == 1)


def test_long_contours_are_compared_piece_by_piece() -> None:
    """Too many pairs of pieces for more: another start is told, other cuts are not."""
    angles = np.linspace(0.0, 2.0 * np.pi, 801)[:-1]
    corners = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    cut = np.stack([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))], axis=1).reshape(-1, 2)
    one = polygon(corners)
    assert same_curve(one, polygon(np.roll(corners[::-1], 5, axis=0)), 1e-15)
    assert not same_curve(one, polygon(cut), 1e-15)
    assert same_curve(one[:9], polygon(cut)[:18], 1e-15)
