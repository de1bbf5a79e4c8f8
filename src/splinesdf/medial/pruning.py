"""Branches of an axis cut by height: how far the reconstructed shape shrinks without them.

Without a branch that ends in the junction J, what its disks no longer cover is within
max(|c - J| + r) - r_J of the disk of J, over its disks (c, r): its height.
"""

from __future__ import annotations

import heapq
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.medial.conics import conic_points
from splinesdf.medial.edge import AxisEdge, joined

# Disks of one arc by which its height is measured.
_LOOKED = np.linspace(0.0, 1.0, 5)


class Graph(NamedTuple):
    """Vertices and edges of an axis."""

    points: Floats  # (n, 2)
    radius: Floats  # (n,)
    kind: tuple[str, ...]
    edges: tuple[AxisEdge, ...]


def _samples(edges: tuple[AxisEdge, ...]) -> dict[int, list[Floats]]:
    """Disks of each edge."""
    if not edges:
        return {}
    arcs = np.concatenate([edge.arcs for edge in edges])
    weights = np.concatenate([edge.weights for edge in edges])
    count = len(_LOOKED)
    places = np.tile(_LOOKED, len(arcs))
    disks = conic_points(np.repeat(arcs, count, axis=0), np.repeat(weights, count), places)
    bounds = count * np.cumsum([0] + [len(edge.arcs) for edge in edges])
    return {k: [disks[a:b]] for k, (a, b) in enumerate(pairwise(bounds.tolist()))}


def pruned(graph: Graph, height: float, corners: bool) -> Graph:
    """The graph without branches lower than a height, and without those to corners if asked."""
    cut = _Cut(graph)
    if not corners:
        cut.corners()
    if height > 0.0:
        cut.lower_than(height)
    return cut.rest()


class _Cut:
    """A graph of which branches are being cut."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.edges: dict[int, AxisEdge] = dict(enumerate(graph.edges))
        self.at: list[list[int]] = [[] for _ in graph.radius]
        for number, edge in self.edges.items():
            for vertex in (edge.start, edge.end):
                if vertex >= 0:
                    self.at[vertex].append(number)
        self.gone: set[int] = set()
        self.kind = list(graph.kind)
        # Disks that were cut, by the vertex or the edge that stands for them.
        self.lost: dict[int, list[Floats]] = {}
        self.lost_on: dict[int, list[Floats]] = {}
        self.queue: list[tuple[float, int, int]] = []
        self.looks = [0] * len(graph.radius)  # how often a vertex was looked at: the last counts
        self.samples = _samples(graph.edges)
        self.vertices = np.column_stack([graph.points, graph.radius])

    def corners(self) -> None:
        """Cut the branches that end in corners, up to the first junction.

        All at once: one after the other, what is left of a junction's branches would be one with
        the edge behind it, and go with that or stay for it.
        """
        chosen = []
        for vertex in [v for v, kind in enumerate(self.kind) if kind == "corner"]:
            if len(self.at[vertex]) == 1:
                far = self._other(self.at[vertex][0], vertex)
                if len(self.at[far]) > 1:
                    chosen.append(vertex)
        for far in dict.fromkeys([self._cut(vertex) for vertex in chosen]):
            self._settle(far)

    def lower_than(self, height: float) -> None:
        """Cut the lowest branch again and again."""
        for vertex in range(len(self.at)):
            self._look(vertex)
        while self.queue:
            low, vertex, look = heapq.heappop(self.queue)
            if low >= height:
                break
            if vertex not in self.gone and len(self.at[vertex]) == 1 and look == self.looks[vertex]:
                self._settle(self._cut(vertex))

    def _other(self, edge: int, vertex: int) -> int:
        one = self.edges[edge]
        return one.end if one.start == vertex else one.start

    def _look(self, vertex: int) -> None:
        """Put a branch that ends in a vertex on the list."""
        self.looks[vertex] += 1
        if vertex not in self.gone and len(self.at[vertex]) == 1:
            height = self._height(vertex)
            far = self._other(self.at[vertex][0], vertex)
            # Of an axis that is one edge the larger disk is left.
            alone = len(self.at[far]) == 1
            radius = self.graph.radius
            if not (alone and (radius[vertex], vertex) > (radius[far], far)):
                heapq.heappush(self.queue, (height, vertex, self.looks[vertex]))

    def _disks(self, vertex: int) -> list[Floats]:
        """All disks that go with a branch."""
        number = self.at[vertex][0]
        lost = self.lost.get(vertex, []) + self.lost_on.get(number, [])
        return [self.vertices[vertex : vertex + 1], *self.samples[number], *lost]

    def _height(self, vertex: int) -> float:
        far = self._other(self.at[vertex][0], vertex)
        center, radius = self.graph.points[far], float(self.graph.radius[far])
        disks = np.concatenate(self._disks(vertex))
        reach = np.hypot(*(disks[:, :2] - center).T) + disks[:, 2]
        return max(0.0, float(reach.max()) - radius)

    def _cut(self, vertex: int) -> int:
        """Cut the branch that ends in a vertex; where it began."""
        number = self.at[vertex][0]
        far = self._other(number, vertex)
        self.lost.setdefault(far, []).extend(self._disks(vertex))
        del self.edges[number]
        self.gone.add(vertex)
        self.at[vertex] = []
        self.at[far].remove(number)
        return far

    def _settle(self, far: int) -> None:
        """Make a vertex what it is without the branches that were cut."""
        if len(self.at[far]) == 2:
            self._join(far)
        elif len(self.at[far]) == 1:
            self.kind[far] = "end"
            self._look(far)
        elif not self.at[far]:
            self.kind[far] = "isolated"

    def _join(self, vertex: int) -> None:
        """Make two edges one where a branch was."""
        one, other = self.at[vertex]
        if self.kind[vertex] == "cut":
            return
        if one == other:  # a loop that is left alone
            edge = self.edges[one]
            self.edges[one] = replace(edge, start=-1, end=-1)
            self.at[vertex] = []
            self.gone.add(vertex)
            return
        first, second = self.edges[one], self.edges[other]
        first = first if first.end == vertex else first.reversed()
        second = second if second.start == vertex else second.reversed()
        self.edges[one] = joined(first, second)
        self.samples[one] = self.samples[one] + self.samples.pop(other)
        lost = self.lost.pop(vertex, []) + self.lost_on.pop(other, [])
        self.lost_on.setdefault(one, []).extend(lost)
        del self.edges[other]
        end = self.edges[one].end
        self.at[end] = [one if number == other else number for number in self.at[end]]
        self.at[vertex] = []
        self.gone.add(vertex)
        for far in {self.edges[one].start, end}:
            self._look(far)

    def rest(self) -> Graph:
        """What is left, with new numbers."""
        kept = [v for v in range(len(self.at)) if v not in self.gone]
        number = {v: i for i, v in enumerate(kept)} | {-1: -1}
        edges = tuple(
            replace(edge, start=number[edge.start], end=number[edge.end])
            for _, edge in sorted(self.edges.items())
        )
        return Graph(
            self.graph.points[kept],
            self.graph.radius[kept],
            tuple(self.kind[v] for v in kept),
            edges,
        )
