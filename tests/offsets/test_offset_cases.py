"""Small shapes whose right offsets are known: by formula, by counting, or by GEOS.

`values.csv`: number of loops and area of shapes that reports to other libraries are about. Below
it are shapes that were wrong here, each with what is right: loops, arcs, area.
"""

from __future__ import annotations

import csv
import math
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf import bbox

import splinesdf as ss
from splinesdf.cli.main import main
from splinesdf.contours.contour import Contour
from splinesdf.offsets.offset import deviation
from tests.offset_crossings import meetings
from tests.offset_region import judge_region, slack

DATA = Path(__file__).parents[1] / "data" / "offsets"
with (DATA / "values.csv").open(encoding="utf-8", newline="") as stream:
    VALUES = list(csv.DictReader(stream))
# The tolerance for those, a share of the size, and what areas are printed to.
TOLERANCE, PRINTED = 1e-6, 1e-6
# CPU seconds in which an offset of a few pieces is done, compiling it all included. More: those
# that have no end hold up the tests; fewer: a slow machine compiles as long.
CEILING = 1200


def area(contours: list[Contour]) -> float:
    return sum(contour.area for contour in contours)


def arcs(contours: list[Contour]) -> int:
    return sum(len(contour.arcs) for contour in contours)


def check(shape: ss.Shape, contours: list[Contour], distance: float, tolerance: float) -> None:
    """Deviation, sides, area and loops by the other judge; no arcs that meet."""
    assert judge_region(shape, contours, distance, tolerance).failures == []
    assert len(meetings(contours)) == 0


def check_no_stubs(shape: ss.Shape, contours: list[Contour]) -> None:
    """No arc is shorter than a share of the size that no drawing has."""
    shortest = min(np.hypot(*(c.arcs[:, 2] - c.arcs[:, 0]).T).min() for c in contours)
    assert shortest > 1e-8 * shape.size


@pytest.mark.parametrize("row", VALUES, ids=[f"{r['file']} {r['distance']}" for r in VALUES])
def test_loops_and_area_are_those_known(row: dict[str, str]) -> None:
    shape = ss.read(DATA / row["file"])
    tolerance = TOLERANCE * shape.size
    # Some distances are below the tolerance.
    contours = ss.offset(shape, float(row["distance"]), tolerance=tolerance, coarse=True)
    assert len(contours) == int(row["loops"])
    # What rounding makes of the area of a triangle of 1e-9.
    rounding = slack(shape, 0.0) ** 2
    assert area(contours) == pytest.approx(float(row["area"]), rel=PRINTED, abs=rounding)


@pytest.mark.parametrize(
    ("file", "distance", "tolerance", "loops", "right", "most"),
    [
        ("bad_utm_rounded.svg", 0.5, 1e-3, 1, 11 * 7 - (4 - math.pi) * 1.5**2, 8),
        ("bad_utm_rounded.svg", -0.5, 1e-3, 1, 9 * 5 - (4 - math.pi) * 0.5**2, 8),
        ("bad_utm_rounded.svg", -2.0, 1e-3, 1, 12.0, 4),
        ("bad_far_circle.svg", 0.5, 1e-3, 1, math.pi * 1.5**2, 4),
        ("circle_r5_at_utm.svg", 1.0, 1e-3, 1, math.pi * 6.0**2, 4),
        (
            *("circle_and_rect_at_utm.svg", -1.0, 1e-3, 2),
            *(math.pi * 4.0**2 + 18 * 8 - (4 - math.pi) * 2.0**2, 12),
        ),
        ("bad_touching_triangles.svg", 1.0, 1e-3, 1, 1435.74198815, 16),
        ("bad_touching_triangles.svg", 3.0, 1e-3, 1, 2326.0471887, 16),
        ("bad_touching_triangles.svg", 10.0, 1e-3, 1, 5639.738245, 16),
        ("bad_touching_fan.svg", 2.0, 1e-3, 1, 433.142984, 16),
    ],
)
def test_lines_and_circles_far_away_or_touching_are_exact(
    file: str, distance: float, tolerance: float, loops: int, right: float, most: int
) -> None:
    shape = ss.read(DATA / file)
    contours = ss.offset(shape, distance, tolerance=tolerance)
    assert len(contours) == loops
    # Rounding of where it is drawn, all along.
    around = sum(contour.length for contour in contours)
    assert area(contours) == pytest.approx(right, rel=1e-9, abs=around * slack(shape, distance))
    assert arcs(contours) <= most
    check(shape, contours, distance, tolerance)


@pytest.mark.parametrize(("distance", "right"), [(0.5, 35.6827), (-0.3, 18.3064)])
def test_curves_far_away_are_where_they_would_be_at_home(distance: float, right: float) -> None:
    shape = ss.read(DATA / "bad_utm_bezier.svg")
    contours = ss.offset(shape, distance, tolerance=1e-3)
    assert len(contours) == 1
    assert area(contours) == pytest.approx(right, abs=1e-3 * contours[0].length)
    check(shape, contours, distance, 1e-3)


@pytest.mark.parametrize(
    ("file", "distance", "tolerance"),
    [("bad_near_straight.csv", -5.0, 1e-9), ("bad_c920.svg", 5.0, 1e-6)],
)
def test_turns_that_are_nearly_none_keep_the_tolerance(
    file: str, distance: float, tolerance: float
) -> None:
    shape = ss.read(DATA / file)
    contours = ss.offset(shape, distance, tolerance=tolerance)
    assert deviation(shape, contours) <= tolerance
    check(shape, contours, distance, tolerance)


def test_a_small_circle_beside_a_large_square_is_kept() -> None:
    path = "M0 0H1000000V1000000H0Z M-16 50A4 4 0 0 1 -24 50A4 4 0 0 1 -16 50Z"
    shape = ss.Shape.from_svg_path(path)
    contours = ss.offset(shape, 1.0, tolerance=1e-3)
    assert len(contours) == 2
    small = min(contours, key=lambda contour: contour.length)
    assert abs(small.area) == pytest.approx(math.pi * 5.0**2, rel=1e-9)
    check(shape, contours, 1.0, 1e-3)


# Path data or file, distance, tolerance, number of arcs at most, fill rule. "About 13" is up to 16,
# "some 20" up to 30: what shapes like them have, and what nobody would look at twice.
FEW = [
    ("hole_touching_corner_evenodd.csv", 0.125, 1e-3, 15, "evenodd"),
    ("M51 38L30 16L18 2Z M51 38L4 0L10 48Z", 1.0, 1e-3, 16, None),
    ("zero_handle_corner.svg", 0.48, 1e-4, 24, None),
    ("zero_handle_corner.svg", 0.479996557974909, 1e-4, 24, None),
    ("zero_handle_corner.svg", 0.5, 1e-4, 24, None),
    ("M 40 -27 C 8 37 36 -49 36 -49 L -2 -9 L -17 -20 L -48 -3 Z", 2.0, 1e-4, 30, None),
    ("M 40 -27 C 8 37 36 -49 36 -49 L -2 -9 L -17 -20 L -48 -3 Z", 2.07, 1e-4, 30, None),
    ("M 40 -27 C 8 37 36 -49 36 -49 L -2 -9 L -17 -20 L -48 -3 Z", 2.5, 1e-4, 30, None),
    ("M 25 -56 C 25 -56 7 47 20 -43 L -55 -5 L 40 -3 Z", 5.84, 1e-4, 24, None),
    ("M 0 0 C 3 0 -2 0 1 0 L 1 1 Z", 0.001, 1e-6, 9, None),
]


@pytest.mark.parametrize(("drawn", "distance", "tolerance", "most", "fill"), FEW)
def test_few_arcs_and_simple_rings(
    drawn: str, distance: float, tolerance: float, most: int, fill: str | None
) -> None:
    if drawn.endswith("Z"):
        shape = ss.Shape.from_svg_path(drawn)
    else:
        shape = ss.read(DATA / drawn, fill=fill)
    contours = ss.offset(shape, distance, tolerance=tolerance)
    assert 0 < arcs(contours) <= most
    check(shape, contours, distance, tolerance)
    check_no_stubs(shape, contours)


# Each in a process of its own: they had no end, or took gigabytes.
ENDLESS = {
    "part, 1e4 sizes": ('read_shape("part", {})', 1e6, 1e-2, 9),
    "part, 1e7 sizes": ('read_shape("part", {})', 1e9, 1.0, 10),
    "polygon, 2e5 sizes": ("ss.Shape.from_points([(0, 0), (4, 0), (3, 3), (1, 4)])", 1e6, 1e-3, 11),
    "polygon, 2e6 sizes": ("ss.Shape.from_points([(0, 0), (4, 0), (3, 3), (1, 4)])", 1e7, 1e-3, 11),
    "lens": ('ss.read("tests/data/offsets/lens_zero_speed_corners.json")', 0.01, 1e-4, 10),
}


@pytest.mark.parametrize("name", ENDLESS)
def test_few_arcs_or_a_refusal_at_once(name: str) -> None:
    shape, distance, tolerance, most = ENDLESS[name]
    program = f"""
import resource, sys
resource.setrlimit(resource.RLIMIT_CPU, ({CEILING}, {CEILING}))
import splinesdf as ss
from splinesdf.cli.shapes import read_shape
from tests.offset_region import judge_region
shape = {shape}
try:
    contours = ss.offset(shape, {distance!r}, tolerance={tolerance!r})
except ss.SplineSDFError as error:
    sys.exit(f"refused: {{error}}")
number = sum(len(contour.arcs) for contour in contours)
print(len(contours), number)
if number <= {most}:
    print(judge_region(shape, contours, {distance!r}, {tolerance!r}).failures)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    if done.returncode == 1 and done.stderr.startswith("refused: "):
        assert name != "lens"
        assert done.stderr.count("\n") == 1
        return
    assert done.returncode == 0, f"status {done.returncode}: {done.stderr[-500:]}"
    loops, number = map(int, done.stdout.split("\n")[0].split())
    assert (loops, number <= most) == (1, True), f"{number} arcs"
    assert done.stdout.split("\n")[1] == "[]"


@pytest.mark.parametrize(
    ("points", "band", "tolerance"),
    [
        ([(0, 0), (1, 0), (1, 1), (0, 1)], (0.0, 0.03), 0.003),
        ([(0.7, 0.5), (0.7, 0.2), (0.6, 0.8)], (0.012, 0.012), 0.0018),
        ([(0.8, 0), (0.4, 0.3), (0.8, 0.8)], (-0.016, 0.016), 0.0024),
        ([(0.1, 0.8), (0.3, 0.8), (0.6, 0.9)], (-0.05, -0.025), 0.005),
    ],
)
def test_the_error_in_a_band_is_below_its_bound(
    points: list[tuple[float, float]], band: tuple[float, float], tolerance: float
) -> None:
    shape = ss.Shape.from_points(points)
    result = ss.fit(shape, tolerance=tolerance, band=band)
    assert result.stopped == "reached"
    assert result.bound is not None
    assert result.error <= result.bound <= tolerance
    xmin, ymin, xmax, ymax = result.spline.domain
    asked = np.random.default_rng(5).uniform((xmin, ymin), (xmax, ymax), (100_000, 2))
    exact = ss.signed_distance(shape, asked)
    # A level is no set of samples: points beside it are moved onto it along the gradient.
    onto = np.clip(exact, *band)
    near = np.abs(exact - onto) < 0.05
    found = ss.project(shape, asked[near])
    ways = (asked[near] - found.point) / found.distance[:, None]
    moved = asked[near] + (onto - exact)[near, None] * ways
    exact = ss.signed_distance(shape, moved)
    there = (exact >= band[0] - 1e-12) & (exact <= band[1] + 1e-12)
    if band[1] < -0.0196:  # deeper than the inscribed circle of the last one
        assert not there.any()
        assert result.error == 0.0
        return
    assert there.sum() > 1000
    assert np.abs(result.spline(moved[there]) - exact[there]).max() <= result.bound


# --- what a user of drawings expects -------------------------------------------------------------

Run = Callable[..., tuple[str, str]]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run ``splinesdf offset`` on one of the drawings in a folder of its own."""

    def run(file: str, *arguments: str) -> tuple[str, str]:
        monkeypatch.chdir(tmp_path)
        given = ["splinesdf", "offset", str(DATA / file), *arguments]
        monkeypatch.setattr(sys, "argv", given)
        with pytest.raises(SystemExit) as caught:
            main()
        out, err = capsys.readouterr()
        assert not caught.value.code, err
        return out, err

    return run


def test_a_drawing_that_says_its_unit_is_not_called_another(run: Run, tmp_path: Path) -> None:
    """100 mm are 378 units: in mm, or with a note."""
    _, said = run(
        "behaviour_mm.svg", "--stroke", "centre", "-d", "0.1", "--units", "mm", "-o", "x.dxf"
    )
    if re.search(r"note: .*\bmm\b", said) is None:
        box = bbox.extents(ezdxf.readfile(tmp_path / "x.dxf").modelspace())
        assert box.size.x == pytest.approx(80.0 + 0.2, abs=0.3)


def test_open_paths_end_to_end_are_one_loop(run: Run, tmp_path: Path) -> None:
    run(
        "behaviour_joined.svg",
        "--stroke",
        "centre",
        "--close",
        "-d",
        "1",
        "--tolerance",
        "1e-3",
        "-o",
        "x.svg",
    )
    shape = ss.read(DATA / "behaviour_joined.svg", close=True, stroke="centre")
    contours = ss.offset(shape, 1.0, tolerance=1e-3)
    assert [len(contour.arcs) for contour in contours] == [8]
    assert contours[0].length == pytest.approx(160.0 + 2.0 * math.pi, rel=1e-9)


def test_holes_are_cut_before_the_outline(run: Run, tmp_path: Path) -> None:
    run(
        "behaviour_washer.svg",
        "--stroke",
        "centre",
        "--fill",
        "evenodd",
        "-d",
        "0.15",
        "-o",
        "x.nc",
    )
    text = (tmp_path / "x.nc").read_text()
    starts = [
        np.hypot(float(x) - 30.0, float(y) - 30.0) for x, y in re.findall(r"G0 X(\S+) Y(\S+)", text)
    ]
    radii = [radius for radius in starts if radius > 1.0]
    assert radii[:2] == pytest.approx([8.0 - 0.15, 25.0 + 0.15], abs=0.1)


def test_open_lines_beside_closed_ones_are_named(run: Run, tmp_path: Path) -> None:
    out, said = run(
        "behaviour_mixed.svg", "--stroke", "centre", "-d", "1", "--tolerance", "1e-3", "-o", "x.svg"
    )
    assert "note: " in said
    assert re.search(r"\+1 +1 ", out)
