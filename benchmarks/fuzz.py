"""Does every broken file give one clear line? Files are broken at random, and read under limits.

    python -m benchmarks.fuzz [--reader .svg .dxf ...] [--count 3000] [--seed 0] [--folder FOLDER]

Each is read in a process that is used again, with 10 s and 1 GB for each file, with warnings as
errors, and if it is read, distances are asked for, so that its boundary is made. Right is an
`InputError` of one line, or a shape whose distances are numbers. An escape is anything else:
another exception, a warning, time or memory without end, a distance that is no number, and another
file or address that is opened. Escapes are printed once each, by the smallest file that was found.

    parent: good files ──broken──> worker: limits, read, distances ──> read | refused | escape
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import random
import resource
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
from pathlib import Path
from typing import Any

import numpy as np

import splinesdf as ss
from benchmarks.fuzz_seeds import seeds
from benchmarks.mutations import mutated, smaller

READERS = (
    *(".svg", ".svgz", ".dxf", ".geojson", ".json", ".wkt", ".csv", ".dat", ".ttf", ".woff2"),
    ".npz",
)
# Seconds of processor time and bytes beyond what the process has, for one file.
_SECONDS, _BYTES = 10, 1 << 30
# Longer lines are not read by anyone.
_LONGEST_LINE = 500
# Inputs tried to make an escape smaller.
_TRIES = 150
_TEXT = "Ag8"


@dataclass
class Answer:
    """What came of a file."""

    kind: str  # "read", "refused", or what escaped and where
    seconds: float = 0.0
    megabytes: float = 0.0


@dataclass
class Tally:
    """What came of a reader's files."""

    counts: Counter[str] = field(default_factory=Counter)
    escapes: dict[str, tuple[bytes, dict[str, Any]]] = field(default_factory=dict)
    longest: float = 0.0
    peak: float = 0.0


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


def _serve(connection: Connection) -> None:
    sys.addaudithook(_watch)
    warnings.simplefilter("error")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # what libraries print
    while True:
        reader, path, options = connection.recv()
        used = resource.getrusage(resource.RUSAGE_SELF)
        ceiling = int(used.ru_utime + used.ru_stime) + _SECONDS + 1
        resource.setrlimit(resource.RLIMIT_CPU, (ceiling, resource.RLIM_INFINITY))
        have = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (have + _BYTES, resource.RLIM_INFINITY))
        Path("/proc/self/clear_refs").write_text("5")
        before = _resident()
        began = time.process_time()
        kind = _kind_of(reader, path, options)
        seconds = time.process_time() - began
        resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        connection.send(Answer(kind, seconds, max(0.0, _resident() - before)))


def _resident() -> float:
    """The most memory since it was last asked to begin anew, in MB."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1]) / 1024
    return 0.0


def _kind_of(reader: str, path: str, options: dict[str, Any]) -> str:
    _asked[:] = [path]
    try:
        return _read(reader, path, options)
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


def _read(reader: str, path: str, options: dict[str, Any]) -> str:
    if reader == ".npz":
        spline = ss.load(path)
        x0, y0, x1, y1 = spline.mesh.domain
        points = _spread(np.array([x0, y0]), np.array([x1, y1]))
        if not np.isfinite(spline(points)).all():
            return "a value that is no number"
        shape = spline.shape
        if shape is None:
            return "read"
    else:
        shape = ss.read(path, **options)
    if any(len(note.splitlines()) > 1 for note in shape.notes):
        return "a note of several lines"
    points = _spread(shape.control.min(axis=0), shape.control.max(axis=0))
    if not np.isfinite(ss.signed_distance(shape, points)).all():
        return "a distance that is no number"
    return "read"


def _spread(low: Any, high: Any) -> Any:
    """Points in and around a box."""
    share = np.array([[0.5, 0.5], [0.1, 0.8], [0.31, 0.47], [-0.5, 1.3], [0.0, 1.0]])
    return low + share * (high - low)


# --- the process that asks ----------------------------------------------------------------------


class Worker:
    """A process that reads files, started anew if one has killed it."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._process = folder, None
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("fork")
        self._here, there = context.Pipe()
        self._process = context.Process(target=_serve, args=(there,), daemon=True)
        self._process.start()
        there.close()

    def answer(self, content: bytes, reader: str, options: dict[str, Any]) -> Answer:
        path = self._folder / f"broken{reader}"
        path.write_bytes(content)
        self._here.send((reader, str(path), options))
        try:
            if self._here.poll(6 * _SECONDS):
                return self._here.recv()
            kind = "no answer"
            self._process.kill()
        except EOFError:
            kind = "killed"
        self._process.join()
        if self._process.exitcode == -24:  # SIGXCPU
            kind = f"more than {_SECONDS} s"
        elif kind == "killed":
            kind = f"the process ended with {self._process.exitcode}"
        self._start()
        return Answer(kind, float(_SECONDS))

    def stop(self) -> None:
        self._process.kill()


def _warm_up(folder: Path) -> None:
    """Load what is loaded only when it is used, once for all processes."""
    for reader in READERS:
        for content in seeds(reader)[:3]:
            path = folder / f"good{reader}"
            path.write_bytes(content)
            options = {"text": _TEXT} if reader in (".ttf", ".woff2") else {}
            try:
                _read(reader, str(path), options)
            except ss.InputError:
                continue


def _options(reader: str, dice: random.Random) -> dict[str, Any]:
    """Options of `read`, most often none."""
    if reader in (".ttf", ".woff2"):
        return {"text": _TEXT}
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


def _inputs(reader: str, seed: int) -> Iterator[tuple[bytes, dict[str, Any]]]:
    dice = random.Random(f"{reader} {seed}")
    good = seeds(reader)
    while True:
        content, other = dice.choice(good), dice.choice(good)
        try:
            yield mutated(content, other, reader, dice), _options(reader, dice)
        except (EOFError, OSError, zlib.error):
            continue


def run(worker: Worker, reader: str, count: int, seed: int, seconds: float) -> Tally:
    """Break and read so many files, or for so long."""
    tally, began = Tally(), time.monotonic()
    for content, options in _inputs(reader, seed):
        answer = worker.answer(content, reader, options)
        tally.counts[answer.kind] += 1
        tally.longest = max(tally.longest, answer.seconds)
        tally.peak = max(tally.peak, answer.megabytes)
        if answer.kind not in ("read", "refused") and answer.kind not in tally.escapes:
            tally.escapes[answer.kind] = content, options
        if tally.counts.total() >= count or time.monotonic() - began > seconds:
            break
    return tally


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--reader", nargs="+", default=READERS, choices=READERS)
    parser.add_argument("--count", type=int, default=3000, help="files of each reader")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=1e9, help="at most, for each reader")
    parser.add_argument("--folder", type=Path, help="where escapes are kept")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _warm_up(folder)
        worker = Worker(folder)
        print("reader    inputs    read refused escapes  longest    peak", flush=True)
        for reader in asked.reader:
            tally = run(worker, reader, asked.count, asked.seed, asked.seconds)
            total, counts = tally.counts.total(), tally.counts
            escaped = total - counts["read"] - counts["refused"]
            print(
                f"{reader:8} {total:7} {counts['read']:7} {counts['refused']:7} {escaped:7} "
                f"{tally.longest:6.2f} s {tally.peak:4.0f} MB",
                flush=True,
            )
            for number, (kind, (content, options)) in enumerate(tally.escapes.items()):
                _report(worker, reader, number, kind, content, options, counts[kind], asked.folder)
        worker.stop()


def _report(
    worker: Worker,
    reader: str,
    number: int,
    kind: str,
    content: bytes,
    options: dict[str, Any],
    times: int,
    folder: Path | None,
) -> None:
    """Print an escape by a small file that does the same."""
    if "more than" not in kind:
        content = smaller(
            content, lambda part: worker.answer(part, reader, options).kind == kind, _TRIES
        )
    print(f"  {kind}, {times} times, with {options}: {content[:300]!r}", flush=True)
    if folder is not None:
        folder.mkdir(exist_ok=True)
        (folder / f"escape{number}{reader}").write_bytes(content)


if __name__ == "__main__":
    main()
