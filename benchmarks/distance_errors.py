"""Errors of the exact distance: against 40 digits, against GEOS on fine polylines, and wrong sides.

Run from the repository's root, with the ``test`` extra and fontTools installed:

    python -m benchmarks.distance_errors [--precise 400] [--points 100000] [--shapes 12]

Errors are shares of a shape's size. "beyond" is what the error against GEOS exceeds the polylines'
own deviation by: 0 if it does not. Left out are the points where polylines of two finenesses
differ by more than that, near contours that cross at a small angle; their share is printed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

import splinesdf as ss
from tests import oracles
from tests.glyphs import glyphs
from tests.precise import Bezier, Curve, precise_distance
from tests.real_shapes import SMOOTH, around, beside, formula_arcs, formula_shape, icons, outlines

# How far the polylines stay from the curves, as a share of the size. Polygons are their own.
DEVIATION = 1e-7


@dataclass(frozen=True)
class Case:
    shape: ss.Shape
    curves: Callable[[], Sequence[Curve]]  # what the 40 digits are computed from


def bezier_case(shape: ss.Shape) -> Case:
    def curves() -> Sequence[Curve]:
        return [Bezier(oracles.piece(shape, i)) for i in range(shape.piece_count)]

    return Case(shape, curves)


def formula_case(name: str) -> Case:
    return Case(formula_shape(name), lambda: formula_arcs(name))


def case_sets(count: int) -> dict[str, list[Case]]:
    """Sets of shapes, at most so many of each, evenly picked."""
    sets = {name: [formula_case(name)] for name in SMOOTH}
    for title, shapes in (("glyphs", glyphs()), ("icons", icons()), ("outlines", outlines())):
        step = max(1, len(shapes) // count)
        sets[title] = [bezier_case(shape) for shape in list(shapes.values())[::step]]
    return sets


def questions(shape: ss.Shape, count: int, seed: int) -> np.ndarray:
    """Half about the shape, half beside its contours at 1e-14 to 1e-1 of the size."""
    half = count // 2
    return np.concatenate([around(shape, half, seed), beside(shape, count - half, seed + 1)])


def all_is_boundary(shape: ss.Shape) -> bool:
    """Whether no contour has the same filling on both sides; else 40 digits would judge others."""
    rings = oracles.polylines(shape, 1e-4 * shape.size)
    every, kept = (
        sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in lines)
        for lines in (rings, oracles.filled_boundary(rings, shape.fill))
    )
    return abs(every - kept) < 1e-9 * every


def precise_error(case: Case, count: int) -> float:
    """Largest error against 40 digits, a share of the size."""
    points = questions(case.shape, count, 1)
    found = np.abs(ss.signed_distance(case.shape, points))
    miss = np.abs(found - precise_distance(case.curves(), points))
    return float(miss.max()) / case.shape.size


def polyline_error(case: Case, count: int) -> tuple[float, int, float]:
    """Largest error beyond the deviation, wrong sides, and the share of points left out."""
    shape, points = case.shape, questions(case.shape, count, 3)
    straight = shape.control.shape[0] == 2 * shape.piece_count
    deviation = DEVIATION * shape.size if not straight else oracles.SNAP * np.abs(points).max()
    expected = oracles.sure_polyline_distance(shape, points, deviation)
    if expected is None:
        raise SystemExit(f"{shape.name} fills nothing")
    distance, sure = expected
    found = ss.signed_distance(shape, points)
    miss = np.max(np.abs(np.abs(found) - np.abs(distance)), where=sure, initial=0.0)
    clear = sure & (np.abs(distance) > 2.0 * deviation)
    wrong = np.count_nonzero((found < 0)[clear] != (distance < 0)[clear])
    return max(0.0, float(miss) - deviation) / shape.size, int(wrong), 1.0 - float(np.mean(sure))


def shown_row(title: str, cases: Sequence[Case], precise: int, points: int) -> str:
    """One line of the table; the points of a set are shared among its shapes."""
    began = time.perf_counter()
    exact = [case for case in cases if title in SMOOTH or all_is_boundary(case.shape)]
    errors = [precise_error(case, max(2, precise // len(exact))) for case in exact]
    against = [polyline_error(case, points) for case in cases]
    beyond, wrong, left_out = zip(*against, strict=True)
    worst = int(np.argmax(beyond))
    where = f"  worst: {cases[worst].shape.name}" if beyond[worst] > 1e-14 else ""
    return (
        f"{title:16} {len(cases):6} {len(exact) * max(2, precise // len(exact)):8} "
        f"{max(errors):9.1e} {len(cases) * points:9} {max(beyond):9.1e} {sum(wrong):6} "
        f"{max(left_out):9.1e} {time.perf_counter() - began:8.1f}{where}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description="Errors of the exact distance.")
    parser.add_argument("--precise", type=int, default=400, help="points a set against 40 digits")
    parser.add_argument("--points", type=int, default=100_000, help="points a shape against GEOS")
    parser.add_argument("--shapes", type=int, default=12, help="shapes of each set of drawings")
    options = parser.parse_args()
    print(
        "shapes            count   points 40 digits    points    beyond  wrong  left out  seconds"
    )
    for title, cases in case_sets(options.shapes).items():
        print(shown_row(title, cases, options.precise, options.points), flush=True)


if __name__ == "__main__":
    main()
