"""Which ends of open paths are joined: the nearest first, each once, none beyond the gap."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from splinesdf.shapes.joining import _pair_up


def nearest_first(points: np.ndarray, gap: float) -> list[int]:
    """All pairs, one after the other."""
    partner = [-1] * len(points)
    pairs = itertools.combinations(range(len(points)), 2)
    for apart, i, j in sorted((math.dist(points[i], points[j]), i, j) for i, j in pairs):
        if apart <= gap and partner[i] == partner[j] == -1:
            partner[i], partner[j] = j, i
    return partner


@pytest.mark.parametrize("seed", range(20))
def test_ends_are_paired_as_by_all_pairs(seed: int) -> None:
    points = np.random.default_rng(seed).uniform(0.0, 6.0, (40, 2))
    partner = [-1] * len(points)
    _pair_up(points, 0.7, np.arange(len(points)), partner)
    assert partner == nearest_first(points, 0.7)
    assert 2 <= partner.count(-1) < 38
