"""Lower bounds of the largest of several quadratics on a triangle, by means of them.

Used by `enclosure`.
"""

from __future__ import annotations

import numpy as np

from splinesdf.fits.kernels.bands import least_of
from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import uncounted

# Differences that are added to a mean to bound the largest of them, and halvings for the share of
# each. More: sharper bounds where many branches meet; each costs about 50 ns.
_ADDED, _SHARE_STEPS = 6, 8


@uncounted
def least_of_means(models: Floats, chains: int, enough: float, mean: Floats) -> float:
    """A lower bound of the largest of all differences on a triangle: that of a mean of some (2.10).

    To the best one, another is added that is large where the mean is smallest, a few times.
    """
    one, best = 0, -np.inf
    for m in range(chains):
        least = least_of(models[m, 6:])
        if least > best:
            one, best = m, least
    for v in range(6):
        mean[v] = models[one, 6 + v]
    rest = models[one, 4]
    bound = best - rest
    for _ in range(_ADDED):
        if -bound <= enough:
            break
        worst = 0
        for v in range(1, 6):
            if mean[v] < mean[worst]:
                worst = v
        other = 0
        for m in range(chains):
            if models[m, 6 + worst] > models[other, 6 + worst]:
                other = m
        q = models[other, 6:]
        share = _best_share(mean, q)
        rest = max(rest, models[other, 4])
        for v in range(6):
            mean[v] = share * mean[v] + (1.0 - share) * q[v]
        bound = max(bound, least_of(mean) - rest)
    return float(bound)


@uncounted
def _best_share(q: Floats, other: Floats) -> float:
    """The share of q in the mean of both that makes its smallest coefficient largest."""
    low, high = 0.0, 1.0
    for _ in range(_SHARE_STEPS):
        share = 0.5 * (low + high)
        least, rising = np.inf, 0.0
        for k in range(6):
            value = share * q[k] + (1.0 - share) * other[k]
            if value < least:
                least, rising = value, q[k] - other[k]
        if rising > 0.0:
            low = share
        else:
            high = share
    return 0.5 * (low + high)
