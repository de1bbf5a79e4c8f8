"""Interpolation by polynomials of degree 7 on [0, 1]: where to sample, and what to do with it."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from splinesdf.ground.arrays import Floats

# Higher: fewer pieces, each dearer to the distance kernel; lower: more pieces.
DEGREE = 7
# Chebyshev nodes stretched so that the outer two are the ends: ends come out exact, and the error
# is half that of the Chebyshev-Lobatto points.
NODES: Floats = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, 16, 2) / 16) / math.cos(math.pi / 16)
NODES[0], NODES[-1] = 0.0, 1.0
# Three checks between each two nodes, where an interpolant is worst.
CHECKS: Floats = np.concatenate(
    [a + (b - a) * np.array([0.21, 0.5, 0.79]) for a, b in pairwise(NODES)]
)
SAMPLES: Floats = np.concatenate([NODES, CHECKS])


def _bernstein(t: Floats) -> Floats:
    """Values of the Bernstein polynomials of degree 7, shape (n, 8)."""
    k = np.arange(DEGREE + 1)
    binomial = np.array([math.comb(DEGREE, int(i)) for i in k], dtype=np.float64)
    return np.asarray(binomial * t[:, None] ** k * (1.0 - t[:, None]) ** (DEGREE - k))


# From values at the nodes to Bernstein coefficients (8, 8), and to values at the checks (21, 8).
TO_CONTROL: Floats = np.linalg.inv(_bernstein(NODES)).astype(np.float64)
TO_CHECKS: Floats = _bernstein(CHECKS) @ TO_CONTROL
