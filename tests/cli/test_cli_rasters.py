"""`splinesdf texture` and `splinesdf atlas`: the files, what is printed and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from PIL import Image

import splinesdf as ss
from tests.cli.test_cli import Command, run  # noqa: F401, a fixture

DATA = Path(__file__).parents[1] / "data"
SANS = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
GEAR = DATA / "gear-fill.svg"


def test_texture_writes_what_the_library_makes(run: Command, tmp_path: Path) -> None:  # noqa: F811
    done = run("texture", str(GEAR), "-o", "x.png", "--texels", "40", "--range", "2")
    assert done.status == 0, done.err
    expected = ss.texture(ss.read(GEAR), 40, range=2.0)
    codes = np.asarray(Image.open(tmp_path / "x.png"))
    assert np.array_equal(codes, expected.pixels())
    assert "40 × 40 texels" in done.out
    assert "written   x.png" in done.out
    options = ("--bits", "16", "--rows", "bottom", "--domain", "0", "0", "8", "16")
    assert run("texture", str(GEAR), "-o", "y.png", "--range", "2", *options).status == 0
    turned = ss.texture(ss.read(GEAR), 64, range=2.0, domain=(0, 0, 8, 16), rows="bottom")
    assert np.array_equal(np.asarray(Image.open(tmp_path / "y.png")), turned.pixels(16))
    assert turned.values.shape == (64, 32)


@pytest.mark.parametrize("name", ["fit.npz", "fit.json"])
def test_texture_of_a_saved_fit(run: Command, name: str, tmp_path: Path) -> None:  # noqa: F811
    spline = ss.fit(ss.read(GEAR), tolerance=0.1, band=(-0.5, 0.5)).spline
    spline.save(tmp_path / name)
    done = run("texture", name, "-o", "fit.tif", "--texels", "20", "--range", "2")
    assert done.status == 0, done.err
    assert "note: the spline keeps its tolerance at distances of -0.5 to 0.5 only" in done.err
    values = np.asarray(Image.open(tmp_path / "fit.tif"))
    assert np.array_equal(values, ss.texture(spline, 20, range=2.0).values.astype(np.float32))


def test_atlas_writes_a_picture_and_its_layout(run: Command, tmp_path: Path) -> None:  # noqa: F811
    done = run("atlas", str(SANS), "-o", "a.png", "--characters", "AV ", "--y-origin", "top")
    assert done.status == 0, done.err
    expected = ss.atlas(SANS, characters="AV ")
    assert np.array_equal(np.asarray(Image.open(tmp_path / "a.png")), expected.pixels())
    assert (tmp_path / "a.json").read_text() == expected.layout(y_origin="top")
    assert "3, of which 1 with nothing to see" in done.out
    assert "written   a.json" in done.out


def test_atlas_of_a_folder_and_of_a_variable_font(run: Command, tmp_path: Path) -> None:  # noqa: F811
    folder = tmp_path / "icons"
    folder.mkdir()
    for name in ("gear-fill", "geo-alt-fill"):
        (folder / f"{name}.svg").write_bytes((DATA / f"{name}.svg").read_bytes())
    (folder / "old.png").write_text("")
    assert run("atlas", "icons", "-o", "i.png", "--em", "16", "--size", "24").status == 0
    done = run("atlas", "icons", "-o", "i.png", "--em", "each", "--size", "24")
    assert "note: 1 in the folder is no drawing" in done.err
    names = [glyph["name"] for glyph in json.loads((tmp_path / "i.json").read_text())["glyphs"]]
    assert names == ["gear-fill", "geo-alt-fill"]
    font = DATA / "fonts" / "inter-latin-wght-normal.woff2"
    assert run("atlas", str(font), "-o", "v.npy", "--axis", "wght=900", "--range", "6").status == 0
    values = np.load(tmp_path / "v.npy")
    assert np.array_equal(values, ss.atlas(font, location={"wght": 900}, range=6).values)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("texture", str(GEAR), "-o", "x.png"), "--range"),
        (("texture", str(GEAR), "-o", "x.gif", "--range", "1"), "ending in .npy, .png"),
        (("texture", str(GEAR), "-o", "x.png", "--range", "-1"), "a positive range"),
        (("texture", str(GEAR), "-o", "x.png", "--range", "1", "--bits", "12"), "8 or 16 bits"),
        (("texture", "none.svg", "-o", "x.png", "--range", "1"), "does not exist"),
        (("atlas", str(SANS), "-o", "no/x.png"), "does not exist"),
        (("atlas", str(SANS), "-o", "x.png", "--characters", "\u4e2d"), "no glyph for '\\u4e2d'"),
        (("atlas", "nothing", "-o", "x.png"), "expected a font ending in"),
        (("atlas", str(DATA), "-o", "x.png", "--em", "two"), "--em as a number or each"),
        (("atlas", str(SANS), "-o", "x.png", "--axis", "wght"), "an axis such as wght=650"),
    ],
)
def test_bad_input_is_one_line_and_status_2(
    run: Command,  # noqa: F811
    tmp_path: Path,
    arguments: tuple[str, ...],
    expected: str,
) -> None:
    done = run(*arguments)
    assert done.status == 2
    assert expected in done.err
    assert len(done.err.splitlines()) == 1
    assert done.out == ""
    assert list(tmp_path.iterdir()) == []
