"""Does every broken file give one clear line? Files are broken at random, and read under limits.

    python -m benchmarks.fuzz [--reader .svg .dxf ...] [--count 3000] [--share 1.0] [--seed 0]

A process breaks and reads one file after the other, with 10 s and 1 GB for each, with warnings and
what libraries log as errors. Of a share of those that are read distances are asked for, so that
their boundary is made. Right is an `InputError` of one line, or a shape whose distances are
numbers. An escape is anything else: another exception, a warning, time or memory without end, a
distance that is no number, and another file or address that is opened. Escapes are printed once
each, by the smallest file that was found. ``--log`` keeps the counts so far, and ``--folder`` one
file of each escape. Each file is made from its number alone, so that ``--first`` goes on.

    parent: numbers ──> worker: good file ──broken──> limits, read, distances ──> counts | escape
       └── another worker from the next number on, if a file has killed it
"""

from __future__ import annotations

import argparse
import logging
import multiprocessing
import os
import random
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from multiprocessing.sharedctypes import RawValue
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import splinesdf as ss
from benchmarks.fuzz_seeds import seeds
from benchmarks.mutations import FONTS, mutated, smaller

READERS = (
    *(".svg", ".svgz", ".dxf", ".geojson", ".json", ".wkt", ".csv", ".dat"),
    *FONTS,
    ".npz",
)
# Seconds of processor time and bytes beyond what the process has, for one file.
_SECONDS, _BYTES = 10, 1 << 30
# Longer lines are not read by anyone.
_LONGEST_LINE = 500
# Inputs tried to make an escape smaller.
_TRIES = 150
# Files between two lines of the log, and between two looks at the memory.
_EVERY, _LOOKS = 2000, 50
# Seconds without a file read after which a process is ended: it waits for something.
_EVER = 300.0
_TEXTS = ("A", "g", "8", "g8")


class Task(NamedTuple):
    """A broken file."""

    content: bytes
    options: dict[str, Any]
    ask: bool  # for distances


@dataclass
class Tally:
    """What came of a reader's files."""

    total: int = 0
    read: int = 0
    refused: int = 0
    asked: int = 0
    longest: float = 0.0
    peak: float = 0.0
    kinds: Counter[str] = field(default_factory=Counter)
    escapes: dict[str, Task] = field(default_factory=dict)


# --- the process that reads ---------------------------------------------------------------------

_asked: list[str] = []


def _watch(event: str, arguments: tuple[Any, ...]) -> None:
    """Refuse what a reader has no business with, while it reads."""
    if not _asked:
        return
    if event in ("socket.connect", "socket.getaddrinfo", "subprocess.Popen", "os.system", "exec"):
        if event == "exec" and "site-packages" in getattr(arguments[0], "co_filename", ""):
            return  # modules, loaded when they are used
        if event == "exec" and getattr(arguments[0], "co_filename", "").startswith(sys.base_prefix):
            return
        if event == "exec" and "splinesdf" in getattr(arguments[0], "co_filename", ""):
            return
        if event == "exec" and getattr(arguments[0], "co_filename", "") == "<string>":
            return  # named tuples, which are made of text
        raise PermissionError(f"a reader does {event} {arguments!r:.80}")
    if event == "open" and isinstance(arguments[0], str):
        path = arguments[0]
        inner = (sys.prefix, sys.base_prefix, str(Path(ss.__file__).parent), "/proc", "<")
        if path not in _asked and not path.startswith(inner):
            raise PermissionError(f"a reader opens {path:.80}")


class _Logged(logging.Handler):
    """A library's message, which nobody asked for, as an error."""

    def emit(self, record: logging.LogRecord) -> None:
        raise RuntimeWarning(f"{record.name} logs {record.getMessage():.80}")


def _serve(connection: Connection, reader: str, asked: argparse.Namespace, shared: Shared) -> None:
    sys.addaudithook(_watch)
    warnings.simplefilter("error")
    logging.lastResort = _Logged()  # what is logged and has nowhere else to go
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # what libraries print
    good = seeds(reader)
    before = _resident()
    while True:
        wanted = connection.recv()
        if isinstance(wanted, Task):
            connection.send(_kind_of(reader, wanted, asked.place))
            continue
        for number in range(*wanted):
            shared.number.value = number
            task = _task(reader, number, good, asked)
            began = time.process_time()
            kind = _kind_of(reader, task, asked.place)
            shared.longest.value = max(shared.longest.value, time.process_time() - began)
            if kind == "read":
                shared.read.value += 1
                shared.asked.value += task.ask
            elif kind == "refused":
                shared.refused.value += 1
            else:
                connection.send((kind, number))
            if number % _LOOKS == 0:
                shared.peak.value = max(shared.peak.value, _resident() - before)
        connection.send(None)


def _limit() -> None:
    """Begin to count anew how much time and memory a file takes."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    ceiling = int(used.ru_utime + used.ru_stime) + _SECONDS + 1
    resource.setrlimit(resource.RLIMIT_CPU, (ceiling, resource.RLIM_INFINITY))
    have = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (have + _BYTES, resource.RLIM_INFINITY))


def _resident() -> float:
    """The most memory that this process has had, in MB."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1]) / 1024
    return 0.0


def _kind_of(reader: str, task: Task, place: str) -> str:
    """What came of a file: "read", "refused", or what escaped and where."""
    path = f"{place}{reader}"
    Path(path).write_bytes(task.content)
    _limit()
    _asked[:] = [path]
    try:
        return _read(reader, path, task.options, task.ask)
    except ss.InputError as error:
        line = str(error)
        if len(line.splitlines()) != 1 or len(line) > _LONGEST_LINE or not line.isprintable():
            return f"a message of {len(line)} characters: {line[:80]!r}"
        return "refused"
    except BaseException as error:
        frames = traceback.extract_tb(error.__traceback__)
        ours = [frame for frame in frames if "/splinesdf/" in frame.filename] or [frames[-1]]
        at = f"{Path(ours[-1].filename).name}:{ours[-1].lineno}"
        return f"{type(error).__name__} at {at}: {str(error)[:60]!r}"
    finally:
        _asked.clear()


def _read(reader: str, path: str, options: dict[str, Any], ask: bool) -> str:
    if reader == ".npz":
        spline = ss.load(path)
        x0, y0, x1, y1 = spline.mesh.domain
        points = _spread(np.array([x0, y0]), np.array([x1, y1]))
        if not np.isfinite(spline(points)).all():
            return "a value that is no number"
        shape = spline.shape
        if shape is None or not ask:
            return "read"
    else:
        shape = ss.read(path, **options)
    if any(len(note.splitlines()) > 1 for note in shape.notes):
        return "a note of several lines"
    if not ask:
        return "read"
    points = _spread(shape.control.min(axis=0), shape.control.max(axis=0))
    if not np.isfinite(ss.signed_distance(shape, points)).all():
        return "a distance that is no number"
    return "read"


def _spread(low: Any, high: Any) -> Any:
    """Points in and around a box."""
    share = np.array([[0.5, 0.5], [0.1, 0.8], [0.31, 0.47], [-0.5, 1.3], [0.0, 1.0]])
    return low + share * (high - low)


# --- the process that asks ----------------------------------------------------------------------


class Shared:
    """Numbers that the process that asks sees also after the one that reads was killed."""

    def __init__(self) -> None:
        self.number, self.read, self.refused, self.asked = (RawValue("q", 0) for _ in range(4))
        self.longest, self.peak = RawValue("d", 0.0), RawValue("d", 0.0)


class Worker:
    """A process that reads files, started anew if one has killed it."""

    def __init__(self, reader: str, asked: argparse.Namespace) -> None:
        self.shared = Shared()
        self._given = reader, asked, self.shared
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("fork")
        self._here, there = context.Pipe()
        self._process = context.Process(target=_serve, args=(there, *self._given), daemon=True)
        self._process.start()
        there.close()

    def kind_of(self, task: Task) -> str:
        self._here.send(task)
        answer: str = self._answer(6 * _SECONDS) or "no answer"
        return answer

    def escapes(self, first: int, last: int) -> Iterator[tuple[str, int]]:
        """Read the files of these numbers; those that escape, and how."""
        self._here.send((first, last))
        while (answer := self._answer(_EVER)) is not None:
            if isinstance(answer, str):  # it is gone, and there is another one
                number = self.shared.number.value
                yield answer, number
                self._here.send((number + 1, last))
            else:
                yield answer

    def _answer(self, seconds: float) -> Any:
        """What the process sends; a text of its own if it has ended or sits still."""
        number, began = self.shared.number.value, time.monotonic()
        try:
            while not self._here.poll(1.0):
                if self.shared.number.value != number:
                    number, began = self.shared.number.value, time.monotonic()
                if time.monotonic() - began > seconds:
                    self._process.kill()
                    raise EOFError
            return self._here.recv()
        except EOFError:
            self._process.join()
        code = self._process.exitcode
        self._start()
        return {
            -signal.SIGXCPU: f"more than {_SECONDS} s",
            -signal.SIGKILL: "no answer",
        }.get(code, f"the process ended with {code}")

    def stop(self) -> None:
        self._process.kill()


def _warm_up(folder: Path) -> None:
    """Load what is loaded only when it is used, once for all processes."""
    for reader in READERS:
        for content in seeds(reader)[:3]:
            path = folder / f"good{reader}"
            path.write_bytes(content)
            options = {"text": _TEXTS[-1]} if reader in FONTS else {}
            try:
                _read(reader, str(path), options, True)
            except ss.InputError:
                continue


def _options(reader: str, dice: random.Random) -> dict[str, Any]:
    """Options of `read`, most often none."""
    if reader in FONTS:
        return {"text": dice.choice(_TEXTS)}
    options: dict[str, Any] = {}
    if reader == ".npz" or dice.random() < 0.6:
        return options
    if dice.random() < 0.5:
        options["close"] = True
    if dice.random() < 0.3:
        options["fill"] = dice.choice(("nonzero", "evenodd"))
    if reader in (".svg", ".svgz") and dice.random() < 0.5:
        options["stroke"] = "centre"
    return options


def _task(reader: str, number: int, good: list[bytes], asked: argparse.Namespace) -> Task:
    """The broken file of a number."""
    dice = random.Random(f"{reader} {asked.seed} {number}")
    while True:
        content, other = dice.choice(good), dice.choice(good)
        try:
            broken = mutated(content, other, reader, dice)
        except (EOFError, OSError, zlib.error):
            continue
        return Task(broken, _options(reader, dice), dice.random() < asked.share)


def run(worker: Worker, reader: str, asked: argparse.Namespace) -> Tally:
    """Break and read so many files, or for so long."""
    tally, began, good = Tally(), time.monotonic(), seeds(reader)
    for first in range(asked.first, asked.count, _EVERY):
        last = min(first + _EVERY, asked.count)
        for kind, number in worker.escapes(first, last):
            tally.kinds[kind] += 1
            tally.escapes.setdefault(kind, _task(reader, number, good, asked))
        shared = worker.shared
        tally.read, tally.refused = shared.read.value, shared.refused.value
        tally.asked, tally.total = shared.asked.value, last - asked.first
        tally.longest, tally.peak = shared.longest.value, shared.peak.value
        if asked.log is not None:
            with asked.log.open("a") as log:
                log.write(f"{_line(reader, tally)} {list(tally.escapes)}\n")
        if time.monotonic() - began > asked.seconds:
            break
    return tally


_HEAD = "reader    inputs    read (asked) refused escapes  longest    peak"


def _line(reader: str, tally: Tally) -> str:
    return (
        f"{reader:8} {tally.total:7} {tally.read:7} {tally.asked:7} {tally.refused:7} "
        f"{tally.kinds.total():7} {tally.longest:6.2f} s {tally.peak:4.0f} MB"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--reader", nargs="+", default=READERS, choices=READERS)
    parser.add_argument("--first", type=int, default=0, help="number of the first file")
    parser.add_argument("--count", type=int, default=3000, help="number after the last one")
    parser.add_argument("--share", type=float, default=1.0, help="of files asked for distances")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=1e9, help="at most, for each reader")
    parser.add_argument("--folder", type=Path, help="where escapes are kept")
    parser.add_argument("--log", type=Path, help="where counts are kept on the way")
    asked = parser.parse_args()
    memory = Path("/dev/shm")  # files in memory, where there are some
    with tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else None) as name:
        asked.place = str(Path(name) / "broken")
        _warm_up(Path(name))
        print(_HEAD, flush=True)
        for reader in asked.reader:
            worker = Worker(reader, asked)
            tally = run(worker, reader, asked)
            print(_line(reader, tally), flush=True)
            for place, (kind, task) in enumerate(tally.escapes.items()):
                print(f"  {tally.kinds[kind]} times: {kind}", flush=True)
                content = _smallest(worker, kind, task)
                print(f"    with {task.options}: {content[:300]!r}", flush=True)
                if asked.folder is not None:
                    asked.folder.mkdir(exist_ok=True)
                    (asked.folder / f"escape{place}{reader}").write_bytes(content)
            worker.stop()


def _smallest(worker: Worker, kind: str, task: Task) -> bytes:
    """A small file that does the same."""
    if "more than" in kind:
        return task.content
    return smaller(
        task.content,
        lambda part: worker.kind_of(task._replace(content=part)) == kind,
        _TRIES,
    )


if __name__ == "__main__":
    main()
