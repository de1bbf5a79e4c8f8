"""What the trimming of parallels claims of distances to single arclets, against dense samples."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.kernels import arclet, nearest
from splinesdf.arclets.kernels.nearest import room_to_search
from splinesdf.offsets import trimmed as trimmed_module
from splinesdf.offsets.kernels import clearance, gather
from splinesdf.offsets.kernels import parallels as _parallels
from splinesdf.offsets.trimmed import parallels, parallels_at, trimmed, walls_at
from tests.compiled import from_python
from tests.glyphs import glyphs
from tests.mechanical import parts
from tests.named_shapes import gamma

SHAPES = {
    "gamma2": lambda: gamma("gamma2"),
    "gamma3": lambda: gamma("gamma3"),
    "glyph": lambda: glyphs()["DejaVuSans:g"],
    "gasket": lambda: parts()["gasket"],
    "involute": lambda: parts()["involute gear"],
}
TRIALS, WALLS = 250, 20
point_on = from_python(arclet.point_on)
closest_on = from_python(nearest.closest_on)
parallel_point = from_python(_parallels.parallel_point)
bend_range = from_python(clearance.bend_range)
stays_nearer = from_python(clearance._stays_nearer)
is_nearer_at_its_ends = from_python(clearance.is_nearer_at_its_ends)
second_range = from_python(clearance._second_range)
apart = from_python(gather._apart)
passes = from_python(clearance._passes)
clearance_at = from_python(clearance.clearance_at)


class Stretch(NamedTuple):
    """A part of a parallel, as it really is."""

    i: int  # the arclet
    m: float  # the parameter in its middle
    half: float  # how far it goes from there, in the parameter
    points: np.ndarray  # (65, 2)
    away: np.ndarray  # (65,) how far along from the middle
    middle: tuple[float, float, float, float]  # point and tangent
    bends: tuple[float, float]  # the range of its curvature, as far as is known

    @property
    def length(self) -> float:
        """Of a half, as long as it really is, so that claims are as bold as can be."""
        return 1.001 * float(self.away.max())


def some_stretch(
    shape: ss.Shape, distance: float, random: np.random.Generator, shares: tuple[float, float]
) -> Stretch:
    i = int(random.integers(len(shape.boundary.start)))
    half = 10.0 ** random.uniform(*shares)
    m = random.uniform(half, 1.0 - half)
    at = np.linspace(m - half, m + half, 65)
    points = parallels(shape, np.array([[i, 0]] * 65), at, distance)[:, :2]
    x, y, tx, ty, _, bend = parallel_point(parallels_at(shape, distance), (i, 0), m)
    steps = np.hypot(*np.diff(points, axis=0).T)
    away = np.abs(np.cumsum(np.append(0.0, steps)) - steps[:32].sum())
    bends = bend_range(shape.bends.rows, distance, (i, 0), bend, 2.0 * half)
    return Stretch(i, m, half, points, away, (x, y, tx, ty), bends)


def foot_on(shape: ss.Shape, wall: int, x: float, y: float) -> tuple | None:
    """Distance, direction and parameter of the nearest point of a wall, if it is elsewhere."""
    arcs = shape.boundary.arcs
    squared, t = closest_on(arcs, wall, x, y, np.inf, room_to_search(arcs))
    far, (px, py) = np.sqrt(squared), point_on(arcs, wall, t)
    return (far, (x - px) / far, (y - py) / far, t) if far > 0.0 else None


def distances(shape: ss.Shape, j: int, points: np.ndarray) -> np.ndarray:
    arcs = shape.boundary.arcs
    scratch = room_to_search(arcs)
    return np.sqrt([closest_on(arcs, j, x, y, np.inf, scratch)[0] for x, y in points])


def allowed(shape: ss.Shape, wall: int, foot: tuple, along: tuple, length: float) -> float:
    """How much the distance may grow at most, as far as is claimed: infinite if nothing is."""
    slope = foot[1] * along[0] + foot[2] * along[1]

    def sure(gap: float) -> bool:
        row = shape.bends.rows[wall]
        return stays_nearer(shape.boundary.arcs, row, wall, foot, along, (gap, slope), length)

    low, high = -10.0 * shape.size, 0.0
    if not sure(low):
        return np.inf
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if sure(middle) else (low, middle)
    return -low


@pytest.mark.parametrize("name", SHAPES)
def test_a_wall_is_nowhere_farther_than_its_curvature_allows(name: str) -> None:
    shape = SHAPES[name]()
    random = np.random.default_rng(5)
    growth = []
    for _ in range(TRIALS):
        distance = shape.size * random.choice([-1.0, 1.0]) * 10.0 ** random.uniform(-2.5, -0.5)
        one = some_stretch(shape, distance, random, (-3.0, -0.5))
        x, y, tx, ty = one.middle
        for wall in random.integers(len(shape.boundary.start), size=WALLS).tolist():
            if (foot := foot_on(shape, wall, x, y)) is None:
                continue
            most = allowed(shape, wall, foot, (tx, ty, *one.bends), one.length)
            if np.isfinite(most):
                growth.append((float((distances(shape, wall, one.points) - foot[0]).max()), most))
    grown, most = np.array(growth).T
    assert len(growth) > 20
    assert np.all(grown <= most * (1.0 + 1e-9) + 1e-14 * shape.size)
    # Nor is it far more than that, or it would be of no use.
    much = grown > 1e-6 * shape.size
    assert np.median(most[much] / grown[much]) < 1.5


@pytest.mark.parametrize("name", SHAPES)
def test_long_stretches_are_no_nearer_and_no_farther_than_is_said(name: str) -> None:
    shape = SHAPES[name]()
    boundary, count = shape.boundary, len(shape.boundary.start)
    scratch = room_to_search(boundary.arcs)
    random = np.random.default_rng(6)
    nearer, bounds, sizes = 0, [], []
    for _ in range(TRIALS):
        distance = shape.size * random.choice([-1.0, 1.0]) * 10.0 ** random.uniform(-4.0, -0.5)
        one = some_stretch(shape, distance, random, (-2.0, -0.31))
        if not np.isfinite(one.bends).all():
            continue
        x, y, tx, ty = one.middle
        levels, around = parallels_at(shape, distance), walls_at(shape, distance)
        rounding = 1e-13 * (shape.size + abs(distance))
        walls = np.append(random.integers(count, size=8), np.arange(one.i - 4, one.i + 5) % count)
        for wall in walls.tolist():
            if (foot := foot_on(shape, wall, x, y)) is None:
                continue
            found = distances(shape, wall, one.points)
            row, along = shape.bends.rows[wall], (tx, ty, *one.bends)
            under, _, slack = second_range(row, foot, along, one.length)
            slope = abs(foot[1] * tx + foot[2] * ty) + slack
            if np.isfinite(under):
                least = foot[0] - slope * one.away + 0.5 * under * one.away**2
                assert np.all(found >= least - rounding)
                bounds.append(foot[0] <= 2.0 * one.length)
                sizes.append(float((found - least).max()) / one.length)
            ends = ((one.i, 0), one.m - one.half, one.m + one.half)
            most = (max(map(abs, one.bends)), one.length)
            if is_nearer_at_its_ends(levels, around, ends, wall, most, scratch):
                nearer += 1
                assert found.max() <= abs(distance) + around.grain + rounding
    assert sum(bounds) > 20
    assert nearer > 20 or name == "gamma2"  # which bends too much for claims so long
    # Nor is what is said of no use.
    assert np.median(np.array(sizes)[bounds]) < 2.0


def test_nodes_of_the_tree_are_no_nearer_to_a_segment_than_is_said() -> None:
    boundary = glyphs()["DejaVuSans:g"].boundary
    random = np.random.default_rng(7)
    size = float(np.ptp(boundary.start, axis=0).max())
    said = []
    for _ in range(300):
        ends = random.uniform(-1.0, 1.0, (2, 2)) * size
        node = int(random.integers(len(boundary.tree)))
        low, high = boundary.tree[node, 6:8].astype(int)
        t = np.linspace(0.0, 1.0, 9)
        points = np.array([point_on(boundary.arcs, k, s) for k in range(low, high) for s in t])
        way = ends[1] - ends[0]
        share = np.clip((points - ends[0]) @ way / (way @ way), 0.0, 1.0)
        real = np.hypot(*(points - ends[0] - share[:, None] * way).T).min()
        bound = apart(boundary.tree, node, (*ends[0], *ends[1]))
        assert bound <= real * (1.0 + 1e-12)
        said.append(bound > 0.5 * real)
    assert np.mean(said) > 0.3


@pytest.mark.parametrize("name", SHAPES)
def test_where_the_gap_to_a_wall_is_zero_is_found(name: str) -> None:
    shape = SHAPES[name]()
    count, scratch = len(shape.boundary.start), room_to_search(shape.boundary.arcs)
    random = np.random.default_rng(8)
    found = 0
    for _ in range(200):
        element, wall = (int(random.integers(count)), 0), int(random.integers(count))
        side = float(random.choice([-1.0, 1.0]))

        def gap(t: float, d: float, element: tuple = element, wall: int = wall) -> float:
            levels, around = parallels_at(shape, d), walls_at(shape, d)
            return float(clearance_at(levels, around, element, wall, t, scratch))

        # A distance at which the gap is zero in the middle of the parallel, if there is one.
        near, far = 1e-3 * side * shape.size, 0.5 * side * shape.size
        if not gap(0.5, far) < 0.0 < gap(0.5, near):
            continue
        for _ in range(20):
            middle = 0.5 * (near + far)
            near, far = (middle, far) if gap(0.5, middle) > 0.0 else (near, middle)
        for ends in ((0.1, 0.97), (0.97, 0.1)):
            if not gap(ends[0], far) < 0.0 < gap(ends[1], far):
                continue
            found += 1
            levels, around = parallels_at(shape, far), walls_at(shape, far)
            t = passes(levels, around, element, wall, ends, scratch)
            assert min(ends) <= t <= max(ends)
            assert abs(gap(t, far)) <= 1e-13 * shape.size
    assert found > 10


@pytest.mark.parametrize("root", [0.02, 0.3, 0.71, 0.999])
@pytest.mark.parametrize("bend", [-0.9, 0.0, 3.0])
@pytest.mark.parametrize("ends", [(0.0, 1.0), (1.0, 0.0)])
def test_secants_find_where_a_gap_is_zero_with_few_looks(
    root: float, bend: float, ends: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    looked = []

    def gap(*arguments: float) -> float:
        looked.append(t := arguments[4])
        return (ends[1] - ends[0]) * (t - root) * (1.0 + bend * t)

    monkeypatch.setattr(clearance, "clearance_at", gap)
    t = clearance._passes.py_func(None, None, None, 0, ends, None)
    assert t == pytest.approx(root, abs=1e-15)
    # Halvings alone take about fifty.
    assert len(looked) < 30


@pytest.mark.parametrize("room", [0, 1, 7])
@pytest.mark.parametrize("distance", [-2.0, 2.0])
def test_segments_that_have_no_room_are_looked_for_again(
    room: int, distance: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And are those that are found at once where there is room."""
    part = ss.example("part")
    expected = trimmed(part, distance, 1e-3)
    monkeypatch.setattr(trimmed_module, "_ROOM", room - 2 * len(part.joints.order))
    for one, other in zip(trimmed(part, distance, 1e-3), expected, strict=True):
        assert np.array_equal(one, other)
