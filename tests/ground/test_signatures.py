"""A tour of all public operations, compiled anew with bounds checked and references counted.

Run by CI, and by ``python -m pytest -n 0 -m anew tests/ground``. One process answers three
questions, as compiling everything takes a minute: does an index leave its array, is anything
compiled for two signatures, and do kernels that count no references answer as their counted twins?
A last one only loads what another has kept: it must find all that it needs, and answer the same.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import splinesdf

pytestmark = pytest.mark.anew
ROOT = Path(__file__).parents[2]
# What checks of bounds change in how sums are ordered, on the way to an arc's control points. A
# reference that is given back too early leaves other arrays' numbers: all digits.
ROUNDING = 1e-9


def tour(*arguments: str, **settings: str) -> dict[str, Any]:
    paths = os.pathsep.join([str(Path(splinesdf.__file__).parents[1]), str(ROOT)])
    done = subprocess.run(
        [sys.executable, "-W", "error", "-m", "tests.ground.tour", *arguments],
        env=os.environ | {"PYTHONPATH": paths} | settings,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder = str(tmp_path_factory.mktemp("compiled"))
    return tour("counted", NUMBA_BOUNDSCHECK="1", NUMBA_CACHE_DIR=folder)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(tmp_path_factory.mktemp("kept"))


@pytest.fixture(scope="module")
def plain(folder: str) -> dict[str, Any]:
    return tour(NUMBA_CACHE_DIR=folder)


def test_nothing_is_compiled_twice(checked: dict[str, Any]) -> None:
    twice = {name: found for name, found in checked["signatures"].items() if len(found) > 1}
    assert not twice


def test_the_tour_runs_every_kernel(checked: dict[str, Any]) -> None:
    never = {name for name, found in checked["signatures"].items() if not found}
    assert never == set()


def test_counted_twins_answer_the_same(checked: dict[str, Any], plain: dict[str, Any]) -> None:
    assert plain["results"].keys() == checked["results"].keys()
    for name, (_, total) in plain["results"].items():
        assert checked["results"][name][1] == pytest.approx(total, rel=ROUNDING, abs=ROUNDING), name


def test_what_is_loaded_answers_the_same(folder: str, plain: dict[str, Any]) -> None:
    loaded = tour(NUMBA_CACHE_DIR=folder)
    assert loaded["compiled"] == []
    assert loaded["results"] == plain["results"]
