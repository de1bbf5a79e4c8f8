"""`splinesdf offset`: where its files' numbers lie, several files, and that --check sees both."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from splinesdf.io import output as io_output
from splinesdf.io.placing import Placement, placed
from splinesdf.io.remeasured import curves_in

Run = Callable[..., tuple[int, str, str]]
FORMATS = ("a.dxf", "a.svg", "a.nc", "a.geojson", "a.wkt", "a.csv")
# 40 mm x 30 mm on a sheet of 60 mm x 50 mm, in twice as many units.
PLATE = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="50mm" viewBox="0 0 120 100">'
    '<path fill-rule="evenodd" d="M20 10H100V70H20Z M36 26V54H84V26Z"/></svg>'
)
ASKED = ("plate.svg", "-d", "2", "-d", "-3", "--tolerance", "0.02")


def all_of(names: Sequence[str]) -> list[str]:
    return [word for name in names for word in ("-o", name)]


PLACES = [
    (),
    ("--scale", "0.25"),
    ("--origin", "lower-left"),
    ("--origin", "center", "--flip"),
    ("--origin", "20,70", "--no-flip", "--scale", "3"),
    ("--flip", "--origin=-1.5,4"),
]


@pytest.mark.parametrize("where", PLACES)
def test_files_that_are_right_pass_the_check(
    run: Run, tmp_path: Path, where: Sequence[str]
) -> None:
    status, out, err = run(*ASKED, *all_of(FORMATS), *where, "--check")
    assert status == 0, out + err
    assert out.count("within the tolerance") == len(FORMATS)
    assert "NOT" not in out
    assert {path.name for path in tmp_path.iterdir()} == {"plate.svg", *FORMATS}


def test_several_files_hold_the_same(run: Run, tmp_path: Path) -> None:
    """At the distance 2 the plate is 84 by 64 units: 42 mm by 32 mm, whatever the file."""
    status, _, err = run(*ASKED, "-o", "a.dxf", "-o", "a.svg", "-o", "a.nc", "--origin", "center")
    assert status == 0, err
    for name, unit in (("a.dxf", 0.5), ("a.svg", 1.0), ("a.nc", 0.5)):
        curves = [c for c in curves_in(tmp_path / name) if c.distance == 2.0]
        points = np.concatenate([c.at(np.linspace(0.0, c.count, 50 * c.count)) for c in curves])
        assert points.max(axis=0) == pytest.approx([42.0 * unit, 32.0 * unit], abs=0.03)
        assert points.min(axis=0) == pytest.approx([-42.0 * unit, -32.0 * unit], abs=0.03)


# What a writer might get wrong. Each is put in place of the right map, and the check must see it.


def about_zero(contours: Any, suffix: str, placement: Placement, by: float) -> Any:
    """y mirrored about 0, as if there were no page."""
    return placed([replace(c, page=None) for c in contours], suffix, placement, by)


def not_scaled(contours: Any, suffix: str, placement: Placement, by: float) -> Any:
    return placed(contours, suffix, replace(placement, scale=1.0), by)


def not_converted(contours: Any, suffix: str, placement: Placement, by: float) -> Any:
    return placed(contours, suffix, placement, 1.0)


def origin_left_out(contours: Any, suffix: str, placement: Placement, by: float) -> Any:
    return placed(contours, suffix, replace(placement, origin=None), by)


def origin_not_mirrored(contours: Any, suffix: str, placement: Placement, by: float) -> Any:
    x, y = placement.origin or (0.0, 0.0)
    return placed(contours, suffix, replace(placement, origin=(x, 100.0 - float(y))), by)


def not_flipped(contours: Any, suffix: str, placement: Placement, by: float) -> Any:
    return placed(contours, suffix, replace(placement, flip=False), by)


WRONG: list[tuple[Callable[..., Any], Sequence[str], Sequence[str]]] = [
    (about_zero, (), ("a.dxf", "a.nc")),
    (about_zero, ("--flip",), FORMATS),
    (not_scaled, ("--scale", "1.01"), FORMATS),
    (not_converted, (), ("a.dxf", "a.nc")),
    (origin_left_out, ("--origin", "lower-left"), FORMATS),
    (origin_left_out, ("--origin", "3,7"), FORMATS),
    (origin_not_mirrored, ("--origin", "3,7"), FORMATS),
    (not_flipped, (), ("a.dxf", "a.nc")),
    (not_flipped, ("--flip",), FORMATS),
]


@pytest.mark.parametrize(("wrong", "where", "names"), WRONG)
def test_files_that_lie_elsewhere_fail_the_check(
    run: Run,
    monkeypatch: pytest.MonkeyPatch,
    wrong: Callable[..., Any],
    where: Sequence[str],
    names: Sequence[str],
) -> None:
    monkeypatch.setattr(io_output, "placed", wrong)
    status, out, _ = run(*ASKED, *all_of(names), *where, "--check")
    assert status == 1
    assert out.count("NOT within the tolerance") == len(names)


def test_a_file_of_another_unit_fails_the_check(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """The numbers are in inches; G21 says that they are in millimeters."""
    text_of = io_output.file_text

    def renamed(*arguments: Any, **options: Any) -> str:
        return text_of(*arguments, **options).replace("G20", "G21")

    monkeypatch.setattr("splinesdf.cli.offset.file_text", renamed)
    status, _, err = run(*ASKED, "-o", "a.nc", "--units", "inch", "--check")
    assert status == 1
    assert "expected numbers in inch" in err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("-o", "a.dxf", "-o", "a.dxf"), "different files"),
        (("-o", "a.dxf", "-o", "./a.dxf"), "different files"),
        (("-o", "a.dxf", "-o", "b/../a.dxf"), "different files"),
        (("-o", "a.dxf", "-o", "a.foo"), "ending in"),
        (("-o", "a.svg", "-o", "plate.svg"), "is the input"),
        (("-o", "a.svg", "-o", "none/a.dxf"), "does not exist"),
        (("-o", "a.svg", "-o", "b.svg", "--units", "mm"), "units only for"),
        (("-o", "a.wkt", "-o", "b.csv", "--arcs"), "arcs only for"),
        (("-o", "a.dxf", "-o", "b.svg", "--feed", "3"), "milling only for"),
        (("-o", "a.dxf", "--scale", "0"), "positive scale"),
        (("-o", "a.dxf", "--scale", "nan"), "positive scale"),
        (("-o", "a.dxf", "--origin", "left"), "lower-left, center or X,Y"),
        (("-o", "a.dxf", "--origin", "1,2,3"), "point"),
        (("-o", "a.dxf", "--origin", "1,inf"), "finite origin"),
        (("-o", "a.svg", "-o", "a.nc", "--origin", "1e14,0"), "another origin"),
    ],
)
def test_nothing_is_written_if_one_is_bad(
    run: Run, tmp_path: Path, arguments: Sequence[str], says: str
) -> None:
    (tmp_path / "b").mkdir()
    status, _, err = run(*ASKED, *arguments)
    assert status == 2
    assert says in err
    assert "Traceback" not in err
    assert {path.name for path in tmp_path.iterdir()} == {"plate.svg", "b"}


def test_each_file_takes_the_options_that_it_can_use(run: Run, tmp_path: Path) -> None:
    names = ("-o", "a.dxf", "-o", "a.nc", "-o", "a.csv")
    status, _, err = run(*ASKED, *names, "--feed", "250", "--arcs", "--units", "inch")
    assert status == 0, err
    assert "F250" in (tmp_path / "a.nc").read_text()
    assert "G20" in (tmp_path / "a.nc").read_text()
