"""Where arclets meet: as often as naively, and as near as is asked for."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.crossings import find_crossings


def sides_of(a: np.ndarray, b: np.ndarray, points: np.ndarray) -> np.ndarray:
    way = b - a
    return np.sign((points[:, 1] - a[1]) * way[0] - (points[:, 0] - a[0]) * way[1])


@pytest.mark.parametrize("seed", range(5))
def test_sides_of_a_polygon_cross_where_each_has_its_ends_on_both_sides_of_the_other(
    seed: int,
) -> None:
    points = np.random.default_rng(seed).uniform(-1.0, 1.0, (16, 2))
    ends = np.roll(points, -1, axis=0)
    expected = 0
    for i in range(16):
        for j in range(i + 2, 16 - (i == 0)):
            one = sides_of(points[i], ends[i], np.stack([points[j], ends[j]]))
            other = sides_of(points[j], ends[j], np.stack([points[i], ends[i]]))
            expected += int(one.prod() < 0.0 and other.prod() < 0.0)
    outline = ss.Shape.from_points(points).arclets
    pair, at = find_crossings(outline, 1e-12)
    assert len(pair) == expected > 10
    first, second = (
        outline.start[k] + t[:, None] * (outline.end[k] - outline.start[k])
        for k, t in zip(pair.T, at.T, strict=True)
    )
    assert first == pytest.approx(second, abs=1e-14)


@pytest.mark.parametrize("angle", np.linspace(0.0, 3.0, 7))
def test_corners_that_nearly_touch_a_side(angle: float) -> None:
    """Nearer than the tolerance they do, several times farther they do not."""
    tolerance = 1e-3
    c, s = np.cos(angle), np.sin(angle)
    for share, touches in ((0.0, 2), (0.5, 2), (0.9, 2), (3.0, 0), (10.0, 0)):
        points = np.array([(0, 0), (4, 0), (4, 4), (2.2, share * tolerance), (0, 4)])
        outline = ss.Shape.from_points(points @ np.array([[c, s], [-s, c]])).arclets
        pair, at = find_crossings(outline, tolerance)
        assert len({frozenset(both) for both in pair.tolist()}) == touches
        for k, t in zip(pair.ravel(), at.ravel(), strict=True):
            x, y = outline.origin + outline.start[k] + t * (outline.end[k] - outline.start[k])
            assert [x, y] == pytest.approx([2.2 * c, 2.2 * s], abs=2.0 * tolerance)
