"""The steps to an offset, each by itself: trimming, kinds of arcs, meeting arcs, nesting, cusps."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import splinesdf as ss
from splinesdf.arclets.tables import FREE, ROUND, STRAIGHT
from splinesdf.arclets.thresholds import SMOOTH
from splinesdf.contours.contour import Contour, evaluate
from splinesdf.contours.kernels.meetings import find_meetings
from splinesdf.contours.nesting import enclosed, nested
from splinesdf.offsets.loops import _run_on
from splinesdf.offsets.offset import deviation
from splinesdf.offsets.trimmed import parallels, trimmed
from tests.chains import circle
from tests.glyphs import glyphs
from tests.named_shapes import gamma
from tests.real_shapes import icons, outlines

SHARES = (0.003, -0.003, 0.03, -0.03, 0.2)
# Points this near to where something is nearer count to both sides: rounding, as a share of the
# size, and what the bias against walls twice the distance apart adds.
CLOSE = 1e-11


def trimmed_shape(name: str) -> ss.Shape:
    if name.startswith("gamma"):
        return gamma(name)
    return next(some for some in (icons(), glyphs(), outlines()) if name in some)[name]


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize(
    "name", ["gamma2", "gamma3", "gear-wide", "virus", "DejaVuSans:&", "greece"]
)
def test_trimming_keeps_what_the_exact_distance_keeps(name: str, share: float) -> None:
    shape = trimmed_shape(name)
    distance = share * shape.size
    kept = trimmed(shape, distance, 1e-6 * shape.size)
    count = len(shape.boundary.start)
    # The naive way: points of all parallels, asked for their exact distance.
    every = np.column_stack([np.repeat(np.arange(count), 9), np.zeros(9 * count, dtype=np.int64)])
    at = np.tile(np.linspace(0.03, 0.97, 9), count)
    rows = parallels(shape, every, at, distance)
    exact = ss.signed_distance(shape, rows[:, :2] + shape.boundary.origin)
    on = np.abs(exact - distance) <= CLOSE * shape.size
    found = np.zeros(len(at), dtype=bool)
    order = {}
    for element, span in zip(kept.elements.tolist(), kept.spans, strict=True):
        if element[1] == 0:
            order.setdefault(element[0], []).append(span)
    for k, (arclet, t) in enumerate(zip(every[:, 0].tolist(), at, strict=True)):
        found[k] = any(low <= t <= high for low, high in order.get(arclet, ()))
    # Where the parallel runs backward it may touch the offset, but is no part of it.
    forward = rows[:, 4] > 0.0
    assert not np.any(found & ~on)
    assert not np.any(on & forward & ~found)
    assert found.any() == (len(kept.spans) > 0)


def test_kinds_are_told_by_points() -> None:
    quarter = [[1, 0], [1, 1], [0, 1]]
    nurbs = ss.Shape.from_nurbs(
        [*quarter, [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]],
        degree=2,
        knots=[0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4],
        weights=np.tile([1.0, np.sqrt(0.5)], 5)[:9],
    )
    formula = ss.Shape.from_formula("5 - 3*sin(2*t)", "3*cos(2*t)", t=(0, "pi"))
    for shape, center in ((nurbs, (0, 0)), (formula, (5, 0))):
        assert (shape.kinds.kind == ROUND).all()
        # Pieces of 0.2 radians: rounding over the square of that.
        assert shape.kinds.center + shape.boundary.origin == pytest.approx(
            np.broadcast_to(np.array(center, float), shape.kinds.center.shape), abs=1e-11
        )
    ellipse = ss.Shape.from_formula("2*cos(t)", "sin(t)")
    assert (ellipse.kinds.kind == FREE).all()
    # Four cubics that look like a circle are none.
    k = 0.5522847498
    path = f"M1 0C1 {k} {k} 1 0 1S-1 {k} -1 0S-{k} -1 0 -1S1 -{k} 1 0Z"
    assert (ss.Shape.from_svg_path(path).kinds.kind == FREE).all()
    assert (ss.Shape.from_points([(0, 0), (1, 0), (0, 1)]).kinds.kind == STRAIGHT).all()


def meetings(arcs: np.ndarray, weights: np.ndarray, following: list[int]) -> list[tuple[int, int]]:
    order = np.argsort(arcs[:, :, 0].min(axis=1))
    pairs = np.empty((16, 2), dtype=np.int64)
    count = find_meetings(arcs, weights, np.array(following), order, (1e-12, 1e-7), pairs)
    return [(min(p), max(p)) for p in pairs[:count].tolist()]


def test_arcs_that_meet_are_found() -> None:
    one, two = circle(), circle(center=(1.5, 0.0))
    arcs = np.concatenate([one.arcs, two.arcs])
    weights = np.concatenate([one.weights, two.weights])
    following = [1, 2, 3, 0, 5, 6, 7, 4]
    # They cross at (0.75, ±0.66): the first and last quarter of one, the middle ones of the other.
    assert sorted(meetings(arcs, weights, following)) == [(0, 5), (3, 6)]
    for shift, expected in ((1e-9, 0), (-1e-9, 2)):
        far = circle(center=(2.0 + shift, 0.0))
        arcs = np.concatenate([one.arcs, far.arcs])
        assert len(meetings(arcs, weights, following)) >= expected
        assert bool(meetings(arcs, weights, following)) == bool(expected)


@pytest.mark.parametrize("seed", range(4))
def test_all_pairs_of_chords_that_meet_are_found(seed: int) -> None:
    # Of so many that boxes around boxes are looked at; in any order.
    random = np.random.default_rng(seed)
    start = random.uniform(-1.0, 1.0, (37, 2))
    end = start + random.normal(size=(37, 2)) * 10.0 ** random.uniform(-2.0, 0.0, (37, 1))
    arcs = np.stack([start, 0.5 * (start + end), end], axis=1)
    # No arc follows another.
    order = random.permutation(37)
    pairs = np.empty((1000, 2), dtype=np.int64)
    none = np.full(37, -1)
    count = find_meetings(arcs, np.ones(37), none, order, (1e-12, 1e-7), pairs)
    found = {(min(pair), max(pair)) for pair in pairs[:count].tolist()}
    lines = shapely.linestrings(np.stack([start, end], axis=1))
    expected = {
        (i, j) for i in range(37) for j in range(i + 1, 37) if lines[i].intersects(lines[j])
    }
    assert len(found) == count
    assert found == expected


def test_neighbors_meet_only_where_they_come_back() -> None:
    def parabola(*points: tuple[float, float]) -> np.ndarray:
        return np.array(points)

    there = parabola((0, 0), (1, 0), (2, 1))
    back = parabola((2, 1), (1, 1), (0, 2))
    crossing = parabola((2, 1), (1, -2), (0, 2))
    closing = [1, 5, 0]
    for second, expected in ((back, []), (crossing, [(0, 1)])):
        arcs = np.stack([there, second])
        assert meetings(arcs, np.ones(2), closing[:2]) == expected


def test_nesting_of_rings() -> None:
    radii = [1.0, 4.0, 2.0, 3.0]
    rings = [circle(radius) for radius in radii]
    other = circle(0.5, center=(10.0, 0.0))
    found = nested([*rings, other])
    parents = [None if c.parent is None else round(np.hypot(*c.parent.arcs[0, 0])) for c in found]
    assert parents == [2, None, 3, 4, None]
    assert all(any(c.parent is other for other in found) for c in found if c.parent is not None)


@pytest.mark.parametrize("turns", range(8))
def test_nesting_does_not_depend_on_where_a_contour_starts(turns: int) -> None:
    # Points level with joints of the outer contour, from which the ray starts.
    outer = circle(2.0)
    arcs, weights = np.roll(outer.arcs, turns, axis=0), np.roll(outer.weights, turns)
    inner = circle(0.5, center=(-1.0, 0.0))
    start = Contour(np.roll(inner.arcs, turns // 2, axis=0), inner.weights)
    first, second = nested([Contour(arcs, weights), start])
    assert second.parent is first
    assert first.parent is None


@pytest.mark.parametrize("turns", range(4))
def test_rays_cross_an_arc_that_dips_through_them(turns: int) -> None:
    """With both ends on one side of the ray, an arc crosses it twice, or with one end beyond."""
    bag = np.array([[[-1.0, 1.0], [0.0, -7.0], [1.0, 1.0]], [[1.0, 1.0], [0.0, 1.5], [-1.0, 1.0]]])
    c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][turns]
    turn = np.array([[c, s], [-s, c]], dtype=float)
    points = np.random.default_rng(6).uniform(-1.5, 1.5, (400, 2)) * [1.0, 2.0] @ turn
    for weight in (0.3, 1.0, 5.0):
        outer = Contour(bag @ turn, np.array([weight, 1.0]))
        line = outer.points(1e-7)
        clear = shapely.distance(shapely.LineString(line), shapely.points(points)) > 1e-6
        inside = shapely.contains(shapely.Polygon(line), shapely.points(points))
        assert 50 < np.count_nonzero(inside) < 350
        assert np.array_equal(enclosed(outer, points)[clear], inside[clear])
    inner = circle(0.1, center=(0.0, 0.0))
    assert nested([outer, inner])[1].parent is outer


def test_fields_of_level_sets_are_nested_too() -> None:
    shape = icons()["bullseye"]
    spline = ss.fit(shape, tolerance=0.05).spline
    contours = spline.contours(0.0)
    points = [evaluate(c.arcs, c.weights, np.array([0.5]))[0, 0] for c in contours]
    assert sum(c.parent is None for c in contours) == 1
    assert all(np.sign(c.area) == -np.sign(c.parent.area) for c in contours if c.parent)
    assert len(points) == 7


def test_the_boundary_itself_is_on_no_side() -> None:
    # It has cusps, next to which offsets are asked for their side.
    for shape in (icons()["bing"], ss.Shape.from_formula("cos(t)^3", "sin(t)^3")):
        contours = ss.offset(shape, 0.0, tolerance=1e-6)
        assert len(contours) == len(shape.joints.loops) - 1
        assert deviation(shape, contours) <= 1e-6


@pytest.mark.parametrize("angle", [2.0545443260420138, 0.8268676483632236, 1.0434802622597035])
def test_a_rose_turned_so_that_rounding_leaves_an_end_open(angle: float) -> None:
    # Six branches meet in its triple point; it once took a kernel out of its arrays.
    c, s = np.cos(angle), np.sin(angle)
    rose = gamma("gamma3")
    pieces = [rose.piece(i) @ np.array([[c, s], [-s, c]]) for i in range(rose.piece_count)]
    shape = ss.Shape.from_pieces([pieces])
    assert sorted(shape.joints.order) == list(range(len(shape.boundary.start)))
    assert sorted(shape.joints.following) == list(range(len(shape.boundary.start)))
    for distance, count in ((0.02, 1), (-0.02, 3)):
        contours = ss.offset(shape, distance, tolerance=1e-5)
        assert len(contours) == count
        assert deviation(shape, contours) <= 1e-5


@pytest.mark.parametrize("hole", [False, True])
def test_the_side_of_a_cusp_is_that_of_its_branches(hole: bool) -> None:
    # An astroid has four cusps that point outward; as a hole in a square they point inward.
    astroid = ss.Shape.from_formula("cos(t)^3", "sin(t)^3")
    if hole:
        pieces = [astroid.piece(i) for i in range(astroid.piece_count)]
        square = np.array([(-3, -3), (3, -3), (3, 3), (-3, 3)], dtype=float)
        sides = [np.stack([a, b]) for a, b in zip(square, np.roll(square, -1, 0), strict=True)]
        astroid = ss.Shape.from_pieces([pieces, sides], fill="evenodd")
    turn = astroid.joints.turn
    cusps = np.abs(np.abs(turn) - np.pi) < 1e-3
    assert np.count_nonzero(cusps) == 4
    assert (np.sign(turn[cusps]) == (-1.0 if hole else 1.0)).all()


def egg(turn: float) -> ss.Shape:
    """Two cubics that meet in (-1, 0), smoothly, and in (1, 0), where they turn by an angle."""
    up = [[1, 0], [1 - 1.1 * np.sin(turn), 1.1 * np.cos(turn)], [-1, 1.3], [-1, 0]]
    low = [[-1, 0], [-1, -0.6], [1, -0.9], [1, 0]]
    return ss.Shape.from_pieces([[np.array(up, dtype=float), np.array(low, dtype=float)]])


@pytest.mark.parametrize("distance", [0.2, -0.2])
@pytest.mark.parametrize("turn", [0.4 * SMOOTH, -0.4 * SMOOTH])
def test_a_turn_too_small_to_see_leaves_the_arcs_as_they_are(turn: float, distance: float) -> None:
    (smooth,) = ss.offset(egg(0.0), distance, tolerance=1e-3)
    (bent,) = ss.offset(egg(turn), distance, tolerance=1e-3)
    # Where a tangent may jump an arc ends: one more at each joint of arclets.
    assert len(bent.arcs) == len(smooth.arcs) == 6
    assert bent.length == pytest.approx(smooth.length, abs=1e-3)
    # Each parallel runs on into the next, and none has to look for another's start.
    stretches = trimmed(egg(turn), distance, 1e-3, SMOOTH)
    assert (_run_on(egg(turn), stretches, distance, SMOOTH) >= 0).all()
    # A turn that is none too small is a corner: an arc around it, or two ends that are to meet.
    seen = egg(np.copysign(1e-3, turn))
    loose = _run_on(seen, trimmed(seen, distance, 1e-3, SMOOTH), distance, SMOOTH) < 0
    assert np.count_nonzero(loose) == (turn * distance < 0.0)
