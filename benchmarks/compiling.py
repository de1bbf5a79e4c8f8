"""What the first use of each main operation compiles: seconds of CPU time by kernel.

    python -m benchmarks.compiling [offset] [fit] [distance] [--most 15]

Each operation runs in a process of its own with an empty folder for compiled code, as with a
newcomer. A kernel's seconds are its own, without those of the kernels that it calls.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from dataclasses import dataclass

import numpy as np

OPERATIONS = ("distance", "offset", "fit")


@dataclass(frozen=True)
class FirstUse:
    """What one process took: CPU seconds, of compiling by kernel, and how often each."""

    process: float  # the whole of it, Python's start included
    total: float
    own: dict[str, float]
    times: dict[str, int]

    @property
    def compiling(self) -> float:
        return sum(self.own.values())


def first_use(operation: str, folder: str) -> FirstUse:
    """Carry one operation out in a process of its own; compiled code is kept in the folder."""
    command = [sys.executable, "-m", "benchmarks.compiling", operation, "--run"]
    printed, process = child(command, {"NUMBA_CACHE_DIR": folder})
    found = json.loads(printed)
    return FirstUse(process, found["total"], found["own"], found["times"])


def child(command: list[str], settings: dict[str, str]) -> tuple[str, float]:
    """What a process prints, and its CPU seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        command, env=os.environ | settings, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        text=True, check=True,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _run(operation: str) -> None:
    """Carry one operation out, in this process; print the figures as JSON."""
    from numba.core import event

    started = time.process_time()
    own: dict[str, float] = defaultdict(float)
    times: dict[str, int] = defaultdict(int)
    stack: list[list[float]] = []  # when each began, and what was spent within

    class Listener(event.Listener):
        def on_start(self, event: event.Event) -> None:
            stack.append([time.process_time(), 0.0])

        def on_end(self, event: event.Event) -> None:
            began, within = stack.pop()
            spent = time.process_time() - began
            if stack:
                stack[-1][1] += spent
            function = event.data["dispatcher"].py_func
            name = f"{function.__module__.removeprefix('splinesdf.')}.{function.__name__}"
            own[name] += spent - within
            times[name] += 1

    event.register("numba:compile", Listener())
    import splinesdf as ss

    shape = ss.example("part")
    if operation == "distance":
        ss.signed_distance(shape, np.random.default_rng(0).random((1000, 2)) * shape.size)
    elif operation == "offset":
        ss.offset(shape, 2.0)
    else:
        ss.fit(shape, tolerance=1e-2 * shape.size)
    total = time.process_time() - started
    print(json.dumps({"own": own, "times": times, "total": total}))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("operations", nargs="*", default=OPERATIONS)
    parser.add_argument("--most", type=int, default=15, help="kernels to print")
    parser.add_argument("--run", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.run:
        _run(arguments.operations[0])
        return
    for operation in arguments.operations:
        with tempfile.TemporaryDirectory() as folder:
            found = first_use(operation, folder)
        twice = {name: count for name, count in found.times.items() if count > 1}
        print(f"{operation}: {found.total:.1f} s of CPU time, of which compiling "
              f"{found.compiling:.1f} s for {sum(found.times.values())} signatures")  # fmt: skip
        for name, seconds in sorted(found.own.items(), key=lambda item: -item[1])[: arguments.most]:
            print(f"  {seconds:6.2f}  {name}")
        if twice:
            print("  more than one signature:", ", ".join(f"{k} {n}" for k, n in twice.items()))


if __name__ == "__main__":
    main()
