"""`Shape.to_shapely`, judged by geometries that Shapely makes by itself, and by closed forms."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from tests.examples import examples

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4]]


def parts_and_holes(region: shapely.Geometry) -> tuple[int, int]:
    parts = shapely.get_parts(region)
    return len(parts), sum(len(part.interiors) for part in parts)


def ring(center: tuple[float, float], radius: float, count: int = 40_000) -> shapely.Polygon:
    angles = 2.0 * np.pi * np.arange(count) / count
    return shapely.Polygon(np.add(center, radius * np.c_[np.cos(angles), np.sin(angles)]))


def assert_near(shape: ss.Shape, expected: shapely.Geometry, tolerance: float) -> None:
    """Valid, of the same parts and holes, and different by a strip along the boundary at most."""
    found = shape.to_shapely(tolerance)
    assert found.is_valid
    assert found.geom_type in ("Polygon", "MultiPolygon")
    assert parts_and_holes(found) == parts_and_holes(expected)
    between = shapely.symmetric_difference(found, expected).area
    assert between <= tolerance * expected.length
    assert abs(found.area - expected.area) <= tolerance * expected.length


@pytest.mark.parametrize("at", [(0.0, 0.0), (3e5, -4e5)])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_disks_in_holes_in_disks(at: tuple[float, float], tolerance: float) -> None:
    radii = (5.0, 4.0, 3.0, 1.0)
    shape, expected = ss.Shape.circle(at, 5.0), ring(at, 5.0)
    for k, radius in enumerate(radii[1:]):
        inner, disk = ss.Shape.circle(at, radius), ring(at, radius)
        shape = shape | inner if k % 2 else shape - inner
        expected = expected.union(disk) if k % 2 else expected.difference(disk)
    assert parts_and_holes(expected) == (2, 2)
    assert_near(shape, expected, tolerance)


@examples(12)
@given(st.integers(0, 10**6))
def test_boxes_added_and_taken_away(seed: int) -> None:
    """On a lattice, so that boxes touch along sides and in corners."""
    random = np.random.default_rng(seed)
    shape, expected = ss.Shape.rectangle(0, 0, 9, 9), shapely.box(0, 0, 9, 9)
    for k in range(8):
        x, y = random.integers(0, 8, 2).tolist()
        width, height = random.integers(1, 4, 2).tolist()
        box = ss.Shape.rectangle(x, y, x + width, y + height)
        other = shapely.box(x, y, x + width, y + height)
        shape = shape | box if k % 3 == 2 else shape - box
        expected = expected.union(other) if k % 3 == 2 else expected.difference(other)
    found = shape.to_shapely(1e-9)
    assert found.is_valid
    assert parts_and_holes(found) == parts_and_holes(expected)
    assert found.symmetric_difference(expected).area <= 1e-9 * expected.length


@pytest.mark.parametrize(
    ("shape", "parts", "holes", "area"),
    [
        (ss.Shape.rectangle(0, 0, 1, 1) | ss.Shape.rectangle(1, 1, 2, 2), 2, 0, 2.0),
        (ss.Shape.circle((0, 0), 1) | ss.Shape.circle((2, 0), 1), 2, 0, 2.0 * np.pi),
        (ss.Shape.rectangle(0, 0, 4, 4) - ss.Shape.circle((1, 2), 1), 1, 1, 16.0 - np.pi),
        (ss.Shape.polygon(SQUARE, [[[0, 0], [2, 1], [1, 2]]]), 1, 1, 14.5),
        (ss.Shape.from_points([[0, 0], [2, 2], [2, 0], [0, 2]], fill="evenodd"), 2, 0, 2.0),
    ],
)  # fmt: skip
def test_what_touches_in_a_corner_is_valid(
    shape: ss.Shape, parts: int, holes: int, area: float
) -> None:
    found = shape.to_shapely()
    assert found.is_valid
    assert parts_and_holes(found) == (parts, holes)
    assert found.area == pytest.approx(area, abs=2e-5 * shape.length)


def test_vertices_lie_on_the_boundary_and_miss_none_of_it() -> None:
    """Both ways: of all that is filled no arc is left out, and y keeps its direction."""
    shape = ss.Shape.from_svg_path(
        "M 0 0 C 6 -4 6 9 0 4 Q -3 2 0 0 Z M 2 1 h 1 v 1 h -1 z", fill="evenodd"
    )
    assert shape.y_down
    tolerance = 1e-4
    found = shape.to_shapely(tolerance)
    lines = shapely.boundary(found)
    assert np.abs(shape.signed_distance(shapely.get_coordinates(lines))).max() <= tolerance
    middle = shapely.get_coordinates(shapely.segmentize(lines, 0.01))
    assert np.abs(shape.signed_distance(middle)).max() <= tolerance
    own = np.concatenate(shape.sample(50))
    assert shapely.distance(lines, shapely.points(own)).max() <= tolerance


def test_there_and_back() -> None:
    expected = shapely.box(0, 0, 10, 8).difference(shapely.box(2, 2, 4, 4))
    found = ss.Shape.from_shapely(expected).to_shapely()
    assert found.equals(expected)


def test_contours_by_way_of_a_shape() -> None:
    grown = ss.offset(ss.Shape.rectangle(0, 0, 4, 4), 1.0, tolerance=1e-6)
    found = ss.Shape.from_contours(grown).to_shapely(1e-6)
    assert found.symmetric_difference(shapely.box(0, 0, 4, 4).buffer(1.0, 2000)).area <= 1e-4


def test_however_coarse_no_part_is_lost() -> None:
    shape = ss.Shape.rectangle(0, 0, 40, 40) - ss.Shape.circle((10, 10), 0.5)
    shape = shape | ss.Shape.circle((50, 10), 0.5)
    assert parts_and_holes(shape.to_shapely(2.0)) == (2, 1)
    lens = ss.Shape.circle((0, 0), 5) & ss.Shape.circle((0, 9), 5)  # two arcs, one from end to end
    assert parts_and_holes(lens.to_shapely(1.5)) == (1, 0)


def test_refused() -> None:
    far = ss.Shape.rectangle(1e6, 1e6, 1e6 + 0.1, 1e6 + 0.1)
    assert far.to_shapely().area == pytest.approx(0.01, abs=1e-6)
    for tolerance, words in [(1e-9, "at least 4e-07"), (0.0, "positive"), (np.nan, "positive")]:
        with pytest.raises(ss.InputError, match=words):
            far.to_shapely(tolerance)


@pytest.mark.parametrize(
    ("geometry", "got"),
    [(shapely.Point(1, 2), "1 Point"), (shapely.GeometryCollection(), "none"),
     (shapely.MultiLineString([[(0, 0), (1, 1)]]), "1 MultiLineString")],
)  # fmt: skip
def test_geometries_without_a_polygon_are_refused(geometry: object, got: str) -> None:
    with pytest.raises(ss.InputError, match=f"expected polygons, got {got}$"):
        ss.Shape.from_shapely(geometry)


def test_without_shapely(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "shapely", None)
    with pytest.raises(ss.MissingExtraError, match=r'pip install "splinesdf\[maps\]"'):
        ss.Shape.rectangle(0, 0, 1, 1).to_shapely()
