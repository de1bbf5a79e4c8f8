"""Which pieces are lines and which are parts of circles."""

from __future__ import annotations

import math

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.tables import FREE, ROUND, STRAIGHT


@pytest.mark.parametrize("ratio", [1.0, 1.0 + 1e-9])
@pytest.mark.parametrize("height", [0.0, 2.0])  # its arclets come first, and last
def test_a_tiny_loop_does_not_change_what_a_large_arc_is(height: float, ratio: float) -> None:
    """Rounding goes with the whole shape: with that of a part, circles are not recognized."""
    large = f"M1e3 0A1e3 {1e3 * ratio!r} 0 0 1 -1e3 0A1e3 {1e3 * ratio!r} 0 0 1 1e3 0Z"
    # With more lines than the circle has arclets: half of all are in a tiny box.
    angles = (2.0 * math.pi * np.arange(200) / 200).tolist()
    points = " ".join(f"{1e-3 * math.cos(a)!r} {height + 1e-3 * math.sin(a)!r}" for a in angles)
    shape = ss.Shape.from_svg_path(f"{large}M{points}Z", fill="evenodd")
    boundary = shape.boundary
    near = np.hypot(*(boundary.start + boundary.origin).T) < 10.0
    assert 2 * near.sum() > len(near)
    assert set(shape.kinds.kind[near].tolist()) == {STRAIGHT}
    assert set(shape.kinds.kind[~near].tolist()) == {ROUND if ratio == 1.0 else FREE}
