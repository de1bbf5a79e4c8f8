"""Processes of this machine that do items: one thread of ours waits for each.

    items ─→ thread ─→ pickle on stdin ─→ process: `serve` ─→ pickle on stdout ─→ row

A process that dies takes its item with it and no other; the next item gets a new one. If we die,
stdin ends, and each process ends after the item that it is at. They are programs of their own and
not forks, as ours has threads, nor children of `multiprocessing`, which run the caller's script
again.
"""

from __future__ import annotations

import logging
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from splinesdf.batches.item import BatchRow, Item, done
from splinesdf.errors import SplineSDFError

_PROGRAM = """
import sys
sys.path[:] = {path!r}
from splinesdf.batches.workers import serve
serve({first})
"""
_READY = "ready"


def serve(first: bool = True) -> None:
    """Answer items on stdin by rows on stdout, until stdin ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # for who started us to say
    items, rows = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no row
    if not first:  # that it compiles is said once
        logging.getLogger("splinesdf").setLevel(logging.ERROR)
    try:
        pickle.dump(_READY, rows)
        rows.flush()
        while True:
            row = done(pickle.load(items))
            pickle.dump(row, rows)
            rows.flush()
    except (EOFError, BrokenPipeError):
        return


class _Process:
    """A process, started anew after it died."""

    def __init__(self, first: bool) -> None:
        self.first = first
        self.running: subprocess.Popen[bytes] | None = None

    def ask(self, item: Item) -> BatchRow:
        """The row of an item; that of a failure if the process dies over it."""
        process = self.running = self.running or self._start()
        assert process.stdin is not None and process.stdout is not None  # noqa: PT018
        try:
            pickle.dump(item, process.stdin)
            process.stdin.flush()
            row = pickle.load(process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            how = self.end()
            return BatchRow(item.name, item.output, "failed", f"its process ended {how}")
        assert isinstance(row, BatchRow)
        return row

    def _start(self) -> subprocess.Popen[bytes]:
        program = _PROGRAM.format(path=sys.path, first=self.first)
        process = subprocess.Popen(
            [sys.executable, "-c", program],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            # Each has a processor of its own.
            env={"OMP_NUM_THREADS": "1", **os.environ},
        )
        assert process.stdout is not None
        try:
            ready: Any = pickle.load(process.stdout)
        except (EOFError, pickle.UnpicklingError):
            ready = None
        if ready != _READY:
            process.kill()
            process.wait()
            raise SplineSDFError(f"cannot start {sys.executable!r} as a process of the batch")
        return process

    def end(self) -> str:
        """End the process, at once, and say how it had ended by itself."""
        process, self.running = self.running, None
        if process is None:
            return ""
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with suppress(OSError):
                    stream.close()
        try:
            code = process.wait(timeout=1.0)
        except subprocess.TimeoutExpired:
            process.kill()
            code = process.wait()
        if code >= 0:
            return f"with status {code}"
        out = "; is there enough memory?" if -code == signal.SIGKILL else ""
        return f"by {signal.Signals(-code).name}{out}"


def rows_here(items: Iterator[Item], workers: int) -> Iterator[BatchRow]:
    """The rows of items, as they come, by so many processes; as many items are under way.

    If the caller stops asking, the processes are killed: what they were at is not written.
    """
    rows: queue.SimpleQueue[BatchRow | BaseException | None] = queue.SimpleQueue()
    lock, stopped = threading.Lock(), threading.Event()
    processes = [_Process(first=k == 0) for k in range(workers)]

    def work(process: _Process) -> None:
        try:
            while not stopped.is_set():
                with lock:
                    item = next(items, None)
                if item is None:
                    break
                rows.put(process.ask(item))
        except BaseException as error:
            rows.put(error)
        finally:
            process.end()
            rows.put(None)

    threads = [threading.Thread(target=work, args=(p,), daemon=True) for p in processes]
    for thread in threads:
        thread.start()
    try:
        left = workers
        while left:
            found = rows.get()
            if isinstance(found, BaseException):
                raise found
            if found is None:
                left -= 1
            else:
                yield found
    finally:
        stopped.set()
        for process in processes:
            if (running := process.running) is not None:
                running.kill()
        for thread in threads:
            thread.join()
