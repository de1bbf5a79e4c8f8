"""Work in blocks, on all processors that this process may use."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from threading import current_thread

# Points a thread takes at a time. Fewer: the pool's overhead shows (about 50 µs a block); more:
# the last block keeps one core busy alone, and a block's arrays leave the second-level cache.
_BLOCK = 8192
_NAME = "splinesdf-blocks"
_ALONE: ContextVar[bool] = ContextVar("alone", default=False)


@contextmanager
def alone() -> Iterator[None]:
    """Have this thread do all its blocks itself: other processes have the other processors."""
    before = _ALONE.set(True)
    try:
        yield
    finally:
        _ALONE.reset(before)


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@cache
def _pool(workers: int) -> ThreadPoolExecutor:
    """Threads that stay: to make them anew can take longer than the work."""
    return ThreadPoolExecutor(workers, thread_name_prefix=_NAME)


if hasattr(os, "register_at_fork"):  # pragma: no branch: Windows has no fork
    # A child process has none of its parent's threads.
    os.register_at_fork(after_in_child=_pool.cache_clear)


def in_blocks(count: int, work: Callable[[slice], None], *, size: int = _BLOCK) -> None:
    """Call ``work(part)`` for slices of ``size`` that cover ``range(count)``.

    Kernels release the GIL, so the threads' work overlaps. Called from within such work, it does
    all of it itself: threads that wait for each other would wait forever.
    """
    parts = [slice(first, min(first + size, count)) for first in range(0, count, size)]
    workers = processors()
    within = _ALONE.get() or current_thread().name.startswith(_NAME)
    if len(parts) <= 1 or workers == 1 or within:
        for part in parts:
            work(part)
        return
    list(_pool(workers).map(work, parts))  # the list raises what a block raised
