"""Terminals that are narrow, or know only ASCII: every command says all that it has to say."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

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
    "axis": ("part", "-o", "é.svg", "--tolerance", "0.0123456"),
    "thickness": ("part", "--count", "2"),
    "vcarve": ("é€.csv", "-o", "é.nc", "--tip", "0.0123456", "--check"),
    "batch": ("write", "é€.csv", "-o", "{name} é.svg", "-j", "1"),
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


# As `python -m splinesdf` would, one command after another: loading Python and the libraries takes
# longer than most commands. Each has its folder and, as files there, its output; "then" parts them.
_ONE_AFTER_ANOTHER = """
import os, runpy, sys, traceback

commands = [[]]
for word in sys.argv[1:]:
    commands.append([]) if word == "then" else commands[-1].append(word)
streams = (sys.stdout, sys.stderr)
asked_for = [stream.errors for stream in streams]
for folder, *words in commands:
    os.chdir(folder)
    sys.argv = ["splinesdf", *words]
    for stream, errors in zip(streams, asked_for):
        stream.reconfigure(errors=errors)
        file = os.open(stream.name.strip("<>"), os.O_WRONLY | os.O_CREAT)
        os.dup2(file, stream.fileno())
        os.close(file)
    try:
        runpy.run_module("splinesdf", run_name="__main__", alter_sys=False)
        status = 0
    except SystemExit as ended:
        status = ended.code or 0
    except BaseException:
        traceback.print_exc()
        status = 1
    for stream in streams:
        stream.flush()
    with open("status", "w") as file:
        file.write(str(status))
"""


class Done(NamedTuple):
    """How a command ended, and what it wrote."""

    status: int
    stdout: bytes
    stderr: bytes


def done_by_a_process(
    commands: Mapping[str, Sequence[str]], prepared: Path, folder: Path, **variables: str
) -> dict[str, Done]:
    """Each command's end, all run by one process, in copies of what is prepared."""
    words: list[str] = []
    for name, command in commands.items():
        shutil.copytree(prepared, folder / name)
        words += ["then", str(folder / name), *command]
    subprocess.run(
        [sys.executable, "-c", _ONE_AFTER_ANOTHER, *words[1:]],
        env={**os.environ, "PYTHONPATH": str(Path(ss.__file__).parents[1]), **variables},
        capture_output=True,
        check=True,
    )
    return {
        name: Done(
            int((folder / name / "status").read_text()),
            *((folder / name / stream).read_bytes() for stream in ("stdout", "stderr")),
        )
        for name in commands
    }


IN_ASCII = [*COMMANDS, "--help", "fit --help", "offset --help", "oops"]


@pytest.fixture(scope="module")
def in_ascii(prepared: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Done]:
    words = {name: arguments(name) if name in COMMANDS else name.split() for name in IN_ASCII}
    folder = tmp_path_factory.mktemp("in_ascii")
    return done_by_a_process(words, prepared, folder, PYTHONIOENCODING="ascii", LC_ALL="C")


@pytest.mark.parametrize("name", IN_ASCII)
def test_ascii(name: str, in_ascii: dict[str, Done]) -> None:
    """A traceback once ended `info` and `fit`: of × and ² there is no ASCII."""
    done = in_ascii[name]
    assert done.status == (2 if name == "oops" else 0), done.stderr
    assert b"Traceback" not in done.stderr
    assert done.stdout.isascii()
    assert b"?" not in done.stdout  # nor is anything lost


@pytest.mark.skipif(sys.platform == "win32", reason="names of files are texts there")
def test_a_name_that_is_no_text(tmp_path: Path) -> None:
    name = os.fsdecode(b"\xff.csv")
    (tmp_path / "drawn").mkdir()
    (tmp_path / "drawn" / name).write_text("0,0\n1,0\n1,1\n")
    commands = {"info": ("info", name), "fit": ("fit", name, "-o", os.fsdecode(b"\xfe.npz"))}
    for done in done_by_a_process(commands, tmp_path / "drawn", tmp_path).values():
        assert done.status == 0, done.stderr


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


# What takes long and knows nothing of the width: done for the first only.
LONG = {
    "demo": (("splinesdf.cli.demo", "fitted"), ("splinesdf.cli.demo", "draw")),
    "paper": (("splinesdf.paper.tables", "tables"),),
    "batch": (("splinesdf", "batch"),),  # and the second time it would be kept
}


def once(function: Callable[..., Any]) -> Callable[..., Any]:
    """What a function answered first, however often it is asked the same."""
    answers: list[Any] = []

    def answer(*arguments: Any, **options: Any) -> Any:
        if not answers:
            found = function(*arguments, **options)
            answers.append(list(found) if isinstance(found, Iterator) else found)
        return answers[0]

    return answer


@pytest.mark.parametrize("name", COMMANDS)
def test_narrow(name: str, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """No number is cut, nor any other word, however narrow the terminal."""
    for module, function in LONG.get(name, ()):
        place = import_module(module)
        monkeypatch.setattr(place, function, once(getattr(place, function)))
    wide = words_of(run(500, *arguments(name)))
    assert len(wide) > 1
    for width in (1, 40):
        assert words_of(run(width, *arguments(name))) == wide
