"""Regions as loops with the inside on their left, and what several of them have in common.

loops, fill rule ──boundary──> arclets, inside on the left ──joined where one piece was cut──> loops

Loops of several regions together, under the rule nonzero, are their union. Where two regions
overlap their windings add up to two, so that this bounds the intersection.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from splinesdf.arclets.cutting import build_arclets
from splinesdf.arclets.tables import Arclets
from splinesdf.ground.arrays import Floats
from splinesdf.shapes.boundary import filled_boundary
from splinesdf.shapes.loops import closed_loops

Loops = list[list[Floats]]
# Loops of no more than this share of the largest coordinate enclose nothing. It is the limit for
# shapes as a whole: smaller, they would be refused.
_POINT = 1e-9


def region(loops: Sequence[Sequence[Floats]], fill: str) -> Loops:
    """Loops around what closed loops fill under a rule, inside on the left; none if nothing is.

    Parameters
    ----------
    loops : sequence of sequences of ndarray, shape (degree + 1, 2)
        The control points of each piece of each loop; open ones are closed by a straight piece.
    fill : {"nonzero", "evenodd"}
    """
    return _filled(loops, 0 if fill == "evenodd" else 1)


def intersection(one: Loops, other: Loops) -> Loops:
    """Loops around what two regions have in common, inside on the left; none if nothing is.

    Parameters
    ----------
    one, other : lists of lists of ndarray
        As `region` answers them.
    """
    return _filled([*one, *other], 2) if one and other else []


def difference(one: Loops, other: Loops) -> Loops:
    """Loops around what is in one region and not in another; none if nothing is."""
    common = intersection(one, other)
    # What is common is once inside and once turned round: nothing of it is left.
    return _filled([*one, *([p[::-1] for p in reversed(loop)] for loop in common)], 1)


def union(regions: Sequence[Loops]) -> Loops:
    """Loops around what is in some region, inside on the left; none if nothing is."""
    return _filled([loop for loops in regions for loop in loops], 1)


def united_regions(parts: Sequence[tuple[Loops, str | None]]) -> tuple[Loops, str]:
    """Loops around the union of regions, and the rule under which they are.

    Parameters
    ----------
    parts : sequence of (loops, rule)
        The loops of each region, and the rule by which they fill it: None if they have the inside
        on their left already. Those of a single one are left as they are.
    """
    if len(parts) == 1:
        loops, rule = parts[0]
        return loops, rule or "nonzero"
    regions = [loops if rule is None else region(loops, rule) for loops, rule in parts]
    return [loop for loops in regions for loop in loops], "nonzero"


def _filled(loops: Sequence[Sequence[Floats]], least: int) -> Loops:
    """Loops around where the winding number is at least so much, or odd for 0."""
    if not any(len(loop) for loop in loops):
        return []
    every = np.concatenate([piece for loop in loops for piece in loop])
    # What is that small beside its coordinates is a point, or a line, but for their rounding.
    if np.ptp(every, axis=0).max() <= _POINT * np.abs(every).max():
        return []
    closed = closed_loops(loops, close=True)
    pieces = [piece for loop in closed for piece in loop]
    control = np.concatenate(pieces)
    starts = np.cumsum([0] + [len(piece) for piece in pieces], dtype=np.int64)
    ends = np.cumsum([0] + [len(loop) for loop in closed], dtype=np.int64)
    outline = build_arclets(control, starts, ends)
    boundary = filled_boundary(outline, least, float(np.abs(control).max()))
    if boundary is None:
        return []
    return closed if boundary is outline else _loops_of(boundary, pieces)


def _loops_of(boundary: Arclets, pieces: list[Floats]) -> Loops:
    """A boundary's arclets as loops of pieces, those that were cut from one piece in one again."""
    following = boundary.following.tolist()
    loops, seen = [], np.zeros(len(following), dtype=bool)
    for first in range(len(following)):
        if seen[first]:
            continue
        chain, k = [], first
        while k >= 0 and not seen[k]:
            seen[k] = True
            chain.append(k)
            k = following[k]
        runs = _runs(boundary, chain)
        loops.append(_joined(boundary, pieces, runs))
    return loops


def _runs(boundary: Arclets, chain: list[int]) -> list[tuple[int, int]]:
    """First and last arclet of what is one stretch of one piece, in order around a loop."""
    piece, interval = boundary.piece, boundary.interval

    def goes_on(a: int, b: int) -> bool:
        same = piece[a] == piece[b] and interval[a, 1] == interval[b, 0]
        rising = interval[a, 1] > interval[a, 0], interval[b, 1] > interval[b, 0]
        return bool(same and rising[0] == rising[1])

    # There is one at least: where a piece closes in itself, it ends and begins.
    breaks = [k for k in range(len(chain)) if not goes_on(chain[k - 1], chain[k])]
    turned = chain[breaks[0] :] + chain[: breaks[0]]
    marks = [k - breaks[0] for k in breaks] + [len(chain)]
    return [(turned[begin], turned[end - 1]) for begin, end in pairwise(marks)]


def _joined(boundary: Arclets, pieces: list[Floats], runs: list[tuple[int, int]]) -> list[Floats]:
    """The stretches as pieces, each starting exactly where the last one ended."""
    result, own_start, own_end = [], [], []
    for first, last in runs:
        low, high = float(boundary.interval[first, 0]), float(boundary.interval[last, 1])
        control = pieces[boundary.piece[first]]
        result.append(stretch(control, low, high))
        own_start.append(low in (0.0, 1.0))
        own_end.append(high in (0.0, 1.0))
    for k, (first, _) in enumerate(runs):
        # Ends of pieces stay what they were; where both were cut, it is the crossing.
        if own_start[k]:
            at = result[k][0].copy()
        elif own_end[k - 1]:
            at = result[k - 1][-1].copy()
        else:
            at = boundary.start[first] + boundary.origin
        result[k][0] = result[k - 1][-1] = at
    return result


def stretch(control: Floats, low: float, high: float) -> Floats:
    """A piece between two parameters, turned round if the first is the larger one."""
    if low > high:
        return np.ascontiguousarray(stretch(control, high, low)[::-1])
    if (low, high) == (0.0, 1.0):
        return control.copy()
    points = control
    upper = np.empty_like(control)
    for k in range(len(control)):  # de Casteljau: the part from low on
        upper[len(control) - 1 - k] = points[-1]
        points = (1.0 - low) * points[:-1] + low * points[1:]
    share = (high - low) / (1.0 - low)
    lower, points = np.empty_like(control), upper
    for k in range(len(control)):
        lower[k] = points[0]
        points = (1.0 - share) * points[:-1] + share * points[1:]
    return lower
