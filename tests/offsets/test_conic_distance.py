"""How far a point is from a conic arc, as the fit of conics to parallels has it."""

from __future__ import annotations

import numpy as np
import pytest

from splinesdf.contours.contour import evaluate
from splinesdf.offsets.kernels import conic_arc
from tests.compiled import from_python

barycentric = from_python(conic_arc._barycentric)
off = from_python(conic_arc._off)

ARCS = np.array(
    [
        [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        [[-2.0, 1.0], [0.5, 3.0], [2.0, -1.0]],
        [[0.0, 0.0], [3.0, -1.0], [4.0, 1.5]],
    ]
)
WEIGHTS = (0.3, np.sqrt(0.5), 1.0, 4.0)


def triangle(arc: np.ndarray) -> tuple[float, float, float, float, float, float]:
    x, y, ex, ey, cx, cy = np.concatenate([arc[0], arc[1] - arc[0], arc[2] - arc[0]]).tolist()
    return x, y, ex, ey, cx, cy


@pytest.mark.parametrize("arc", ARCS)
def test_shares_give_the_point_back(arc: np.ndarray) -> None:
    for x, y in np.random.default_rng(1).normal(size=(20, 2)).tolist():
        shares = np.array(barycentric(triangle(arc), x, y))
        assert shares.sum() == pytest.approx(1.0, abs=1e-15)
        assert shares @ arc == pytest.approx([x, y], abs=1e-13)


@pytest.mark.parametrize("w", WEIGHTS)
@pytest.mark.parametrize("arc", ARCS)
def test_points_beside_a_conic_are_as_far_as_they_were_moved(arc: np.ndarray, w: float) -> None:
    t = np.linspace(0.1, 0.9, 17)
    h = 1e-5
    (before, on, after) = (evaluate(arc[None], np.array([w]), t + s)[0] for s in (-h, 0.0, h))
    way = after - before
    normal = np.stack([-way[:, 1], way[:, 0]], axis=1) / np.hypot(*way.T)[:, None]
    for moved in (1e-6, -1e-4, 1e-3):
        for x, y in (on + moved * normal).tolist():
            # The normal is good to h²; what a point's distance misses is of second order.
            assert off(triangle(arc), w * w, x, y) == pytest.approx(abs(moved), rel=0.05)


def test_points_beside_a_circle_are_as_far_as_their_radius_says() -> None:
    for angle in np.linspace(0.1, 1.4, 9):
        for radius in (0.99, 1.0 - 1e-9, 1.0 + 1e-4, 1.01):
            x, y = radius * np.cos(angle), radius * np.sin(angle)
            found = off(triangle(ARCS[0]), 0.5, float(x), float(y))
            assert found == pytest.approx(abs(radius - 1.0), rel=0.02, abs=1e-14)
