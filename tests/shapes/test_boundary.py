from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.arclets.crossings import find_crossings
from splinesdf.arclets.points import points_at, tangents_at
from splinesdf.arclets.tables import Arclets
from splinesdf.shapes.boundary import _closed
from splinesdf.shapes.sources.compiled import polygon
from tests.glyphs import glyphs
from tests.named_shapes import gamma
from tests.real_shapes import icons

Corners = list[tuple[float, float]]

# What the package takes as touching, for coordinates of size one.
TOUCHING = 64 * np.finfo(float).eps


def square(x: float, y: float, side: float = 1.0) -> Corners:
    return [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]


def polygons(*rings: Corners, fill: str = "nonzero") -> ss.Shape:
    return ss.Shape.from_pieces([polygon(ring) for ring in rings], fill=fill)


def circles(*drawn: tuple[float, float, float], fill: str = "nonzero") -> ss.Shape:
    return ss.Shape.from_svg_path(
        " ".join(
            f"M{x + r} {y}A{r} {r} 0 1 1 {x - r} {y}A{r} {r} 0 1 1 {x + r} {y}Z"
            for x, y, r in drawn
        ),
        fill=fill,
    )


SLIT = [(0, 0), (1, 0), (1, 1), (0.5, 1), (0.5, 0.5), (0.5, 1), (0, 1)]
SPIKE = [(0, 0), (1, 0), (1, 1), (0.5, 1), (0.5, 1.5), (0.5, 1), (0, 1)]
TANGENT = [(0.0, 0.0, 1.0), (0.5, 0.0, 0.5)]

# Shape, loops of the boundary, area of what is filled.
KNOWN = {
    "square": (polygons(square(0, 0)), 1, 1.0),
    "square, clockwise": (polygons(square(0, 0)[::-1]), 1, 1.0),
    "overlap": (polygons(square(0, 0), square(0.5, 0.25)), 1, 1.625),
    "overlap, evenodd": (polygons(square(0, 0), square(0.5, 0.25), fill="evenodd"), 2, 1.25),
    "overlap, one clockwise": (polygons(square(0, 0), square(0.5, 0.25)[::-1]), 2, 1.25),
    "common side": (polygons(square(0, 0), square(1, 0)), 1, 2.0),
    "common part of a side": (polygons(square(0, 0), square(1, 0.25, 0.5)), 1, 1.25),
    "common corner": (polygons(square(0, 0), square(1, 1)), 2, 2.0),
    "drawn twice": (polygons(square(0, 0), square(0, 0)), 1, 1.0),
    "drawn three times": (polygons(*[square(0, 0)] * 3, fill="evenodd"), 1, 1.0),
    "square in a square": (polygons(square(0, 0), square(0.25, 0.25, 0.5)), 1, 1.0),
    "hole": (polygons(square(0, 0), square(0.25, 0.25, 0.5)[::-1]), 2, 0.75),
    "slit": (polygons(SLIT), 1, 1.0),
    "spike": (polygons(SPIKE), 1, 1.0),
    "circles": (circles((0, 0, 1), (3, 0, 1), (0, 3, 0.5)), 3, 2.25 * np.pi),
    "circle twice": (circles((0, 0, 1), (0, 0, 1)), 1, np.pi),
    "tangent inside": (circles(*TANGENT), 1, np.pi),
    "tangent hole": (circles(*TANGENT, fill="evenodd"), None, 0.75 * np.pi),
    "tangent outside": (circles((0, 0, 1), (2, 0, 1)), 2, 2.0 * np.pi),
    "petals": (gamma("gamma3"), None, np.pi / 16.0),
}


def loops(boundary: Arclets) -> list[list[int]]:
    """Arclets in the order in which they follow one another; every one must be led to once."""
    assert np.array_equal(np.sort(boundary.following), np.arange(len(boundary.start)))
    left = set(range(len(boundary.start)))
    result = []
    while left:
        loop = [min(left)]
        while boundary.following[loop[-1]] != loop[0]:
            loop.append(int(boundary.following[loop[-1]]))
        left -= set(loop)
        result.append(loop)
    return result


def area(boundary: Arclets) -> float:
    """Enclosed, by the chords and what lies between them and the arclets: Gauss points."""
    x, weight = np.polynomial.legendre.leggauss(10)
    arclet = np.repeat(np.arange(len(boundary.start)), 10)
    t = np.tile(0.5 * (x + 1.0), len(boundary.start))
    point, along = points_at(boundary, arclet, t), tangents_at(boundary, arclet, t)
    cross = point[:, 0] * along[:, 1] - point[:, 1] * along[:, 0]
    return float(0.25 * cross @ np.tile(weight, len(boundary.start)))


@pytest.mark.parametrize("name", KNOWN)
def test_boundaries_known_by_hand(name: str) -> None:
    shape, count, enclosed = KNOWN[name]
    boundary = shape.boundary
    found = loops(boundary)
    assert count is None or len(found) == count
    # Counterclockwise around what is filled, clockwise around holes: the areas add up. A crossing
    # may be off by what counts as touching, times the inverse of a small angle where arcs touch.
    assert area(boundary) == pytest.approx(enclosed, abs=1e-12)


def test_what_bounds_as_it_is_drawn_is_left_alone() -> None:
    for name in ("gamma1", "gamma2"):
        assert gamma(name).boundary is gamma(name).arclets


def test_a_shape_drawn_backwards_is_turned_around() -> None:
    there = polygons(square(0, 0))
    back = polygons(square(0, 0)[::-1]).boundary
    assert area(there.arclets) == pytest.approx(area(back)) == 1.0
    assert np.array_equal(np.sort(back.interval, axis=1), np.tile([0.0, 1.0], (4, 1)))
    assert np.all(back.interval[:, 0] > back.interval[:, 1])


DRAWN = {"glyph": glyphs, "icon": icons}


@pytest.mark.parametrize("name", sorted(f"{kind} {n}" for kind in DRAWN for n in DRAWN[kind]()))
def test_left_of_real_boundaries_is_inside_and_right_is_outside(name: str) -> None:
    kind, _, drawing = name.partition(" ")
    shape = DRAWN[kind]()[drawing]
    boundary = shape.boundary
    every = np.arange(len(boundary.start))
    half = np.full(len(every), 0.5)
    middle, along = points_at(boundary, every, half), tangents_at(boundary, every, half)
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    step = 1e-11 * shape.size  # thinner than the slits where icons' parts nearly meet
    left, right = (
        ss.signed_distance(shape, middle + boundary.origin + side * step * normal)
        for side in (1.0, -1.0)
    )
    # The distance to the arclet itself, unless another one is nearer still.
    rounding = 1e-14 * (shape.size + np.abs(shape.control).max())
    assert np.all((left < 0.0) & (left >= -step - rounding))
    assert np.all((right > 0.0) & (right <= step + rounding))


def naive_crossings(ring: np.ndarray) -> list[tuple[float, float]]:
    """Proper crossings of a polygon's sides, each pair tried."""
    ends = np.roll(ring, -1, axis=0)
    found = []
    for i in range(len(ring)):
        for j in range(i + 2, len(ring)):
            if (j + 1) % len(ring) == i:
                continue
            along, other = ends[i] - ring[i], ends[j] - ring[j]
            cross = along[0] * other[1] - along[1] * other[0]
            between = ring[j] - ring[i]
            s = (between[0] * other[1] - between[1] * other[0]) / cross
            t = (between[0] * along[1] - between[1] * along[0]) / cross
            if 0.0 < s < 1.0 and 0.0 < t < 1.0:
                found.append(tuple(ring[i] + s * along))
    return sorted(found)


@pytest.mark.parametrize("count", [5, 20, 100])
def test_crossings_of_a_random_polygon_equal_naive(count: int) -> None:
    ring = np.random.default_rng(count).uniform(-1.0, 1.0, (count, 2))
    arclets = ss.Shape.from_points(ring).arclets
    found = find_crossings(arclets, TOUCHING)
    places = points_at(arclets, found.pair[:, 0], found.at[:, 0]) + arclets.origin
    others = points_at(arclets, found.pair[:, 1], found.at[:, 1]) + arclets.origin
    assert np.max(np.abs(places - others)) < 1e-13
    expected = np.array(naive_crossings(ring))
    assert len(places) == len(expected) > 0
    # Rounding over the sine of the flattest crossing among some thousands.
    assert np.max(np.abs(places[np.argsort(places[:, 0])] - expected)) < 1e-10


@given(st.integers(0, 10**6), st.integers(1, 3))
def test_crossings_of_cubics_equal_those_of_fine_polylines(seed: int, degree: int) -> None:
    rng = np.random.default_rng(seed)
    first, second = rng.uniform(-1.0, 1.0, (2, 4, 2)) @ np.diag([1.0, 1.0 / degree])
    shape = ss.Shape.from_pieces([[first], [second]], close=True)
    arclets = shape.arclets
    found = find_crossings(arclets, TOUCHING)
    loop = np.searchsorted(shape.loops, arclets.piece[found.pair], side="right")
    curved = np.isin(arclets.piece[found.pair], [0, 2]).all(axis=1)
    places = points_at(arclets, found.pair[:, 0], found.at[:, 0])[
        curved & (loop[:, 0] != loop[:, 1])
    ]
    t = np.linspace(0.0, 1.0, 4001)[:, None]
    weights = np.concatenate([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3], axis=1)
    crossing = shapely.LineString(weights @ first).intersection(
        shapely.LineString(weights @ second)
    )
    expected = shapely.get_coordinates(crossing) - arclets.origin
    # Where two of the polylines' crossings are next to each other, the curves may only touch.
    apart = shapely.distance(*np.meshgrid(*[shapely.points(expected)] * 2))
    assume(np.min(apart + 10.0 * np.eye(len(expected)), initial=1.0) >= 1e-2)
    # The polylines are within 12 / 8 / 4000² of the curves, but a flat crossing moves farther.
    for place in expected:
        assert np.min(np.linalg.norm(places - place, axis=1)) < 1e-3
    for place in places:
        assert np.min(np.linalg.norm(expected - place, axis=1)) < 1e-3


@pytest.mark.parametrize("height", [1e-3, 1e-6, 1e-9, 1e-11])
def test_a_thin_lens_between_arcs_is_found(height: float) -> None:
    # Two parabolas that cross at x = -1 and 1 and bulge apart by the height in between.
    lower, upper = ([(-2, -3 * h), (0, 5 * h), (2, -3 * h)] for h in (0.5, 0.5 + height))
    shape = ss.Shape.from_pieces(
        [
            [lower, [lower[2], (0, 9)], [(0, 9), lower[0]]],
            [upper[::-1], [upper[0], (0, -9)], [(0, -9), upper[2]]],
        ]
    )
    arclets = shape.arclets
    found = find_crossings(arclets, TOUCHING * 9)
    places = points_at(arclets, found.pair[:, 0], found.at[:, 0]) + arclets.origin
    inner = places[np.abs(places[:, 0]) < 1.5]
    # Each may be found several times, within what counts as touching over the slope between them.
    near = TOUCHING * 9 / height + 1e-12
    assert np.max(np.abs(np.abs(inner[:, 0]) - 1.0)) < near
    assert np.array_equal(np.unique(np.sign(inner[:, 0])), [-1.0, 1.0])


def test_contours_that_fill_nothing_are_refused_with_advice() -> None:
    with pytest.raises(
        ss.InputError, match=r"fill nothing under the rule 'evenodd'.*fill='nonzero'"
    ):
        ss.signed_distance(polygons(square(0, 0), square(0, 0), fill="evenodd"), (0.0, 0.0))
    with pytest.raises(ss.InputError, match="fill nothing under the rule 'nonzero'"):
        ss.fit(ss.Shape.from_points([(0, 0), (1, 0), (2, 0)]), tolerance=0.1)


def test_thousands_of_contours_over_each_other() -> None:
    rng = np.random.default_rng(9)
    drawn = [(*rng.uniform(0.0, 1.0, 2), 0.02) for _ in range(1000)]
    shape = circles(*drawn)
    points = rng.uniform(0.0, 1.0, (2000, 2))
    middle = np.array(drawn)[:, :2]
    depth = 0.02 - np.linalg.norm(points[:, None] - middle, axis=2).min(axis=1)
    found = ss.signed_distance(shape, points)
    assert np.array_equal(found < 0.0, depth > 0.0)
    # Outside of all of them, the nearest one's circle is the boundary there.
    outside = depth < 0.0
    assert np.max(np.abs(found + depth)[outside]) < 1e-14


@pytest.mark.parametrize("line_first", [True, False])
def test_neighbors_that_cross_once_more_beside_their_joint(line_first: bool) -> None:
    # A cubic that turns back along the line before it, on one side of it, and crosses it soon. At
    # the joint the offset of one from the other is zero, exactly or to rounding.
    rng = np.random.default_rng(5)
    wrong = []
    for _ in range(200):
        corner, away = rng.integers(-60, 60, (2, 2)).astype(float)
        if np.hypot(*away) < 10.0:
            continue
        angle = rng.choice([-1.0, 1.0]) * rng.uniform(0.003, 0.05)
        c, s = np.cos(angle), np.sin(angle)
        handle = corner + 0.4 * np.array([c * away[0] - s * away[1], s * away[0] + c * away[1]])
        side = -np.sign(angle) * np.array([-away[1], away[0]])
        far = corner + away + 0.7 * side
        line = np.stack([corner + away, corner])
        cubic = np.stack([corner, handle, far, far])
        pieces = [line, cubic, np.stack([far, corner + away])]
        if not line_first:
            pieces = [piece[::-1] for piece in pieces[::-1]]
        shape = ss.Shape.from_pieces([pieces])
        if not inside_is_on_the_left(shape):
            wrong.append((line.tolist(), cubic.tolist()))
    assert not wrong, f"{len(wrong)} wrong: {wrong[0]}"


def inside_is_on_the_left(shape: ss.Shape) -> bool:
    """Whether points just beside all arcs of the boundary have the sides that they should."""
    boundary = shape.boundary
    every = np.arange(len(boundary.start))
    middle, chord = np.full(len(every), 0.5), boundary.end - boundary.start
    points, ahead = points_at(boundary, every, middle), tangents_at(boundary, every, middle)
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1) / np.hypot(*ahead.T)[:, None]
    beside = 1e-6 * np.hypot(*chord.T)[:, None] * left
    inside, outside = (
        ss.signed_distance(shape, points + sign * beside + boundary.origin) for sign in (1, -1)
    )
    return bool((inside < 0.0).all() and (outside > 0.0).all())


@given(
    st.lists(st.tuples(*[st.integers(-2, 10)] * 3), min_size=1, max_size=4),
    st.sampled_from(["evenodd", "nonzero"]),
    st.booleans(),
    st.booleans(),
)
def test_flat_loops_on_a_side_leave_one_side(
    places: list[tuple[int, int, int]], fill: str, turned: bool, backward: bool
) -> None:
    start, way = np.array([3.0, -1.0]), np.array([0.5, 1.25])
    triangle = np.stack([start, start + 8.0 * way, start + np.array([-7.0, 4.0])])
    assume(all(len(set(three)) == 3 for three in places))
    loops = [triangle[::-1] if backward else triangle]
    loops += [start + np.array(three)[:, None] * way for three in places]
    if turned:
        cos, sin = np.cos(0.7), np.sin(0.7)
        loops = [loop @ np.array([[cos, sin], [-sin, cos]]) for loop in loops]
    pieces = [[np.stack(p) for p in zip(c, np.roll(c, -1, axis=0), strict=True)] for c in loops]
    boundary = ss.Shape.from_pieces(pieces, fill=fill).boundary
    around = np.hypot(*np.diff(triangle[[0, 1, 2, 0]], axis=0).T).sum()
    assert np.hypot(*(boundary.end - boundary.start).T).sum() == pytest.approx(around, rel=1e-12)


def test_a_line_to_and_fro_across_a_curve_cuts_no_sliver_off_it() -> None:
    # It crosses at an angle of 4e-5, twice, and for rounding in two places 2e-11 apart.
    boundary = icons()["dribbble"].boundary
    length = np.hypot(*(boundary.end - boundary.start).T)
    assert length.min() > 1e-6


@pytest.mark.parametrize("first", range(5))
@pytest.mark.parametrize("chamfer", [1e-16, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13])
def test_a_side_next_to_nothing_costs_no_contour(chamfer: float, first: int) -> None:
    """It begins and ends where the rest of its contour does, which passed for its repetition."""
    cut = 1.0 - chamfer
    corners = [(-1.0, -1.0), (cut, -1.0), (1.0, -cut), (1.0, 1.0), (-1.0, 1.0)]
    shape = ss.Shape.from_points(np.roll(np.array(corners), first, axis=0))
    found = ss.signed_distance(shape, [(0.0, 0.0), (2.0, 0.0), (0.5, -0.75)])
    assert found == pytest.approx([-1.0, 1.0, -0.25], abs=1e-12)
    assert [len(c.arcs) > 3 for c in ss.offset(shape, 0.3)] == [True]


def opened(by: float) -> Arclets:
    """The sides of a square 100 long at (1000, 0), one cut short in the corner (1100, 100)."""
    corners = square(1000.0, 0.0, 100.0)
    boundary = polygons(corners).boundary
    (row,) = np.flatnonzero((boundary.end + boundary.origin == corners[2]).all(axis=1))
    following, end = boundary.following.copy(), boundary.end.copy()
    following[row] = -1
    end[row, 1] -= by
    return boundary._replace(following=following, end=end, arcs=boundary.arcs.copy())


def test_what_rounding_leaves_open_is_closed_to_the_bit() -> None:
    made = _closed(opened(0.9e-5))
    assert sorted(made.following) == [0, 1, 2, 3]
    assert np.array_equal(made.end, made.start[made.following])
    assert np.array_equal(made.arcs[:, 1:3], made.end)


def test_a_boundary_that_is_open_farther_is_refused_not_closed_by_a_step() -> None:
    with pytest.raises(ss.InputError, match=r"leaves open near \(1100, 99\.99\d+\): move them"):
        _closed(opened(1.1e-5))
