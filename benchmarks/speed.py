"""How long it takes to make shapes ready, to offset and to fit them, and how that grows.

    python -m benchmarks.speed [--against PATH] [--only WORD ...] [--limit 120]

CPU seconds of one core. Each row is measured in a process of its own, which has done the same once
before on something small; with ``--against``, another checkout's source takes its turn right after.
A row that takes longer than the limit says so.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
# Address space of one row, so that what takes all memory ends: bytes.
_MEMORY = 8 << 30


def measured(row: int, source: Path, limit: float) -> str:
    """What one row gives with the package of a folder, as text."""
    path = os.pathsep.join([str(source), str(ROOT)])
    command = [sys.executable, "-m", "benchmarks.speed", "--row", str(row)]
    try:
        done = subprocess.run(
            command, cwd=ROOT, env=os.environ | {"PYTHONPATH": path}, timeout=limit,
            capture_output=True, text=True, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"> {limit:g} s"
    if done.returncode:
        return (done.stderr.strip().splitlines() or ["failed"])[-1][:40]
    return f"{float(done.stdout.split()[-1]):.3g}"


def _run(row: int) -> None:
    """Measure one row in this process, on one core."""
    import resource

    from benchmarks.speed_cases import CASES

    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    _load()
    print(CASES[row].measure())


def _load() -> None:
    """Use all that is measured once, so that code is compiled, or loaded."""
    import splinesdf as ss
    from benchmarks import speed_cases as cases

    for shape in (cases.limacon(), cases.part()):
        cases.prepare(shape)
        cases.offset(shape, -0.03, 1e-3)
        cases.offset(shape, 0.03, 1e-3)
    ss.fit(cases.limacon(), tolerance=1e-2)
    ss.signed_distance_grid(cases.square(), 8, 8)
    ss.offset(cases.spiral(2), -0.2)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--against", type=Path, help="another checkout's root")
    parser.add_argument("--only", nargs="*", default=[], help="rows whose names have these words")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds a row")
    parser.add_argument("--row", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.row is not None:
        _run(arguments.row)
        return
    from benchmarks.speed_cases import CASES

    trees = [ROOT / "src"]
    if arguments.against:
        trees.insert(0, arguments.against.resolve() / "src")
    print(f"{'':42}{'':4}" + "".join(f"{name:>12}" for name in ("there", "here")[-len(trees) :])
          + f"{'goal':>8}")  # fmt: skip
    for row, case in enumerate(CASES):
        if all(word in case.name for word in arguments.only):
            found = [measured(row, tree, arguments.limit) for tree in trees]
            print(f"{case.name:42}{case.unit:>4}" + "".join(f"{one:>12}" for one in found)
                  + f"{case.goal:>8}", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
