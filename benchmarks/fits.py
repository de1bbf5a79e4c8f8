"""Fits: leaves, errors, proofs, times; beside the paper's method, other operators, random points.

Run from the repository's root, with the ``test`` or the ``bench`` extra installed:

    python -m benchmarks.fits [--tables ABCDE] [--points 1000000] [--shapes 12] [--element quartic]

The paper's curves are fitted on its unit square with absolute tolerances; for other shapes all
lengths are shares of the shape's size, and the domain is the default one.

A  leaves, error, proved bound, evaluations and seconds, with and without the proof
B  the paper's grids at the same true error: tensor grids and uniform ones, operator W
C  how leaves grow with the tolerance: exponents by least squares
D  random points against error and bound, of any element (the cubic on uniform grids)
E  operators, and grids to start from
"""

from __future__ import annotations

import argparse
import math
import os
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

import numpy as np

import splinesdf as ss
from benchmarks.fit_cases import Case, curve, drawn, glyph, icon, part, seconds
from benchmarks.fit_methods import METHODS, MOST
from benchmarks.tables import clock
from splinesdf.errors import ToleranceNotReached
from splinesdf.fits.fit import FitResult
from splinesdf.paper import tables as paper
from splinesdf.spaces.elements import ELEMENTS
from tests.glyphs import glyphs
from tests.real_shapes import SMOOTH, formula_shape, icons, outlines

BLOCK = 1_000_000  # random points at a time
OPERATORS = "SWPV"


def head(title: str, columns: str) -> None:
    print(f"\n{title}\n{columns}", flush=True)


@dataclass(frozen=True)
class Leaves:
    """A fit with its proof, and seconds with and without it; lengths are shares of the unit."""

    result: FitResult
    error: float
    bound: float
    proved: float
    believed: float
    runs: int
    unproved: int  # leaves of the fit without a proof

    @property
    def per_leaf(self) -> float:
        return self.result.evaluations / self.result.cells


def leaves(case: Case, share: float) -> Leaves:
    """One line of table A."""
    result = case.fit(share)  # also warms up
    unproved = case.fit(share, certify=False)
    runs = [partial(case.fit, share), partial(case.fit, share, certify=False)]
    (proved, believed), count = seconds(runs)
    error, bound = result.error / case.unit, (result.bound or math.nan) / case.unit
    return Leaves(result, error, bound, proved, believed, count, unproved.cells)


def table_a() -> None:
    head(
        "A. leaves, errors, times (medians of warm runs)",
        f"{'shape':12} tolerance     error     bound   ratio   leaves  evaluations  per leaf"
        "  seconds  unproved  ratio  runs  leaves unproved",
    )
    cases: list[tuple[Case, tuple[float, ...]]]
    cases = [(curve(name), (1e-2, 2e-3, 1e-3, 3e-4, 1e-4)) for name in paper.CURVES]
    others = [
        *map(glyph, "gS&"),
        *map(icon, ("airplane", "github", "fingerprint")),
        drawn(outlines()["iceland"], "iceland"),
        part(),
    ]
    cases += [(case, (1e-2, 1e-3)) for case in others]
    for case, shares in cases:
        for share in shares:
            row = leaves(case, share)
            print(
                f"{case.name:12} {share:9.0e} {row.error:9.3e} {row.bound:9.3e} "
                f"{row.bound / row.error:7.4f} {row.result.cells:8} {row.result.evaluations:12} "
                f"{row.per_leaf:9.2f} {row.proved:8.3f} {row.believed:9.3f} "
                f"{row.proved / row.believed:6.2f} {row.runs:5} {row.unproved:8}",
                flush=True,
            )


def table_b() -> None:
    head(
        f"B. the paper's grids at the same true error (given up beyond {MOST:,} cells)",
        "curve    tolerance  method            cells     error    ratio  seconds",
    )
    for name in ("gamma1", "gamma2"):
        case = curve(name)
        for share in (1e-2, 5e-3, 2e-3, 1e-3, 3e-4, 1e-4):
            least = case.fit(share).cells
            for method, run in METHODS.items():
                began = clock()
                result = run(case, share)
                took = clock() - began
                missed = "" if result.stopped == "reached" else "  gave up"
                print(
                    f"{name:8} {share:9.0e}  {method:14} {result.cells:8} {result.error:9.2e} "
                    f"{result.cells / least:8.2f} {took:8.2f}{missed}",
                    flush=True,
                )


def table_c() -> None:
    head(
        "C. exponents of leaves against tolerance (least squares)",
        "shape    where          operator  exponent  expected  last half  leaves",
    )
    coarse = [10.0 ** (-2.0 - k / 3.0) for k in range(7)]
    fine = [10.0 ** (-3.0 - k / 2.0) for k in range(9)]
    for case in (curve("gamma2"), curve("gamma3"), glyph("g")):
        for operator in "SP":
            counts = [case.fit(share, operator=operator).cells for share in coarse]
            show_slope(case.name, "everywhere", operator, -1.0, coarse, counts)
    for case, level in ((curve("gamma2"), -0.02), (curve("gamma1"), 0.05)):
        for operator in "SP":
            counts = [
                cells_on(case.shape, case.fit(share, level=level, operator=operator), level)
                for share in fine
            ]
            show_slope(case.name, f"level {level:+.2f}", operator, -1.0 / 3.0, fine, counts)


def cells_on(shape: ss.Shape, result: FitResult, level: float) -> int:
    """Leaves that a level may meet: its distance from their center is half a diagonal at most."""
    boxes = result.spline.mesh.boxes
    away = np.abs(ss.signed_distance(shape, 0.5 * (boxes[:, :2] + boxes[:, 2:])) - level)
    return int(np.count_nonzero(away <= 0.5 * np.hypot(*(boxes[:, 2:] - boxes[:, :2]).T)))


def show_slope(
    name: str, where: str, operator: str, expected: float, shares: list[float], counts: list[int]
) -> None:
    x, y = np.log(shares), np.log(counts)
    half = len(shares) // 2
    slope, last = np.polyfit(x, y, 1)[0], np.polyfit(x[half:], y[half:], 1)[0]
    off = "" if abs(slope - expected) <= 0.1 else "  OFF"
    print(
        f"{name:8} {where:14} {operator:8} {slope:9.3f} {expected:9.3f} {last:10.3f}  "
        f"{' '.join(map(str, counts))}{off}",
        flush=True,
    )


def spread(items: Iterable[ss.Shape], count: int) -> list[ss.Shape]:
    """So many at most, evenly picked."""
    every = list(items)
    return every[:: max(1, len(every) // count)][:count]


def random_error(result: FitResult, shape: ss.Shape, count: int, seed: int) -> float:
    """Largest |s - u| at random points, half in the domain and half in random leaves."""
    random = np.random.default_rng(seed)
    boxes, domain = result.spline.mesh.boxes, np.array(result.spline.mesh.domain)
    largest = 0.0
    for first in range(0, count, BLOCK):
        size = min(BLOCK, count - first)
        box = boxes[random.integers(len(boxes), size=size)]
        box[: size // 2] = domain
        points = box[:, :2] + random.random((size, 2)) * (box[:, 2:] - box[:, :2])
        miss = np.abs(result.spline(points) - ss.signed_distance(shape, points))
        largest = max(largest, float(miss.max()))
    return largest


def table_d(points: int, count: int, element: str) -> None:
    share = 1e-2
    space = ELEMENTS[element].spaces[0]
    head(
        f"D. {points:,} random points a shape, {element}, {space}, tolerance {share:g} of the size",
        f"{'shape':26} leaves     error    random  random/error  random/bound  bound/error",
    )
    shapes = [formula_shape(name) for name in SMOOTH]
    for drawings in (glyphs(), icons()):
        shapes += spread(drawings.values(), count)
    shapes += outlines().values()
    failures, against_error, against_bound, width = [], 0.0, 0.0, 0.0
    for seed, shape in enumerate(shapes):
        case = drawn(shape)
        try:
            result = case.fit(share, element=element, space=space)
        except ToleranceNotReached as missed:
            failures.append(f"{case.name}: {missed}")
            continue
        found = random_error(result, shape, points, 1000 + seed)
        error, bound = result.error, result.bound or math.nan
        ratios = found / error, found / bound, bound / error
        print(
            f"{case.name:26} {result.cells:6} {error / case.unit:9.3e} {found / case.unit:9.3e} "
            f"{ratios[0]:13.5f} {ratios[1]:13.5f} {ratios[2]:12.5f}",
            flush=True,
        )
        against_error = max(against_error, ratios[0])
        against_bound, width = max(against_bound, ratios[1]), max(width, ratios[2])
        right = {
            "random <= bound": found <= bound,
            "error >= 0.99 random": error >= 0.99 * found,
            "bound <= tolerance": bound <= result.tolerance,
        }
        failures += [f"{case.name}: not {what}" for what, holds in right.items() if not holds]
    print(
        f"{len(shapes)} shapes, failures: {len(failures)}; largest random/error "
        f"{against_error:.5f}, random/bound {against_bound:.5f}, bound/error {width:.5f}"
    )
    print("\n".join(failures))


def table_e() -> None:
    questions: list[tuple[Case, float | None, float]] = [
        (case, None, 1e-3) for case in (*map(curve, paper.CURVES), glyph("g"), icon("airplane"))
    ]
    levels = ((curve("gamma2"), -0.02), (curve("gamma1"), 0.05), (glyph("S"), 0.02))
    questions += [(case, level, share) for case, level in levels for share in (1e-4, 1e-5, 1e-6)]
    head(
        "E. leaves by operator, and with S by the cells to start from",
        "shape    where         tolerance         S        W        P        V"
        "    start 2        4        8",
    )
    for case, level, share in questions:
        counts = [case.fit(share, level=level, operator=name).cells for name in OPERATORS]
        starts = [
            case.fit(share, level=level, start=case.start(cells, level)).cells
            for cells in (2, 4, 8)
        ]
        where = "everywhere" if level is None else f"level {level:+.2f}"
        print(
            f"{case.name:8} {where:12} {share:10.0e}  {' '.join(f'{n:8}' for n in counts)}   "
            f"{' '.join(f'{n:8}' for n in starts)}",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description="Leaves, errors and times of fits.")
    parser.add_argument("--tables", default="ABCDE", help="which tables")
    parser.add_argument("--points", type=int, default=1_000_000, help="random points a shape (D)")
    parser.add_argument("--shapes", type=int, default=12, help="glyphs and icons, of each (D)")
    parser.add_argument("--element", default="quadratic", choices=ELEMENTS, help="B-splines (D)")
    options = parser.parse_args()
    tables: dict[str, Callable[[], None]] = {
        "A": table_a,
        "B": table_b,
        "C": table_c,
        "D": partial(table_d, options.points, options.shapes, options.element),
        "E": table_e,
    }
    if hasattr(os, "getloadavg"):
        print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    began = time.perf_counter()
    for name in options.tables.upper():
        tables[name]()
    print(f"\n{time.perf_counter() - began:.0f} seconds in all")


if __name__ == "__main__":
    main()
