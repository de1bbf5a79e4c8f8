"""Faces with three sides and more, divided by the disks that touch three of their arcs.

Such a disk is a vertex of the axis. The chords between its feet divide the face; what is left on
the other side of each is divided alike, until no part has more than two sides.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats, Ints
from splinesdf.medial.chords import Region
from splinesdf.medial.tables import Arcs, Disks, Met

# An arc of a walk: element and parameter where it starts, and where it ends.
Part = tuple[int, float, int, float]
# Rounds of dividing. A face of n sides has at most n - 2 vertices; most have one or two.
_ROUNDS = 200
# Disks smaller than this share of the size are not found where they touch an end of an arc.
_SMALL = 1e-5


class Face(NamedTuple):
    """A face to be divided."""

    parts: list[Part]  # its arcs in order around it
    plain: bool  # whether there are chords, and no leaves, between all of them
    guess: Floats  # (3,) some disk near by
    leaves: list[Floats]  # disks of leaves in its arcs, of which one may touch others
    round_ends: set[tuple[int, float]]  # where these leaves are: only their own disks touch there


class Divided(NamedTuple):
    """What became of faces."""

    vertices: dict[int, tuple[Floats, float]]  # faces that one disk touches all around
    chords: Disks
    divided: set[int]  # faces that chords divide


def divided(region: Region, near: float, faces: dict[int, Face]) -> Divided:
    """Find the disks that touch three arcs of faces or more.

    Parameters
    ----------
    region : Region
    near : float
        Distances that differ by less are equal.
    faces : dict
        By their numbers.
    """
    vertices: dict[int, tuple[Floats, float]] = {}
    split: set[int] = set()
    rows: list[tuple[int, float, int, float]] = []
    disks: list[tuple[float, float, float]] = []
    todo = list(faces.items())
    for _ in range(_ROUNDS):
        if not todo:
            break
        met, first = _met(region, near, [face for _, face in todo])
        _touched_by_leaves(region, near, [face for _, face in todo], first, met)
        following = []
        for i, (f, (parts, plain, _, _, round_ends)) in enumerate(todo):
            if met.found[i] == 0:
                continue
            a, r = int(first[i]), float(met.radius[i])
            center = met.center[i].copy()
            count = len(parts)
            if met.found[i] == count and (plain or met.chosen[i, 0] < 0):
                vertices[f] = center, r
                continue
            touched = [k for k in range(count) if abs(float(met.distance[a + k]) - r) <= near]
            places = [(int(met.element[a + k]), float(met.at[a + k])) for k in touched]
            if met.chosen[i, 0] >= 0 and not round_ends.isdisjoint(places):
                continue
            # So small a disk touches within rounding where it is not tangent: in an end of an arc.
            ends = {place for part in parts for place in (part[:2], part[2:])}
            if r < _SMALL * region.size and not ends.isdisjoint(places):
                continue
            split.add(f)
            guess = np.append(center, r)
            for j, k in enumerate(touched):
                other = (j + 1) % len(touched)
                rows.append((*places[j], *places[other]))
                disks.append((*center.tolist(), r))
                last = touched[other] + (count if other == 0 else 0)
                if last - k + 1 < 3:
                    continue
                between = [parts[m % count] for m in range(k + 1, last)]
                begin = (*places[j], *parts[k][2:])
                end = (*parts[last % count][:2], *places[other])
                following.append((f, Face([begin, *between, end], False, guess, [], round_ends)))
        todo = following
    table = np.array(disks).reshape(-1, 3)
    chords = Disks(
        np.array([(row[0], row[2]) for row in rows], dtype=np.int64).reshape(-1, 2),
        np.array([(row[1], row[3]) for row in rows]).reshape(-1, 2),
        table[:, :2].copy(),
        table[:, 2].copy(),
    )
    return Divided(vertices, chords, split)


def _touched_by_leaves(
    region: Region, near: float, faces: list[Face], first: Ints, met: Met
) -> None:
    """Put the disk of a leaf in the place of what was found, where it touches other arcs, too.

    It touches both arcs beside the leaf in any case. Then ``chosen`` is -1.
    """
    from splinesdf.medial.kernels.junctions import feet

    tried = [(i, disk) for i, face in enumerate(faces) for disk in face.leaves]
    if not tried:
        return
    parts = [part for i, _ in tried for part in faces[i].parts]
    counts = [len(faces[i].parts) for i, _ in tried]
    table = _table(region, parts, np.zeros(1, dtype=np.int64))
    found = room(0, len(parts))
    feet(region.walk, table, np.repeat([disk[:2] for _, disk in tried], counts, axis=0), found)
    at = 0
    for (i, disk), count in zip(tried, counts, strict=True):
        rows = slice(at, at + count)
        touched = int(np.count_nonzero(np.abs(found.distance[rows] - disk[2]) <= near))
        at += count
        if touched > 2 and (met.found[i] < touched or touched == count):
            met.found[i], met.chosen[i] = touched, -1
            met.center[i], met.radius[i] = disk[:2], disk[2]
            own = slice(int(first[i]), int(first[i + 1]))
            met.element[own], met.at[own] = found.element[rows], found.at[rows]
            met.distance[own] = found.distance[rows]


def _table(region: Region, parts: list[Part], first: Ints) -> Arcs:
    return Arcs(
        first,
        np.array([(part[0], part[2]) for part in parts], dtype=np.int64),
        np.array([(part[1], part[3]) for part in parts]),
        region.loops.after,
    )


def _met(region: Region, near: float, faces: list[Face]) -> tuple[Met, Ints]:
    """Disks that touch three arcs of each face."""
    from splinesdf.medial.kernels.junctions import junctions

    rows = [part for face in faces for part in face.parts]
    first = np.cumsum([0] + [len(face.parts) for face in faces])
    met = room(len(faces), len(rows))
    guess = np.array([face.guess for face in faces])
    junctions(region.searched, region.walk, _table(region, rows, first), guess, near, met)
    return met, first


def room(faces: int, arcs: int) -> Met:
    """Room for what the kernels fill in."""
    return Met(
        np.empty((faces, 2)),
        np.empty(faces),
        np.empty(faces, dtype=np.int64),
        np.empty((faces, 3), dtype=np.int64),
        np.empty(arcs, dtype=np.int64),
        np.empty(arcs),
        np.empty(arcs),
    )
