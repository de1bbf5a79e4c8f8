"""Open paths among closed ones: told apart, or joined end to end.

open paths ──ends in order──> pairs of ends that meet ──walk from end to end──> chains
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from splinesdf.ground.arrays import NOTHING, Floats
from splinesdf.shapes.loops import PRINTED_GAP, extent

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


def joined(
    loops: Sequence[list[Floats]], *, gap: float | None = None
) -> tuple[list[list[Floats]], int, float]:
    """The loops, open ones joined where an end of one meets an end of another.

    Parameters
    ----------
    loops : sequence of lists of ndarray, shape (degree + 1, 2)
        The control points of each piece of each loop, pieces following one another.
    gap : float, optional
        How far apart ends may be that meet: 1e-6 of the drawing's size unless given.

    Returns
    -------
    loops : list of lists of ndarray
        Closed ones as they are. Of those that are joined, each is where the first of it was and
        runs as that does; others are turned round where they have to be.
    count : int
        How many were joined to another.
    largest : float
        The largest gap between ends that were joined.

    Notes
    -----
    Each end is paired
    once, those that are equal to the bit first, then the nearest; where more than two meet, the
    earlier ones in the file. Sorting takes most: O(n log n).
    """
    size, _ = extent(loops)
    ends = [_ends(loop, size) for loop in loops]
    gap = PRINTED_GAP * size if gap is None else gap
    rows = [row for row, pair in enumerate(ends) if pair and math.dist(*pair) > gap]
    # End 2 k is the start of the k-th open path, end 2 k + 1 is where it ends.
    points = np.array([ends[row] for row in rows]).reshape(-1, 2)
    partner = _pairs(points, gap)
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
    return kept, count, max(met, default=0.0)


def _ends(loop: Sequence[Floats], size: float) -> tuple[Floats, Floats] | None:
    """Where a path starts and ends; None if it is nothing but a point."""
    pieces = [piece for piece in loop if np.any(np.ptp(piece, axis=0) > NOTHING * size)]
    return (pieces[0][0], pieces[-1][-1]) if pieces else None


def _pairs(points: Floats, gap: float) -> list[int]:
    """Of each end, the one that it is paired with, or -1: (n, 2) -> n."""
    partner = [-1] * len(points)
    # Equal to the bit: neighbors in order, the earlier ones first.
    order = np.lexsort((points[:, 1], points[:, 0])).tolist()
    for one, other in pairwise(order):
        if partner[one] < 0 and (points[one] == points[other]).all():
            partner[one], partner[other] = other, one
    # The rest by squares of one gap: what meets is in the same or in one of the eight around.
    # Counted from the lowest corner, there are at most 1e6 of them in a row.
    squares = np.floor((points - points.min(axis=0, initial=math.inf)) / gap).astype(np.int64)
    at: dict[tuple[int, int], list[int]] = defaultdict(list)
    for end, (i, j) in enumerate(squares.tolist()):
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
    return partner


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
