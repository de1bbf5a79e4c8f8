"""Faces between chords: pieces of edges, ends, and vertices; more chords where it is not clear.

A face with two sides (its chords, and the leaves in its arcs) is crossed by one smooth path of the
axis. One with more holds a vertex, if a disk touches all of its arcs; else chords of the disks that
touch three divide it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Bools, Floats
from splinesdf.medial.chords import (
    SNAP,
    Map,
    Region,
    canonical,
    chords_at,
    mapped,
    position,
    together,
    without_doubles,
)
from splinesdf.medial.dividing import Face, Part, divided
from splinesdf.medial.feet import points_and_normals
from splinesdf.medial.tables import WHOLE, Disks, Leaves

# Distances from a center that differ by less than this share of the size are equal.
NEAR = 1e-12
# Rounds of more chords. Few are needed; at the ceiling the axis is incomplete.
_ROUNDS = 40
# Chords for each element of the walk, and beside, after which an axis is given up as incomplete.
_MOST, _BESIDE = 40, 4000
# Points of an arc at which is measured how far it is from a disk.
_LOOKED = 9
# Rounds without a new chord after which an axis is given up.
_STUCK = 2
# Faces are given up for one vertex, where their disks are nearly one, from this round on.
_PATIENT = 1


class Vertex(NamedTuple):
    """A vertex of the axis in a face."""

    center: Floats  # (2,)
    radius: float
    leaf: int  # which leaf it is, -1 for none
    spread: float  # how far disks that it stands for may be off it; 0 where it is exact


def traced(region: Region, leaves: Leaves, first: Disks, spread: float) -> Look:
    """Divide faces until each is clear.

    Parameters
    ----------
    region, leaves : Region, Leaves
    first : Disks
        Chords to start from.
    spread : float
        Faces whose disks differ by less are one vertex where all else fails.
    """
    chords = without_doubles(region, first, leaves)
    most = _MOST * len(region.walk.element) + _BESIDE
    look, stuck = Look(region, leaves, chords, spread), 0
    for round_ in range(_ROUNDS):
        more = look.resolve(round_, stuck > 0)
        if more is None or len(chords.radius) > most or stuck > _STUCK:
            return look
        count = len(chords.radius)
        chords = without_doubles(region, together(chords, more), leaves)
        look = Look(region, leaves, chords, spread)
        stuck = stuck + 1 if len(chords.radius) == count else 0
    look.resolve(_ROUNDS, True)
    return look


class Look:
    """One look at all faces.

    Attributes
    ----------
    vertices : dict
        By face.
    unclear : list of int
        Faces of which is not known how the axis crosses them.
    alone : list of int
        Leaves of loops without chords: disks.
    bare : list of int
        Loops without chords that are no disks.
    """

    def __init__(self, region: Region, leaves: Leaves, chords: Disks, spread: float) -> None:
        self.region, self.leaves, self.chords, self.spread = region, leaves, chords, spread
        self.map: Map = mapped(region, chords)
        self.near = NEAR * region.size
        self.vertices: dict[int, Vertex] = {}
        self.unclear: list[int] = []
        self.alone: list[int] = []
        self.bare: list[int] = []
        places = chords.element.reshape(-1).tolist(), chords.at.reshape(-1).tolist()
        self.ends: list[tuple[int, float]] = list(zip(*places, strict=True))
        self.next: list[int] = self.map.next.tolist()
        self.inside: dict[int, list[int]] = {}  # leaves in the arc of an end
        self._place_leaves()

    @property
    def euler(self) -> int:
        """Faces less chords: components less holes, if nothing is missing."""
        return len(self.map.first) - 1 + len(self.alone) - len(self.chords.radius)

    def members(self, face: int) -> list[int]:
        """The ends of chords around a face."""
        ends: list[int] = self.map.member[self.map.first[face] : self.map.first[face + 1]].tolist()
        return ends

    def _place_leaves(self) -> None:
        """Find in which arc each leaf is."""
        leaves, region, order = self.leaves, self.region, self.map.order
        low_at, low = canonical(region, leaves.low[:, 1], leaves.low[:, 0].astype(np.int64))
        high_at, high = canonical(region, leaves.high[:, 1], leaves.high[:, 0].astype(np.int64))
        self.low: list[tuple[int, float]] = list(zip(low.tolist(), low_at.tolist(), strict=True))
        self.high: list[tuple[int, float]] = list(zip(high.tolist(), high_at.tolist(), strict=True))
        loop = region.loops.loop[low]
        ends = np.bincount(
            region.loops.loop[self.chords.element.reshape(-1)],
            minlength=len(region.loops.first) - 1,
        )
        offset = np.concatenate([[0], np.cumsum(ends)])
        where = position(region, low, low_at) + SNAP * region.size
        row = np.searchsorted(self.map.position[order], where, side="right") - 1
        row = np.where(row < offset[loop], offset[loop + 1] - 1, row)
        bare = ends[loop] == 0
        for k in np.flatnonzero(~bare).tolist():
            self.inside.setdefault(int(order[row[k]]), []).append(k)
        for j in np.flatnonzero(ends == 0).tolist():
            own = np.flatnonzero(loop == j).tolist()
            if len(own) == 1 and leaves.kind[own[0]] == WHOLE:
                self.alone += own
            else:
                self.bare.append(j)

    def resolve(self, round_: int, stuck: bool) -> Disks | None:
        """Find vertices; chords that divide the faces that are not clear, None if all are."""
        sizes = np.diff(self.map.first)
        count = np.zeros(len(sizes), dtype=np.int64)
        for k, own in self.inside.items():
            count[self.map.face[k]] += len(own)
        for f in np.flatnonzero((sizes == 1) & (count == 1)).tolist():
            leaf = self.inside[int(self.map.member[self.map.first[f]])][0]
            radius = float(self.leaves.radius[leaf])
            self.vertices[f] = Vertex(self.leaves.center[leaf], radius, leaf, 0.0)
        self._one_disks((sizes > 2) & (count == 0))
        known = np.zeros(len(sizes), dtype=np.bool_)
        known[list(self.vertices)] = True
        todo = np.flatnonzero(~known & ~((sizes == 2) & (count == 0))).tolist()
        sides = {f: self._parts_of(f) for f in todo}
        met = divided(self.region, self.near, self._guesses(sides))
        for f, vertex in met.vertices.items():
            self.vertices[f] = Vertex(*vertex, -1, 0.0)
        more = [met.chords] if len(met.chords.radius) else []
        divided_ = set[int]() if stuck else met.divided
        open_ = [f for f in todo if f not in self.vertices and f not in divided_]
        patient = round_ < _PATIENT and not stuck
        self.unclear = [f for f in open_ if patient or not self._collapsed(f)]
        places = [place for f in self.unclear for place in self._middles(f, round_)]
        for j in self.bare:
            first, last = self.region.loops.first[j], self.region.loops.first[j + 1]
            share = 0.5 / (round_ + 1) + 0.07
            places += [(e, share) for e in range(first, last)]
        if places:
            element, at = (np.array(column) for column in zip(*places, strict=True))
            more.append(chords_at(self.region, element.astype(np.int64), at.astype(np.float64)))
        if not more and not self.unclear:
            return None
        joined = more[0] if more else met.chords
        for some in more[1:]:
            joined = together(joined, some)
        return joined

    def _one_disks(self, chosen: Bools) -> None:
        """Find faces whose chords are all of one disk, which then is a vertex."""
        faces = np.flatnonzero(chosen)
        if not len(faces):
            return
        sizes = np.diff(self.map.first)[faces]
        starts = np.cumsum(sizes) - sizes
        rows = np.repeat(self.map.first[faces] - starts, sizes) + np.arange(int(sizes.sum()))
        chord = self.map.member[rows] >> 1
        disk = np.column_stack([self.chords.center[chord], self.chords.radius[chord]])
        spread = np.maximum.reduceat(disk, starts) - np.minimum.reduceat(disk, starts)
        mean = np.add.reduceat(disk, starts) / sizes[:, None]
        for i in np.flatnonzero(spread.max(axis=1) <= self.near).tolist():
            self.vertices[int(faces[i])] = Vertex(mean[i, :2], float(mean[i, 2]), -1, 0.0)

    def _guesses(self, sides: dict[int, list[Part]]) -> dict[int, Face]:
        """Faces with three sides or more."""
        result = {}
        for f, parts in sides.items():
            if len(parts) < 3:
                continue
            ends = self.members(f)
            some = [k >> 1 for k in ends]
            guess = np.append(
                self.chords.center[some].mean(axis=0), self.chords.radius[some].mean()
            )
            inside = [leaf for k in ends for leaf in self.inside.get(k, ())]
            disks = [
                np.append(self.leaves.center[leaf], self.leaves.radius[leaf])
                for leaf in inside
                if self.leaves.radius[leaf] > 0.0
            ]
            round_ends = {
                place
                for leaf in inside
                if self.leaves.radius[leaf] > 0.0
                for place in (self.high[leaf], self._end(*self.low[leaf]))
            }
            result[f] = Face(parts, not inside, guess, disks, round_ends)
        return result

    def _parts_of(self, face: int) -> list[Part]:
        """The arcs of a face, cut at leaves; none where a chord has the only end on a loop."""
        result: list[Part] = []
        for k in self.members(face):
            if self.next[k] == k and not self.inside.get(k):
                return []
            result += self.parts(k)
        if any(start == end and v < u for start, u, end, v in result):
            return []
        return result

    def parts(self, k: int) -> list[Part]:
        """The arc from one end of a chord to the next, cut at leaves."""
        e, u = self.ends[k]
        result = []
        for leaf in self.inside.get(k, ()):
            result.append((e, u, *self._end(*self.low[leaf])))
            e, u = self.high[leaf]
        end, v = self.ends[self.next[k]]
        if (end, v) != (e, u):
            end, v = self._end(end, v)
        return [*result, (e, u, end, v)]

    def _end(self, element: int, at: float) -> tuple[int, float]:
        """A place as the end of an arc."""
        return (element, at) if at > 0.0 else (int(self.region.loops.before[element]), 1.0)

    def _spans(self, face: int) -> list[tuple[int, float, float]]:
        """The parts of elements that the arcs of a face go over."""
        after = self.region.loops.after
        spans: list[tuple[int, float, float]] = []
        for k in self.members(face):
            last = self.next[k]
            (e, u), (end, v) = self.ends[k], self.ends[last]
            if e == end and u <= v and last != k:
                spans.append((e, u, v))
                continue
            spans.append((e, u, 1.0))
            e = int(after[e])
            while e != end:
                spans.append((e, 0.0, 1.0))
                e = int(after[e])
            spans.append((e, 0.0, v))
        return spans

    def _middles(self, face: int, round_: int) -> list[tuple[int, float]]:
        """Places in the middle of the elements that the arcs of a face go over."""
        share = 0.5 if round_ % 2 else 0.4142
        return [(e, u + share * (v - u)) for e, u, v in self._spans(face) if v > u]

    def _collapsed(self, face: int) -> bool:
        """Whether all disks of a face are one within the spread allowed; then it is a vertex."""
        ends = self.members(face)
        rows = [k >> 1 for k in ends]
        center, radius = self.chords.center[rows], self.chords.radius[rows]
        least = int(np.argmin(radius))
        middle, r = center[least], float(radius[least])
        spread = float((np.hypot(*(center - middle).T) + radius - r).max())
        if spread > self.spread:
            return False
        spread = max(spread, self._farthest(face, middle) - r)
        if spread > self.spread:
            return False
        inside = [leaf for k in ends for leaf in self.inside.get(k, ())]
        leaf = inside[0] if len(ends) == 1 and inside else -1
        self.vertices[face] = Vertex(middle, r, leaf, spread)
        return True

    def _farthest(self, face: int, middle: Floats) -> float:
        """How far the arcs of a face are from a point at most, by their points."""
        spans = self._spans(face)
        share = np.linspace(0.0, 1.0, _LOOKED)
        every = np.repeat([e for e, _, _ in spans], _LOOKED)
        places = np.concatenate([low + share * (high - low) for _, low, high in spans])
        points, _ = points_and_normals(self.region.walk, every, places)
        return float(np.hypot(*(points - middle).T).max())


def leaves_with_empty_disks(region: Region, leaves: Leaves) -> Leaves:
    """Leaves without those whose disk the boundary enters."""
    from splinesdf.medial.kernels.disks import distances

    far = np.empty(len(leaves.radius))
    some = leaves.radius > 0.0
    checked = np.empty(int(np.count_nonzero(some)))
    distances(region.searched, np.ascontiguousarray(leaves.center[some]), checked)
    far[~some], far[some] = 0.0, checked
    keep = far >= leaves.radius * (1.0 - 1e-8) - 10.0 * NEAR * region.size
    low, high, center, radius, kind = leaves
    return Leaves(low[keep], high[keep], center[keep], radius[keep], kind[keep])
