"""Arclets: a boundary cut into short, nearly straight arcs under a tree of boxes and capsules.

    pieces ──split where x or y turns──> monotone ──halve while they bulge──> arclets ──halve
    the list──> tree

The distance kernel asks three things of an arclet: a capsule around it, the squared distance to
a point as a Bernstein polynomial (two multiplications a coefficient, thanks to ``gram`` and
``linear``), and points and derivatives near a parameter. The winding kernel needs only that y is
monotone, the search for crossings that directions stay within a quadrant.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.tables import Arclets, Arcs
from splinesdf.arclets.tree import along_z, build_hierarchy
from splinesdf.ground.arrays import Bools, Floats, Ints

# An arclet's control points stay within this share of its chord's length from the chord (about
# 45 degrees of turning). Smaller: more arclets, tighter capsules, fewer Newton steps, a deeper
# tree. It is a matter of speed only: no guarantee depends on it.
_BULGE = 0.1
# Nor does an arclet bend so fast anywhere that it would turn by more than this (radians) on its
# length: spikes and ends like cusps are cut off. Larger: curvature is known so badly beside them
# that proofs of a fit's error take long; smaller: more arclets. Again a matter of speed only.
_BENT = 2.0
# Halvings after which a piece is taken as it is. Only pieces that shrink to a point (cusps, where
# the chord vanishes as fast as the bulge) get there; the kernel is exact on them all the same.
_HALVINGS = 12
# Nor is anything cut that is smaller than this share of its piece, or, for rounding, the second one
# of the largest coordinate. Smaller: next to a cusp directions of what is cut off are rounding;
# larger: curves far from the origin are not cut, and not understood.
_SMALLEST, _LOST = 1e-8, 1e-12
# A step between control points below this share of the largest coordinate is rounding: the x of a
# straight vertical piece must not be seen to turn, nor that of an arc that ends where it turns.
# Too large: a real turn is missed, and the winding number is wrong within that share of the size
# of the curve there.
_NO_STEP = 64 * 2.220446049250313e-16
# Arclets of a bent piece that there is room for at first. Fewer: more shapes are cut twice.
_ROOM = 4


class Sequences(NamedTuple):
    """How arcs follow one another."""

    label: Ints  # (n,) which run the arc belongs to
    place: Ints  # (n,) its place in the run
    closed: Bools  # (n_runs,) whether the last one leads to the first one


def build_arclets(control: Floats, starts: Ints, loops: Ints) -> Arclets:
    """Cut the pieces of a shape (see `Shape`) into arclets and put the tree over them."""
    from splinesdf.arclets.kernels.cutting import (  # Numba loads only when it is used
        Cut,
        Cutting,
        Pieces,
        cut_pieces,
    )

    origin = 0.5 * (control.min(axis=0) + control.max(axis=0))
    largest = float(np.abs(control).max())
    degrees = np.diff(starts) - 1
    most = int(degrees.max())
    cutting = Cutting(
        pascal=pascal(2 * most + 1),
        noise=_noise(control - origin, starts, degrees),
        bulge=_BULGE,
        bent=_BENT,
        halvings=_HALVINGS,
        smallest=_SMALLEST,
        lost=_LOST * largest,
    )
    pieces = Pieces(np.ascontiguousarray(control), np.ascontiguousarray(starts), origin)
    room = len(degrees) + _ROOM * int(np.count_nonzero(degrees > 1))
    while True:
        found = Cut(_empty_arcs(room, most), np.zeros(1, dtype=np.int64))
        cut_pieces(pieces, cutting, found)
        count = int(found.total[0])
        if count <= room:
            break
        room = count
    arcs = Arcs._make(column[:count] for column in found.arcs)
    label = np.searchsorted(loops, arcs.piece, side="right") - 1
    closed = np.ones(len(loops) - 1, dtype=np.bool_)
    return assemble(arcs, Sequences(label, np.arange(count), closed), origin)


def _noise(control: Floats, starts: Ints, degrees: Ints) -> Floats:
    """By degree, steps between control points that are rounding: (m,)."""
    ends = np.maximum(np.abs(control[starts[:-1]]), np.abs(control[starts[1:] - 1])).max(axis=1)
    result = np.zeros(int(degrees.max()) + 1)
    np.maximum.at(result, degrees, ends)
    return _NO_STEP * result


@cache
def pascal(size: int) -> Floats:
    """Binomial coefficients, a row for each degree: (size, size)."""
    result = np.zeros((size, size))
    for n in range(size):
        result[n, : n + 1] = [math.comb(n, k) for k in range(n + 1)]
    return result


def _empty_arcs(count: int, most: int) -> Arcs:
    """Room for arcs of degrees up to the most."""
    return Arcs(
        control=np.zeros((count, most + 1, 2)),
        start=np.empty((count, 2)),
        degree=np.empty(count, dtype=np.int64),
        piece=np.empty(count, dtype=np.int64),
        interval=np.empty((count, 2)),
    )


def assemble(arcs: Arcs, runs: Sequences, origin: Floats) -> Arclets:
    """Tables and tree of arcs that are short and monotone already.

    Parameters
    ----------
    arcs : Arcs
        Relative to ``origin``.
    runs : Sequences
        Of the arcs. Sequences that are near one another become neighbors in the tree.
    origin : ndarray, shape (2,)
    """
    from splinesdf.arclets.kernels.assembly import fill_tables  # Numba loads only when it is used

    order = np.lexsort((runs.place, _near_ones_together(arcs.start, runs.label)[runs.label]))
    control, start, degree, piece, interval = Arcs._make(column[order] for column in arcs)
    label = runs.label[order]
    following = _following(label, runs.closed)
    rows = np.arange(len(order))
    end = start + (control[rows, degree] - control[:, 0])
    end = np.where((following >= 0)[:, None], start[following], end)
    most = int(degree.max())
    power = np.zeros((len(order), most + 1, 2))
    table, boxes, radius = (
        np.zeros((len(order), 8 * (most + 1))),
        np.empty((len(order), 4)),
        np.empty(len(order)),
    )
    fill_tables(control, degree, pascal(2 * most + 1), (start, end), power, table, boxes, radius)
    found = build_hierarchy(start, end, boxes, radius, label)
    return Arclets(
        origin=origin,
        start=start,
        end=end,
        power=power,
        piece=piece,
        interval=interval,
        run=label,
        following=following,
        arcs=table,
        tree=found.tree,
        boxes=found.boxes,
        range=found.range,
        chain=found.chain,
    )


def _near_ones_together(start: Floats, label: Ints) -> Ints:
    """A rank for each run, along the Z-shaped curve through the middles of their first points."""
    count = int(label.max()) + 1
    if count == 1:
        return np.zeros(1, dtype=np.int64)
    total = np.stack([np.bincount(label, column) for column in start.T], axis=1)
    key = along_z(total / np.bincount(label)[:, None], 16)
    rank = np.empty(count, dtype=np.int64)
    rank[np.argsort(key, kind="stable")] = np.arange(count)
    return rank


def _following(label: Ints, closed: Bools) -> Ints:
    """The arclet after each one, given the runs that they lie in, in order; -1 at an open end."""
    first = np.flatnonzero(np.diff(label, prepend=-1))
    result = np.arange(1, len(label) + 1)
    result[np.append(first[1:], len(label)) - 1] = np.where(closed[label[first]], first, -1)
    return result
