"""Which contour lies in which, of many: pairs of boxes and points against all of them."""

from __future__ import annotations

import numpy as np
import pytest

from splinesdf.contours import nesting
from splinesdf.contours.contour import Contour


def ring(x: float, y: float, reach: float) -> Contour:
    """A square around a point."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * reach + [x, y]
    following = np.roll(corners, -1, axis=0)
    arcs = np.stack([corners, 0.5 * (corners + following), following], axis=1)
    return Contour(arcs, np.ones(4))


@pytest.mark.parametrize("seed", range(6))
def test_points_in_boxes_are_all_that_there_are(seed: int) -> None:
    random = np.random.default_rng(seed)
    points = random.uniform(-1.0, 1.0, (40, 2)) ** (1 if seed % 2 else 5)
    points[:3] = points[3]
    if seed == 5:
        points[:, 0] = 0.25
    low = random.uniform(-1.5, 1.0, (30, 2))
    high = low + random.uniform(0.0, 1.0, (30, 2)) ** 3
    low[0], high[0] = -np.inf, np.inf
    low[1] = high[1] = points[7]
    found = nesting.points_in_boxes(low, high, points)
    inside = ((low[:, None] <= points) & (points <= high[:, None])).all(axis=2)
    assert sorted(zip(*(some.tolist() for some in found), strict=True)) == sorted(
        map(tuple, np.argwhere(inside).tolist())
    )


def test_rings_in_rings_in_any_order_have_their_parents() -> None:
    # Four deep in each of nine places, and one around them all.
    made = [ring(3.0 * k % 9.0, 3.0 * (k // 3), 1.2 / (1 + m)) for k in range(9) for m in range(4)]
    made.append(ring(3.0, 3.0, 6.0))
    reach = {id(contour): float(np.ptp(contour.arcs[..., 0])) for contour in made}
    order = np.random.default_rng(4).permutation(len(made))
    given = [made[k] for k in order]
    for contour, before in zip(found := nesting.nested(given), given, strict=True):
        assert np.array_equal(contour.arcs, before.arcs)
        middle = before.arcs.mean(axis=(0, 1))
        larger = [
            one
            for one in given
            if reach[id(one)] > reach[id(before)]
            and (np.abs(middle - one.arcs.mean(axis=(0, 1))) < 0.5 * reach[id(one)]).all()
        ]
        if not larger:
            assert contour.parent is None
            continue
        around = min(larger, key=lambda one: reach[id(one)])
        assert contour.parent is not None
        assert np.array_equal(contour.parent.arcs, around.arcs)
        assert any(contour.parent is one for one in found)


def test_no_more_contours_are_asked_than_have_boxes_around(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    enclosed = nesting.enclosed

    def counted(contour: Contour, points: np.ndarray) -> np.ndarray:
        asked.append(len(points))
        return enclosed(contour, points)

    monkeypatch.setattr(nesting, "enclosed", counted)
    side = 20
    rings = [ring(x, y, 0.4) for x in range(side) for y in range(side)]
    rings.append(ring(0.5 * side, 0.5 * side, side))
    found = nesting.nested(rings)
    assert [one.parent is found[-1] for one in found] == [True] * side**2 + [False]
    assert asked == [side**2, side**2]  # the one around them all, for two points of each


def test_an_open_contour_encloses_nothing_and_is_enclosed() -> None:
    outer, inner = ring(0.0, 0.0, 3.0), ring(0.0, 0.0, 2.0)
    opened = Contour(inner.arcs[:3], inner.weights[:3], closed=False)
    tiny = ring(0.0, 0.0, 0.5)
    found = nesting.nested([tiny, opened, outer])
    assert [one.parent is found[2] for one in found] == [True, True, False]
