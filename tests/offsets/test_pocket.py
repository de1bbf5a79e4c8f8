"""Pockets are cleared: a disk is moved along the paths over a grid, by SciPy and Shapely alone."""

from dataclasses import replace
from itertools import pairwise
from math import comb
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

import splinesdf as ss
from splinesdf.io import clearance
from splinesdf.io.clearance import left_by
from splinesdf.io.remeasured import measure_file
from splinesdf.io.source_frame import Told
from splinesdf.offsets import pocket as module
from tests import mechanical
from tests.examples import examples
from tests.glyphs import glyphs

STEPOVERS = (0.3, 0.45, 0.6, 0.75, 0.85, 0.95)
GLYPHS = ["B", "g", "&", "@", "8", "Å", "§", "Ω", "½", "ß"]
# Points on each piece of a boundary, and cells along the longer side of the grid.
_PIECE, _CELLS = 64, 120


def region_of(shape: ss.Shape) -> shapely.Geometry:
    """The filled region: faces of the dense outlines, those that the rule of filling fills."""
    lines = []
    for first, last in zip(shape.loops[:-1], shape.loops[1:], strict=True):
        points = []
        for i in range(first, last):
            control = shape.control[shape.starts[i] : shape.starts[i + 1]]
            n = len(control) - 1
            t = np.linspace(0.0, 1.0, _PIECE if n > 1 else 2)[:-1]
            basis = [comb(n, k) * t**k * (1.0 - t) ** (n - k) for k in range(n + 1)]
            points.append(np.stack(basis, axis=1) @ control)
        loop = np.concatenate(points)
        lines.append(np.concatenate([loop, loop[:1]]))
    whole = shapely.union_all([shapely.LineString(line) for line in lines])
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(whole)))
    kept = []
    for face in faces:
        x, y = shapely.get_coordinates(face.representative_point())[0]
        number = 0
        for line in lines:
            a, b = line[:-1] - (x, y), line[1:] - (x, y)
            up = (a[:, 1] <= 0.0) != (b[:, 1] <= 0.0)
            side = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
            number += int(np.sum(np.where(up & (a[:, 1] <= 0.0), side > 0.0, 0)))
            number -= int(np.sum(np.where(up & (a[:, 1] > 0.0), side < 0.0, 0)))
        if number % 2 if shape.fill == "evenodd" else number:
            kept.append(face)
    return shapely.union_all(kept)


def ends_along(contours: list[ss.Contour], every: float, sag: float) -> np.ndarray:
    parts = []
    for contour in contours:
        line = contour.points(sag)
        for a, b in pairwise(line):
            count = max(1, int(np.ceil(np.hypot(*(b - a)) / every)))
            parts.append(a + np.linspace(0.0, 1.0, count, endpoint=False)[:, None] * (b - a))
    return np.concatenate(parts)


def left_and_gouged(
    shape: ss.Shape, contours: list[ss.Contour], radius: float, tolerance: float
) -> tuple[int, int, float]:
    """How many cells of the grid the tool reaches, and leaves; how deep it cuts into what stays."""
    region = region_of(shape)
    slack = 2.0 * tolerance
    reach = region.buffer(-radius - slack, quad_segs=64).buffer(radius, quad_segs=64)
    low, high = np.array(shape.box[:2]), np.array(shape.box[2:])
    step = float((high - low).max()) / _CELLS
    x, y = (np.arange(a + 0.31 * step, b, step) for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    shapely.prepare(reach)
    points = points[shapely.contains_xy(reach, points[:, 0], points[:, 1])]
    path = ends_along(contours, 0.2 * step, 0.2 * tolerance)
    every = 0.5 * 0.2 * step
    off = cKDTree(path).query(points)[0] - np.hypot(radius, every) - 0.2 * tolerance
    at = shapely.points(ends_along(contours, step, 0.2 * tolerance))
    shapely.prepare(region)
    room = np.where(
        shapely.contains(region, at), shapely.distance(shapely.boundary(region), at), -1.0
    )
    return len(points), int(np.count_nonzero(off > 0.0)), float(radius - room.min())


def check(shape: ss.Shape, diameter: float, share: float) -> ss.Pocket:
    found = ss.pocket(shape, diameter, share * diameter)
    tolerance = found.wall[0].tolerance
    assert tolerance is not None
    cells, left, deep = left_and_gouged(shape, list(found), 0.5 * diameter, tolerance)
    assert cells > 500
    assert left == 0
    # Outlines of the judge are polygons inscribed in curves.
    assert deep <= tolerance + 1e-3 * shape.size / _PIECE
    assert {c.distance for c in found.wall} == {-0.5 * diameter}
    for contour in found.rings:
        turns = (-contour.distance - 0.5 * diameter) / (share * diameter)
        assert turns == pytest.approx(round(turns), abs=1e-9)
    return found


@pytest.mark.parametrize("share", [0.45, 0.95])
def test_the_example_part_is_cleared(share: float) -> None:
    found = check(ss.example("part"), 6.0, share)
    # Above the radius rings leave something, as they did before.
    left = left_and_gouged(ss.example("part"), [*found.wall, *found.rings], 3.0, 6e-3)[1]
    assert (left > 0) == (share > 0.5)
    assert bool(found.extra) == (share > 0.5)


@pytest.mark.parametrize(("number", "name"), list(enumerate(GLYPHS)))
def test_glyphs_are_cleared(number: int, name: str) -> None:
    check(glyphs()[f"DejaVuSans:{name}"], 60.0, STEPOVERS[number % len(STEPOVERS)])


@pytest.mark.parametrize(
    ("name", "diameter", "share"),
    [("cam", 3.0, 0.95), ("star knob", 4.0, 0.8), ("airfoil rib", 3.0, 0.6)],
)
def test_parts_with_islands_are_cleared(name: str, diameter: float, share: float) -> None:
    check(mechanical.parts()[name], diameter, share)


@examples(4)
@given(
    angle=st.floats(0.0, 6.0),
    far=st.sampled_from([0.0, 1e5]),
    share=st.floats(0.55, 0.95),
    sharp=st.floats(0.1, 2.5),
)
def test_sharp_corners_are_cleared_wherever_they_lie(
    angle: float, far: float, share: float, sharp: float
) -> None:
    tip = 60.0 * np.exp(0.5j * sharp * np.array([-1.0, 1.0]))
    corners = np.array([0j, tip[0], tip[1]]) * np.exp(1j * angle) + far
    shape = ss.Shape.from_points(np.stack([corners.real, corners.imag], axis=-1))
    assume(ss.offset(shape, -2.0, tolerance=4e-3))
    found = ss.pocket(shape, 4.0, 4.0 * share)
    cells, left, deep = left_and_gouged(shape, list(found), 2.0, 4e-3)
    assert cells
    assert left == 0
    assert deep <= 5e-3


def test_what_is_left_is_on_the_left_of_the_paths_through_it() -> None:
    """As what is cut away is on the left of walls and rings: so climb milling is one for all."""
    found = ss.pocket(ss.example("part"), 6.0, 5.0, tolerance=0.01)
    others = ends_along([*found.wall, *found.rings], 0.02, 1e-3)
    for contour in found.extra:
        line = contour.points(1e-3)
        ahead = np.diff(line, axis=0)
        k = int(np.argmax(np.hypot(*ahead.T)))
        left = np.array([-ahead[k, 1], ahead[k, 0]]) / np.hypot(*ahead[k])
        middle = 0.5 * (line[k] + line[k + 1])
        sides = cKDTree(others).query([middle + 0.05 * left, middle - 0.05 * left])[0]
        assert sides[0] > sides[1] + 0.02


def test_the_check_of_a_file_sees_what_is_left(tmp_path: Path) -> None:
    """All paths are right, and those between rings are lost: only what is left tells."""
    shape = ss.example("part")
    found = ss.pocket(shape, 6.0, 5.0, tolerance=0.01)
    for kept in (list(found), [*found.wall, *found.rings], list(found)[1:]):
        ss.write(tmp_path / "a.nc", kept, tolerance=0.01)
        left = left_by(tmp_path / "a.nc", shape, 3.0, 0.02, Told(), kept).left
        assert (left <= 0.0) == (len(kept) == len(list(found)))


def test_a_check_that_would_not_end_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    square = ss.Shape.from_points([[0, 0], [40, 0], [40, 40], [0, 40]])
    found = list(ss.pocket(square, 6.0, 2.5, tolerance=0.01))
    ss.write(tmp_path / "a.nc", found, tolerance=0.01)
    asked = left_by(tmp_path / "a.nc", square, 3.0, 0.02, Told(), found).asked
    monkeypatch.setattr(clearance, "_MOST", asked)
    assert left_by(tmp_path / "a.nc", square, 3.0, 0.02, Told(), found).left <= 0.0
    monkeypatch.setattr(clearance, "_MOST", asked - 1)
    with pytest.raises(ss.InputError, match=f"that {asked - 1:,} points .* 0.02 needs more: raise"):
        left_by(tmp_path / "a.nc", square, 3.0, 0.02, Told(), found)


def test_paths_between_rings_are_measured(tmp_path: Path) -> None:
    shape = ss.example("part")
    found = ss.pocket(shape, 6.0, 5.0, tolerance=0.01)
    levels = sorted({c.distance for c in found})
    free = {c.distance for c in found.extra}
    ss.write(tmp_path / "a.nc", found, tolerance=0.01)
    worst = measure_file(tmp_path / "a.nc", shape, levels, 0.03, clearing=free)
    assert worst.keeps(0.03)
    nearer = [replace(c, distance=c.distance - 0.5) for c in found.extra[:1]]
    ss.write(tmp_path / "a.nc", [*found, *nearer], tolerance=0.01)
    moved = {*free, nearer[0].distance}
    worst = measure_file(tmp_path / "a.nc", shape, levels, 0.03, clearing=moved)
    assert not worst.keeps(0.03)


def test_what_cannot_be_cleared_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    square = ss.Shape.from_points([[0, 0], [40, 0], [40, 40], [0, 40]])
    with pytest.raises(ss.InputError, match=r"a stepover of at most 5\.9"):
        ss.pocket(square, 6.0, 6.0)
    with pytest.raises(ss.InputError, match="fits nowhere"):
        ss.pocket(square, 41.0, 10.0)
    with pytest.raises(ss.InputError, match="10,000 times at most"):
        ss.pocket(square, 6.0, 1e-3, tolerance=1e-4)
    # Of the stepover that was given, not of the tolerance that would go with it.
    with pytest.raises(ss.InputError, match="10,000 times at most, got 1e-12"):
        ss.pocket(square, 6.0, 1e-12)
    # The ceiling ends it, in words.
    monkeypatch.setattr(module, "_ROUNDS", 1)
    with pytest.raises(ss.SplineSDFError, match="in 1 rounds, but something is left"):
        ss.pocket(square, 6.0, 5.6)
