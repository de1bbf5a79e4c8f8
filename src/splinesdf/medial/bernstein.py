"""Derivatives and products of many polynomials at once, by their Bernstein coefficients."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.ground.arrays import Floats


def derivative(points: Floats) -> Floats:
    """Control points of the derivatives: (d + 1, 2, n) -> (d, 2, n), but (1, 2, n) for d = 0."""
    degree = len(points) - 1
    if degree == 0:
        return np.zeros_like(points)
    return np.asarray(degree * np.diff(points, axis=0))


def product(one: Floats, other: Floats) -> Floats:
    """Bernstein coefficients (a + b + 1, n) of products of polynomials (a + 1, n), (b + 1, n)."""
    a, b = len(one) - 1, len(other) - 1
    result = np.zeros((a + b + 1, one.shape[1]))
    scaled = other * _binomials(b)
    for i in range(a + 1):
        result[i : i + b + 1] += math.comb(a, i) * one[i] * scaled
    return np.asarray(result / _binomials(a + b))


def _binomials(n: int) -> Floats:
    return np.array([[math.comb(n, k)] for k in range(n + 1)], dtype=np.float64)
