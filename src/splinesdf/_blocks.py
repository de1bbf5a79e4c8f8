"""Work in blocks, on all processors that this process may use."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

# Points a thread takes at a time. Fewer: the pool's overhead shows (about 50 µs a block); more:
# the last block keeps one core busy alone, and a block's arrays leave the second-level cache.
_BLOCK = 8192


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def in_blocks(count: int, work: Callable[[slice], None], *, size: int = _BLOCK) -> None:
    """Call ``work(part)`` for slices of ``size`` that cover ``range(count)``.

    Kernels release the GIL, so the threads' work overlaps.
    """
    parts = [slice(first, min(first + size, count)) for first in range(0, count, size)]
    if len(parts) <= 1 or processors() == 1:
        for part in parts:
            work(part)
        return
    with ThreadPoolExecutor(processors()) as pool:
        list(pool.map(work, parts))  # the list raises what a block raised
