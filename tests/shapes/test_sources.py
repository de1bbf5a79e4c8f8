"""Shapes of pieces, points, contours and geometries of other libraries: what they are."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import splinesdf as ss

SQUARE = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]
SIDES = [[a, b] for a, b in zip(SQUARE, [*SQUARE[1:], SQUARE[0]], strict=True)]


def around(low: float, high: float, count: int = 400) -> np.ndarray:
    return np.random.default_rng(1).uniform(low, high, (count, 2))


def by_geos(region: shapely.Geometry, points: np.ndarray) -> np.ndarray:
    away = shapely.distance(shapely.boundary(region), shapely.points(points))
    return np.where(shapely.contains_xy(region, points), -away, away)


def test_geometries_of_shapely_are_united() -> None:
    plate = shapely.box(0, 0, 10, 8).difference(shapely.box(2, 2, 4, 4))
    both = shapely.GeometryCollection(
        [plate, shapely.MultiPolygon([shapely.box(9, 1, 12, 3), shapely.box(20, 0, 22, 2)]),
         shapely.Point(5, 5), shapely.LineString([(0, 0), (9, 9)])]
    )  # fmt: skip
    shape = ss.Shape.from_shapely(both, name="plate")
    points = around(-3.0, 25.0)
    region = shapely.union_all([plate, shapely.box(9, 1, 12, 3), shapely.box(20, 0, 22, 2)])
    assert np.allclose(ss.signed_distance(shape, points), by_geos(region, points), atol=1e-13)
    assert shape.name == "plate"
    assert "1 LineString" in " ".join(shape.notes)


def test_collections_and_polygons_of_nothing_are_passed_over() -> None:
    square = {"type": "Polygon", "coordinates": [[*SQUARE, SQUARE[0]]]}
    shape = ss.Shape.from_shapely(
        {"type": "GeometryCollection", "geometries": [
            {"type": "GeometryCollection", "geometries": []}, square,
            {"type": "MultiPolygon", "coordinates": []},
            {"type": "Polygon", "coordinates": []}]}
    )  # fmt: skip
    assert shape.box == (0.0, 0.0, 4.0, 4.0)
    assert shape.loop_count == 1


def test_rings_that_are_no_list_are_refused() -> None:
    with pytest.raises(ss.InputError, match="expected a list of rings in a Polygon, got"):
        ss.Shape.from_shapely({"type": "MultiPolygon", "coordinates": [5]})


def test_a_point_is_no_polygon() -> None:
    with pytest.raises(ss.InputError, match=r"expected points of shape \(n, 2\), got shape \(2,\)"):
        ss.Shape.from_points((1.0, 2.0))


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_pieces_without_extent_are_passed_over(degree: int) -> None:
    shape = ss.Shape.from_pieces([[SIDES[0], [SQUARE[1]] * (degree + 1), *SIDES[1:]]])
    points = around(-2.0, 6.0)
    expected = by_geos(shapely.Polygon(SQUARE), points)
    assert np.allclose(ss.signed_distance(shape, points), expected, atol=1e-14)
    assert shape.piece_count == 4


@pytest.mark.parametrize(
    ("loop", "expected"),
    [
        ([[(0, 0)]], r"control points of shape \(degree \+ 1, 2\), got \(1, 2\)"),
        ([[(0, 0), (1, np.nan)], [(1, np.nan), (0, 0)]], "expected finite coordinates, got NaN"),
        ([[(0, 0), (np.inf, 1)], [(np.inf, 1), (0, 0)]], "got NaN or infinity"),
    ],
)
def test_what_is_no_curve_is_refused(loop: list[list[tuple[float, float]]], expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected):
        ss.Shape.from_pieces([loop])


def test_contours_that_are_no_shape_are_refused() -> None:
    shape = ss.Shape.from_points(SQUARE)
    one, other = ss.offset(shape, [0.5, 1.0], tolerance=1e-3)
    with pytest.raises(ss.InputError, match="expected at least one contour, got none"):
        ss.Shape.from_contours([])
    with pytest.raises(ss.InputError, match="expected contours, got Shape"):
        ss.Shape.from_contours([shape])  # type: ignore[list-item]
    with pytest.raises(ss.InputError, match=r"of one distance, got 0\.5 and 1: those of each"):
        ss.Shape.from_contours([one, other])
    # The corner of the square is in the domain, and so is half of a circle about it.
    spline = ss.interpolate(shape, (8, 8), domain=(-3.0, -3.0, 2.0, 2.0)).spline
    with pytest.raises(ss.OpenContourError, match="got one that leaves the domain"):
        ss.Shape.from_contours(spline.contours(0.5))


def test_a_plus_before_an_argument_changes_nothing() -> None:
    plain = ss.Shape.from_formula("3*cos(t)", "2*sin(t)*abs(cos(t))")
    signed = ss.Shape.from_formula("+3*cos(+t)", "+2*sin(t)*abs(+cos(t))")
    points = around(-4.0, 4.0)
    assert np.array_equal(ss.signed_distance(plain, points), ss.signed_distance(signed, points))


def elevated(control: np.ndarray) -> np.ndarray:
    """A quadratic piece as a cubic one."""
    a, b, c = np.asarray(control, dtype=float)
    return np.stack([a, (a + 2.0 * b) / 3.0, (2.0 * b + c) / 3.0, c])


def test_a_contour_drawn_again_in_another_degree_counts_once() -> None:
    corners = np.array([(0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (0.0, 6.0)])
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    loop = [np.stack([middles[k - 1], corners[k], middles[k]]) for k in range(4)]
    once = ss.Shape.from_pieces([loop])
    cubics = [elevated(piece) for piece in loop]
    shape = ss.Shape.from_pieces([loop, [piece[::-1] for piece in reversed(cubics)]])
    assert "drawn again, counted once: 1 (contour 2 as 1)" in " ".join(shape.notes)
    points = around(-2.0, 10.0)
    found, expected = (ss.signed_distance(one, points) for one in (shape, once))
    assert np.allclose(found, expected, atol=1e-13)


def test_long_contours_that_differ_in_a_corner_are_two() -> None:
    angle = 2.0 * np.pi * np.arange(700) / 700
    one = 10.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    other = one.copy()
    other[350] *= 0.9
    shape = ss.Shape.from_points([one, other[::-1]])
    assert shape.loop_count == 2
    assert shape.notes == ()


def test_one_contour_does_for_a_list_of_contours() -> None:
    (contour,) = ss.offset(ss.Shape.circle((0, 0), 1), 1)
    assert ss.Shape.from_contours(contour) == ss.Shape.from_contours([contour])
    assert ss.Shape.from_contours([contour]).box == pytest.approx((-2, -2, 2, 2))
    with pytest.raises(ss.InputError, match=r"expected a list of contours, got int$"):
        ss.Shape.from_contours(3)  # type: ignore[arg-type]
