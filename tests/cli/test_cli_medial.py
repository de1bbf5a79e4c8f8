"""`splinesdf axis` and `thickness`: what is printed without a file, and what is refused."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.cli.main import main

Run = Callable[..., tuple[int, str, str]]
# Between circles of the radii 1 and 2: the axis is a circle, which has no ends.
RING = "M2 0A2 2 0 0 1-2 0A2 2 0 0 1 2 0ZM1 0A1 1 0 0 1-1 0A1 1 0 0 1 1 0Z"


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    monkeypatch.chdir(tmp_path)
    Path("ring.svg").write_text(f'<svg><path fill-rule="evenodd" d="{RING}"/></svg>')
    ss.write("bar.svg", ss.Shape.rectangle(0, 0, 4, 2))

    def command(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["splinesdf", *arguments])
        with pytest.raises(SystemExit) as caught:
            main()
        return int(caught.value.code or 0), *capsys.readouterr()

    return command


def test_an_axis_is_told_of_without_a_file(run: Run) -> None:
    status, out, _ = run("axis", "ring.svg")
    assert status == 0
    assert "1 edges, length 9.42478" in out
    assert sorted(path.name for path in Path().iterdir()) == ["bar.svg", "ring.svg"]


def test_the_longest_path_has_ends(run: Run) -> None:
    status, out, err = run("axis", "ring.svg", "--longest", "-o", "a.svg")
    assert (status, out) == (2, "")
    assert err.endswith("an axis with two ends for --longest: this one has loops\n")
    assert not Path("a.svg").exists()
    for asked, count, length in (
        ((), 5, 2.0 + 4.0 * 2.0**0.5),
        (("--longest",), 3, 2.0 + 8.0**0.5),
    ):
        assert run("axis", "bar.svg", *asked, "-o", "a.csv")[0] == 0
        rows = np.loadtxt("a.csv", delimiter=",", skiprows=1)
        lines = [rows[rows[:, 0] == k, 2:] for k in range(count)]
        assert sum(map(len, lines)) == len(rows)
        whole = sum(float(np.hypot(*np.diff(line, axis=0).T).sum()) for line in lines)
        assert whole == pytest.approx(length, abs=1e-9)


def test_a_count_of_no_places_is_refused(run: Run) -> None:
    status, out, err = run("thickness", "bar.svg", "--count", "0")
    assert (status, out) == (2, "")
    assert err.endswith("splinesdf: expected a count of at least 1, got 0\n")
