"""Interrupted, killed or out of space while saving: under the name is a whole file, old or new."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid
from tests.named_shapes import UNIT
from tests.saving import before_line, fit_with_shape

# Saves one large fit after the other under the same name; fit k has the ordinates k.
SAVER = """
import signal, sys
import numpy as np
import splinesdf as ss
from tests.saving import full_tree

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
tree = full_tree(7)
for k in range(10**6):
    ss.SplineSDF(tree, np.full((4**8, 8), float(k))).save(sys.argv[1])
    if k == 0:
        print("saved", flush=True)
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_killed_at_any_moment(number: signal.Signals, tmp_path: Path) -> None:
    path = tmp_path / "fit.npz"
    rng = np.random.default_rng(int(number))
    left_over, runs = 0, 5
    for _ in range(runs):
        with subprocess.Popen(
            [sys.executable, "-c", SAVER, str(path)],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=Path(__file__).parents[2],
        ) as saver:
            assert saver.stdout is not None
            assert saver.stdout.readline() == b"saved\n"
            while True:
                time.sleep(rng.uniform(0.0, 0.03))  # a save takes about 0.03 s
                saver.send_signal(signal.SIGSTOP)
                os.waitpid(saver.pid, os.WUNTRACED)
                if len(list(tmp_path.iterdir())) > 1:  # it is stopped while it writes
                    break
                saver.send_signal(signal.SIGCONT)
            saver.send_signal(number)
            saver.send_signal(signal.SIGCONT)
            saver.wait()
        ordinates = ss.load(path).ordinates
        assert len(ordinates) == 4**8
        assert np.ptp(ordinates) == 0.0
        others = [other for other in tmp_path.iterdir() if other != path]
        left_over += len(others)
        # What is left stands beside the file, hidden, and in the way of nothing: the next save
        # has another name for its own.
        assert all(other.name.startswith(".") and other.suffix == ".tmp" for other in others)
        for other in others:
            other.unlink()
    assert left_over == (runs if number == signal.SIGKILL else 0)


# What is thrown away may say on stderr that it could not be finished: at 9 lines of zipfile.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_interrupted_at_every_line(tmp_path: Path) -> None:
    """A KeyboardInterrupt before any line of ours or of zipfile that a save runs."""
    path = tmp_path / "fit.npz"
    old = ss.SplineSDF(Grid.uniform(UNIT, 1, 1), np.zeros((1, 8)))
    new = dataclasses.replace(old, ordinates=old.ordinates + 1.0)
    old.save(path)
    before = path.read_bytes()
    new.save(path)
    after = path.read_bytes()
    number, reached = 0, True
    while reached:
        path.write_bytes(before)
        with before_line(number, interrupt) as left, contextlib.suppress(KeyboardInterrupt):
            new.save(path)
        reached = left[0] < 0
        now = path.read_bytes()
        assert now in (before, after)
        assert [other.name for other in tmp_path.iterdir()] == ["fit.npz"]
        number += 1
    assert now == after
    assert number > 1000  # there were so many lines


def interrupt() -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.999])
def test_no_space_left(share: float, tmp_path: Path) -> None:
    """By the system's own limit on the length of a file, as no disk is full here."""
    path = tmp_path / "fit.npz"
    spline = fit_with_shape()
    spline.save(path)
    before = path.read_bytes()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(share * len(before)), hard))
    try:
        with pytest.raises(ss.InputError, match=r"^cannot write '.*fit\.npz': File too large$"):
            dataclasses.replace(spline, ordinates=spline.ordinates + 1.0).save(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["fit.npz"]  # noqa: PTH208
