"""Loops of an offset, and those that are left out as rounding leaves them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints

# A loop that is smaller than this share of the tolerance, or of the boundary's loop, is left out:
# it may be what rounding leaves next to where parallels cross at a small angle.
_LEAST, _SPECK = 1e-3, 1e-9


class Loops(NamedTuple):
    """Closed loops, one after the other; each row is a stretch or a bridge, in order."""

    elements: Ints  # (n, 2) see `Stretches`; -1 for a bridge
    spans: Floats  # (n, 2)
    start: Floats  # (n, 2) points, relative to the boundary's origin; each is the one before's end
    end: Floats  # (n, 2)
    center: Floats  # (n, 2) of a bridge that is an arc, NaN for a straight one
    smooth: Bools  # (n,) whether the tangent is continuous where the row ends
    first: Ints  # (n_loops + 1,) loop j has the rows first[j]:first[j + 1]


def without_specks(loops: Loops, sizes: Floats, tolerance: float) -> Loops:
    """Without loops that are smaller both ways than what rounding may leave."""
    if len(loops.first) < 2:
        return loops
    arclet = loops.elements[:, 0]
    own = np.where(arclet < 0, 0.0, sizes[arclet])
    own = np.maximum.reduceat(own, loops.first[:-1])
    least = np.maximum(_LEAST * tolerance, _SPECK * own)
    low = np.minimum.reduceat(loops.start, loops.first[:-1])
    high = np.maximum.reduceat(loops.start, loops.first[:-1])
    rows_each = np.diff(loops.first)
    # One row alone that is a loop is a speck: none turns by a full turn.
    kept = (high - low).max(axis=1) > least
    if kept.all():
        return loops
    rows = np.repeat(kept, rows_each)
    first = np.concatenate([[0], np.cumsum(rows_each[kept])])
    return Loops(
        loops.elements[rows],
        loops.spans[rows],
        loops.start[rows],
        loops.end[rows],
        loops.center[rows],
        loops.smooth[rows],
        first,
    )
