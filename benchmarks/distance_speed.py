"""Speed of the exact signed distance beside that of other libraries, and how it grows.

Run from the repository's root; peers that are not installed are named and left out:

    python -m pip install -e ".[bench]"
    python -m benchmarks.distance_speed [--points 1000000] [--rounds 3] [--cores 1 2]

For each number of cores one process is bound to so many. In it every contestant answers once a
round, one after the other, and the median of its rounds is shown: what else the machine does hits
all alike. On one core seconds are those of the CPU, on more those of the clock. Making trees is
timed apart ("ready"). Slow peers are given fewer points.
Peers that know polylines only get one within 1e-6 of the shape's size; errors are shares of the
size, against ``ss.signed_distance``. Grids are those of the same domain and the same nodes.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from statistics import median

import numpy as np

import splinesdf as ss
from benchmarks.distance_peers import DEVIATION, PEERS, Answer, Question, limacon, rings
from benchmarks.tables import OURS, Entry, clock

MARGIN = 0.1


@dataclass
class Contestant:
    name: str
    answer: Answer
    step: int  # a slow peer is given points so many apart
    ready: float  # seconds to get ready
    seconds: list[float] = field(default_factory=list)
    miss: float = 0.0
    count: int = 0  # of the points that it was given


def limacon_cubics(count: int) -> ss.Shape:
    """The limaçon's cubic Hermite interpolant at equal parameters: tangents are continuous."""
    t = 2 * np.pi * np.arange(count + 1) / count
    points, slopes = limacon(t), limacon(t, derivative=True) * (2 * np.pi / count) / 3
    points[-1] = points[0]
    loop = [
        np.stack([points[i], points[i] + slopes[i], points[i + 1] - slopes[i + 1], points[i + 1]])
        for i in range(count)
    ]
    return ss.Shape.from_pieces([loop], name=f"limaçon, {count} cubics")


def limacon_polygon(sides: int) -> ss.Shape:
    t = 2 * np.pi * np.arange(sides) / sides
    return ss.Shape.from_points(limacon(t), name=f"limaçon, {sides} sides")


def glyph() -> ss.Shape | None:
    try:
        from tests.glyphs import glyphs
    except ImportError as missing:
        print(f"no glyph: {missing.name} is not installed")
        return None
    return glyphs()["DejaVuSans:&"]


def question(shape: ss.Shape, count: int, grid: bool) -> Question:
    """Random points, or the nodes of a square grid, over the shape's box grown a little."""
    xmin, ymin, xmax, ymax = shape.box
    grown = MARGIN * shape.size
    domain = (xmin - grown, ymin - grown, xmax + grown, ymax + grown)
    lines = rings(shape, DEVIATION * shape.size)
    if not grid:
        rng = np.random.default_rng(1)
        return Question(shape, rng.uniform(domain[:2], domain[2:], (count, 2)), None, domain, lines)
    side = round(count**0.5)
    x, y = np.linspace(*domain[::2], side), np.linspace(*domain[1::2], side)
    nodes = np.stack(np.meshgrid(x, y), -1).reshape(-1, 2)
    return Question(shape, nodes, (side, side), domain, lines)


def ours(asked: Question) -> Answer:
    shape, domain = replace(asked.shape), asked.domain  # a copy without its tree
    ss.signed_distance(shape, asked.points[:1])  # makes the tree
    if asked.grid is None or not hasattr(ss, "signed_distance_grid"):
        return lambda points: ss.signed_distance(shape, points)
    nx, ny = asked.grid
    return lambda _: ss.signed_distance_grid(shape, nx, ny, domain=domain).distance.ravel()


def contestants(asked: Question) -> tuple[list[Contestant], dict[str, str]]:
    """Ourselves first, then every peer that has an answer; and why others are not installed."""
    result, missing = [], {}
    everyone: dict[str, tuple[Callable[[Question], Answer | None], int]] = {
        OURS: (ours, 1),
        **PEERS,
    }
    for name, (prepare, step) in everyone.items():
        began = clock()
        try:
            answer = prepare(asked)
        except (ImportError, OSError) as error:
            missing[name] = str(error)
            continue
        if answer is not None:
            result.append(Contestant(name, answer, step, clock() - began))
    return result, missing


def answered(shape: ss.Shape, count: int, rounds: int, grid: bool) -> list[Contestant]:
    """Everyone before the same points, by turns."""
    asked = question(shape, count, grid)
    field_, _ = contestants(asked)
    expected = ss.signed_distance(shape, asked.points)
    for _ in range(rounds):
        for one in field_:
            points = np.ascontiguousarray(asked.points[:: one.step])
            began = clock()
            found = one.answer(points)
            one.seconds.append((clock() - began) / len(points))
            one.miss = float(np.max(np.abs(found - expected[:: one.step]))) / shape.size
            one.count = len(points)
    return field_


def entries(shape: ss.Shape, count: int, rounds: int, grid: bool) -> list[Entry]:
    """Seconds a point and largest errors, those of peers against ours, for the report."""
    title = f"{shape.name}: {'grid' if grid else 'random points'}"
    return [
        Entry(
            title,
            one.name,
            median(one.seconds),
            None if one.name == OURS else one.miss,
            f"{1e3 * one.ready:,.3g}" if one.ready < 1.0 else f"{1e3 * one.ready:,.0f}",
        )
        for one in answered(shape, count, rounds, grid)
    ]


def small_entries(rounds: int) -> list[Entry]:
    """One question of a tiny shape, and nothing to share the preparation with, for the report."""
    corners = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    point = np.array([[0.5, 0.4]])

    def by_shapely() -> object:
        import shapely

        return shapely.distance(shapely.Polygon(corners).exterior, shapely.points(point))

    def by_gpytoolbox() -> object:
        from gpytoolbox import squared_distance

        ends = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
        return squared_distance(point, corners, ends)

    everyone = {
        OURS: lambda: ss.signed_distance(ss.Shape.from_points(corners), point),
        "shapely ring": by_shapely,
        "gpytoolbox AABB": by_gpytoolbox,
    }
    seconds: dict[str, list[float]] = {}
    for _ in range(20 * rounds + 1):
        for name, run in everyone.items():
            began = clock()
            try:
                run()
            except ImportError:
                continue
            seconds.setdefault(name, []).append(clock() - began)
    title = "one point of a rectangle that was just made"
    return [Entry(title, name, median(times[1:])) for name, times in seconds.items()]


def compare(shape: ss.Shape, count: int, rounds: int, grid: bool) -> None:
    print(f"\n{shape.name}: {'grid' if grid else 'random points'}", flush=True)
    print("                       points   ready, s   M points/s  of ours  max error")
    field_ = answered(shape, count, rounds, grid)
    for one in field_:
        speed = 1e-6 / median(one.seconds)
        share = median(field_[0].seconds) / median(one.seconds)
        print(
            f"    {one.name:16} {one.count:8} {one.ready:10.3f} {speed:12.4f} "
            f"{share:8.4f} {one.miss:10.1e}",
            flush=True,
        )


def growth(count: int, largest: int) -> None:
    """Time a point over polygons of ever more sides: a tree's grows like their logarithm."""
    print("\nlimaçon polygons: random points")
    print("      sides   shape, s    tree, s   µs/point  µs/point / log2(sides)")
    sides = 100
    while sides <= largest:
        began = time.perf_counter()
        shape = limacon_polygon(sides)
        made = time.perf_counter()
        asked = question(shape, count, grid=False)
        ss.signed_distance(shape, asked.points[:1])
        ready = time.perf_counter()
        seconds = []
        for _ in range(3):
            start = time.perf_counter()
            ss.signed_distance(shape, asked.points)
            seconds.append(time.perf_counter() - start)
        each = 1e6 * median(seconds) / count
        print(
            f"    {sides:7} {made - began:10.3f} {ready - made:10.3f} {each:10.3f} "
            f"{each / np.log2(sides):10.4f}",
            flush=True,
        )
        sides *= 10


def bound(cores: int) -> bool:
    """Bind this process to so many cores; False where there are fewer or it cannot be done."""
    if not hasattr(os, "sched_setaffinity"):
        print("this system cannot bind a process to cores: all are used")
        return True
    allowed = sorted(os.sched_getaffinity(0))
    if len(allowed) < cores:
        print(f"only {len(allowed)} cores: {cores} left out")
        return False
    os.sched_setaffinity(0, allowed[:cores])
    return True


def warm_up() -> dict[str, str]:
    """Compile and import what everyone needs; give those that are not installed, and why."""
    missing: dict[str, str] = {}
    for grid in (False, True):
        asked = question(limacon_cubics(8), 10_000, grid)
        field_, absent = contestants(asked)
        missing |= absent
        for one in field_:
            one.answer(asked.points)
    return missing


def run(options: argparse.Namespace) -> None:
    """Everything, on the cores this process has."""
    for name, why in warm_up().items():
        print(f"    {name}: left out, {why}")
    shapes = [limacon_cubics(32), glyph(), limacon_polygon(1383), limacon_polygon(100_000)]
    for shape in shapes:
        if shape is not None:
            for grid in (False, True):
                compare(shape, options.points, options.rounds, grid)
    growth(min(options.points, 200_000), options.sides)


def main() -> None:
    parser = argparse.ArgumentParser(description="Speed of the exact distance, beside peers.")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--sides", type=int, default=1_000_000, help="of the largest polygon")
    parser.add_argument("--cores", type=int, nargs="+", default=[1, 2])
    options = parser.parse_args()
    if len(options.cores) == 1:
        if bound(options.cores[0]):
            print(f"== cores: {options.cores[0]}")
            run(options)
        return
    for cores in options.cores:
        command = [sys.executable, "-m", "benchmarks.distance_speed", "--cores", str(cores)]
        command += [f"--{name}={getattr(options, name)}" for name in ("points", "rounds", "sides")]
        subprocess.run(command, check=True)


if __name__ == "__main__":
    main()
