"""What benchmarks have in common: answers to a question side by side, as Markdown; the machine.

A ratio is always a peer's seconds over ours, both of the same run: above 1 we are quicker.
"""

from __future__ import annotations

import math
import os
import platform
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path

OURS = "splinesdf"
ROOT = Path(__file__).parents[1]
RATIO = "peer / ours"


@dataclass(frozen=True)
class Entry:
    """What one contestant did for one question."""

    question: str
    who: str
    seconds: float  # CPU seconds of one core, a median
    error: float | None = None  # as the section says
    size: str = ""  # of the answer, or of what it takes
    note: str = ""


@dataclass(frozen=True)
class Table:
    """Cells by rows: words, numbers, or None for what there is not."""

    head: tuple[str, ...]
    rows: tuple[tuple[str | float | None, ...], ...]


def clock() -> float:
    """Seconds of CPU if this process is bound to one core when it first asks, else of the clock."""
    return _timer()()


@cache
def _timer() -> Callable[[], float]:
    # Looked up once: to ask for the cores takes longer than to read the time.
    alone = hasattr(os, "sched_getaffinity") and len(os.sched_getaffinity(0)) == 1
    return time.process_time if alone else time.perf_counter


def ratio(peer: float, ours: float) -> float:
    """Give a peer's seconds over ours."""
    if not (math.isfinite(peer) and math.isfinite(ours) and peer > 0.0 and ours > 0.0):
        raise ValueError(f"expected seconds above zero, got {peer} of a peer and {ours} of ours")
    return peer / ours


def ratios(entries: Sequence[Entry]) -> list[float | None]:
    """Give each entry's ratio to ours of the same question; None for ours and where we have none.

    Another way of ours, as "splinesdf, adaptive fit", is no peer.
    """
    own = {entry.question: entry.seconds for entry in entries if entry.who == OURS}
    return [
        ratio(entry.seconds, own[entry.question])
        if not entry.who.startswith(OURS) and entry.question in own
        else None
        for entry in entries
    ]


def compared(
    entries: Sequence[Entry], *, unit: str, scale: float, error: str = "error", size: str = "size"
) -> Table:
    """Lay entries out as a table, seconds times a scale in a unit; empty columns are left out."""
    head = ["question", "who", unit, RATIO, error, size, "note"]
    rows: list[list[str | float | None]] = [
        [one.question, one.who, one.seconds * scale, share, one.error, one.size, one.note]
        for one, share in zip(entries, ratios(entries), strict=True)
    ]
    kept = [k for k in range(len(head)) if k < 4 or any(row[k] not in (None, "") for row in rows)]
    return Table(tuple(head[k] for k in kept), tuple(tuple(row[k] for k in kept) for row in rows))


def lost(entries: Sequence[Entry]) -> list[tuple[float, Entry]]:
    """List the entries of peers that are quicker than we are, the worst for us first."""
    found = [
        (share, entry)
        for entry, share in zip(entries, ratios(entries), strict=True)
        if share is not None and share < 1.0
    ]
    return sorted(found, key=lambda pair: pair[0])


def markdown(table: Table) -> str:
    """Write a table as Markdown; words to the left, numbers to the right."""
    count = len(table.head)
    if any(len(row) != count for row in table.rows):
        raise ValueError(f"expected {count} cells a row, got {[len(row) for row in table.rows]}")
    numbers = [
        bool(table.rows) and all(not isinstance(row[k], str) for row in table.rows)
        for k in range(count)
    ]
    lines = [_line(table.head), _line(["--:" if number else "---" for number in numbers])]
    lines += [_line([_cell(value) for value in row]) for row in table.rows]
    return "\n".join(lines)


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def _cell(value: str | float | None) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if not math.isfinite(value):
        raise ValueError(f"expected a finite number in a table, got {value}")
    if isinstance(value, int) or abs(value) >= 1e3:
        return f"{value:,.0f}" if abs(value) < 1e9 else f"{value:.1e}"
    return f"{value:.2e}" if 0.0 < abs(value) < 0.01 else f"{value:.3g}"


def machine(libraries: Sequence[str]) -> list[str]:
    """Describe what a report ran on, a line each: date, commit, processor, load, versions."""
    load = f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown"
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    found, absent = [], []
    for name in libraries:
        try:
            found.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            absent.append(name)
    lines = [
        f"date: {time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime())}",
        f"commit: {_commit()}",
        f"processor: {_processor()}; {os.cpu_count()} cores, {cores} for this process; load {load}",
        f"system: {platform.system()} {platform.machine()}, Python {platform.python_version()}",
        f"versions: {', '.join(found)}",
    ]
    return [*lines, f"not installed: {', '.join(absent)}"] if absent else lines


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def _commit() -> str:
    """Name the commit, and say whether the package differs from it."""
    try:
        name = _git("rev-parse", "--short", "HEAD")
        changed = _git("status", "--porcelain", "--", "src", "benchmarks")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return f"{name}, with changes" if changed else name


def _git(*words: str) -> str:
    done = subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True, text=True)
    return done.stdout.strip()
