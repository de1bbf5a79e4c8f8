"""Where the time of an exact distance goes: nanoseconds a point of each step, on one thread.

    python -m benchmarks.distance_profile

One block of points, as a thread takes it, goes through the steps of `splinesdf.distance` one by
one; the least time of several rounds counts. "quick" is the share of points in cells whose
candidates are so few that no tree is walked. The last column is what a second thread leaves of
the time for a million points: half would be perfect. Last, ten million points at once: the memory
beyond the points themselves and the result.
"""

from __future__ import annotations

import time
import tracemalloc

import numpy as np

import splinesdf as ss
from benchmarks.distance_speed import limacon_cubics, limacon_polygon
from splinesdf.arclets.culling import candidates_of_cells
from splinesdf.arclets.kernels.nearest import nearest
from splinesdf.arclets.kernels.nearest_convex import nearest_of_few
from splinesdf.arclets.kernels.winding import fill_inside
from splinesdf.arclets.tables import NOTHING, Feet, Searched
from splinesdf.distance.exact import sorted_into_cells
from splinesdf.ground.blocks import processors
from tests.glyphs import glyphs

SIDE, ROUNDS = 362, 7


def steps(shape: ss.Shape, points: np.ndarray) -> tuple[dict[str, float], float]:
    """Seconds of each step, and the share of points that need no walk."""
    boundary, outline, count = shape.boundary, shape.arclets, len(points)
    largest = float(np.abs(boundary.boxes[0]).max())
    searched = Searched(boundary.tree, boundary.arcs, largest)
    ways = (outline.boxes, outline.range, outline.chain, outline.arcs)
    seconds: dict[str, float] = {}
    began = 0.0

    def lap(name: str) -> None:
        nonlocal began
        now = time.thread_time()
        seconds[name] = min(seconds.get(name, np.inf), now - began)
        began = now

    for _ in range(ROUNDS):
        began = time.thread_time()
        cells, order = sorted_into_cells(points - boundary.origin)
        lap("sort")
        candidates = candidates_of_cells(boundary, cells)
        lap("cull")
        feet = Feet(np.empty(count), np.empty(count, dtype=np.int64), np.empty(count), np.inf)
        done = np.zeros(len(cells.starts) - 1, dtype=np.bool_)
        lap("room")
        nearest_of_few(boundary.tree, boundary.arcs, cells, candidates, feet, done)
        lap("few")
        nearest(searched, cells, candidates, done, NOTHING, feet)
        lap("walk")
        inside = np.empty(count, dtype=np.bool_)
        fill_inside(*ways, cells.points, feet.distance, shape.fill == "evenodd", inside)
        lap("side")
        result = np.empty(count)
        result[order] = np.where(inside, -feet.distance, feet.distance)
        lap("out")
    return seconds, float(np.diff(cells.starts)[done].sum() / count)


def whole(shape: ss.Shape, points: np.ndarray) -> float:
    """Seconds of `signed_distance` on all threads."""
    times = []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        ss.signed_distance(shape, points)
        times.append(time.perf_counter() - began)
    return float(np.median(times))


def many(shape: ss.Shape, count: int) -> str:
    """Seconds and memory of many points at once."""
    xmin, ymin, xmax, ymax = shape.default_domain()
    points = np.random.default_rng(2).uniform((xmin, ymin), (xmax, ymax), (count, 2))
    began = time.perf_counter()
    ss.signed_distance(shape, points)
    seconds = time.perf_counter() - began
    tracemalloc.start()
    result = ss.signed_distance(shape, points)
    peak = tracemalloc.get_traced_memory()[1] - result.nbytes
    tracemalloc.stop()
    return f"{count:,} points: {seconds:.2f} s, {peak / 2**20:.0f} MiB beside the result"


def main() -> None:
    shapes = {
        "32 cubics": limacon_cubics(32),
        "glyph &": glyphs()["DejaVuSans:&"],
        "1,383-gon": limacon_polygon(1383),
        "100,000-gon": limacon_polygon(100_000),
    }
    names = ("sort", "cull", "room", "few", "walk", "side", "out")
    print(f"ns a point    {''.join(f'{name:>7}' for name in names)}  quick    all  threads")
    for title, shape in shapes.items():
        xmin, ymin, xmax, ymax = shape.default_domain()
        tile = (xmax - xmin) * SIDE / 1000
        line = np.linspace(0.0, tile, SIDE)
        middle = 0.5 * np.array([xmin + xmax - tile, ymin + ymax - tile])
        grid = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2) + middle
        points = np.random.default_rng(1).uniform((xmin, ymin), (xmax, ymax), (1_000_000, 2))
        for kind, some in (("grid", grid), ("random", points[: SIDE * SIDE])):
            seconds, quick = steps(shape, some)
            each = [seconds[name] / len(some) * 1e9 for name in names]
            shown = "".join(f"{value:7.1f}" for value in each)
            alone = sum(each) * 1e-9 * len(points)
            share = f"{whole(shape, points) / alone:8.2f}" if kind == "random" else ""
            print(f"{title:12} {kind:6}{shown}{quick:7.2f}{sum(each):7.0f} {share}")
    print(f"{processors()} processors; {many(shapes['32 cubics'], 10_000_000)}")


if __name__ == "__main__":
    main()
