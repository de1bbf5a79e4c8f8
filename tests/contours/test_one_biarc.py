"""The biarc between two points with given tangents, by the equation that it solves."""

from __future__ import annotations

import numpy as np
import pytest

from splinesdf.contours.kernels import biarcs
from tests.compiled import from_python

biarc = from_python(biarcs._biarc)
off = from_python(biarcs._off)


def knot(point: np.ndarray, angle: float) -> np.ndarray:
    return np.array([0.0, *point, np.cos(angle), np.sin(angle)])


def test_legs_are_equal_and_neither_arc_is_more_than_a_quarter_turn() -> None:
    random = np.random.default_rng(2)
    found = refused = 0
    for _ in range(2000):
        start, end = (knot(random.normal(size=2), a) for a in random.uniform(-3.0, 3.0, 2))
        v, first, last = end[1:3] - start[1:3], start[3:], end[3:]
        # |P0 Q0| = |Q1 P2| = d and |Q0 Q1| = 2 d: one root of this is positive.
        both = first + last
        roots = np.roots([both @ both - 4.0, -2.0 * v @ both, v @ v])
        [root] = roots[roots > 0.0]
        joint = v - root * both
        turns = min(joint @ first, joint @ last) / np.hypot(*joint)
        if abs(turns) < 1e-9:
            continue
        d = biarc(start, end)
        if turns > 0.0:
            assert d == pytest.approx(root, rel=1e-6)
            found += 1
        else:
            assert d == 0.0
            refused += 1
    assert min(found, refused) > 200


def test_a_quarter_circle_is_two_equal_arcs() -> None:
    start, end = knot(np.array([1.0, 0.0]), 0.5 * np.pi), knot(np.array([0.0, 1.0]), np.pi)
    # Each turns by an eighth of a turn around the origin.
    assert biarc(start, end) == pytest.approx(np.tan(np.pi / 8.0), rel=1e-15)


def test_a_line_is_in_four_equal_parts() -> None:
    start, end = knot(np.zeros(2), 0.3), knot(8.0 * np.array([np.cos(0.3), np.sin(0.3)]), 0.3)
    assert biarc(start, end) == pytest.approx(2.0, rel=1e-15)
    assert biarc(end, start) == 0.0


@pytest.mark.parametrize("bend", [-2.0, -0.1, 0.5, 3.0])
def test_points_inside_and_outside_a_circle_are_as_far_as_their_radius_says(bend: float) -> None:
    """Seen from any of its points; next to the center it is not said."""
    random = np.random.default_rng(3)
    for angle, away in random.uniform(-3.0, 3.0, (50, 2)):
        normal = np.array([np.cos(angle), np.sin(angle)])
        center = normal / bend
        share = 0.51 + 0.3 * abs(away)
        around = np.array([np.cos(away), np.sin(away)]) * share / abs(bend)
        found = off(*(center + around), *normal, bend)
        assert found == pytest.approx(abs(share - 1.0) / abs(bend), rel=1e-12)
        inner = 0.49 / share * around
        assert off(*(center + inner), *normal, bend) == np.inf
