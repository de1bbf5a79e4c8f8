"""The command line, run as a user does: what it prints, writes and refuses."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import ezdxf
import numpy as np
import pytest

import splinesdf as ss
from splinesdf.cli.main import main
from tests.named_shapes import UNIT, gamma

DATA = Path(__file__).parents[1] / "data"
SQUARE = "0,0\n1,0\n1,1\n0,1\n"


class Run(NamedTuple):
    """How a command ended."""

    status: int
    out: str
    err: str


Command = Callable[..., Run]


@pytest.fixture
def run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Command:
    """Run ``splinesdf`` with these arguments in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def command(*arguments: str) -> Run:
        monkeypatch.setattr(sys, "argv", ["splinesdf", *arguments])
        with pytest.raises(SystemExit) as caught:
            main()
        code = caught.value.code
        assert code is None or isinstance(code, int)
        return Run(code or 0, *capsys.readouterr())

    return command


def test_fit_saves_draws_and_prints_its_error(run: Command, tmp_path: Path) -> None:
    done = run("fit", "gamma2", "--tolerance", "0.01", "-o", "fit.npz", "--plot", "fit.png")
    assert done.status == 0, done.err
    spline = ss.load(tmp_path / "fit.npz")
    points = np.random.default_rng(1).uniform(spline.domain[:2], spline.domain[2:], (20_000, 2))
    assert np.abs(spline(points) - ss.signed_distance(gamma("gamma2"), points)).max() <= 0.01
    assert (tmp_path / "fit.png").read_bytes().startswith(b"\x89PNG")
    assert "centre error" in done.out
    assert f"{len(spline.ordinates):,}" in done.out


def test_fit_as_json_says_what_the_library_says(run: Command) -> None:
    done = run(
        *("fit", "gamma1", "--tolerance", "0.01", "--domain", "0", "0", "1", "1", "--json"),
        *("--operator", "V", "--space", "uniform"),
    )
    found = json.loads(done.out)
    expected = ss.fit(gamma("gamma1"), tolerance=0.01, domain=UNIT, operator="V", space="uniform")
    assert (found["error"], found["cells"]) == (expected.error, expected.cells)
    assert found["centre_error"] == expected.centre_error
    assert [step["cells"] for step in found["history"]] == [s.cells for s in expected.history]


def test_tolerance_that_was_not_given_is_announced(run: Command) -> None:
    done = run("fit", "gamma1", "--json")
    assert json.loads(done.out)["tolerance"] == pytest.approx(1e-3 * gamma("gamma1").size)
    assert "1e-3 of the larger side" in done.err


def test_band_reaches_the_fit(run: Command) -> None:
    done = run("fit", "gamma2", "--tolerance", "1e-4", "--band", "-0.02", "-0.01", "--json")
    found = json.loads(done.out)
    assert found["bands"] == [[-0.02, -0.01]]
    assert found["error"] <= 1e-4
    assert found["cells"] < 1000


@pytest.mark.parametrize("name", ["out.svg", "out.dxf", "out.geojson", "out.wkt", "out.csv"])
def test_offset_writes_every_format(name: str, run: Command, tmp_path: Path) -> None:
    done = run("offset", "gamma1", "-d", "-0.1", "-d", "0.1", "--tolerance", "1e-3", "-o", name)
    assert done.status == 0, done.err
    assert "+0.1" in done.out
    assert "-0.1" in done.out
    assert (tmp_path / name).stat().st_size > 500
    if name == "out.dxf":
        splines = ezdxf.readfile(tmp_path / name).modelspace().query("SPLINE")
        assert len(splines) == 2


@pytest.mark.parametrize("name", ["gear-fill.svg", "geo-alt-fill.svg"])
def test_offset_of_real_icons(name: str, run: Command, tmp_path: Path) -> None:
    done = run("offset", str(DATA / name), "-d", "0.3", "--tolerance", "1e-3", "-o", "out.csv")
    assert done.status == 0, done.err
    with (tmp_path / "out.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    points = np.array([[float(row["x"]), float(row["y"])] for row in rows])
    shape = ss.read(DATA / name)
    # A vertex of the polyline lies on an arc, which keeps the tolerance.
    assert np.abs(ss.signed_distance(shape, points) - 0.3).max() <= 1e-3


def test_query_of_a_shape_and_of_its_fit(run: Command, tmp_path: Path) -> None:
    (tmp_path / "square.csv").write_text(SQUARE)
    (tmp_path / "points.csv").write_text("x,y\n0.5,0.25\n2,0.5\n2,2\nnan,0\n0,0.5\n")
    run("fit", "square.csv", "--tolerance", "0.01", "-o", "fit.npz")
    exact = run("query", "square.csv", "points.csv")
    rows = np.array([list(map(float, r.split(","))) for r in exact.out.splitlines()[1:]])
    assert exact.out.splitlines()[0] == "x,y,distance,gx,gy"
    expected = [
        [0.5, 0.25, -0.25, 0.0, -1.0],
        [2.0, 0.5, 1.0, 1.0, 0.0],
        [2.0, 2.0, np.sqrt(2.0), np.sqrt(0.5), np.sqrt(0.5)],
        [np.nan, 0.0, np.nan, np.nan, np.nan],
        [0.0, 0.5, 0.0, np.nan, np.nan],
    ]
    assert rows == pytest.approx(np.array(expected), abs=1e-15, nan_ok=True)
    assert "1 of 5 points" in exact.err

    assert run("query", "fit.npz", "points.csv", "-o", "out.csv").status == 0
    fitted = np.genfromtxt(tmp_path / "out.csv", delimiter=",", skip_header=1)
    spline = ss.load(tmp_path / "fit.npz")
    value, gradient = spline.value_and_gradient(rows[:, :2])
    assert np.array_equal(fitted[:, 2], value, equal_nan=True)
    assert np.array_equal(fitted[:, 3:], gradient, equal_nan=True)
    assert abs(fitted[0, 2] + 0.25) <= 0.01


def test_paper_as_json_has_every_row(run: Command) -> None:
    found = json.loads(run("paper", "--json").out)
    assert len(found) == 42
    first = {"table": 1, "curve": "gamma1", "mesh": "uniform", "operator": "V", "k": 0}
    assert first.items() <= found[0].items()
    assert {"m", "n", "error", "printed", "true_error"} <= set(found[0])


def test_paper_prints_tables_that_are_not_cut(run: Command) -> None:
    out = run("paper", "--tables").out
    rows = [line.split() for line in out.splitlines() if " gamma" in line]
    assert len(rows) == 42
    assert rows[0][:4] == ["1", "gamma1", "uniform", "V"]
    assert all(len(row[-1]) == len("1.2345e-02") for row in rows)


def test_info_of_a_shape_and_of_a_fit(run: Command, tmp_path: Path) -> None:
    shape = run("info", "part")
    assert shape.status == 0
    assert "9 (evenodd)" in shape.out
    run("fit", "gamma1", "--tolerance", "0.05", "-o", "fit.npz")
    fit = run("info", "fit.npz")
    assert "gamma1" in fit.out
    assert str(len(ss.load(tmp_path / "fit.npz").ordinates)) in fit.out


def test_what_a_reader_left_out_is_told(run: Command, tmp_path: Path) -> None:
    svg = '<svg xmlns="http://www.w3.org/2000/svg"><rect width="4" height="3"/><text>a</text></svg>'
    (tmp_path / "a.svg").write_text(svg)
    done = run("info", "a.svg")
    assert done.status == 0
    assert "1 text" in done.err


def test_demo_writes_what_it_says(run: Command, tmp_path: Path) -> None:
    done = run("demo", "-o", "here")
    assert done.status == 0, done.err
    written = [line.split()[1] for line in done.out.splitlines() if line.startswith("written")]
    assert sorted(written) == sorted(str(p.relative_to(tmp_path)) for p in tmp_path.glob("here/*"))
    assert len(written) == 4
    spline = ss.load(tmp_path / "here" / "part.npz")
    assert spline.y_down


def _cut(tmp_path: Path) -> None:
    ss.fit(gamma("gamma1"), tolerance=0.1).spline.save(tmp_path / "cut.npz")
    whole = (tmp_path / "cut.npz").read_bytes()
    (tmp_path / "cut.npz").write_bytes(whole[: len(whole) // 2])


BAD: dict[str, tuple[str, list[str], str]] = {
    # name: (file a.<extension> to make, arguments, what the line must say)
    "open contour": (
        '.svg|<svg xmlns="http://www.w3.org/2000/svg"><path fill="none" d="M0 0H9V9"/></svg>',
        ["fit", "a.svg"],
        "closed",
    ),
    "empty file": (".svg|", ["fit", "a.svg"], "empty"),
    "empty points": (".csv|", ["fit", "a.csv"], "empty"),
    "only comments": (".csv|# nothing\n", ["fit", "a.csv"], "point"),
    "not a number": (".csv|0,0\n1,0\nnan,1\n", ["fit", "a.csv"], "line 3"),
    "infinity": (".csv|0,0\n1,0\ninf,1\n", ["fit", "a.csv"], "line 3"),
    "text in points": (".csv|0,0\n1,0\n1,one\n", ["fit", "a.csv"], "line 3"),
    "two points": (".csv|0,0\n1,0\n", ["fit", "a.csv"], "3"),
    "one point again and again": (".csv|1,1\n1,1\n1,1\n", ["fit", "a.csv"], "point"),
    "far from the origin": (
        ".csv|1e12,0\n1000000000001,0\n1000000000001,1\n1e12,1\n",
        ["fit", "a.csv"],
        "nearer to the origin",
    ),
    "text as svg": (".svg|hello", ["fit", "a.svg"], "SVG"),
    "svg as json": (".json|<svg/>", ["fit", "a.json"], "JSON"),
    "picture as points": (".csv|\x89PNG\x00\x01\x02", ["fit", "a.csv"], "a.csv"),
    "html as svg": (".svg|<html></html>", ["fit", "a.svg"], "svg"),
    "svg without curves": (
        '.svg|<svg xmlns="http://www.w3.org/2000/svg"><text>a</text></svg>',
        ["fit", "a.svg"],
        "1 text",
    ),
    "bad path data": (
        '.svg|<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 L5"/></svg>',
        ["fit", "a.svg"],
        "path",
    ),
    "formula that is code": (
        '.json|{"x": "__import__(\'os\').getcwd()", "y": "t"}',
        ["fit", "a.json"],
        "formula",
    ),
    "formula that does not close": (
        '.json|{"x": "cos(t)", "y": "t"}',
        ["fit", "a.json"],
        "closed",
    ),
    "formula with a pole": (
        '.json|{"x": "cos(t)", "y": "1/sin(t)"}',
        ["fit", "a.json"],
        "finite",
    ),
    "no tolerance to speak of": ("", ["fit", "gamma1", "--tolerance", "0"], "tolerance"),
    "negative tolerance": ("", ["fit", "gamma1", "--tolerance", "-1"], "tolerance"),
    "tolerance below rounding": ("", ["fit", "gamma1", "--tolerance", "1e-17"], "rounding"),
    "tolerance that is no number": ("", ["fit", "gamma1", "--tolerance", "small"], "small"),
    "tolerance nan": ("", ["fit", "gamma1", "--tolerance", "nan"], "tolerance"),
    "tolerance out of reach": (
        "",
        ["fit", "gamma2", "--tolerance", "1e-4", "--max-cells", "300"],
        "max_cells",
    ),
    "unknown space": ("", ["fit", "gamma1", "--space", "cubic"], "cubic"),
    "unknown operator": ("", ["fit", "gamma1", "--operator", "Z"], "Z"),
    "empty domain": ("", ["fit", "gamma1", "--domain", "1", "0", "0", "1"], "domain"),
    "band upside down": ("", ["fit", "gamma1", "--band", "1", "0"], "band"),
    "missing file": ("", ["fit", "nowhere.svg"], "nowhere.svg"),
    "folder as shape": ("", ["fit", "."], "folder"),
    "unknown kind of file": (".doc|hello", ["fit", "a.doc"], ".svg"),
    "missing argument": ("", ["fit"], "SHAPE"),
    "unknown option": ("", ["fit", "gamma1", "--tolerances", "1"], "--tolerances"),
    "unknown command": ("", ["fits"], "fits"),
    "fit to another kind of file": ("", ["fit", "gamma1", "-o", "fit.txt"], ".npz"),
    "picture of another kind": ("", ["fit", "gamma1", "--plot", "fit.gif"], ".png"),
    "folder that does not exist": ("", ["fit", "gamma1", "-o", "no/fit.npz"], "does not exist"),
    "offsets to another kind of file": (
        "",
        ["offset", "gamma1", "-d", "0.1", "-o", "out.png"],
        ".dxf",
    ),
    "offset at nan": ("", ["offset", "gamma1", "-d", "nan", "-o", "out.svg"], "finite"),
    "nothing left": ("", ["offset", "gamma1", "-d", "-9", "-o", "out.svg"], "-9"),
    "no distance": ("", ["offset", "gamma1", "-o", "out.svg"], "--distance"),
    "output over input": (f".csv|{SQUARE}", ["offset", "a.csv", "-d", "1", "-o", "a.csv"], "input"),
    "points over points": (f".csv|{SQUARE}", ["query", "gamma1", "a.csv", "-o", "a.csv"], "input"),
    "points of three columns": (".csv|1,2,3\n", ["query", "gamma1", "a.csv"], "line 1"),
    "above a limit": (
        f".csv|{SQUARE}",
        ["info", "a.csv", "--limit", "pieces=3"],
        "--limit pieces=",
    ),
    "unknown limit": ("", ["info", "gamma1", "--limit", "parts=3"], "pieces"),
    "limit that is no number": ("", ["info", "gamma1", "--limit", "pieces=many"], "pieces=5e6"),
    "no saved fit": (".npz|hello", ["info", "a.npz"], "a.npz"),
    "saved fit that is missing": ("", ["query", "b.npz", "a.csv"], "b.npz"),
    "saved fit cut short": ("", ["info", "cut.npz"], "cut.npz"),
    "demo into a file": (".txt|hello", ["demo", "-o", "a.txt"], "a.txt"),
    "figures into a file": (".txt|hello", ["paper", "--figures", "a.txt"], "a.txt"),
}


def test_limits_are_raised_and_lowered_for_one_file(run: Command, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(SQUARE)
    assert run("info", "a.csv", "--limit", "pieces=4", "--limit", "bytes=1e3").status == 0
    assert run("info", "a.csv", "--limit", "pieces=4", "--limit", "bytes=5").status == 2


@pytest.mark.parametrize("kind", BAD)
def test_bad_input_is_one_line_and_status_2(kind: str, run: Command, tmp_path: Path) -> None:
    file, arguments, says = BAD[kind]
    if file:
        extension, text = file.split("|", 1)
        (tmp_path / f"a{extension}").write_bytes(text.encode("latin-1"))
    if kind == "saved fit cut short":
        _cut(tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    done = run(*arguments)
    assert done.status == 2
    assert done.out == ""
    lines = [line for line in done.err.splitlines() if not line.startswith(("tolerance ", "note:"))]
    assert len(lines) == 1, done.err
    assert lines[0].startswith("splinesdf: ")
    assert says in lines[0]
    assert "Traceback" not in done.err
    # Nothing lost, nothing half written.
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_every_command_has_help(run: Command) -> None:
    for command in ("demo", "fit", "offset", "query", "paper", "info"):
        done = run(command, "--help")
        assert done.status == 0
        assert "Usage" in done.out
    assert ss.__version__ in run("--version").out


def test_info_and_help_load_neither_numba_nor_matplotlib(tmp_path: Path) -> None:
    code = (
        "import sys; sys.argv = ['splinesdf', *sys.argv[1:]]\n"
        "from splinesdf.cli.main import main\n"
        "try:\n    main()\nfinally:\n"
        "    assert not {'numba', 'matplotlib', 'scipy', 'ezdxf'} & set(sys.modules)"
    )
    ss.fit(gamma("gamma1"), tolerance=0.1).spline.save(tmp_path / "fit.npz")
    for arguments in (["info", "part"], ["info", str(tmp_path / "fit.npz")], ["--help"]):
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("arguments", [["info", "part"], ["query", "gamma1", "a.csv"]])
def test_reader_that_goes_away_makes_no_noise(arguments: list[str], tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("0,0\n1,1\n")
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [sys.executable, "-m", "splinesdf", *arguments],
        cwd=tmp_path,
        stdout=writing,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(writing)
    assert done.returncode == 1
    assert done.stderr == ""


def test_names_do_not_steer_the_terminal(run: Command, tmp_path: Path) -> None:
    loop = {"x": "cos(t)", "y": "sin(t)"}
    (tmp_path / "x.json").write_text(json.dumps(loop | {"name": "\x1b[31mred\nx"}))
    done = run("info", "x.json")
    assert done.status == 0, done.err
    assert "\x1b" not in done.out
    assert "red x" in done.out


def test_names_are_no_markup(run: Command, tmp_path: Path) -> None:
    """They once ended the program."""
    loop = {"x": "cos(t)", "y": "sin(t)", "name": "[/x] [bold]\x1b[31m"}
    (tmp_path / "x.json").write_text(json.dumps(loop))
    for arguments in (
        ("fit", "x.json", "--tolerance", "0.1", "-o", "x.npz", "--plot", "x.png"),
        ("offset", "x.json", "-d", "0.1", "--tolerance", "0.02", "-o", "x.svg"),
        ("info", "x.npz"),
    ):
        done = run(*arguments)
        assert done.status == 0, done.err
        assert "[/x] [bold] [31m" in done.out
        assert "\x1b" not in done.out + done.err


def test_long_names_are_refused_in_a_line(run: Command) -> None:
    long = 300 * "a"
    for arguments in (
        ("info", f"{long}.svg"),
        ("fit", "gamma1", "-o", f"{long}.npz"),
        ("fit", "gamma1", "--plot", f"{long}.png"),
        ("offset", "gamma1", "-d", "1", "-o", f"{long}.svg"),
        ("query", "gamma1", f"{long}.csv"),
    ):
        done = run(*arguments)
        assert done.status == 2
        assert done.out == ""
        assert done.err.count("\n") == 1
        assert "File name too long" in done.err
