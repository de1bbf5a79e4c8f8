"""How many loops the level set of the exact distance has, counted on a quadtree of its values.

A cell whose center is farther from the level than its half diagonal has no part of it, as the
distance changes by no more than the way. In a cell all of whose gradients lie in a cone, the
distance grows along the cone's axis: the level passes simply, even if its tangent jumps. The
others are halved: they hold places where gradients point all around, and only there loops are
born, meet and die. Regions below and above the level, joined along cells' sides, and the loops
between them form a tree: loops = regions - 1.

The cone is no guess: what is closest to some point of a cell is no farther from its center than
the closest to that, and a diagonal. All of the boundary so near, as polylines, must lie in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import splinesdf as ss
from tests import oracles
from tests.offset_crossings import angle

# The square's side in steps of the finest lattice, as a power of two: what is left unresolved is
# 1e-9 of the size, and rounding of gradients is far less than a right angle still.
LEVELS = 30
# Cells are asked for cones when they are as fine as this share of the size, and of the distance.
# Coarser: in vain, there is too much of the boundary near.
COARSE, OF_DISTANCE = 1.0 / 700.0, 0.25
# How far the polylines stay from the boundary, a share of the size: little beside a cell that has
# a cone of the angle below and is not among the finest.
DEVIATION = 3e-6
# The cone's whole angle. Nearer pi: fewer cells at very sharp corners are left as hard.
CONE = np.radians(160.0)
# In the finest cells only this keeps a sharp corner from a place where gradients point all around.
FINEST_CONE = np.radians(179.0)
# Unresolved cells at which it gives up: a whole stretch of the skeleton lies on the level.
MOST = 40_000

# A cell's corners counterclockwise, then its sides' and its own middle, in half cells.
NINE = np.array([(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)])


def loop_counts(shape: ss.Shape, distance: float) -> list[int]:
    """The number of loops of the level, or all that it may be where rounding decides, sorted.

    Counted on two lattices, and if they disagree on two finer ones: where the level runs to a
    point narrower than cells, lattice points that belong together may be counted as two regions.
    """
    first = counted(shape, distance, 1.0)
    if len(first) > 1 or counted(shape, distance, 1.7) == first:
        return first
    return sorted({*counted(shape, distance, 3.1), *counted(shape, distance, 5.3)})


def counted(shape: ss.Shape, distance: float, fineness: float) -> list[int]:
    """The number on one lattice, its cells by a factor finer than need be."""
    side, corner = square(shape, distance)
    side *= 1.0 + 0.01 * fineness  # so that no point is one of two lattices
    unit = side / 2.0**LEVELS
    target = COARSE * shape.size
    if distance != 0.0:
        target = min(target, OF_DISTANCE * abs(distance))
    target /= fineness
    level = LEVELS - 6
    axis = np.arange(64) << level
    cells = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    wild = np.ones(len(cells), dtype=np.bool_)
    leaves = []
    while True:
        size = unit * 2.0**level
        middles = (2 * cells + (NINE[8] << level)) * (0.5 * unit) + corner
        fine, last = size <= target, level == 1
        # Of cells that are halved in any case nothing is asked but whether they are pure.
        looks = fine or last
        found = ss.project(shape, middles) if looks else None
        known = ss.signed_distance(shape, middles) if found is None else found.distance
        pure = np.abs(known - distance) > np.sqrt(0.5) * size
        simple, cone = pure.copy(), np.full(len(cells), np.inf)
        # The other eight of a pure cell are on its middle's side, and nothing else is asked.
        below = np.repeat((known < distance)[:, None], 4, axis=1)
        if found is not None:
            rest = np.flatnonzero(~pure)
            own = picked(found, rest)
            at_corners, nodes = looked_at(shape, cells[rest], NINE[:4], level, unit, corner)
            below[rest] = at_corners.distance < distance
            cone[rest] = in_cone([(at_corners, nodes), alone(own, middles[rest])])
            # These say soonest where there is no cone; where there may be one, all that is near.
            hopeful = fine & (cone[rest] < CONE) & ~alternates(below[rest])
            if distance != 0.0:
                sure = rest[hopeful]
                simple[sure] = sure_cone(shape, middles[sure], picked(found, sure), size) < CONE
            left = ~simple[rest]
            rest = rest[left]
            at_sides = looked_at(shape, cells[rest], NINE[4:8], level, unit, corner)
            cone[rest] = in_cone(
                [
                    (picked(at_corners, left), nodes[left]),
                    at_sides,
                    alone(picked(found, rest), middles[rest]),
                ]
            )
            if distance == 0.0:
                simple[rest] = hopeful[left] & (cone[rest] < CONE)
            last |= fine and np.sum(~simple) > MOST
        if last:
            simple |= cone < FINEST_CONE
        done = simple | last
        leaves.append(
            Leaves(
                corners(cells[done], level),
                below[done],
                (pure & wild)[done],
                ~simple[done],
            )
        )
        if done.all():
            break
        level -= 1
        cells = (cells[~done][:, None] + (NINE[:4] // 2 << level)).reshape(-1, 2)
        wild = np.repeat(~(fine & (cone < CONE))[~done], 4)
    return counts(Leaves(*(np.concatenate(parts) for parts in zip(*leaves, strict=True))))


class Leaves(NamedTuple):
    """Cells: their corners' names and which of them are below the level; two kinds of cells.

    Sure ones lie on one side and may have a highest or a lowest point of the distance in them, as
    each region has somewhere. The level may do anything in hard ones.
    """

    corners: np.ndarray  # (n, 4)
    below: np.ndarray  # (n, 4)
    sure: np.ndarray  # (n,)
    hard: np.ndarray  # (n,)


def square(shape: ss.Shape, distance: float) -> tuple[float, np.ndarray]:
    """A square whose border is far outside; off the shape's axes of symmetry."""
    xmin, ymin, xmax, ymax = shape.box
    side = 1.0931 * shape.size + 2.2147 * max(distance, 0.0)
    middle = np.array([0.5 * (xmin + xmax), 0.5 * (ymin + ymax)]) + shape.size * 1e-3 * np.array(
        [0.7391, 0.4177]
    )
    return side, middle - 0.5 * side


def picked(found: ss.Projection, which: np.ndarray) -> ss.Projection:
    return ss.Projection(*(part[which] for part in found))


def alone(found: ss.Projection, points: np.ndarray) -> tuple[ss.Projection, np.ndarray]:
    """One node of each cell, as `looked_at` gives several."""
    return picked(found, np.s_[:, None]), points[:, None]


def looked_at(
    shape: ss.Shape,
    cells: np.ndarray,
    nine: np.ndarray,
    level: int,
    unit: float,
    corner: np.ndarray,
) -> tuple[ss.Projection, np.ndarray]:
    """What `project` says of some of the cells' nine, and these: (n, some) each.

    Neighbors share them: each is asked for once.
    """
    at = 2 * (cells[:, None] >> level) + nine  # in half cells
    _, first, which = np.unique(
        (at[..., 0] << LEVELS + 1) + at[..., 1], return_index=True, return_inverse=True
    )
    nodes = (at.reshape(-1, 2)[first] << level) * (0.5 * unit) + corner
    which = which.reshape(at.shape[:2])
    return picked(ss.project(shape, nodes), which), nodes[which]


def in_cone(looks: Sequence[tuple[ss.Projection, np.ndarray]]) -> np.ndarray:
    """The angle of the narrowest cone that has all gradients of a cell in it: (n,)."""
    away = np.concatenate([nodes - found.point for found, nodes in looks], axis=1)
    distance = np.concatenate([found.distance for found, _ in looks], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        gradients = away / distance[..., None]
    angles = np.sort(np.arctan2(gradients[..., 1], gradients[..., 0]), axis=1)  # NaN last
    gaps = np.diff(angles, axis=1, append=angles[:, :1] + 2.0 * np.pi)
    cone: np.ndarray = 2.0 * np.pi - gaps.max(axis=1)
    return cone  # NaN on the boundary: not less than anything


@lru_cache(maxsize=4)
def boundary_segments(shape: ss.Shape) -> tuple[np.ndarray, shapely.STRtree]:
    """The filled region's boundary as short straight pieces (n, 2, 2), and a tree of them."""
    rings = oracles.polylines(shape, DEVIATION * shape.size)
    lines = oracles.filled_boundary(rings, shape.fill, snap=1e-13 * np.abs(shape.control).max())
    segments = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
    return segments, shapely.STRtree(shapely.linestrings(segments))


def sure_cone(
    shape: ss.Shape, middles: np.ndarray, found: ss.Projection, size: float
) -> np.ndarray:
    """A cone that has all gradients of cells in it, from all that may be closest there: (n,)."""
    if len(middles) == 0:
        return np.empty(0)
    segments, tree = boundary_segments(shape)
    half = np.sqrt(0.5) * size
    reach = np.abs(found.distance) + 2.0 * half + 2.0 * DEVIATION * shape.size
    cell, near = tree.query(shapely.points(middles), predicate="dwithin", distance=reach)
    start = segments[near, 0] - middles[cell]
    way = segments[near, 1] - segments[near, 0]
    # The part of each piece within reach: where |start + t way| <= reach.
    square = np.sum(way * way, axis=1)
    nearest = -np.sum(start * way, axis=1) / square
    off = start + nearest[:, None] * way
    room = np.sqrt(np.maximum(reach[cell] ** 2 - np.sum(off * off, axis=1), 0.0) / square)
    toward = (found.point - middles)[cell]
    low, high = np.zeros(len(middles)), np.zeros(len(middles))
    for t in (nearest - room, nearest + room):
        end = start + np.clip(t, 0.0, 1.0)[:, None] * way
        turn = angle(toward, end)
        np.minimum.at(low, cell, turn)
        np.maximum.at(high, cell, turn)
    aside = np.arcsin(np.minimum(1.0, half / np.abs(found.distance)))
    result: np.ndarray = high - low + 2.0 * aside
    return result


def alternates(below: np.ndarray) -> np.ndarray:
    """Whether a cell's corners in turn are below and above: (n,)."""
    one, two, three, four = below[:, :4].T
    result: np.ndarray = (one == three) & (two == four) & (one != two)
    return result


def corners(cells: np.ndarray, level: int) -> np.ndarray:
    """The lattice points of the cells' corners as one number each: (n, 4)."""
    points = cells[:, None] + (NINE[:4] << (level - 1))
    return (points[..., 0] << (LEVELS + 1)) + points[..., 1]


def counts(leaves: Leaves) -> list[int]:
    """Loops if the hard cells are as their corners say, all below, and all above the level.

    Where the level runs to a point, lattice points may be cut off from the rest of their region:
    they have no sure cell, so they are none. What has no sure but a hard cell may be a region.
    """
    names, where = np.unique(leaves.corners, return_inverse=True)
    where = where.reshape(leaves.corners.shape)
    given, sure, hard = (np.zeros(len(names), dtype=np.bool_) for _ in range(3))
    given[where] = leaves.below
    sure[where[leaves.sure]] = True
    hard[where[leaves.hard]] = True
    start, end = where.ravel(), np.roll(where, -1, axis=1).ravel()
    result = set()
    for forced in (None, True, False) if hard.any() else (None,):
        below = given if forced is None else np.where(hard, forced, given)
        same = below[start] == below[end]
        links = coo_array(
            (np.ones(np.sum(same), dtype=np.int8), (start[same], end[same])),
            shape=(len(names), len(names)),
        )
        _, label = connected_components(links, directed=False)
        regions = np.unique(label[sure & (below == given)])
        unsure = np.setdiff1d(label[hard], regions)
        result |= {len(regions) - 1, len(regions) - 1 + len(unsure)}
    return sorted(result)
