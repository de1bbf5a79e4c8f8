"""Disks of the axis between two others of one edge: their feet are between those of both."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.medial.chords import Region, disks_at, position
from splinesdf.medial.conics import slopes
from splinesdf.medial.feet import arms
from splinesdf.medial.graph import Chains

# A second foot may be beyond its neighbors' by this share of the size, for rounding. Larger: disks
# of another edge pass for one of this; smaller: good ones are refused.
_BEYOND = 1e-7


class Pool(NamedTuple):
    """Disks of edges, in the order in which they were found."""

    disk: Floats  # (n, 3) x, y, r
    element: Ints  # (n, 2) places of the right and the left foot
    at: Floats  # (n, 2)
    foot: Floats  # (n, 2, 2)
    slope: Floats  # (n, 3) direction of the axis in (x, y, r)
    order: Floats  # (n,) by how much both feet have walked, edge after edge


def pool_of(region: Region, chains: Chains, slope: Floats) -> Pool:
    """The nodes of chains."""
    nodes = chains.nodes
    pool = Pool(nodes.disk, nodes.element, nodes.at, nodes.foot, slope, np.empty(len(nodes.disk)))
    every = np.arange(len(nodes.disk) - 1)
    steps = sum(_ordered(region, pool, every, every + 1, side)[1] for side in (0, 1))
    # Edges are kept apart.
    steps = np.where(np.isin(every + 1, chains.first), region.size, steps)
    return pool._replace(order=np.concatenate([np.zeros(1), np.cumsum(steps)])[: len(nodes.disk)])


def with_middles(region: Region, pool: Pool, five: Ints) -> tuple[Pool, Ints, Bools]:
    """Fill the disks at the middle and the quarters where they are missing (-1).

    Returns
    -------
    pool : Pool
    five : ndarray of int
    lost : ndarray of bool
        Whether one of them was not found.
    """
    five = five.copy()
    lost = np.zeros(len(five), dtype=np.bool_)
    for target, before, behind in ((2, 0, 4), (1, 0, 2), (3, 2, 4)):
        rows = np.flatnonzero((five[:, target] < 0) & (five[:, before] >= 0) & ~lost)
        if not len(rows):
            continue
        half = np.full(len(rows), 0.5)
        pool, good = between(region, pool, five[rows, before], five[rows, behind], half)
        count = len(pool.order)
        five[rows, target] = np.arange(count - len(rows), count)
        lost[rows[~good]] = True
    five = np.where(five < 0, five[:, :1], five)
    return pool, five, lost


def between(
    region: Region, pool: Pool, first: Ints, last: Ints, share: Floats
) -> tuple[Pool, Bools]:
    """Disks at a share of the way between others, by their feet, and which of them were found."""
    right_low, right_length = _ordered(region, pool, first, last, 0)
    left_low, left_length = _ordered(region, pool, first, last, 1)
    on_left = left_length > right_length
    start = np.where(on_left, left_low, right_low)
    length = np.where(on_left, left_length, right_length)
    loop = region.loops.loop[pool.element[first, on_left.astype(np.int64)]]
    # The left foot walks backward.
    way = np.where(on_left, 1.0 - share, share)
    element, at = _place(region, start + way * length, loop)
    found, good = disks_at(region, element, at)
    # The second foot must be on the other side, between those of the neighbors.
    other_low = np.where(on_left, right_low, left_low)
    other_length = np.where(on_left, right_length, left_length)
    other_loop = region.loops.loop[pool.element[first, 1 - on_left.astype(np.int64)]]
    second = np.where(good, found.element[:, 1], 0)
    where = position(region, second, found.at[:, 1])
    around = _around(region, other_loop)
    slack = _BEYOND * region.size
    ahead = np.mod(where - other_low + slack, around)
    good &= (region.loops.loop[second] == other_loop) & (ahead <= other_length + 2.0 * slack)
    places, params = np.where(good[:, None], found.element, 0), found.at
    right = np.where(on_left, places[:, 1], places[:, 0])
    left = np.where(on_left, places[:, 0], places[:, 1])
    right_at = np.where(on_left, params[:, 1], params[:, 0])
    left_at = np.where(on_left, params[:, 0], params[:, 1])
    disk = np.column_stack([found.center, found.radius])
    sides = (
        arms(region.walk, e, u, disk[:, :2], region.size)
        for e, u in ((right, right_at), (left, left_at))
    )
    foot, normal = (np.stack(column, axis=1) for column in zip(*sides, strict=True))
    slope = slopes(normal)
    slope = np.where(np.isnan(slope), 0.0, slope)
    good &= np.any(slope != 0.0, axis=1)
    walked = _advance(region, pool, first, right, right_at, 0)
    walked += _advance(region, pool, first, left, left_at, 1)
    low, high = pool.order[first], pool.order[last]
    middle = np.clip(low + walked, low, high)
    joined = Pool(
        np.concatenate([pool.disk, disk]),
        np.concatenate([pool.element, np.column_stack([right, left])]),
        np.concatenate([pool.at, np.column_stack([right_at, left_at])]),
        np.concatenate([pool.foot, foot]),
        np.concatenate([pool.slope, slope]),
        np.concatenate([pool.order, middle]),
    )
    return joined, good


def _around(region: Region, loop: Ints) -> Floats:
    """Lengths of loops."""
    loops = region.loops
    ends = loops.first[1:] - 1
    total = region.start[ends] + loops.length[ends] - region.start[loops.first[:-1]]
    return np.asarray(total[loop])


def _ordered(
    region: Region, pool: Pool, first: Ints, last: Ints, side: int
) -> tuple[Floats, Floats]:
    """Where the walk begins between the feet of two disks on one side, and how long it is."""
    one, other = (first, last) if side == 0 else (last, first)
    start = position(region, pool.element[one, side], pool.at[one, side])
    end = position(region, pool.element[other, side], pool.at[other, side])
    around = _around(region, region.loops.loop[pool.element[one, side]])
    length = np.mod(end - start, around)
    # A foot that stays where it is, to rounding.
    return start, np.where(length > around - 1e-9 * region.size, 0.0, length)


def _advance(
    region: Region, pool: Pool, first: Ints, element: Ints, at: Floats, side: int
) -> Floats:
    """How far a foot on one side has walked from that of another disk: (n,)."""
    start = position(region, pool.element[first, side], pool.at[first, side])
    where = position(region, element, at)
    around = _around(region, region.loops.loop[pool.element[first, side]])
    step = where - start if side == 0 else start - where
    step = np.mod(step, around)
    return np.asarray(np.where(step > around - 1e-9 * region.size, 0.0, step))


def _place(region: Region, where: Floats, loop: Ints) -> tuple[Ints, Floats]:
    """Element and parameter of positions on loops."""
    loops = region.loops
    first = region.start[loops.first[:-1]][loop]
    around = _around(region, loop)
    where = first + np.mod(where - first, around)
    element = np.searchsorted(region.start, where, side="right") - 1
    element = np.clip(element, loops.first[:-1][loop], loops.first[1:][loop] - 1)
    at = (where - region.start[element]) / loops.length[element]
    return element, np.clip(at, 0.0, 1.0)
