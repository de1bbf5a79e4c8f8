"""`read_all`: one shape an element, none lost, and together what `read` reads."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Sequence
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.io.readers.svg_document import parse_document
from splinesdf.io.readers.svg_regions import clips_of
from splinesdf.io.readers.svg_walk import Document
from tests.examples import examples
from tests.oracles import winding_number
from tests.reading import areas, assert_one_line

DATA = Path(__file__).parents[1] / "data"
SVG = '<svg xmlns="http://www.w3.org/2000/svg" {}>{}</svg>'


def inside(shape: ss.Shape, points: np.ndarray) -> np.ndarray:
    """By the winding number of polylines along what was drawn."""
    number = winding_number(shape.sample(12), points)
    return number % 2 != 0 if shape.fill == "evenodd" else number != 0


def faces(shape: ss.Shape) -> shapely.Geometry:
    """What a shape fills, by GEOS: the faces between its lines that it winds around."""
    lines = shapely.union_all([shapely.linestrings(ring) for ring in shape.sample(12)])
    found = shapely.get_parts(shapely.polygonize([lines]))
    at = shapely.point_on_surface(found)
    points = np.stack([shapely.get_x(at), shapely.get_y(at)], axis=-1)
    return shapely.union_all(found[inside(shape, points)])


def named(shapes: Sequence[ss.Shape], words: str) -> int:
    """How many elements notes name after these words, each note once."""
    notes = {note for shape in shapes for note in shape.notes if words in note}
    counts = [re.search(rf"{words}:? (?:(\d+) elements \()?", note) for note in notes]
    return sum(int(found[1] or 1) for found in counts if found)


def check(path: Path, **options: object) -> list[ss.Shape]:
    """Read both ways; the region is the same."""
    whole, shapes = ss.read(path, **options), ss.read_all(path, **options)
    names = [shape.name for shape in shapes]
    assert len(set(names)) == len(names)
    for shape in shapes:
        assert (shape.unit, shape.page, shape.y_down) == (whole.unit, whole.page, whole.y_down)
        assert shape.notes[: len(whole.notes)] == whole.notes
    draw = np.random.default_rng(0)
    boxes = [whole.box, *(shape.box for shape in shapes)]
    points = np.concatenate(
        [draw.uniform(box[:2], box[2:], (max(20, 600 // len(boxes)), 2)) for box in boxes]
    )
    # Beside the boundary, where chords are on the other side of the curves.
    points = points[np.abs(ss.signed_distance(whole, points)) > 2e-3 * whole.size]
    united = np.any([inside(shape, points) for shape in shapes], axis=0)
    np.testing.assert_array_equal(united, inside(whole, points))
    return shapes


def tables() -> list[Path]:
    return sorted(
        path
        for path in (DATA / "files").iterdir()
        if path.suffix in (".csv", ".dat", ".geojson", ".dxf") and path.name != "values.csv"
    )


@pytest.mark.parametrize("path", tables(), ids=lambda path: path.name)
def test_files_of_all_formats_fill_the_same(path: Path) -> None:
    shapes = check(path)
    assert shapely.union_all([faces(shape) for shape in shapes]).area == pytest.approx(
        faces(ss.read(path)).area, rel=1e-9
    )


def drawings() -> list[Path]:
    folders = sorted((DATA / "drawings").iterdir())
    some = [path for folder in folders for path in sorted(folder.glob("*.svg"))[::50]]
    return [*some, *sorted((DATA / "files").glob("0*.svg"))]


@pytest.mark.parametrize(
    ("path", "stroke"),
    [
        *itertools.product(drawings(), ["none", "centre"]),
        (DATA / "files" / "03_stroke_frame.svg", "outline"),
        (DATA / "drawings" / "feather" / "activity.svg", "outline"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.stem,
)
def test_drawings_fill_the_same_and_no_element_is_lost(path: Path, stroke: str) -> None:
    options = {"stroke": stroke, "close": True, "ignore": ("mask", "dashes")}
    try:
        whole = ss.read(path, **options)
    except ss.InputError as error:
        with pytest.raises(type(error)):
            ss.read_all(path, **options)
        return
    shapes = check(path, **options)
    if len(shapes) < 40:
        assert shapely.union_all([faces(shape) for shape in shapes]).area == pytest.approx(
            faces(whole).area, abs=1e-3 * whole.size**2
        )
    document = Document(parse_document(path.read_bytes()), frozenset(["mask"]), clips_of)
    together = sum(named([shape], "together with") for shape in shapes)
    alone = named(shapes, "nothing is filled by them alone")
    assert len(shapes) + together + alone == len(list(document.outlines()))


def test_names_and_notes_of_a_drawing(tmp_path: Path) -> None:
    content = """
        <style>.gone{fill:none}</style>
        <clipPath id="none"><rect x="90" width="5" height="5"/></clipPath>
        <rect width="4" height="3"/>
        <g id="all"><circle id="disk" cx="20" cy="20" r="5"/><rect x="8" width="4" height="3"/></g>
        <path d="M30 0H40V10Z" xmlns:i="http://www.inkscape.org/namespaces/inkscape" i:label="tip"/>
        <use href="#disk" x="40"/><use href="#disk" x="60"/>
        <text>no</text><path d="M0 0L5 5"/><rect class="gone" width="9" height="9"/>
        <rect id="cut away" width="5" height="5" clip-path="url(#none)"/>
        <rect width="4" height="3"/>"""
    path = tmp_path / "a.svg"
    path.write_text(SVG.format('width="100mm" height="50mm" viewBox="0 0 200 100"', content))
    shapes = check(path)
    names = ["rect 1", "disk", "rect 2", "tip", "disk 2", "disk 3"]
    assert [shape.name for shape in shapes] == names
    assert [sum(map(abs, areas(shape))) for shape in shapes] == pytest.approx(
        [12.0, 25.0 * np.pi, 12.0, 50.0, 25.0 * np.pi, 25.0 * np.pi]
    )
    assert all(shape.unit == 0.5 and shape.page == (0.0, 0.0, 200.0, 100.0) for shape in shapes)
    for shape in shapes:
        (note,) = [note for note in shape.notes if "alone" in note]
        assert note.endswith("4 elements (path 2, rect 3, cut away, rect 5)")


def test_a_fill_and_its_stroke_are_one_shape(tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    rects = '<rect x="5" y="5" width="10" height="10" stroke="red" stroke-width="2"/>'
    rects += '<path d="M30 0V20" stroke="red" stroke-width="2"/>'
    path.write_text(SVG.format("", rects))
    shapes = check(path, stroke="outline")
    assert [shape.name for shape in shapes] == ["rect 1", "path 1"]
    assert [faces(shape).area for shape in shapes] == pytest.approx([144.0, 40.0])
    assert [faces(shape).area for shape in check(path)] == pytest.approx([100.0])


def test_lines_that_are_holes_stay_with_their_outline(tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    line = '<path id="{}" fill="none" stroke="red" d="{}"/>'
    parts = {
        "hole": "M10 10h5v5h-5z",
        "plate": "M0 0h30v30h-30z",
        "other": "M50 0h30v30h-30z",
        "island": "M12 12h1v1h-1z",
    }
    path.write_text(SVG.format("", "".join(line.format(*part) for part in parts.items())))
    plate, other = check(path, stroke="centre")
    assert (plate.name, other.name) == ("plate", "other")
    assert (faces(plate).area, faces(other).area) == pytest.approx((900.0 - 25.0 + 1.0, 900.0))
    assert "together with 2 elements (hole, island), which overlap it" in plate.notes
    assert not any("together" in note for note in other.notes)


def test_open_lines_are_joined_to_one_element(tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    lines = ["M0 0H10", "M10 10H0V0", "M10 0V10", "M20 0h5v5h-5z"]
    line = '<path fill="none" stroke="red" d="{}"/>'
    path.write_text(SVG.format("", "".join(map(line.format, lines))))
    shapes = check(path, stroke="centre", close=True)
    assert [shape.name for shape in shapes] == ["path 1", "path 4"]
    assert any(note.endswith("2 elements (path 2, path 3)") for note in shapes[0].notes)


def test_features_and_geometries(tmp_path: Path) -> None:
    def square(x: float, side: float = 2.0) -> list[list[list[float]]]:
        return [[[x, 0], [x + side, 0], [x + side, side], [x, side], [x, 0]]]

    def feature(geometry: object, **more: object) -> dict[str, object]:
        return {"type": "Feature", "geometry": geometry, "properties": None, **more}

    one = {"type": "Polygon", "coordinates": square(0.0)}
    two = {"type": "MultiPolygon", "coordinates": [square(1.0), square(10.0)]}
    point = {"type": "Point", "coordinates": [0, 0]}
    features = [
        feature(one, id="a"),
        feature(two, properties={"name": "b"}),
        feature(point, id=3),
        feature(None),
        feature({"type": "GeometryCollection", "geometries": [one, point]}, id="a"),
    ]
    path = tmp_path / "a.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    shapes = check(path)
    assert [shape.name for shape in shapes] == ["a", "b", "a 2"]
    assert [faces(shape).area for shape in shapes] == pytest.approx([4.0, 8.0, 4.0])
    assert any(note.endswith("alone: 2 elements (3, Feature 4)") for note in shapes[0].notes)

    path = tmp_path / "a.wkt"
    path.write_text(
        "POLYGON ((0 0, 2 0, 2 2, 0 2, 0 0), (0.5 0.5, 1 0.5, 1 1, 0.5 0.5)); POINT (1 1)\n"
        "GEOMETRYCOLLECTION (POLYGON ((5 0, 6 0, 6 1, 5 0)), MULTIPOLYGON (((1 0, 3 0, 3 1, 1 0))))"
    )
    shapes = check(path)
    assert [shape.name for shape in shapes] == ["POLYGON 1", "POLYGON 3", "MULTIPOLYGON 4"]
    assert [faces(shape).area for shape in shapes] == pytest.approx([3.875, 0.5, 1.0])
    assert any(note.endswith("alone: POINT 2") for note in shapes[0].notes)


def test_formulas(tmp_path: Path) -> None:
    def disk(x: float, radius: float, sign: str = "") -> dict[str, str]:
        return {"x": f"{x} + {radius}*cos(t)", "y": f"{sign}{radius}*sin(t)"}

    path = tmp_path / "a.json"
    loops = [disk(0, 3), disk(0, 1, "-"), disk(4, 2), disk(20, 1)]
    path.write_text(json.dumps({"loops": loops, "name": "all"}))
    shapes = check(path)
    # The hole is one beside its outline only; disks that overlap are two.
    assert [shape.name for shape in shapes] == ["loop 1", "loop 3", "loop 4"]
    assert [sum(areas(shape)) for shape in shapes] == pytest.approx(
        [8.0 * np.pi, 4.0 * np.pi, np.pi]
    )
    path.write_text(json.dumps({**disk(0, 3), "name": "one"}))
    assert [shape.name for shape in check(path)] == ["one"]


def test_outlines_of_a_dxf(tmp_path: Path) -> None:
    document = ezdxf.new()
    space = document.modelspace()
    for x in (0.0, 20.0):
        space.add_lwpolyline([(x, 0), (x + 10, 0), (x + 10, 8), (x, 8)], close=True)
        space.add_circle((x + 3, 4), 1.0)
        space.add_circle((x + 7, 4), 2.0)
    space.add_lwpolyline([(10, 0), (20, 0), (20, 8), (10, 8)], close=True)  # between, side by side
    document.saveas(tmp_path / "a.dxf")
    shapes = check(tmp_path / "a.dxf")
    assert [shape.name for shape in shapes] == ["outline 1", "outline 4", "outline 7"]
    assert [sum(map(abs, areas(shape))) for shape in shapes] == pytest.approx(
        [80.0 + 5.0 * np.pi, 80.0 + 5.0 * np.pi, 80.0]
    )


def test_glyphs() -> None:
    font = DATA / "fonts" / "roboto-latin-400-normal.woff2"
    shapes = check(font, text="AV A\nA", size=10.0)
    assert [shape.name for shape in shapes] == ["A", "V", "A 2", "A 3"]
    first, _, second, third = (shape.box for shape in shapes)
    assert second[2] - second[0] == pytest.approx(first[2] - first[0])
    assert third[0] == pytest.approx(first[0])
    assert third[1] < first[1]
    assert len(shapes[0].notes) == 1  # the space


def test_offsets_that_were_written_come_back_one_by_one(tmp_path: Path) -> None:
    shape = ss.Shape.from_svg_path(
        "M0 0H20V20H0ZM5 5V15H15V5ZM40 0h9v9h-9zM8 8h4v4h-4z", fill="evenodd"
    )
    contours = ss.offset(shape, -0.5, tolerance=1e-3)
    assert len(contours) == 4
    for name, count in (("a.csv", 2), ("a.svg", 2), ("a.dxf", 2), ("a.geojson", 3), ("a.wkt", 3)):
        ss.write(tmp_path / name, contours)
        assert len(check(tmp_path / name)) == count


rectangles = st.lists(
    st.tuples(*[st.integers(0, 9)] * 2, *[st.integers(1, 6)] * 2, st.booleans()),
    min_size=1,
    max_size=7,
    unique_by=lambda r: r[:4],
)


@examples(40)
@given(rectangles, st.sampled_from([None, "nonzero", "evenodd"]))
def test_outlines_are_apart_wherever_they_may_be(
    tmp_path_factory: pytest.TempPathFactory,
    drawn: list[tuple[int, int, int, int, bool]],
    fill: str | None,
) -> None:
    """Rectangles on a grid, either way around: regions and groups are counted by its squares."""
    path = tmp_path_factory.mktemp("all") / "a.csv"
    blocks = []
    for x, y, w, h, turned in drawn:
        corners = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
        blocks.append("\n".join(f"{a},{b}" for a, b in (corners[::-1] if turned else corners)))
    path.write_text("\n\n".join(blocks))
    squares = np.stack(np.meshgrid(np.arange(15) + 0.5, np.arange(15) + 0.5), -1).reshape(-1, 2)
    covers = np.array(
        [
            ((squares > (x, y)) & (squares < (x + w, y + h))).all(axis=1) * (-1 if turned else 1)
            for x, y, w, h, turned in drawn
        ]
    )
    number = covers.sum(axis=0)
    filled = number % 2 != 0 if fill == "evenodd" else number != 0
    # Groups: by the rule alone, which pairs may cancel each other.
    label = np.arange(len(drawn))
    for one, other in itertools.combinations(range(len(drawn)), 2):
        overlap = np.any(covers[one] * covers[other] != 0)
        if overlap and (fill == "evenodd" or drawn[one][4] != drawn[other][4]):
            label[label == label[other]] = label[one]
    seen = [covers[label == group].sum(axis=0) for group in np.unique(label)]
    wanted = sorted(
        np.count_nonzero(part % 2 if fill == "evenodd" else part)
        for part in seen
        if np.any(part % 2 if fill == "evenodd" else part)
    )
    if not wanted:
        with pytest.raises(ss.InputError):
            ss.read_all(path, fill=fill)
        return
    shapes = ss.read_all(path, fill=fill)
    parts = [ss.signed_distance(shape, squares) < 0.0 for shape in shapes]
    assert sorted(np.count_nonzero(part) for part in parts) == wanted
    np.testing.assert_array_equal(np.any(parts, axis=0), filled)
    together = sum(named([shape], "together with") for shape in shapes)
    assert len(shapes) + together + named(shapes, "nothing is filled by them alone") == len(drawn)


def test_what_is_drawn_again_is_counted_once(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("0,0\n4,0\n4,4\n\n4,4\n0,0\n4,0\n\n9,0\n10,0\n10,1\n")
    shapes = check(path)
    assert [shape.name for shape in shapes] == ["polygon 1", "polygon 3"]
    assert any(note.endswith("alone: polygon 2") for note in shapes[0].notes)


@pytest.mark.parametrize(
    ("name", "content", "options"),
    [
        ("a.svg", SVG.format("", "<text>a</text>"), {}),
        ("a.svg", SVG.format("", '<rect width="9" height="9" fill="none"/>'), {"layers": "x"}),
        ("a.csv", "1,1\n1,1\n", {}),
        ("a.wkt", "POINT (1 1)", {}),
        ("a.json", '{"x": "t", "y": "t*t"}', {}),
        ("a.geojson", '{"type": "Point", "coordinates": [1, 2]}', {}),
        ("a.foo", "", {}),
        ("a.csv", "1,1\n1,2\n2,2\n", {"text": "A"}),
        ("a.csv", "1,1\n1,2\n1,1\n", {"fill": "nonzero"}),
    ],
)
def test_errors_are_those_of_read(
    tmp_path: Path, name: str, content: str, options: dict[str, object]
) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(ss.InputError) as caught:
        ss.read_all(tmp_path / name, **options)
    assert_one_line(caught.value, name)


def test_open_outlines_are_refused_unless_closed(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text('{"loops": [{"x": "cos(t)", "y": "sin(t)", "t": [0, 3]}]}')
    for read in (ss.read, ss.read_all):
        with pytest.raises(ss.OpenContourError):
            read(path)
    assert len(check(path, close=True)) == 1
