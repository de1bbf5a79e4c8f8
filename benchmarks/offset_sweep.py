"""Offsets of all shapes at all distances and tolerances, judged by tests/offset_checks.py.

Run from the repository's root, with the ``test`` extra and fontTools installed:

    python -m benchmarks.offset_sweep [--shapes 100] [--tolerances 1e-3 1e-5 1e-8]

Distances and tolerances are shares of a shape's size, and to the mechanical parts' distances come
those at which something degenerates exactly. Each kind of failure is a column, each failure a line
below; "undecided" are the runs in which the number of loops hangs on less than the count resolves.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import cache
from multiprocessing import get_context

import numpy as np

import splinesdf as ss
from splinesdf.contours.contour import Contour, evaluate
from tests import oracles
from tests.glyphs import glyphs
from tests.mechanical import AWKWARD, SPLINES, parts
from tests.named_shapes import FORMULAS, gamma
from tests.offset_checks import judge
from tests.offset_count import loop_counts
from tests.real_shapes import icons, outlines

SHARES = tuple(sign * share for share in (1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3) for sign in (1.0, -1.0))
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
# Of what consists of lines and circular arcs the offset is exact: it may deviate by this share of
# the size, the rounding of arcs that came as Bézier pieces and of a few steps on.
EXACT = 1e-11
# The polylines of the other oracle, a share of the size, and the points of a run it is asked.
DEVIATION = 1e-7
ASKED = 40
KINDS = (
    "raised",
    "chain",
    "side",
    "parent",
    "deviation",
    "exact",
    "oracle",
    "jump",
    "blunt",
    "meet",
    "count",
    "missing",
)


@dataclass
class Run:
    """One offset: what was asked, what came, what was found."""

    group: str
    name: str
    distance: float
    tolerance: float  # share of the size
    loops: int = 0
    arcs: int = 0
    corners: int = 0
    deviation: float = 0.0  # share of the tolerance
    seconds: float = 0.0
    failures: list[tuple[str, str]] = field(default_factory=list)
    undecided: list[str] = field(default_factory=list)


GROUPS: dict[str, Callable[[], Mapping[str, ss.Shape]]] = {
    "curves": lambda: {name: gamma(name) for name in FORMULAS},
    "glyphs": glyphs,
    "icons": icons,
    "mechanical": parts,
    "polygons": outlines,
}


@cache
def group(name: str) -> Mapping[str, ss.Shape]:
    return GROUPS[name]()


def spread(names: Iterable[str], count: int) -> list[str]:
    """So many at most, evenly picked."""
    every = list(names)
    return every[:: -(-len(every) // count)] if count < len(every) else every


def sweep(task: tuple[str, str, Sequence[float], Sequence[float]]) -> list[Run]:
    """All distances and tolerances of one shape."""
    title, name, tolerances, shares = task
    shape = group(title)[name]
    distances = [share * shape.size for share in shares]
    distances += AWKWARD.get(name, ()) if title == "mechanical" else ()
    exact = title == "polygons" or (title == "mechanical" and name not in SPLINES)
    runs, samples = [], []
    for distance in distances:
        counts = loop_counts(shape, distance)
        for share in tolerances:
            run = Run(title, name, distance, share)
            contours = one(run, shape, counts, exact)
            runs.append(run)
            samples.append(sampled(contours, ASKED))
    ask_oracle(shape, runs, samples)
    return runs


def one(run: Run, shape: ss.Shape, counts: Sequence[int], exact: bool) -> list[Contour]:
    """Make an offset and have it judged."""
    tolerance = run.tolerance * shape.size
    began = time.perf_counter()
    try:
        contours = ss.offset(shape, run.distance, tolerance=tolerance, coarse=True)
    except Exception as error:  # whatever it is, it is a failure, and the sweep goes on
        run.failures.append(("raised", f"{type(error).__name__}: {error}"))
        return []
    run.seconds = time.perf_counter() - began
    verdict = judge(shape, contours, run.distance, tolerance, counts=counts)
    run.failures, run.undecided = verdict.failures, verdict.undecided
    run.loops, run.arcs = len(contours), sum(len(contour.arcs) for contour in contours)
    run.corners, run.deviation = verdict.corners, verdict.deviation / tolerance
    if exact and verdict.deviation > EXACT * shape.size:
        run.failures.append(("exact", f"{verdict.deviation / shape.size:.2e} of the size"))
    return contours


def sampled(contours: Sequence[Contour], count: int) -> np.ndarray:
    """Some points of the contours, always the same ones."""
    if not contours:
        return np.empty((0, 2))
    random = np.random.default_rng(7)
    arcs = np.concatenate([contour.arcs for contour in contours])
    weights = np.concatenate([contour.weights for contour in contours])
    rows = random.integers(len(arcs), size=count)
    return evaluate(arcs[rows], weights[rows], random.random(1))[:, 0]


def ask_oracle(shape: ss.Shape, runs: Sequence[Run], samples: Sequence[np.ndarray]) -> None:
    """Distances by GEOS to fine polylines, of all runs of a shape at once."""
    points = np.concatenate(samples)
    deviation = DEVIATION * shape.size
    answer = oracles.sure_polyline_distance(shape, points, deviation) if len(points) else None
    if answer is None:
        return
    first = 0
    for run, some in zip(runs, samples, strict=True):
        part = slice(first, first + len(some))
        first = part.stop
        allowed = run.tolerance * shape.size + 2.0 * deviation
        wrong = (np.abs(answer[0][part] - run.distance) > allowed) & answer[1][part]
        if wrong.any():
            # Snapping closes wedges that are thin enough, as at a tip of the icon `bing`.
            rings = oracles.polylines(shape, deviation)
            unsnapped = oracles.signed_polyline_distance(rings, shape.fill, some[wrong])
            if unsnapped is not None:
                wrong[wrong] = np.abs(unsnapped - run.distance) > allowed
        if wrong.any():
            run.failures.append(("oracle", f"{np.sum(wrong)} of {len(some)} points"))


def table(runs: Sequence[Run], key: Callable[[Run], str], title: str) -> None:
    """Markdown: one row for each value of the key, and one for all."""
    rows: dict[str, list[Run]] = {}
    for run in runs:
        rows.setdefault(key(run), []).append(run)
    head = [title, "runs", "loops", "arcs", "corners", "worst deviation / tolerance"]
    head += [*KINDS, "undecided", "median ms", "longest s"]
    print("\n| " + " | ".join(head) + " |\n" + "|---" * len(head) + "|")
    for name, some in [*rows.items(), ("all", list(runs))]:
        cells = [name, len(some)]
        cells += [sum(getattr(run, what) for run in some) for what in ("loops", "arcs", "corners")]
        cells.append(f"{max(run.deviation for run in some):.4f}")
        cells += [sum(any(k == kind for k, _ in run.failures) for run in some) for kind in KINDS]
        cells.append(sum(bool(run.undecided) for run in some))
        times = [run.seconds for run in some]
        cells += [f"{1e3 * statistics.median(times):.1f}", f"{max(times):.2f}"]
        print("| " + " | ".join(map(str, cells)) + " |")


def listing(runs: Sequence[Run]) -> None:
    """Each failure, and each run that could not be decided."""
    for run in runs:
        what = f"{run.group} {run.name}, distance {run.distance!r}, tolerance {run.tolerance:g}"
        kinds: dict[str, list[str]] = {}
        for kind, text in run.failures:
            kinds.setdefault(kind, []).append(text)
        for kind, texts in kinds.items():
            print(f"- {kind} ({len(texts)}): {what}: {texts[0]}")
        for text in run.undecided:
            print(f"- undecided: {what}: {text}")


def main() -> None:
    parser = argparse.ArgumentParser(description="Offsets judged over many shapes.")
    parser.add_argument("--shapes", type=int, default=100, help="of each group, at most")
    parser.add_argument("--groups", nargs="+", default=list(GROUPS), choices=list(GROUPS))
    parser.add_argument("--tolerances", nargs="+", type=float, default=list(TOLERANCES))
    parser.add_argument("--distances", nargs="+", type=float, default=list(SHARES))
    parser.add_argument("--processes", type=int, default=2)
    options = parser.parse_args()
    began = time.perf_counter()
    tasks = [
        (title, name, options.tolerances, options.distances)
        for title in options.groups
        for name in spread(group(title), options.shapes)
    ]
    runs: list[Run] = []
    # Spawned, not forked: compiled code has threads.
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        for done, found in enumerate(pool.map(sweep, tasks), 1):
            runs += found
            failed = sum(bool(run.failures) for run in found)
            if failed:
                print(
                    f"{done}/{len(tasks)} {found[0].name}: {failed} of {len(found)} failed",
                    flush=True,
                )
    table(runs, lambda run: run.group, "group")
    table(runs, lambda run: f"{run.tolerance:g}", "tolerance")
    print()
    listing(runs)
    print(f"\n{len(runs)} runs, {sum(bool(run.failures) for run in runs)} failed")
    print(f"{time.perf_counter() - began:.0f} seconds in all")


if __name__ == "__main__":
    main()
