"""Programs for several controllers, each run by a strict reading of that controller's words."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.io.remeasured import Worst, measure_file

# What each controller takes: words of G and M, and how many commands a line may hold. LinuxCNC:
# "G code reference"; GRBL 1.1: "Supported G-Codes"; Marlin 2: "G-code index".
KNOWN = {
    "any": "G0 G1 G2 G3 G17 G20 G21 G40 G90 G91.1 G94 M2 M3 M5",
    "linuxcnc": "G0 G1 G2 G3 G4 G17 G20 G21 G40 G64 G90 G91.1 G94 M2 M3 M5",
    "grbl": "G0 G1 G2 G3 G4 G17 G20 G21 G40 G90 G91.1 G94 M2 M3 M4 M5",
    "marlin": "G0 G1 G2 G3 G4 G17 G20 G21 G90 M3 M5 M400",
}
TOLERANCE = 0.01


def plate() -> ss.Shape:
    return ss.Shape.from_svg_path(
        "M0 0H40V30H0Z M8 15a5 5 0 1 0 10 0a5 5 0 1 0-10 0Z M26 9h6v12h-6Z", fill="evenodd"
    )


def written(path: Path, machine: str = "any", distance: float = 1.5, **asked: Any) -> str:
    milling = ss.Milling(machine=machine, **{"feed": 300.0, **asked})
    contours = ss.offset(plate(), distance, tolerance=0.1 * TOLERANCE)
    ss.write(path / "a.nc", contours, tolerance=0.5 * TOLERANCE, milling=milling)
    return (path / "a.nc").read_text()


def measured(path: Path, text: str, distance: float = 1.5, **asked: Any) -> Worst:
    """What `--check` finds of a text."""
    (path / "a.nc").write_text(text)
    milling = ss.Milling(**{"feed": 300.0, **asked})
    return measure_file(path / "a.nc", plate(), [distance], TOLERANCE, milling=milling)


def runs(text: str, machine: str) -> list[tuple[float, np.ndarray]]:
    """Each way of the cutter in the plane at one depth: Z and the ends of its moves.

    It refuses what the controller would: unknown words, a cut without a feed, a quick way below
    the surface, several commands in a line of Marlin, comments that it does not know.
    """
    known = set(KNOWN[machine].split())
    found: list[tuple[float, list[complex]]] = []
    here, z, feed = 0j, math.nan, math.nan
    for line in text.splitlines():
        comment = r";.*" if machine == "marlin" else r"\([^()]*\)"
        words = re.sub(comment, "", line).split()
        assert all(re.fullmatch(r"[GMXYZIJFSP]-?\d+(\.\d+)?", word) for word in words), line
        assert len(line) < 80
        commands = [word for word in words if word[0] in "GM"]
        assert set(commands) <= known, line
        assert machine != "marlin" or len(commands) <= 1
        values = {word[0]: float(word[1:]) for word in words}
        feed = values.get("F", feed)
        end = complex(values.get("X", here.real), values.get("Y", here.imag))
        if "G0" in commands:
            assert "X" not in values or z > 0.0
        if {"G1", "G2", "G3"} & set(commands):
            assert feed > 0.0
            if "X" in values:
                if not found or found[-1][0] != z or found[-1][1][-1] != here:
                    found.append((z, [here]))
                found[-1][1].append(end)
        here, z = end, values.get("Z", z)
    assert words == [{"marlin": "M400"}.get(machine, "M2")]
    return [(z, np.array(points)) for z, points in found]


@pytest.mark.parametrize("machine", KNOWN)
def test_each_controller_takes_its_program(tmp_path: Path, machine: str) -> None:
    asked = {"depth": 5.0, "pass_depth": 2.0, "plunge_feed": 80.0, "spindle_speed": 9000.0}
    text = written(tmp_path, machine, **asked)
    found = runs(text, machine)
    heights = [z for z, _ in found]
    assert heights == pytest.approx(3 * [-5.0 / 3.0, -10.0 / 3.0, -5.0], abs=1e-4)
    for k in range(0, 9, 3):
        ways = [points for _, points in found[k : k + 3]]
        assert all(np.array_equal(ways[0], way) for way in ways)
        assert ways[0][0] == ways[0][-1]
    assert "M3 S9000" in text
    assert re.findall(r"G1 Z\S+ F(\S+)", text) == 9 * ["80"]
    worst = measured(tmp_path, text, **asked, machine=machine)
    assert worst.keeps(TOLERANCE)
    assert worst.curves == {1.5: 3}


@pytest.mark.parametrize(
    ("machine", "mode", "on"),
    [
        ("any", None, "M3 S700"),
        ("grbl", None, "M4 S700"),
        ("grbl", "constant", "M3 S700"),
        ("marlin", None, "M3 S700"),
    ],
)
def test_a_laser_is_on_along_contours_only(
    tmp_path: Path, machine: str, mode: str | None, on: str
) -> None:
    asked = {"laser_power": 700.0, "laser_mode": mode}
    text = written(tmp_path, machine, **asked)
    assert "Z" not in re.sub(r"\(.*\)|;.*", "", text)
    words = re.findall(r"^(M[345].*|G[0123](?= ))", text, re.MULTILINE)
    lit = False
    for word in words:
        assert (word == "G0") is not lit or word[0] == "M"
        lit = word == on if word[0] == "M" else lit
    assert words.count(on) == 3
    worst = measured(tmp_path, text, machine=machine, **asked)
    assert worst.keeps(TOLERANCE)


def test_a_feed_of_plunging_does_not_stay(tmp_path: Path) -> None:
    text = written(tmp_path, depth=2.0, plunge_feed=50.0)
    feed = math.nan
    for line in text.splitlines():
        found = re.search(r"F(\S+)", line)
        feed = float(found[1]) if found else feed
        if re.match("G[123] ", line):
            assert feed == (50.0 if " Z" in line else 300.0)


def dropped(text: str, pattern: str, which: int = 0) -> str:
    found = list(re.finditer(pattern, text, re.MULTILINE | re.DOTALL))
    return text[: found[which].start()] + text[found[which].end() :]


PASSES = {"depth": 3.0, "pass_depth": 1.0}
PASS = r"^\(pass 2 of 3\)\n.*?(?=^\(pass 3)"


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (lambda text: dropped(text, PASS, 1), "goes from Z-1 to Z-3 at once"),
        (lambda text: dropped(text, r"^\(pass 3 of 3\)\n.*?(?=^G0 Z)", 1), "to Z-2, expected -3"),
        (lambda text: dropped(text, r"^\(pass 1 of 3\)\n.*?(?=^\(pass 2)", 0), "from Z0 to Z-2"),
        (lambda text: text.replace("G1 Z-3 ", "G1 Z-2.9 "), "to Z-2.9, expected -3"),
        (lambda text: text.replace("G1 Z-1 ", "G1 Z-4 F9\nG1 Z-1 ", 1), "goes down to Z-4"),
        (lambda text: re.sub(r" F\d+", "", text), "cuts without a feed"),
        (lambda text: dropped(text, r"^G0 Z5\n", 1), "goes quickly through the material"),
        # One move of an earlier pass is lost, or there twice.
        (lambda text: moved(text, 2, lost=True), "the pass at Z-2"),
        (lambda text: moved(text, 2, lost=False), "the pass at Z-2"),
    ],
)
def test_the_check_sees_what_is_wrong(tmp_path: Path, damage: Any, says: str) -> None:
    text = written(tmp_path, **PASSES)
    assert measured(tmp_path, text, **PASSES).keeps(TOLERANCE)
    worst = measured(tmp_path, damage(text), **PASSES)
    assert not worst.keeps(TOLERANCE)
    assert any(says in fault for fault in worst.faults), worst.faults


def moved(text: str, number: int, lost: bool) -> str:
    """The rectangle's second pass without its second move, or with the whole way twice."""
    blocks = text.split("(distance ")
    at = next(k for k, block in enumerate(blocks) if k and block.count("G1 X") > block.count("G3"))
    lines = blocks[at].splitlines(keepends=True)
    first = next(k for k, line in enumerate(lines) if line.startswith(f"(pass {number}")) + 2
    last = next(k for k, line in enumerate(lines) if line.startswith(f"(pass {number + 1}"))
    way = lines[first:last]
    new = [way[0], *way[2:]] if lost else way + way
    blocks[at] = "".join(lines[:first] + new + lines[last:])
    return "(distance ".join(blocks)


def test_the_check_sees_a_beam_that_is_off_or_stays_on_or_is_lifted(tmp_path: Path) -> None:
    asked = {"laser_power": 700.0}
    text = written(tmp_path, **asked)
    off = measured(tmp_path, dropped(text, r"^M3 S700\n", 1), **asked)
    assert any("with the beam off" in fault for fault in off.faults)
    on = measured(tmp_path, dropped(text, r"^M5\n", 2), **asked)
    assert any("goes quickly through the material" in fault for fault in on.faults)
    high = measured(tmp_path, text.replace("M5\n", "M5\nG0 Z5\n", 1), **asked)
    assert any("moves in Z, which a laser has not" in fault for fault in high.faults)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"pass_depth": 1.0}, "a depth above 0 to cut in passes"),
        ({"depth": 9.0, "pass_depth": 1e-3}, "at most 1000 passes"),
        ({"machine": "toaster"}, "any, grbl, linuxcnc, marlin for machine, got 'toaster'"),
        ({"laser_power": 5.0}, "a feed for a laser"),
        ({"laser_mode": "constant"}, "a laser power with a laser mode"),
        ({"laser_power": 5.0, "feed": 3.0, "laser_mode": "on"}, "constant or dynamic, got 'on'"),
        ({"laser_power": 5.0, "feed": 3.0, "laser_mode": "dynamic"}, "M4 is GRBL's"),
        ({"laser_power": 5.0, "feed": 3.0, "depth": 1.0}, "no depth for a laser"),
        ({"laser_power": 5.0, "feed": 3.0, "spindle_speed": 1.0}, "no spindle speed for a laser"),
    ],
)
def test_what_does_not_go_together_is_refused(asked: dict[str, Any], says: str) -> None:
    with pytest.raises(ss.InputError, match=re.escape(says)) as caught:
        ss.Milling(**asked)
    assert "\n" not in str(caught.value)
