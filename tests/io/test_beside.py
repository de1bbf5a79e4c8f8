"""Readers and writers beside one another: what others do to a file between any two steps."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.ground.atomic import atomic_file, write_text
from splinesdf.meshes import Grid
from tests.named_shapes import UNIT
from tests.saving import before_line, fit_with_shape

OLD = 7200.0  # seconds: left over for longer than any write pauses


def between_all_lines(
    prepare: Callable[[], object], run: Callable[[], object], act: Callable[[], object]
) -> int:
    """Run again and again, each time with something done before a later line; how many lines."""
    number, reached = 0, True
    while reached:
        prepare()
        with before_line(number, act) as left:
            run()
        reached = left[0] < 0
        number += 1
    return number


SIZES = {"small": 1, "large": 20}


@pytest.mark.parametrize(("first", "second"), [("small", "large"), ("large", "small")])
def test_a_reader_beside_a_writer(first: str, second: str, tmp_path: Path) -> None:
    """Whenever the file is replaced, by a shorter or a longer one, one of the two is read."""
    path, other = tmp_path / "fit.npz", tmp_path / "other.npz"
    bytes_of = {}
    for name, side in SIZES.items():
        ss.SplineSDF(Grid.uniform(UNIT, side, side), np.full((side**2, 8), float(side))).save(other)
        bytes_of[name] = other.read_bytes()

    def prepare() -> None:
        path.write_bytes(bytes_of[first])
        other.write_bytes(bytes_of[second])

    def read() -> None:
        found = ss.load(path).ordinates
        assert any(np.array_equal(found, np.full((n**2, 8), float(n))) for n in SIZES.values())

    assert between_all_lines(prepare, read, lambda: other.replace(path)) > 500


def test_a_writer_beside_a_remover(tmp_path: Path) -> None:
    """Whenever the old file vanishes, the new one is written."""
    path = tmp_path / "a.txt"

    def write() -> None:
        write_text(path, "new")

    lines = between_all_lines(
        lambda: path.write_text("old"), write, lambda: path.unlink(missing_ok=True)
    )
    assert lines > 20
    write()
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]  # noqa: PTH208


def hidden(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if path.name.startswith(".")]


def age(path: Path, seconds: float = OLD) -> None:
    then = path.stat().st_mtime - seconds
    os.utime(path, (then, then))


# Opens a file to write and waits to be ended.
WRITER = """
import sys, time
from splinesdf.ground.atomic import atomic_file

with atomic_file(sys.argv[1]) as file:
    file.write(b"half")
    file.flush()
    print("open", flush=True)
    time.sleep(600)
"""


@contextlib.contextmanager
def writer(path: Path) -> Iterator[subprocess.Popen[bytes]]:
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path)],
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(Path(ss.__file__).parents[1])},
    ) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == b"open\n"
            yield process
        finally:
            process.kill()


def test_what_a_killed_process_left_is_swept(tmp_path: Path) -> None:
    with writer(tmp_path / "a.npz") as process:
        process.kill()
        process.wait()
    (left,) = hidden(tmp_path)
    write_text(tmp_path / "b.txt", "young: its writer might be on another machine")
    assert hidden(tmp_path) == [left]
    age(left)
    write_text(tmp_path / "b.txt", "old")
    assert not hidden(tmp_path)


def test_what_a_living_process_writes_is_left(tmp_path: Path) -> None:
    """However old, and in this process, too."""
    with writer(tmp_path / "a.npz"), atomic_file(tmp_path / "here.txt") as file:
        file.write(b"whole")
        file.flush()
        for path in hidden(tmp_path):
            age(path)
        assert len(hidden(tmp_path)) == 2
        write_text(tmp_path / "b.txt", "x")
        assert len(hidden(tmp_path)) == 2
    assert (tmp_path / "here.txt").read_bytes() == b"whole"


def test_what_is_not_ours_is_left(tmp_path: Path) -> None:
    names = [".0123456789abcdef.tmp", ".splinesdf", ".splinesdf-notes.tmp", "splinesdf.tmp"]
    for name in names:
        (tmp_path / name).write_text("mine")
        age(tmp_path / name)
    (tmp_path / ".splinesdf-0123456789abcdef.tmp").mkdir()
    age(tmp_path / ".splinesdf-0123456789abcdef.tmp")
    write_text(tmp_path / "b.txt", "x")
    assert len(os.listdir(tmp_path)) == 6  # noqa: PTH208


def test_what_cannot_be_swept_is_in_nobodys_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    left = tmp_path / ".splinesdf-0123456789abcdef.tmp"
    left.write_bytes(b"PK half a file")
    age(left)

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "unlink", refuse)
    monkeypatch.setattr(os, "remove", refuse)
    spline = fit_with_shape()
    path = tmp_path / "fit.npz"
    dataclasses.replace(spline, ordinates=spline.ordinates + 1.0).save(path)
    assert left.exists()
    assert np.array_equal(ss.load(path).ordinates, spline.ordinates + 1.0)
