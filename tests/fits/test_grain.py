"""What rounding adds to the bounds of distances on a triangle, on both sides of the curve."""

from __future__ import annotations

import numpy as np
import pytest

from splinesdf.distance.tables import Bent
from splinesdf.fits.kernels import enclosure
from splinesdf.fits.tables import Limits, Parts
from tests.compiled import from_python

CALLED = {k: from_python(getattr(enclosure, k)) for k in ("_radius", "meets", "seen_in_bands")}
NUMBERS = np.zeros(1, dtype=np.int64)
NOTHING = Bent(np.zeros((1, 16)), NUMBERS, np.zeros((1, 11)), np.zeros((1, 5, 1)), NUMBERS)


@pytest.mark.parametrize("largest", [0.25, 8.0])
@pytest.mark.parametrize("far", [0.75, 1.0, 6.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_triangle_meets_a_band_as_near_as_rounding_may_lead(
    side: float, far: float, largest: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a distance it is known that it changes by no more than the point moves."""
    # Run in Python: all that it can call takes seconds to compile.
    for name, called in CALLED.items():
        monkeypatch.setattr(enclosure, name, called)
    r = 0.5
    grain = enclosure._GRAIN * (largest + far)
    # The spline is on the other side of the curve, out of the band.
    spline = np.full(6, -20.0 * side)
    triangle = np.concatenate([[-r, 0.0, r, 0.0, 0.0, r], spline])
    sizes = np.array([[0, -1, 0]])  # too many arclets to look at
    lists = np.zeros((1, 32), dtype=np.int64)
    room = np.zeros((32, 9)), np.zeros((256, 12)), np.zeros(3), np.zeros(6)
    parts = Parts(triangle[None], sizes, lists, *room)
    anchor = np.array([0.0, 0.0, side * far, 0.0])
    for share, met in ((0.0, True), (0.9, True), (1.1, False), (2.0, False)):
        ends = side * (far + r + share * grain), 20.0 * side
        limits = Limits(np.array([sorted(ends)]), False, largest, 1e-3, 0.1, 1.0, 100, 10)
        counts, low, high, effort = enclosure._look.py_func(NOTHING, anchor, limits, parts, 0, 0.0)
        assert counts == met
        assert low == 0.0
        assert high == np.inf
        assert effort == 0
