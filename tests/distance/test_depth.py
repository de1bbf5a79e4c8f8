"""How deep inside the deepest point is: against shapes of which it is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.distance.depth import deepest

RADIUS = 1.25
SHAPES = {
    "disk": ss.Shape.from_formula(f"7+{RADIUS}*cos(t)", f"{RADIUS}*sin(t)"),
    "square": ss.Shape.from_points(RADIUS * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])),
    # The deepest points are a line, 400 times as long as they are deep.
    "slot": ss.Shape.from_points(RADIUS * np.array([(0, 0), (400, 0), (400, 2), (0, 2)])),
    "tall": ss.Shape.from_points(RADIUS * np.array([(0, 0), (2, 0), (2, 30), (0, 30)])),
}


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("share", [1e-9, 0.5, 0.97, 0.999, 1.001, 1.03, 2.0, 1e9])
def test_what_is_there_and_what_is_not(name: str, share: float) -> None:
    low, high = deepest(SHAPES[name], share * RADIUS)
    assert low <= RADIUS * (1.0 + 1e-14)
    assert high >= RADIUS * (1.0 - 1e-14)
    if abs(share - 1.0) > 0.01:
        assert (low >= share * RADIUS) if share < 1.0 else (high < share * RADIUS)
        assert share < 1.0 or high - low <= 0.01 * high


def test_the_very_depth_is_left_open_or_right() -> None:
    for shape in SHAPES.values():
        low, high = deepest(shape, RADIUS)
        assert low <= RADIUS * (1.0 + 1e-14) <= high * (1.0 + 2e-14)


def test_the_deepest_of_several() -> None:
    rings = ss.Shape.from_svg_path("M0 0H4V4H0Z M10 0H20V10H10Z M14 4V6H16V4Z")
    low, high = deepest(rings, 3.0)
    # In a corner of the second square, as far from its walls as from the hole's corner.
    depth = 4.0 * math.sqrt(2.0) / (1.0 + math.sqrt(2.0))
    assert low <= depth <= high
    assert high < 3.0
