"""The boundary of what a shape fills: where contours cross, touch or repeat, only what separates.

arclets ──crossings──> parts ──joined between crossings──> chains ──a side of each is filled
and the other is not──> kept, turned so that the inside is on the left
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.arclets.crossings import control_points, degrees
from splinesdf.arclets.cutting import Arcs, Sequences, assemble, ends, split
from splinesdf.arclets.points import tangents_at
from splinesdf.arclets.tables import Arclets
from splinesdf.errors import InputError
from splinesdf.ground.arrays import NOTHING, Bools, Floats, Ints, as_points
from splinesdf.shapes.loops import closed_loops
from splinesdf.shapes.parts import MERGE, Parts, chain_ends, cut_at_crossings, groups, without_cuts
from splinesdf.shapes.sides import bounding, look_at_sides

# Nearer than this counts as touching, in units of the largest coordinate: a few times what
# rounding and compiled pieces (4 ulp) can put between curves that are meant to coincide. Larger:
# slits and gaps of that width are closed; smaller: contours drawn twice are not recognized, and
# what lies inside would attract the distance.
_TOUCHING = 64 * 2.220446049250313e-16
# Loops smaller than this many times what counts as touching are one point to the crossings, and
# would be dropped there without a word. Larger: specks that could be told apart are left out.
_NO_SPECK = 4.0
# Chains longer than this many times what counts as one point have their ends moved to where others
# end. Smaller: a chain might shrink to a point.
_LONG = 8.0
# Ends that nothing leads on from are led on to what begins this near, as a share of the size. It is
# the length below which a slit may be kept or dropped (see `splinesdf.shapes.sides`). Larger: a
# boundary that lacks a part is closed by a step; smaller: rounding where contours touch is refused.
_LOOSE = 1e-7


def touching_of(largest: float) -> float:
    """The distance within which curves count as touching, by the largest coordinate."""
    return _TOUCHING * largest


def kept_loops(
    loops: Iterable[Sequence[ArrayLike]], *, close: bool
) -> tuple[list[list[Floats]], tuple[str, ...]]:
    """Closed loops without those that are lost beside the coordinates of the others, and a note.

    Those would bound nothing, and still turn the sign of what is near.

    Parameters
    ----------
    loops, close
        As of `closed_loops`.
    """
    given = [[as_points(piece) for piece in loop] for loop in loops]
    closed = closed_loops(given, close=close)
    every = np.concatenate([piece for loop in closed for piece in loop])
    counts = np.array([sum(map(len, loop)) for loop in closed])
    starts = np.cumsum(counts) - counts
    largest, sides = float(np.abs(every).max()), np.maximum.reduceat(every, starts)
    size = (sides - np.minimum.reduceat(every, starts)).max(axis=1)
    lost = size < _NO_SPECK * touching_of(largest)
    sizes = size[lost].tolist()
    if len(closed) < len(given):  # even smaller ones are gone, of which some are points
        every_side = [max(float(np.ptp(p, axis=0).max()) for p in loop) for loop in given if loop]
        sizes += [side for side in every_side if 0.0 < side <= NOTHING * largest]
    if not sizes:
        return closed, ()
    words = (
        f"{len(sizes)} contour{'s' if len(sizes) > 1 else ''} of size {max(sizes):.3g} or less, "
        f"lost beside coordinates of {largest:.3g}"
    )
    if lost.all():
        raise InputError(f"expected contours that enclose something, got {words}")
    kept = [loop for loop, gone in zip(closed, lost.tolist(), strict=True) if not gone]
    return kept, (f"left out: {words}",)


def filled_boundary(outline: Arclets, least: int, largest: float) -> Arclets | None:
    """The arclets that have the filled region on exactly one side, which is their left.

    Parameters
    ----------
    outline : Arclets
        All that was drawn.
    least : int
        The fill rule: winding numbers of at least so much, with either sign; odd ones for 0.
    largest : float
        The largest absolute coordinate of the shape, in its own system.

    Returns
    -------
    Arclets or None
        None if nothing is filled: all is traced to and fro, or nowhere wider than `touching_of`.
    """
    touching = touching_of(largest)
    parts = cut_at_crossings(outline, touching)
    sides = look_at_sides(outline, parts, least, touching)
    keep, left = bounding(outline, parts, sides, touching)
    keep &= ~_in_vain(outline, parts, keep, left, sides.partner >= 0, 2.0 * MERGE * touching)
    if not keep.any():
        return None
    if keep.all() and left.all() and parts.closed.all():
        return outline
    healed = _cut_in_vain(outline, parts, keep, left, 2.0 * MERGE * touching)
    parts, chains = without_cuts(parts, healed)
    return _closed(_rebuild(outline, parts, keep[chains], left[chains], touching))


def some_boundary(outline: Arclets, fill: str, largest: float) -> Arclets:
    """The same by the name of the fill rule, or an `InputError` if nothing is filled."""
    found = filled_boundary(outline, 0 if fill == "evenodd" else 1, largest)
    if found is None:
        other = "nonzero" if fill == "evenodd" else "evenodd"
        raise InputError(
            f"the contours fill nothing under the rule {fill!r}: they are traced to and fro, or "
            "twice, or nowhere wider than the rounding of their coordinates, "
            f"{touching_of(largest):.2g}; draw each once, or try fill={other!r}"
        )
    return found


def _in_vain(
    outline: Arclets, parts: Parts, keep: Bools, left: Bools, doubled: Bools, near: float
) -> Bools:
    """Which chains on top of others are kept in vain: more begin than end where they begin.

    And more end than begin where they end, or the last of several does of which each leads on to
    the next. So it is where three lie on each other that are not cut in the same places: of a
    boundary as many chains end as begin in each point.
    """
    some = np.flatnonzero(keep & ~parts.closed)
    group = groups(chain_ends(outline, parts)[:, some].reshape(-1, 2), near).reshape(2, -1)
    begin, end = np.where(left[some], group, group[::-1])
    count = int(group.max(initial=-1)) + 1
    more = np.bincount(begin, minlength=count) - np.bincount(end, minlength=count)
    result = np.zeros(len(keep), dtype=np.bool_)
    for k in np.flatnonzero(doubled[some])[::-1].tolist():
        if more[begin[k]] > 0 > more[end[k]]:
            result[some[k]] = True
            more[begin[k]] -= 1
            more[end[k]] += 1
    for first in np.flatnonzero(more > 0).tolist():
        free = np.flatnonzero(doubled[some] & ~result[some])
        for _ in range(int(more[first])):
            way = _way(first, more < 0, begin[free], end[free])
            if not way:
                break
            rows = free[way]
            result[some[rows]] = True
            more[first] -= 1
            more[end[rows[-1]]] += 1
            free = free[~result[some[free]]]
    return result


def _way(first: int, goal: Bools, begin: Ints, end: Ints) -> list[int]:
    """The fewest edges from a point to one of some others, in order; none if there is no way."""
    order = np.argsort(begin, kind="stable")
    starts = np.searchsorted(begin[order], np.arange(len(goal) + 1))
    by: dict[int, int] = {first: -1}  # the edge that led to each point
    points = [first]
    for point in points:  # it grows
        if goal[point]:
            way = []
            while by[point] >= 0:
                way.append(by[point])
                point = int(begin[by[point]])
            return way[::-1]
        for edge in order[starts[point] : starts[point + 1]].tolist():
            if (to := int(end[edge])) not in by:
                by[to] = edge
                points.append(to)
    return []


def _cut_in_vain(outline: Arclets, parts: Parts, keep: Bools, left: Bools, near: float) -> Bools:
    """Which chains go on, on the same arclet, from where only the one before it is kept as well.

    What crosses there bounds nothing. At a small angle it may have cut off a part so short that its
    curvature is all rounding.
    """
    first = np.flatnonzero(parts.place == 0)
    before = np.maximum(first - 1, 0)
    chain = parts.chain[before]
    inner = (parts.arclet[before] == parts.arclet[first]) & (parts.interval[first, 0] > 0.0)
    inner &= (parts.following[chain] == parts.chain[first]) & (first > 0) & ~parts.closed
    inner &= keep & keep[chain] & (left == left[chain])
    some = keep & ~parts.closed
    group = groups(chain_ends(outline, parts)[:, some].reshape(-1, 2), near).reshape(2, -1)
    alone = np.zeros(len(keep), dtype=np.bool_)
    alone[some] = np.bincount(group.ravel())[group[0]] == 2
    return np.asarray(inner & alone)


def _rebuild(outline: Arclets, parts: Parts, keep: Bools, left: Bools, touching: float) -> Arclets:
    """The kept chains, each turned so that the inside is on its left."""
    label = np.cumsum(keep) - 1
    kept = keep[parts.chain]
    degree = degrees(outline)
    meeting = _meeting_points(outline, parts, keep, 2.0 * MERGE * touching)
    last = np.diff(parts.chain, append=-1) != 0
    arcs_of, labels, places = [], [], []
    for d in np.unique(degree[parts.arclet[kept]]):
        rows = np.flatnonzero(kept & (degree[parts.arclet] == d))
        arclet = parts.arclet[rows]
        control, start = control_points(outline.power[arclet, : d + 1]), outline.start[arclet]
        arcs = _restrict(
            Arcs(control, start, outline.piece[arclet], outline.interval[arclet]),
            parts.interval[rows],
        )
        turned = ~left[parts.chain[rows]]
        whole = parts.interval[rows, 1] == 1.0
        arcs.start[turned] = np.where(whole[:, None], outline.end[arclet], ends(arcs))[turned]
        arcs.control[turned] = arcs.control[turned, ::-1]
        arcs.interval[turned] = arcs.interval[turned, ::-1]
        # What meets in one point does so to the bit.
        chain, side = parts.chain[rows], turned.astype(np.int64)
        begins = np.flatnonzero(np.where(turned, last[rows], parts.place[rows] == 0))
        arcs.start[begins] = meeting[side[begins], chain[begins]]
        stops = np.flatnonzero(np.where(turned, parts.place[rows] == 0, last[rows]))
        arcs.control[stops, -1] += meeting[1 - side[stops], chain[stops]] - ends(arcs)[stops]
        arcs_of.append(arcs)
        labels.append(label[parts.chain[rows]])
        places.append(np.where(turned, -parts.place[rows], parts.place[rows]))
    runs = Sequences(np.concatenate(labels), np.concatenate(places), parts.closed[keep])
    boundary = assemble(arcs_of, runs, outline.origin)
    open_end = np.flatnonzero(boundary.following < 0)
    chain = np.flatnonzero(keep)[boundary.run[open_end]]
    boundary.end[open_end] = meeting[left[chain].astype(np.int64), chain]
    boundary.arcs[open_end, 1:3] = boundary.end[open_end]
    # Pairs of kept chains that were drawn one after the other with the inside on the same side.
    follows = parts.following
    drawn = np.flatnonzero(keep & keep[follows] & (left == left[follows]) & ~parts.closed)
    first = np.where(left[drawn], drawn, follows[drawn])
    second = np.where(left[drawn], follows[drawn], drawn)
    return _stitch(boundary, label[first], label[second], 2.0 * MERGE * touching)


def _meeting_points(outline: Arclets, parts: Parts, keep: Bools, near: float) -> Floats:
    """Where chains start and end as they were drawn, one point for all that meet: (2, n, 2).

    Those of chains that are dropped or no longer than a few times ``near`` stay where they are.
    """
    points = chain_ends(outline, parts)
    first = np.flatnonzero(parts.place == 0)
    last = np.append(first[1:], len(parts.chain)) - 1
    middle = parts.arclet[(first + last) // 2]
    reach = np.maximum(
        np.hypot(*(outline.start[middle] - points[0]).T),
        np.hypot(*(points[1] - points[0]).T),
    )
    joined = keep & ~parts.closed & (reach > _LONG * near)
    if not joined.any():
        return points
    some = points[:, joined].reshape(-1, 2)
    group = groups(some, near)
    _, representative = np.unique(group, return_index=True)
    points[:, joined] = some[representative][group].reshape(2, -1, 2)
    return points


def _restrict(arcs: Arcs, interval: Floats) -> Arcs:
    """The parts of arcs between two parameters each."""
    low, high = interval.T
    count = len(low)
    result = Arcs(arcs.control.copy(), arcs.start.copy(), arcs.piece, arcs.interval.copy())
    for at, part, whole in (
        (high, slice(0, count), high == 1.0),
        (low / high, slice(count, None), low == 0.0),
    ):
        cut = split(result, at)
        result.control[~whole] = cut.control[part][~whole]
        result.start[~whole] = cut.start[part][~whole]
        result.interval[~whole] = cut.interval[part][~whole]
    return result


def _closed(boundary: Arclets) -> Arclets:
    """The boundary with ends that are still open led on to what begins next to them.

    Where many contours touch within rounding, chains as short as that may be kept in vain. No
    boundary is better than one that is open farther than that: what is inside would be anyone's
    guess.
    """
    ends = np.flatnonzero(boundary.following < 0)
    if not len(ends):
        return boundary
    following = boundary.following.copy()
    begins = np.ones(len(following), dtype=bool)
    begins[following[following >= 0]] = False
    allowed = _LOOSE * float(np.ptp(boundary.boxes[0].reshape(2, 2), axis=0).max())
    for end in ends.tolist():
        starts = np.flatnonzero(begins)
        gap = np.hypot(*(boundary.start[starts] - boundary.end[end]).T)
        nearest = int(np.argmin(gap))
        if gap[nearest] > allowed:
            x, y = boundary.end[end] + boundary.origin
            raise InputError(
                f"expected contours that touch or cross clearly, got some that rounding leaves "
                f"open near ({x:.9g}, {y:.9g}): move them apart, or onto each other"
            )
        following[end], begins[starts[nearest]] = starts[nearest], False
        boundary.end[end] = boundary.start[starts[nearest]]
        boundary.arcs[end, 1:3] = boundary.end[end]
    return boundary._replace(following=following)


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
