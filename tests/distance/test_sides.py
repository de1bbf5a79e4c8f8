"""The side of a point by the arclets that it has a foot in, next to corners of all angles."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.distance.kernels.branches import side_of
from splinesdf.distance.kernels.feet import fill_foot_table
from splinesdf.distance.tables import Bent
from tests.glyphs import glyphs
from tests.mechanical import parts
from tests.named_shapes import gamma

MOST = 32
SHAPES = {
    "star": lambda: ss.Shape.from_points([(0, 3), (2, -3), (-2, 1), (4, 0), (-1, -3)][::-1]),
    "triangle": lambda: ss.Shape.from_points([(0, 0), (4, 1), (1, 3)]),
    "glyph": lambda: glyphs()["DejaVuSans:g"],
    "gear": lambda: parts()["trapezoid gear"],
    "curve": lambda: gamma("gamma2"),
}


def side_at(shape: ss.Shape, x: float, y: float) -> int:
    """By the arclets nearest to a point, all of them in a table."""
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
    if not exact:
        return 0
    bent = Bent(boundary.arcs, boundary.following, bends.rows, bends.second, bends.previous)
    return int(side_of(bent, ids, number, near, nearest, 1e-15 * shape.size))


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
