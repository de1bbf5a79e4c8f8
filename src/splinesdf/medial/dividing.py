"""Faces with three sides and more, divided by the disks that touch three of their arcs.

Such a disk is a vertex of the axis. The chords between its feet divide the face; what is left on
the other side of each is divided alike, until no part has more than two sides.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.medial.chords import Region
from splinesdf.medial.tables import Arcs, Disks, Met

# An arc of a walk: element and parameter where it starts, and where it ends.
Part = tuple[int, float, int, float]
# Rounds of dividing. A face of n sides has at most n - 2 vertices; most have one or two.
_ROUNDS = 200


class Divided(NamedTuple):
    """What became of faces."""

    vertices: dict[int, tuple[Floats, float]]  # faces that one disk touches all around
    chords: Disks
    divided: set[int]  # faces that chords divide


def divided(
    region: Region, near: float, faces: dict[int, tuple[list[Part], bool, Floats]]
) -> Divided:
    """Find the disks that touch three arcs of faces or more.

    Parameters
    ----------
    region : Region
    near : float
        Distances that differ by less are equal.
    faces : dict
        By face: its arcs in order around it; whether there are chords, and no leaves, between all
        of them; some disk near by.
    """
    vertices: dict[int, tuple[Floats, float]] = {}
    split: set[int] = set()
    rows: list[tuple[int, float, int, float]] = []
    disks: list[tuple[float, float, float]] = []
    todo = [(f, parts, plain, guess) for f, (parts, plain, guess) in faces.items()]
    for _ in range(_ROUNDS):
        if not todo:
            break
        met, first = _met(region, near, todo)
        following = []
        for i, (f, parts, plain, _) in enumerate(todo):
            if met.found[i] == 0:
                continue
            a, r = int(first[i]), float(met.radius[i])
            center = met.center[i].copy()
            count = len(parts)
            if met.found[i] == count and plain:
                vertices[f] = center, r
                continue
            split.add(f)
            touched = [k for k in range(count) if abs(float(met.distance[a + k]) - r) <= near]
            places = [(int(met.element[a + k]), float(met.at[a + k])) for k in touched]
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
                following.append((f, [begin, *between, end], False, guess))
        todo = following
    table = np.array(disks).reshape(-1, 3)
    chords = Disks(
        np.array([(row[0], row[2]) for row in rows], dtype=np.int64).reshape(-1, 2),
        np.array([(row[1], row[3]) for row in rows]).reshape(-1, 2),
        table[:, :2].copy(),
        table[:, 2].copy(),
    )
    return Divided(vertices, chords, split)


def _met(
    region: Region, near: float, todo: list[tuple[int, list[Part], bool, Floats]]
) -> tuple[Met, np.ndarray]:
    """Disks that touch three arcs of each face."""
    from splinesdf.medial.kernels.junctions import junctions

    rows = [part for _, parts, _, _ in todo for part in parts]
    first = np.cumsum([0] + [len(parts) for _, parts, _, _ in todo])
    table = Arcs(
        first,
        np.array([(part[0], part[2]) for part in rows], dtype=np.int64),
        np.array([(part[1], part[3]) for part in rows]),
        region.loops.after,
    )
    met = room(len(todo), len(rows))
    guess = np.array([guess for _, _, _, guess in todo])
    junctions(region.searched, region.walk, table, guess, near, met)
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
