"""Terminals that are narrow, or know only ASCII: every command says all that it has to say."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import splinesdf as ss
from splinesdf.cli.main import commands, main

# How long it took, and of that how long to compile, which differs from run to run.
_SECONDS = re.compile(
    r"time\s+\S+\s+s(,\s+and\s+\S+\s+s\s+to\s+compile,\s+once)?|\"seconds(_compiling)?\": \S+"
)
COMMANDS: dict[str, tuple[str, ...]] = {
    "info": ("part",),
    "info of a fit": ("fit.npz",),
    "info of a name": ("é€.csv",),
    "fit": ("gamma1", "--tolerance", "0.0123456", "-o", "fit.npz"),
    "fit to bands": ("é€.csv", "--tolerance", "0.0123456", "--band", "0.1234567", "0.2345678"),
    "fit as json": ("gamma1", "--tolerance", "0.0123456", "--json"),
    "query": ("é€.csv", "points.csv"),
    "query to a file": ("fit.npz", "points.csv", "-o", "é.csv"),
    "offset": (
        *("part", "-d", "1.2345678", "-d", "-1000", "-o", "é.svg"),
        *("--check", "--tolerance", "0.0123456"),
    ),
    "texture": ("é€.csv", "-o", "é.png", "--range", "0.1234567"),
    "atlas": ("drawings é", "-o", "é.png", "--size", "12.345678"),
    "view": ("é€.csv", "--html", "é.html", "--tolerance", "0.05"),
    "paper": ("--tables",),
    "demo": ("-o", "hier é"),
    "completion": ("bash",),
}


def arguments(name: str) -> tuple[str, ...]:
    return name.split()[0], *COMMANDS[name]


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("prepared")
    (path / "é€.csv").write_text("0,0\n1,0\n1,1\n0,1\n")
    (path / "points.csv").write_text("0.5,0.25\n2,0.5\n")
    (path / "drawings é").mkdir()
    (path / "drawings é" / "ö€.svg").write_text('<svg><path d="M0 0h5v5H0z"/></svg>')
    ss.fit(ss.read(path / "é€.csv"), tolerance=0.05).spline.save(path / "fit.npz")
    return path


@pytest.fixture
def folder(prepared: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for file in prepared.iterdir():
        (shutil.copytree if file.is_dir() else shutil.copy)(file, tmp_path / file.name)
    return tmp_path


def test_every_command_is_here() -> None:
    assert {name.split()[0] for name in COMMANDS} == set(commands.commands)


@pytest.mark.parametrize("name", [*COMMANDS, "--help", "fit --help", "offset --help", "oops"])
def test_ascii(name: str, folder: Path) -> None:
    """A traceback once ended `info` and `fit`: of × and ² there is no ASCII."""
    words = arguments(name) if name in COMMANDS else name.split()
    done = subprocess.run(
        [sys.executable, "-m", "splinesdf", *words],
        cwd=folder,
        env={
            **os.environ,
            "PYTHONPATH": str(Path(ss.__file__).parents[1]),
            "PYTHONIOENCODING": "ascii",
            "LC_ALL": "C",
        },
        capture_output=True,
        check=False,
    )
    assert done.returncode == (2 if name == "oops" else 0), done.stderr
    assert b"Traceback" not in done.stderr
    assert done.stdout.isascii()
    assert b"?" not in done.stdout  # nor is anything lost


@pytest.mark.skipif(sys.platform == "win32", reason="names of files are texts there")
def test_a_name_that_is_no_text(folder: Path) -> None:
    name = os.fsdecode(b"\xff.csv")
    (folder / name).write_text("0,0\n1,0\n1,1\n")
    for words in (("info", name), ("fit", name, "-o", os.fsdecode(b"\xfe.npz"))):
        done = subprocess.run(
            [sys.executable, "-m", "splinesdf", *words],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(Path(ss.__file__).parents[1])},
            capture_output=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr


Run = Callable[..., str]


@pytest.fixture
def run(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    def at_width(width: int, *words: str) -> str:
        monkeypatch.setenv("COLUMNS", str(width))
        monkeypatch.setattr(sys, "argv", ["splinesdf", *words])
        with pytest.raises(SystemExit) as caught:
            main()
        assert not caught.value.code
        return capsys.readouterr().out

    return at_width


def words_of(text: str) -> list[str]:
    """What is printed, but for lines and spaces, and the time that it took."""
    return re.findall(r"[^\s│─╶╴╵╷]+", _SECONDS.sub("", text))


@pytest.mark.parametrize("name", COMMANDS)
def test_narrow(name: str, run: Run) -> None:
    """No number is cut, nor any other word, however narrow the terminal."""
    wide = words_of(run(500, *arguments(name)))
    assert len(wide) > 1
    # What takes seconds is shown to the narrowest only.
    for width in (1,) if name in ("demo", "paper") else (1, 40):
        assert words_of(run(width, *arguments(name))) == wide
