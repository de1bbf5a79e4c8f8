"""V-carving, by the programs that are written: a cone is moved along them, point by point."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

import splinesdf as ss
from splinesdf.io.recarved import measure_carve
from splinesdf.io.source_frame import Told
from tests.glyphs import glyphs
from tests.named_shapes import gamma

Floats = NDArray[np.float64]
L = ss.Shape.from_points([[0, 0], [40, 0], [40, 12], [15, 12], [15, 30], [0, 30]])
PLATE = ss.Shape.rectangle(0, 0, 40, 30) - ss.Shape.circle((12, 14), 5.0)


def moves(text: str) -> Floats:
    """The straight cuts of a program, (n, 2, 3), read by its words alone."""
    here, result = {"X": 0.0, "Y": 0.0, "Z": 0.0}, []
    for line in re.sub(r"\(.*?\)|;.*", "", text).splitlines():
        words = dict(re.findall(r"([GXYZ])([-+.\d]+)", line))
        there = here | {name: float(words[name]) for name in "XYZ" if name in words}
        if words.get("G") == "1":
            result.append([list(here.values()), list(there.values())])
        here = there
    return np.array(result)


def depth_at(points: Floats, cuts: Floats, slope: float, tip: float = 0.0) -> Floats:
    """How deep a cone leaves points: the deepest place along each cut, by thirds."""
    found = np.zeros(len(points))
    for start, end in cuts:
        reach = -min(start[2], end[2]) / slope + tip
        low, high = np.minimum(start, end)[:2] - reach, np.maximum(start, end)[:2] + reach
        near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
        some = points[near]
        low, high = np.zeros(len(near)), np.ones(len(near))
        for _ in range(40 if len(near) else 0):  # what a cone leaves is concave along a cut
            thirds = low + (high - low) / 3.0, high - (high - low) / 3.0
            one, two = (
                _depth(some, start + t[:, None] * (end - start), slope, tip) for t in thirds
            )
            low, high = np.where(one < two, thirds[0], low), np.where(one < two, high, thirds[1])
        at = start + (0.5 * (low + high))[:, None] * (end - start)
        found[near] = np.maximum(found[near], _depth(some, at, slope, tip))
    return found


def _depth(points: Floats, at: Floats, slope: float, tip: float) -> Floats:
    far = np.hypot(*(points - at[:, :2]).T)
    return np.asarray(-at[:, 2] - slope * np.maximum(far - 0.5 * tip, 0.0))


def program(tmp_path: Path, carve: ss.Carve, **options: Any) -> str:
    ss.write(tmp_path / "a.nc", carve, milling=ss.Milling(feed=500), **options)
    return (tmp_path / "a.nc").read_text()


def points_in(shape: ss.Shape, count: int, seed: int = 3) -> tuple[Floats, Floats]:
    """Points of the box, and how far inside they are."""
    low, high = np.reshape(shape.box, (2, 2))
    points = np.random.default_rng(seed).uniform(low, high, (count, 2))
    return points, -ss.signed_distance(shape, points)


CASES = {
    "L": (L, 60.0),
    "plate": (PLATE, 90.0),
    "limacon": (gamma("gamma2").scale(30.0), 120.0),
    "R": (glyphs()["DejaVuSans:R"], 30.0),
    "part": (ss.example("part"), 60.0),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("share", [None, 0.02])
def test_the_surface_is_the_distance(tmp_path: Path, name: str, share: float | None) -> None:
    shape, angle = CASES[name]
    depth = None if share is None else share * shape.size
    carve = ss.vcarve(shape, angle, depth, tolerance=4e-3 * shape.size)
    cuts = moves(program(tmp_path, carve, flip=False))
    slope = 1.0 / np.tan(np.radians(0.5 * angle))
    points, inside = points_in(shape, 150)
    exact = slope * np.maximum(inside, 0.0)
    wall = np.ones(len(points), dtype=bool) if depth is None else exact <= depth
    exact = exact if depth is None else np.minimum(exact, depth)
    found = depth_at(points, cuts, slope)
    digit = 2e-4 * (1.0 + slope)  # of the file, which has four decimals or more
    assert (found - exact).max() <= digit
    assert (exact - found)[wall].max() <= 4e-3 * shape.size
    # And along the cuts, where a cone is widest: nowhere wider than the shape.
    at = (cuts[:, :1] + np.linspace(0, 1, 9)[:, None] * (cuts[:, 1:] - cuts[:, :1])).reshape(-1, 3)
    at = at[at[:, 2] < 0.0]
    assert (-at[:, 2] - slope * -ss.signed_distance(shape, at[:, :2])).max() <= digit


@pytest.mark.parametrize("name", CASES)
def test_all_of_a_part_is_carved_without_a_lift(name: str) -> None:
    shape, angle = CASES[name]
    whole = ss.vcarve(shape, angle, tolerance=2e-3 * shape.size)
    assert whole.lifts == len(shapely.get_parts(shape.to_shapely(1e-4 * shape.size)))
    assert whole.flat == ()
    depth = 0.02 * shape.size
    carve = ss.vcarve(shape, angle, depth, tolerance=1e-3 * shape.size)
    ground = ss.Shape.from_contours(carve.flat).to_shapely(1e-5 * shape.size)
    points, inside = points_in(shape, 4000)
    clear = np.abs(inside - depth / carve.slope) > carve.tolerance
    is_flat = shapely.contains_xy(ground, points)
    assert np.array_equal(is_flat[clear], (inside > depth / carve.slope)[clear])
    left = shapely.difference(shape.to_shapely(1e-5 * shape.size), ground)
    assert carve.lifts == len(shapely.get_parts(left))


def test_corners_come_up_to_the_surface() -> None:
    carve = ss.vcarve(L, 60.0, tolerance=0.01)
    points = np.concatenate(carve.paths)
    for corner in ([0, 0], [40, 0], [40, 12], [15, 30], [0, 30]):
        apart = np.linalg.norm(points - [*corner, 0.0], axis=1)
        assert apart.min() < 1e-12
    # A tree is walked twice, but for its longest way.
    axis = ss.medial_axis(L, 1e-5)
    longest = sum(edge.length for edge in axis.longest_path())
    assert carve.length == pytest.approx(2.0 * axis.length - longest, rel=1e-4)


def test_a_circle_is_one_plunge(tmp_path: Path) -> None:
    carve = ss.vcarve(ss.Shape.circle((3.0, 4.0), 2.0), 90.0)
    assert [path.tolist() for path in carve.paths] == [[pytest.approx([3.0, 4.0, -2.0], abs=1e-9)]]
    assert moves(program(tmp_path, carve))[-1, 1].tolist() == [3.0, 4.0, -2.0]


def test_passes_are_no_deeper_than_a_step() -> None:
    once, steps = (ss.vcarve(L, 60.0, 9.0, step_down=s, tolerance=0.01) for s in (None, 2.5))
    assert steps.lifts == once.lifts
    (path,), (whole,) = steps.paths, once.paths
    assert len(path) > 3 * len(whole)
    for low in (-2.5, -5.0, -7.5):
        first = int(np.argmax(path[:, 2] < low - 1e-12))
        # Before it goes deeper, all is carved to there.
        before = depth_at(
            whole[:, :2], np.stack([path[: first - 1], path[1:first]], axis=1), once.slope
        )
        assert (before >= np.minimum(-whole[:, 2], -low) - 1e-5).all()


def test_a_tip_and_an_allowance_are_kept(tmp_path: Path) -> None:
    carve = ss.vcarve(PLATE, 60.0, 6.0, tip=1.0, allowance=0.5, tolerance=0.02)
    points, inside = points_in(PLATE, 300)
    found = depth_at(points, moves(program(tmp_path, carve)), carve.slope, tip=1.0)
    exact = np.minimum(carve.slope * np.maximum(inside - 0.5, 0.0), 6.0)
    assert (found - exact).max() <= 1e-3
    # As deep as that between the boundary and the tip, where the largest disk holds the bit.
    rim = np.concatenate(PLATE.sample(90))
    rim = rim[:: len(rim) // 180]
    rim = rim[ss.maximal_disk(PLATE, rim).radius > 1.0]
    disk = ss.maximal_disk(PLATE, rim)
    share = np.random.default_rng(4).uniform(0.0, 1.0, len(rim))
    far = 0.5 + share * (np.minimum(disk.radius - 0.5, 6.0 / carve.slope + 0.5) - 0.5)
    points = rim + (far / disk.radius)[:, None] * (disk.center - rim)
    found = depth_at(points, moves((tmp_path / "a.nc").read_text()), carve.slope, tip=1.0)
    assert len(points) > 150
    assert (carve.slope * (far - 0.5) - found).max() <= 0.02


@pytest.mark.parametrize("change", ["far", "small", "turned"])
def test_it_moves_with_the_shape(change: str) -> None:
    home = ss.vcarve(L, 60.0, 8.0, tolerance=0.01)
    moved, by = {
        "far": (L.translate(1e6, -1e6), 1.0),
        "small": (L.scale(1e-3), 1e-3),
        "turned": (L.rotate(33.0), 1.0),
    }[change]
    found = ss.vcarve(moved, 60.0, 8.0 * by, tolerance=0.01 * by)
    assert found.lifts == home.lifts
    assert found.deepest == pytest.approx(home.deepest * by, rel=1e-9)
    assert found.length == pytest.approx(home.length * by, rel=1e-3)
    areas = [sum(c.area for c in carve.flat) for carve in (found, home)]
    assert areas[0] == pytest.approx(areas[1] * by**2, rel=1e-6)


def carved(tmp_path: Path, change: Sequence[int] | None, z: float = 0.0) -> bool:
    """Whether the check passes a program of the plate with some of its lines changed."""
    carve = ss.vcarve(PLATE, 60.0, tolerance=0.02)
    lines = program(tmp_path, carve, origin="center", scale=2.0).splitlines()
    cuts = [k for k, line in enumerate(lines) if line.startswith("G1 X")]
    for k in change or ():
        if z:
            head, low = lines[cuts[k]].split(" Z")
            lines[cuts[k]] = f"{head} Z{float(low.split()[0]) - z:.4f}"
        else:
            lines[cuts[k]] = ""
    (tmp_path / "a.nc").write_text("\n".join(lines))
    told = Told(scale=2.0, origin="center")
    return measure_carve(tmp_path / "a.nc", PLATE, carve, told).keeps(0.02, carve.slope)


def test_the_check_sees_what_is_wrong(tmp_path: Path) -> None:
    assert carved(tmp_path, None)
    assert not carved(tmp_path, [7], 0.01)  # too deep by half a tolerance
    assert not carved(tmp_path, range(1, 4))
    # Without its way into each of the corners.
    carve = ss.vcarve(PLATE, 60.0, tolerance=0.02)
    corners = [
        k for k, p in enumerate(carve.paths[0]) if p[2] == 0.0 and p[0] % 40 == p[1] % 30 == 0
    ]
    assert len(corners) >= 4
    for k in corners[1:3]:
        assert not carved(tmp_path, [k - 1])


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"angle": 180.0}, "an angle between 0 and 180 degrees, got 180"),
        ({"depth": 0.0}, "expected a positive depth, got 0"),
        ({"step_down": -1.0}, "expected a positive step down, got -1"),
        ({"tip": -1.0}, "expected tip of at least 0, got -1"),
        ({"allowance": -1.0}, "expected allowance of at least 0, got -1"),
        ({"tip": 40.0}, "one in which it fits nowhere"),
        ({"step_down": 1e-6}, "at most 1000 passes"),
        ({"tolerance": 0.0}, "a positive tolerance, got 0"),
    ],
)
def test_bad_input_is_one_line(options: dict[str, float], says: str) -> None:
    with pytest.raises(ss.InputError, match=says):
        ss.vcarve(L, **options)  # type: ignore[arg-type]


def test_files_of_a_carve(tmp_path: Path) -> None:
    carve = ss.vcarve(L, 60.0, tolerance=0.1)
    ss.write(tmp_path / "a.csv", carve)
    rows = np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1)
    assert np.array_equal(rows[:, 1:], carve.paths[0])
    with pytest.raises(ss.InputError, match=r"whose paths are in space, got .*a\.svg"):
        ss.write(tmp_path / "a.svg", carve)
    with pytest.raises(ss.InputError, match="expected no tolerance for a carve"):
        ss.write(tmp_path / "a.nc", carve, tolerance=0.1)
    with pytest.raises(ss.InputError, match="expected no depth in the milling"):
        ss.write(tmp_path / "a.nc", carve, milling=ss.Milling(depth=2, pass_depth=1))
