"""GeoJSON, WKT and CSV read back, GeoJSON and WKT by Shapely, and compared with the arcs."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from splinesdf.contours.contour import Contour
from splinesdf.io.output import write
from tests.chains import (
    circle,
    circular,
    joined,
    mixed_chain,
    open_chain,
    turned,
)
from tests.nearness import compare


def test_geojson(tmp_path: Path) -> None:
    chains = [mixed_chain(), open_chain()]
    write(tmp_path / "a.geojson", chains, tolerance=1e-3)
    collection = json.loads((tmp_path / "a.geojson").read_text())
    assert collection["type"] == "FeatureCollection"
    properties = [feature["properties"] for feature in collection["features"]]
    assert properties == [
        {"distance": -0.5, "closed": True},
        {"distance": -0.5, "closed": False},
    ]
    closed, opened = (shapely.geometry.shape(f["geometry"]) for f in collection["features"])
    assert isinstance(closed, shapely.Polygon)
    assert isinstance(opened, shapely.LineString)
    # A polyline within 1e-3 everywhere misses at most length times that of the area.
    assert closed.area == pytest.approx(chains[0].area, abs=1e-3 * chains[0].length)
    for shape, chain in ((closed.exterior, chains[0]), (opened, chains[1])):
        compare(np.array(shape.segmentize(0.1).coords), chain, 1e-3)


def nested() -> list[Contour]:
    """A ring with an island in its hole, the hole given first, and another level's circle."""
    outer = circle(5.0, distance=1.0)
    hole = replace(turned(circle(4.0, distance=1.0)), parent=outer)
    island = replace(circle(1.0, distance=1.0), parent=hole)
    return [hole, outer, island, circle(9.0, distance=2.0)]


@pytest.mark.parametrize("name", ["a.geojson", "a.wkt"])
@pytest.mark.parametrize("flip", [False, True])
def test_holes_are_holes(tmp_path: Path, name: str, flip: bool) -> None:
    chains = nested()
    if flip:
        chains[1:] = [turned(chain) for chain in chains[1:]]
        chains[0] = replace(chains[0], parent=chains[1])
        chains[2] = replace(chains[2], parent=chains[0])
    write(tmp_path / name, chains, tolerance=1e-6)
    text = (tmp_path / name).read_text()
    if name == "a.wkt":
        shapes = [shapely.from_wkt(row) for row in text.splitlines()]
    else:
        features = json.loads(text)["features"]
        assert [f["properties"]["distance"] for f in features] == [1.0, 1.0, 2.0]
        shapes = [shapely.geometry.shape(f["geometry"]) for f in features]
    assert [len(shape.interiors) for shape in shapes] == [1, 0, 0]
    areas = [math.pi * (25.0 - 16.0), math.pi, math.pi * 81.0]
    assert [shape.area for shape in shapes] == pytest.approx(areas, abs=1e-4)
    assert all(shape.is_valid for shape in shapes)
    # RFC 7946: outer rings counterclockwise, holes clockwise.
    assert all(shape.exterior.is_ccw for shape in shapes)
    assert not shapes[0].interiors[0].is_ccw


def test_a_hole_alone_is_a_polygon(tmp_path: Path) -> None:
    write(tmp_path / "a.wkt", nested()[:1], tolerance=1e-6)
    assert shapely.from_wkt((tmp_path / "a.wkt").read_text()).area == pytest.approx(
        math.pi * 16.0, abs=1e-4
    )


def test_a_ring_has_four_points_however_coarse(tmp_path: Path) -> None:
    lens = joined(circular(1.0, 0j, 0.0, 1.0, 1), circular(1.0, 0j, 1.0, 0.0, 1))
    arcs = np.array([[[0.0, 0], [1, 1], [2, 0]], [[2.0, 0], [1, -1], [0, 0]]])
    lens = replace(lens, arcs=arcs, weights=np.ones(2))
    write(tmp_path / "a.wkt", [lens], tolerance=10.0)
    shape = shapely.from_wkt((tmp_path / "a.wkt").read_text())
    assert len(shape.exterior.coords) >= 4
    assert shape.area > 0.0


def test_wkt(tmp_path: Path) -> None:
    chains = [circle(2.0), open_chain()]
    write(tmp_path / "a.wkt", chains, tolerance=1e-5)
    ring, line = (shapely.from_wkt(s) for s in (tmp_path / "a.wkt").read_text().splitlines())
    assert isinstance(ring, shapely.Polygon)
    assert isinstance(line, shapely.LineString)
    # Inscribed, so smaller; by at most length times tolerance.
    assert 0.0 <= 4.0 * math.pi - ring.area <= 4.0 * math.pi * 1e-5


def test_csv(tmp_path: Path) -> None:
    chains = [circle(2.0, distance=0.1), mixed_chain()]
    write(tmp_path / "a.csv", chains, tolerance=1e-2)
    with (tmp_path / "a.csv").open() as file:
        assert file.readline() == "contour,distance,x,y\n"
    table = np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1)
    for number, chain in enumerate(chains):
        rows = table[table[:, 0] == number]
        assert set(rows[:, 1]) == {chain.distance}
        assert np.array_equal(rows[:, 2:], chain.points(1e-2))
