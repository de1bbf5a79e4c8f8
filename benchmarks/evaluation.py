"""Value and gradient of a spline on a 128 x 128 grid, beside SciPy's bicubic one, in one run.

    python benchmarks/evaluation.py

Both are asked for value, d/dx and d/dy at the same million points in row order, by turns, the
median of seven rounds. SciPy works on one thread; ours is timed on one and on all of them.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable

import numpy as np
from scipy.interpolate import RectBivariateSpline

import splinesdf as ss
from splinesdf import paper
from splinesdf.kernels.ordinates import evaluate
from splinesdf.meshes import Grid
from splinesdf.quasi import quasi_interpolate
from splinesdf.spaces.cells import frames, power_form

CELLS, SIDE, ROUNDS = 128, 1000, 7


def main() -> None:
    shape = paper.shape("gamma2")
    grid = Grid.uniform(paper.DOMAIN, CELLS, CELLS)
    spline = quasi_interpolate(lambda p: ss.signed_distance(shape, p), grid, "W")
    line = np.linspace(0.0, 1.0, CELLS + 1)
    knots = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1)
    bicubic = RectBivariateSpline(line, line, ss.signed_distance(shape, knots))
    axis = (np.arange(SIDE) + 0.5) / SIDE
    points = np.stack(np.meshgrid(axis, axis, indexing="xy"), axis=-1).reshape(-1, 2)
    x, y = points.T.copy()

    cell_frames, powers = frames(grid.boxes), power_form(spline.ordinates)

    def one_thread() -> None:
        count = len(points)
        value, gradient, none = np.empty(count), np.empty((count, 2)), np.empty((0, 3))
        evaluate(cell_frames, powers, grid.locate(points), points, value, gradient, none)

    runs: dict[str, Callable[[], object]] = {
        "splinesdf, all threads": lambda: spline.value_and_gradient(points),
        "splinesdf, one thread": one_thread,
        "RectBivariateSpline.ev x 3": lambda: [
            bicubic.ev(x, y, dx=dx, dy=dy) for dx, dy in ((0, 0), (1, 0), (0, 1))
        ],
    }
    exact = ss.signed_distance(shape, points)
    print(f"{os.cpu_count()} processors, {len(points):,} points in row order, {CELLS}² cells")
    print(f"error of splinesdf {np.abs(spline(points) - exact).max():.2e}", end=", ")
    print(f"of the bicubic {np.abs(bicubic.ev(x, y) - exact).max():.2e}")
    seconds: dict[str, list[float]] = {name: [] for name in runs}
    for run in runs.values():
        run()  # compiles, warms up
    for _ in range(ROUNDS):
        for name, run in runs.items():
            began = time.perf_counter()
            run()
            seconds[name].append(time.perf_counter() - began)
    slowest = statistics.median(seconds["RectBivariateSpline.ev x 3"])
    for name, times in seconds.items():
        median = statistics.median(times)
        rate = len(points) / median / 1e6
        print(f"{name:28} {rate:7.1f} M points/s   {slowest / median:5.1f} x SciPy")


if __name__ == "__main__":
    main()
