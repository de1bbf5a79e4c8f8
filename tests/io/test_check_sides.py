"""`splinesdf offset --check` sees what is lost, what is twice, and what runs the wrong way."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.cli.main import main
from splinesdf.io.enclosed import check_sides, flattened, winding_number
from splinesdf.io.remeasured import curves_in, measure_file
from tests import oracles
from tests.chains import circle
from tests.mechanical import parts
from tests.offsets.test_offset_checks import reversed_, ring
from tests.real_shapes import icons

Change = Callable[[list[ss.Contour]], list[ss.Contour]]
FORMATS = ("a.dxf", "a.svg", "a.nc", "a.geojson", "a.wkt", "a.csv")
TOLERANCE = 1e-3
DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg"><path fill-rule="evenodd" '
    'd="M0 0H40V30H0Z M8 8V22H32V8Z M100 3A3 3 0 0 1 94 3A3 3 0 0 1 100 3Z"/></svg>'
)


def longest(contours: list[ss.Contour]) -> int:
    return int(np.argmax([contour.length for contour in contours]))


CHANGES: dict[str, Change] = {
    "a lost loop": lambda c: [x for x in c if x.length > min(y.length for y in c)],
    "a lost outline": lambda c: [x for i, x in enumerate(c) if i != longest(c)],
    "a lost hole": lambda c: [x for x in c if x.parent is None],
    "a loop twice": lambda c: [*c, replace(c[longest(c)])],
    "a hole twice": lambda c: [*c, *(replace(x) for x in c if x.parent is not None)],
}


@pytest.fixture
def run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str, str]]:
    """Run ``splinesdf offset`` with offsets that are changed."""
    real = ss.offset
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drawing.svg").write_text(DRAWING)

    def command(change: Change, *arguments: str) -> tuple[int, str, str]:
        def offset(*given: object, **options: object) -> list[ss.Contour]:
            return change(real(*given, **options))

        monkeypatch.setattr(ss, "offset", offset)
        monkeypatch.setattr(sys, "argv", ["splinesdf", "offset", "drawing.svg", *arguments])
        with pytest.raises(SystemExit) as caught:
            main()
        return int(caught.value.code or 0), *capsys.readouterr()

    return command


Run = Callable[..., tuple[int, str, str]]
ASKED = ("--tolerance", str(TOLERANCE), "--check")


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("distance", ["1", "-1"])
def test_what_is_right_passes(run: Run, name: str, distance: str) -> None:
    status, out, err = run(list, "-d", distance, "-o", name, *ASKED)
    # G-code says that numbers without a unit are taken for millimeters, and which feed it has.
    assert status == 0
    said = ("does not say its unit", "no --feed is given")
    assert all(any(text in line for text in said) for line in err.splitlines())
    assert " 0 on the wrong side" in out


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("distance", ["1", "-1"])
@pytest.mark.parametrize("fault", CHANGES)
def test_each_fault_has_status_1(run: Run, name: str, distance: str, fault: str) -> None:
    status, out, err = run(CHANGES[fault], "-d", distance, "-o", name, *ASKED)
    assert status == 1
    assert "NOT within the tolerance" in out
    assert f"at distance +{distance}" in err or f"at distance {distance}" in err
    assert "Traceback" not in err


def test_no_contour_where_there_should_be_one_is_no_empty_offset(run: Run) -> None:
    status, _, err = run(lambda contours: [], "-d", "1", "-o", "a.svg", "--tolerance", "1e-3")
    assert status == 1
    assert "not enclosed" in err
    status, _, err = run(list, "-d", "-30", "-o", "a.svg", "--tolerance", "1e-3")
    assert status == 2
    assert "nothing to write" in err


def test_steps_that_end_too_early_are_found(run: Run) -> None:
    asked = ("--step", "-1", "-o", "a.svg", *ASKED)
    assert run(list, *asked)[0] == 0
    last = -3.0  # of the walls and the disk, 8 wide
    status, _, err = run(lambda contours: [c for c in contours if c.distance > last], *asked)
    assert status == 1
    assert "at distance -3" in err


@pytest.mark.parametrize("check", [(), ("--check",)])
def test_a_deviation_above_the_tolerance_has_status_1(run: Run, check: tuple[str, ...]) -> None:
    def spoil(contours: list[ss.Contour]) -> list[ss.Contour]:
        return [replace(c, arcs=c.arcs + 2.0 * TOLERANCE) for c in contours]

    asked = ("-d", "1", "-o", "a.svg", "--tolerance", str(TOLERANCE), *check)
    status, _, err = run(spoil, *asked)
    assert status == 1
    assert "expected a deviation of at most 0.001" in err
    assert run(list, *asked)[0] == 0


@pytest.mark.parametrize("name", ["a.nc", "a.geojson"])
@pytest.mark.parametrize("d", [0.5, -0.5])
@pytest.mark.parametrize("direction", ["climb", "conventional"])
def test_the_way_around_matters_where_it_does(
    tmp_path: Path, name: str, d: float, direction: str
) -> None:
    washer = parts()["washer"]
    options = {"milling": ss.Milling(direction=direction)} if name == "a.nc" else {}
    for contours, right in ((ring(d), True), ([*ring(d)[:1], reversed_(ring(d)[1])], False)):
        ss.write(tmp_path / name, contours, tolerance=1e-4, **options)
        worst = measure_file(tmp_path / name, washer, [d], TOLERANCE)
        # GeoJSON's holes are turned by the writer, which knows them by their parents.
        assert worst.keeps(TOLERANCE) == right
        assert all(sides.lost == sides.spurious == 0 for sides in worst.sides if right)


@pytest.mark.parametrize("name", ["a.wkt", "a.geojson", "a.csv"])
def test_a_loop_that_is_a_point_is_found(tmp_path: Path, name: str) -> None:
    """Just where the disk's inner offset ends, every point of it is at the right distance."""
    disk = ss.Shape.from_formula("1000 + 2*cos(t)", "2*sin(t)")
    for radius, right in ((1e-9, True), (1e-14, False)):
        there = circle(radius, (1000.0, 0.0), -2.0)
        ss.write(tmp_path / name, [there], tolerance=1e-4)
        worst = measure_file(tmp_path / name, disk, [-2.0], TOLERANCE)
        assert worst.deviation < 1e-8
        assert worst.keeps(TOLERANCE) == right


def test_small_loops_beside_something_large_are_asked_for() -> None:
    """From each piece of the boundary, in shares of its own length."""
    path = "M0 0H1000000V1000000H0Z M-16 50A4 4 0 0 1 -24 50A4 4 0 0 1 -16 50Z"
    shape = ss.Shape.from_svg_path(path)
    for distance in (1.0, -1.0):
        contours = ss.offset(shape, distance, tolerance=TOLERANCE)
        lines = [c.points(0.1 * TOLERANCE) for c in contours]
        lines = [max(lines, key=lambda line: np.ptp(line, axis=0).max())]
        lines += [circle(4.0 + distance, (-20.0, 50.0)).points(0.1 * TOLERANCE)]
        assert check_sides(shape, distance, lines, TOLERANCE).wrong == 0
        assert check_sides(shape, distance, lines[:1], TOLERANCE).lost > 10


@pytest.mark.parametrize("left", [1e-2, 1e-3, 1e-4])
def test_what_little_is_left_of_a_large_shape_is_asked_for(left: float) -> None:
    """Next to the middle of a long side only, between any samples."""
    half = math.sqrt(40.0 * left)  # so that the inscribed circle's radius is 5 + 2 left
    shape = ss.Shape.from_svg_path(f"M0 0H1000V10H{613 + half}V20H{613 - half}V10H0Z")
    found = ss.offset(shape, -5.0 - left, tolerance=0.01 * left)
    assert found
    sides = check_sides(shape, -5.0 - left, [], 0.01 * left)
    assert sides.lost > 0
    lines = [contour.points(1e-3 * left) for contour in found]
    assert check_sides(shape, -5.0 - left, lines, 0.01 * left).wrong == 0


@pytest.mark.parametrize(
    ("name", "share"), [("fingerprint", -0.01), ("rocket-takeoff", 0.01), ("umbrella-fill", 0.2)]
)
def test_icons_pass_and_each_loop_counts(name: str, share: float) -> None:
    shape = icons()[name]
    distance, tolerance = share * shape.size, 1e-5 * shape.size
    contours = ss.offset(shape, distance, tolerance=tolerance)
    lines = [contour.points(0.1 * tolerance) for contour in contours]
    assert check_sides(shape, distance, lines, tolerance, turn=1).wrong == 0
    for k in range(len(lines)):
        assert check_sides(shape, distance, lines[:k] + lines[k + 1 :], tolerance).wrong > 0
        turned = [*lines[:k], lines[k][::-1], *lines[k + 1 :]]
        assert check_sides(shape, distance, turned, tolerance, turn=1).wrong > 0
        assert check_sides(shape, distance, [*lines, lines[k]], tolerance).wrong > 0


def test_winding_numbers_are_those_of_the_slow_way() -> None:
    random = np.random.default_rng(3)
    lines = [random.integers(0, 20, (n, 2)).astype(np.float64) for n in (3, 9, 40)]
    points = random.uniform(-1.0, 21.0, (2000, 2))
    closed = [np.concatenate([line, line[:1]]) for line in lines]
    expected = oracles.winding_number(closed, points)
    assert np.array_equal(winding_number(lines, points), expected)
    assert np.array_equal(winding_number(closed, points), expected)
    assert len(np.unique(expected)) > 4


def test_polylines_stay_within_a_quarter_of_the_tolerance() -> None:
    def at(u: np.ndarray) -> np.ndarray:
        return np.stack([np.cos(u), np.sin(u)], -1)

    line = flattened(at, 6, 1e-4)
    middles = 0.5 * (line[:-1] + line[1:])
    assert 1e-6 < np.abs(1.0 - np.hypot(*middles.T)).max() <= 0.25e-4


def test_halving_of_a_curve_that_jumps_ends() -> None:
    def step(t: Any) -> Any:
        return np.stack([t, np.where(t < 0.3, 0.0, 1.0)], axis=-1)

    points = flattened(step, 1, 1e-6)
    assert len(points) == 5 + 20
    assert np.ptp(points[:, 1]) == 1.0
    assert np.min(np.diff(points[:, 0])) == 0.25 * 2.0**-20


def test_a_curve_that_is_a_point_asks_for_nothing_beside_it() -> None:
    square = ss.Shape.from_points([(0, 0), (9, 0), (9, 9), (0, 9)])
    (contour,) = ss.offset(square, -1.0, tolerance=1e-3)
    ring = contour.points(1e-4)
    point = np.full((3, 2), 4.5)
    alone, both = (check_sides(square, -1.0, curves, 1e-3) for curves in ([ring], [ring, point]))
    assert (alone.wrong, both.wrong) == (0, 0)
    assert both.asked < alone.asked


def test_a_file_without_a_curve_cannot_be_checked(tmp_path: Path) -> None:
    square = ss.Shape.from_points([(0, 0), (9, 0), (9, 9), (0, 9)])
    (tmp_path / "a.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
    with pytest.raises(ss.InputError, match=r"a\.svg: expected at least one curve, found none"):
        measure_file(tmp_path / "a.svg", square, [-1.0], tolerance=1e-3)


@pytest.mark.parametrize(("turn", "way"), [("G2", -1.0), ("G3", 1.0)])
def test_an_arc_from_a_point_to_itself_is_checked_as_machines_run_it(
    tmp_path: Path, turn: str, way: float
) -> None:
    """`write` has none: a full circle is two arcs, and one of no length is left out."""
    (tmp_path / "a.nc").write_text(f"G21\nG0 X5 Y1\nG1 Z-1\n{turn} X5 Y1 I-3 J0\nG0 Z5\n")
    (curve,) = curves_in(tmp_path / "a.nc")
    u = np.linspace(0.0, 1.0, 41)
    angle = way * 2.0 * math.pi * u
    around = np.stack([2.0 + 3.0 * np.cos(angle), 1.0 + 3.0 * np.sin(angle)], axis=1)
    np.testing.assert_allclose(curve.at(curve.count * u), around, atol=1e-12)
