"""Work on many points in blocks, on all cores."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

# Points a thread takes at a time. Fewer: the pool's overhead shows (about 50 µs a block); more:
# the last block keeps one core busy alone, and a block's arrays leave the second-level cache.
_BLOCK = 8192


def in_blocks(count: int, work: Callable[[slice], None]) -> None:
    """Call ``work(part)`` for slices that cover ``range(count)``; kernels release the GIL."""
    parts = [slice(first, min(first + _BLOCK, count)) for first in range(0, count, _BLOCK)]
    if len(parts) <= 1:
        for part in parts:
            work(part)
        return
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(work, parts))  # the list raises what a block raised
