"""Runs: stretches of a loop that one line, one circle or one smooth curve goes through.

Lines and circles of the shape have lines and circles as their offsets, and corners have circles;
these stay what they are. Everything else between two of them, or two corners, is one free run.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from splinesdf._arrays import Bools, Floats, Ints
from splinesdf._tables import ROUND, STRAIGHT, Runs
from splinesdf.curves.geometry import angles
from splinesdf.curves.shape import Shape
from splinesdf.offsets.loops import Loops
from splinesdf.offsets.trimmed import parallels

# Circles that follow one another are one if their centers are no farther apart, as a share of
# radius and size: what short arcs leave of their precision.
_CENTERS_APART = 1e-9


def runs_of(shape: Shape, loops: Loops, distance: float) -> tuple[Runs, Ints]:
    """Cut loops into runs, each loop turned so that it begins with one.

    Returns
    -------
    runs : Runs
    first : ndarray, shape (n_loops + 1,)
        Loop j has the runs ``first[j]:first[j + 1]``.
    """
    kind, center = _kinds(shape, loops)
    count = len(kind)
    after = np.arange(1, count + 1)
    after[loops.first[1:] - 1] = loops.first[:-1]
    same = (kind == kind[after]) & loops.smooth
    round_ = (kind == ROUND) & (kind[after] == ROUND)
    scale = shape.size + abs(distance)
    same &= ~round_ | (np.abs(center[after] - center).max(axis=1) <= _CENTERS_APART * scale)
    order = np.concatenate([_turned(np.arange(a, b), same[a:b]) for a, b in pairwise(loops.first)])
    # Where the loops end, runs do.
    ends = ~same[order]
    ends[loops.first[1:] - 1] = True
    first = np.concatenate([[0], np.flatnonzero(ends) + 1])
    members = np.repeat(np.arange(len(first) - 1), np.diff(first))
    kind, center, sweep = kind[order], center[order], _sweeps(shape, loops, order, distance)
    with np.errstate(invalid="ignore"):
        weight = np.abs(sweep)
        total = np.bincount(members, weight)
        mean = np.column_stack([np.bincount(members, weight * c) / total for c in center.T])
    mean = np.where((total > 0.0)[:, None], mean, center[first[:-1]])
    starts = np.searchsorted(first, loops.first)
    closed = np.zeros(len(first) - 1, dtype=np.bool_)
    alone = np.flatnonzero(np.diff(starts) == 1)
    closed[starts[alone]] = loops.smooth[order[loops.first[alone + 1] - 1]]
    return (
        Runs(
            loops.elements[order],
            loops.spans[order],
            loops.start[order],
            loops.end[order],
            first,
            kind[first[:-1]],
            mean,
            np.bincount(members, sweep).astype(np.float64),
            closed,
        ),
        starts,
    )


def _kinds(shape: Shape, loops: Loops) -> tuple[Ints, Floats]:
    """Kind and center of every row."""
    table = shape.kinds
    arclet, corner = loops.elements.T
    bridge, around = arclet < 0, np.isfinite(loops.center[:, 0])
    kind = np.where(corner == 1, ROUND, table.kind[arclet])
    kind = np.where(bridge, np.where(around, ROUND, STRAIGHT), kind)
    center = np.where((corner == 1)[:, None], shape.boundary.end[arclet], table.center[arclet])
    center = np.where(bridge[:, None], loops.center, center)
    return kind, center


def _sweeps(shape: Shape, loops: Loops, order: Ints, distance: float) -> Floats:
    """How far the tangent turns along each row, all less than half a turn."""
    result = np.zeros(len(order))
    rows = loops.elements[order]
    own = np.flatnonzero(rows[:, 0] >= 0)
    a, b = (
        parallels(shape, rows[own], loops.spans[order[own], k], distance)[:, 2:4] for k in (0, 1)
    )
    result[own] = angles(a, b)
    bridges = np.flatnonzero(np.isfinite(loops.center[order, 0]))
    at = order[bridges]
    result[bridges] = angles(loops.start[at] - loops.center[at], loops.end[at] - loops.center[at])
    corners = rows[:, 1] == 1
    # Around the tip of a cusp rounding may take half a turn for one to the other side.
    result[corners] = np.copysign(result[corners], distance)
    return result


def _turned(rows: Ints, same: Bools) -> Ints:
    """The rows of a loop, starting behind a break if there is one."""
    breaks = np.flatnonzero(~same)
    return np.concatenate([rows[breaks[-1] + 1 :], rows[: breaks[-1] + 1]]) if len(breaks) else rows
