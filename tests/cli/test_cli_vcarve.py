"""`splinesdf vcarve`: options reach the files, the check ends it, and what is not is said."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from splinesdf.cli.main import main

Run = Callable[..., tuple[int, str, str]]
ASKED = ("part", "--tolerance", "0.1", "--depth", "3", "-o", "a.nc")


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    monkeypatch.chdir(tmp_path)

    def command(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["splinesdf", "vcarve", *arguments])
        with pytest.raises(SystemExit) as caught:
            main()
        return int(caught.value.code or 0), *capsys.readouterr()

    return command


def test_all_options_reach_the_files(run: Run, tmp_path: Path) -> None:
    status, out, err = run(
        *(*ASKED, "--angle", "90", "--tip", "0.5", "--allowance", "0.1", "--step-down", "2"),
        *("--feed", "500", "--plunge-feed", "70", "--spindle-speed", "9000"),
        *("--machine", "linuxcnc", "--origin", "center", "--flat", "b.dxf", "--check", "--json"),
    )
    assert status == 0, err
    told = json.loads(out)
    assert told["check"]["passed"]
    assert told["deepest"] == 3.0
    assert told["written"] == ["a.nc", "b.dxf"]
    text = (tmp_path / "a.nc").read_text()
    for words in ("G64 P0.1", "M3 S9000", "F70", "F500", "a bit of 90 degrees, tip 0.5", " Z-2"):
        assert words in text
    assert (tmp_path / "b.dxf").stat().st_size > 1000


def test_what_is_left_is_said(run: Run) -> None:
    status, out, err = run(*ASKED)
    assert status == 0, err
    assert "9 contours around what is flat at the depth are left to another tool" in err
    assert "no --feed is given: 100 mm a minute" in err
    assert "part does not say its unit" in err or "mm" in err
    assert "length" in out


def test_a_surface_that_is_off_is_status_1(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    from splinesdf.cli import vcarve
    from splinesdf.io.output import file_text

    def deeper(*args: object, **options: object) -> str:
        return file_text(*args, **options).replace("Z-3", "Z-3.2")  # type: ignore[arg-type]

    monkeypatch.setattr(vcarve, "file_text", deeper)
    status, out, _ = run(*ASKED, "--check")
    assert status == 1
    assert "too deep by 2.00e-01" in out
    assert "NOT within" in out


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--angle", "0"), "expected an angle between 0 and 180 degrees, got 0"),
        (("-o", "a.svg"), "expected a file name ending in .csv, .gcode, .nc, .ngc for a carve"),
        (("-o", "a.csv", "--check"), "expected G-code to check, got .csv"),
        (("--depth", "99", "--flat", "b.dxf"), "expected something flat for --flat, got none"),
        (("--tip", "60"), "one in which it fits nowhere"),
    ],
)
def test_bad_input_is_one_line(
    run: Run, tmp_path: Path, options: tuple[str, ...], says: str
) -> None:
    status, _, err = run(*ASKED, *options)
    assert status == 2
    assert says in err.splitlines()[-1]
    assert not list(tmp_path.glob("*.nc"))
