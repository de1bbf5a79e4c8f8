"""Programs read by other people's readers: pygcode runs them, gcodeparser takes them apart."""

import importlib
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.io.programs import Way, read_program

PROGRAMS: dict[str, dict[str, Any]] = {
    "plain": {},
    "passes": {"depth": 3.0, "pass_depth": 1.0, "plunge_feed": 80.0, "spindle_speed": 9000.0},
    "ramp and lead": {"depth": 3.0, "pass_depth": 1.5, "ramp": 8.0, "lead": 2.0},
    "tabs": {"depth": 3.0, "tabs": 2, "tab_width": 2.0, "tab_height": 1.0},
    "laser": {"laser_power": 600.0},
}


def reader(name: str) -> Any:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return importlib.import_module(name)
    except ModuleNotFoundError:
        pytest.skip(
            f"no {name}: python -m pip install --no-deps {name} (pygcode: euclid3 and six, too)"
        )


def written(path: Path, asked: dict[str, Any], machine: str) -> tuple[str, list[Way]]:
    shape = ss.Shape.from_svg_path("M0 0H40V30H0Z M8 15a5 5 0 1 0 10 0a5 5 0 1 0-10 0Z")
    milling = ss.Milling(machine=machine, **{"feed": 300.0, **asked})
    ss.write(path / "a.nc", ss.offset(shape, 2.0, tolerance=1e-3), tolerance=1e-2, milling=milling)
    ways, faults = read_program(path / "a.nc", milling)
    assert not faults
    return (path / "a.nc").read_text(), ways


@pytest.mark.parametrize("machine", ["any", "grbl", "linuxcnc"])
@pytest.mark.parametrize("name", PROGRAMS)
def test_pygcode_runs_it_to_the_same_places(tmp_path: Path, name: str, machine: str) -> None:
    pygcode = reader("pygcode")
    text, ways = written(tmp_path, PROGRAMS[name], machine)
    tool, ends = pygcode.Machine(), []
    for line in text.splitlines():
        block = pygcode.Line(line).block
        tool.process_block(block)
        cuts = any(
            str(code.word_key or code.word) in ("G01", "G02", "G03") for code in block.gcodes
        )
        if cuts and any(letter in line.split("(")[0] for letter in "XY"):
            ends.append([tool.pos.values[axis] for axis in "XYZ"])
            assert float(tool.mode.feed_rate.word.value) > 0.0
    mine = [(m.end.real, m.end.imag, m.heights[1]) for way in ways for m in way.moves]
    assert len(ends) == len(mine) > 10
    # A laser's program has no Z: pygcode counts it as 0, this package's reader as not known.
    np.testing.assert_allclose(ends, np.nan_to_num(np.array(mine)), atol=1e-9)


@pytest.mark.parametrize("machine", ["any", "grbl", "linuxcnc", "marlin"])
@pytest.mark.parametrize("name", PROGRAMS)
def test_gcodeparser_takes_it_apart_alike(tmp_path: Path, name: str, machine: str) -> None:
    parser = reader("gcodeparser")
    text, ways = written(tmp_path, PROGRAMS[name], machine)
    here, z, cuts = 0j, math.nan, []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        lines = parser.GcodeParser(text).lines
    for line in lines:
        end = complex(line.params.get("X", here.real), line.params.get("Y", here.imag))
        z = line.params.get("Z", z)
        if line.command[0] == "G" and line.command[1] in (1, 2, 3) and "X" in line.params:
            spoke = (line.params.get("I"), line.params.get("J"))
            cuts.append((line.command[1], here, end, spoke, z))
        here = end
    mine = [move for way in ways for move in way.moves]
    assert len(cuts) == len(mine) > 10
    for (command, start, end, (i, j), height), move in zip(cuts, mine, strict=True):
        assert (start, end) == (move.start, move.end)
        assert command == (1 if move.spoke is None else 2 if move.clockwise else 3)
        assert move.spoke is None or move.spoke == complex(i, j)
        assert height == move.heights[1] or math.isnan(move.heights[1])
