"""The longest path between two ends of an axis."""

from __future__ import annotations

import heapq
from collections.abc import Sequence

from splinesdf.medial.edge import AxisEdge


def longest_path(edges: Sequence[AxisEdge], count: int) -> list[AxisEdge]:
    """Edges in order, turned so that each starts where the one before ends."""
    around: list[list[tuple[int, int, float]]] = [[] for _ in range(count)]
    lengths = [edge.length for edge in edges]
    for number, edge in enumerate(edges):
        if edge.start >= 0 and edge.end >= 0:
            around[edge.start].append((edge.end, number, lengths[number]))
            around[edge.end].append((edge.start, number, lengths[number]))
    best, path = 0.0, list[tuple[int, int]]()
    ends = [v for v in range(count) if len(around[v]) == 1]
    # In a tree two searches find it: the farthest end from any, and the farthest from that. In a
    # part with loops all ends are tried.
    seen: set[int] = set()
    for first in ends:
        if first in seen:
            continue
        far, reached, way = _farthest(around, first)
        if sum(len(around[v]) for v in reached) // 2 < len(reached):
            seen |= reached
            far, _, way = _farthest(around, _last(way, edges))
        if far > best:
            best, path = far, way
    result, at = [], -1
    for vertex, number in path:
        edge = edges[number]
        at = vertex
        result.append(edge if edge.start == at else edge.reversed())
    return result


def _last(way: list[tuple[int, int]], edges: Sequence[AxisEdge]) -> int:
    vertex, number = way[-1]
    edge = edges[number]
    return edge.end if edge.start == vertex else edge.start


def _farthest(
    around: list[list[tuple[int, int, float]]], start: int
) -> tuple[float, set[int], list[tuple[int, int]]]:
    """The farthest end by shortest ways; what was reached; vertices and edges of the way there."""
    distance, came = {start: 0.0}, dict[int, tuple[int, int]]()
    queue = [(0.0, start)]
    while queue:
        far, vertex = heapq.heappop(queue)
        for other, number, length in around[vertex]:
            if far + length < distance.get(other, float("inf")):
                distance[other] = far + length
                came[other] = (vertex, number)
                heapq.heappush(queue, (far + length, other))
    ends = [v for v in distance if len(around[v]) == 1 and v != start]
    last = max(ends, key=lambda v: distance[v], default=start)
    way: list[tuple[int, int]] = []
    at = last
    while at != start:
        way.append(came[at])
        at = came[at][0]
    return distance[last], set(distance), way[::-1]
