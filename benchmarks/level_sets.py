"""Level sets made distances again: ours, fast marching and a PDE on the same samples.

Run from the repository's root; scikit-fmm is named and left out if it is not installed:

    python -m pip install -e ".[bench]"
    python -m benchmarks.level_sets [--sizes 32 64 128] [--cases circle ellipse] [--tables AB]

A  errors of the distance, movement of the zero set, area and seconds of CPU, by halving the step
B  fits of our shapes: the movement of the zero set, and what the fit adds with its proved bound

All lengths are shares of half the domain's side. Truth is a formula of each case's own
(`level_set_cases`). Columns of A, all of them largest errors but the mean:

band      at nodes within three steps of the zero set
fixed     at nodes within a tenth of half the side, the order of the last halving, and the mean
whole     at all nodes
there     from points of the found zero set to the true one, of grids by lines across cells
back      from points of the true one to the found one, so that a missing part is seen; its order
smooth    the found distance at points of the true zero set, of grids by a bicubic spline: the
          method's own movement, without what lines add
area      of what is found, less the true one, as a share of it
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable, Container
from dataclasses import dataclass
from functools import partial
from typing import Any

import contourpy
import numpy as np
import shapely
from scipy.interpolate import RectBivariateSpline

import splinesdf as ss
from benchmarks.level_set_cases import Case, cases
from benchmarks.level_set_peers import PEERS, Reinitialize
from benchmarks.tables import Entry
from tests.oracles import polylines

Array = np.ndarray
ROUNDS = 3
SLOW = 1.0  # seconds; what takes longer is timed once
FIXED = 0.1  # the fixed band
NEAR = 3.0  # steps
SAMPLES = "samples"  # a method that changes nothing
DEVIATION = 1e-8  # of our curve's polyline, a share of half the side; its vertices lie on the curve
HEAD = (
    f"{'method':13} {'n':>4}  {'band':>8} {'fixed':>8} order {'mean':>8} {'whole':>8}  "
    f"{'there':>8} {'back':>8} order {'smooth':>8} {'area':>9} {'seconds':>8}"
)


@dataclass(frozen=True)
class Found:
    """What a method makes of samples, for the judge."""

    distance: Array  # at the nodes, rows along y
    lines: list[Array]  # its zero set, closed
    parts: int  # of each line, at whose ends it is measured
    at_curve: Array  # its distance at points of the true zero set


@dataclass(frozen=True)
class Row:
    """The columns of one line."""

    band: float
    fixed: float
    mean: float
    whole: float
    there: float
    back: float
    smooth: float
    area: float
    seconds: float


def ours(values: Array, case: Case, count: int) -> tuple[Found, float]:
    x = case.nodes(count)

    def run() -> tuple[ss.Shape, Array]:
        shape = ss.from_level_set(values, x, x)
        box = (x[0], x[0], x[-1], x[-1])
        return shape, ss.signed_distance_grid(shape, len(x), len(x), domain=box).distance

    (shape, distance), seconds = timed(run)
    lines = polylines(shape, DEVIATION * case.half)
    return Found(distance, lines, 1, ss.signed_distance(shape, case.curve)), seconds


def on_grid(method: Reinitialize, values: Array, case: Case, count: int) -> tuple[Found, float]:
    x = case.nodes(count)
    reach = float(np.abs(case.distance(*np.meshgrid(x, x))).max())
    distance, seconds = timed(lambda: method(values, x[1] - x[0], reach))
    lines = contourpy.contour_generator(x, x, distance).lines(0.0)
    smooth = RectBivariateSpline(x, x, distance.T)
    return Found(distance, [*map(np.asarray, lines)], 8, smooth.ev(*case.curve.T)), seconds


def unchanged(values: Array, step: float, reach: float) -> Array:
    """No distance: what lines make of the samples' zero set before anything moves it."""
    return values


METHODS: dict[str, Callable[[Array, Case, int], tuple[Found, float]]] = {
    "splinesdf": ours,
    **{name: partial(on_grid, method) for name, method in PEERS.items()},
    SAMPLES: partial(on_grid, unchanged),
}


def timed(run: Callable[[], Any]) -> tuple[Any, float]:
    """What a run gives, and its seconds of CPU: the median of a few, but for one that is slow."""
    times: list[float] = []
    while len(times) < ROUNDS and not (times and times[-1] > SLOW):
        began = time.process_time()
        result = run()
        times.append(time.process_time() - began)
    return result, statistics.median(times)


def judge(found: Found, seconds: float, case: Case, count: int) -> Row:
    x = case.nodes(count)
    true = case.distance(*np.meshgrid(x, x))
    miss, unit = np.abs(found.distance - true) / case.half, case.half
    band, fixed = np.abs(true) <= NEAR * (x[1] - x[0]), np.abs(true) <= FIXED * unit
    there = back = math.inf
    area = 0.0
    if found.lines:
        there = float(np.abs(case.distance(*dense(found.lines, found.parts).T)).max()) / unit
        curve = shapely.multilinestrings([shapely.linestrings(line) for line in found.lines])
        shapely.prepare(curve)
        back = float(shapely.distance(curve, shapely.points(case.curve)).max()) / unit
        area = abs(sum(map(enclosed, found.lines)))
    return Row(
        band=float(miss[band].max()),
        fixed=float(miss[fixed].max()),
        mean=float(miss[fixed].mean()),
        whole=float(miss.max()),
        there=there,
        back=back,
        smooth=float(np.abs(found.at_curve).max()) / unit,
        area=area / case.area - 1.0,
        seconds=seconds,
    )


def dense(lines: list[Array], parts: int) -> Array:
    share = (np.arange(parts) / parts)[:, None, None]
    return np.concatenate(
        [(line[:-1] + share * np.diff(line, axis=0)).reshape(-1, 2) for line in lines]
    )


def enclosed(line: Array) -> float:
    x, y = (line - line[0]).T
    return float(0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))


def order(before: float, now: float) -> str:
    return f"{math.log2(before / now):5.2f}" if math.isfinite(before) and now > 0.0 else "     "


def warm_up() -> dict[str, str]:
    """Compile and import what all need; give those that are not installed, and why."""
    first, missing = cases()[0], {}
    values = first.function(*np.meshgrid(*[first.nodes(32)] * 2))
    ours(values, first, 32)
    for name, method in PEERS.items():
        try:
            method(values, 1.0, 1.0)
        except ImportError as error:
            missing[name] = str(error)
    return missing


def judged(case: Case, name: str, count: int) -> Row:
    """One method at one size."""
    x = case.nodes(count)
    return judge(*METHODS[name](case.function(*np.meshgrid(x, x)), case, count), case, count)


def entries(case: Case, count: int, missing: Container[str]) -> list[Entry]:
    """Seconds a grid and largest errors in the fixed band, for the report; lines alone are none."""
    result = []
    for name in METHODS:
        if name not in missing and name != SAMPLES:
            row = judged(case, name, count)
            moved = f"{max(row.there, row.back):.1e}"
            result.append(Entry(f"{case.name}, {count} steps", name, row.seconds, row.fixed, moved))
    return result


def table_a(chosen: list[Case], sizes: list[int], missing: Container[str]) -> None:
    for case in chosen:
        print(f"\nA. {case.name}\n{HEAD}", flush=True)
        for name in METHODS:
            if name in missing:
                continue
            fixed = back = math.nan
            for count in sizes:
                row = judged(case, name, count)
                orders = order(fixed, row.fixed), order(back, row.back)
                errors = (
                    f"{row.band:8.1e} {row.fixed:8.1e} {orders[0]} {row.mean:8.1e} {row.whole:8.1e}"
                    f"  {row.there:8.1e} {row.back:8.1e} {orders[1]} {row.smooth:8.1e}"
                )
                if name == SAMPLES:  # no distances: lines alone
                    errors = f"{'':42} {row.there:8.1e} {row.back:8.1e} {orders[1]} {'':8}"
                print(
                    f"{name:13} {count:4}  {errors} {row.area:9.1e} {row.seconds:8.3f}", flush=True
                )
                fixed, back = row.fixed, row.back


def table_b(chosen: list[Case], sizes: list[int]) -> None:
    print(
        f"\nB. fits within {FIXED:g} of the zero set, tolerance as the movement or 1e-6\n"
        f"{'case':13} {'n':>4} {'moved':>9} {'tolerance':>9} {'bound':>9} {'moved + bound':>13} "
        f"{'found':>9} {'cells':>7} {'seconds':>8}",
        flush=True,
    )
    for case in chosen:
        for count in sizes:
            x, unit = case.nodes(count), case.half
            shape = ss.from_level_set(case.function(*np.meshgrid(x, x)), x, x)
            # How far the zero sets are apart, which is the most by which distances to them differ.
            lines = polylines(shape, DEVIATION * unit)
            curve = shapely.multilinestrings([shapely.linestrings(line) for line in lines])
            shapely.prepare(curve)
            back = float(shapely.distance(curve, shapely.points(case.curve)).max())
            moved = max(back, float(np.abs(case.distance(*dense(lines, 1).T)).max()))
            tolerance, band = max(moved, 1e-6 * unit), (-FIXED * unit, FIXED * unit)
            began = time.process_time()
            fit = ss.fit(shape, tolerance=tolerance, band=band)
            seconds = time.process_time() - began
            points = np.random.default_rng(count).uniform(-unit, unit, (200_000, 2))
            true = case.distance(*points.T)
            inside = np.abs(true) < FIXED * unit - moved  # there by either zero set
            found = float(np.abs(fit.spline(points[inside]) - true[inside]).max())
            bound = fit.bound or math.nan
            worse = "" if found <= moved + bound else "  BEYOND"
            print(
                f"{case.name:13} {count:4} {moved / unit:9.2e} {tolerance / unit:9.2e} "
                f"{bound / unit:9.2e} {(moved + bound) / unit:13.2e} {found / unit:9.2e} "
                f"{fit.cells:7} {seconds:8.3f}{worse}",
                flush=True,
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[32, 64, 128])
    parser.add_argument("--cases", nargs="+", default=[case.name for case in cases()])
    parser.add_argument("--tables", default="AB", help="which tables")
    options = parser.parse_args()
    missing = warm_up()
    for name, why in missing.items():
        print(f"{name}: left out, {why}")
    chosen = [case for case in cases() if case.name in options.cases]
    tables = {"A": partial(table_a, missing=missing), "B": table_b}
    for name in options.tables.upper():
        tables[name](chosen, options.sizes)


if __name__ == "__main__":
    main()
