"""The exact distance against 40 digits, against GEOS on polylines, and against fractions."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from tests import oracles
from tests.glyphs import glyphs
from tests.precise import Bezier, precise_distance
from tests.real_shapes import SMOOTH, around, beside, formula_arcs, formula_shape, icons, outlines

# Bézier pieces are given exactly; about four roundings in a coordinate of at most 1.2 sizes.
ROUNDING = 1e-15
# The same, and the compiled pieces of a formula, which agree with it to four roundings or, where
# it is noisier than that, to its noise: cos(3*t) loses the digits that 3*t has before the point.
FORMULA_ROUNDING = 1e-14
# How far the polylines stay from the curves, as a share of the size.
DEVIATION = 1e-6

# Cubics whose every part bounds the fill: with a loop, with a cusp, and both nearly.
CUBICS = {
    "loop": [(0, 0), (2, 1.5), (-1, 1.5), (1, 0)],
    "wide loop": [(0, 0), (9, 5), (-8, 5), (1, 0)],
    "cusp": [(0, 0), (1, 1), (0, 1), (1, 0)],
    "almost a cusp": [(0, 0), (1 - 1e-9, 1), (1e-9, 1), (1, 0)],
    "tiny loop": [(0, 0), (1 + 1e-6, 1), (-1e-6, 1), (1, 0)],
    "s": [(0, 0), (0, 3), (1, -3), (1, 0)],
    "flat end": [(0, 0), (0, 0), (1, 2), (1, 0)],
}
# All contours of these bound the fill, so that the nearest piece is the nearest boundary.
PLAIN_GLYPHS = "AgSß&@§Ååfø8Θξ"
PLAIN_ICONS = ("fan", "fingerprint", "github", "hurricane", "snow2", "virus")


def questions(shape: ss.Shape, count: int, seed: int) -> np.ndarray:
    return np.concatenate([around(shape, count, seed), beside(shape, count, seed)])


def worst_miss(shape: ss.Shape, expected: np.ndarray, points: np.ndarray) -> float:
    """Largest error of the unsigned distance, as a share of the size."""
    found = np.abs(ss.signed_distance(shape, points))
    return float(np.max(np.abs(found - expected))) / shape.size


def pieces(shape: ss.Shape) -> list[Bezier]:
    return [Bezier(oracles.piece(shape, i)) for i in range(shape.piece_count)]


@pytest.mark.parametrize("name", SMOOTH)
def test_formulas_against_40_digits(name: str) -> None:
    shape = formula_shape(name)
    points = questions(shape, 25, 1)
    expected = precise_distance(formula_arcs(name), points)
    assert worst_miss(shape, expected, points) < FORMULA_ROUNDING


@pytest.mark.parametrize("name", CUBICS)
def test_cubics_against_40_digits(name: str) -> None:
    shape = ss.Shape.from_pieces([[CUBICS[name]]], close=True)
    points = questions(shape, 40, 2)
    assert worst_miss(shape, precise_distance(pieces(shape), points), points) < ROUNDING


@pytest.mark.parametrize("character", PLAIN_GLYPHS)
def test_glyphs_against_40_digits(character: str) -> None:
    shape = glyphs()[f"DejaVuSans:{character}"]
    points = questions(shape, 15, 3)
    assert worst_miss(shape, precise_distance(pieces(shape), points), points) < ROUNDING


@pytest.mark.parametrize("name", PLAIN_ICONS)
def test_icons_against_40_digits(name: str) -> None:
    shape = icons()[name]
    points = questions(shape, 15, 4)
    assert worst_miss(shape, precise_distance(pieces(shape), points), points) < ROUNDING


def test_random_chains_of_cubics_against_40_digits() -> None:
    # Under the even-odd rule every crossing changes sides: all of the curve is boundary.
    rng = np.random.default_rng(5)
    for _ in range(12):
        corners = rng.uniform(-1.0, 1.0, (4, 2))
        handles = rng.uniform(-1.5, 1.5, (4, 2, 2))
        loop = [np.stack([corners[i - 1], *handles[i], corners[i]]) for i in range(4)]
        shape = ss.Shape.from_pieces([loop], fill="evenodd")
        points = questions(shape, 8, 6)
        assert worst_miss(shape, precise_distance(pieces(shape), points), points) < ROUNDING


def check_against_polylines(
    shape: ss.Shape, points: np.ndarray, deviation: float, least: float = 0.95
) -> None:
    """Distances within the polylines' deviation, and no wrong side farther away than that.

    At least so many of the points must be where the polylines are sure.
    """
    expected = oracles.sure_polyline_distance(shape, points, deviation)
    assert expected is not None
    distance, sure = expected
    found = ss.signed_distance(shape, points)
    allowed = deviation + oracles.SNAP * np.abs(points).max()
    assert np.mean(sure) > least
    assert np.max(np.abs(np.abs(found) - np.abs(distance)), where=sure, initial=0.0) < allowed
    clear = sure & (np.abs(distance) > allowed)
    assert np.array_equal(found[clear] < 0, distance[clear] < 0)


@pytest.mark.parametrize("name", sorted(glyphs())[::2])
def test_glyphs_against_polylines(name: str) -> None:
    shape = glyphs()[name]
    check_against_polylines(shape, questions(shape, 100, 7), DEVIATION * shape.size)


@pytest.mark.parametrize("name", sorted(icons())[::2])
def test_icons_against_polylines(name: str) -> None:
    shape = icons()[name]
    # Two of its elements touch along an edge: beside it polylines are sure of 90 % only.
    least = 0.9 if name == "bing" else 0.95
    check_against_polylines(shape, questions(shape, 150, 8), DEVIATION * shape.size, least)


@pytest.mark.parametrize("name", sorted(outlines()))
def test_outlines_against_polygons(name: str) -> None:
    # A polygon is its own polyline: only rounding is left, and the grid of the oracle.
    shape = outlines()[name]
    check_against_polylines(shape, questions(shape, 5000, 9), 0.5 * ROUNDING * shape.size)


@pytest.mark.parametrize("name", sorted(outlines()))
def test_sides_a_trillionth_from_an_outline(name: str) -> None:
    shape = outlines()[name]
    corners = [ring[:-1] for ring in oracles.polylines(shape, 1.0)]
    line = np.concatenate(corners)
    rng = np.random.default_rng(10)
    at = rng.integers(len(line), size=150)
    place = line[at] + rng.uniform(0, 1, (150, 1)) * (np.roll(line, -1, axis=0)[at] - line[at])
    points = place + 1e-12 * shape.size * rng.normal(size=(150, 2))
    number = np.array([oracles.exact_winding_number(corners, point) for point in points])
    found = ss.signed_distance(shape, points) < 0
    assert np.array_equal(found, oracles.is_filled(number, shape.fill))


@pytest.mark.parametrize("name", ["DejaVuSans:g", "DejaVuSans:&", "DejaVuSerif-Italic:B"])
def test_sides_a_trillionth_from_a_glyph(name: str) -> None:
    # On a segment that no contour meets but at its middle, the side changes there only.
    shape = glyphs()[name]
    rings = oracles.polylines(shape, 1e-6 * shape.size)
    rng = np.random.default_rng(11)
    place, normal = [], []
    for control in (oracles.piece(shape, i) for i in range(shape.piece_count)):
        a, b, c = control if len(control) == 3 else (control[0], control.mean(axis=0), control[1])
        for t in rng.uniform(0.1, 0.9, 4):
            place.append((1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c)
            along = (1 - t) * (b - a) + t * (c - b)
            normal.append(np.array([along[1], -along[0]]) / np.linalg.norm(along))
    place, normal = np.array(place), np.array(normal)
    for side in (-1.0, 1.0):
        far = place + side * 1e-3 * shape.size * normal
        clear = oracles.polyline_distance(rings, far) > 0.99e-3 * shape.size
        assert np.mean(clear) > 0.8
        expected = oracles.is_filled(oracles.winding_number(rings, far[clear]), shape.fill)
        near = place[clear] + side * 1e-12 * shape.size * normal[clear]
        assert np.array_equal(ss.signed_distance(shape, near) < 0, expected)


def test_sides_at_the_point_where_three_petals_meet() -> None:
    # r = cos(3 angle) / 2 about the middle, where that is positive: no other part is filled.
    rng = np.random.default_rng(15)
    angle = rng.uniform(0.0, 2 * np.pi, 20_000)
    radius = 10.0 ** rng.uniform(-11.5, -0.4, 20_000)
    points = 0.45 + radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    # As the points came out, relative to the middle as it is drawn.
    x, y = (points - 0.45).T
    radius, cosine = np.hypot(x, y), np.cos(3.0 * np.arctan2(y, x))
    inside = 2.0 * radius < cosine
    # Both cos(3 angle) r and r - cos(3 angle) / 2 change by at most 3 for a step of one.
    clear = np.minimum(np.abs(cosine) * radius, np.abs(radius - 0.5 * cosine)) > 3e-12
    assert np.mean(clear) > 0.9
    found = ss.signed_distance(formula_shape("gamma3"), points) < 0
    assert np.array_equal(found[clear], inside[clear])


@pytest.mark.parametrize("name", ["gamma1", "gamma2", "wavy"])
def test_many_points_beside_a_curve(name: str) -> None:
    # In company each point starts from what others found; at 1e-14 that is all rounding. Distances
    # are compared with those that few points at a time get, in another order.
    shape = formula_shape(name)
    points = np.concatenate([around(shape, 50_000, 12), beside(shape, 50_000, 13)])
    together = ss.signed_distance(shape, points)
    assert np.isfinite(together).all()
    some = np.random.default_rng(14).choice(len(points), 4000, replace=False)
    few = np.concatenate([ss.signed_distance(shape, points[part]) for part in np.split(some, 200)])
    assert np.max(np.abs(together[some] - few)) < FORMULA_ROUNDING * shape.size
    rings = oracles.polylines(shape, 1e-7)
    clear = np.abs(together) > 1e-6
    inside = oracles.is_filled(oracles.winding_number(rings, points[clear]), shape.fill)
    assert np.array_equal(together[clear] < 0, inside)
