"""What counts is the boundary of the filled region: contours that cross, overlap, repeat, touch."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

import splinesdf as ss
from tests import oracles
from tests.examples import examples

# Crossings are rounded once, and so are the ends of the oracle's parts; then a distance has about
# four roundings: a share of the largest coordinate.
ROUNDING = 4e-15
DEVIATION = 1e-6
RULES = ("nonzero", "evenodd")
rules = st.sampled_from(RULES)

Corners = list[np.ndarray]


def square(low: float, high: float) -> np.ndarray:
    return np.array([(low, low), (high, low), (high, high), (low, high)])


def rectangle(x: float, y: float, width: float, height: float) -> np.ndarray:
    return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])


SQUARE = square(0.0, 1.0)
NASTY: dict[str, Corners] = {
    "cross": [rectangle(0, 2, 5, 1), rectangle(2, 0, 1, 5)],
    "cross, one backwards": [rectangle(0, 2, 5, 1), rectangle(2, 0, 1, 5)[::-1]],
    "square in square": [square(0, 3), square(1, 2)],
    "square in square, backwards": [square(0, 3), square(1, 2)[::-1]],
    "drawn twice": [SQUARE, SQUARE],
    "drawn twice, other start": [SQUARE, np.roll(SQUARE, 1, axis=0)],
    "drawn twice, backwards, and another": [SQUARE, SQUARE[::-1], square(2, 3)],
    "drawn three times": [SQUARE, SQUARE, SQUARE],
    "traced twice": [np.concatenate([SQUARE, SQUARE])],
    "shared edge, same way round": [rectangle(0, 0, 1, 1), rectangle(1, 0, 1, 1)],
    "shared edge, opposite ways round": [rectangle(0, 0, 1, 1), rectangle(1, 0, 1, 1)[::-1]],
    "shared part of an edge": [rectangle(0, 0, 1, 3), rectangle(1, 1, 1, 1)],
    "shared edge inside": [rectangle(0, 0, 3, 3), rectangle(0, 1, 1, 1)],
    "shared edge of a hole": [rectangle(0, 0, 3, 3), rectangle(0, 1, 1, 1)[::-1]],
    "shared corner": [square(0, 1), square(1, 2)],
    "bow tie": [np.array([(0, 0), (2, 2), (2, 0), (0, 2)], dtype=float)],
    "pentagram": [np.array([(0, 3), (2, -3), (-3, 1), (3, 1), (-2, -3)], dtype=float)],
    "slit outside": [
        np.array([(0, 0), (4, 0), (4, 2), (7, 2), (4, 2), (4, 4), (0, 4)], dtype=float)
    ],
    "slit inside": [
        np.array([(0, 0), (4, 0), (4, 2), (1, 2), (4, 2), (4, 4), (0, 4)], dtype=float)
    ],
    "bent slit": [
        np.array([(0, 0), (4, 0), (4, 2), (6, 2), (6, 3), (6, 2), (4, 2), (4, 4), (0, 4)])
    ],
    "bridge to a hole": [
        np.array(
            [(0, 0), (5, 0), (5, 5), (0, 5), (0, 2), (2, 2), (2, 3), (3, 3), (3, 2), (2, 2), (0, 2)]
        )
    ],
    "thin sliver": [rectangle(0, 0, 1, 1e-9)],
    "thin overlap": [rectangle(0, 0, 1, 1), rectangle(1 - 1e-9, 0, 1, 1)],
    "thin gap": [rectangle(0, 0, 1, 1), rectangle(1 + 1e-9, 0, 1, 1)],
    "needle out of a square": [
        np.array([(0, 0), (1, 0), (1, 0.5), (3, 0.5), (1, 0.5 + 1e-9), (1, 1), (0, 1)])
    ],
    "three lines through one point": [
        rectangle(-3, -1, 6, 2),
        np.array([(-2, -3), (0, -3), (2, 3), (0, 3)], dtype=float),
        np.array([(2, -3), (0, -3), (-2, 3), (0, 3)], dtype=float),
    ],
}  # fmt: skip
EMPTY = [
    ("drawn twice", "evenodd"),
    ("drawn twice, other start", "evenodd"),
    ("traced twice", "evenodd"),
]


def polygons(corners: Sequence[np.ndarray], fill: str) -> ss.Shape:
    """One loop a ring, straight pieces; a ring that is a single point has no pieces."""
    loops = []
    for ring in corners:
        sides = zip(ring, np.roll(ring, -1, axis=0), strict=True)
        loops.append([np.array(side, dtype=float) for side in sides if (side[0] != side[1]).any()])
    return ss.Shape.from_pieces(loops, fill=fill)


def sharpest_crossing(starts: np.ndarray, stops: np.ndarray) -> float:
    """Sine of the smallest angle at which two sides cross: there, rounding moves the place."""
    along = stops - starts
    length = np.linalg.norm(along, axis=1)

    def turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]

    # Entry (i, j): on which sides of side i the ends of side j are.
    first = turn(along[:, None], starts[None] - starts[:, None])
    second = turn(along[:, None], stops[None] - starts[:, None])
    apart = first * second < 0
    with np.errstate(invalid="ignore", divide="ignore"):
        sine = np.abs(turn(along[:, None], along[None])) / (length[:, None] * length[None])
    return float(np.min(sine, where=apart & apart.T & (sine > 1e-15), initial=1.0))


def check_polygons(corners: Sequence[np.ndarray], fill: str, seed: int) -> None:
    """Distance and side against fractions, at places all about and close to every contour."""
    shape = polygons(corners, fill)
    every = np.concatenate([np.asarray(ring, dtype=float) for ring in corners])
    size, low = np.ptp(every, axis=0).max(), every.min(axis=0)
    rng = np.random.default_rng(seed)
    sides = np.concatenate([np.roll(ring, -1, axis=0) - ring for ring in corners])
    at = rng.integers(len(every), size=60)
    on = every[at] + rng.uniform(0.0, 1.0, (60, 1)) * sides[at]
    off = size * 10.0 ** rng.uniform(-12.0, -1.0, (60, 1)) * rng.normal(size=(60, 2))
    points = np.concatenate([low + size * rng.uniform(-0.2, 1.2, (60, 2)), on + off])
    boundary = oracles.exact_filled_boundary(corners, fill)
    if not boundary:
        with pytest.raises(ss.InputError):
            ss.signed_distance(shape, points)
        return
    found = ss.signed_distance(shape, points)
    expected = oracles.polyline_distance(boundary, points)
    rounding = ROUNDING * (np.abs(every).max() + size) / sharpest_crossing(every, every + sides)
    assert np.max(np.abs(np.abs(found) - expected)) < rounding
    number = np.array([oracles.exact_winding_number(corners, point) for point in points])
    clear = expected > rounding
    assert np.array_equal((found < 0)[clear], oracles.is_filled(number, fill)[clear])


@pytest.mark.parametrize("fill", RULES)
@pytest.mark.parametrize("name", NASTY)
def test_nasty_polygons(name: str, fill: str) -> None:
    check_polygons(NASTY[name], fill, seed=1)


@pytest.mark.parametrize(("name", "fill"), EMPTY)
def test_shapes_that_fill_nothing_are_refused(name: str, fill: str) -> None:
    assert oracles.exact_filled_boundary(NASTY[name], fill) == []
    with pytest.raises(ss.InputError):
        ss.signed_distance(polygons(NASTY[name], fill), (0.5, 0.5))


@pytest.mark.parametrize("fill", RULES)
@pytest.mark.parametrize("name", NASTY)
@pytest.mark.parametrize("scale", [1e-7, 1e-6, 1e6])
def test_nasty_polygons_of_other_sizes(name: str, fill: str, scale: float) -> None:
    check_polygons([scale * ring for ring in NASTY[name]], fill, seed=2)


@pytest.mark.parametrize("fill", RULES)
@pytest.mark.parametrize(
    "name", [name for name in NASTY if "thin" not in name and "needle" not in name]
)
def test_nasty_polygons_far_from_the_origin(name: str, fill: str) -> None:
    check_polygons([ring + np.array([1e7, -1e7]) for ring in NASTY[name]], fill, seed=3)


# Few places to choose from, so that sides overlap, corners coincide and crossings meet.
grid = st.tuples(st.integers(0, 4), st.integers(0, 4))
rings = st.lists(grid, min_size=3, max_size=6).filter(lambda ring: len(set(ring)) > 1)


@given(st.lists(rings, min_size=1, max_size=2), rules)
@examples(60)
def test_polygons_on_a_coarse_grid(corners: list[list[tuple[int, int]]], fill: str) -> None:
    check_polygons([np.array(ring, dtype=float) for ring in corners], fill, seed=4)


reals = st.floats(-1.0, 1.0, allow_subnormal=False).map(lambda x: round(x, 6))


@given(st.lists(st.tuples(reals, reals), min_size=3, max_size=8), rules)
@examples(40)
def test_polygons_that_cross_themselves(corners: list[tuple[float, float]], fill: str) -> None:
    ring = np.array(corners)
    assume(np.ptp(ring, axis=0).max() >= 0.01)
    check_polygons([ring], fill, seed=5)


boxes = st.tuples(*[st.integers(0, 6)] * 2, *[st.integers(1, 5)] * 2, st.booleans())


@given(st.lists(boxes, min_size=2, max_size=4), rules)
@examples(40)
def test_rectangles_that_overlap(drawn: list[tuple[int, int, int, int, bool]], fill: str) -> None:
    corners = [rectangle(*box[:4])[:: -1 if box[4] else 1].astype(float) for box in drawn]
    check_polygons(corners, fill, seed=6)


Loop = list[np.ndarray]


def check_curves(loops: Sequence[Loop], fill: str, seed: int) -> int:
    """Distance and side against polylines; gives how many points it judged."""
    shape = ss.Shape.from_pieces(loops, fill=fill)
    deviation = DEVIATION * float(np.ptp(shape.control, axis=0).max())
    low, high = shape.control.min(axis=0), shape.control.max(axis=0)
    points = np.random.default_rng(seed).uniform(low, high, (150, 2))
    expected = oracles.sure_polyline_distance(shape, points, deviation)
    if expected is None:
        with pytest.raises(ss.InputError):
            ss.signed_distance(shape, points)
        return 0
    distance, sure = expected
    found = ss.signed_distance(shape, points)
    assert np.max(np.abs(np.abs(found) - np.abs(distance)), where=sure, initial=0.0) < deviation
    clear = sure & (np.abs(distance) > deviation)
    assert np.array_equal(found[clear] < 0, distance[clear] < 0)
    return int(np.count_nonzero(clear))


def reversed_loop(loop: Loop) -> Loop:
    return [piece[::-1] for piece in reversed(loop)]


def circle(x: float, y: float, radius: float) -> Loop:
    """Four cubics, close to a circle; their joints are at exactly ``radius`` from the middle."""
    k = 0.5522847498307936
    corner = [(1, 0), (1, k), (k, 1), (0, 1)]
    result = []
    for _ in range(4):
        result.append((x, y) + radius * np.array(corner))
        corner = [(-b, a) for a, b in corner]
    return result


ROUND: dict[str, list[Loop]] = {
    "two circles": [circle(0, 0, 1), circle(1, 0.5, 1)],
    "two circles, one backwards": [circle(0, 0, 1), reversed_loop(circle(1, 0.5, 1))],
    "three circles": [circle(0, 0, 1), circle(1, 0.25, 1), circle(0.5, 1, 0.75)],
    "circle in circle": [circle(0, 0, 2), circle(0.25, 0, 1)],
    "ring": [circle(0, 0, 2), reversed_loop(circle(0.25, 0, 1))],
    "twice": [circle(0, 0, 1), circle(0, 0, 1)],
    "to and fro, and another": [circle(0, 0, 1), reversed_loop(circle(0, 0, 1)), circle(3, 0, 1)],
    "traced twice": [circle(0, 0, 1) * 2],
    "tangent outside": [circle(0, 0, 1), circle(2, 0, 1)],
    "tangent inside": [circle(0, 0, 2), circle(1, 0, 1)],
    "tangent hole": [circle(0, 0, 2), reversed_loop(circle(1, 0, 1))],
    "half a circle out and back": [
        [*circle(0, 0, 1), *circle(-1, 0, 2)[:2], *reversed_loop(circle(-1, 0, 2)[:2])]
    ],
    "clover, with its middle": [
        [
            np.array([(0, 0), (3, 1), (3, -1), (0, 0)]),
            np.array([(0, 0), (-1, 3), (1, 3), (0, 0)]),
            np.array([(0, 0), (-3, -1), (-3, 1), (0, 0)]),
        ]
    ],
    "loop over the fill": [
        [
            np.array([(0, 0), (2, -1.5), (-1, -1.5), (1, 0)]),
            np.array([(1, 0), (1, -3), (0, -3), (0, 0)]),
        ]
    ],
}


@pytest.mark.parametrize("fill", RULES)
@pytest.mark.parametrize("name", ROUND)
def test_nasty_curves(name: str, fill: str) -> None:
    loops = [[np.asarray(piece, dtype=float) for piece in loop] for loop in ROUND[name]]
    judged = check_curves(loops, fill, seed=7)
    assert judged > 140 or (fill == "evenodd" and "twice" in name)


@given(st.integers(0, 10**9), st.integers(1, 4), st.integers(1, 2), rules)
@example(4702, 4, 1, "nonzero")  # two neighbors that cross once more beside their joint
@examples(60)
def test_random_chains_of_cubics(seed: int, count: int, loops: int, fill: str) -> None:
    rng = np.random.default_rng(seed)
    drawn = []
    for _ in range(loops):
        corners = rng.uniform(-1.0, 1.0, (count, 2))
        handles = rng.uniform(-2.0, 2.0, (count, 2, 2))
        drawn.append([np.stack([corners[i - 1], *handles[i], corners[i]]) for i in range(count)])
    check_curves(drawn, fill, seed=8)


@given(
    st.lists(st.tuples(reals, reals, st.floats(0.2, 1.0), st.booleans()), min_size=2, max_size=4),
    rules,
)
@examples(40)
def test_circles_that_overlap(drawn: list[tuple[float, float, float, bool]], fill: str) -> None:
    loops = []
    for x, y, radius, backwards in drawn:
        loop = circle(x, y, radius)
        loops.append(reversed_loop(loop) if backwards else loop)
    check_curves(loops, fill, seed=9)


@pytest.mark.parametrize("thickness", [1e-320, 1e-20, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13])
@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize("corners", [3, 4, 5])
def test_a_sliver_that_is_closed_leaves_nothing(
    thickness: float, turn: float, corners: int
) -> None:
    """Of its sides nothing counts; its short ends once stayed and attracted the distance."""
    h = thickness
    drawn = {
        3: [(0.0, 0.0), (4.0, 0.0), (4.0, h)],
        4: [(0.0, 0.0), (4.0, 0.0), (4.0, h), (0.0, h)],
        5: [(0.0, 0.0), (4.0, 0.0), (4.0 + h, h / 2), (4.0, h), (0.0, h)],
    }[corners]
    turned = np.array(drawn) @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    square = np.array([(10.0, 0.0), (11.0, 0.0), (11.0, 1.0), (10.0, 1.0)])
    pieces = [[*np.stack([loop, np.roll(loop, -1, axis=0)], axis=1)] for loop in (square, turned)]
    points = np.random.default_rng(4).uniform(-1.0, 12.0, (200, 2))
    found = ss.signed_distance(ss.Shape.from_pieces(pieces), points)
    alone = ss.signed_distance(ss.Shape.from_pieces(pieces[:1]), points)
    along = np.clip(points @ (turned[1] / 16.0), 0.0, 1.0)[:, None] * turned[1]
    whole = np.minimum(alone, np.hypot(*(points - along).T))
    # All of it, or nothing of it: which, is a matter of rounding.
    assert np.allclose(found, alone, atol=1e-12) or np.allclose(found, whole, atol=1e-12)


# A square with a square hole, joined by a bridge that is drawn to and fro; and one with a spike of
# a cubic into its inside, there and back.
KEYHOLE = "M0 0L40 0L40 40L0 40L0 0L11 9L11 18L20 18L20 9L11 9Z"
SPIKE = "M0 0L40 0L40 40L0 40L0 0C9 2 5 17 23 31C5 17 9 2 0 0Z"
# Mixed up by an own map: a similarity leaves no number round.
TURNED = np.array([[0.8, -0.6], [0.6, 0.8]])


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("fill", ["nonzero", "evenodd"])
@pytest.mark.parametrize("path", [KEYHOLE, SPIKE])
def test_points_on_lines_that_bound_nothing_are_inside(path: str, fill: str, turned: bool) -> None:
    # To rounding one way of the line is on the left of such a point and the other on the right.
    drawn = ss.Shape.from_svg_path(path, fill=fill)
    matrix = TURNED if turned else np.eye(2)
    pieces = [drawn.piece(i) @ matrix for i in range(drawn.piece_count)]
    shape = ss.Shape.from_pieces([pieces], fill=fill)
    random = np.random.default_rng(2)
    t = np.concatenate([np.arange(1, 400) / 400.0, random.random(4000)])
    control = pieces[4]
    points = np.zeros((len(t), 2))
    last = len(control) - 1
    for k, point in enumerate(control):
        points += (comb(last, k) * t**k * (1.0 - t) ** (last - k))[:, None] * point
    # Clear of the boundary, by which a side is told for rounding only.
    points = points[(t > 0.01) & (t < 0.99)]
    together = ss.signed_distance(shape, points)
    alone = np.array([ss.signed_distance(shape, point) for point in points[:400]])
    near = ss.signed_distance(shape, np.concatenate([points[:400], points[:400] + 0.01]))
    for found in (together, alone, near):
        assert (found < 0.0).all(), f"{np.sum(found >= 0.0)} of {len(found)} outside"
