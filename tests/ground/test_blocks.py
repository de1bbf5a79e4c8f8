"""Work in blocks: all of it, once, also from within such work and in a forked process."""

from __future__ import annotations

import multiprocessing
import os
import sys
import warnings

import numpy as np
import pytest

from splinesdf.ground import blocks as _blocks
from splinesdf.ground.blocks import in_blocks, processors


def doubled(values: np.ndarray) -> np.ndarray:
    result = np.zeros_like(values)

    def work(part: slice) -> None:
        result[part] += 2.0 * values[part]

    in_blocks(len(values), work, size=10)
    return result


@pytest.fixture(autouse=True)
def _several_processors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_blocks, "processors", lambda: 3)


def test_processors_are_counted_where_a_process_cannot_be_bound_to_some(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As on Windows and macOS."""
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    for count, expected in ((5, 5), (None, 1)):
        monkeypatch.setattr(os, "cpu_count", lambda count=count: count)
        assert processors() == expected


@pytest.mark.parametrize("count", [0, 1, 9, 10, 11, 1000])
def test_every_part_once(count: int) -> None:
    values = np.arange(float(count))
    assert np.array_equal(doubled(values), 2.0 * values)


def test_work_may_itself_work_in_blocks() -> None:
    rows = np.arange(600.0).reshape(6, 100)
    result = np.zeros_like(rows)

    def work(part: slice) -> None:
        for row in range(part.start, part.stop):
            result[row] = doubled(rows[row])

    in_blocks(6, work, size=1)
    assert np.array_equal(result, 2.0 * rows)


def test_what_a_block_raises_is_raised() -> None:
    def work(part: slice) -> None:
        if part.start == 50:
            raise ValueError("block 5")

    with pytest.raises(ValueError, match="block 5"):
        in_blocks(100, work, size=10)
    assert doubled(np.ones(100)).sum() == 200.0  # the threads are none the worse for it


@pytest.mark.skipif(sys.platform == "win32", reason="there is no fork")
def test_a_forked_process_has_threads_of_its_own() -> None:
    doubled(np.ones(100))  # the parent's threads exist
    context = multiprocessing.get_context("fork")
    answers = context.Queue()
    child = context.Process(target=lambda: answers.put(doubled(np.ones(100)).sum()))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # 3.12: fork with threads
        child.start()
    assert answers.get(timeout=600) == 200.0
    child.join(60)
    assert child.exitcode == 0
