"""DXF written by ezdxf, entity by entity, and what its drawings trap readers with."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

import splinesdf as ss
from tests.reading import areas, assert_one_line

Draw = Callable[[Any], object]


@pytest.fixture
def dxf(tmp_path: Path) -> Callable[..., ss.Shape]:
    def read(draw: Draw, *, units: int = 4, **options: object) -> ss.Shape:
        document = ezdxf.new(units=units)
        draw(document)
        document.saveas(tmp_path / "drawing.dxf")
        return ss.read(tmp_path / "drawing.dxf", **options)  # type: ignore[arg-type]

    return read


def square(space: Any, x: float, y: float, side: float, **attributes: Any) -> None:
    corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        space.add_line(a, b, dxfattribs=attributes)


def total(shape: ss.Shape) -> float:
    """The filled area: outlines here are nested at most once, and do not cross."""
    sizes = sorted(np.abs(areas(shape)), reverse=True)
    return float(sizes[0] - sum(sizes[1:]))


ROUND: list[tuple[str, Draw, float]] = [
    ("circle", lambda d: d.modelspace().add_circle((1, 2), 3), 9 * math.pi),
    (
        "circle seen from below",
        lambda d: d.modelspace().add_circle((1, 2), 3, dxfattribs={"extrusion": (0, 0, -1)}),
        9 * math.pi,
    ),
    (
        "two arcs",
        lambda d: [d.modelspace().add_arc((0, 0), 2, a, a + 180) for a in (30, 210)],
        4 * math.pi,
    ),
    (
        "ellipse",
        lambda d: d.modelspace().add_ellipse((1, 1), (3, 4), ratio=0.5),
        math.pi * 5 * 2.5,
    ),
    (
        "two halves of an ellipse",
        lambda d: [
            d.modelspace().add_ellipse((0, 0), (0, 4), 0.5, start_param=a, end_param=a + math.pi)
            for a in (0.5, 0.5 + math.pi)
        ],
        math.pi * 4 * 2,
    ),
    (
        "slot of bulges",
        lambda d: d.modelspace().add_lwpolyline(
            [(0, 0), (10, 0, 1), (10, 4), (0, 4, 1)], format="xyb", close=True
        ),
        40 + 4 * math.pi,
    ),
    (
        "bulge above one, clockwise",
        lambda d: d.modelspace().add_lwpolyline(
            [(0, 0, -(1 + math.sqrt(2))), (2, 0)], format="xyb", close=True
        ),
        2 * (1.5 * math.pi + 1.0) / 2 * 1.0,
    ),
    (
        "old polyline",
        lambda d: d.modelspace().add_polyline2d(
            [(0, 0, 0), (2, 0, 1), (2, 2, 0), (0, 2, 0)], format="xyb", close=True
        ),
        4 + math.pi / 2,
    ),
    (
        "level 3D polyline",
        lambda d: d.modelspace().add_polyline3d([(0, 0, 7), (2, 0, 7), (2, 3, 7)], close=True),
        3.0,
    ),
]


@pytest.mark.parametrize(("draw", "area"), [case[1:] for case in ROUND], ids=[c[0] for c in ROUND])
def test_areas_of_entities(dxf, draw: Draw, area: float) -> None:
    assert_allclose(total(dxf(draw)), area, rtol=1e-11)


def test_arcs_are_exact_and_not_cubics(dxf) -> None:
    shape = dxf(lambda d: d.modelspace().add_circle((100, 50), 30))
    points = shape.sample(50)[0] - [100, 50]
    assert np.abs(np.hypot(*points.T) - 30).max() <= 1e-13 * 130


def test_a_rational_spline_is_a_circle_to_rounding(dxf) -> None:
    from ezdxf.math import rational_bspline_from_arc

    def draw(document: Any) -> None:
        for start in (0, 120, 240):
            curve = rational_bspline_from_arc((2, 1), 5, start, start + 120)
            document.modelspace().add_spline().apply_construction_tool(curve)

    shape = dxf(draw)
    points = np.concatenate(shape.sample(20)) - [2, 1]
    assert np.abs(np.hypot(*points.T) - 5).max() <= 1e-11


def test_a_spline_through_fit_points_is_closed(dxf) -> None:
    angles = np.linspace(0, 2 * np.pi, 13)
    points = [(math.cos(a), math.sin(a)) for a in angles[:-1]] + [(1.0, 0.0)]
    shape = dxf(lambda d: d.modelspace().add_spline(points))
    assert_allclose(total(shape), math.pi, rtol=1e-2)


@pytest.mark.parametrize("count", [3, 4, 7, 150])
@pytest.mark.parametrize("repeated", [False, True])
def test_a_closed_spline_of_fit_points_is_the_periodic_one(dxf, count: int, repeated: bool) -> None:
    """By chord lengths, as CAD programs take them."""
    angles = np.arange(count) * (2.0 * math.pi / count)
    away = 1.0 + 0.05 * np.random.default_rng(count).random(count)
    points = np.stack([3.0 * away * np.cos(angles), 2.0 * away * np.sin(angles)], axis=1)
    around = np.vstack([points, points[:1]])

    def draw(document: Any) -> None:
        document.modelspace().add_spline(around if repeated else points).closed = True

    shape = dxf(draw)
    assert shape.notes == ()
    assert (shape.loop_count, shape.piece_count) == (1, count)
    lengths = np.append(0.0, np.cumsum(np.hypot(*np.diff(around, axis=0).T)))
    curve = CubicSpline(lengths, around, bc_type="periodic")(np.linspace(0.0, lengths[-1], 999))
    assert np.abs(ss.signed_distance(shape, curve)).max() <= 1e-13


def test_a_closed_spline_begins_and_ends_as_it_says(dxf) -> None:
    def draw(document: Any) -> None:
        spline = document.modelspace().add_spline([(0, 0), (4, 0), (4, 3)])
        spline.closed = True
        spline.dxf.start_tangent, spline.dxf.end_tangent = (0, -1, 0), (1, 0, 0)

    shape = dxf(draw)
    assert (shape.loop_count, shape.piece_count) == (1, 3)
    first, last = np.diff(shape.piece(0), axis=0)[0], np.diff(shape.piece(2), axis=0)[-1]
    assert_allclose(first / np.hypot(*first), [0.0, -1.0], atol=1e-12)
    assert_allclose(last / np.hypot(*last), [1.0, 0.0], atol=1e-12)
    assert np.array_equal(shape.piece(2)[-1], [0.0, 0.0])


NOWHERE, BEYOND = float("nan"), 1e101
# What bounds nothing, and in which words it is left out.
FLAT: list[tuple[Draw, str]] = [
    (lambda m: m.add_line((5, 5), (5, 5)), "1 LINE (of no length)"),
    (lambda m: m.add_line((5, 5), (BEYOND, 5)), "1 LINE (with numbers beyond use)"),
    (lambda m: m.add_arc((5, BEYOND), 1, 0, 90), "1 ARC (with numbers beyond use)"),
    (lambda m: m.add_circle((5, 5), 0), "1 CIRCLE (of no radius)"),
    (lambda m: m.add_ellipse((5, 5), (1, 0, 0.5), 0.5), "1 ELLIPSE (tilted)"),
    (lambda m: m.add_polymesh((3, 3)), "1 POLYLINE (a mesh)"),
    (lambda m: m.add_polyline2d([]), "1 POLYLINE (without points)"),
    (
        lambda m: m.add_polyline3d([(0, 0, 0), (NOWHERE, 1, 1), (3, 4, 0)]),
        "1 POLYLINE (without finite points)",
    ),
    (lambda m: m.add_lwpolyline([(3, 3), (3, 3)], close=True), "1 LWPOLYLINE (of no length)"),
    (lambda m: m.add_spline([(3, 3), (NOWHERE, 3), (3, 4)]), "1 SPLINE (without a curve)"),
    (lambda m: m.add_spline([(3, 3), (3, 3), (3, 3)]), "1 SPLINE (without a curve)"),
    (
        lambda m: m.add_rational_spline([(3, 3), (4, 3), (3, 4), (4, 4)], [1, -1, 1, 1]),
        "1 SPLINE (expected positive finite weights, got -1 for control point 2)",
    ),
    (
        lambda m: setattr(m.add_spline([(3, 3), (4, 4), (3, 3)]), "closed", True),
        "1 SPLINE (through fewer than three places)",
    ),
    (
        lambda m: setattr(m.add_spline([(3, 3), (4, 4), (NOWHERE, 3)]), "closed", True),
        "1 SPLINE (with numbers beyond use)",
    ),
]


@pytest.mark.parametrize(("draw", "note"), FLAT, ids=[note for _, note in FLAT])
def test_what_bounds_nothing_is_left_out_and_named(dxf, draw: Draw, note: str) -> None:
    def beside(document: Any) -> None:
        document.modelspace().add_circle((0, 0), 1)
        draw(document.modelspace())

    shape = dxf(beside)
    assert shape.notes == (f"left out: {note}",)
    assert_allclose(total(shape), math.pi, rtol=1e-11)


def test_corners_that_are_drawn_twice_are_one_and_open_polylines_are_joined(dxf) -> None:
    def draw(document: Any) -> None:
        space = document.modelspace()
        space.add_lwpolyline([(0, 0), (0, 0), (4, 0), (4, 3), (4, 3)])
        space.add_line((4, 3), (0, 0))

    assert_allclose(total(dxf(draw)), 6.0, rtol=1e-12)


def test_inserts_are_turned_mirrored_stretched_and_nested(dxf) -> None:
    def draw(document: Any) -> None:
        inner = document.blocks.new("inner")
        square(inner, 0, 0, 1)
        outer = document.blocks.new("outer")
        outer.add_blockref("inner", (1, 0), dxfattribs={"xscale": -1, "rotation": 90})
        outer.add_circle((5, 0), 1)
        document.modelspace().add_blockref("outer", (10, 10), dxfattribs={"xscale": 2})

    shape = dxf(draw)
    assert_allclose(sorted(np.abs(areas(shape))), [2.0, 2.0 * math.pi], rtol=1e-11)
    assert shape.notes == ()
    # The square, mirrored and turned by 90 degrees, lies at x from 0 to 1 of the outer block.
    assert ss.signed_distance(shape, (20.0, 10.0)) == pytest.approx(-1.0)


def test_loose_edges_in_any_order_and_direction(dxf) -> None:
    random = np.random.default_rng(3)

    def draw(document: Any) -> None:
        angles = np.linspace(0, 2 * np.pi, 40, endpoint=False)
        corners = 10.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        order = random.permutation(40)
        for k in order:
            ends = [corners[k], corners[(k + 1) % 40]]
            a, b = ends if random.integers(2) else ends[::-1]
            document.modelspace().add_line(a + random.normal(0, 1e-7, 2), b)

    shape = dxf(draw)
    assert shape.loop_count == 1
    assert_allclose(np.abs(areas(shape)), 20 * 100 * math.sin(2 * math.pi / 40), rtol=1e-6)
    assert "joined end to end: 40 edges, over gaps of up to" in shape.notes[0]


def test_a_wider_gap_is_joined_only_if_asked_for(dxf) -> None:
    def draw(document: Any) -> None:
        space = document.modelspace()
        for a, b in (((0, 0), (4, 0)), ((4.01, 0), (4, 3)), ((4, 3.01), (0, 0.01))):
            space.add_line(a, b)

    with pytest.raises(ss.OpenContourError):
        dxf(draw)
    shape = dxf(draw, gap=0.05)
    assert shape.loop_count == 1
    assert_allclose(np.abs(areas(shape)), 6.0, rtol=1e-2)
    assert "gaps of up to 0.01" in shape.notes[0]


def test_edges_drawn_twice_count_once(dxf) -> None:
    def draw(document: Any) -> None:
        space = document.modelspace()
        square(space, 0, 0, 2)
        space.add_line((2, 0), (0, 0))
        space.add_circle((1, 1), 0.5)
        space.add_circle((1, 1), 0.5)

    shape = dxf(draw)
    assert_allclose(total(shape), 4 - math.pi / 4, rtol=1e-11)
    assert "drawn again, counted once: 2 edges" in shape.notes


def test_layers_are_chosen_and_hidden_ones_left_out(dxf) -> None:
    def draw(document: Any) -> None:
        document.layers.add("Frame").off()
        document.layers.add("Holes")
        space = document.modelspace()
        square(space, -9, -9, 18, layer="Frame")
        square(space, 0, 0, 4)
        space.add_circle((2, 2), 1, dxfattribs={"layer": "Holes"})

    assert_allclose(total(dxf(draw)), 16 - math.pi, rtol=1e-11)
    assert "left out: 4 entities on hidden layers" in dxf(draw).notes
    assert_allclose(total(dxf(draw, layers="holes")), math.pi, rtol=1e-11)
    assert_allclose(total(dxf(draw, layers=["Frame", "0"])), 18**2 - 16, rtol=1e-11)
    with pytest.raises(ss.InputError, match=r"expected layers of .*got 'nowhere'"):
        dxf(draw, layers="nowhere")


@pytest.mark.parametrize(("units", "unit"), [(0, None), (1, 25.4), (4, 1.0), (6, 1000.0)])
def test_the_unit_is_the_headers(dxf, units: int, unit: float | None) -> None:
    shape = dxf(lambda d: d.modelspace().add_circle((0, 0), 1), units=units)
    assert shape.unit == unit
    assert ("the file does not say its unit ($INSUNITS)" in shape.notes) == (unit is None)


def test_what_is_no_edge_is_named_and_counted(dxf) -> None:
    def draw(document: Any) -> None:
        space = document.modelspace()
        space.add_circle((0, 0), 1)
        space.add_text("hello")
        space.add_text("again")
        space.add_point((1, 1))
        space.add_hatch().paths.add_polyline_path([(0, 0), (1, 0), (0, 1)])
        space.add_circle((0, 0), 1, dxfattribs={"extrusion": (1, 0, 0)})
        space.add_line((0, 0, 0), (1, 1, 9))
        space.add_line((5, 5), (6, 6))

    shape = dxf(draw)
    assert_allclose(total(shape), math.pi, rtol=1e-11)
    assert shape.notes == (
        "left out: 2 TEXT, 1 POINT, 1 HATCH, 1 tilted CIRCLE, 1 LINE (not level)",
        "left out: 1 open outlines, the first from (5, 5) to (6, 6): a larger gap= joins them, "
        "close=True (--close) closes them",
    )


def test_what_is_no_drawing_is_refused_in_one_line(dxf, tmp_path: Path) -> None:
    with pytest.raises(ss.InputError, match="got left out: 1 TEXT") as caught:
        dxf(lambda d: d.modelspace().add_text("nothing"))
    assert_one_line(caught.value, "drawing.dxf")
    damaged = [b"", b"0\nSECTION\n2\nENTITIES\n0\nLINE\n10", b"\x00\xff" * 50, b"AutoCAD" * 9]
    for content in (*damaged, b"0\nSECTION\n0\nENDSEC\n0\nEOF\n"):
        (tmp_path / "bad.dxf").write_bytes(content)
        with pytest.raises(ss.InputError) as caught:
            ss.read(tmp_path / "bad.dxf")
        assert_one_line(caught.value, "bad.dxf")


def test_what_write_writes_can_be_read(tmp_path: Path) -> None:
    part = ss.read(Path(ss.__file__).parent / "data" / "part.svg")
    contours = ss.offset(part, [-1.0], tolerance=1e-3)
    for arcs in (False, True):
        ss.write(tmp_path / "offset.dxf", contours, tolerance=1e-4, arcs=arcs)
        shape = ss.read(tmp_path / "offset.dxf")
        assert shape.loop_count == len(contours)
        written = sorted(abs(c.area) for c in contours)
        assert_allclose(sorted(np.abs(areas(shape))), written, rtol=1e-4)


def test_without_ezdxf_it_is_said_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.dxf").write_text("0\nEOF\n")
    monkeypatch.setitem(sys.modules, "ezdxf.filemanagement", None)
    with pytest.raises(ss.MissingExtraError, match=r"pip install 'splinesdf\[dxf\]'"):
        ss.read(tmp_path / "a.dxf")
