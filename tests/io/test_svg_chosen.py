"""What is read of a drawing: by layer, id, color; and options that a format has no use for."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

import splinesdf as ss
from splinesdf.cli.main import main
from splinesdf.io.readers import READERS, USED
from splinesdf.io.readers.source import DEFAULTS
from tests.reading import assert_one_line

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg"
  xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" viewBox="0 0 100 100">
<g inkscape:groupmode="layer" inkscape:label="Cut" id="layer1">
  <rect id="a" width="10" height="10" stroke="red" fill="none"/>
  <rect id="b" x="20" width="10" height="10"/>
</g>
<g id="engrave"><path d="M50 50h10" stroke="#00f"/>
  <g id="q"><rect x="70" y="70" width="5" height="5"/></g></g>
<use id="again" href="#b" x="50"/>
</svg>"""

GIVEN: dict[str, Any] = {
    "stroke": "outline",
    "ignore": "mask",
    "layers": "A",
    "ids": "a",
    "stroke_color": "red",
    "gap": 1.0,
    "columns": (0, 1),
    "text": "A",
    "size": 3.0,
    "location": {"wght": 400.0},
}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "drawing.svg"
    path.write_text(DRAWING, "utf-8")
    return path


@pytest.mark.parametrize(
    ("options", "box"),
    [
        ({"layers": "Cut"}, (20.0, 0.0, 30.0, 10.0)),
        ({"layers": "engrave"}, (70.0, 70.0, 75.0, 75.0)),
        ({"layers": ["Cut", "q"]}, (20.0, 0.0, 75.0, 75.0)),
        ({"ids": "q"}, (70.0, 70.0, 75.0, 75.0)),
        ({"ids": "again"}, (70.0, 0.0, 80.0, 10.0)),
        ({"ids": "layer1"}, (20.0, 0.0, 30.0, 10.0)),
        ({"ids": "a", "stroke": "centre"}, (0.0, 0.0, 10.0, 10.0)),
        ({"stroke": "centre", "stroke_color": "#F00"}, (0.0, 0.0, 10.0, 10.0)),
        ({"stroke": "outline", "stroke_color": "rgb(0,0,255)"}, (50.0, 49.5, 60.0, 50.5)),
    ],
)
def test_what_is_asked_for_is_read(
    file: Path, options: dict[str, Any], box: tuple[float, ...]
) -> None:
    shape = ss.read(file, **options)
    assert shape.box == box
    assert any("elements that were not asked for" in note for note in shape.notes)


@pytest.mark.parametrize("option", ["layers", "ids", "stroke_color"])
def test_what_is_not_there_is_refused(file: Path, option: str) -> None:
    with pytest.raises(ss.InputError, match=r"that are seen, of .*, got 'lime'") as error:
        ss.read(file, **{option: "lime"})
    assert_one_line(error.value, file.name)


def test_asking_for_what_excludes_each_other_is_refused(file: Path) -> None:
    with pytest.raises(ss.InputError, match="all that was asked for, got none"):
        ss.read(file, ids="a", layers="engrave")


@pytest.mark.parametrize("suffix", sorted(READERS))
def test_options_without_use_are_refused(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"file{suffix}"
    path.write_text("nothing", "utf-8")
    for option, value in GIVEN.items():
        if option not in USED[suffix]:
            with pytest.raises(ss.InputError, match=f"expected {option} only for .*: leave it out"):
                ss.read(path, **{option: value})


def test_all_options_are_tried_and_all_readers_listed() -> None:
    assert set(GIVEN) == set(DEFAULTS) - {"fill", "close", "limits"}
    assert set(USED) == set(READERS)


def test_the_command_line_chooses_as_well(
    file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    flags = ["--stroke", "centre", "--stroke-color", "red", "--id", "layer1", "--layer", "Cut"]
    monkeypatch.setattr(sys, "argv", ["splinesdf", "info", str(file), *flags])
    with pytest.raises(SystemExit) as caught:
        main()
    assert not caught.value.code
    assert "[0, 10] × [0, 10]" in capsys.readouterr().out
