"""Chords: maximal disks with two of their feet, in order along the walk, and faces between.

Chords of maximal disks do not cross, so that together with the walk they are a planar map.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.arclets.tables import Searched
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.medial.tables import ARC, FAN, WHOLE, Disks, Leaves, Loops, Walk
from splinesdf.shapes.shape import Shape

# Feet nearer than this share of the size are one place. Larger: junctions that near are one;
# smaller: rounding in feet puts them in the wrong order.
SNAP = 2e-12
# Directions of feet in two disks are alike (radians), beside what `SNAP` does to small disks.
# Larger: feet on several loops may be in the wrong order; smaller: rounding decides.
_ALIKE = 1e-9
# Disks smaller than this share of the size are rounding.
_POINT = 1e-14
# Where an element is looked at first: not its middle, where disks of symmetric shapes coincide.
_INSIDE = 0.4142
# Arclets shorter than this share of the size, as next to cusps, are looked at where they start.
_SHORT = 1e-7


class Region(NamedTuple):
    """A shape as its medial axis is traced."""

    shape: Shape
    walk: Walk
    loops: Loops
    searched: Searched
    size: float
    most: float  # no disk is larger
    start: Floats  # (n_elements,) where each element starts, along all loops


class Map(NamedTuple):
    """Ends of chords in order along the walk; chord i has the ends 2 i and 2 i + 1."""

    position: Floats  # (2 n,) along all loops
    next: Ints  # (2 n,) the end that follows along the loop
    order: Ints  # (2 n,) ends in order
    face: Ints  # (2 n,) the face of the arc that starts at an end
    member: Ints  # (2 n,) ends, face after face, in order around each
    first: Ints  # (n_faces + 1,) face f has the ends member[first[f]:first[f + 1]]


def region_of(shape: Shape, walk: Walk, loops: Loops) -> Region:
    """The tables that all stages share."""
    boundary = shape.boundary
    searched = Searched(boundary.tree, boundary.arcs, float(np.abs(boundary.boxes[0]).max()))
    xmin, ymin, xmax, ymax = boundary.boxes[0].tolist()
    start = np.cumsum(loops.length) - loops.length
    # A disk in a box is no wider than it; a little more, for rounding.
    most = 0.5000001 * min(xmax - xmin, ymax - ymin)
    return Region(shape, walk, loops, searched, shape.size, most, start)


def seeds(region: Region) -> tuple[Ints, Floats]:
    """Places where disks are looked for first: where sites meet, and in every element."""
    walk, loops = region.walk, region.loops
    element, site = walk.element, walk.element[:, 2]
    every = np.arange(len(site))
    joint = (site != site[loops.before]) & ~loops.corner
    long = (loops.length > _SHORT * region.size) | (element[:, 0] == FAN)
    places = np.concatenate([every[joint], every[long]])
    at = np.concatenate(
        [np.zeros(np.count_nonzero(joint)), np.full(np.count_nonzero(long), _INSIDE)]
    )
    return places, at


def disks_at(region: Region, element: Ints, at: Floats) -> tuple[Disks, Bools]:
    """The maximal disks at places, and which of them have a second foot."""
    from splinesdf.medial.kernels.disks import disks

    count = len(element)
    at, element = canonical(region, at, element)
    room = Disks(
        np.ascontiguousarray(np.column_stack([element, np.full(count, -1)])),
        np.ascontiguousarray(np.column_stack([at, np.zeros(count)])),
        np.empty((count, 2)),
        np.empty(count),
    )
    found = np.zeros(count, dtype=np.int64)
    disks(region.searched, region.walk, region.most, found, room)
    return room, found == 1


def chords_at(region: Region, element: Ints, at: Floats) -> Disks:
    """Chords at places, without those that are none."""
    room, found = disks_at(region, element, at)
    keep = found & (room.radius > _POINT * region.size) & (room.radius < region.most)
    return taken(room, keep)


def taken(disks: Disks, rows: Bools | Ints) -> Disks:
    """Some rows."""
    return Disks(disks.element[rows], disks.at[rows], disks.center[rows], disks.radius[rows])


def together(one: Disks, other: Disks) -> Disks:
    """All rows of both."""
    return Disks(*(np.concatenate(pair) for pair in zip(one, other, strict=True)))


def canonical(region: Region, at: Floats, element: Ints) -> tuple[Floats, Ints]:
    """Places at the ends of elements as the starts of the next ones."""
    loops = region.loops
    length = loops.length[element]
    ends = (1.0 - at) * length <= SNAP * region.size
    starts = at * length <= SNAP * region.size
    element = np.where(ends, loops.after[element], element)
    return np.where(ends | starts, 0.0, at), element


def position(region: Region, element: Ints, at: Floats) -> Floats:
    """Where places are along all loops."""
    return np.asarray(region.start[element] + at * region.loops.length[element])


def without_doubles(region: Region, chords: Disks, leaves: Leaves) -> Disks:
    """Chords without those that join one place to itself, come twice, or start in a leaf's arc."""
    at, element = canonical(region, chords.at, chords.element)
    chords = chords._replace(at=at, element=element)
    where = position(region, element, at)
    keep = np.ones(len(where), dtype=np.bool_)
    for k in np.flatnonzero((leaves.kind == ARC) | (leaves.kind == WHOLE)).tolist():
        loop = region.loops.loop[int(leaves.low[k, 0])]
        low, high = (
            position(region, side[k : k + 1, 0].astype(np.int64), side[k : k + 1, 1])[0]
            for side in (leaves.low, leaves.high)
        )
        own = region.loops.loop[element] == loop
        slack = SNAP * region.size
        inside = own & _between(where, low - slack, high + slack, low <= high)
        if leaves.kind[k] == WHOLE:
            inside = own
        keep &= ~inside.any(axis=1)
    where, chords = where[keep], taken(chords, keep)
    group = _groups(region, where)
    first, second = group.min(axis=1), group.max(axis=1)
    _, unique = np.unique(first * (int(group.max(initial=0)) + 1) + second, return_index=True)
    unique = np.sort(unique)
    return taken(chords, unique[(first != second)[unique]])


def _between(where: Floats, low: float, high: float, straight: bool) -> Bools:
    inside = (where >= low) & (where <= high) if straight else (where >= low) | (where <= high)
    return np.asarray(inside)


def _groups(region: Region, where: Floats) -> Ints:
    """Numbers of places, equal for those that are one, in order."""
    flat = where.ravel()
    order = np.argsort(flat, kind="stable")
    steps = np.diff(flat[order], prepend=flat[order[:1]])
    group = np.empty(len(flat), dtype=np.int64)
    group[order] = np.cumsum(steps > SNAP * region.size)
    return group.reshape(where.shape)


def mapped(region: Region, chords: Disks) -> Map:
    """Sort the ends of chords along the walk, and trace the faces between chords."""
    from splinesdf.medial.feet import points_and_normals
    from splinesdf.medial.kernels.cycles import cycles

    ends = 2 * len(chords.radius)
    element, at = chords.element.reshape(-1), chords.at.reshape(-1)
    where = position(region, element, at)
    group = _groups(region, where)
    loop = region.loops.loop[element]
    foot, _ = points_and_normals(region.walk, element, at)
    mate = np.arange(ends) ^ 1
    arm = foot - np.repeat(chords.center, 2, axis=0)
    other = arm[mate]
    angle = np.arctan2(
        arm[:, 0] * other[:, 1] - arm[:, 1] * other[:, 0], np.sum(arm * other, axis=1)
    )
    # Several at one foot: the one whose other foot is first, going on around the disk, is last.
    # Where feet are one but for rounding so are disks, and angles in them no longer tell: then
    # places along the loop do.
    angle = np.mod(angle, 2.0 * np.pi)
    order = np.lexsort((-angle, group, loop))
    apart = np.diff(group[order], prepend=-1) != 0
    apart |= np.abs(np.diff(angle[order], prepend=0.0)) > _ALIKE
    alike = np.empty(ends, dtype=np.int64)
    alike[order] = np.cumsum(apart)
    around = np.bincount(region.loops.loop, weights=region.loops.length)[loop]
    far = np.mod(where[mate] - where, around)
    order = np.lexsort((-far, alike, group, loop))
    following = np.empty(ends, dtype=np.int64)
    following[order] = np.roll(order, -1)
    firsts = np.flatnonzero(np.diff(loop[order], prepend=-1))
    lasts = np.append(firsts[1:], ends) - 1
    if ends:
        following[order[lasts]] = order[firsts]
    face, member = np.full(ends, -1), np.empty(ends, dtype=np.int64)
    cycles(following ^ 1, face, member)
    first = np.searchsorted(face[member], np.arange(int(face.max(initial=-1)) + 2))
    return Map(where, following, order, face, member, first)
