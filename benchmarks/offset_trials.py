"""Offsets of random and moved shapes, each under a ceiling of CPU time, judged by GEOS.

Run from the repository's root, with the ``test`` extra and fontTools installed:

    python -m benchmarks.offset_trials --part transforms [--seed 0] [--count 200]
    python -m benchmarks.offset_trials "path('M0 0H2V2H0Z')" -d 0.5 --tolerance 1e-4

The first prints a table of failures by kind, and a list of the failing cases, each with what the
second form needs to run it alone. Parts: see benchmarks/offset_cases.py; kinds: KINDS below.
"""

from __future__ import annotations

import argparse
import resource
import signal
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

import splinesdf as ss
from benchmarks.offset_cases import PARTS, Case, cases, made
from splinesdf.contours.contour import Contour
from tests.offset_checks import Verdict, check_chains
from tests.offset_crossings import meetings
from tests.offset_region import EPS, judge_region, slack

# What a case may take, in seconds of CPU time, compiling aside; and its judge, a polyline of some
# hundred thousand pieces and its buffers.
CEILING, JUDGE_CEILING = 10.0, 120.0
# Memory, in bytes: beyond, it is as if it had no end.
MEMORY = 12 * 2**30
# Arcs: so many times the pieces of the boundary, and more as the fifth root of the tolerance, the
# order of conics. More are stubs of something, or a fit's. Fewer: what curves have is one.
ARCS_A_PIECE, COARSE = 20.0, 1e-3
# Arcs shorter than this share of the tolerance are stubs; an exact offset has some, where shapes
# turn by little: so many, or one for each piece.
STUB, SOME_STUBS = 1e-3, 20
# Meetings of more arcs take too long to find.
MOST_ARCS = 3000
# A tolerance below so many units in the last place of the coordinates may be refused.
REFUSED_ULPS = 1e3
KINDS = (
    *("raised", "refused", "ceiling", "memory", "deviation", "lost", "spurious", "winding"),
    *("area", "loops", "chain", "meet", "many", "stubs", "distance", "judge", "fallback"),
)


@dataclass
class Trial:
    """A case and what came of it."""

    case: Case
    failures: list[tuple[str, str]] = field(default_factory=list)
    undecided: list[str] = field(default_factory=list)
    arcs: int = 0
    deviation: float = 0.0
    seconds: float = 0.0
    refused: bool = False


# --- in a worker ---------------------------------------------------------------------------------


def work(pipe: Connection) -> None:
    """Run cases that come through a pipe; a timer that runs out kills the process."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warm_up()
    pipe.send("ready")
    while (case := pipe.recv()) is not None:
        attempt(case, pipe)


def warm_up() -> None:
    """Load or compile the kernels, those of a fit included."""
    for text in ("M0 0C2 4 5 -4 8 1C9 3 1 7 0 0Z", "M0 0H8V6H0ZM2 2A1 1 0 0 1 4 2A1 1 0 0 1 2 2Z"):
        shape = ss.Shape.from_svg_path(text, fill="evenodd")
        ss.offset(shape, [-0.3, 0.3], tolerance=1e-4)
        fitted = ss.fit(shape, tolerance=1e-2, band=(0.1, 0.1), certify=True)
        fitted.spline.contours(0.1)
        ss.signed_distance(shape, np.random.default_rng(0).random((10000, 2)))


def attempt(case: Case, pipe: Connection) -> None:
    """Offset, then judge, each under its timer; what is known is sent as soon as it is."""
    trial = Trial(case)
    shape = made(case.shape)
    limit(CEILING)
    began = time.process_time()
    contours: list[Contour] | None = None
    try:
        contours = ss.offset(shape, case.distance, tolerance=case.tolerance, coarse=True)
    except MemoryError:
        trial.failures.append(("memory", "more than the limit"))
    except ss.SplineSDFError as error:
        refused(trial, shape, error)
    except Exception as error:  # whatever it is, it is a failure, and the sweep goes on
        trial.failures.append(("raised", f"{type(error).__name__}: {error}"))
    limit(0.0)
    if contours and any(contour.fitted for contour in contours):
        trial.failures.append(("fallback", "the level set of a fit"))
    trial.seconds = time.process_time() - began
    pipe.send(trial)
    if contours is not None:
        limit(JUDGE_CEILING)
        judge(trial, shape, contours)
        limit(0.0)
    pipe.send(trial)


def limit(seconds: float) -> None:
    """Kill this process, compiled code and all, when it has used so much more CPU time."""
    signal.setitimer(signal.ITIMER_PROF, seconds)


def refused(trial: Trial, shape: ss.Shape, error: Exception) -> None:
    """A refusal is right if it says that the tolerance is below rounding, and it is."""
    case = trial.case
    largest = float(np.abs(shape.control).max()) + abs(case.distance)
    trial.refused = True
    if not ("rounding" in str(error) and case.tolerance < REFUSED_ULPS * 2.0 * EPS * largest):
        trial.failures.append(("refused", f"{type(error).__name__}: {error}"))


def judge(trial: Trial, shape: ss.Shape, contours: list[Contour]) -> None:
    case, verdict = trial.case, Verdict()
    check_chains(verdict, contours, case.distance)
    try:
        judge_region(shape, contours, case.distance, case.tolerance, verdict=verdict)
    except Exception as error:  # a judge that fails is not to stop the sweep
        verdict.fail("judge", f"{type(error).__name__}: {error}")
    trial.arcs = sum(len(contour.arcs) for contour in contours)
    trial.deviation = verdict.deviation / (case.tolerance + slack(shape, case.distance))
    if trial.arcs:
        counted(verdict, case, shape, contours)
    if 0 < trial.arcs <= MOST_ARCS and len(places := meetings(contours)):
        verdict.fail("meet", f"arcs meet at {places[0].tolist()}")
    trial.failures += verdict.failures
    trial.undecided = verdict.undecided


def counted(verdict: Verdict, case: Case, shape: ss.Shape, contours: list[Contour]) -> None:
    """Not many more arcs than there are pieces, and no stubs."""
    arcs = np.concatenate([contour.arcs for contour in contours])
    finer = max(1.0, COARSE * case.size / case.tolerance) ** 0.2
    most = ARCS_A_PIECE * (shape.piece_count + 4) * finer
    if len(arcs) > most:
        verdict.fail("many", f"{len(arcs)} arcs of {shape.piece_count} pieces")
    stubs = int((np.hypot(*(arcs[:, 2] - arcs[:, 0]).T) < STUB * case.tolerance).sum())
    if stubs > max(SOME_STUBS, shape.piece_count):
        verdict.fail("stubs", f"{stubs} of {len(arcs)} arcs are shorter than {STUB} tolerances")


# --- outside -------------------------------------------------------------------------------------


class Worker:
    """A process that is started anew whenever it was killed."""

    def __init__(self) -> None:
        self.process: Any = None
        self.pipe: Any = None

    def start(self) -> None:
        context = get_context("spawn")  # compiled code has threads: not to be forked
        self.pipe, there = context.Pipe()
        self.process = context.Process(target=work, args=(there,), daemon=True)
        self.process.start()
        there.close()
        self.pipe.recv()

    def run(self, case: Case) -> Trial:
        if self.process is None:
            self.start()
        trial = Trial(case)
        reached = "ceiling"
        try:
            self.pipe.send(case)
            trial = self.pipe.recv()
            reached = "judge"
            trial = self.pipe.recv()
        except EOFError:
            self.process.join()
            trial.failures.append((reached, f"killed, status {self.process.exitcode}"))
            self.process = None
        return trial

    def stop(self) -> None:
        if self.process is not None:
            self.pipe.send(None)
            self.process.join()


def run_all(chosen: Iterable[Case], *, verbose: bool = False) -> list[Trial]:
    """The cases one after the other; failures are printed as they come."""
    worker, trials = Worker(), []
    for case in chosen:
        trial = worker.run(case)
        trials.append(trial)
        if trial.failures or verbose:
            print(text_of(trial), flush=True)
    worker.stop()
    return trials


def text_of(trial: Trial) -> str:
    kinds: dict[str, str] = {}
    for kind, text in trial.failures:
        kinds.setdefault(kind, text)
    said = "; ".join(f"{kind}: {text}" for kind, text in kinds.items()) or "nothing found"
    undecided = "".join(f"; undecided: {text}" for text in trial.undecided)
    case = trial.case
    return (
        f"- [{case.kind}] {case}\n    {said}{undecided} ({trial.arcs} arcs, {trial.seconds:.1f} s)"
    )


def table(trials: Sequence[Trial]) -> None:
    """Markdown: one row for each kind of case, a column for each kind of failure."""
    rows: dict[str, list[Trial]] = {}
    for trial in trials:
        rows.setdefault(trial.case.kind, []).append(trial)
    seen = [kind for kind in KINDS if any(kind == k for t in trials for k, _ in t.failures)]
    head = ["kind", "cases", "failed", *seen, "undecided", "refused", "worst", "longest s"]
    print("\n| " + " | ".join(head) + " |\n" + "|---" * len(head) + "|")
    for name, some in [*sorted(rows.items()), ("all", list(trials))]:
        cells = [name, len(some), sum(bool(t.failures) for t in some)]
        cells += [sum(any(k == kind for k, _ in t.failures) for t in some) for kind in seen]
        cells += [sum(bool(t.undecided) for t in some), sum(t.refused for t in some)]
        cells.append(f"{max((t.deviation for t in some), default=0.0):.3g}")
        cells.append(f"{max((t.seconds for t in some), default=0.0):.1f}")
        print("| " + " | ".join(map(str, cells)) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(description="Offsets of random and moved shapes, judged.")
    parser.add_argument("shape", nargs="?", help="one case: an expression of a shape")
    parser.add_argument("-d", "--distance", type=float, default=1.0)
    parser.add_argument("--tolerance", type=float, default=1e-3)
    parser.add_argument("--part", nargs="+", choices=list(PARTS), default=list(PARTS))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=200, help="cases of each part")
    parser.add_argument("--from", type=int, default=0, dest="first", help="leave so many out")
    options = parser.parse_args()
    if options.shape is not None:
        size = made(options.shape).size
        one = Case("one", "one", options.shape, options.distance, options.tolerance, size)
        run_all([one], verbose=True)
        return
    for part in options.part:
        print(f"\n## {part}, seed {options.seed}", flush=True)
        chosen = list(cases(part, options.seed, options.count))[options.first :]
        trials = run_all(chosen)
        table(trials)
        failed = sum(bool(trial.failures) for trial in trials)
        print(f"\n{len(trials)} cases, {failed} failed", flush=True)


if __name__ == "__main__":
    main()
