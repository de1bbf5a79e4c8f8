"""Tables, airfoils and maps: what people have in them, and in which words it is refused."""

from __future__ import annotations

import functools
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
from numpy.testing import assert_allclose
from shapely import contains_xy, from_wkt

import splinesdf as ss
from tests.reading import areas, assert_one_line, corners

Read = Callable[..., ss.Shape]


@pytest.fixture
def read(tmp_path: Path) -> Read:
    def file(name: str, text: str, **options: object) -> ss.Shape:
        (tmp_path / name).write_text(text, "utf-8")
        return ss.read(tmp_path / name, **options)  # type: ignore[arg-type]

    return file


TRIANGLE = [[0, 0], [4, 0], [4, 3]]


@pytest.mark.parametrize(
    "text",
    [
        "0,0\n4,0\n4,3",
        "x,y\n0,0\n4,0\n4,3",
        "id;y;x\n1;0;0\n2;0;4\n3;3;4",
        '"Y","z","X"\n0,9,0\n0,9,4\n3,9,4',
        "x\ty\n0,0\t0,0\n4,0\t0,0\n4,0\t3,0",
        "0;0\n4,0;0\n4;3,0",
        "0 0\n4 0 # corner\n4 3",
    ],
)
def test_columns_are_found(read: Read, text: str) -> None:
    assert corners(read("a.csv", text)) == TRIANGLE


def test_columns_by_name_and_number(read: Read) -> None:
    text = "id,east,north\n1,0,0\n2,4,0\n3,4,3"
    assert corners(read("a.csv", text, columns=("east", "north"))) == TRIANGLE
    assert corners(read("a.csv", text, columns=(1, 2))) == TRIANGLE
    assert corners(read("a.csv", "9,0,0\n9,4,0\n9,4,3", columns=(1, 2))) == TRIANGLE
    for columns, expected in (
        (("x", "north"), "expected a column 'x', got id, east, north"),
        ((1, 7), "expected 8 columns, got 3"),
        ((1,), "expected columns as two names or numbers"),
        ((-1, 0), "expected columns as two names or numbers"),
    ):
        with pytest.raises(ss.InputError, match=expected):
            read("a.csv", text, columns=columns)
    with pytest.raises(ss.InputError, match=r"expected 2 columns, x and y, got 3: .*columns="):
        read("a.csv", text)


UPPER = [(0.0, 0.0), (0.5, 0.06), (1.0, 0.002)]
LOWER = [(0.0, 0.0), (0.5, -0.03), (1.0, -0.002)]
SELIG = [*UPPER[::-1], *LOWER[1:]]


def rows(points: list[tuple[float, float]]) -> str:
    return "".join(f" {x:.6f} {y:.6f}\n" for x, y in points)


AREA = 0.5 * abs(
    sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(SELIG, SELIG[1:] + SELIG[:1], strict=True))
)


@pytest.mark.parametrize(
    ("text", "notes"),
    [
        ("MY FOIL\n" + rows(SELIG), 0),
        (rows(SELIG), 0),
        ("20-32C AIRFOIL\n" + rows(SELIG), 0),
        ("12% JOUKOWSKI\nsecond line of words\n" + rows(SELIG), 0),
        ("FOIL\n" + rows(SELIG) + "\nThickness: 9%\n9/11/14 by me\n3 words follow\n", 1),
        ("MSES\n -2.000 3.000 -2.646 3.000\n" + rows(SELIG), 1),
        (f"FOIL\n 3. 3.\n\n{rows(UPPER)}\n{rows(LOWER)}", 0),
        (f"FOIL\n 3 3\n\n{rows(UPPER)}\n{rows(LOWER)}\nwords\n", 1),
    ],
)
def test_airfoils_in_both_orders_with_prose(read: Read, text: str, notes: int) -> None:
    shape = read("foil.dat", text)
    assert_allclose(np.abs(areas(shape)), AREA, rtol=1e-9)
    assert len(shape.notes) == notes
    # The blunt trailing edge is closed by a line.
    assert ss.signed_distance(shape, (1.1, 0.0)) == pytest.approx(0.1)


def test_elements_of_a_wing_apart_by_999(read: Read) -> None:
    flap = [(x + 2.0, y) for x, y in SELIG]
    shape = read("wing.dat", "WING\n" + rows(SELIG) + "999.0 999.0\n" + rows(flap))
    assert_allclose(np.abs(areas(shape)), [AREA, AREA], rtol=1e-9)


def ring(x: float, y: float, side: float, *, turned: bool = False) -> list[list[float]]:
    points = [[x, y], [x + side, y], [x + side, y + side], [x, y + side], [x, y]]
    return points[::-1] if turned else points


@pytest.mark.parametrize("turned", [False, True])
def test_holes_are_holes_whichever_way_they_run(read: Read, turned: bool) -> None:
    polygon = {
        "type": "Polygon",
        "coordinates": [ring(0, 0, 9), ring(1, 1, 2, turned=turned), ring(5, 5, 3)],
    }
    places = [(2, 2), (6, 6), (4, 4)]
    for content in (polygon, {"type": "Feature", "geometry": polygon, "properties": None}):
        for name in ("a.geojson", "a.json"):
            shape = read(name, json.dumps(content))
            assert np.sign(ss.signed_distance(shape, places)).tolist() == [1, 1, -1]
    lines = ", ".join(
        "(" + ", ".join(f"{x} {y}" for x, y in r) + ")" for r in polygon["coordinates"]
    )
    shape = read("a.wkt", f"SRID=4326;POLYGON ({lines})")
    assert np.sign(ss.signed_distance(shape, places)).tolist() == [1, 1, -1]


@pytest.mark.parametrize("seed", range(25))
def test_holes_take_away_what_they_share_with_the_outline(read: Read, seed: int) -> None:
    """Wherever they stand: Shapely's difference decides, and a note tells of those outside."""
    rng = np.random.default_rng(seed)
    rings = [ring(0, 0, 9)]
    for _ in range(int(rng.integers(1, 5))):
        x, y, side = rng.uniform((-5, -5, 0.5), (11, 11, 6)).round(1).tolist()
        rings.append(ring(x, y, side, turned=bool(rng.integers(2))))
    outline, *holes = map(shapely.Polygon, rings)
    left = outline.difference(shapely.union_all(holes))
    drawn = functools.reduce(shapely.symmetric_difference, holes, outline)
    polygon = {"type": "Polygon", "coordinates": rings}
    lines = ", ".join("(" + ", ".join(f"{x} {y}" for x, y in r) + ")" for r in rings)
    for name, text in (("a.geojson", json.dumps(polygon)), ("a.wkt", f"POLYGON ({lines})")):
        shape = read(name, text)
        assert shape.area == pytest.approx(left.area, rel=1e-12)
        points = rng.uniform(-6, 18, (400, 2))
        clear = shapely.distance(left.boundary, shapely.points(points)) > 1e-9
        inside = ss.signed_distance(shape, points) < 0
        assert np.array_equal(inside[clear], shapely.contains_xy(left, points)[clear])
        noted = any("holes that are not within the outline" in note for note in shape.notes)
        assert noted == (abs(drawn.area - left.area) > 1e-9)
        assert ss.Shape.from_shapely(polygon).area == pytest.approx(left.area, rel=1e-12)


def test_a_hole_as_large_as_its_outline_leaves_nothing(read: Read) -> None:
    polygon = {"type": "Polygon", "coordinates": [ring(0, 0, 9), ring(-1, -1, 11)]}
    with pytest.raises(ss.InputError, match="at least one closed curve, got none"):
        read("a.geojson", json.dumps(polygon))


def test_features_are_united_whatever_overlaps(read: Read) -> None:
    features = [
        {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [r]}}
        for r in (ring(100, 0, 4), ring(102, 0, 4, turned=True))
    ]
    features.append({"type": "Feature", "geometry": None})
    features.append({"type": "Feature", "geometry": {"type": "LineString", "coordinates": []}})
    shape = read("a.geojson", json.dumps({"type": "FeatureCollection", "features": features}))
    assert (ss.signed_distance(shape, [(101, 2), (103, 2), (105, 2)]) < 0).all()
    assert ss.signed_distance(shape, (103, 2)) == pytest.approx(-2.0)
    assert shape.notes[0] == "left out: 1 LineString"
    first, second = "100 0, 104 0, 104 4, 100 4, 100 0", "102 0, 102 4, 106 4, 106 0, 102 0"
    wkt = f"MULTIPOLYGON ((({first})), (({second})))"
    other = read("a.wkt", f"GEOMETRYCOLLECTION (POINT EMPTY, POINT Z (1 2 3), {wkt})")
    assert ss.signed_distance(other, (103, 2)) == pytest.approx(-2.0)
    assert other.notes == ("left out: 1 POINT",)


def test_degrees_and_heights_are_noted(read: Read) -> None:
    points = [[x, y, 7.0] for x, y in ring(10, 50, 2)]
    text = json.dumps({"type": "Polygon", "coordinates": [points]})
    heights, degrees = read("a.geojson", text).notes
    assert "third coordinate" in heights
    assert "degrees" in degrees
    text = json.dumps({"type": "Polygon", "coordinates": [ring(500_000, 5_000_000, 20)]})
    assert read("a.geojson", text).notes == ()


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("a.geojson", "{", "expected GeoJSON"),
        ("a.geojson", "[" * 100_000, "expected GeoJSON"),
        ("a.geojson", '{"type": "Topology"}', "of type 'Topology'"),
        ("a.geojson", '{"type": "Point", "coordinates": [1, 2]}', "expected polygons, got 1 Point"),
        ("a.geojson", '{"type": "Polygon"}', "list of coordinates in a Polygon"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[[1, "2"]]]}', "two numbers"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[1, 2]]}', "ring of points"),
        (
            "a.geojson",
            '{"type": "GeometryCollection", "geometries": [' * 150 + "]}" * 150,
            "up to 100 geometries",
        ),
        ("a.wkt", "POLYGON ((0 0, 1 0", "cut short"),
        ("a.wkt", "POLYGON 0 0", r"expected '\('"),
        ("a.wkt", "POLYGON ((0 0, 1 x, 1 1))", "expected a number, got 'x'"),
        ("a.wkt", "CURVEPOLYGON ((0 0, 1 0, 1 1))", "got 'CURVEPOLYGON'"),
        ("a.wkt", "POLYGON((0 0,1 0,0 1),())", "at least 3 distinct points, got none"),
        (
            "a.geojson",
            '{"type": "Polygon", "coordinates": [[]]}',
            "at least 3 distinct points, got none",
        ),
        ("a.wkt", "POLYGON " + "(" * 200, "up to 100 brackets"),
        ("a.wkt", "POLYGON ((0 0, 1 0, 1 1)) ?", "character 26"),
        ("a.wkt", "POINT (1 2)", "expected polygons, got 1 POINT"),
        ("a.wkt", "POLYGON((0 0,4 0,4 3 0 3,0 0))", "got 2 and 4: is a comma missing"),
        ("a.wkt", "MULTIPOLYGON(EMPTY,EMPTY)", "expected polygons, got none"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[[1, true]]]}', "two numbers"),
    ],
)
def test_what_is_no_map_is_refused_in_one_line(
    read: Read, name: str, text: str, expected: str
) -> None:
    with pytest.raises(ss.InputError, match=expected) as caught:
        read(name, text)
    assert_one_line(caught.value, name)


@pytest.mark.parametrize(
    "text",
    [
        "MULTIPOLYGON(EMPTY, ((0 0,4 0,4 3,0 3,0 0)), EMPTY)",
        "POLYGON((0 0,4 0,4 3,0 3,0 0), EMPTY)",
        "MULTIPOLYGON(((0 0,4 0,4 3,0 3,0 0), EMPTY, (1 1,2 1,2 2,1 1)))",
        "POLYGONZ((0 0 1,4 0 1,4 3 1,0 3 1,0 0 1))",
        "GEOMETRYCOLLECTIONZ(POINTZ(1 1 1),POLYGONZ((0 0 1,4 0 1,4 3 1,0 3 1,0 0 1)))",
    ],
)
def test_empty_parts_and_joined_words_of_wkt_are_read_as_geos_reads_them(
    read: Read, text: str
) -> None:
    found = from_wkt(text)
    points = np.random.default_rng(4).uniform((-1, -1), (5, 4), (500, 2))
    inside = contains_xy(found, *points.T)
    assert inside.any()
    assert ((ss.signed_distance(read("a.wkt", text), points) < 0.0) == inside).all()


@pytest.mark.parametrize("ending", ["geojson", "wkt", "csv"])
def test_what_write_writes_can_be_read(tmp_path: Path, ending: str) -> None:
    part = ss.read(Path(ss.__file__).parent / "data" / "part.svg")
    contours = ss.offset(part, [-1.0], tolerance=1e-3)
    ss.write(tmp_path / f"offset.{ending}", contours, tolerance=1e-3)
    shape = ss.read(tmp_path / f"offset.{ending}")
    assert shape.loop_count == len(contours)
    points = np.random.default_rng(0).random((20_000, 2)) * [120, 80]
    inside = ss.signed_distance(part, points) < -1.01
    clear = np.abs(ss.signed_distance(part, points) + 1.0) > 0.01
    assert np.array_equal((ss.signed_distance(shape, points) < 0)[clear], inside[clear])


def test_contours_at_several_distances_are_no_one_region(tmp_path: Path) -> None:
    square = ss.Shape.from_points([(0, 0), (9, 0), (9, 9), (0, 9)])
    contours = ss.offset(square, [-1.0, -3.0], tolerance=1e-3)
    path = tmp_path / "levels.csv"
    ss.write(path, contours, tolerance=1e-3)
    with pytest.raises(
        ss.InputError, match=r"one distance, got 2 distances \(-1.0, -3.0\)"
    ) as caught:
        ss.read(path)
    assert_one_line(caught.value, "levels.csv")
    assert "fill='evenodd'" in str(caught.value)
    with pytest.raises(ss.InputError, match="of one distance"):
        ss.read_all(path)
    # Outside, between both, in the middle.
    probes = [(0.5, 4.5), (2.0, 4.5), (4.5, 4.5)]
    for fill, inside in (("evenodd", [False, True, False]), ("nonzero", [False, True, True])):
        assert (ss.signed_distance(ss.read(path, fill=fill), probes) < 0.0).tolist() == inside
    text = path.read_text().splitlines()
    path.write_text("\n".join(line for line in text if ",-1.0," not in line))
    assert areas(ss.read(path)) == pytest.approx([9.0])


def test_a_distance_of_each_point_is_another_column(read: Read) -> None:
    text = "contour,distance,x,y\n0,1,0,0\n0,2,4,0\n0,3,4,3\n1,1,9,9\n1,1,8,9\n1,2,8,8"
    assert areas(read("a.csv", text)) == pytest.approx([6.0, 0.5])


def test_an_airfoil_of_two_points_is_refused_by_its_line(read: Read) -> None:
    with pytest.raises(ss.InputError, match="points from line 2 on: expected at least") as caught:
        read("a.dat", "a line\n0 0\n1 0\n")
    assert_one_line(caught.value, "a.dat")
