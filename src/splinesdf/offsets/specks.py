"""Specks: loops so small that only rounding leaves them."""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.offsets.tables import POINT, Loops
from splinesdf.offsets.trimmed import selected

# Loops smaller than these shares of the tolerance, or of the boundary's loop, are left out, as they
# are what rounding leaves next to crossings of parallels at a small angle.
_LEAST, _SPECK = 1e-3, 1e-9


def without_specks(loops: Loops, sizes: Floats, tolerance: float) -> Loops:
    """Leave out loops that are smaller, in width and height, than rounding may leave them.

    Parameters
    ----------
    loops : Loops
    sizes : ndarray, shape (n_arclets,)
        The size of the boundary's loop that each arclet is of.
    tolerance : float
    """
    if len(loops.first) < 2:
        return loops
    arclet, points = loops.segments.elements[:, 0], loops.segments.start[:, POINT]
    own = np.where(arclet < 0, 0.0, sizes[arclet])
    own = np.maximum.reduceat(own, loops.first[:-1])
    least = np.maximum(_LEAST * tolerance, _SPECK * own)
    low = np.minimum.reduceat(points, loops.first[:-1])
    high = np.maximum.reduceat(points, loops.first[:-1])
    rows_each = np.diff(loops.first)
    # A loop of one row is a speck, too: no row turns by a full turn.
    kept = (high - low).max(axis=1) > least
    if kept.all():
        return loops
    rows = np.repeat(kept, rows_each)
    first = np.concatenate([[0], np.cumsum(rows_each[kept])])
    return Loops(selected(loops.segments, rows), loops.center[rows], loops.smooth[rows], first)
