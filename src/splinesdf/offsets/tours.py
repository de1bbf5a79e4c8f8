"""Ways along all edges of a graph without a lift: back along an edge rather than through the air.

A tour begins at the end of the longest way, goes into short branches first and comes back from
each, and ends where the last edge is done: a tree takes twice its length less that longest way.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats


class Way(NamedTuple):
    """An edge of the graph."""

    start: int
    end: int
    points: Floats  # (n, 3)

    @property
    def length(self) -> float:
        """In the plane."""
        return float(np.hypot(*np.diff(self.points[:, :2], axis=0).T).sum())


def tours(ways: Sequence[Way]) -> list[Floats]:
    """Polylines along all edges, one for each connected part."""
    at: dict[int, list[int]] = {}
    for k, way in enumerate(ways):
        for node in {way.start, way.end}:
            at.setdefault(node, []).append(k)
    lengths = [way.length for way in ways]
    result, seen = [], set[int]()
    for node in at:
        if node in seen:
            continue
        there = _lengths_from(node, ways, lengths, at)
        seen |= set(there)
        # Twice the farthest one: the end of a longest way, in a tree.
        first = max(there, key=lambda k: (there[k], -k))
        result.append(_tour(first, ways, lengths, at))
    return result


def _lengths_from(
    node: int, ways: Sequence[Way], lengths: Sequence[float], at: dict[int, list[int]]
) -> dict[int, float]:
    """How far all that is connected is, along edges."""
    found: dict[int, float] = {}
    queue = [(0.0, node)]
    while queue:
        far, here = heapq.heappop(queue)
        if here in found:
            continue
        found[here] = far
        for k in at[here]:
            there = ways[k].end if ways[k].start == here else ways[k].start
            if there not in found:
                heapq.heappush(queue, (far + lengths[k], there))
    return found


def _tour(
    first: int, ways: Sequence[Way], lengths: Sequence[float], at: dict[int, list[int]]
) -> Floats:
    """Along all edges of one part, from a node on."""
    parent, order = _tree(first, ways, lengths, at)
    # How far it goes from each node into what is behind it.
    deep = dict.fromkeys(order, 0.0)
    for node in reversed(order):
        if (k := parent[node]) >= 0:
            above = ways[k].start if ways[k].end == node else ways[k].end
            deep[above] = max(deep[above], deep[node] + lengths[k])
    tree = {k for k in parent.values() if k >= 0}
    done = set[int]()
    pieces: list[tuple[int, bool]] = []  # an edge, and whether it runs from end to start
    last = 0
    stack: list[tuple[int, list[int], tuple[int, bool] | None]] = [
        (first, _sorted(first, ways, lengths, at, deep, tree), None)
    ]
    while stack:
        node, left, back = stack[-1]
        if not left:
            stack.pop()
            if back is not None:
                pieces.append(back)
            continue
        k = left.pop(0)
        if k in done:
            continue
        done.add(k)
        turned = ways[k].start != node
        pieces.append((k, turned))
        last = len(pieces)
        there = ways[k].start if turned else ways[k].end
        if k in tree:
            stack.append((there, _sorted(there, ways, lengths, at, deep, tree), (k, not turned)))
        elif there != node:
            pieces.append((k, not turned))
    rows = [ways[k].points[::-1] if turned else ways[k].points for k, turned in pieces[:last]]
    points = np.concatenate(rows)
    return without_repeats(points)


def without_repeats(points: Floats) -> Floats:
    """A polyline without points that are their neighbors."""
    return np.asarray(points[np.append(True, np.any(points[1:] != points[:-1], axis=1))])


def _tree(
    first: int, ways: Sequence[Way], lengths: Sequence[float], at: dict[int, list[int]]
) -> tuple[dict[int, int], list[int]]:
    """The edge by which each node is reached first, by short ways, and the nodes in that order."""
    parent, order = dict[int, int](), list[int]()
    queue = [(0.0, first, -1)]
    while queue:
        far, here, by = heapq.heappop(queue)
        if here in parent:
            continue
        parent[here] = by
        order.append(here)
        for k in at[here]:
            there = ways[k].end if ways[k].start == here else ways[k].start
            if there not in parent:
                heapq.heappush(queue, (far + lengths[k], there, k))
    return parent, order


def _sorted(
    node: int,
    ways: Sequence[Way],
    lengths: Sequence[float],
    at: dict[int, list[int]],
    deep: dict[int, float],
    tree: set[int],
) -> list[int]:
    """The edges at a node: those that close loops first, then by how far they lead."""

    def reach(k: int) -> float:
        if k not in tree:
            return -1.0
        there = ways[k].end if ways[k].start == node else ways[k].start
        return lengths[k] + deep[there]

    return sorted(at[node], key=reach)
