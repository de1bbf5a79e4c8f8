"""What the first use of each main operation compiles: seconds of CPU time by kernel.

    python -m benchmarks.compiling [offset] [fit] [distance] [--most 15]

Each operation runs in a process of its own with an empty folder for compiled code, as with a
newcomer. A kernel's seconds are its own, without those of the kernels that it calls.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict

import numpy as np

OPERATIONS = ("distance", "offset", "fit")


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
    from benchmarks.digest_shapes import PART

    shape = ss.read(PART)
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
            command = [sys.executable, "-m", "benchmarks.compiling", operation, "--run"]
            answer = subprocess.run(
                command, env=os.environ | {"NUMBA_CACHE_DIR": folder}, stdout=subprocess.PIPE,
                text=True, check=True,
            )  # fmt: skip
        found = json.loads(answer.stdout)
        kernels = sum(found["times"].values())
        twice = {name: count for name, count in found["times"].items() if count > 1}
        print(f"{operation}: {found['total']:.1f} s of CPU time, of which compiling "
              f"{sum(found['own'].values()):.1f} s for {kernels} signatures")  # fmt: skip
        for name, seconds in sorted(found["own"].items(), key=lambda item: -item[1])[
            : arguments.most
        ]:
            print(f"  {seconds:6.2f}  {name}")
        if twice:
            print("  more than one signature:", ", ".join(f"{k} {n}" for k, n in twice.items()))


if __name__ == "__main__":
    main()
