"""The foot, on one edge of the border, of a point outside: where it is sought first."""

from __future__ import annotations

import math

import numpy as np
import pytest

from splinesdf.splines.kernels import extension


@pytest.mark.parametrize("length", [0.01, 0.3, 7.0])
@pytest.mark.parametrize("slope", [-0.8, -0.1, 0.6])
def test_where_the_spline_is_linear_newton_starts_in_the_foot(
    slope: float, length: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = []

    def measured(x: float, y: float) -> float:
        seen.append((x, y))
        return math.hypot(x, y)

    monkeypatch.setattr(extension, "_length", measured)
    for share in (0.05, 0.4, 0.9):
        for away in (0.02, 0.5):
            start, b = 1.5, away * length
            # Snell's law: s + distance is level where the way to the point leans by the slope.
            foot = start + share * length
            a = foot + slope * b / math.sqrt(1.0 - slope * slope)
            edges = np.array([[start, 0.2, 0.2 + 0.5 * slope * length], [start + length, 0.0, 0.0]])
            edges[1, 1] = 0.2 + slope * length
            seen.clear()
            least, at, bend, free = extension._least_on_edge.py_func(edges, 0, a, b)
            assert at == pytest.approx(foot, rel=1e-14)
            across = slope * share * length + b / math.sqrt(1.0 - slope * slope)
            assert least == pytest.approx(0.2 + across, rel=1e-14)
            assert bend == pytest.approx(0.0, abs=1e-12 / length)
            assert free
            # After four ends, the first place that is tried.
            assert seen[4] == pytest.approx((foot - a, b), abs=1e-13 * length)
