"""The boundary of what a shape fills: where contours cross, touch or repeat, only what separates.

    arclets ──crossings──> parts ──joined between crossings──> chains ──a side of each is filled
    and the other is not──> kept, turned so that the inside is on the left

A chain has the same winding number along all of one side, so one look at each side decides. The
look is taken where the chain is clearest of all others, halfway to what is next to it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf._arrays import Bools, Floats, Ints
from splinesdf._tables import Arclets, Candidates, Cells, Feet, PassedOver
from splinesdf.curves.arclets import Arcs, Runs, assemble, split
from splinesdf.curves.crossings import control_points, degrees, find_crossings
from splinesdf.curves.geometry import points_at, tangents_at
from splinesdf.errors import InputError

# Nearer than this counts as touching, in units of the largest coordinate: a few times what
# rounding and compiled pieces (4 ulp) can put between curves that are meant to coincide. Larger:
# slits and gaps of that width are closed; smaller: contours drawn twice are not recognized, and
# what lies inside would attract the distance.
_TOUCHING = 64 * 2.220446049250313e-16
# Crossings on one arc nearer than this many times that are one.
_MERGE = 8.0
# Parts of a chain, its longest ones, in which a clear place is looked for, and where in each.
_PARTS = 3
_PLACES = (0.5, 0.3, 0.7)


class _Parts(NamedTuple):
    """Arclets cut at crossings, in the order in which they were drawn."""

    arclet: Ints  # (n,)
    interval: Floats  # (n, 2) parameters of the arclet
    chain: Ints  # (n,) number of the chain, from 0
    place: Ints  # (n,) place in the chain
    closed: Bools  # (n_chains,) whether the chain is a whole loop
    following: Ints  # (n_chains,) the chain that was drawn next


def filled_boundary(outline: Arclets, evenodd: bool, largest: float) -> Arclets:
    """The arclets that have the filled region on exactly one side, which is their left.

    Parameters
    ----------
    outline : Arclets
        All that was drawn.
    evenodd : bool
        The fill rule; otherwise nonzero.
    largest : float
        The largest absolute coordinate of the shape, in its own system.

    Raises
    ------
    InputError
        If nothing is filled.
    """
    touching = _TOUCHING * largest
    parts = _cut_at_crossings(outline, touching)
    left, right, partner, partner_at = _sides(outline, parts, evenodd, touching)
    keep = left != right
    keep &= ~_repeated(outline, parts, keep, partner, partner_at, touching)
    if not keep.any():
        rule, other = ("evenodd", "nonzero") if evenodd else ("nonzero", "evenodd")
        raise InputError(
            f"the contours fill nothing under the rule {rule!r}: they are traced to and fro, or "
            f"twice; draw each once, or try fill={other!r}"
        )
    if keep.all() and left.all() and parts.closed.all():
        return outline
    return _rebuild(outline, parts, keep, left, touching)


def _cut_at_crossings(outline: Arclets, touching: float) -> _Parts:
    pair, at = find_crossings(outline, touching)
    arclet, t = pair.ravel(), at.ravel()
    order = np.lexsort((t, arclet))
    arclet, t = arclet[order], t[order]
    place = points_at(outline, arclet, t)
    count = len(outline.start)
    near = _MERGE * touching
    at_start = np.hypot(*(place - outline.start[arclet]).T) <= near
    at_end = np.hypot(*(place - outline.end[arclet]).T) <= near
    # A chain begins at the joint before these arclets.
    begins = np.zeros(count, dtype=bool)
    begins[arclet[at_start]] = True
    begins[outline.following[arclet[at_end]]] = True
    inner = ~(at_start | at_end)
    arclet, t, place = arclet[inner], t[inner], place[inner]
    if len(arclet):
        gap = np.hypot(*np.diff(place, axis=0, prepend=place[:1]).T)
        again = (np.diff(arclet, prepend=-1) == 0) & (gap <= near)
        arclet, t = arclet[~again], t[~again]
    part_arclet = np.concatenate([np.arange(count), arclet])
    low = np.concatenate([np.zeros(count), t])
    order = np.lexsort((low, part_arclet))
    part_arclet, low = part_arclet[order], low[order]
    last = np.diff(part_arclet, append=count) != 0
    high = np.where(last, 1.0, np.append(low[1:], 1.0))
    begin = (low > 0.0) | begins[part_arclet]
    return _in_chains(outline, part_arclet, np.column_stack([low, high]), begin)


def _in_chains(outline: Arclets, arclet: Ints, interval: Floats, begin: Bools) -> _Parts:
    """Number the runs between crossings; a loop's parts are turned to begin with a crossing."""
    first_of_loop = np.zeros(len(outline.start), dtype=bool)
    # A loop's last arclet leads back to its first one.
    back = outline.following <= np.arange(len(outline.start))
    first_of_loop[outline.following[back]] = True
    starts = np.flatnonzero(first_of_loop[arclet] & (interval[:, 0] == 0.0))
    loop = np.searchsorted(starts, np.arange(len(arclet)), side="right") - 1
    sizes = np.diff(np.append(starts, len(arclet)))
    broken = np.flatnonzero(begin)
    shift = np.zeros(len(starts), dtype=np.int64)
    loops, first = np.unique(loop[broken], return_index=True)
    shift[loops] = broken[first] - starts[loops]
    closed_loop = np.ones(len(starts), dtype=bool)
    closed_loop[loops] = False
    place = (np.arange(len(arclet)) - starts[loop] - shift[loop]) % sizes[loop]
    order = np.lexsort((place, loop))
    loop, place = loop[order], place[order]
    opens = begin[order] | (place == 0)
    chain = np.cumsum(opens) - 1
    firsts = np.flatnonzero(opens)
    # Each loop's chains are numbered one after the other.
    first_chain = np.flatnonzero(np.diff(loop[firsts], prepend=-1))
    following = np.arange(1, len(firsts) + 1)
    following[np.append(first_chain[1:], len(firsts)) - 1] = first_chain
    return _Parts(
        arclet=arclet[order],
        interval=interval[order],
        chain=chain,
        place=np.arange(len(arclet)) - firsts[chain],
        closed=closed_loop[loop[firsts]],
        following=following,
    )


def _sides(
    outline: Arclets, parts: _Parts, evenodd: bool, touching: float
) -> tuple[Bools, Bools, Ints, Floats]:
    """Of each chain: whether its left and its right are filled, and another arclet on top of it."""
    from splinesdf.kernels.winding import fill_inside  # Numba loads only when it is used

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
    crowded = (partner >= 0) | (clear <= _MERGE * touching)
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
        fill_inside(outline, points, np.zeros(len(best)), evenodd, filled)
        sides.append(filled)
    return sides[0], sides[1], partner[best], at[best]


def _others(
    outline: Arclets, points: Floats, own: Ints, within: float
) -> tuple[Floats, Ints, Floats]:
    """Distance, arclet and parameter of what is nearest to points on arclets, but for their own.

    And but for what is not farther than ``within``.
    """
    from splinesdf.kernels.nearest import nearest  # Numba loads only when it is used

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
    nearest(outline, cells, candidates, done, PassedOver(own, within), feet)
    return feet.distance, feet.arclet, feet.at


def _repeated(
    outline: Arclets, parts: _Parts, keep: Bools, partner: Ints, at: Floats, touching: float
) -> Bools:
    """Chains that lie on top of an earlier one that is kept, from end to end."""
    first = np.flatnonzero(parts.place == 0)
    last = np.append(first[1:], len(parts.chain)) - 1
    ends = np.stack(
        [
            points_at(outline, parts.arclet[first], parts.interval[first, 0]),
            points_at(outline, parts.arclet[last], parts.interval[last, 1]),
        ]
    )
    chain = np.flatnonzero(partner >= 0)
    # The part in which the partner's parameter lies, and so the chain.
    order = np.lexsort((parts.interval[:, 0], parts.arclet))
    key = parts.arclet[order] + parts.interval[order, 0]
    where = np.searchsorted(key, partner[chain] + at[chain], side="right") - 1
    other = parts.chain[order[where]]
    near = 2.0 * _MERGE * touching

    def meet(a: Floats, b: Floats) -> Bools:
        return np.asarray(np.hypot(*(a - b).T) <= near)

    same = meet(ends[0, chain], ends[0, other]) & meet(ends[1, chain], ends[1, other])
    turned = meet(ends[0, chain], ends[1, other]) & meet(ends[1, chain], ends[0, other])
    # Whole loops need not begin at the same place.
    both_closed = parts.closed[chain] & parts.closed[other]
    result = np.zeros(len(keep), dtype=bool)
    result[chain] = (same | turned | both_closed) & keep[other] & (other < chain)
    return result


def _rebuild(outline: Arclets, parts: _Parts, keep: Bools, left: Bools, touching: float) -> Arclets:
    """The kept chains, each turned so that the inside is on its left."""
    label = np.cumsum(keep) - 1
    kept = keep[parts.chain]
    degree = degrees(outline)
    groups, labels, places = [], [], []
    for d in np.unique(degree[parts.arclet[kept]]):
        rows = np.flatnonzero(kept & (degree[parts.arclet] == d))
        arclet = parts.arclet[rows]
        control = control_points(outline.power[arclet, : d + 1]) + outline.start[arclet, None]
        control[:, -1] = outline.end[arclet]
        arcs = _restrict(
            Arcs(control, outline.piece[arclet], outline.interval[arclet]), parts.interval[rows]
        )
        turned = ~left[parts.chain[rows]]
        arcs.control[turned] = arcs.control[turned, ::-1]
        arcs.interval[turned] = arcs.interval[turned, ::-1]
        groups.append(arcs)
        labels.append(label[parts.chain[rows]])
        places.append(np.where(turned, -parts.place[rows], parts.place[rows]))
    runs = Runs(np.concatenate(labels), np.concatenate(places), parts.closed[keep])
    boundary = assemble(groups, runs, outline.origin)
    # Pairs of kept chains that were drawn one after the other with the inside on the same side.
    follows = parts.following
    drawn = np.flatnonzero(keep & keep[follows] & (left == left[follows]) & ~parts.closed)
    first = np.where(left[drawn], drawn, follows[drawn])
    second = np.where(left[drawn], follows[drawn], drawn)
    return _stitch(boundary, label[first], label[second], 2.0 * _MERGE * touching)


def _restrict(arcs: Arcs, interval: Floats) -> Arcs:
    """The parts of arcs between two parameters each."""
    low, high = interval.T
    count = len(low)
    result = Arcs(arcs.control.copy(), arcs.piece, arcs.interval.copy())
    for at, part, whole in (
        (high, slice(0, count), high == 1.0),
        (low / high, slice(count, None), low == 0.0),
    ):
        cut = split(result, at)
        result.control[~whole] = cut.control[part][~whole]
        result.interval[~whole] = cut.interval[part][~whole]
    return result


def _stitch(boundary: Arclets, first: Ints, second: Ints, near: float) -> Arclets:
    """Lead each chain's open end on to the start of a chain in the same place.

    Chains (by number) that were drawn ``second`` after ``first`` go together. Of the others that
    meet, the one that turns most to the left keeps closest to the inside.
    """
    following = boundary.following.copy()
    ends = np.flatnonzero(following < 0)
    led_to = np.zeros(len(following), dtype=bool)
    led_to[following[following >= 0]] = True
    starts = np.flatnonzero(~led_to)
    # Open chains have one end and one start each.
    start_of = np.full(int(boundary.run.max()) + 1, -1)
    end_of = start_of.copy()
    start_of[boundary.run[starts]], end_of[boundary.run[ends]] = starts, ends
    following[end_of[first]] = start_of[second]
    led_to[start_of[second]] = True
    ends = np.flatnonzero(following < 0)
    starts = np.flatnonzero(~led_to)
    starts = starts[np.argsort(boundary.start[starts, 0])]
    x = boundary.start[starts, 0]
    low = np.searchsorted(x, boundary.end[ends, 0] - near)
    high = np.searchsorted(x, boundary.end[ends, 0] + near, side="right")
    arriving = tangents_at(boundary, ends, np.ones(len(ends)))
    leaving = tangents_at(boundary, starts, np.zeros(len(starts)))
    free = np.ones(len(starts), dtype=bool)
    for i, end in enumerate(ends):
        candidates = np.arange(low[i], high[i])
        gap = np.hypot(*(boundary.start[starts[candidates]] - boundary.end[end]).T)
        candidates = candidates[(gap <= near) & free[candidates]]
        if len(candidates):
            a, b = arriving[i], leaving[candidates]
            turn = np.arctan2(a[0] * b[:, 1] - a[1] * b[:, 0], b @ a)
            best = candidates[np.argmax(turn)]
            free[best] = False
            following[end] = starts[best]
    return boundary._replace(following=following)
