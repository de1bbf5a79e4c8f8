"""Faces as a graph: chains of disks from one vertex to the next, cut where sites change."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.medial.dividing import Part, room
from splinesdf.medial.faces import Look
from splinesdf.medial.feet import arms
from splinesdf.medial.tables import Arcs

# Disks of a chain that differ by less than this share of the size from its vertex are that.
_SAME = 1e-11


class Nodes(NamedTuple):
    """Disks of all chains, one chain after the other; the walk goes forward on the right side."""

    disk: Floats  # (n, 3) x, y, r
    element: Ints  # (n, 2) places of the right and the left foot
    at: Floats  # (n, 2)
    foot: Floats  # (n, 2, 2)
    normal: Floats  # (n, 2, 2) unit vectors from the feet to the center


class Chains(NamedTuple):
    """Edges of the axis as chains of disks."""

    nodes: Nodes
    first: Ints  # (n_edges + 1,) edge j has the nodes first[j]:first[j + 1]
    ends: Ints  # (n_edges, 2) vertices, -1 for closed chains without any
    # (n_nodes, 2) of each node but the last of an edge, the elements that the feet are on just
    # behind it; and just before the next one
    ahead: Ints
    behind: Ints


class Corners(NamedTuple):
    """Vertices of the graph."""

    center: Floats  # (n, 2)
    radius: Floats  # (n,)
    leaf: Ints  # (n,) which leaf, -1 for none
    spread: Floats  # (n,)
    face: dict[int, int]  # from faces


def corners_of(traced: Look) -> Corners:
    """The vertices, those of loops without chords last."""
    leaves = traced.leaves
    faces = sorted(traced.vertices)
    vertices = [traced.vertices[f] for f in faces]
    alone = traced.alone
    center = [vertex.center for vertex in vertices] + [leaves.center[k] for k in alone]
    radius = [vertex.radius for vertex in vertices] + [leaves.radius[k] for k in alone]
    leaf = [vertex.leaf for vertex in vertices] + list(alone)
    spread = [vertex.spread for vertex in vertices] + [0.0] * len(alone)
    return Corners(
        np.array(center).reshape(-1, 2),
        np.array(radius, dtype=np.float64),
        np.array(leaf, dtype=np.int64),
        np.array(spread, dtype=np.float64),
        {f: i for i, f in enumerate(faces)},
    )


def chains_of(traced: Look, corners: Corners) -> Chains:
    """Follow the chords from vertex to vertex."""
    chart, chords = traced.map, traced.chords
    face, faces = chart.face.tolist(), [*map(traced.members, range(len(chart.first) - 1))]
    used = [False] * len(chords.radius)
    chains: list[tuple[int, list[int], int]] = []  # vertex, right ends of chords, vertex
    starts: list[tuple[int, int]] = [(f, k) for f in corners.face for k in faces[f]]
    # Where the axis is not clear chains end, too: an incomplete one is never silent, but shown.
    starts += [(-2, k) for f in traced.unclear for k in faces[f]]
    for f, k in starts:
        if used[k >> 1]:
            continue
        rights, end = _followed(k ^ 1, face, faces, used, corners)
        chains.append((corners.face.get(f, -1), rights, end))
    for i in range(len(used)):
        if not used[i]:
            rights, end = _followed(2 * i, face, faces, used, corners)
            chains.append((-1, rights, end))
    return _with_vertices(traced, corners, chains)


def _followed(
    right: int, face: list[int], faces: list[list[int]], used: list[bool], corners: Corners
) -> tuple[list[int], int]:
    """Right ends of the chords from one on, up to a vertex; -1 where there is none."""
    rights = []
    while not used[right >> 1]:
        used[right >> 1] = True
        rights.append(right)
        f = face[right]
        if f in corners.face:
            return rights, corners.face[f]
        ends = faces[f]
        if len(ends) != 2:
            return rights, -1
        right = (ends[1] if ends[0] == right else ends[0]) ^ 1
    return rights, -1


def _with_vertices(
    traced: Look, corners: Corners, chains: list[tuple[int, list[int], int]]
) -> Chains:
    """The tables of chains, their vertices at both ends; of a closed one the first node again."""
    region, chords = traced.region, traced.chords
    element, at = chords.element.reshape(-1), chords.at.reshape(-1)
    before = region.loops.before
    rows: list[int] = []  # right ends; below zero for vertices
    first, ends = [0], []
    known = np.column_stack([chords.center, chords.radius]).tolist()
    vertices = np.column_stack([corners.center, corners.radius]).tolist()
    for start, rights, end in chains:
        inner = _apart(known, vertices, (start, rights, end), _SAME * region.size)
        closed = start < 0 and end < 0 and len(rights) > 1
        rows += [-start - 1] if start >= 0 else []
        rows += inner
        rows += [-end - 1] if end >= 0 else ([inner[0]] if closed else [])
        first.append(len(rows))
        ends.append((start, end))
    row = np.array(rows, dtype=np.int64)
    vertex = row < 0
    right, left = np.where(vertex, 0, row), np.where(vertex, 1, row ^ 1)
    if not len(element):
        return _nothing()
    places, params = element[np.stack([right, left], axis=1)], at[np.stack([right, left], axis=1)]
    number = np.where(vertex, -row - 1, 0)
    disk = np.where(
        vertex[:, None],
        np.column_stack([corners.center, corners.radius])[number]
        if len(corners.radius)
        else np.zeros((len(row), 3)),
        np.column_stack([chords.center, chords.radius])[right >> 1],
    )
    starts = np.array(first[:-1])
    lasts = np.array(first[1:]) - 1
    at_start = starts[vertex[starts]]
    at_end = lasts[vertex[lasts] & (lasts > starts)]
    bounds = np.array(first)
    # The elements beside a vertex are those of the chord next to it.
    for rows_, step in ((at_start, 1), (at_end, -1)):
        places[rows_], params[rows_] = places[rows_ + step], params[rows_ + step]
    ahead, behind = _elements(places, params, before, vertex)
    _feet_of_vertices(traced, (at_start, at_end), disk, row, places, params)
    foot, normal = (
        np.stack(column, axis=1)
        for column in zip(
            *(
                arms(region.walk, places[:, k], params[:, k], disk[:, :2], region.size)
                for k in (0, 1)
            ),
            strict=True,
        )
    )
    nodes = Nodes(disk, places, params, foot, normal)
    return Chains(nodes, bounds, np.array(ends, dtype=np.int64).reshape(-1, 2), ahead, behind)


def _nothing() -> Chains:
    none = np.empty((0, 2), dtype=np.int64)
    empty = np.empty((0, 2, 2))
    nodes = Nodes(np.empty((0, 3)), none, np.empty((0, 2)), empty, empty)
    return Chains(nodes, np.zeros(1, dtype=np.int64), none, none, none)


def _apart(
    chords: list[list[float]],
    vertices: list[list[float]],
    chain: tuple[int, list[int], int],
    near: float,
) -> list[int]:
    """The chords of a chain that are not the disk of a vertex at its end; one at least."""
    start, rights, end = chain

    def same(right: int, vertex: int) -> bool:
        if vertex < 0:
            return False
        one, other = chords[right >> 1], vertices[vertex]
        return sum(abs(a - b) for a, b in zip(one, other, strict=True)) <= near

    low, high = 0, len(rights)
    while high - low > 1 and same(rights[low], start):
        low += 1
    while high - low > 1 and same(rights[high - 1], end):
        high -= 1
    return rights[low:high]


def _elements(places: Ints, params: Floats, before: Ints, vertex: Bools) -> tuple[Ints, Ints]:
    """Elements just behind each node, and just before the next, of the right and the left foot."""
    previous = np.where(params > 0.0, places, before[places])
    following = np.roll(np.arange(len(places)), -1)
    # Going on, the right foot walks forward and the left one backward.
    ahead = np.column_stack([places[:, 0], previous[:, 1]])
    behind = np.column_stack([previous[:, 0], places[:, 1]])[following]
    starts = vertex
    # A vertex has the places of the chord next to it: seen from there.
    ahead = np.where(starts[:, None], behind, ahead)
    behind = np.where(vertex[following][:, None], ahead, behind)
    return ahead, behind


def _feet_of_vertices(
    traced: Look, rows: tuple[Ints, Ints], disk: Floats, row: Ints, places: Ints, params: Floats
) -> None:
    """Fill the feet of vertices on both sides of each chain that ends in them.

    They are on the arcs that lead from the chord next to it to the vertex.
    """
    from splinesdf.medial.kernels.junctions import feet

    table: list[Part] = []
    far: list[tuple[int, float]] = []
    before = np.empty_like(traced.map.next)
    before[traced.map.next] = np.arange(len(before))
    targets: list[tuple[int, int]] = []
    for at_end, some in enumerate(rows):
        for place in some.tolist():
            right = int(row[place - 1 if at_end else place + 1])
            # Right feet walk forward, left ones backward.
            ahead, back = (right, right ^ 1) if at_end else (right ^ 1, right)
            both = [
                _on_site(traced, traced.parts(ahead)[0], True),
                _on_site(traced, traced.parts(int(before[back]))[-1], False),
            ]
            table += both if at_end else both[::-1]
            # Where the disk is a point the arcs end in it.
            far += [both[0][2:], both[1][:2]] if at_end else [both[1][:2], both[0][2:]]
            targets += [(place, 0), (place, 1)]
    if not table:
        return
    count = len(table)
    met = room(0, count)
    arcs = Arcs(
        np.zeros(1, dtype=np.int64),
        np.array([(part[0], part[2]) for part in table], dtype=np.int64),
        np.array([(part[1], part[3]) for part in table]),
        traced.region.loops.after,
    )
    which, sides = np.array(targets).T
    feet(traced.region.walk, arcs, np.ascontiguousarray(disk[which, :2]), met)
    point = disk[which, 2] == 0.0
    element, at = (np.array(column) for column in zip(*far, strict=True))
    places[which, sides] = np.where(point, element, met.element)
    params[which, sides] = np.where(point, at, met.at)


def _on_site(traced: Look, part: Part, forward: bool) -> Part:
    """An arc from a chord to a vertex, as far as it is on the site that it is on at the chord.

    Where a site ends there is a chord, but for circles whose center is the vertex.
    """
    site, loops = traced.region.walk.element[:, 2], traced.region.loops
    e, u, end, v = part
    if e == end:
        return part
    if forward:
        at = e
        while at != end and site[loops.after[at]] == site[e]:
            at = int(loops.after[at])
        return (e, u, at, v if at == end else 1.0)
    at = end
    while at != e and site[loops.before[at]] == site[end]:
        at = int(loops.before[at])
    return (at, u if at == e else 0.0, end, v)
