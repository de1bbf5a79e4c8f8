"""Strokes: against shapely's buffers, segments across the path, distances from it, and pictures."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

import splinesdf as ss
from splinesdf.arclets.points import bezier_points
from splinesdf.shapes.sources.pen import Pen
from splinesdf.shapes.sources.stroke import stroke_region
from splinesdf.shapes.sources.svg_path import parse_path, parse_until
from tests.drawings import judged
from tests.reading import areas
from tests.shapes.test_boundary import area, loops

Floats = NDArray[np.float64]

DATA = Path(__file__).parents[1] / "data"

ZIGZAG = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (4.0, 6.0), (-3.0, 9.0)]
# Some bend less than the width, some more, some in both directions, some just as much.
CURVES = {
    "gentle": ("M0 0C10 0 10 10 0 10", 2.0),
    "tight": ("M0 0C1 3 1 3 2 0", 3.0),
    "loop": ("M0 0C12 8-10 8 2 0", 2.5),
    "s": ("M0 0C8 6-6 6 2 12", 4.0),
    "its own center": ("M2 0A2 2 0 0 1 -2 0", 4.0),
    "smaller": ("M1 0A1 1 0 0 1 -1 0", 4.0),
    "quadratic": ("M0 0Q1 6 2 0", 3.0),
    "bent by half the width where it starts": ("M0 0Q6 4-5 5", 29.998186611860387),
}


def stroked(path: str, pen: Pen) -> ss.Shape:
    found = parse_until(path)
    return ss.Shape.from_pieces(stroke_region(found.loops, found.closed, pen), once=False)


def line(points: list[tuple[float, float]]) -> str:
    return "M" + "L".join(f"{x} {y}" for x, y in points)


def grid(shape: ss.Shape, across: int = 60) -> Floats:
    x0, y0, x1, y1 = shape.box
    x, y = np.linspace(x0 - 1, x1 + 1, across), np.linspace(y0 - 1, y1 + 1, across + 1)
    return np.asarray(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))


def followed(path: str) -> list[tuple[Floats, Floats]]:
    """Points and derivatives along each piece: four thousand in all, or more."""
    pieces = [piece for loop in parse_path(path) for piece in loop]
    t = np.linspace(0.0, 1.0, max(401, 4001 // len(pieces)))
    return [bezier_points(piece, t) for piece in pieces]


def swept(path: str, width: float, points: Floats) -> NDArray[np.bool_]:
    """Whether a segment across the path meets each point: where it is passed, near enough."""
    met = np.zeros(len(points), dtype=bool)
    for (on_x, on_y), (along_x, along_y) in (
        (on.T.copy(), along.T.copy()) for on, along in followed(path)
    ):
        for k, (x, y) in enumerate(points):
            dx, dy = x - on_x, y - on_y
            ahead = dx * along_x + dy * along_y > 0.0
            near = dx * dx + dy * dy <= 0.25 * width * width
            met[k] |= bool(np.any((ahead[1:] != ahead[:-1]) & near[1:]))
    return met


@pytest.mark.parametrize("join", ["miter", "bevel", "round"])
@pytest.mark.parametrize("cap", ["butt", "square", "round"])
def test_polylines_are_shapelys_buffers(cap: str, join: str) -> None:
    shape = stroked(line(ZIGZAG), Pen(1.0, cap, join))
    flat = {"butt": "flat", "square": "square", "round": "round"}[cap]
    mitre = {"miter": "mitre", "bevel": "bevel", "round": "round"}[join]
    buffer = shapely.LineString(ZIGZAG).buffer(
        0.5, cap_style=flat, join_style=mitre, mitre_limit=4.0, quad_segs=2000
    )
    assert math.isclose(area(shape.boundary), buffer.area, rel_tol=1e-6)
    points = grid(shape)
    distance = ss.signed_distance(shape, points)
    far = np.abs(distance) > 1e-5
    inside = shapely.contains_xy(buffer, points)
    np.testing.assert_array_equal(distance[far] < 0.0, inside[far])


@pytest.mark.parametrize("name", CURVES)
def test_segments_across_fill_the_region_and_no_more(name: str) -> None:
    path, width = CURVES[name]
    shape = stroked(path, Pen(width))
    points = grid(shape, 30)
    distance = ss.signed_distance(shape, points)
    far = np.abs(distance) > 0.01
    np.testing.assert_array_equal(distance[far] < 0.0, swept(path, width, points[far]))


@pytest.mark.parametrize("name", CURVES)
def test_round_strokes_are_what_is_near_the_path(name: str) -> None:
    path, width = CURVES[name]
    shape = stroked(path, Pen(width, "round", "round"))
    points = grid(shape, 30)
    nearest = np.full(len(points), np.inf)
    for on_x, on_y in (on.T.copy() for on, _ in followed(path)):
        square = [((x - on_x) ** 2 + (y - on_y) ** 2).min() for x, y in points]
        nearest = np.minimum(nearest, np.sqrt(square))
    # Outside, the distance itself is what is left of the way to the path.
    distance = ss.signed_distance(shape, points)
    away = nearest > 0.5 * width + 0.01
    assert np.all(distance[away] > 0.0)
    assert np.all(distance[nearest < 0.5 * width - 0.01] < 0.0)
    np.testing.assert_allclose(distance[away], nearest[away] - 0.5 * width, atol=1e-3)


@pytest.mark.parametrize(("radius", "filled"), [(2.0, 8.0 * math.pi), (1.0, 4.0 * math.pi)])
def test_a_circle_is_a_ring_or_a_disk(radius: float, filled: float) -> None:
    circle = f"M{radius} 0A{radius} {radius} 0 1 1 {-radius} 0A{radius} {radius} 0 1 1 {radius} 0Z"
    shape = stroked(circle, Pen(2.0))
    assert math.isclose(area(shape.boundary), filled, rel_tol=1e-9)
    assert len(loops(shape.boundary)) == (2 if radius > 1.0 else 1)


@pytest.mark.parametrize(("scale", "shift"), [(1.0, 1e6), (1e-6, 1.0), (1e6, 0.0)])
def test_a_disk_far_away_or_small_is_one(scale: float, shift: float) -> None:
    found = parse_until("M2 0A2 2 0 0 1 -2 0A2 2 0 0 1 2 0Z")
    moved = [[scale * piece + shift for piece in loop] for loop in found.loops]
    shape = ss.Shape.from_pieces(stroke_region(moved, found.closed, Pen(4.0 * scale)), once=False)
    assert len(loops(shape.boundary)) == 1
    distance = ss.signed_distance(shape, scale * np.array([[0.0, 0.0], [3.9, 0.0]]) + shift)
    np.testing.assert_allclose(distance / scale, [-4.0, -0.1], atol=1e-8)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.97, 1.0 - 1e-6])
@pytest.mark.parametrize("at", [(0.0, 0.0), (9.0, 13.0), (0.3, -1e4)])
def test_a_circle_less_wide_than_the_stroke_is_a_disk(
    share: float, at: tuple[float, float]
) -> None:
    """Its center is one point, of which rounding makes no cloud."""
    x, y = at
    found = parse_until(
        f"M{x + share} {y}a{share} {share} 0 1 0 {-2 * share} 0a{share} {share} 0 1 0 {2 * share} 0"
    )
    for closed in (True, False):
        around = stroke_region(found.loops, [closed], Pen(2.0, "butt"))
        # Forty pieces a circle, four intervals each on both sides, and the lines to the center.
        assert sum(map(len, around)) <= 40 * 4 * 2 + 80
        shape = ss.Shape.from_pieces(around, once=False)
        assert len(loops(shape.boundary)) == 1
        assert math.isclose(area(shape.boundary), math.pi * (1.0 + share) ** 2, rel_tol=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_what_an_arc_of_a_small_circle_sweeps(seed: int) -> None:
    """Two sectors that touch in its center: one beside the arc, one across."""
    rng = np.random.default_rng(seed)
    x, y, radius, turn = rng.uniform((-20, -20, 0.1, 0.3), (20, 20, 0.9, 2.9)).tolist()
    start = rng.uniform(0.0, 2.0 * math.pi)
    ends = [radius * np.array([math.cos(a), math.sin(a)]) + (x, y) for a in (start, start + turn)]
    (ax, ay), (bx, by) = (end.tolist() for end in ends)
    shape = stroked(f"M{ax!r} {ay!r}A{radius!r} {radius!r} 0 0 1 {bx!r} {by!r}", Pen(2.0))
    sectors = 0.5 * turn * ((1.0 + radius) ** 2 + (1.0 - radius) ** 2)
    assert shape.area == pytest.approx(sectors, rel=1e-9)
    assert len(loops(shape.boundary)) == 2


def test_a_miter_beyond_its_limit_is_a_bevel() -> None:
    sharp = line([(0.0, 0.0), (10.0, 0.0), (0.0, 1.0)])
    assert stroked(sharp, Pen(1.0, miter_limit=30.0)).box[2] > 12.0
    assert stroked(sharp, Pen(1.0, miter_limit=4.0)).box[2] < 11.0


def test_a_point_with_caps_is_a_dot() -> None:
    assert math.isclose(area(stroked("M3 4h0", Pen(2.0, "round")).boundary), math.pi, rel_tol=1e-9)
    assert math.isclose(area(stroked("M3 4h0", Pen(2.0, "square")).boundary), 4.0, rel_tol=1e-12)
    assert stroke_region(parse_path("M3 4h0"), [False], Pen(2.0)) == []


@pytest.mark.parametrize("back", ["H0V0", "h-9.7h-.2h-.1v-10"])
def test_only_a_closed_path_has_a_join_at_its_start(back: str) -> None:
    """Where it closes, rounding may be between; what ends where it starts may be open."""
    square = f"M0 0h.1h.2h9.7v10{back}"
    assert math.isclose(area(stroked(square + "Z", Pen(2.0)).boundary), 80.0, rel_tol=1e-9)
    assert math.isclose(area(stroked(square, Pen(2.0)).boundary), 79.0, rel_tol=1e-9)


def test_a_path_that_turns_back_has_no_miter() -> None:
    assert stroked("M0 0H10H5", Pen(2.0)).box == (0.0, -1.0, 10.0, 1.0)
    assert stroked("M0 0H10H5", Pen(2.0, join="round")).box == pytest.approx((0.0, -1.0, 11.0, 1.0))


@pytest.fixture
def outlined(tmp_path: Path) -> Callable[..., ss.Shape]:
    def read(body: str, **options: str) -> ss.Shape:
        file = tmp_path / "drawing.svg"
        file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg">{body}</svg>', "utf-8")
        return ss.read(file, stroke="outline", **options)

    return read


def test_what_is_filled_and_its_stroke_are_one_region(outlined: Callable[..., ss.Shape]) -> None:
    shape = outlined('<rect x="10" y="10" width="20" height="20" stroke="red" stroke-width="4"/>')
    assert area(shape.boundary) == pytest.approx(24.0**2, rel=1e-12)
    assert shape.box == pytest.approx((8.0, 8.0, 32.0, 32.0))


def test_a_transform_stretches_the_stroke(outlined: Callable[..., ss.Shape]) -> None:
    path = '<path d="M0 0V10" transform="scale(-3 1)" stroke="red" stroke-width="4" fill="none"/>'
    shape = outlined(path)
    assert shape.box == pytest.approx((-6.0, 0.0, 6.0, 10.0), abs=1e-12)
    constant = path.replace("stroke=", 'vector-effect="non-scaling-stroke" stroke=')
    shape = outlined(constant)
    assert shape.box == pytest.approx((-2.0, 0.0, 2.0, 10.0), abs=1e-12)


ICONS = sorted((DATA / "drawings" / "feather").glob("*.svg"))[::3]


@pytest.mark.parametrize("path", ICONS, ids=lambda path: path.stem)
def test_icons_of_strokes_are_as_painted(path: Path) -> None:
    assert judged(path, 256, stroke="outline") == ""


@pytest.mark.parametrize("d", ["M16 16s-1.5-2-4-2-4 2-4 2", "M14.5 21s-.682-3-2.5-3-2.5 3-2.5 3"])
def test_handles_of_no_length_are_followed_to_their_ends(tmp_path: Path, d: str) -> None:
    """A mouth of feather and a bow of tabler."""
    pen = "fill='none' stroke='#000' stroke-width='2' stroke-linecap='round'"
    text = (
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 24 24'><path {pen} d='{d}'/></svg>"
    )
    (tmp_path / "bow.svg").write_text(text)
    assert judged(tmp_path / "bow.svg", 256, stroke="outline") == ""


@pytest.mark.parametrize("path", ["M0 0H50V2", "M0 0H50L49 2", "M0 0H50L30 1", "M50 2V0H0V3"])
@pytest.mark.parametrize("join", ["miter", "bevel", "round"])
@pytest.mark.parametrize("cap", ["butt", "round"])
def test_a_short_last_piece_shows_no_more_than_its_join_and_cap(
    path: str, join: str, cap: str
) -> None:
    pen = Pen(12.0, cap, join, 1.0 if join == "miter" else 4.0)
    shape = stroked(path, pen)
    corners = np.array([piece[0] for piece in parse_path(path)[0]] + [parse_path(path)[0][-1][-1]])
    points = grid(shape, 80)
    inside = np.zeros(len(points), dtype=bool)
    units = [step / math.hypot(*step) for step in np.diff(corners, axis=0)]
    for start, end, unit in zip(corners[:-1], corners[1:], units, strict=True):
        along = (points - start) @ unit
        across = np.abs((points - start) @ np.array([-unit[1], unit[0]]))
        inside |= (along >= 0) & (along <= math.dist(start, end)) & (across <= 6.0)
    # A sector: what is ahead of the piece before and behind the one after, or a triangle of it.
    for at, before, after in zip(corners[1:-1], units[:-1], units[1:], strict=True):
        from_corner = points - at
        beyond = (from_corner @ before >= 0) & (from_corner @ after <= 0)
        chord = (before - after) / math.hypot(*(before - after))
        reach = 6.0 * math.cos(0.5 * math.acos(float(before @ after)))
        near = np.hypot(*from_corner.T) <= 6.0 if join == "round" else from_corner @ chord <= reach
        inside |= beyond & near
    for at, outward in ((corners[0], -units[0]), (corners[-1], units[-1])):
        if cap == "round":
            inside |= ((points - at) @ outward >= 0) & (np.hypot(*(points - at).T) <= 6.0)
    distance = ss.signed_distance(shape, points)
    away = np.abs(distance) > 1e-9
    assert np.array_equal((distance < 0.0)[away], inside[away])


def test_where_rounding_parts_a_curve_no_sliver_is_left() -> None:
    path, width = CURVES["bent by half the width where it starts"]
    assert np.abs(areas(stroked(path, Pen(width)))).min() > 1.0


def test_a_curve_with_a_cusp_within_it_is_refused() -> None:
    with pytest.raises(ss.InputError, match=r"cannot be resolved near t = 0\.5"):
        stroked("M20 20C80 80 20 80 80 20", Pen(9.0))


@pytest.mark.parametrize("seed", range(20))
def test_corners_as_round_as_the_stroke_end_where_the_lines_beside_them_do(seed: int) -> None:
    """A rounded rectangle, and a line that is flush with its inner side."""
    rng = np.random.default_rng(seed)
    x, y, r = (round(float(v), 2) for v in rng.uniform((-40, -40, 0.4), (40, 40, 1.9)))
    wide, high = (round(float(v), 2) for v in rng.uniform(8.0, 15.0, 2))
    corner = f"{r} {r} 0 0 1"
    path = (
        f"M{x + r} {y}h{wide - 2 * r}a{corner} {r} {r}v{high - 2 * r}a{corner} {-r} {r}"
        f"h{2 * r - wide}a{corner} {-r} {-r}v{2 * r - high}a{corner} {r} {-r}z"
    )
    shape = stroked(f"{path}M{x + r} {y + 2 * r}H{x + 3 * r}", Pen(2.0 * r))
    outer = (wide + 2 * r) * (high + 2 * r) - (4.0 - math.pi) * (2.0 * r) ** 2
    inner = (wide - 2 * r) * (high - 2 * r) - 4.0 * r * r
    assert shape.area == pytest.approx(outer - inner, rel=1e-9)
    assert len(loops(shape.boundary)) == 2


def test_an_icon_with_such_corners_is_drawn(tmp_path: Path) -> None:
    """Feather's clipboard.svg (MIT)."""
    (tmp_path / "icon.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="24" height="24" fill="none" '
        'stroke="#000" stroke-width="2" stroke-linecap="round" stroke-linejoin="round">'
        '<path d="M16 4h2a2 2 0 0 1 2 2v14a2 2 0 0 1-2 2H6a2 2 0 0 1-2-2V6a2 2 0 0 1 2-2h2"/>'
        '<rect x="8" y="2" width="8" height="4" rx="1" ry="1"/></svg>'
    )
    assert not judged(tmp_path / "icon.svg", 256, stroke="outline")
