"""Open paths among closed ones: told apart, or joined end to end.

open paths ──ends in order──> pairs of ends that meet ──walk from end to end──> chains
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import NOTHING, Bools, Floats, Ints
from splinesdf.shapes.loops import PRINTED_GAP, extent
from splinesdf.shapes.parts import groups

# So many unpaired ends at one place (of the width of a gap) are looked at to find an end's nearest.
# More: time grows like the square of the ends where a drawing is smaller than what its program
# prints; fewer: where many paths meet, but not to the bit, some that could be joined are not.
_MOST_NEAR = 64


def are_open(loops: Sequence[Sequence[Floats]]) -> list[bool | None]:
    """Of each path, whether its ends are farther apart than a drawing program's printed digits.

    None of one that is nothing but a point.

    Raises
    ------
    InputError
        If a coordinate is not finite or too large, or all is a single point.
    """
    size, _ = extent(loops)
    found = [_ends(loop, size) for loop in loops]
    return [None if ends is None else math.dist(*ends) > PRINTED_GAP * size for ends in found]


class Joined(NamedTuple):
    """Paths, joined to chains where ends meet.

    Closed ones are as they were. Of those that are joined, each is where the first of it was and
    runs as that does; others are turned round where they have to be.
    """

    loops: list[list[Floats]]
    paths: int  # how many were joined to another
    largest: float  # the largest gap between ends that were joined
    forks: int  # places of closed outlines where an odd number of paths end: one leads nowhere


def joined(loops: Sequence[list[Floats]], *, gap: float | None = None) -> Joined:
    """The loops, open ones joined where an end of one meets an end of another.

    Parameters
    ----------
    loops : sequence of lists of ndarray, shape (degree + 1, 2)
        The control points of each piece of each loop, pieces following one another.
    gap : float, optional
        How far apart ends may be that meet: 1e-6 of the drawing's size unless given.

    Notes
    -----
    Each end is paired once. Paths that are part of an outline come before those that lead to one or
    from one to another, so that these open none; then those that are equal to the bit, then the
    nearest; where more than two meet, the earlier ones in the file. Sorting takes most: O(n log n).
    """
    size, _ = extent(loops)
    ends = [_ends(loop, size) for loop in loops]
    gap = PRINTED_GAP * size if gap is None else gap
    rows = [row for row, pair in enumerate(ends) if pair and math.dist(*pair) > gap]
    # End 2 k is the start of the k-th open path, end 2 k + 1 is where it ends.
    points = np.array([ends[row] for row in rows]).reshape(-1, 2)
    partner, forks = _pairs(points, gap)
    met = [math.dist(points[a], points[b]) for a, b in enumerate(partner) if b >= 0]
    taken: set[int] = set()
    chains: dict[int, list[Floats]] = {}
    count = 0
    for k, row in enumerate(rows):
        if k in taken:
            continue
        chain = _chain(k, partner)
        taken.update(end // 2 for end in chain)
        count += len(chain) if len(chain) > 1 else 0
        # From the first path of it on, so that a closed chain starts where that does.
        chains[row] = [piece for end in chain for piece in _run(loops[rows[end // 2]], end)]
    rest = set(rows) - set(chains)
    kept = [chains.get(row, loop) for row, loop in enumerate(loops) if row not in rest]
    return Joined(kept, count, max(met, default=0.0), forks)


def _ends(loop: Sequence[Floats], size: float) -> tuple[Floats, Floats] | None:
    """Where a path starts and ends; None if it is nothing but a point."""
    pieces = [piece for piece in loop if np.any(np.ptp(piece, axis=0) > NOTHING * size)]
    return (pieces[0][0], pieces[-1][-1]) if pieces else None


def _pairs(points: Floats, gap: float) -> tuple[list[int], int]:
    """Of each end, the one that it is paired with, or -1: (n, 2) -> n; and `Joined.forks`."""
    partner = [-1] * len(points)
    on_circle, forks = _on_circles(points, gap)
    _pair_up(points, gap, np.flatnonzero(np.repeat(on_circle, 2)), partner)
    if not on_circle.all():
        _pair_up(points, gap, np.flatnonzero(np.array(partner) < 0), partner)
    return partner, forks


def _on_circles(points: Floats, gap: float) -> tuple[Bools, int]:
    """Which paths some way along others leads back to, and how many places an odd number end at.

    The rest are bridges, which a walk through all of the drawing crosses once: no way back goes
    above the place where it crosses.
    """
    place = groups(points, gap)
    at: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for path, (one, other) in enumerate(place.reshape(-1, 2).tolist()):
        at[one].append((path, other))
        at[other].append((path, one))
    on_circle = np.ones(len(points) // 2, dtype=np.bool_)
    depth: dict[int, int] = {}
    highest: dict[int, int] = {}
    for root in at:
        if root in depth:
            continue
        depth[root] = highest[root] = 0
        walk = [(root, -1, iter(at[root]))]
        while walk:
            here, by, rest = walk[-1]
            path, there = next(rest, (-1, -1))
            if path < 0:
                walk.pop()
                if walk:
                    above = walk[-1][0]
                    highest[above] = min(highest[above], highest[here])
                    on_circle[by] = highest[here] <= depth[above]
            elif there in depth:
                if path != by:
                    highest[here] = min(highest[here], depth[there])
            else:
                depth[there] = highest[there] = len(walk)
                walk.append((there, path, iter(at[there])))
    ends = np.bincount(place[np.repeat(on_circle, 2)]) % 2
    return on_circle, int(np.count_nonzero(ends))


def _pair_up(points: Floats, gap: float, ends: Ints, partner: list[int]) -> None:
    """Pair some ends with one another, which have no partner yet."""
    # Equal to the bit: neighbors in order, the earlier ones first.
    order = ends[np.lexsort((points[ends, 1], points[ends, 0]))].tolist()
    for one, other in pairwise(order):
        if partner[one] < 0 and (points[one] == points[other]).all():
            partner[one], partner[other] = other, one
    # The rest by squares of one gap: what meets is in the same or in one of the eight around.
    # Counted from the lowest corner, there are at most 1e6 of them in a row.
    some = points[ends]
    squares = np.floor((some - some.min(axis=0, initial=math.inf)) / gap).astype(np.int64)
    at: dict[tuple[int, int], list[int]] = defaultdict(list)
    for end, (i, j) in zip(ends.tolist(), squares.tolist(), strict=True):
        if partner[end] < 0:
            at[i, j].append(end)
    near = []
    for (i, j), here in at.items():
        # Each pair of squares once.
        around = [
            at.get(key, []) for key in ((i + 1, j - 1), (i + 1, j), (i + 1, j + 1), (i, j + 1))
        ]
        for place, one in enumerate(here[:_MOST_NEAR]):
            others = here[place + 1 : _MOST_NEAR]
            others = others + [other for square in around for other in square[:_MOST_NEAR]]
            near += [(math.dist(points[one], points[other]), one, other) for other in others]
    for apart, one, other in sorted(near):
        if apart <= gap and partner[one] < 0 and partner[other] < 0:
            partner[one], partner[other] = other, one


def _chain(first: int, partner: list[int]) -> list[int]:
    """The ends at which the paths of a chain are entered, in order, each path once.

    The chain runs as its path ``first`` does, and begins with it if it is closed.
    """
    entered = 2 * first
    # Back to where the chain begins, or once around.
    while (before := partner[entered]) >= 0 and before ^ 1 != 2 * first:
        entered = before ^ 1
    start = 2 * first if before >= 0 else entered
    chain = [start]
    while (following := partner[chain[-1] ^ 1]) >= 0 and following != start:
        chain.append(following)
    return chain


def _run(loop: list[Floats], end: int) -> list[Floats]:
    """The path's pieces from that end on: odd ones are where it ends."""
    return [piece[::-1] for piece in reversed(loop)] if end % 2 else loop
