"""What offsets enclose, judged by GEOS near the origin: sides of points, area, loops.

A point at the right distance passes though the loop it is on is one of two, or one that should not
be. So the region is judged: the winding number of the contours is 1 where the distance is less
than asked and 0 where it is more. All is first moved to the origin, as GEOS rounds far from it.

    shape ─ home ─→ polylines of two finenesses ─┬─ distance ─────→ side of each test point
                                                 └─ buffered rings ─→ area, number of loops
    contours ─ moved alike, flattened ─→ winding numbers, area

GEOS's negative buffers are known to fail: regions are unions and differences of the filled region
and a buffer of its boundary, and where two finenesses disagree nothing is decided. They fail with
both alike, too: an area or a count that is wrong by them is asked for once more in another way.

Nothing here makes offsets. Of the package it uses a `Shape`'s control points and, where tolerances
are finer than polylines, the exact distance, which is itself compared with that to the polylines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import shapely

import splinesdf as ss
from splinesdf.contours.contour import Contour
from tests import oracles
from tests.flat_contours import Line, flattened, on_arcs, winding_number
from tests.offset_checks import Verdict, places_and_ways
from tests.offset_count import loop_counts as quadtree_counts

# Rounding of what is far from the origin: so many units in the last place of its coordinates.
ULPS = 64.0
EPS = float(np.finfo(np.float64).eps)
# Polylines stay within this share of the tolerance, but this share of the size at least: finer ones
# take GEOS seconds.
OF_TOLERANCE, OF_SIZE = 0.02, 1e-6
# For buffers: these shares of the size, and segments of a quarter circle.
FINENESS = ((1e-5, 64), (3e-6, 128))
# What GEOS's buffers are good to, a share of the distance. Before it buffers a line it leaves out
# vertices whose absence moves it by up to a hundredth; 1.3e-3 was seen in the result. Rectangles of
# all sides and sectors of all corners, united, are good to the polylines, and take a minute.
BUFFER = 3e-3
# For what is asked when buffers disagree: a share of the size, and segments a radian.
SWEPT, SEGMENTS = 3e-5, 40
# Boundary places whose parallels are looked at, points beside the contours, and a grid's side.
PLACES, BESIDE, GRID = 800, 400, 40
# How far from the level test points lie, in tolerances, and how near they may turn out to be.
OFF, NEAR = 2.0, 1.5
# A chord's part of the tolerance.
CHORD = 0.125


def slack(shape: ss.Shape, distance: float) -> float:
    """What rounding may add to a tolerance where the shape is drawn, and where it is offset to."""
    largest = float(np.abs(shape.control).max()) + abs(distance)
    return ULPS * float(np.spacing(largest))


@lru_cache(maxsize=8)
def home(shape: ss.Shape) -> tuple[ss.Shape, np.ndarray]:
    """The shape moved so that its smallest loop is at the origin, and by how much it was moved.

    One subtraction a coordinate: right to the last digit of the result, however far the shape.
    """
    extents = [float(np.ptp(loop, axis=0).max()) for loop in loops_of(shape)]
    origin = loops_of(shape)[int(np.argmin(extents))][0].copy()
    return replace(shape, control=shape.control - origin), origin


def loops_of(shape: ss.Shape) -> list[np.ndarray]:
    """The control points of each loop."""
    ends = shape.starts[shape.loops]
    return [shape.control[a:b] for a, b in pairwise(ends)]


def judge_region(
    shape: ss.Shape,
    contours: Sequence[Contour],
    distance: float,
    tolerance: float,
    *,
    seed: int = 0,
    verdict: Verdict | None = None,
) -> Verdict:
    """Deviation, sides, area and number of loops of the contours of one distance.

    Kinds of failure: "distance" (the exact one is not that to polylines), "deviation", "lost" and
    "spurious" (of the region nearer than asked), "winding" (neither 0 nor 1), "area", "loops".
    """
    verdict = Verdict() if verdict is None else verdict
    here, origin = home(shape)
    allowed = tolerance + slack(shape, distance)
    lines = [flattened(contour, origin, CHORD * allowed) for contour in contours]
    judge = Judge(here, distance, allowed)
    judge.deviation(verdict, contours, origin)
    judge.sides(verdict, lines, seed)
    try:
        judge.enclosed(verdict, [line.points for line in lines])
    except shapely.GEOSException as error:
        verdict.undecided.append(f"area and loops, as GEOS fails: {error}")
    return verdict


@dataclass(frozen=True)
class Judge:
    """A shape at home, the distance asked, and how far from it a point may be."""

    shape: ss.Shape
    distance: float
    allowed: float

    def exact(self, verdict: Verdict, points: np.ndarray) -> np.ndarray:
        """Exact distances, after a comparison with those to polylines."""
        answer: np.ndarray = ss.signed_distance(self.shape, points)
        fine = max(OF_TOLERANCE * self.allowed, OF_SIZE * self.shape.size)
        other = oracles.sure_polyline_distance(self.shape, points, fine)
        if other is not None and len(points):
            # Beyond that GEOS's own rounding counts: a few units of the points' coordinates.
            rounding = 1e-13 * float(np.abs(points).max())
            miss = np.abs(answer - other[0])
            wrong = other[1] & (miss > 2.0 * fine + rounding)
            if wrong.any():
                wrong[wrong] &= ~oracles.on_lines(self.shape, points[wrong], fine)
            if wrong.any():
                k = int(np.argmax(np.where(wrong, miss, 0.0)))
                text = f"{wrong.sum()} of {len(points)}: {answer[k]!r} instead of {other[0][k]!r}"
                verdict.fail("distance", f"{text} at {points[k].tolist()} from home")
        return answer

    def deviation(self, verdict: Verdict, contours: Sequence[Contour], origin: np.ndarray) -> None:
        """Points of the contours are at the distance, within what is allowed."""
        if not contours:
            return
        arcs = np.concatenate([contour.arcs for contour in contours]) - origin
        weights = np.concatenate([contour.weights for contour in contours])
        many = np.linspace(0.0, 1.0, 17 if len(arcs) < 5000 else 3)
        points = on_arcs(arcs, weights, many).reshape(-1, 2)
        off = np.abs(ss.signed_distance(self.shape, points) - self.distance)
        verdict.deviation = float(off.max())
        if verdict.deviation > self.allowed:
            at = points[int(off.argmax())].tolist()
            text = f"{verdict.deviation / self.allowed:.4g} times what is allowed"
            verdict.fail("deviation", f"{text}, at {at} from home")
        chosen = np.random.default_rng(1).integers(len(points), size=min(200, len(points)))
        self.exact(verdict, points[chosen])

    def sides(self, verdict: Verdict, contours: Sequence[Line], seed: int) -> None:
        """The winding number is 1 below the level and 0 above it."""
        lines = [contour.points for contour in contours]
        points = np.concatenate(
            [self.about_the_level(seed), self.about(lines, seed), self.everywhere(lines)]
        )
        above = self.exact(verdict, points) - self.distance
        clear = np.abs(above) > NEAR * self.allowed
        points, above = points[clear], above[clear]
        number = winding_number(contours, points, CHORD * self.allowed)
        for kind, wrong in (
            ("lost", (above < 0.0) & (number == 0)),
            ("spurious", (above > 0.0) & (number == 1)),
            ("winding", (number != 0) & (number != 1)),
        ):
            if wrong.any():
                worst = int(np.argmax(np.where(wrong, np.abs(above), 0.0)))
                text = f"{wrong.sum()} of {len(points)} points, the worst {above[worst]:.3g} off"
                text += f" (winding number {number[worst]}) at {points[worst].tolist()} from home"
                verdict.fail(kind, text)

    def about_the_level(self, seed: int) -> np.ndarray:
        """Points a little off the true level, found by marching from the boundary."""
        places, normals = places_and_normals(self.shape, PLACES, seed)
        march = places + abs(self.distance) * normals
        off = np.abs(ss.signed_distance(self.shape, march) - self.distance)
        march, normals = march[off < 0.5 * self.allowed], normals[off < 0.5 * self.allowed]
        step = OFF * self.allowed * normals
        return np.concatenate([march + step, march - step])

    def about(self, lines: Sequence[np.ndarray], seed: int) -> np.ndarray:
        """Points a little off the contours, of each contour some."""
        rng = np.random.default_rng(seed)
        result = [np.empty((0, 2))]
        for line in lines:
            ways = np.diff(line, axis=0)
            length = np.hypot(*ways.T)
            rows = rng.integers(len(ways), size=max(4, BESIDE // len(lines)))
            rows = rows[length[rows] > 0.0]
            middle = 0.5 * (line[rows] + line[rows + 1])
            step = np.stack([-ways[rows, 1], ways[rows, 0]], -1) / length[rows, None]
            step *= OFF * self.allowed
            result += [middle + step, middle - step]
        return np.concatenate(result)

    def everywhere(self, lines: Sequence[np.ndarray]) -> np.ndarray:
        """A grid over all, and one over each small loop."""
        reach = max(self.distance, 0.0)
        hulls = [self.shape.control, *loops_of(self.shape)[:30], *lines[:30]]
        grids = []
        for number, hull in enumerate(hulls):
            low, high = hull.min(axis=0) - 1.1 * reach, hull.max(axis=0) + 1.1 * reach
            margin = 0.0312 * float((high - low).max())
            axes = [
                np.linspace(a - margin, b + margin, 11 if number else GRID)
                for a, b in zip(low, high, strict=True)
            ]
            grids.append(np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2))
        return np.concatenate(grids)

    def enclosed(self, verdict: Verdict, lines: Sequence[np.ndarray]) -> None:
        """Area and number of loops are those of the region by GEOS."""
        regions = [region(self.shape, self.distance, *fineness) for fineness in FINENESS]
        areas = [r.area if r is not None else np.nan for r in regions]
        area = sum(signed_area(line) for line in lines)
        around = sum(float(np.hypot(*np.diff(line, axis=0).T).sum()) for line in lines)
        around = max(around, *(r.length if r is not None else 0.0 for r in regions))
        near = self.allowed + BUFFER * abs(self.distance) + FINENESS[0][0] * self.shape.size
        room = 2.0 * abs(areas[0] - areas[1]) + around * near
        if np.isnan(room):
            verdict.undecided.append("GEOS fills nothing")
            return
        if abs(area - areas[1]) > room and abs(area - swept_area(self.shape, self.distance)) > room:
            text = f"{area:.9g} instead of {areas[1]:.9g}, {abs(area - areas[1]) / room:.3g}"
            verdict.fail("area", f"{text} times what is allowed")
        counts = self.loop_counts()
        if not min(counts) <= len(lines) <= max(counts):
            counts = set(slow_counts(self.shape, self.distance))
        if not min(counts) <= len(lines) <= max(counts):
            verdict.fail("loops", f"{len(lines)} instead of {sorted(counts)}")
        elif len(counts) > 1:
            verdict.undecided.append(f"{len(lines)} loops, may be any of {sorted(counts)}")

    def loop_counts(self) -> set[int]:
        """The number of loops, at two finenesses and at distances a little off.

        Farther out than any point of the shape is from the middle of its box, all disks have that
        point in them: their union is a star about it, with one boundary.
        """
        if self.distance > self.shape.size:
            return {1}
        near = OFF * self.allowed + BUFFER * abs(self.distance)
        near += 2.0 * FINENESS[0][0] * self.shape.size
        counts = set()
        for fineness in FINENESS:
            for off in (-near, 0.0, near):
                found = region(self.shape, self.distance + off, *fineness)
                counts.add(-1 if found is None else rings_of(found))
        return counts


@lru_cache(maxsize=16)
def region(
    shape: ss.Shape, distance: float, deviation: float, segments: int
) -> shapely.Geometry | None:
    """What is nearer than the distance, as polygons; None if nothing is filled."""
    found = filled(shape, deviation)
    if found is None or distance == 0.0:
        return None if found is None else found[0]
    near = shapely.buffer(found[1], abs(distance), quad_segs=segments)
    return shapely.union(found[0], near) if distance > 0.0 else shapely.difference(found[0], near)


@lru_cache(maxsize=8)
def swept_area(shape: ss.Shape, distance: float) -> float:
    """The area once more, slowly, without GEOS's buffers: they fail with two finenesses alike.

    Of a union of rectangles along all sides and sectors at all corners.
    """
    found = filled(shape, SWEPT)
    assert found is not None
    if distance == 0.0:
        return float(found[0].area)
    near = shapely.union_all(swept(found[1], abs(distance)))
    join = shapely.union if distance > 0.0 else shapely.difference
    return float(join(found[0], near).area)


slow_counts = lru_cache(maxsize=8)(quadtree_counts)


@lru_cache(maxsize=8)
def filled(shape: ss.Shape, deviation: float) -> tuple[shapely.Geometry, shapely.Geometry] | None:
    """The filled region and its boundary, by polylines within a share of the size."""
    lines = oracles.polylines(shape, deviation * shape.size)
    snap = oracles.SNAP * float(np.abs(shape.control).max())
    boundary = oracles.filled_boundary(lines, shape.fill, snap=snap)
    if not boundary:
        return None
    drawn = shapely.multilinestrings([shapely.linestrings(line) for line in boundary])
    return shapely.build_area(drawn), drawn


def swept(boundary: shapely.Geometry, distance: float) -> np.ndarray:
    """All within a distance of closed lines: rectangles along sides, sectors where they turn."""
    result = []
    for line in shapely.get_parts(boundary):
        points = shapely.get_coordinates(line)[:-1]
        ends = np.roll(points, -1, axis=0)
        ways = (ends - points) / np.hypot(*(ends - points).T)[:, None]
        off = distance * np.stack([-ways[:, 1], ways[:, 0]], -1)
        sides = np.stack([points - off, ends - off, ends + off, points + off, points - off], 1)
        result.append(shapely.polygons(sides))
        angle = np.arctan2(ways[:, 1], ways[:, 0])
        turn = (angle - np.roll(angle, 1) + np.pi) % (2.0 * np.pi) - np.pi
        # On the side that the turn leaves open, and a hair more, to overlap its neighbors.
        start = angle - np.copysign(0.5 * np.pi, turn)
        for middle, first, way in zip(points, start, turn, strict=True):
            steps = 2 + int(SEGMENTS * abs(way))
            around = first - way * np.linspace(-1e-9, 1.0 + 1e-9, steps)
            arc = middle + distance * np.stack([np.cos(around), np.sin(around)], -1)
            result.append(shapely.polygons([np.concatenate([[middle], arc, [middle]])]))
    return np.concatenate(result)


def rings_of(polygons: shapely.Geometry) -> int:
    """How many loops bound a region."""
    parts = shapely.get_parts(polygons)
    parts = parts[(shapely.get_type_id(parts) == 3) & ~shapely.is_empty(parts)]
    return int(len(parts) + shapely.get_num_interior_rings(parts).sum())


def signed_area(line: np.ndarray) -> float:
    """By the shoelace formula about the line's first point."""
    x, y = (line - line[0]).T
    return float(0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))


def places_and_normals(shape: ss.Shape, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Places of what was drawn and unit normals there, to both sides; at joints all around.

    A third is spread by length, a third evenly over loops, a third over pieces, so that what is
    small beside something large has its share.
    """
    rng = np.random.default_rng(seed)
    controls = [oracles.piece(shape, i) for i in range(shape.piece_count)]
    length = np.array([np.linalg.norm(np.diff(c, axis=0), axis=1).sum() for c in controls])
    share = np.zeros(len(controls))
    share += length / length.sum() + 1.0 / len(controls)
    for first, last in zip(shape.loops[:-1], shape.loops[1:], strict=True):
        own = length[first:last] + 1e-3 * length[first:last].max()
        share[first:last] += own / own.sum() / shape.loop_count
    pieces = rng.choice(len(controls), size=count, p=share / share.sum())
    t = rng.random(count)
    joint = np.arange(count) % 4 == 3
    t[joint] = 0.0
    angle = rng.uniform(0.0, 2.0 * np.pi, int(np.sum(t == 0.0)))
    places, ways = places_and_ways(shape, pieces, t)
    ways[t == 0.0] = np.stack([np.sin(angle), -np.cos(angle)], axis=-1)  # all around
    some = ways.any(axis=1)
    places, ways = places[some], ways[some] / np.hypot(*ways[some].T)[:, None]
    normals = np.stack([-ways[:, 1], ways[:, 0]], axis=-1)
    return np.repeat(places, 2, axis=0), np.stack([normals, -normals], axis=1).reshape(-1, 2)
