"""`splinesdf offset`: every format keeps the tolerance, and --check finds what does not."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import splinesdf as ss
from splinesdf.ground.atomic import write_text
from splinesdf.io.remeasured import measure_file
from tests.chains import circle, circular
from tests.named_shapes import gamma

Run = Callable[..., tuple[int, str, str]]
FORMATS = ("a.dxf", "a.svg", "a.nc", "a.geojson", "a.wkt", "a.csv")
PLATE = (
    '<svg xmlns="http://www.w3.org/2000/svg"><path fill-rule="evenodd" '
    'd="M0 0H40V30H0Z M8 8V22H32V8Z M14 15a5 3 0 1 0 10 0a5 3 0 1 0 -10 0Z"/></svg>'
)


@pytest.mark.parametrize("shape", ["gamma2", "plate.svg"])
@pytest.mark.parametrize(
    ("name", "arcs"),
    [(name, ()) for name in FORMATS] + [(name, ("--arcs",)) for name in ("a.dxf", "a.svg", "a.nc")],
)
def test_what_is_written_keeps_the_tolerance(
    run: Run, name: str, arcs: tuple[str, ...], shape: str
) -> None:
    """Also where y is mirrored: the plate's points down, the limaçon's up."""
    step = "0.02" if shape == "gamma2" else "2"
    wanted = ("-d", step, "-d", f"-{step}", "--tolerance", f"{0.01 * float(step):g}")
    status, out, err = run(shape, *wanted, "-o", name, "--check", *arcs)
    assert status == 0, out + err
    assert "within the tolerance" in out
    assert "NOT" not in out


@pytest.mark.parametrize("name", FORMATS)
def test_check_measures_what_is_there(tmp_path: Path, name: str) -> None:
    """A circle 0.3 aside of where it should be: the worst point is known."""
    disk = ss.Shape.from_formula("2*cos(t)", "2*sin(t)")
    aside = circular(3.0, 0.3 + 0j, 0.1, 2.0 * math.pi, 5, distance=1.0)
    ss.write(tmp_path / name, [aside], tolerance=1e-7)
    worst = measure_file(tmp_path / name, disk, [1.0], 1e-4)
    assert worst.deviation == pytest.approx(0.3, abs=2e-7)
    assert worst.distance == 1.0
    assert worst.curves == {1.0: 1}
    x, y = worst.point
    assert min(math.dist((x, y), (3.3, 0.0)), math.dist((x, y), (-2.7, 0.0))) <= 2e-3


@pytest.mark.parametrize("name", FORMATS)
def test_check_finds_the_top_of_a_bump(tmp_path: Path, name: str) -> None:
    """The samples miss it; what is found is the true maximum."""
    disk = ss.Shape.from_formula("2*cos(t)", "2*sin(t)")
    ring = circular(3.0, 0j, 0.4, 2.0 * math.pi, 4, distance=1.0)
    bumpy = replace(ring, arcs=ring.arcs * [1.0, 3.05 / 3.0])
    ss.write(tmp_path / name, [bumpy], tolerance=1e-6)
    worst = measure_file(tmp_path / name, disk, [1.0], 1e-4)
    assert worst.deviation == pytest.approx(0.05, abs=1.1e-6)


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        ("move", "NOT within the tolerance"),
        ("drop", "expected curves"),
        ("point", "expected curves with an extent, got 1 that are points"),
    ],
)
def test_a_damaged_file_has_status_1(
    run: Run, monkeypatch: pytest.MonkeyPatch, damage: str, says: str
) -> None:
    def damaged(path: str, text: str) -> None:
        write_text(path, text)
        text = Path(path).read_text()
        if damage == "move":
            # One vertex of many, by a hundredth.
            text = re.sub(
                r"(\n0,0\.02,)([-.\d]+)", lambda m: f"{m[1]}{float(m[2]) + 0.01}", text, count=1
            )
        elif damage == "drop":
            text = text[: text.index("\n1,") + 1]
        else:
            text += 3 * "2,0.02,1.5,0.5\n"
        Path(path).write_text(text)

    monkeypatch.setattr("splinesdf.cli.offset.write_text", damaged)
    wanted = ("-d", "0.02", "-d", "-0.02", "--tolerance", "1e-3")
    status, out, err = run("gamma2", *wanted, "-o", "a.csv", "--check")
    assert status == 1
    assert says in out + err
    assert "Traceback" not in err


def test_what_is_the_level_set_of_a_fit_is_said(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("splinesdf.offsets.offset.contours_at", lambda *_, **__: None)
    status, _, err = run("plate.svg", "-d", "2", "--tolerance", "0.5", "-o", "a.svg")
    assert status == 0
    assert "note: at 2 the offset is the level set of a fit, within the tolerance, of" in err


def test_options_reach_the_program(run: Run, tmp_path: Path) -> None:
    status, _, err = run(
        *("plate.svg", "-d", "-1", "--tolerance", "0.01", "-o", "a.nc", "--units", "inch"),
        *("--feed", "250", "--safe-height", "7", "--depth", "2", "--start", "40", "-30"),
        *("--direction", "conventional"),
    )
    assert status == 0, err
    text = (tmp_path / "a.nc").read_text()
    for words in ("G20", "G0 Z7", "G1 Z-2 F250", "conventional milling"):
        assert words in text
    x, y = map(float, re.search(r"G0 X(\S+) Y(\S+)", text).groups())
    # The innermost comes first: of the island less 1, mirrored, the point nearest to the start.
    t = np.linspace(0.0, 2.0 * np.pi, 100_000)
    along = np.stack([-5.0 * np.sin(t), 3.0 * np.cos(t)], axis=1)
    inward = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    inset = np.stack([19.0 + 5.0 * np.cos(t), -15.0 + 3.0 * np.sin(t)], axis=1) + inward
    nearest = np.hypot(*(inset - [40.0, -30.0]).T).min()
    assert np.hypot(*(inset - [x, y]).T).min() <= 0.01 + 1e-4
    assert np.hypot(x - 40.0, y + 30.0) == pytest.approx(nearest, abs=0.01)


def test_arcs_reach_the_drawing(run: Run, tmp_path: Path) -> None:
    run("gamma2", "-d", "0.02", "--tolerance", "1e-3", "-o", "a.dxf", "--arcs", "--units", "mm")
    document = ezdxf.readfile(tmp_path / "a.dxf")
    assert [entity.dxftype() for entity in document.modelspace()] == ["LWPOLYLINE"]
    assert document.header["$INSUNITS"] == 4


def test_steps_are_handed_on(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = {}
    real = ss.offset

    def offset(shape: ss.Shape, **options: float) -> list[ss.Contour]:
        asked.update(options)
        return real(shape, [0.5, 1.0], tolerance=options["tolerance"])

    monkeypatch.setattr(ss, "offset", offset)
    status, out, _ = run("gamma1", "--step", "0.5", "--tolerance", "1e-3", "-o", "a.geojson")
    assert status == 0
    assert asked == {"step": 0.5, "tolerance": pytest.approx(1.25e-4), "coarse": True}
    assert "+0.5" in out
    assert "+1" in out
    features = json.loads((tmp_path / "a.geojson").read_text())["features"]
    assert [feature["properties"]["distance"] for feature in features] == [0.5, 1.0]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((), "or a --tool-diameter with a --stepover, got neither"),
        (("-d", "1", "--step", "1"), "or a --tool-diameter with a --stepover, got both"),
        (("-d", "1", "--units", "cm"), "'cm'"),
        (("-d", "1", "--units", "mm"), "units only for .dxf, .gcode, .nc, .ngc, got it for .svg"),
        (("-d", "1", "--feed", "100"), "milling only for .gcode, .nc, .ngc"),
        (("-d", "1", "--start", "0"), "--start"),
        (("-d", "1", "-o", "a.nc", "--feed", "-1"), "positive feed"),
        (("-d", "1", "-o", "a.nc", "--depth", "-1"), "below the surface"),
        (("-d", "1", "-o", "a.nc", "--direction", "up"), "'up'"),
        (("-d", "1", "-o", "a.csv", "--depth", "1"), "milling only for"),
    ],
)
def test_bad_options_are_one_line_before_any_work(
    run: Run, tmp_path: Path, arguments: tuple[str, ...], says: str
) -> None:
    status, out, err = run("gamma1", "--tolerance", "1e-3", "-o", "a.svg", *arguments)
    assert (status, out) == (2, "")
    assert err.startswith("splinesdf: ")
    assert err.count("\n") == 1
    assert says in err
    assert [path.name for path in tmp_path.iterdir()] == ["plate.svg"]


def test_the_help_tells_every_option(run: Run) -> None:
    _, out, _ = run("--help")
    for option in (
        *("--distance", "--step", "--tolerance", "--output", "--arcs", "--units", "--feed"),
        *("--safe-height", "--depth", "--start", "--direction", "--check"),
    ):
        assert option in out


def test_an_eighth_of_the_tolerance_makes_the_fewest_arcs() -> None:
    """Why the offset gets so little: at a half, biarcs follow what it wavers by."""
    counts = {}
    for share in (0.125, 0.5):
        contours = ss.offset(gamma("gamma2"), [0.02], tolerance=share * 1e-4)
        rest = (1.0 - share) * 1e-4
        counts[share] = sum(len(ss.as_arcs(c, tolerance=rest).arcs) for c in contours)
    assert counts[0.125] < 0.9 * counts[0.5]
    assert np.isfinite(list(counts.values())).all()


def test_the_message_names_the_tolerance_that_was_given(run: Run) -> None:
    """Not the offset's share of it, which was once told: -0.875 for -1."""
    for name in FORMATS:
        for given in ("-1", "0", "nan", "-0.0123", "inf"):
            status, _, err = run("gamma1", "-d", "0.1", f"--tolerance={given}", "-o", name)
            assert status == 2
            assert re.search(rf"got {re.escape(given)}(\s|$|:)", err), err
        status, _, err = run("gamma1", "-d", "0.1", "--tolerance", "1.25e-14", "-o", name)
        assert status == 2
        assert "1.25e-14" in err
        least = re.search(r"at least (\S+) for", err)
        assert least is not None, err
        assert float(least[1]) > 1.25e-14


def test_what_the_library_says_of_a_share_names_the_whole(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def offset(*_: object, tolerance: float, **__: object) -> list[ss.Contour]:
        raise ss.InputError(f"no such tolerance as {tolerance:g}")

    monkeypatch.setattr(ss, "offset", offset)
    _, _, err = run("gamma1", "-d", "3", "--tolerance", "0.5", "-o", "a.svg")
    assert "0.4375" in err
    assert "tolerance 0.5" in err


def test_no_point_of_the_plane_is_said_only_where_it_is_true(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ss, "offset", lambda *_, **__: [])  # as with a huge tolerance
    for distances, there in (
        (("-0.4",), True),  # the ellipse is 0.444 deep
        (("-0.5",), False),
        (("-0.5", "-7"), False),
        (("-0.5", "-0.1"), True),
        (("0.1",), True),
        (("0",), True),
    ):
        asked = [word for d in distances for word in ("-d", d)]
        status, _, err = run("gamma1", *asked, "--tolerance", "9", "--coarse", "-o", "a.svg")
        assert status == 2
        assert ("no point of the plane" in err) == (not there)
        assert ("tolerance 9" in err) == there
    _, _, err = run("gamma1", "--step", "-0.4", "--tolerance", "9", "--coarse", "-o", "a.svg")
    assert "no point of the plane" not in err


def test_nothing_is_left_is_said_only_where_it_is_true(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def offset(_: ss.Shape, distance: float, **__: object) -> list[ss.Contour]:
        return [circle(1.0, distance=distance)] if distance > 0.0 else []

    monkeypatch.setattr(ss, "offset", offset)
    asked = (
        *("-d", "0.5", "-d", "-0.4", "-d", "-0.5"),
        *("--tolerance", "9", "--coarse", "-o", "a.csv"),
    )
    status, out, err = run("gamma1", *asked)
    assert status == 0, err
    told = {line.split()[0]: line for line in out.splitlines() if re.match(r"\s*[+-]\d", line)}
    assert "nothing as wide as the tolerance" in told["-0.4"]
    assert "nothing is left" in told["-0.5"]
