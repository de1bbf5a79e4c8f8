"""How many loops the level set of the exact distance has, counted on a quadtree of its values.

A cell whose center is farther from the level than its half diagonal has no part of it, as the
distance changes by no more than the way. In a cell all of whose gradients lie in a cone, the
distance grows along the cone's axis: the level passes simply, whatever its corners (in the sense
of tangents). The others are halved: they hold places where gradients point all around, and only
there loops are born, meet and die. Regions below and above the level, joined along cells' sides,
and the loops between them form a tree: loops = regions - 1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import splinesdf as ss

# The square's side in steps of the finest lattice, as a power of two: what is left unresolved is
# 1e-9 of the size, and rounding of gradients is far less than a right angle still.
LEVELS = 30
# Cells that meet the level are at least this fine (share of the size), and a share of the
# distance, down to the finest start. Coarser: features between the nine samples go unseen.
COARSE, OF_DISTANCE, FINE = 1.0 / 700.0, 0.25, 1.0 / 6000.0
# The cone's whole angle. Nearer pi: fewer cells at very sharp corners are left as hard, and the
# samples' cone is less surely the cell's.
CONE = np.radians(160.0)
# In the finest cells only this keeps a sharp corner from a place where gradients point all around.
FINEST_CONE = np.radians(179.0)
# Unresolved cells at which it gives up: a whole stretch of the skeleton lies on the level.
MOST = 60_000

# A cell's corners counterclockwise, then its sides' and its own middle, in half cells.
NINE = np.array([(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)])


def loop_counts(shape: ss.Shape, distance: float) -> list[int]:
    """The number of loops of the level, or all that it may be where rounding decides, sorted."""
    side, corner = square(shape, distance)
    unit = side / 2.0**LEVELS
    target = np.clip(OF_DISTANCE * abs(distance) / shape.size, FINE, COARSE) * shape.size
    level = LEVELS - 6
    axis = np.arange(64) << level
    cells = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    wild = np.ones(len(cells), dtype=np.bool_)
    leaves = []
    while True:
        nodes = (2 * cells[:, None] + (NINE << level)) * (0.5 * unit) + corner
        found = ss.project(shape, nodes)
        above = found.distance - distance
        size = unit * 2.0**level
        pure = np.abs(above[:, 8]) > np.sqrt(0.5) * size
        cone = in_cone(found, nodes)
        fine = size <= target
        simple = pure | (fine & (cone < CONE) & ~alternates(above < 0.0))
        last = level == 1 or (fine and np.sum(~simple) > MOST)
        if last:
            simple |= cone < FINEST_CONE
        done = simple | last
        leaves.append(
            Leaves(
                corners(cells[done], level),
                above[done, :4] < 0.0,
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


def in_cone(found: ss.Projection, nodes: np.ndarray) -> np.ndarray:
    """The angle of the narrowest cone that has all gradients of a cell in it: (n,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        gradients = (nodes - found.point) / found.distance[..., None]
    angles = np.sort(np.arctan2(gradients[..., 1], gradients[..., 0]), axis=1)  # NaN last
    gaps = np.diff(angles, axis=1, append=angles[:, :1] + 2.0 * np.pi)
    cone: np.ndarray = 2.0 * np.pi - gaps.max(axis=1)
    return cone  # NaN on the boundary: not less than anything


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
    for forced in (None, True, False):
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
