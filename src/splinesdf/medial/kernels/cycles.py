"""The cycles of a permutation."""

from __future__ import annotations

from splinesdf.ground.arrays import Ints
from splinesdf.ground.jit import kernel


@kernel
def cycles(step: Ints, number: Ints, member: Ints) -> None:
    """Number the cycles of a permutation.

    Parameters
    ----------
    step : ndarray of int, shape (n,)
        What each leads to.
    number : ndarray of int, shape (n,)
        Of -1. Filled: the cycle of each.
    member : ndarray of int, shape (n,)
        Filled: cycle after cycle, in order.
    """
    found, filled = 0, 0
    for first in range(step.shape[0]):
        if number[first] >= 0:
            continue
        k = first
        while number[k] < 0:
            number[k] = found
            member[filled] = k
            filled += 1
            k = step[k]
        found += 1
