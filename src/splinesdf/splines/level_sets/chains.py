"""Chains: the crossings of each triangle joined by arcs, the arcs joined into contours."""

from __future__ import annotations

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.ground.arrays import Floats, Ints, finite
from splinesdf.meshes import Mesh
from splinesdf.splines.level_sets.arcs import conic_arcs, shoulders
from splinesdf.splines.level_sets.edges import EdgeCrossings, find_edge_crossings
from splinesdf.splines.level_sets.quadratics import (
    Quadratics,
    pair,
    triangle_quadratics,
    whole_ellipses,
)

# Arcs shorter than this share of the domain are left out and their ends joined. Shorter ones
# have too few digits for a tangent to a millionth; longer ones begin to matter.
_SHORTEST = 1e-9
# And those shorter than so many units in the last place of the largest coordinate, which moves the
# ends and the middle of an arc by half a unit each. Smaller: some come out as points.
_ROUNDED = 64.0


def contours(mesh: Mesh, ordinates: Floats, level: float, *, y_down: bool = False) -> list[Contour]:
    """The level set of a spline: chains of conic arcs, the lower side on their left.

    Parameters
    ----------
    mesh : Grid or Quadtree
    ordinates : ndarray, shape (n_cells, 8)
    level : float
    y_down : bool
        Handed on to the contours.

    Returns
    -------
    list of Contour
        Closed, but for those that leave the domain. Exact up to rounding: every arc is the
        conic on which the triangle's quadratic takes the level.
    """
    level = finite(level, "level")
    crossings = find_edge_crossings(mesh, ordinates, level)
    boxes = mesh.local_boxes[crossings.cells]
    quadratics = triangle_quadratics(boxes, ordinates[crossings.cells], level)
    triangle, start, end = _join(crossings, quadratics)

    lonely = np.setdiff1d(np.arange(4 * len(boxes)), crossings.triangle)
    rows, rings = whole_ellipses(quadratics.take(lonely))
    position = np.concatenate([crossings.position, rings.reshape(-1, 2)])
    corner = len(crossings.position) + np.arange(rings.size // 2).reshape(-1, 4)
    triangle = np.concatenate([triangle, np.repeat(lonely[rows], 4)])
    start = np.concatenate([start, corner.ravel()])
    end = np.concatenate([end, np.roll(corner, -1, axis=1).ravel()])

    xmin, ymin, xmax, ymax = mesh.domain
    size, largest = max(xmax - xmin, ymax - ymin), max(map(abs, mesh.domain))
    shortest = max(_SHORTEST * size, _ROUNDED * float(np.spacing(largest)))
    result = []
    for chain, closed in _chains(start, end):
        points = np.concatenate([position[start[chain[:1]]], position[end[chain]]])
        f, points = _without_short(quadratics.take(triangle[chain]), points, shortest)
        if len(points) == 0:
            continue
        _, arcs, weights = conic_arcs(f, points[:-1], points[1:], shortest)
        result.append(Contour(arcs + np.array([xmin, ymin]), weights, closed, level, y_down))
    return result


def _join(crossings: EdgeCrossings, quadratics: Quadratics) -> tuple[Ints, Ints, Ints]:
    """Arcs as triangle, first and last crossing: each starts where the way leaves the low side."""
    triangles, first, count = np.unique(crossings.triangle, return_index=True, return_counts=True)
    simple = count == 2
    one, other = crossings.crossing[first[simple]], crossings.crossing[first[simple] + 1]
    leaves = crossings.leaving[first[simple]]
    found = [(triangles[simple], np.where(leaves, one, other), np.where(leaves, other, one))]
    for row, at, many in zip(triangles[~simple], first[~simple], count[~simple], strict=True):
        crossing = crossings.crossing[at : at + many]
        start, end = pair(
            quadratics.take(np.array([row])),
            crossings.position[crossing],
            crossings.leaving[at : at + many],
        )
        found.append((np.full(len(start), row), crossing[start], crossing[end]))
    triangle, start, end = (np.concatenate(values) for values in zip(*found, strict=True))
    return triangle, start, end


def _chains(start: Ints, end: Ints) -> list[tuple[Ints, bool]]:
    """Arcs in order, chain by chain, and whether a chain comes back to its start."""
    starting = {crossing: arc for arc, crossing in enumerate(start.tolist())}
    following = [starting.get(crossing, -1) for crossing in end.tolist()]
    entered = set(end.tolist())
    openings = [arc for arc, crossing in enumerate(start.tolist()) if crossing not in entered]
    seen = np.zeros(len(start), dtype=np.bool_)
    result = []
    for head in [*openings, *range(len(start))]:
        if seen[head]:
            continue
        chain = []
        arc = head
        while arc >= 0 and not seen[arc]:
            seen[arc] = True
            chain.append(arc)
            arc = following[arc]
        result.append((np.array(chain), arc >= 0))
    return result


def _without_short(f: Quadratics, points: Floats, shortest: float) -> tuple[Quadratics, Floats]:
    """The rest of a chain of n arcs and n + 1 points without short arcs; no points if all are."""
    around, far = _around(f, points[:-1], points[1:], shortest)
    f = f.take(np.sort(np.append(np.arange(len(points) - 1), around)))
    points = np.insert(points, around + 1, far, axis=0)
    short = np.linalg.norm(np.diff(points, axis=0), axis=1) < shortest
    while short.any():
        if short.all():
            return f.take(np.flatnonzero(~short)), points[:0]
        f = f.take(np.flatnonzero(~short))
        # The first and the last point stay: they are one, or on the border of the domain.
        points = np.concatenate([points[:1], points[1:][~short][:-1], points[-1:]])
        # An arc beside one that was left out may have become shorter.
        short = np.linalg.norm(np.diff(points, axis=0), axis=1) < shortest
    return f, points


def _around(f: Quadratics, first: Floats, last: Floats, shortest: float) -> tuple[Ints, Floats]:
    """Which arcs with a short chord go nearly once around an ellipse, and their far ends."""
    chord = last - first
    gradient = f.gradient_at(first)
    backward = chord[:, 1] * gradient[:, 0] - chord[:, 0] * gradient[:, 1] < 0.0
    # A chord of no length at all has no direction: an ellipse touches a side in a vertex at the
    # level. Beside it the side is below, so the ellipse goes around what is above, and all around.
    length = np.hypot(chord[:, 0], chord[:, 1])
    point = length == 0.0
    backward |= point & (np.trace(f.hessian, axis1=1, axis2=2) < 0.0)
    rows = np.flatnonzero(backward & (length < shortest))
    f, point = f.take(rows), point[rows]
    inside = f.contains_ellipse()
    rows, f, point = rows[inside], f.take(np.flatnonzero(inside)), point[inside]
    across = 2.0 * (f.center + f.extremes()[0]) - first[rows]
    far = np.where(point[:, None], across, shoulders(f, first[rows], last[rows]))
    # What rounding sends backward stays near, or would leave the triangle on the way round.
    there = np.linalg.norm(far - first[rows], axis=1) > shortest
    return rows[there], far[there]
