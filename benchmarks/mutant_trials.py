"""Mutants put in force one after the other, each in a child process: see `mutants`."""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import pickle
import resource
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import _pytest.main
import numpy as np
import pytest

from benchmarks.digest import TOPICS
from benchmarks.digest_shapes import SHAPES

# What a folder's kernels are seen by: topics of the digest, folders of tests.
SEEN_BY = {
    "arclets": (("distances", "offsets"), ("distance", "shapes", "arclets", "offsets", "fits")),
    "contours": (("offsets",), ("contours", "offsets", "io")),
    "distance": (("fits",), ("distance", "fits")),
    "fits": (("fits",), ("fits",)),
    "offsets": (("offsets",), ("offsets",)),
    "spaces": (("fits", "tables"), ("spaces", "splines", "fits")),
    "splines": (("fits",), ("splines",)),
}
# Seconds of CPU for a digest and for one test. Beyond, a mutant has no end, which is seen as well.
PATIENCE = 30
# Seconds of tests for each mutant at first. What they do not see is asked of all tests in the end.
AT_FIRST = 15.0
# Differences by no more than this share of the largest number are the last bits'.
ROUNDING = 1e-12
MEMORY = 8 << 30
SLOWEST = 40
Arrays = dict[tuple[str, str], list[np.ndarray]]


def in_child(number: int, work: Callable[[], object]) -> tuple[int, Any]:
    """Status, not 0 if it crashed or had no end, and what some work gives under a mutant."""
    read, write = os.pipe()
    sys.stdout.flush()
    child = os.fork()
    if not child:
        os.close(read)
        status = 1
        try:
            put_in_force(number)
            data = pickle.dumps(work())
            with os.fdopen(write, "wb") as pipe:
                pipe.write(data)
            status = 0
        except BaseException as error:
            if number < 0:
                print(repr(error), file=sys.stderr)
        finally:
            os._exit(status)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        data = pipe.read()
    _, status = os.waitpid(child, 0)
    return status, pickle.loads(data) if data and not status else None


def put_in_force(number: int) -> None:
    mutant = sys.modules["splinesdf.ground.mutant"]
    mutant.in_force.value = number
    os.environ["SPLINESDF_MUTANT"] = str(number)
    for name in (signal.SIGPROF, signal.SIGALRM):
        signal.signal(name, signal.SIG_DFL)
    if number >= 0:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.setitimer(signal.ITIMER_PROF, PATIENCE)
        signal.alarm(20 * PATIENCE)  # where a process of the test's own has no end


def kernels() -> dict[str, Any]:
    """All compiled functions by name."""
    return {
        f"{module}.{name}": value
        for module in list(sys.modules)
        if module.startswith("splinesdf.")
        for name, value in vars(sys.modules[module]).items()
        if hasattr(value, "py_func") and value.__module__ == module
    }


def results() -> tuple[Arrays, dict[str, Any]]:
    """All that the digest is of, and what kernels were compiled for."""
    found = {
        (topic, name): list(TOPICS[topic](shape))
        for topic in TOPICS
        for name, shape in SHAPES[topic]().items()
    }
    return found, {name: list(one.signatures) for name, one in kernels().items()}


def differences(topics: tuple[str, ...], expected: Arrays) -> int:
    """0 if results are the same, 1 if but for rounding, 2 if not."""
    worst = 0
    for topic in topics:
        for name, shape in SHAPES[topic]().items():
            one = expected[topic, name]
            other = list(TOPICS[topic](shape))
            if len(one) != len(other):
                return 2
            for a, b in zip(one, other, strict=True):
                if a.tobytes() == b.tobytes() and a.shape == b.shape:
                    continue
                if a.shape != b.shape or a.dtype.kind != "f" or b.dtype.kind != "f":
                    return 2
                largest = np.abs(a[np.isfinite(a)]).max(initial=0.0)
                if not np.allclose(a, b, rtol=0.0, atol=ROUNDING * largest, equal_nan=True):
                    return 2
                worst = 1
    return worst


class Trials:
    """Runs the collected tests once for each mutant, those that saw most before the others."""

    def __init__(self, trials: list[tuple[int, str, str]]) -> None:
        self.trials = trials
        self.seconds: dict[str, float] = {}  # of each test that was run
        self.kills: dict[str, int] = {}
        self.sound: dict[str, bool] = {}  # whether a test passes where there is no mutant
        self.log: list[tuple[str, float, bool]] = []
        self.until = np.inf

    @pytest.hookimpl(tryfirst=True)
    def pytest_configure(self) -> None:
        from hypothesis import Phase, settings  # not before pytest has

        found = (Phase.explicit, Phase.generate)  # which of them is the shortest is no matter
        settings.register_profile("mutants", deadline=None, derandomize=True, phases=found)

    def pytest_runtest_logstart(self) -> None:
        signal.setitimer(signal.ITIMER_PROF, PATIENCE)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.log.append((report.nodeid, report.duration, report.failed))
        if time.process_time() > self.until and not report.failed:
            self.session.shouldstop = "the time for a mutant is over"

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        early = [name for name, one in kernels().items() if one.signatures]
        assert not early, f"run before any mutant is in force: {early}"
        begin = time.time()
        in_child(-1, results)  # compiles
        status, (expected, signatures) = in_child(-1, results)
        assert not status
        for name in signatures:
            importlib.import_module(name.rpartition(".")[0])
        found = kernels()
        for name, some in signatures.items():
            for signature in some:
                found[name].compile(signature)  # from the folder of compiled code
        print(f"{len(session.items)} tests, compiled in {time.time() - begin:.0f} s", flush=True)
        counts = dict.fromkeys(("seen", "not seen", "rounding only", "no result changed"), 0)
        later = []

        def told(outcome: str, text: str, begin: float) -> None:
            print(f"{outcome:18} {text}  ({time.time() - begin:.0f} s)", flush=True)
            state = counts | {"seen by no test yet": len(later)}
            print("   ", ", ".join(f"{name} {n}" for name, n in state.items()), flush=True)

        for number, room, text in self.trials:
            begin = time.time()
            topics = SEEN_BY[room][0]
            status, worst = in_child(number, lambda t=topics: differences(t, expected))
            if not status and worst < 2:
                outcome = ("no result changed", "rounding only")[worst]
            elif seen := self.judged(session, (number, room, text), AT_FIRST):
                outcome, text = "seen", f"{text}  {seen}"
            else:
                later.append((number, room, text))
                told("no test yet", text, begin)
                continue
            counts[outcome] += 1
            told(outcome, text, begin)
        while later:
            begin = time.time()
            number, room, text = later.pop(0)
            seen = self.judged(session, (number, room, text))
            outcome = "seen" if seen else "not seen"
            counts[outcome] += 1
            told(outcome, f"{text}  {seen}", begin)
        print("the slowest tests, of those that were run:")
        for name in sorted(self.seconds, key=lambda name: -self.seconds[name])[:SLOWEST]:
            print(f"{self.seconds[name]:6.1f} s  {name}")
        return True

    def judged(
        self, session: pytest.Session, trial: tuple[int, str, str], seconds: float = np.inf
    ) -> str:
        """What sees a mutant: the test that fails first, or nothing."""
        number, room, text = trial
        rooms, kernel = SEEN_BY[room][1], text.split()[1].partition(".")[0]
        named = f"{room}.kernels.{kernel} import"
        direct = {path for path in {i.path for i in session.items} if named in path.read_text()}
        items = [i for i in session.items if i.path.parent.name in rooms or i.path in direct]
        files: dict[Path, list[pytest.Item]] = {}
        for item in items:
            files.setdefault(item.path, []).append(item)

        def order(path: Path) -> tuple[bool, float, float]:
            names = [item.nodeid for item in files[path]]
            took = sum(self.seconds.get(name, 1.0) for name in names)
            return path not in direct, -sum(self.kills.get(name, 0) for name in names), took

        ordered = []
        for path in sorted(files, key=order):
            some = sorted(files[path], key=lambda i: -self.kills.get(i.nodeid, 0))
            ordered += [item for item in some if self.sound.get(item.nodeid, True)]
        while True:
            status, log = in_child(number, lambda some=ordered: self.run(session, some, seconds))
            if log is None:
                return f"no end or a crash: {status}"
            for name, took, _ in log:
                self.seconds[name] = max(took, self.seconds.get(name, 0.0))
            failed = [name for name, _, bad in log if bad]
            if not failed:
                return ""
            name = failed[0]
            if name not in self.sound:
                one = [item for item in items if item.nodeid == name]
                status, log = in_child(-1, lambda one=one: self.run(session, one))
                self.sound[name] = not status and not any(bad for _, _, bad in log)
            if self.sound[name]:
                self.kills[name] = self.kills.get(name, 0) + 1
                return name
            print(f"    fails without a mutant: {name}", flush=True)
            ordered = [item for item in ordered if item.nodeid != name]

    def run(
        self, session: pytest.Session, items: list[pytest.Item], seconds: float = np.inf
    ) -> list[tuple[str, float, bool]]:
        """Tests until one fails, or for so long, in silence."""
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, 1)
        os.dup2(nothing, 2)
        self.log, self.until, self.session = [], time.process_time() + seconds, session
        session.items = items
        session.config.option.maxfail = 1
        with contextlib.suppress(session.Failed, session.Interrupted):
            _pytest.main.pytest_runtestloop(session)
        return self.log


def main() -> int:
    trials = json.loads(Path(sys.argv[1]).read_text())
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    rooms = sorted({f"tests/{name}" for _, room, _ in trials for name in SEEN_BY[room][1]})
    options = [
        "-q",
        "-s",
        "-n",
        "0",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:faulthandler",
        "--hypothesis-profile=mutants",
    ]
    return int(pytest.main([*options, *rooms], plugins=[Trials(trials)]))


if __name__ == "__main__":
    sys.exit(main())
