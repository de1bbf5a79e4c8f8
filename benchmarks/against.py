"""Times beside those of another commit: CPU seconds of one core, as ratios, in one run.

    python -m benchmarks.against REVISION [--rounds 3]

Both trees take turns; of each operation the median of all rounds counts. Code is compiled in a
round of its own before. "First" is a whole `splinesdf offset part.svg -d 2` with nothing compiled,
"warm" the same once more.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
# Runs in either tree, on one processor: what is public there. Names and CPU seconds as JSON.
WORK = """
import json, os, time
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
from pathlib import Path
import numpy as np
import splinesdf as ss
part = ss.read(Path(ss.__file__).parent / "data" / "part.svg")
gamma = ss.Shape.from_formula("1/5 + (3 + 2*cos(t))*cos(t)/10", "2/5 + (3 + 2*cos(t))*sin(t)/10")
random = np.random.default_rng(0)
box = np.array(part.default_domain())
points = random.random((200_000, 2)) * (box[2:] - box[:2]) + box[:2]
spline = ss.fit(part, tolerance=1e-3 * part.size).spline
def offsets(shape):
    for share in (0.03, -0.01, 0.002, -0.002):
        ss.offset(shape, share * shape.size, tolerance=1e-6 * shape.size)
work = {
    "distance, 200,000 points": lambda: ss.signed_distance(part, points),
    "distance, grid 400 x 400": lambda: ss.signed_distance_grid(part, 400, 400),
    "fit of the part": lambda: ss.fit(part, tolerance=1e-3 * part.size),
    "values": lambda: spline(points),
    "values and gradients": lambda: spline.value_and_gradient(points),
    "4 offsets of the part": lambda: offsets(part),
    "4 offsets of a limacon": lambda: offsets(gamma),
}
found = {}
for name, call in work.items():
    call()
    times = []
    for _ in range(5):
        began = time.process_time()
        call()
        times.append(time.process_time() - began)
    found[name] = sorted(times)[2]
print(json.dumps(found))
"""
OFFSET = "import sys; sys.argv = ['splinesdf', 'offset', 'part', '-d', '2', '-o', {0!r}]; {1}"


def run(tree: Path, code: str, folder: str) -> tuple[str, float]:
    """What code prints in a tree, its compiled code kept in a folder; and its CPU seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    settings = {"PYTHONPATH": str(tree / "src"), "NUMBA_CACHE_DIR": folder}
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | settings,
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("revision")
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        other = folder / "other"
        subprocess.run(["git", "clone", "-q", str(ROOT), str(other)], check=True)
        subprocess.run(["git", "checkout", "-q", arguments.revision], cwd=other, check=True)
        trees = {"there": other, "here": ROOT}
        times: dict[str, dict[str, list[float]]] = {}
        for label, tree in trees.items():
            moved = (tree / "src/splinesdf/cli/main.py").exists()
            entry = f"from splinesdf.cli{'.main' if moved else ''} import main; main()"
            code = OFFSET.format(str(folder / "offset.svg"), entry)
            for what in ("first offset, whole process", "warm offset, whole process"):
                _, seconds = run(tree, code, str(folder / label))
                times.setdefault(what, {}).setdefault(label, []).append(seconds)
            run(tree, WORK, str(folder / label))
        for _ in range(arguments.rounds):
            for label, tree in trees.items():
                printed, _ = run(tree, WORK, str(folder / label))
                for what, seconds in json.loads(printed).items():
                    times.setdefault(what, {}).setdefault(label, []).append(seconds)
    print(f"{'':30} {arguments.revision[:8]:>10} {'here':>10} {'ratio':>7}")
    for what, by in times.items():
        one, two = (statistics.median(by[label]) for label in trees)
        print(f"{what:30} {one:9.4f}s {two:9.4f}s {two / one:7.2f}")


if __name__ == "__main__":
    main()
