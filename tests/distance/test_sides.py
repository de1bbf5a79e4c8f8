"""The side of a point by the arclets that it has a foot in, next to corners of all angles."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.distance.kernels import branches, feet
from splinesdf.distance.tables import Bent
from tests.compiled import from_python
from tests.glyphs import glyphs
from tests.mechanical import parts
from tests.named_shapes import gamma

at_foot = from_python(branches._at_foot)
side_of = from_python(branches.side_of)
fill_foot_table = from_python(feet.fill_foot_table)

MOST = 32
SHAPES = {
    "star": lambda: ss.Shape.from_points([(0, 3), (2, -3), (-2, 1), (4, 0), (-1, -3)][::-1]),
    "triangle": lambda: ss.Shape.from_points([(0, 0), (4, 1), (1, 3)]),
    "glyph": lambda: glyphs()["DejaVuSans:g"],
    "gear": lambda: parts()["trapezoid gear"],
    "curve": lambda: gamma("gamma2"),
}


Feet = tuple[Bent, np.ndarray, int, np.ndarray, float, bool]


def feet_of(shape: ss.Shape, x: float, y: float) -> Feet:
    """The arclets nearest to a point, their feet, the least distance and whether it is exact."""
    boundary, bends = shape.boundary, shape.bends
    px, py = x - boundary.origin[0], y - boundary.origin[1]
    middles = 0.5 * (boundary.start + boundary.end)
    ids = np.zeros(MOST, dtype=np.int64)
    kept = np.argsort(np.hypot(*(middles - [px, py]).T))[:MOST]
    ids[: len(kept)] = kept
    near = np.zeros((MOST, 9))
    disk = (px, py, 1e-3 * abs(float(ss.signed_distance(shape, (x, y)))))
    number, nearest, exact = fill_foot_table(
        boundary.arcs, bends.rows, bends.second, ids, len(kept), disk, near
    )
    bent = Bent(boundary.arcs, boundary.following, bends.rows, bends.second, bends.previous)
    return bent, ids, number, near, nearest, exact


def side_at(shape: ss.Shape, x: float, y: float) -> int:
    bent, ids, number, near, nearest, exact = feet_of(shape, x, y)
    return int(side_of(bent, ids, number, near, nearest, 1e-15 * shape.size)) if exact else 0


@pytest.mark.parametrize("name", SHAPES)
def test_the_side_is_that_of_the_exact_distance(name: str) -> None:
    shape = SHAPES[name]()
    random = np.random.default_rng(9)
    boundary = shape.boundary
    corners = boundary.end[random.integers(len(boundary.end), size=400)] + boundary.origin
    far = shape.size * 10.0 ** random.uniform(-5.0, -2.5, (400, 1))
    angle = random.uniform(0.0, 2.0 * np.pi, 400)
    points = corners + far * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    exact = np.sign(ss.signed_distance(shape, points))
    found = np.array([side_at(shape, x, y) for x, y in points.tolist()])
    assert np.all((found == exact) | (found == 0))
    # Not to be told only where feet fall nearly on the line that a tangent gives.
    assert np.mean(found == exact) > 0.95


@pytest.mark.parametrize("reverse", [False, True])
def test_a_corner_is_seen_from_the_side_that_the_curve_turns_away_from(reverse: bool) -> None:
    corners = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]
    shape = ss.Shape.from_points(corners[::-1] if reverse else corners)
    seen = 0
    for (x, y), outside in (((4.1, -0.1), True), ((2.0, 0.9), False), ((-0.1, 3.2), True)):
        bent, ids, number, near, _, _ = feet_of(shape, x, y)
        exact = float(ss.signed_distance(shape, (x, y)))
        assert (exact > 0.0) == outside
        [before] = [j for j in range(number) if near[j, 1] == 1.0 and near[j, 0] <= abs(exact)]
        [after] = [j for j in range(number) if near[j, 1] == 0.0 and near[j, 0] <= abs(exact)]
        for chain in ((before, after, before), (before, after, after)):
            u, gx, gy, k, known = at_foot(bent, ids, chain, near)
            assert known
            assert u == pytest.approx(exact, rel=1e-14)
            # A level set next to a corner is a circle around it.
            assert k == pytest.approx(1.0 / exact, rel=1e-14)
            h = 1e-6
            ahead, above = (float(ss.signed_distance(shape, p)) for p in ((x + h, y), (x, y + h)))
            gradient = np.array([ahead - exact, above - exact]) / h
            assert [gx, gy] == pytest.approx(gradient, abs=1e-5)
            seen += 1
        # At the end of a chain it is not known where the curve goes on.
        for chain in ((before, before, before), (after, after, after)):
            u, _, _, _, known = at_foot(bent, ids, chain, near)
            assert not known
            assert u == pytest.approx(abs(exact), rel=1e-14)
    assert seen == 6
