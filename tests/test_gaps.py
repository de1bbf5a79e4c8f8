"""What the trimming of parallels claims of distances to single arclets, against dense samples."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.kernels.gaps import _bend_range, _stays_nearer
from splinesdf.kernels.nearest import closest_on, point_on, room_to_search
from splinesdf.kernels.parallels import parallel_point
from splinesdf.offsets.trimmed import parallels, trimming
from tests.glyphs import glyphs
from tests.mechanical import parts
from tests.shapes import gamma

SHAPES = {
    "gamma2": lambda: gamma("gamma2"),
    "gamma3": lambda: gamma("gamma3"),
    "glyph": lambda: glyphs()["DejaVuSans:g"],
    "gasket": lambda: parts()["gasket"],
    "involute": lambda: parts()["involute gear"],
}
TRIALS, WALLS = 1000, 20


def distances(shape: ss.Shape, j: int, points: np.ndarray) -> np.ndarray:
    arcs = shape.boundary.arcs
    scratch = room_to_search(arcs)
    return np.sqrt([closest_on(arcs, j, x, y, np.inf, scratch)[0] for x, y in points])


def allowed(shape: ss.Shape, wall: int, foot: tuple, along: tuple, length: float) -> float:
    """How much the distance may grow at most, as far as is claimed: infinite if nothing is."""
    slope = foot[1] * along[0] + foot[2] * along[1]

    def sure(gap: float) -> bool:
        row = shape.bends.rows[wall]
        return _stays_nearer(shape.boundary.arcs, row, wall, foot, along, (gap, slope), length)

    low, high = -10.0 * shape.size, 0.0
    if not sure(low):
        return np.inf
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if sure(middle) else (low, middle)
    return -low


@pytest.mark.parametrize("name", SHAPES)
def test_a_wall_is_nowhere_farther_than_its_curvature_allows(name: str) -> None:
    shape = SHAPES[name]()
    arcs, count = shape.boundary.arcs, len(shape.boundary.start)
    scratch = room_to_search(arcs)
    random = np.random.default_rng(5)
    growth = []
    for _ in range(TRIALS):
        distance = shape.size * random.choice([-1.0, 1.0]) * 10.0 ** random.uniform(-2.5, -0.5)
        i = int(random.integers(count))
        half = 10.0 ** random.uniform(-3.0, -0.5)
        m = random.uniform(half, 1.0 - half)
        at = np.linspace(m - half, m + half, 65)
        points = parallels(shape, np.array([[i, 0]] * 65), at, distance)[:, :2]
        x, y, tx, ty, _, bend = parallel_point(shape.joints, (i, 0), m, distance)
        # Half of the stretch, as long as it really is, so that claims are as bold as can be.
        steps = np.hypot(*np.diff(points, axis=0).T)
        length = 1.001 * max(float(steps[:32].sum()), float(steps[32:].sum()))
        range_ = _bend_range(trimming(shape, distance, 1.0), (i, 0), bend, 2.0 * half)
        for wall in random.integers(count, size=WALLS).tolist():
            squared, t = closest_on(arcs, wall, x, y, np.inf, scratch)
            far, (px, py) = np.sqrt(squared), point_on(arcs, wall, t)
            if far > 0.0:
                foot = (far, (x - px) / far, (y - py) / far, t)
                most = allowed(shape, wall, foot, (tx, ty, *range_), length)
                if np.isfinite(most):
                    growth.append((float((distances(shape, wall, points) - far).max()), most))
    grown, most = np.array(growth).T
    assert len(growth) > 20
    assert np.all(grown <= most * (1.0 + 1e-9) + 1e-14 * shape.size)
    # Nor is it far more than that, or it would be of no use.
    much = grown > 1e-6 * shape.size
    assert np.median(most[much] / grown[much]) < 1.5
