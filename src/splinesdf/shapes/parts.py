"""A shape's arclets cut where they cross or touch, and joined to chains in between."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.arclets.crossings import find_crossings
from splinesdf.arclets.points import points_at
from splinesdf.arclets.tables import Arclets
from splinesdf.ground.arrays import Bools, Floats, Ints

# Crossings on one arc nearer than this many times what counts as touching are one.
MERGE = 8.0


class Parts(NamedTuple):
    """Arclets cut at crossings, in the order in which they were drawn."""

    arclet: Ints  # (n,)
    interval: Floats  # (n, 2) parameters of the arclet
    chain: Ints  # (n,) number of the chain, from 0
    place: Ints  # (n,) place in the chain
    closed: Bools  # (n_chains,) whether the chain is a whole loop
    following: Ints  # (n_chains,) the chain that was drawn next


def cut_at_crossings(outline: Arclets, touching: float) -> Parts:
    """The arclets of a shape, cut wherever another one is within ``touching``."""
    pair, at = find_crossings(outline, touching)
    arclet, t = pair.ravel(), at.ravel()
    order = np.lexsort((t, arclet))
    arclet, t = arclet[order], t[order]
    place = points_at(outline, arclet, t)
    count = len(outline.start)
    near = MERGE * touching
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


def _in_chains(outline: Arclets, arclet: Ints, interval: Floats, begin: Bools) -> Parts:
    """Number the runs between crossings; a loop's parts are turned to begin with a crossing."""
    first_of_loop = np.diff(outline.run, prepend=-1) != 0
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
    return Parts(
        arclet=arclet[order],
        interval=interval[order],
        chain=chain,
        place=np.arange(len(arclet)) - firsts[chain],
        closed=closed_loop[loop[firsts]],
        following=following,
    )


def without_cuts(parts: Parts, healed: Bools) -> tuple[Parts, Ints]:
    """The parts with some chains, by number, joined to the one before: it was cut in vain.

    Both are on one arclet, and the chain that goes on is no loop's first. The second result are the
    numbers of the chains that are left.
    """
    gone = healed[parts.chain] & (parts.place == 0)
    first = np.flatnonzero(~gone)
    last = np.append(first[1:], len(gone)) - 1
    left = np.flatnonzero(~healed)
    number = np.cumsum(~healed) - 1
    chain = number[parts.chain[first]]
    opens = np.flatnonzero(np.diff(chain, prepend=-1))
    # What came after the last of those that are one chain now.
    tail = np.append(left[1:], len(healed)) - 1
    return (
        Parts(
            arclet=parts.arclet[first],
            interval=np.column_stack([parts.interval[first, 0], parts.interval[last, 1]]),
            chain=chain,
            place=np.arange(len(first)) - opens[chain],
            closed=parts.closed[left],
            following=number[parts.following[tail]],
        ),
        left,
    )


def chain_ends(outline: Arclets, parts: Parts) -> Floats:
    """Where each chain starts and ends, as it was drawn: (2, n_chains, 2)."""
    first = np.flatnonzero(parts.place == 0)
    last = np.append(first[1:], len(parts.chain)) - 1
    return np.stack(
        [
            points_at(outline, parts.arclet[first], parts.interval[first, 0]),
            points_at(outline, parts.arclet[last], parts.interval[last, 1]),
        ]
    )


def groups(points: Floats, near: float) -> Ints:
    """Number points so that those nearer to one another than ``near`` have one number."""
    group = np.zeros(len(points), dtype=np.int64)
    for axis in (0, 1, 0, 1):
        order = np.lexsort((points[:, axis], group))
        apart = np.diff(points[order, axis], prepend=-np.inf) > near
        apart |= np.diff(group[order], prepend=-1) != 0
        group[order] = np.cumsum(apart) - 1
    return group
