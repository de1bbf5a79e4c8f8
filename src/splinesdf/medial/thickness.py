"""Wall thickness: narrow places, largest disks that touch given points, or that cover them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import AxisIncomplete, InputError
from splinesdf.ground.arrays import Bools, Floats, Ints, as_points, shown
from splinesdf.ground.values import by_value
from splinesdf.medial.between import Pool, between, pool_of
from splinesdf.medial.chords import Region
from splinesdf.medial.curves import slopes_of
from splinesdf.medial.graph import Chains
from splinesdf.medial.tables import FAN, Disks
from splinesdf.medial.tracing import (
    Side,
    around,
    checked_tolerance,
    graph_of,
    inside_axis,
    is_complete,
    leaves_in,
    why,
    without_frame,
)
from splinesdf.meshes.mesh import Box
from splinesdf.shapes.shape import Shape, check_shape

# Slopes of the radius along the axis below this are none: walls are parallel. Above the rounding of
# directions; larger: walls that taper by as much are parallel.
_LEVEL = 1e-10
# Steps to a narrow place, by false position within a bracket. The width is exact to rounding once
# the slope is 1e-8, as it is least there.
_STEPS, _FLAT = 60, 1e-12
# The default tolerance of local thickness, as a share of the larger side.
_OF_SIZE = 1e-3
# Disks of local thickness. More: memory, and seconds for each point that small disks cover.
_MOST = 1_000_000
# Branches lower than this share of the larger side have no narrow place of their own.
_LOW = 1e-6


@by_value
@dataclass(frozen=True, eq=False)
class Narrow:
    """A place where walls, or what is between contours, are narrowest.

    Attributes
    ----------
    width : float
        The distance of both feet: the diameter of the disk that touches there.
    point : ndarray, shape (2,)
        Its center.
    feet : ndarray, shape (2, 2)
        Where the disk touches, at opposite ends of a diameter.

    Examples
    --------
    >>> import splinesdf as ss
    >>> place = ss.thickness(ss.Shape.rectangle(0, 0, 4, 2))[0]
    >>> place.width, place.point.tolist()
    (2.0, [2.0, 1.0])
    """

    width: float
    point: Floats
    feet: Floats

    def __repr__(self) -> str:
        return f"<Narrow: {self.width:.6g} at ({self.point[0]:.6g}, {self.point[1]:.6g})>"


class MaximalDisks(NamedTuple):
    """Largest disks of a shape that touch given points of its boundary.

    Attributes
    ----------
    center : ndarray, shape (..., 2)
    radius : ndarray, shape (...,)
    foot : ndarray, shape (..., 2)
        Where else the disk touches; NaN where it is the disk of curvature.

    Examples
    --------
    >>> import splinesdf as ss
    >>> disk = ss.maximal_disk(ss.Shape.rectangle(0, 0, 4, 2), [2.0, 0.0])
    >>> disk.center.tolist(), float(disk.radius), disk.foot.tolist()
    ([2.0, 1.0], 1.0, [2.0, 2.0])
    """

    center: Floats
    radius: Floats
    foot: Floats


def thickness(shape: Shape, *, side: Side = "inside", domain: Box | None = None) -> list[Narrow]:
    """All places where the shape, or the space outside, is narrower than nearby.

    Parameters
    ----------
    shape : Shape
    side : {"inside", "outside"}
        Walls, or the channels between them.
    domain : (xmin, ymin, xmax, ymax), optional
        As in `medial_axis`.

    Returns
    -------
    list of Narrow
        Smallest width first: the local minima of 2 r along the medial axis, where both feet are
        opposite. Of parallel walls there is one, in the middle. Exact, to about 1e-14 of the size.
        Corners are no narrow places, and a disk has none.

    Raises
    ------
    AxisIncomplete, InputError
        As `medial_axis`.

    Examples
    --------
    >>> import splinesdf as ss
    >>> plate = ss.Shape.rectangle(0, 0, 10, 4) - ss.Shape.circle((3, 2), 1.5)
    >>> [round(place.width, 9) for place in ss.thickness(plate)]
    [0.5, 0.5, 1.5, 4.0]
    """
    check_shape(shape)
    if side not in ("inside", "outside"):
        raise InputError(f'expected side "inside" or "outside", got {shown(side)}')
    box = None
    region_shape = shape
    if side == "outside":
        region_shape, box = around(shape, domain)
    elif domain is not None:
        raise InputError('expected domain with side="outside" only: inside there is the shape')
    look, corners, chains = graph_of(region_shape, _LOW * shape.size)
    if not is_complete(look, corners, chains):
        raise AxisIncomplete(why(shape), inside_axis(region_shape, _OF_SIZE * shape.size))
    if not len(chains.ends):
        return []
    region = look.region
    chosen = np.ones(len(chains.ends), dtype=np.bool_)
    if box is not None:
        frame = np.array(box) - np.tile(region.shape.boundary.origin, 2)
        chosen, _, _ = without_frame(region, chains, ["junction"] * len(corners.radius), frame)
    pool = pool_of(region, chains, slopes_of(chains))
    pool, rows = _narrow(region, pool, chains, chosen)
    origin = region.shape.boundary.origin
    found = [
        Narrow(2.0 * float(pool.disk[i, 2]), pool.disk[i, :2] + origin, pool.foot[i] + origin)
        for i in rows.tolist()
    ]
    return sorted(found, key=lambda place: (place.width, *place.point.tolist()))


def _narrow(region: Region, pool: Pool, chains: Chains, chosen: Bools) -> tuple[Pool, Ints]:
    """The disks of a pool, and others added to it, that are narrowest along edges."""
    slope = pool.slope[:, 2]
    level = np.where(np.abs(slope) <= _LEVEL, 0, np.sign(slope)).astype(np.int64)
    # At ends in corners and in maxima of curvature the radius is least, but no wall is there.
    rows: list[int] = []
    level_rows: list[tuple[int, int]] = []
    low: list[int] = []
    high: list[int] = []
    for j in np.flatnonzero(chosen).tolist():
        nodes = np.arange(chains.first[j], chains.first[j + 1])
        if chains.ends[j, 0] < 0:
            # Around a closed edge, from where the radius changes.
            nodes = nodes[:-1]
            uneven = np.flatnonzero(level[nodes])
            if not len(uneven):
                rows.append(int(nodes[0]))
                continue
            nodes = np.roll(nodes, -int(uneven[0]))
            nodes = np.append(nodes, nodes[0])
        signs = level[nodes].tolist()
        at = 0
        while at < len(signs):
            end = at
            while end + 1 < len(signs) and signs[end + 1] == signs[at]:
                end += 1
            falls = at == 0 or signs[at - 1] < 0
            rises = end == len(signs) - 1 or signs[end + 1] > 0
            inner = at > 0 and end < len(signs) - 1
            if signs[at] == 0 and falls and rises and (inner or end > at):
                level_rows.append((int(nodes[at]), int(nodes[end])))
            if signs[at] < 0 and end + 1 < len(signs) and signs[end + 1] > 0:
                low.append(int(nodes[end]))
                high.append(int(nodes[end + 1]))
            at = end + 1
    pool, more = _bracketed(region, pool, np.array(low, dtype=int), np.array(high, dtype=int))
    pool, middles = _middles(region, pool, np.array(level_rows, dtype=int).reshape(-1, 2))
    return pool, np.concatenate([np.array(rows, dtype=np.int64), middles, more])


def _middles(region: Region, pool: Pool, ends: Ints) -> tuple[Pool, Ints]:
    """The disks in the middle of parallel walls, between two others."""
    one = ends[:, 0] == ends[:, 1]
    first, last = ends[~one].T
    pool, good = between(region, pool, first, last, np.full(len(first), 0.5))
    new = np.arange(len(pool.order) - len(first), len(pool.order))
    return pool, np.concatenate([ends[one, 0], np.where(good, new, first)])


def _bracketed(region: Region, pool: Pool, low: Ints, high: Ints) -> tuple[Pool, Ints]:
    """Disks between others where the radius falls and where it rises: the narrowest ones."""
    best = np.where(pool.disk[low, 2] < pool.disk[high, 2], low, high)
    live = np.arange(len(low))
    left, right = -pool.slope[low, 2], pool.slope[high, 2]
    for step in range(_STEPS):
        if not len(live):
            break
        share = left[live] / (left[live] + right[live])
        # Every third step halves, so that neither end stays where it is.
        share = np.full(len(live), 0.5) if step % 3 == 2 else np.clip(share, 0.01, 0.99)
        pool, good = between(region, pool, low[live], high[live], share)
        new = np.arange(len(pool.order) - len(live), len(pool.order))
        live, new = live[good], new[good]
        slope = pool.slope[new, 2]
        nearer = np.abs(slope) < np.abs(pool.slope[best[live], 2])
        best[live[nearer]] = new[nearer]
        falls = slope < 0.0
        low[live[falls]], left[live[falls]] = new[falls], -slope[falls]
        high[live[~falls]], right[live[~falls]] = new[~falls], slope[~falls]
        live = live[np.abs(slope) > _FLAT]
    return pool, best


def maximal_disk(shape: Shape, points: ArrayLike) -> MaximalDisks:
    """The largest disk inside the shape that touches its boundary at each point.

    Parameters
    ----------
    shape : Shape
    points : array_like, shape (..., 2)
        Of the boundary; others stand for the point of it that is nearest. In a corner that points
        outward the disk is a point; in one that points inward it is that in the middle of all
        directions.

    Returns
    -------
    MaximalDisks
        Exact to about 1e-14 of the size; NaN for points that are not finite.

    Examples
    --------
    >>> import splinesdf as ss
    >>> disk = ss.maximal_disk(ss.Shape.circle((0, 0), 2), [[2.0, 0.0], [0.0, 2.0]])
    >>> disk.radius.round(9).tolist()
    [2.0, 2.0]
    """
    from splinesdf.medial.kernels.covers import places
    from splinesdf.medial.kernels.disks import disks

    array = as_points(points)
    check_shape(shape)
    region, _ = leaves_in(shape)
    origin = shape.boundary.origin
    flat = array.reshape(-1, 2)
    known = np.isfinite(flat).all(axis=1)
    count = int(np.count_nonzero(known))
    element, at = np.zeros((count, 2), dtype=np.int64), np.zeros((count, 2))
    places(region.searched, region.walk, flat[known] - origin, element, at)
    # In a corner the middle direction of its fan; a corner outward has none.
    walk, loops = region.walk, region.loops
    ends = at[:, 0] >= 1.0
    first = np.where(ends, loops.after[element[:, 0]], element[:, 0])
    start = ends | (at[:, 0] <= 0.0)
    before = loops.before[first]
    fan = np.where(walk.element[first, 0] == FAN, first, before)
    inward = start & (walk.element[fan, 0] == FAN)
    element[:, 0] = np.where(inward, fan, first)
    at[:, 0] = np.where(inward, 0.5, np.where(start, 0.0, at[:, 0]))
    corner = start & ~inward & loops.corner[first]
    room = Disks(element, at, np.empty((count, 2)), np.empty(count))
    found = np.zeros(count, dtype=np.int64)
    disks(region.searched, walk, region.most, found, room)
    from splinesdf.medial.feet import points_and_normals

    own, _ = points_and_normals(walk, room.element[:, 0].copy(), room.at[:, 0].copy())
    two = (found == 1) & ~corner
    other, _ = points_and_normals(
        walk, np.where(two, room.element[:, 1], 0), np.where(two, room.at[:, 1], 0.0)
    )
    center, radius, foot = (
        np.full(shape_, np.nan) for shape_ in (flat.shape, len(flat), flat.shape)
    )
    center[known] = np.where(corner[:, None], own, room.center) + origin
    radius[known] = np.where(corner, 0.0, room.radius)
    foot[known] = np.where(two[:, None], other + origin, np.nan)
    grid = array.shape[:-1]
    return MaximalDisks(
        center.reshape(array.shape), radius.reshape(grid), foot.reshape(array.shape)
    )


def local_thickness(shape: Shape, points: ArrayLike, *, tolerance: float | None = None) -> Floats:
    """The diameter of the largest disk inside the shape that covers each point.

    Parameters
    ----------
    shape : Shape
    points : array_like, shape (..., 2)
    tolerance : float, optional
        A disk that misses a point by less covers it; 1e-3 of the larger side unless given. As the
        largest disk may change from one point to the next, its diameter is that of a point at most
        this far away.

    Returns
    -------
    ndarray, shape (...,)
        Within twice the tolerance, in that sense; 0 outside, NaN for points that are not finite.

    Raises
    ------
    AxisIncomplete
        As `medial_axis`.

    Examples
    --------
    >>> import splinesdf as ss
    >>> rectangle = ss.Shape.rectangle(0, 0, 4, 2)
    >>> ss.local_thickness(rectangle, [[2.0, 0.5], [5.0, 0.0]]).round(2).tolist()
    [2.0, 0.0]
    """
    from splinesdf.distance.exact import signed_distance
    from splinesdf.medial.kernels.covers import largest_cover

    array = as_points(points)
    tolerance = checked_tolerance(check_shape(shape), tolerance)
    axis = inside_axis(shape, 0.25 * tolerance)
    if not axis.complete:
        raise AxisIncomplete(why(shape), axis)
    if 4.0 * axis.length > _MOST * tolerance:
        raise InputError(
            f"expected a tolerance of at least {4.0 * axis.length / _MOST:.2g}, which takes "
            f"{_MOST:,} disks, got {tolerance:.2g}: raise it"
        )
    rows = [np.column_stack([axis.points, axis.radius])]
    for edge in axis.edges:
        # Disks so near to each other that what one covers the next covers within the tolerance.
        length = edge.length + (edge.largest - edge.smallest)
        count = max(2, len(edge.arcs), int(np.ceil(4.0 * length / tolerance)))
        rows.append(edge.at(np.linspace(0.0, len(edge.arcs), count)))
    disks = np.concatenate(rows)
    disks = np.ascontiguousarray(disks[np.argsort(-disks[:, 2], kind="stable")])
    flat = np.ascontiguousarray(array.reshape(-1, 2))
    inside = signed_distance(shape, flat)
    result = np.zeros(len(flat))
    largest_cover(disks, flat, tolerance, result)
    result = np.where(inside < 0.0, 2.0 * result, 0.0)
    return np.asarray(np.where(np.isnan(inside), np.nan, result).reshape(array.shape[:-1]))
