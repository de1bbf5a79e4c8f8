"""Straight pieces of a higher degree as lines, to where they turn back and from there on.

Handles of no length, or along the line, leave a parallel without a direction somewhere; beside a
line it has one.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from splinesdf.ground.arrays import Floats

# Of the largest coordinate: how far rounding moves control points, which are sums of a file's
# relative steps. Smaller: a handle of no length has a random direction, and where a line turns
# back is a curve that no parallel follows; larger: what bends is taken for a line.
_ROUNDING = 1e-13
# Roots this near to the real line are on it.
_REAL = 1e-6


def straightened(piece: Floats) -> list[Floats]:
    """A straight piece as lines, one after the other; any other as it is but for rounded handles.

    Parameters
    ----------
    piece : ndarray, shape (degree + 1, 2)
        Not all of its control points are the same.
    """
    if len(piece) == 2:
        return [piece]
    rounding = _ROUNDING * float(np.abs(piece).max())
    piece = _without_rounded_handles(piece, rounding)
    ways = piece - piece[0]
    far = ways[int(np.argmax(np.hypot(ways[:, 0], ways[:, 1])))]
    aside = np.abs(far[0] * ways[:, 1] - far[1] * ways[:, 0]).max() / math.hypot(*far)
    if aside > rounding:
        return [piece]
    along = powers(ways @ far / float(far @ far))
    roots = np.roots(np.polyder(along))
    real = (np.abs(roots.imag) < _REAL) & (roots.real > 0.0) & (roots.real < 1.0)
    turns = np.polyval(along, np.sort(roots.real[real]))
    steps = np.diff([0.0, *turns, np.polyval(along, 1.0)])
    if np.all(steps >= 0.0) or np.all(steps <= 0.0):
        return [piece[[0, -1]]]
    places = [piece[0], *(piece[0] + share * far for share in turns), piece[-1]]
    return [np.array(ends) for ends in pairwise(places)]


def _without_rounded_handles(piece: Floats, rounding: float) -> Floats:
    """The piece, control points at an end if they are only rounding away from it."""
    piece = piece.copy()
    for end in (0, -1):
        away = np.hypot(*(piece[1:-1] - piece[end]).T)
        piece[1:-1][away <= rounding] = piece[end]
    return piece


def powers(values: Floats) -> Floats:
    """A Bernstein polynomial, less its value at the start, by falling powers of its parameter."""
    degree = len(values) - 1
    rising = [
        math.comb(degree, k) * np.diff(values - values[0], k)[0] if k else 0.0
        for k in range(degree + 1)
    ]
    return np.array(rising[::-1])
