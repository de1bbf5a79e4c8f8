"""Winding numbers of contours are those of their arcs, however large those are."""

from __future__ import annotations

import numpy as np
import pytest

from tests import oracles
from tests.flat_contours import flattened, winding_number
from tests.offsets.test_offset_checks import ring


@pytest.mark.parametrize("radius", [1.0, 1e4, 1e7])
@pytest.mark.parametrize("share", [1e-4, 1e-12])
def test_points_just_inside_and_outside_a_circle(radius: float, share: float) -> None:
    outer = ring(0.0)[0]
    low, high = outer.arcs.min(axis=(0, 1)), outer.arcs.max(axis=(0, 1))
    center, scale = 0.5 * (low + high), radius / (0.5 * (high[0] - low[0]))
    angle = np.linspace(0.0, 7.0, 2000)
    way = np.stack([np.cos(angle), np.sin(angle)], -1)
    moved = type(outer)(
        scale * (outer.arcs - center), outer.weights, distance=0.0, y_down=outer.y_down
    )
    off = share * radius
    line = flattened(moved, np.zeros(2), 0.1 * off)
    assert winding_number([line], (radius - off) * way, 0.1 * off).tolist() == [1] * 2000
    assert winding_number([line], (radius + off) * way, 0.1 * off).tolist() == [0] * 2000
    if share == 1e-12:  # of the chords alone, it is another matter
        chords = oracles.winding_number([line.points], (radius - off) * way)
        assert np.count_nonzero(chords == 0) > 1000
