"""The fill on both sides of the chains of a drawing, and which of them bound it.

A chain has the same winding number along all of one side, so one look at each side decides. The
look is taken where the chain is clearest of all others, halfway to what is next to it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.arclets.crossings import degrees
from splinesdf.arclets.points import points_at, previous_of, tangents_at
from splinesdf.arclets.tables import Arclets, Candidates, Cells, Feet, PassedOver, Searched
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.shapes.parts import MERGE, Parts, chain_ends, groups

# Parts of a chain, its longest ones, in which a clear place is looked for, and where in each.
_PARTS = 3
_PLACES = (0.5, 0.3, 0.7)
# A stretch of a contour runs to and fro on top of itself, and bounds nothing, if its two sides are
# nearer than this share of what counts as touching. Farther apart, it may be the tip of a cusp.
_ON_TOP = 0.25
# The tip of a cusp that is thinner than what counts as touching is no longer than this share of
# the size: a width that grows like the square or the cube of the length has grown out of it. And
# below the second share, whatever it is, to keep it costs no more than its length.
_LONGEST_TIP, _SHORTEST_SLIT = 1e-4, 1e-7
# Chains on top of each other are of one length, but for what counts as touching: the shorter one is
# more than this share of the longer. Larger: tiny ones, whose lengths are rounding, count
# twice; smaller: a whole contour passes for a repetition of its own shortest side.
_ALIKE = 0.25


class Sides(NamedTuple):
    """Of each chain, what was found in its clearest place."""

    left: Bools  # (n,) whether its left is filled
    right: Bools  # (n,)
    partner: Ints  # (n,) another arclet on top of it there, -1 for none
    at: Floats  # (n,) that one's parameter
    apart: Floats  # (n,) how far from it
    length: Floats  # (n,) of the chain


def look_at_sides(outline: Arclets, parts: Parts, least: int, touching: float) -> Sides:
    """Look at both sides of each chain; what is within twice ``touching`` of it is on top of it."""
    from splinesdf.arclets.kernels.winding import fill_inside  # Numba loads only when it is used

    low, high = parts.interval.T
    ends = points_at(outline, parts.arclet, low), points_at(outline, parts.arclet, high)
    length = np.hypot(*(ends[1] - ends[0]).T)
    order = np.lexsort((-length, parts.chain))
    rank = np.arange(len(order)) - np.searchsorted(parts.chain, parts.chain)
    longest = order[rank < _PARTS]
    part = np.repeat(longest, len(_PLACES))
    t = low[part] + np.tile(_PLACES, len(longest)) * (high - low)[part]
    place = points_at(outline, parts.arclet[part], t)
    tangent = tangents_at(outline, parts.arclet[part], t)
    # What is nearest may lie on top of the chain; what is nearest beyond that does not.
    near, partner, at = _others(outline, place, parts.arclet[part], -1.0)
    partner = np.where(near <= 2.0 * touching, partner, -1)
    clear, _, _ = _others(outline, place, parts.arclet[part], 2.0 * touching)
    # The clearest place of each chain; if possible one where no other passes through.
    crowded = (partner >= 0) | (clear <= MERGE * touching)
    order = np.lexsort((-clear, crowded, parts.chain[part]))
    best = order[np.flatnonzero(np.diff(parts.chain[part][order], prepend=-1))]
    normal = np.column_stack([-tangent[best, 1], tangent[best, 0]])
    normal /= np.maximum(np.hypot(normal[:, 0], normal[:, 1]), np.finfo(np.float64).tiny)[:, None]
    reach = 0.5 * np.minimum(clear[best], np.ptp(outline.boxes[0].reshape(2, 2), axis=0).max())
    sides = []
    for side in (1.0, -1.0):
        points = place[best] + side * reach[:, None] * normal
        filled = np.empty(len(best), dtype=np.bool_)
        # Zero: no point says anything about the next one.
        nowhere = np.zeros(len(best))
        fill_inside(
            outline.boxes,
            outline.range,
            outline.chain,
            outline.arcs,
            points,
            nowhere,
            least,
            filled,
        )
        sides.append(filled)
    return Sides(
        left=sides[0],
        right=sides[1],
        partner=partner[best],
        at=at[best],
        apart=near[best],
        length=np.bincount(parts.chain, weights=length).astype(np.float64),
    )


def _others(
    outline: Arclets, points: Floats, own: Ints, within: float
) -> tuple[Floats, Ints, Floats]:
    """Distance, arclet and parameter of what is nearest to points on arclets, but for their own.

    And but for what is not farther than ``within``.
    """
    from splinesdf.arclets.kernels.nearest import nearest  # Numba loads only when it is used

    count = len(points)
    # One cell a point, with the root of the tree.
    cells = Cells(np.zeros(4), 0, np.arange(count + 1), points)
    candidates = Candidates(np.arange(count + 1), np.zeros(count, dtype=np.int64))
    feet = Feet(
        distance=np.empty(count),
        arclet=np.empty(count, dtype=np.int64),
        at=np.empty(count),
        farthest=np.inf,
    )
    done = np.zeros(count, dtype=np.bool_)
    largest = float(np.abs(outline.boxes[0]).max())
    searched = Searched(outline.tree, outline.arcs, largest)
    nearest(searched, cells, candidates, done, PassedOver(own, within), feet)
    return feet.distance, feet.arclet, feet.at


def bounding(outline: Arclets, parts: Parts, sides: Sides, touching: float) -> tuple[Bools, Bools]:
    """Which chains bound what is filled, and whether the inside is on their left."""
    keep, left = sides.left != sides.right, sides.left.copy()
    tips, tip = [], np.zeros(len(keep), dtype=bool)
    size = float(np.ptp(outline.boxes[0].reshape(2, 2), axis=0).max())
    tiny = sides.length < _SHORTEST_SLIT * size
    for run, before in _doubtful_runs(parts, sides, keep, tiny):
        length = float(sides.length[run].sum())
        apart = sides.apart[run][sides.partner[run] >= 0].max(initial=0.0)
        thin = length < _LONGEST_TIP * size and apart > _ON_TOP * touching
        if thin or length < _SHORTEST_SLIT * size:
            tip[run], left[run] = True, left[before]
            tips.append((run, before))
    keep &= ~_repeated(outline, parts, sides, keep, tip, touching)
    # What leads on from a chain that is drawn again is drawn again with it; from another it leads
    # on, also where two contours touch, and another tip lies on it.
    for run, before in tips:
        keep[run] |= keep[before]
    # The ends of a sliver that is closed: its sides are gone, they would be left alone.
    short = ~parts.closed & (sides.length <= MERGE * touching)
    alone = short & ~(keep[parts.following] | keep[previous_of(parts.following)])
    return keep & ~alone, left


def _doubtful_runs(
    parts: Parts, sides: Sides, keep: Bools, tiny: Bools
) -> list[tuple[list[int], int]]:
    """Runs of chains that are tiny, or dropped with another on top; and the chain before each.

    Only between two chains that are kept, with the inside on the same side: the contour might as
    well go on through the run.
    """
    doubtful = tiny | (~keep & (sides.partner >= 0))
    firm = keep & ~doubtful
    result = []
    for before in np.flatnonzero(firm & doubtful[parts.following]).tolist():
        run = []
        chain = int(parts.following[before])
        while doubtful[chain]:
            run.append(chain)
            chain = int(parts.following[chain])
        if firm[chain] and sides.left[chain] == sides.left[before]:
            result.append((run, before))
    return result


def _repeated(
    outline: Arclets, parts: Parts, sides: Sides, keep: Bools, tip: Bools, touching: float
) -> Bools:
    """Chains that lie on top of an earlier one that is kept, from end to end; tips come first.

    A tip leads on from one chain to the next. Dropped, it would leave these open.

    Each knows one other: of three or more on top of one another those known by any are one group,
    and lines with the same ends.
    """
    ends = chain_ends(outline, parts)
    chain = np.flatnonzero(sides.partner >= 0)
    # The part in which the partner's parameter lies, and so the chain.
    order = np.lexsort((parts.interval[:, 0], parts.arclet))
    key = parts.arclet[order] + parts.interval[order, 0]
    where = np.searchsorted(key, sides.partner[chain] + sides.at[chain], side="right") - 1
    other = parts.chain[order[where]]
    near = 2.0 * MERGE * touching

    def meet(a: Floats, b: Floats) -> Bools:
        return np.asarray(np.hypot(*(a - b).T) <= near)

    same = meet(ends[0, chain], ends[0, other]) & meet(ends[1, chain], ends[1, other])
    turned = meet(ends[0, chain], ends[1, other]) & meet(ends[1, chain], ends[0, other])
    # Whole loops need not begin at the same place.
    both_closed = parts.closed[chain] & parts.closed[other]
    # A contour with a side that is next to nothing has the ends of that side, but lies not on it.
    shorter, longer = np.sort([sides.length[chain], sides.length[other]], axis=0)
    linked = (same | turned | both_closed) & keep[other] & keep[chain] & (shorter > _ALIKE * longer)
    line = np.bincount(parts.chain) == 1
    line[parts.chain] &= degrees(outline)[parts.arclet] == 1
    line &= keep & (sides.partner >= 0)
    number = np.sort(groups(ends[:, line].reshape(-1, 2), near).reshape(2, -1), axis=0)
    _, first, which = np.unique(number, axis=1, return_index=True, return_inverse=True)
    lines = np.flatnonzero(line)
    one = np.concatenate([chain[linked], lines])
    two = np.concatenate([other[linked], lines[first[which.ravel()]] if len(lines) else lines])
    rank = np.empty(len(keep), dtype=np.int64)
    rank[np.argsort(~tip, kind="stable")] = np.arange(len(keep))
    earliest, changed = rank.copy(), True
    while changed:  # each round some become earlier, or it ends
        before = earliest.copy()
        least = np.minimum(earliest[one], earliest[two])
        np.minimum.at(earliest, one, least)
        np.minimum.at(earliest, two, least)
        changed = not np.array_equal(before, earliest)
    return np.asarray(earliest < rank)
