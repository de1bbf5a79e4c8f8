"""`splinesdf offset` to G-code and pockets: options reach the program, notes say what is not."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import shapely

import splinesdf as ss
from splinesdf.cli import pocket
from splinesdf.offsets.pocket import cleared as as_it_is

Run = Callable[..., tuple[int, str, str]]
PLATE = ""  # the part that comes with the package
ASKED = ("part", "--tolerance", "0.02", "-o", "a.nc")


def test_all_options_reach_the_program(run: Run, tmp_path: Path) -> None:
    status, _, err = run(
        *(*ASKED, "-d", "2", "--machine", "linuxcnc", "--depth", "4", "--pass-depth", "2"),
        *("--feed", "250", "--plunge-feed", "70", "--spindle-speed", "9000", "--lead", "1.5"),
        *("--tabs", "2", "--tab-width", "2", "--tab-height", "1", "--check"),
    )
    assert status == 0, err
    text = (tmp_path / "a.nc").read_text()
    for words in ("G64 P0.0175", "M3 S9000", "G1 Z-2 F70", "F250", "(lead in)", "(pass 2 of 2)"):
        assert words in text
    assert "G1 Z-3 F70" in text  # over a tab
    assert "with fewer tabs, which have no room" in err
    assert "no --feed" not in err


def test_a_ramp_and_a_laser_reach_it(run: Run, tmp_path: Path) -> None:
    status, _, err = run(*ASKED, "-d", "2", "--depth", "1", "--ramp", "10", "--check")
    assert status == 0, err
    assert "no --feed is given: 100 mm a minute" in err
    assert "(ramp" in (tmp_path / "a.nc").read_text()
    laser = ("--laser-power", "500", "--feed", "900", "--machine", "grbl")
    status, _, err = run(*ASKED, "-d", "0.1", *laser, "--laser-mode", "constant", "--check")
    assert status == 0, err
    assert "M3 S500" in (tmp_path / "a.nc").read_text()


@pytest.mark.parametrize("name", ["a.nc", "a.dxf"])
def test_a_pocket_is_cleared_in_every_file(run: Run, name: str) -> None:
    tool = ("--tool-diameter", "6", "--stepover", "5")
    status, out, err = run(*ASKED[:-1], name, *tool, "--check", "--json")
    assert status == 0, err
    assert f"{name} clears all that the tool reaches" in err
    assert re.search(r"note: \d+ paths clear what rings leave", err)
    assert json.loads(out)["offsets"][0]["distance"] == -3.0


def test_a_pocket_that_leaves_something_fails_its_check(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its corners: what clears them is lost. The figures are those of the paths' polylines."""
    paths = list[ss.Contour]()

    def cleared(*arguments: Any) -> ss.Pocket:
        found = replace(as_it_is(*arguments), extra=())
        paths.extend(found)
        return found

    monkeypatch.setattr(pocket, "cleared", cleared)
    (tmp_path / "square.csv").write_text("0,0\n40,0\n40,40\n0,40\n")
    tool = ("--tool-diameter", "6", "--stepover", "5.6", "--tolerance", "0.02")
    status, _, err = run("square.csv", "-o", "a.nc", *tool, "--check")
    assert status == 1
    assert "clear what rings leave" not in err
    found = re.search(r"but \((.*), (.*)\) of the shape is (\S+) farther from all paths", err)
    assert found is not None
    *point, left = map(float, found.groups())
    lines = [shapely.LinearRing(path.points(1e-3)) for path in paths]
    away = shapely.distance(shapely.Point(point), lines).min()
    assert left == pytest.approx(away - 3.0, abs=5e-3)
    assert left > 0.02


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--tool-diameter", "6"), "expected --stepover with --tool-diameter, got none"),
        (("--stepover", "6"), "expected --tool-diameter with --stepover, got none"),
        (("--tool-diameter", "6", "--stepover", "-1"), "a positive stepover, got -1"),
        (("--tool-diameter", "6", "--stepover", "3", "-d", "2"), "got both: give one"),
        (("--tool-diameter", "6", "--stepover", "3", "-d", "2", "--step", "-1"), "got all"),
        ((), "got neither: give one"),
        (("--tool-diameter", "6", "--stepover", "6"), "a stepover of at most 5.9"),
        (("--tool-diameter", "600", "--stepover", "6"), "fits nowhere"),
        (("--tool-diameter", "6", "--stepover", "3", "-o", "b.wkt"), "another file than .wkt"),
        (
            ("--step", "-2", "--tabs", "2", "--tab-width", "1", "--tab-height", "1"),
            "tabs only with --distance",
        ),
        (("-d", "2", "--laser-power", "5"), "a feed for a laser"),
    ],
)
def test_what_does_not_go_together_is_refused(
    run: Run, tmp_path: Path, options: tuple[str, ...], says: str
) -> None:
    status, out, err = run(*ASKED, *options)
    assert (status, out) == (2, "")
    assert err.splitlines()[-1].startswith("splinesdf: ")
    assert says in err
    assert not (tmp_path / "a.nc").exists()
