"""Ramps, leads and tabs of programs, followed by a reader of their own and judged by Shapely."""

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import splinesdf as ss
from splinesdf.io.remeasured import Worst, measure_file
from tests import chains

TOLERANCE = 0.01
RADIUS = 1.5
# A plate with a hole and a slot that leaves the cutter little room.
PLATE = "M0 0H60V40H0Z M8 20a8 8 0 1 0 16 0a8 8 0 1 0-16 0Z M36 15h12v3.4h-12Z"


def plate() -> ss.Shape:
    return ss.Shape.from_svg_path(PLATE, fill="evenodd")


def region() -> shapely.Geometry:
    """The same, y upward, as the file has it."""
    holes = [shapely.Point(16, -20).buffer(8, quad_segs=256), shapely.box(36, -18.4, 48, -15)]
    return shapely.box(0, -40, 60, 0).difference(shapely.union_all(holes))


def written(path: Path, distance: float = RADIUS, **asked: Any) -> str:
    contours = ss.offset(plate(), distance, tolerance=0.1 * TOLERANCE)
    milling = ss.Milling(**{"feed": 300.0, "depth": 3.0, **asked})
    ss.write(path / "a.nc", contours, tolerance=0.5 * TOLERANCE, milling=milling)
    return (path / "a.nc").read_text()


def measured(path: Path, text: str, distance: float = RADIUS, **asked: Any) -> Worst:
    (path / "a.nc").write_text(text)
    milling = ss.Milling(**{"feed": 300.0, "depth": 3.0, **asked})
    return measure_file(path / "a.nc", plate(), [distance], TOLERANCE, milling=milling)


def ways(text: str) -> list[tuple[str, np.ndarray]]:
    """Each stretch under a comment as points (x, y, z), arcs and helices by their words."""
    found: list[tuple[str, list[np.ndarray]]] = []
    here = np.array([0.0, 0.0, math.nan])
    for line in text.splitlines():
        if line.startswith("("):
            found.append((line[1:-1], []))
        words = {w[0]: float(w[1:]) for w in re.findall(r"[A-Z]-?[\d.]+", line.split("(")[0])}
        end = np.array([words.get(k, old) for k, old in zip("XYZ", here, strict=True)])
        share = np.linspace(0.0, 1.0, 65)[:, None]
        if words.get("G") == 1.0:
            found[-1][1].append(here + share * (end - here))
        elif words.get("G") in (2.0, 3.0):
            center = here[:2] + np.array([words["I"], words["J"]])
            low, high = (math.atan2(*(p[:2] - center)[::-1]) for p in (here, end))
            turn = (high - low) % (2.0 * math.pi)
            turn = turn - 2.0 * math.pi if words["G"] == 2.0 else turn
            angle = low + share[:, 0] * turn
            at = center + np.hypot(*(here[:2] - center)) * np.c_[np.cos(angle), np.sin(angle)]
            found[-1][1].append(np.c_[at, here[2] + share[:, 0] * (end[2] - here[2])])
        here = end
    return [(name, np.concatenate(parts)) for name, parts in found if parts]


@pytest.mark.parametrize("lead", [None, 2.0])
@pytest.mark.parametrize("degrees", [3.0, 20.0])
def test_a_ramp_goes_down_along_the_contour(
    tmp_path: Path, degrees: float, lead: float | None
) -> None:
    asked = {"ramp": degrees, "pass_depth": 1.5, "lead": lead}
    text = written(tmp_path, **asked)
    assert measured(tmp_path, text, **asked).keeps(TOLERANCE)
    edge = shapely.boundary(region())
    found = ways(text)
    ramps = [points for name, points in found if name.startswith("ramp")]
    assert len(ramps) == 6
    for points in ramps:
        way = np.hypot(*np.diff(points[:, :2], axis=0).T)
        fall = -np.diff(points[:, 2])
        assert (fall >= -1e-5).all()
        assert -points[-1, 2] in (1.5, 3.0)
        off = shapely.distance(edge, shapely.points(points[:, :2]))
        assert np.abs(off - RADIUS).max() <= TOLERANCE
        steepest = math.tan(math.radians(degrees))
        # The short slot is gone around ten times at most, and steeper.
        if "steeper" not in text:
            assert (fall <= steepest * way * 1.01 + 1e-5).all()
            assert fall.sum() / way.sum() == pytest.approx(steepest, rel=1e-3)
    passes = [points for name, points in found if name.startswith("pass")]
    assert all(np.ptp(points[points[:, 2] <= points[:, 2].min(), 2]) == 0.0 for points in passes)


def test_a_ramp_ends_at_its_depth_where_its_last_move_is_all_rounding(tmp_path: Path) -> None:
    """A side takes all of it but 0.00003, which four decimals do not tell from nothing."""
    milling = ss.Milling(feed=9, depth=1.00003, ramp=45.0)
    ring = replace(chains.line(0j, 1 + 0j, 1 + 1j, 1j, closed=True), distance=-0.1)
    ss.write(tmp_path / "a.nc", [ring], tolerance=0.01, milling=milling)
    ramp, rest = (tmp_path / "a.nc").read_text().split("(pass 1 of 1)\n")
    assert re.findall(r"Z(\S+)", ramp)[-2:] == ["-1", "-1.00003"]
    assert "Z" not in rest.split("G0")[0]


def test_a_ramp_around_a_short_contour_is_steeper_and_that_is_said(tmp_path: Path) -> None:
    dot = ss.offset(ss.Shape.from_svg_path("M0 0H4V4H0Z"), -1.9, tolerance=1e-3)
    ss.write(tmp_path / "a.nc", dot, milling=ss.Milling(feed=9, depth=3.0, ramp=1.0))
    text = (tmp_path / "a.nc").read_text()
    assert "(ramp steeper than asked" in text
    assert text.count("\n") < 100


@pytest.mark.parametrize("distance", [RADIUS, -RADIUS])
@pytest.mark.parametrize("direction", ["climb", "conventional"])
def test_leads_are_tangential_and_spoil_nothing(
    tmp_path: Path, distance: float, direction: str
) -> None:
    asked = {"lead": 4.0, "direction": direction}
    text = written(tmp_path, distance, **asked)
    assert measured(tmp_path, text, distance, **asked).keeps(TOLERANCE)
    found = ways(text)
    leads = [k for k, (name, _) in enumerate(found) if name.startswith("lead")]
    assert len(leads) >= 4
    shape = region()
    for k in leads:
        name, points = found[k]
        points = points[-65:, :2]
        at = shapely.points(points)
        signed = shapely.distance(shapely.boundary(shape), at)
        signed = np.where(shapely.contains(shape, at), -signed, signed)
        spoiled = distance - signed if distance > 0.0 else signed - distance
        assert spoiled.max() <= TOLERANCE
        way = found[k + 1][1] if name == "lead in" else found[k - 1][1]
        way = way[np.abs(way[:, 2] + 3.0) < 1e-9][:, :2]
        along = way[1] - way[0] if name == "lead in" else way[-1] - way[-2]
        ahead = points[-1] - points[-2] if name == "lead in" else points[1] - points[0]
        cosine = along @ ahead / (np.hypot(*along) * np.hypot(*ahead))
        assert cosine > math.cos(0.1)


def test_no_room_for_a_lead_is_said(tmp_path: Path) -> None:
    """The slot is a little wider than the cutter: into its path no quarter circle fits."""
    text = written(tmp_path, RADIUS, lead=4.0)
    assert "(no room for a lead in)" in text


def test_a_lead_does_not_enter_what_another_contour_keeps(tmp_path: Path) -> None:
    """Two parts side by side: between them there is less room than the lead asks for."""
    two = ss.Shape.from_svg_path("M0 0H20V20H0Z M24 0H44V20H24Z")
    contours = ss.offset(two, 1.0, tolerance=1e-3)
    milling = ss.Milling(feed=300, lead=6.0, start=(22.0, -10.0))
    ss.write(tmp_path / "a.nc", contours, tolerance=5e-3, milling=milling)
    parts = shapely.union_all([shapely.box(0, -20, 20, 0), shapely.box(24, -20, 44, 0)])
    text = (tmp_path / "a.nc").read_text()
    leads = [points for name, points in ways(text) if name.startswith("lead")]
    assert leads
    for points in leads:
        assert shapely.distance(parts, shapely.points(points[:, :2])).min() >= 1.0 - TOLERANCE


def test_tabs_hold_the_part(tmp_path: Path) -> None:
    """The sheet less all that is cut through: one piece, by bridges of the width asked for."""
    asked = {"tabs": 3, "tab_width": 2.0, "tab_height": 1.0, "pass_depth": 1.0}
    text = written(tmp_path, **asked)
    assert measured(tmp_path, text, **asked).keeps(TOLERANCE)
    sheet = shapely.box(-10, -50, 70, 10)
    deep = []
    for name, points in ways(text):
        if name.startswith("pass 3"):
            low = points[:, 2] <= -3.0
            for group in np.split(points, np.flatnonzero(np.diff(low.astype(int))) + 1):
                if group[0, 2] <= -3.0 and len(group) > 1:
                    deep.append(shapely.LineString(group[:, :2]).buffer(RADIUS, quad_segs=64))
    cut = shapely.union_all(deep)
    for width, holds in ((0.1, True), (1.8, True), (2.1, False)):
        # Bridges go once what is cut grows by half their width; the hole's are as long on a bend.
        grown = sheet.difference(cut.buffer(0.5 * width, quad_segs=64))
        whole = [part for part in shapely.get_parts(grown) if part.area > 1.0]
        assert (len(whole) == 1) is holds, width
    heights = {round(float(z), 6) for name, p in ways(text) for z in p[:, 2] if "pass 3" in name}
    assert heights >= {-3.0, -2.0}
    early = [points[65:, 2] for name, points in ways(text) if re.match("pass [12]", name)]
    assert all(np.ptp(z) == 0.0 for z in early)


def swapped(text: str, pattern: str, new: str) -> str:
    assert re.search(pattern, text, re.MULTILINE), pattern
    return re.sub(pattern, new, text, count=1, flags=re.MULTILINE)


PASS = r"^\(pass 1 of 1\)\n(.*\n)*?(?=\(lead out)"
TABS = {"tabs": 3, "tab_width": 2.0, "tab_height": 1.0}


@pytest.mark.parametrize(
    ("asked", "pattern", "new", "says"),
    [
        ({"lead": 2.0}, r"^(\(lead in\)\n)", r"\1G1 X30 Y-30\n", "a lead of contour"),
        ({"lead": 2.0}, r"^(\(lead out\)\n)", r"\1G1 X30 Y-30\n", "a lead of contour"),
        ({"ramp": 9.0}, r"^(\(ramp\)\n)", r"\1G1 X30 Y-30\n", "a ramp of contour"),
        ({"ramp": 9.0}, r"^G1 Z0 F300$", "G1 Z-1 F300", "begins at Z-1, expected 0"),
        ({"ramp": 9.0}, r"^\(ramp\)\n(.*\n)*?(?=\(pass)", "G1 Z-3 F300\n", "has no ramp"),
        ({"ramp": 3.0}, r"^(\(ramp\)\n\S+ \S+ \S+ Z)\S+", r"\1-2.9", "steeper than 3 degrees"),
        (TABS, r"^G1 Z-2 F300\n", "", "has 2 tabs, expected 3"),
        (TABS, r"^G1 Z-2 F300\n", "G1 Z-2.5 F300\n", "has a tab up to Z-2.5, expected -2"),
        (TABS, r"^G1 X61.5 Y-7.54794$", "G1 X61.5 Y-10", "has a tab over 2.54794, expected 5"),
        ({"lead": 2.0}, PASS, "", "contour 1 has ways into it, and no pass"),
    ],
)
def test_the_check_sees_what_is_wrong(
    tmp_path: Path, asked: dict[str, Any], pattern: str, new: str, says: str
) -> None:
    text = written(tmp_path, **asked)
    assert measured(tmp_path, text, **asked).keeps(TOLERANCE)
    worst = measured(tmp_path, swapped(text, pattern, new), **asked)
    assert not worst.keeps(TOLERANCE)
    assert any(says in fault for fault in worst.faults), worst.faults


def test_a_lead_into_a_path_between_rings_stays_within_the_walls_path(tmp_path: Path) -> None:
    """It may be nearer to the wall than its path, which is nowhere nearer than 12 to it."""
    square = ss.Shape.from_points([[0, 0], [40, 0], [40, 40], [0, 40]])
    wall = ss.offset(square, -3.0, tolerance=1e-3)
    paths = [*wall, chains.circle(8.0, (20.0, 20.0), distance=-12.0)]
    ss.write(tmp_path / "a.nc", paths, tolerance=5e-3, milling=ss.Milling(feed=9, lead=2.0))
    text = (tmp_path / "a.nc").read_text()

    def faults(way: str) -> tuple[str, ...]:
        lead = r"(\(distance -12.0\)\n(?:.*\n)*?\(lead in\)\n)G3 (\S+ \S+) .*"
        (tmp_path / "a.nc").write_text(swapped(text, lead, rf"\1G1 X20 {way}\nG1 \2"))
        levels = [-12.0, -3.0]
        return measure_file(tmp_path / "a.nc", square, levels, TOLERANCE, clearing={-12.0}).faults

    assert faults("Y5") == ()
    (fault,) = faults("Y1")
    assert re.match(r"a lead of contour \d, at Z0, is 2 from where it may be", fault)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"ramp": 90.0, "depth": 1.0}, "a ramp below 90 degrees"),
        ({"ramp": 5.0}, "a depth above 0"),
        ({"tabs": -1}, "tabs"),
        ({"tabs": 2}, "both their width and height"),
        ({"tab_width": 2.0}, "both their width and height"),
        ({**TABS, "depth": 0.5}, "no higher than the depth 0.5"),
        ({**TABS, "depth": 2.0, "ramp": 5.0}, "tabs or a ramp, got both"),
    ],
)
def test_what_does_not_go_together_is_refused(asked: dict[str, Any], says: str) -> None:
    with pytest.raises(ss.InputError, match=re.escape(says)):
        ss.Milling(**asked)
