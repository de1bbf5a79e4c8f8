"""`splinesdf view`: a page as a file, a page from a server, and what is refused."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from pathlib import Path
from urllib.request import urlopen

import pytest

import splinesdf as ss
from tests.cli.test_cli import Command, run

__all__ = ["run"]


def test_view_writes_a_page(run: Command, tmp_path: Path) -> None:
    done = run("view", "gamma1", "--tolerance", "0.05", "--html", "page.html", "-d", "0.05")
    assert done.status == 0, done.err
    assert "written   page.html" in done.out
    text = (tmp_path / "page.html").read_text()
    assert text.startswith("<!doctype html>")
    assert "<title>gamma1" in text
    assert run("fit", "gamma1", "--tolerance", "0.05", "-o", "fit.json").status == 0
    assert run("view", "fit.json", "--html", "again.html", "-d", "0.05").status == 0
    # The same but for the numbers, among which DXF files have dates.
    again = (tmp_path / "again.html").read_text()
    assert again.partition('id="block">')[0] == text.partition('id="block">')[0]


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("gamma1", "--html", "page.pdf"), "ending in .html"),
        (("gamma1", "--html", "no/page.html"), "does not exist"),
        (("gamma1", "-d", "1"), "--html only"),
        (("gamma1", "--tolerance", "0.1", "--html", "page.html", "-d", "nan"), "finite distance"),
        (("nothing.svg", "--html", "page.html"), "nothing.svg"),
        (("fit.npz", "--tolerance", "0.1", "--html", "page.html"), "it has its own"),
        (("cubic.npz", "--html", "page.html"), "quadratic spline"),
        (("fit.npz", "--html", "fit.npz"), "it would be lost"),
    ],
)
def test_view_refuses(run: Command, tmp_path: Path, arguments: tuple[str, ...], line: str) -> None:
    run("fit", "gamma1", "--tolerance", "0.1", "-o", "fit.npz")
    if "cubic.npz" in arguments:
        cubic = ("--element", "cubic", "--space", "uniform")
        run("fit", "gamma1", "--tolerance", "0.1", *cubic, "-o", "cubic.npz")
    done = run("view", *arguments)
    assert done.status == 2
    assert line in done.err
    assert len([one for one in done.err.splitlines() if one.startswith("splinesdf: ")]) == 1
    assert not list(tmp_path.glob("page*"))


def test_view_of_a_saved_fit_has_the_limits_that_are_given(run: Command, tmp_path: Path) -> None:
    star = ss.Shape.from_points([(0, 0), (9, 9), (9, 0), (0, 9), (4, 12), (5, -3)])
    ss.interpolate(star, (2, 2)).spline.save(tmp_path / "fit.npz")
    done = run("view", "fit.npz", "--html", "page.html", "-d", "0.5", "--limit", "crossings=1")
    assert done.status == 2
    assert "up to 1 crossings" in done.err
    assert not (tmp_path / "page.html").exists()


def test_view_opens_the_page_unless_told_not_to(
    run: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Served:
        def serve_forever(self) -> None:
            raise KeyboardInterrupt

        def server_close(self) -> None:
            """Nothing is open."""

    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr("splinesdf.web.server.make_server", lambda _: (Served(), "http://here/"))
    for arguments in ((), ("--no-open",)):
        done = run("view", "gamma1", "--tolerance", "0.1", *arguments)
        assert done.status == 0
        assert done.out == "http://here/\n"
        assert "Ctrl+C ends it." in done.err
        assert done.err.endswith("ended\n")
    assert opened == ["http://here/"]
    done = run("view", "gamma1", "--tolerance", "0.1", "--no-open", "--json")
    assert json.loads(done.out) == {"address": "http://here/"}
    assert "Ctrl+C" not in done.err


def test_view_says_that_many_cells_take_long(run: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    arguments = ("view", "gamma1", "--tolerance", "0.1", "--html", "page.html")
    assert "note:" not in run(*arguments).err
    monkeypatch.setattr("splinesdf.cli.view._MANY", 3)
    assert re.search(r"note: \d+ cells take a browser seconds to open", run(*arguments).err)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for another process")
def test_view_serves_until_interrupted(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "splinesdf", "view", "gamma1", "--tolerance", "0.1"]
    process = subprocess.Popen(
        [*command, "--no-open"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # What a shell starts in the background inherits that SIGINT is ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        with urlopen(address, timeout=60) as answer:
            assert b"gamma1" in answer.read()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    finally:
        process.kill()  # nothing, if it has ended
    assert process.returncode == 0
    assert errors.split("\n")[-3:] == ["Ctrl+C ends it.", "ended", ""]
    assert list(tmp_path.iterdir()) == []
