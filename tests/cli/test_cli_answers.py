"""How commands answer: as JSON, quietly, through pipes; and what a shell completes."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.cli.main import commands, main

SQUARE = "0,0\n1,0\n1,1\n0,1\n"
COMMANDS: dict[str, tuple[str, ...]] = {
    "info": ("square.csv", "--measure"),
    "fit": ("square.csv", "--tolerance", "0.05", "-o", "fit.npz"),
    "offset": ("square.csv", "-d", "0.25", "-d", "-0.125", "-o", "a.svg", "--check"),
    "query": ("square.csv", "points.csv"),
    "texture": ("square.csv", "--texels", "8", "--range", "0.5", "-o", "a.png"),
    "atlas": ("drawings", "-o", "b.png"),
    "axis": ("square.csv", "-o", "c.svg"),
    "thickness": ("square.csv", "--side", "outside"),
    "vcarve": ("square.csv", "-o", "d.nc", "--check"),
    "view": ("square.csv", "--tolerance", "0.1", "--html", "a.html"),
}


class Run(NamedTuple):
    """How a command ended."""

    status: int
    out: str
    err: str


Command = Callable[..., Run]


@pytest.fixture
def run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsysbinary: pytest.CaptureFixture[bytes]
) -> Command:
    """Run ``splinesdf`` with these arguments in a folder with a square, and with standard input."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "square.csv").write_text(SQUARE)
    (tmp_path / "points.csv").write_text("0.5,0.25\nnan,1\n3,4\n")
    (tmp_path / "drawings").mkdir()
    (tmp_path / "drawings" / "one.svg").write_text('<svg><path d="M0 0h5v5H0z"/></svg>')

    def command(*arguments: str, given: bytes = b"") -> Run:
        monkeypatch.setattr(sys, "argv", ["splinesdf", *arguments])
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(given)))
        with pytest.raises(SystemExit) as caught:
            main()
        out, err = capsysbinary.readouterr()
        return Run(int(caught.value.code or 0), out.decode(), err.decode())

    return command


def as_json(done: Run) -> Any:
    """What was printed: one JSON text without NaN or infinity, which JSON has not."""
    assert done.status == 0, done.err

    def refuse(name: str) -> None:
        pytest.fail(f"{name} in JSON")

    return json.loads(done.out, parse_constant=refuse)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_answers_in_json_or_not_at_all(name: str, run: Command) -> None:
    figures = as_json(run(name, *COMMANDS[name], "--json"))
    assert figures
    for file in figures.get("written", []):
        assert Path(file).stat().st_size > 0
    quiet = run(name, *COMMANDS[name], "--quiet")
    assert quiet.status == 0
    assert quiet.err == ""
    # A table of distances on standard output is what was asked for.
    assert bool(quiet.out) == (name == "query")


def test_json_is_what_python_says(run: Command) -> None:
    square = ss.Shape.from_points([(0, 0), (1, 0), (1, 1), (0, 1)])
    figures = as_json(run("info", "square.csv", "--json", "--measure"))
    assert (figures["loops"], figures["pieces"], figures["area"], figures["length"]) == (1, 4, 1, 4)
    assert figures["box"] == [0, 0, 1, 1]
    figures = as_json(run("query", "square.csv", "points.csv", "--json"))
    assert figures["points"] == [[0.5, 0.25], [None, 1.0], [3.0, 4.0]]
    assert figures["distance"] == [-0.25, None, square.signed_distance((3, 4))]
    figures = as_json(run("offset", *COMMANDS["offset"], "--json"))
    outer, inner = figures["offsets"]
    assert (outer["distance"], outer["loops"], inner["distance"]) == (0.25, 1, -0.125)
    assert outer["length"] == pytest.approx(4 + np.pi / 2, rel=1e-12)
    assert inner["length"] == pytest.approx(3.0, rel=1e-12)
    (check,) = figures["checks"]
    assert check["kept"]
    assert check["curves"] == 2
    figures = as_json(run("texture", *COMMANDS["texture"], "--json"))
    assert figures["texels"] == [8, 8]


def test_several_files_are_described_one_after_the_other(run: Command) -> None:
    names = ["square.csv", "part", "gamma2"]
    assert [one["shape"] for one in as_json(run("info", *names, "--json"))] == [
        *("square", "part", "gamma2")
    ]
    text = run("info", *names).out
    assert text.count("loops") == 3
    assert text.count("\n\n") == 2
    bad = run("info", "square.csv", "none.csv")
    assert (bad.status, bad.out) == (2, "")
    assert "none.csv" in bad.err


def test_a_check_that_fails_is_said_in_json_too(run: Command, monkeypatch: Any) -> None:
    from splinesdf.cli import offset

    written = offset.write_text
    monkeypatch.setattr(
        offset, "write_text", lambda path, text: written(path, text.replace("1.25", "1.2"))
    )
    done = run("offset", *COMMANDS["offset"], "--json")
    assert done.status == 1
    assert not json.loads(done.out)["checks"][0]["kept"]


def test_what_is_piped_is_read_and_written_as_files_are(run: Command, tmp_path: Path) -> None:
    csv, svg = SQUARE.encode(), (tmp_path / "drawings" / "one.svg").read_bytes()
    assert as_json(run("info", "svg:-", "--json", "--measure", given=svg))["area"] == 25
    (tmp_path / "one.svg").write_bytes(svg)
    for wanted in ("svg", "dxf", "wkt"):
        piped = run("offset", "svg:-", "-d", "1", "-o", f"{wanted}:-", given=svg)
        assert piped.err == ""
        assert run("offset", "one.svg", "-d", "1", "-o", f"b.{wanted}").status == 0
        # but for the day and the mark of the file that DXF holds
        kept = (tmp_path / f"b.{wanted}").read_text()
        assert piped.out == kept or (wanted == "dxf" and len(piped.out) > 0.9 * len(kept))
    table = run("query", "square.csv", "-", given=b"0.5,0.25\n")
    assert table.out.splitlines()[1].startswith("0.5,0.25,-0.25,")
    fit = run("fit", "csv:-", "--tolerance", "0.05", "-o", "json:-", given=csv)
    spline = ss.SplineSDF.from_dict(json.loads(fit.out))
    assert abs(spline((0.5, 0.5)) + 0.5) <= 0.05


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("info", "-"), "format of what is piped, as svg:-"),
        (("info", "oops:-"), "ending in"),
        (("offset", "part", "-d", "2", "-o", "svg:-", "--json"), "--json or a file"),
        (("offset", "part", "--json", "-d", "2", "-o", "svg:-"), "--json or a file"),
        (("offset", "part", "-d", "2", "-o", "svg:-", "-o", "dxf:-"), "got two"),
        (("offset", "part", "-d", "2", "-o", "doc:-"), "ending in"),
        (("completion", "tcsh"), "not one of"),
    ],
)
def test_pipes_that_cannot_be_are_refused_in_one_line(
    run: Command, words: tuple[str, ...], message: str
) -> None:
    done = run(*words, given=b"")
    assert (done.status, done.out) == (2, "")
    assert message in done.err
    assert done.err.count("\n") == 1


@pytest.mark.skipif(sys.platform == "win32", reason="bash")
def test_a_shell_completes_commands_options_and_shapes(run: Command) -> None:
    script = run("completion", "bash").out
    assert "_SPLINESDF_COMPLETE=bash_complete" in script

    def completed(line: str) -> list[str]:
        words = line.split(" ")
        done = subprocess.run(
            [sys.executable, "-m", "splinesdf"],
            env={
                **os.environ,
                "PYTHONPATH": str(Path(ss.__file__).parents[1]),
                "_SPLINESDF_COMPLETE": "bash_complete",
                "COMP_WORDS": line,
                "COMP_CWORD": str(len(words) - 1),
            },
            capture_output=True,
            check=False,
            text=True,
        )
        return done.stdout.split()

    assert set(completed("splinesdf ")) == {f"plain,{name}" for name in commands.commands}
    assert {"plain,gamma1", "plain,gamma2", "plain,gamma3"} < set(completed("splinesdf info ga"))
    assert "plain,--tolerance" in completed("splinesdf fit part --to")


def test_a_file_is_not_written_twice(run: Command, tmp_path: Path) -> None:
    done = run("fit", "gamma2", "--tolerance", "0.1", "-o", "a.npz", "-o", "./a.npz")
    assert (done.status, done.out) == (2, "")
    assert "'./a.npz' twice" in done.err
    assert not list(tmp_path.glob("*.npz"))
