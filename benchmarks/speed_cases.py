"""What `speed` measures: shapes that grow, and the work that is timed on them.

Each case is a function without arguments that does its own getting ready and returns what it
measured, in the unit of its row. Only public names are used, but for the tables that make a shape
ready, so that the same cases run on other commits.
"""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import splinesdf as ss

Points = np.ndarray
DATA = Path(__file__).parents[1] / "tests" / "data"
READY = ("boundary", "bends", "_vertices", "kinds")  # what a fresh shape makes first
ROUNDS = 9


@dataclass(frozen=True)
class Case:
    """One row of the table."""

    name: str
    unit: str
    goal: str
    measure: Callable[[], float]


def limacon(count: int = 0) -> ss.Shape:
    """The limaçon as a formula, or as a polygon of so many sides."""
    if not count:
        return ss.Shape.from_formula("(3 + 2*cos(t))*cos(t)/10", "(3 + 2*cos(t))*sin(t)/10")
    t = 2.0 * np.pi * np.arange(count) / count
    r = (3.0 + 2.0 * np.cos(t)) / 10.0
    return ss.Shape.from_points(np.stack([r * np.cos(t), r * np.sin(t)], axis=1))


def square() -> ss.Shape:
    return ss.Shape.rectangle(0.0, 0.0, 1.0, 1.0)


def glyph() -> ss.Shape:
    from tests.glyphs import glyphs

    return glyphs()["DejaVuSans:&"]


def part() -> ss.Shape:
    return ss.example("part")


def cubics(count: int) -> ss.Shape:
    """The limaçon's cubic Hermite interpolant at equal parameters."""
    from benchmarks.distance_speed import limacon_cubics

    return limacon_cubics(count)


def plate(holes: int) -> ss.Shape:
    """A square plate with round holes on a grid."""
    across = int(np.ceil(holes**0.5))
    around = ss.Shape.circle((0.0, 0.0), 0.3)
    hole = [around.piece(k)[::-1] for k in range(around.piece_count)][::-1]
    sides = np.array([[0.0, 0.0], [across, 0.0], [across, across], [0.0, across], [0.0, 0.0]])
    loops = [[np.array(pair) for pair in pairwise(sides)]]
    for k in range(holes):
        middle = np.array([k % across, k // across]) + 0.5
        loops.append([piece + middle for piece in hole])
    return ss.Shape.from_pieces(loops, fill="nonzero")


def coast(sides: int) -> Points:
    """A square roughened by moving the middles of its sides, again and again, by the same rule."""
    random = np.random.default_rng(3)
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    while len(points) < sides:
        chord = np.roll(points, -1, axis=0) - points
        moved = 0.15 * random.uniform(-1.0, 1.0, (len(points), 1))
        middle = points + 0.5 * chord + moved * np.stack([-chord[:, 1], chord[:, 0]], axis=1)
        points = np.stack([points, middle], axis=1).reshape(-1, 2)
    # As many as asked, evenly.
    return points[np.linspace(0, len(points), sides, endpoint=False).astype(np.int64)]


def comb(slots: int, width: float = 1e-6) -> ss.Shape:
    """A comb of deep slots side by side, as wide as the teeth between them."""
    points = [(0.0, 0.0), (2.0 * slots * width, 0.0), (2.0 * slots * width, 2.0)]
    for k in reversed(range(slots)):
        left, right = (2.0 * k + 0.5) * width, (2.0 * k + 1.5) * width
        points += [(right, 2.0), (right, 1.0), (left, 1.0), (left, 2.0)]
    return ss.Shape.from_points(np.array([*points, (0.0, 2.0)]))


def spiral(turns: int, sides: int = 40) -> ss.Shape:
    """A band wound up, half as wide as its turns are apart: 2 pi."""
    angle = 2.0 * np.pi * np.arange(turns * sides + 1) / sides
    one = np.stack([np.cos(angle), np.sin(angle)], axis=1) * (angle + 2.0 * np.pi)[:, None]
    other = np.stack([np.cos(angle), np.sin(angle)], axis=1) * (angle + 3.0 * np.pi)[:, None]
    return ss.Shape.from_points(np.concatenate([one, other[::-1]]))


def seconds(call: Callable[[], Any]) -> float:
    """CPU seconds of one call."""
    began = time.process_time()
    call()
    return time.process_time() - began


def middle(call: Callable[[], Any], rounds: int = ROUNDS) -> float:
    """The median of CPU seconds of some calls."""
    return median(seconds(call) for _ in range(rounds))


def prepare(shape: ss.Shape) -> None:
    """Make what the first distance, fit or offset of a fresh shape makes first."""
    for name in READY:
        getattr(shape, name)


def preparing(make: Callable[[], ss.Shape]) -> float:
    shape = make()
    prepare(replace(shape))
    return 1e3 * middle(lambda: prepare(replace(shape)))


def first_offset(make: Callable[[], ss.Shape]) -> float:
    shape = make()
    return 1e3 * middle(lambda: offset(replace(shape), -0.03, 1e-4))


def further_offset(make: Callable[[], ss.Shape]) -> float:
    shape = make()
    offset(shape, 0.02, 1e-4)
    return 1e3 * middle(lambda: offset(shape, -0.03, 1e-4))


def nested_offsets(make: Callable[[], ss.Shape], count: int = 50) -> float:
    shape = make()
    distances = -0.002 * shape.size * np.arange(1, count + 1)
    prepare(shape)
    return 1e3 * middle(lambda: offsets(shape, distances, 1e-6), 3) / count


def offset(shape: ss.Shape, share: float, tolerance: float) -> list[ss.Contour]:
    return ss.offset(shape, share * shape.size, tolerance=tolerance * shape.size)


def offsets(shape: ss.Shape, distances: Points, tolerance: float) -> list[ss.Contour]:
    return ss.offset(shape, distances, tolerance=tolerance * shape.size)


def icons(times: int = 20) -> float:
    paths = sorted((DATA / "icons").glob("*.svg")) * times

    def read(path: Path) -> None:
        ss.signed_distance_grid(ss.read(path), 64, 64)

    read(paths[0])
    return seconds(lambda: [read(path) for path in paths])


def fitting(make: Callable[[], ss.Shape], tolerance: float, rounds: int = 3) -> float:
    shape = make()

    def fit() -> None:
        ss.fit(shape, tolerance=tolerance * shape.size)

    fit()
    return middle(fit, rounds)


def of_plate(name: str, holes: int) -> float:
    """Seconds until a plate has one of its tables, those before it made already."""
    shape = plate(holes)
    for before in READY[: READY.index(name)] if name in READY else READY:
        getattr(shape, before)
    if name in READY:
        return seconds(lambda: getattr(shape, name))
    return seconds(lambda: ss.offset(shape, -0.05, tolerance=1e-3))


def memory_of_plate(holes: int) -> float:
    """Megabytes at most, of a process that made a plate ready."""
    prepare(plate(holes))
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def plate_ready(holes: int) -> float:
    shape = plate(holes)
    return seconds(lambda: prepare(shape))


def of_coast(sides: int) -> float:
    shape = ss.Shape.from_points(coast(sides))
    prepare(shape)
    return seconds(lambda: ss.offset(shape, 1e-3))


def shapely_of_coast(sides: int) -> float:
    import shapely

    polygon = shapely.Polygon(coast(sides))
    return seconds(lambda: polygon.buffer(1e-3))


def of_polygon(arcs: bool) -> float:
    shape = limacon(10_000)
    prepare(shape)
    found = offset(shape, -0.03, 1e-4)
    if arcs:
        return float(sum(len(contour.arcs) for contour in found))
    return 1e3 * middle(lambda: offset(shape, -0.03, 1e-4), 3)


def of_comb(slots: int) -> float:
    shape = comb(slots)
    return seconds(lambda: ss.offset(shape, 1e-4, tolerance=1e-5))


def of_spiral(turns: int) -> float:
    shape = spiral(turns)
    return seconds(lambda: ss.offset(shape, -0.25 * np.pi, tolerance=1e-3))


def distances(count: int = 200_000) -> float:
    shape = cubics(32)
    box = np.array(shape.default_domain())
    points = np.random.default_rng(1).uniform(box[:2], box[2:], (count, 2))
    ss.signed_distance(shape, points[:10])
    return count * 1e-6 / middle(lambda: ss.signed_distance(shape, points), 5)


def _of_four(
    what: str, measure: Callable[[Callable[[], ss.Shape]], float], goals: str
) -> list[Case]:
    shapes = {"square": square, "limaçon": limacon, "glyph": glyph, "part": part}
    some = list(shapes.items())[-len(goals.split()) :]
    return [
        Case(f"{what}: {name}", "ms", goal, lambda make=make: measure(make))  # type: ignore[misc]
        for (name, make), goal in zip(some, goals.split(), strict=True)
    ]


def _of_plates(*names: str) -> list[Case]:
    return [
        Case(
            f"plate of {holes:,} holes: {name}", "s", goal,
            lambda name=name, holes=holes: of_plate(name, holes),  # type: ignore[misc]
        )
        for name in names
        for holes, goal in ((1000, ""), (10_000, "11 x"))
    ]  # fmt: skip


CASES = [
    *_of_four("prepare", preparing, "0.1 0.8 0.8 2"),
    *_of_four("first offset at 1e-4", first_offset, "0.3 2 2 4"),
    *_of_four("a further one", further_offset, "0.6 0.8 1.2"),
    Case("50 nested at 1e-6, each: limaçon", "ms", "0.5", lambda: nested_offsets(limacon)),
    Case("50 nested at 1e-6, each: part", "ms", "1", lambda: nested_offsets(part)),
    Case("1,000 icons, read and a grid of 64²", "s", "1.2", icons),
    Case("fit at 1e-3: limaçon", "ms", "35", lambda: 1e3 * fitting(limacon, 1e-3)),
    Case("fit at 1e-3: part", "ms", "200", lambda: 1e3 * fitting(part, 1e-3)),
    Case("fit at 1e-2: limaçon, 1,000 sides", "s", "0.12", lambda: fitting(
        lambda: limacon(1000), 1e-2
    )),
    *_of_plates("boundary", "bends", "offset"),
    Case("plate of 10,000 holes: ready", "s", "2", lambda: plate_ready(10_000)),
    Case("plate of 10,000 holes: memory", "MB", "600", lambda: memory_of_plate(10_000)),
    Case("coast of 10,000 sides: offset", "s", "", lambda: of_coast(10_000)),
    Case("coast of 100,000 sides: offset", "s", "12 x", lambda: of_coast(100_000)),
    Case("the same by shapely", "s", "", lambda: shapely_of_coast(100_000)),
    Case("10,000-gon of a limaçon, 1e-4: arcs", "", "30", lambda: of_polygon(True)),
    Case("10,000-gon of a limaçon, 1e-4: time", "ms", "30", lambda: of_polygon(False)),
    Case("comb of 500 slots, 1e-6 wide, at 1e-4", "s", "0.3", lambda: of_comb(500)),
    Case("spiral of 1,000 turns, at half its gap", "s", "10", lambda: of_spiral(1000)),
    Case("distance to 32 cubics, random points", "M/s", "8", distances),
]  # fmt: skip
