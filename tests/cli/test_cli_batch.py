"""`splinesdf batch`: options reach the functions, failures are told, statuses are right."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import splinesdf as ss
from splinesdf.cli.main import main

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    monkeypatch.chdir(tmp_path)
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text("x,y\n0,0\n2,0\n2,1\n0,1\n")

    def command(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["splinesdf", "batch", *arguments])
        with pytest.raises(SystemExit) as caught:
            main()
        return int(caught.value.code or 0), *capsys.readouterr()

    return command


def test_a_batch_and_again(run: Run) -> None:
    asked = ("offset", "a.csv", "none.csv", "-d", "0.5", "-o", "{name}-{index}.svg", "-j", "1")
    status, printed, errors = run(*asked)
    assert (status, printed) == (1, "1 written, 1 failed\n")
    assert errors == "splinesdf: none.csv: the file does not exist in '.'\n"
    status, printed, _ = run(*asked, "--json")
    rows = json.loads(printed)["rows"]
    assert status == 1
    assert [(row["output"], row["status"]) for row in rows] == [
        ("a-0.svg", "kept"),
        ("none-1.svg", "failed"),
    ]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What `batch` is called with, in place of its work."""
    calls: list[Any] = []

    def called(*given: Any, **options: Any) -> ss.BatchReport:
        del options["progress"], options["reading"]
        calls.append((given, {name: v for name, v in options.items() if v is not None}))
        return ss.BatchReport(())

    monkeypatch.setattr(ss, "batch", called, raising=False)
    return calls


def test_options(run: Run, asked: list[Any]) -> None:
    """Zero is handed on, to be refused, and nothing that was not given is."""
    usual = ("a.csv", "b.csv", "-o", "{name}.x")
    files, none = ("a.csv", "b.csv"), {"writing": {}, "overwrite": False}
    for words, job, options in (
        (("offset", "-d", "1", "-d", "2", "--tolerance", "0"), "offset", {"distances": [1.0, 2.0]}),
        (("offset", "--step", "0", "--coarse", "--tolerance", "0"), "offset", {"step": 0.0}),
        (("fit", "--tolerance", "0", "--band", "0", "1"), "fit", {"band": [(0.0, 1.0)]}),
        (("fit", "--tolerance", "0", "--max-cells", "7"), "fit", {"max_cells": 7}),
    ):
        run(*words, *usual)
        more = {"coarse": True} if "--coarse" in words else {}
        assert asked.pop() == ((files, job, "{name}.x"), {"tolerance": 0.0} | options | none | more)
    run("grid", *usual, "--nodes", "5", "6", "--max-distance", "0", "--overwrite", "-j", "3")
    told = {"nx": (5, 6), "max_distance": 0.0, "workers": 3, "overwrite": True, "writing": {}}
    assert asked.pop() == ((files, "grid", "{name}.x"), told)
    run("write", *usual, "--tolerance", "0", "--arcs", "--units", "mm")
    assert asked.pop()[1]["writing"] == {"tolerance": 0.0, "arcs": True, "units": "mm"}


def test_help_lists_the_jobs_in_the_order_of_their_sentence(run: Run) -> None:
    status, printed, _ = run("--help")
    assert status == 0
    jobs = re.findall(r"^  (offset|fit|grid|write) ", printed, re.MULTILINE)
    assert jobs == ["offset", "fit", "grid", "write"]


def test_interrupted(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(ss, "batch", stopped, raising=False)
    status, printed, errors = run("write", "a.csv", "-o", "{name}.svg")
    assert (status, printed) == (130, "")
    assert errors == "splinesdf: interrupted; the same command does what is left\n"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("offset", "a.csv", "x/a.svg", "-d", "1", "-o", "{name}.dxf"), "expected different names"),
        (("offset", "a.csv", "-d", "1", "-o", "a.dxf"), "{name} or {index}"),
        (("offset", "a.csv", "-o", "{name}.dxf"), "expected distances or step"),
        (("offset", "a.csv", "-d", "1"), "expected --output, got none"),
        (("write", "a.csv", "-o", "{name}.csv"), "is an input"),
    ],
)
def test_refused(words: tuple[str, ...], message: str, run: Run) -> None:
    status, printed, errors = run(*words)
    assert (status, printed) == (2, "")
    assert message in errors
    assert errors.count("\n") == 1
