"""Offsets re-measured by the exact distance, counted on pixels, and against closed formulas."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
import svgelements
from numpy.typing import ArrayLike
from scipy import ndimage

import splinesdf as ss
from splinesdf.contours.contour import Contour, evaluate
from splinesdf.offsets.offset import deviation
from tests.named_shapes import FORMULAS, gamma
from tests.offset_checks import judge

DATA = Path(__file__).parents[1] / "data"
PARAMETERS = np.linspace(0.0, 1.0, 21)
PIXELS = 300


class Picture:
    """The exact distance on a grid of pixels around the shape, its outermost ring far outside."""

    def __init__(self, shape: ss.Shape, reach: float) -> None:
        xmin, ymin, xmax, ymax = shape.box
        side = max(xmax - xmin, ymax - ymin) + 3.0 * reach
        self.pixel = side / PIXELS
        line = side * ((np.arange(PIXELS) + 0.5) / PIXELS - 0.5)
        x, y = 0.5 * (xmin + xmax) + line, 0.5 * (ymin + ymax) + line
        self.values = ss.signed_distance(shape, np.stack(np.meshgrid(x, y, indexing="ij"), -1))

    def loops(self, distance: float) -> int:
        """How many loops bound the points nearer than the distance: the regions, less the outside.

        Regions on both sides of the curves and the loops between them form a tree. Neither side
        may touch itself where it is less than two pixels wide: the count must not depend on it.
        """
        counts = {
            ndimage.label(self.values < distance + shift)[1]
            + ndimage.label(self.values >= distance + shift)[1]
            for shift in self.pixel * np.array([-0.7, 0.0, 0.7])
        }
        assert len(counts) == 1, "choose a distance that is not so near to a change"
        return counts.pop() - 1


def check(
    shape: ss.Shape,
    contours: list[Contour],
    distance: float,
    tolerance: float,
    picture: Picture,
    *,
    count: bool = True,
) -> None:
    for contour in contours:
        assert contour.closed
        assert contour.distance == distance
        points = evaluate(contour.arcs, contour.weights, PARAMETERS)
        assert np.abs(ss.signed_distance(shape, points) - distance).max() <= tolerance
    assert judge(shape, contours, distance, tolerance).failures == []
    # Nothing is missing: the area is the pixels', up to half a pixel along the curve.
    area = np.sum(picture.values < distance) * picture.pixel**2
    length = sum(contour.length for contour in contours)
    found = sum(contour.area for contour in contours)
    assert found == pytest.approx(area, abs=0.5 * picture.pixel * length)
    if count:
        assert len(contours) == picture.loops(distance)


@pytest.mark.parametrize("distance", [0.05, -0.05, -0.1, 0.2])
def test_limacon(distance: float) -> None:
    shape, tolerance = gamma("gamma2"), 1e-5
    contours = ss.offset(shape, distance, tolerance=tolerance)
    check(shape, contours, distance, tolerance, Picture(shape, 0.2))
    if distance == 0.2:
        (outer,) = contours
        assert outer.area > 0.0
    assert deviation(shape, contours) <= tolerance


@pytest.mark.parametrize(("distance", "loops"), [(-0.02, 3), (0.02, 1)])
def test_rose_that_touches_itself(distance: float, loops: int) -> None:
    shape, tolerance = gamma("gamma3"), 1e-4
    contours = ss.offset(shape, distance, tolerance=tolerance)
    assert len(contours) == loops
    check(shape, contours, distance, tolerance, Picture(shape, 0.02))


SQUARE = ss.Shape.from_points([(0, 0), (2, 0), (2, 2), (0, 2)])


@pytest.mark.parametrize("tolerance", [1e-2, 1e-8])
def test_offset_of_a_square_is_exact(tolerance: float) -> None:
    d = 0.4
    outer, inner = ss.offset(SQUARE, [d, -d], tolerance=tolerance)
    assert len(outer.arcs) == 8  # a line for each side, a quarter for each corner
    assert outer.area == pytest.approx(4 + 8 * d + np.pi * d**2, rel=1e-14)
    assert outer.length == pytest.approx(8 + 2 * np.pi * d, rel=1e-14)
    assert np.count_nonzero(outer.weights == 1.0) == 4
    quarters = outer.weights[outer.weights != 1.0]
    assert quarters == pytest.approx(np.sqrt(0.5), rel=1e-14)
    assert len(inner.arcs) == 4
    corners = inner.arcs[:, 0]
    assert sorted(map(tuple, np.round(corners, 14))) == [
        (d, d),
        (d, 2 - d),
        (2 - d, d),
        (2 - d, 2 - d),
    ]


def test_circles_come_back_as_circles() -> None:
    shape = ss.Shape.from_formula("3 + 2*cos(t)", "1 + 2*sin(t)")
    for contour in ss.offset(shape, [-1.5, 0.0, 0.25], tolerance=1e-2):
        radius = 2.0 + contour.distance
        assert len(contour.arcs) == 4
        spokes = np.hypot(*(contour.arcs[:, 0] - (3.0, 1.0)).T)
        assert spokes == pytest.approx(radius, rel=1e-13)
        assert contour.area == pytest.approx(np.pi * radius**2, rel=1e-13)


def test_few_arcs() -> None:
    shape = gamma("gamma2")
    for tolerance, most in ((1e-4, 12), (1e-6, 26), (1e-8, 60)):
        (contour,) = ss.offset(shape, -0.05, tolerance=tolerance)
        assert len(contour.arcs) <= most


def test_steps_until_nothing_is_left() -> None:
    contours = ss.offset(SQUARE, step=-0.3, tolerance=1e-6)
    assert [contour.distance for contour in contours] == pytest.approx([-0.3, -0.6, -0.9])
    assert [contour.area for contour in contours] == pytest.approx([1.4**2, 0.8**2, 0.2**2])


@pytest.mark.parametrize("step", [0.0, 0.1, np.nan, -np.inf, "in"])
def test_a_step_that_never_ends_is_refused(step: float) -> None:
    with pytest.raises(ss.InputError, match=r"^expected a negative step, .*, got .*$"):
        ss.offset(SQUARE, step=step, tolerance=1e-2)


def test_distances_or_a_step() -> None:
    with pytest.raises(ss.InputError, match="got both"):
        ss.offset(SQUARE, -0.1, step=-0.1, tolerance=1e-2)
    with pytest.raises(ss.InputError, match="got neither"):
        ss.offset(SQUARE, tolerance=1e-2)


def test_walls_twice_the_distance_apart() -> None:
    path = "M0 0 H40 V30 H0 Z M10 10 V20 H30 V10 Z"  # walls of 10
    shape = ss.Shape.from_svg_path(path, fill="evenodd")
    # What is left is around the four corners: the walls' middle lines are no part of it.
    assert len(ss.offset(shape, -5.0, tolerance=1e-3)) == 4
    outer, hole = ss.offset(shape, -4.999, tolerance=1e-4)
    assert (outer.parent is None) or (hole.parent is None)
    assert {contour.parent for contour in (outer, hole)} - {None} <= {outer, hole}


def test_a_shape_whose_contours_nearly_coincide() -> None:
    # Two pieces of this icon differ in one control point by 0.001 and cross once; the sliver
    # between them has cusps, and rounding must not decide what is inside.
    shape = ss.read(DATA / "icons" / "bing.svg")
    for share in (0.01, -0.01, -0.1):
        distance, tolerance = share * shape.size, 1e-6 * shape.size
        contours = ss.offset(shape, distance, tolerance=tolerance)
        assert judge(shape, contours, distance, tolerance).failures == []


def test_nothing_is_left_beyond_the_deepest_point() -> None:
    tolerance = 1e-3
    assert ss.offset(SQUARE, -1.0 - 2.0 * tolerance, tolerance=tolerance) == []
    assert ss.offset(SQUARE, [-5.0, -1e6], tolerance=tolerance) == []
    (small,) = ss.offset(SQUARE, -1.0 + 2.0 * tolerance, tolerance=tolerance)
    assert 0.0 < small.area < 36e-6


def test_contours_come_in_the_order_of_the_distances() -> None:
    contours = ss.offset(SQUARE, [0.3, -5.0, -0.5, 0.0], tolerance=1e-2)
    assert [contour.distance for contour in contours] == [0.3, -0.5, 0.0]
    (alone,) = ss.offset(SQUARE, -0.5, tolerance=1e-2)
    assert np.array_equal(alone.arcs, contours[1].arcs)


@pytest.mark.parametrize(
    "distances",
    [np.nan, [0.1, np.inf], [], "near", [[0.1, 0.2]], [0.1, [0.2]], {}, [1j]],
)
def test_bad_distances_are_refused_in_one_line(distances: ArrayLike) -> None:
    with pytest.raises(ss.InputError, match=r"^expected .*distances.*, got .*$"):
        ss.offset(SQUARE, distances, tolerance=1e-2)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.nan, np.inf, 1e-18, "fine", [1e-3], 1j])
def test_bad_tolerances_are_refused_in_one_line(tolerance: float) -> None:
    with pytest.raises(ss.InputError, match=r"^expected a .*tolerance.*, got .*$"):
        ss.offset(SQUARE, 0.1, tolerance=tolerance)


def measures(shape: ss.Shape, distances: list[float], tolerance: float) -> np.ndarray:
    contours = ss.offset(shape, distances, tolerance=tolerance)
    assert len(contours) == len(distances)
    return np.array([(contour.length, contour.area) for contour in contours])


@cache
def expected_measures() -> np.ndarray:
    return measures(gamma("gamma2"), [0.05, -0.05], 1e-4)


@pytest.mark.parametrize("range_of_t", [(1.0, "1 + 2*pi"), ("-7", "2*pi - 7")])
@pytest.mark.parametrize("sense", ["t", "(-t)"])
def test_start_point_and_direction_do_not_matter(range_of_t: tuple[float, str], sense: str) -> None:
    x, y = (re.sub(r"\bt\b", sense, text) for text in FORMULAS["gamma2"])
    found = measures(ss.Shape.from_formula(x, y, t=range_of_t), [0.05, -0.05], 1e-4)
    # Both are within the tolerance of the same curve.
    assert found == pytest.approx(expected_measures(), abs=2e-4 * expected_measures().max())


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e3])
@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.37, -2.0)])
def test_scale_and_place_do_not_matter(scale: float, shift: tuple[float, float]) -> None:
    x, y = (
        f"{scale} * ({text} + {move})" for text, move in zip(FORMULAS["gamma2"], shift, strict=True)
    )
    distances = [0.05 * scale, -0.05 * scale]
    found = measures(ss.Shape.from_formula(x, y), distances, 1e-4 * scale) / [scale, scale**2]
    assert found == pytest.approx(expected_measures(), abs=2e-4 * expected_measures().max())


def circle_path(x: float, y: float, radius: float) -> str:
    """A circle as drawing programs write it: four cubics, radius off by 3e-4 of it at most."""
    k = 0.5522847498 * radius
    return (
        f"M{x + radius} {y} C{x + radius} {y + k} {x + k} {y + radius} {x} {y + radius} "
        f"S{x - radius} {y + k} {x - radius} {y} S{x - k} {y - radius} {x} {y - radius} "
        f"S{x + radius} {y - k} {x + radius} {y} Z"
    )


def test_plate_with_holes_once_died_of_a_singular_matrix() -> None:
    holes = [(15, 15, 6), (15, 60, 6), (60, 15, 6), (15, 37, 4), (38, 15, 4)]
    outline = "M0 0 H80 V30 H30 V80 H0 Z"
    path = " ".join([outline, *(circle_path(*hole) for hole in holes)])
    shape, tolerance = ss.Shape.from_svg_path(path, fill="evenodd"), 1e-2
    distances = [-3.0, -6.0, 3.0, 6.0, 9.0]
    contours = ss.offset(shape, distances, tolerance=tolerance)
    picture = Picture(shape, 9.0)
    for distance in distances:
        chosen = [contour for contour in contours if contour.distance == distance]
        # At 6 three holes shrink to points, at -6 pieces are about to part: pixels cannot tell.
        check(shape, chosen, distance, tolerance, picture, count=abs(distance) != 6.0)
    assert all(contour.y_down for contour in contours)


REAL = ["dejavu_sans_B.txt", "dejavu_sans_8.txt", "gear-fill.svg", "geo-alt-fill.svg"]


def path_data(file: str) -> str:
    text = (DATA / file).read_text()
    if not file.endswith(".svg"):
        return text
    (path,) = re.findall(r'\bd="([^"]*)"', text)
    return str(path)


@cache
def real_shape(file: str) -> ss.Shape:
    if file.endswith(".svg"):
        return ss.read(DATA / file)
    return ss.Shape.from_svg_path(path_data(file))


@cache
def real_picture(file: str) -> Picture:
    shape = real_shape(file)
    return Picture(shape, 0.1 * shape.size)


def other_signed_distance(path: str, points: np.ndarray) -> np.ndarray:
    """By shapely, to a fine polyline whose vertices are svgelements'; for loops that do not cross.

    400 vertices a curve, so on a half circle its sag is (pi / 400)² / 8 = 8e-6 of the radius.
    """
    t = np.linspace(0.0, 1.0, 401)
    region = shapely.Polygon()
    for loop in svgelements.Path(path).as_subpaths():
        pieces = [
            np.asarray(piece.npoint(t if not isinstance(piece, svgelements.Line) else t[[0, -1]]))
            for piece in svgelements.Path(loop)
            if not isinstance(piece, svgelements.Move | svgelements.Close)
        ]
        region = region.symmetric_difference(shapely.Polygon(np.concatenate(pieces)))
    shapely.prepare(region)
    outside = ~shapely.contains_xy(region, points)
    distance = shapely.distance(shapely.points(points), region.boundary)
    return np.where(outside, distance, -distance)


@pytest.mark.parametrize("file", REAL)
def test_fit_of_a_real_outline_keeps_its_tolerance(file: str) -> None:
    shape = real_shape(file)
    tolerance = 1e-3 * shape.size
    spline = ss.fit(shape, tolerance=tolerance).spline
    xmin, ymin, xmax, ymax = spline.domain
    points = np.random.default_rng(5).uniform((xmin, ymin), (xmax, ymax), (20_000, 2))
    exact = ss.signed_distance(shape, points)
    assert np.abs(spline(points) - exact).max() <= tolerance
    other = other_signed_distance(path_data(file), points[:4000])
    # The polyline's sag, with radii up to half the size; no sign may differ.
    assert np.abs(other - exact[:4000]).max() < 4e-6 * shape.size


# At the letters' half stroke, 0.05 of the size, offsets end in tails that no picture resolves.
@pytest.mark.parametrize("share", [-0.03, -0.02, 0.02, 0.08])
@pytest.mark.parametrize("file", REAL)
def test_offsets_of_a_real_outline(file: str, share: float) -> None:
    shape = real_shape(file)
    distance, tolerance = share * shape.size, 1e-4 * shape.size
    contours = ss.offset(shape, distance, tolerance=tolerance)
    check(shape, contours, distance, tolerance, real_picture(file))
    if share == 0.02:
        # Two counters in B and 8, the eye of the icons: holes go round the other way.
        holes = 2 if file.startswith("dejavu") else 1
        assert sum(contour.area < 0.0 for contour in contours) == holes
        assert sum(contour.area > 0.0 for contour in contours) == 1
