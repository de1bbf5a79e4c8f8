"""What compiling takes: a note when it begins, and its seconds, apart from those of the work."""

from __future__ import annotations

import logging
import time

from numba.core import event

_NOTE = "splinesdf: compiling what this work needs, and keeping it; this may take a minute"


class _Watch(event.Listener):
    """Numba tells what it compiles to objects of a class of its own.

    It compiles one kernel at a time in a process, under a lock, so that nothing else guards these
    numbers. A kernel's compilation includes those of the kernels that it calls.
    """

    seconds = 0.0
    depth = 0
    began: float | None = None

    def on_start(self, event: event.Event) -> None:
        if _is_ours(event):
            if not self.depth:
                if self.began is None:
                    logging.getLogger("splinesdf").warning(_NOTE)
                self.began = time.perf_counter()
            self.depth += 1

    def on_end(self, event: event.Event) -> None:
        if _is_ours(event):
            self.depth -= 1
            if not self.depth and self.began is not None:
                self.seconds += time.perf_counter() - self.began


_watch = _Watch()
event.register("numba:compile", _watch)  # type: ignore[no-untyped-call]


def seconds_compiling() -> float:
    """Seconds that this process has spent compiling kernels of the package so far.

    When the first of them begins, the logger "splinesdf" notes it.
    """
    return _watch.seconds


def _is_ours(one: event.Event) -> bool:
    return str(one.data["dispatcher"].py_func.__module__).startswith("splinesdf.")
