"""How commands read, what they say of what is missing, and how they end when they cannot go on."""

from __future__ import annotations

import dataclasses
import io
import itertools
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import splinesdf as ss
from splinesdf.paper import tables
from tests.cli.test_cli import Command, run
from tests.named_shapes import gamma

DATA = Path(__file__).parents[1] / "data"


__all__ = ["run"]


def test_columns_by_name_and_by_number(run: Command, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x,east,north\n9,0,0\n9,4,0\n9,4,3\n")
    (tmp_path / "b.csv").write_text("9,0,0\n9,4,0\n9,4,3\n")
    for name, columns in (("a.csv", ("east", "north")), ("b.csv", ("1", "2"))):
        done = run("info", name, "--columns", *columns)
        assert done.status == 0, done.err
        assert "[0, 4] × [0, 3]" in done.out


def test_axes_of_a_font(run: Command) -> None:
    font = str(DATA / "fonts" / "inter-latin-wght-normal.woff2")
    boxes = []
    for weight in (100, 900):
        done = run("info", font, "--text", "H", "--axis", f"wght={weight}")
        assert done.status == 0, done.err
        shape = ss.read(font, text="H", location={"wght": weight})
        assert f"{shape.box[2]:.6g}" in done.out
        boxes.append(shape.box)
    assert boxes[0] != boxes[1]
    for text in ("wght", "wght=bold", ""):
        done = run("info", font, "--text", "H", "--axis", text)
        assert done.status == 2
        assert done.err == f"splinesdf: expected an axis such as wght=650, got {text!r}\n"


def test_a_fit_that_is_deleted_meanwhile_is_described(
    run: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ss.fit(gamma("gamma1"), tolerance=0.1).spline.save(tmp_path / "fit.npz")
    load = ss.load

    def deleted(path: str, **options: Any) -> ss.SplineSDF:
        spline = load(path, **options)
        (tmp_path / "fit.npz").unlink()
        return spline

    monkeypatch.setattr(ss, "load", deleted)
    done = run("info", "fit.npz")
    assert done.status == 0, done.err
    assert re.search(r"size\s+no longer there", done.out)


def test_a_name_that_no_system_takes_is_refused_in_a_line(run: Command) -> None:
    """Of a .json file it is first asked whether it is a fit, which cannot be told either."""
    done = run("info", "a" * 300 + ".json")
    assert (done.status, done.out) == (2, "")
    assert re.fullmatch(r"splinesdf: a+\.\.\.: .*(too long|does not exist).*\n", done.err)


def test_a_fit_of_unknown_origin_is_described(run: Command, tmp_path: Path) -> None:
    spline = ss.fit(gamma("gamma1"), tolerance=0.1).spline
    ss.SplineSDF(spline.mesh, spline.ordinates).save(tmp_path / "fit.npz")
    done = run("info", "fit.npz")
    assert done.status == 0, done.err
    assert re.search(r"made\s+the file does not say how", done.out)


@pytest.mark.parametrize("as_json", [False, True])
def test_figures_are_drawn_where_they_are_wanted(
    as_json: bool, run: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def drawn(folder: str) -> list[Path]:
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "figure_05.png").write_text("drawn")
        return [Path(folder, "figure_05.png")]

    row = tables.Row(
        table=1, curve="gamma1", mesh="uniform", operator="V", k=0, m=8, n=8,
        error=0.5, true_error=0.5, printed=None,
    )  # fmt: skip
    monkeypatch.setattr("splinesdf.paper.figures.figures", drawn)
    monkeypatch.setattr(tables, "tables", lambda: iter([row]))
    done = run("paper", "--figures", "here", *(["--json"] if as_json else []))
    assert done.status == 0, done.err
    assert (tmp_path / "here" / "figure_05.png").read_text() == "drawn"
    if as_json:
        assert json.loads(done.out) == {"written": [str(Path("here", "figure_05.png"))]}
    else:
        assert done.out.split() == ["written", str(Path("here", "figure_05.png"))]


def test_a_row_that_the_paper_does_not_print_has_nothing_beside_it(
    run: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    [row] = itertools.islice(tables.tables(), 1)
    rows = [row, dataclasses.replace(row, operator="S", printed=None)]
    monkeypatch.setattr(tables, "tables", lambda: iter(rows))
    done = run("paper", "--tables")
    assert done.status == 0, done.err
    one, other = (line.split() for line in done.out.splitlines() if " gamma" in line)
    assert [word for word in one if word not in other] == ["V", f"{row.printed:.2e}"]


@pytest.mark.parametrize(
    ("error", "status", "says"),
    [
        (KeyboardInterrupt(), 130, "splinesdf: interrupted; nothing was written\n"),
        (
            MemoryError(),
            2,
            "splinesdf: not enough memory: raise the tolerance, or ask for a band\n",
        ),
    ],
)
def test_what_ends_a_command_is_said_in_a_line(
    error: BaseException, status: int, says: str, run: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ended(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(ss, "offset", ended)
    done = run("offset", "gamma1", "-d", "0.1", "--tolerance", "0.01", "-o", "a.svg")
    assert (done.status, done.out, done.err.lstrip("\n")) == (status, "", says)
    assert not Path("a.svg").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signs of a closed pipe")
@pytest.mark.parametrize(
    "arguments", [("--version",), ("info", "part"), ("offset", "part", "-qd-2", "-o", "wkt:-")]
)
def test_a_reader_that_has_enough_ends_a_command_without_a_word(arguments: tuple[str, ...]) -> None:
    """As ``| head``: click ends with the status 1, and nothing is flushed into the closed pipe."""
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "splinesdf", *arguments]
    with os.fdopen(writer, "wb") as closed:
        done = subprocess.run(command, stdout=closed, stderr=subprocess.PIPE, check=False)
    assert (done.returncode, done.stderr) == (1, b"")


def test_streams_that_are_no_files_take_what_is_said(
    run: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a program's that starts the command line within itself."""
    taken = io.StringIO()
    monkeypatch.setattr(sys, "stdout", taken)
    done = run("info", "part")
    assert (done.status, done.out) == (0, "")
    assert "9 (evenodd)" in taken.getvalue()


def test_no_command_is_all_commands(run: Command) -> None:
    done = run()
    assert done.status == 2
    assert done.out == ""
    assert all(name in done.err for name in ("demo", "fit", "offset", "query", "paper", "info"))


@pytest.mark.parametrize("missing", ["click", "rich"])
def test_without_its_libraries_the_command_line_names_its_extra(missing: str) -> None:
    code = (
        f"import sys; sys.modules[{missing!r}] = None; sys.argv = ['splinesdf', 'info', 'part']\n"
        "from splinesdf.cli.main import main\nmain()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == (
        'splinesdf: the command line needs: python -m pip install "splinesdf[cli]"\n'
    )


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ("offset", "part", "-d", "-2,2", "-o", "a.dxf"),
            "expected a number for -d, got '-2,2': for several give -d again for each",
        ),
        (
            ("offset", "part", "-d", "2", "--feed", "9mm", "-o", "a.nc"),
            "expected a number for --feed, got '9mm'",
        ),
        (
            ("offset", "part", "-d", "-2", "2", "-o", "a.dxf"),
            "Got unexpected extra argument (2): for a second value give its option again, "
            "as -d 2 -d 4",
        ),
        (
            ("query", "part", "fit.npz"),
            "expected a table of points, got a saved fit, 'fit.npz': give the points last",
        ),
        (
            ("query", "a fit.npz", "30, 2e1"),
            "expected a table of points, got '30, 2e1': write them into a file, or "
            "echo 30,2e1 | splinesdf query 'a fit.npz' -",
        ),
        (
            ("texture", "part", "-o", "a.png"),
            "expected --range, got none: width of the distances that are told apart, in the "
            "shape's unit",
        ),
    ],
)
def test_slips_are_told_with_the_way_on(
    run: Command, tmp_path: Path, arguments: tuple[str, ...], said: str
) -> None:
    (tmp_path / "fit.npz").write_bytes(b"PK")
    done = run(*arguments)
    assert (done.status, done.out, done.err) == (2, "", f"splinesdf: {said}\n")
