"""Lower bounds of the largest of several quadratics: below it everywhere, and seldom far."""

from __future__ import annotations

import numpy as np
import pytest

from splinesdf.fits.kernels import means
from tests.compiled import from_python

best_share = from_python(means._best_share)
least_of_means = from_python(means.least_of_means)

# Barycentric coordinates all over a triangle.
GRID = np.array([(i, j, 40 - i - j) for i in range(41) for j in range(41 - i)]) / 40.0


def values(coefficients: np.ndarray) -> np.ndarray:
    """Of quadratics AA BB CC AB BC CA at the points of the grid: (n, points)."""
    a, b, c = GRID.T
    return coefficients @ np.array([a * a, b * b, c * c, 2 * a * b, 2 * b * c, 2 * c * a])


def bound_of(coefficients: np.ndarray, rests: np.ndarray | float = 0.0) -> float:
    models = np.zeros((len(coefficients), 12))
    models[:, 6:] = coefficients
    models[:, 4] = rests
    return least_of_means(models, len(models), -np.inf, np.empty(6))


def test_the_share_is_the_best_one() -> None:
    random = np.random.default_rng(1)
    shares = np.linspace(0.0, 1.0, 2001)
    for _ in range(200):
        q, other = random.normal(size=(2, 6))

        def least(share: np.ndarray, q: np.ndarray = q, other: np.ndarray = other) -> np.ndarray:
            return (share[:, None] * q + (1.0 - share)[:, None] * other).min(axis=1)

        found = best_share(q, other)
        # Eight halvings: half of 1/256, by the steepest of the lines.
        slack = np.abs(q - other).max() / 512.0
        assert 0.0 < found < 1.0
        assert least(np.array([found]))[0] >= least(shares).max() - slack - 1e-3 * slack


@pytest.mark.parametrize("count", [1, 2, 3, 6])
def test_no_point_is_below_the_bound(count: int) -> None:
    random = np.random.default_rng(count)
    sharp = []
    for _ in range(200):
        coefficients = random.normal(size=(count, 6))
        rests = random.uniform(0.0, 0.5, count)
        largest = (values(coefficients) - rests[:, None]).max(axis=0).min()
        bound = bound_of(coefficients, rests)
        assert bound <= largest + 1e-12
        # Some other may take the place of the best one, but is no worse.
        one = int(np.argmax(coefficients.min(axis=1)))
        assert bound >= coefficients[one].min() - rests[one] - 1e-15
        sharp.append(largest - bound_of(coefficients))
    assert np.median(sharp) < 1.5


def test_two_that_fall_in_opposite_directions_are_bounded_by_their_mean() -> None:
    """Each is 0 at one end, and one of them 1/2 at least."""
    rising = np.array([0.0, 1.0, 0.0, 0.5, 0.5, 0.0])
    assert bound_of(np.array([rising])) == 0.0
    assert bound_of(np.array([rising, 1.0 - rising])) == pytest.approx(0.5, abs=1 / 256)
