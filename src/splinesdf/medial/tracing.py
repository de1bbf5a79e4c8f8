"""The medial axis of a shape, from its boundary.

walk along the boundary ─→ ends, proved ─→ maximal disks ─→ chords ─→ faces ─→ vertices
     ─→ edges, exact or fitted ─→ counted and checked ─→ pruned

Chords of maximal disks do not cross, and what they leave between them is the graph. Its ends are
known beforehand and its loops are the holes of the shape, so that a count proves that nothing is
missing.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from splinesdf.errors import AxisIncomplete, InputError
from splinesdf.ground.arrays import Bools, Floats, Ints, finite, positive, shown
from splinesdf.medial.axis import MedialAxis
from splinesdf.medial.chords import Region, chords_at, region_of, seeds
from splinesdf.medial.curves import Curves, curves_of
from splinesdf.medial.edge import AxisEdge
from splinesdf.medial.faces import NEAR, Look, leaves_with_empty_disks, traced
from splinesdf.medial.graph import Chains, Corners, chains_of, corners_of
from splinesdf.medial.leaves import leaves_of
from splinesdf.medial.tables import ARC, BEND_LEAF, CORNER, CUSP_LEAF, WHOLE, Leaves
from splinesdf.medial.walk import walk_of
from splinesdf.meshes.mesh import Box, check_domain
from splinesdf.shapes.shape import Shape, check_shape

Side = Literal["inside", "outside"]

# The default tolerance, as a share of the larger side: what a picture shows.
_OF_SIZE = 1e-3
# The least tolerance, as a share of the larger side: disks are known to about 1e-15 of it.
_LEAST = 1e-11
# How much disks may differ that are one vertex where all else fails, as a share of what is pruned;
# and of the size, if nothing is.
_SPREAD, _NO_SPREAD = 0.125, 1e-11
_KINDS = {CORNER: "corner", BEND_LEAF: "end", ARC: "end", CUSP_LEAF: "cusp", WHOLE: "isolated"}


def medial_axis(
    shape: Shape,
    tolerance: float | None = None,
    *,
    side: Side = "inside",
    prune: float | None = None,
    corners: bool = True,
    domain: Box | None = None,
) -> MedialAxis:
    """All centers of largest disks in a shape, as a graph of curves with radii.

    Parameters
    ----------
    shape : Shape
    tolerance : float, optional
        How far edges may be off, in x, y and r; 1e-3 of the larger side unless given. Edges
        between lines, circles and corners are exact, to about 1e-12 of the size.
    side : {"inside", "outside"}
        Outside, the axis is that of what the shape leaves of the domain, without the branches whose
        disks touch the border of the domain.
    prune : float, optional
        The height below which branches are left out, see `MedialAxis.pruned`; the tolerance unless
        given, as a shape within the tolerance may lack them. 0 keeps all.
    corners : bool
        If false, branches that end in corners are left out up to the first junction.
    domain : (xmin, ymin, xmax, ymax), optional
        Of the outside. The box grown by its size on all sides unless given.

    Returns
    -------
    MedialAxis
        Complete: its ends before pruning are exactly the corners and the maxima of curvature with
        an empty disk of curvature, each proved, and it has the components and loops of the region.
        At every vertex and at the ends of all arcs the feet are equally far, and the disk is empty,
        to about 1e-12 of the size.

    Raises
    ------
    AxisIncomplete
        If the count or a check fails: what was found is in ``.result``, and is not to be trusted.
    InputError
        If the shape fills nothing, or an argument cannot be used.

    Examples
    --------
    >>> import splinesdf as ss
    >>> axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 4, 2))
    >>> axis
    <MedialAxis rectangle: 6 vertices, 5 edges, complete>
    >>> float(axis.radius.max()), len(ss.medial_axis(ss.example("part"), side="outside").edges) > 0
    (1.0, True)
    """
    tolerance = checked_tolerance(check_shape(shape), tolerance)
    height = tolerance if prune is None else finite(prune, "prune")
    if height < 0.0:
        raise InputError(f"expected prune of at least 0, got {height:g}")
    if side not in ("inside", "outside"):
        raise InputError(f'expected side "inside" or "outside", got {shown(side)}')
    if side == "inside":
        if domain is not None:
            raise InputError('expected domain with side="outside" only: inside there is the shape')
        found = _axis_of(shape, tolerance, height, None)
    else:
        found = _outside(shape, tolerance, height, domain)
    if not found.complete:
        raise AxisIncomplete(why(shape), found)
    return found.pruned(height, corners=corners) if height > 0.0 or not corners else found


def checked_tolerance(shape: Shape, tolerance: float | None) -> float:
    """The tolerance, or the default; an `InputError` below the rounding of disks."""
    if tolerance is None:
        return _OF_SIZE * shape.size
    tolerance = positive(tolerance, "tolerance")
    if tolerance < _LEAST * shape.size:
        raise InputError(
            f"expected a tolerance of at least {_LEAST * shape.size:.2g}, rounding at this size, "
            f"got {tolerance:.2g}: raise it"
        )
    return tolerance


def why(shape: Shape) -> str:
    """What to say of an axis that is not complete."""
    name = f" of {shape.name}" if shape.name else ""
    return (
        f"the medial axis{name} could not be completed: the count of ends and loops does not hold, "
        "or a disk is not empty; raise prune, or mend places where contours nearly touch"
    )


def _outside(shape: Shape, tolerance: float, height: float, domain: Box | None) -> MedialAxis:
    """The axis of what a shape leaves of a domain, less what belongs to the domain's border."""
    rest, box = around(shape, domain)
    return _axis_of(rest, tolerance, height, np.array(box))


def around(shape: Shape, domain: Box | None) -> tuple[Shape, Box]:
    """What a shape leaves of a domain, and the domain: its box grown by its size unless given."""
    xmin, ymin, xmax, ymax = shape.box
    margin = shape.size
    box = (
        (xmin - margin, ymin - margin, xmax + margin, ymax + margin)
        if domain is None
        else check_domain(domain)
    )
    if not (box[0] < xmin and box[1] < ymin and xmax < box[2] and ymax < box[3]):
        raise InputError(
            f"expected a domain around the shape's box {tuple(map(float, shape.box))}, got {box}"
        )
    frame = Shape.rectangle(*box)
    rest = replace(frame, y_down=shape.y_down, limits=shape.limits).difference(shape)
    return replace(rest, name=shape.name, unit=shape.unit, page=shape.page), box


def inside_axis(shape: Shape, tolerance: float) -> MedialAxis:
    """The axis of the inside, not pruned, perhaps incomplete."""
    return _axis_of(shape, tolerance, tolerance, None)


def _axis_of(shape: Shape, tolerance: float, height: float, frame: Floats | None) -> MedialAxis:
    """The axis of the inside of a shape, not pruned; without the disks that touch a frame."""
    look, corners, chains = graph_of(shape, height)
    curves = curves_of(look.region, chains, tolerance)
    complete = is_complete(look, corners, chains) and curves.failed == 0
    return _assembled(look, corners, chains, curves, tolerance, complete, frame)


def graph_of(shape: Shape, height: float) -> tuple[Look, Corners, Chains]:
    """Faces, vertices and chains of disks of the inside of a shape."""
    region, leaves = leaves_in(shape)
    spread = _SPREAD * height if height > 0.0 else _NO_SPREAD * region.size
    look = traced(region, leaves, chords_at(region, *seeds(region)), spread)
    corners = corners_of(look)
    return look, corners, chains_of(look, corners)


def is_complete(look: Look, corners: Corners, chains: Chains) -> bool:
    """Whether the count holds, and all disks are empty."""
    return _counted(look, chains, corners) and _checked(look.region, corners, chains)


def leaves_in(shape: Shape) -> tuple[Region, Leaves]:
    """The tables of a shape, and where its axis ends."""
    walk, loops = walk_of(shape)
    region = region_of(shape, walk, loops)
    return region, leaves_with_empty_disks(region, leaves_of(shape.boundary, walk, loops))


def _counted(look: Look, chains: Chains, corners: Corners) -> bool:
    """Whether faces, chords, ends and loops are as many as they must be."""
    if look.unclear or look.bare or look.euler != look.region.loops.euler:
        return False
    # An end that is none of those known beforehand is the sign of another that is missing.
    ends = np.bincount(chains.ends[chains.ends >= 0], minlength=len(corners.leaf))
    if ((ends == 1) & (corners.leaf < 0)).any():
        return False
    open_ = chains.ends[:, 0] >= 0
    if (open_ != (chains.ends[:, 1] >= 0)).any():
        return False
    # A closed chain of one or two disks says nothing about what is between.
    closed = chains.ends[:, 0] < 0
    if (np.diff(chains.first)[closed] < 4).any():
        return False
    # Components less loops, of the graph.
    return bool(len(corners.radius) - np.count_nonzero(open_) == look.region.loops.euler)


def _checked(region: Region, corners: Corners, chains: Chains) -> bool:
    """Whether disks are empty and touch the boundary, at all vertices and ends of arcs."""
    from splinesdf.medial.kernels.disks import distances

    exact = corners.spread == 0.0
    disks = np.concatenate(
        [np.column_stack([corners.center, corners.radius])[exact], chains.nodes.disk]
    )
    far = np.empty(len(disks))
    distances(region.searched, np.ascontiguousarray(disks[:, :2]), far)
    off = np.abs(far - disks[:, 2])
    spread = float(corners.spread.max(initial=0.0))
    allowed = np.full(len(disks), NEAR * region.size)
    # Chains end in vertices, of which some may stand for several disks.
    allowed[np.count_nonzero(exact) :] += spread
    return bool((off <= allowed).all())


def _assembled(
    look: Look,
    corners: Corners,
    chains: Chains,
    curves: Curves,
    tolerance: float,
    complete: bool,
    frame: Floats | None,
) -> MedialAxis:
    """The result, in the coordinates of the shape."""
    region = look.region
    origin = region.shape.boundary.origin
    arcs = curves.arcs.copy()
    arcs[..., :2] += origin
    feet = curves.feet + origin
    bounds = np.searchsorted(curves.edge, np.arange(len(chains.ends) + 1))
    kinds = [
        _KINDS[int(look.leaves.kind[leaf])] if leaf >= 0 else "junction"
        for leaf in corners.leaf.tolist()
    ]
    number = np.arange(len(kinds))
    chosen: Bools = np.ones(len(chains.ends), dtype=np.bool_)
    if frame is not None:
        chosen, number, kinds = without_frame(region, chains, kinds, frame - np.tile(origin, 2))
    edges = []
    for j in np.flatnonzero(chosen).tolist():
        a, b = int(bounds[j]), int(bounds[j + 1])
        start, end = (int(number[v]) if v >= 0 else -1 for v in chains.ends[j])
        edges.append(
            AxisEdge(
                start,
                end,
                arcs[a:b],
                curves.weights[a:b],
                np.concatenate([feet[a:b, 0], feet[b - 1 : b, 1]]),
                curves.exact[a:b],
            )
        )
    kept: Bools = np.asarray(number >= 0)
    return MedialAxis(
        points=corners.center[kept] + origin,
        radius=corners.radius[kept],
        kind=tuple(kind for kind, keep in zip(kinds, kept.tolist(), strict=True) if keep),
        edges=tuple(edges),
        tolerance=tolerance,
        error=max(curves.error, float(corners.spread.max(initial=0.0))),
        complete=complete,
        name=region.shape.name,
        y_down=region.shape.y_down,
        unit=region.shape.unit,
        page=region.shape.page,
    )


def without_frame(
    region: Region, chains: Chains, kinds: list[str], frame: Floats
) -> tuple[Bools, Ints, list[str]]:
    """Which edges have no foot on a frame; the new numbers of vertices, -1 for none; kinds."""
    boundary, loops = region.shape.boundary, region.loops
    near = 1e-9 * region.size
    on_frame = np.zeros(len(loops.first) - 1, dtype=np.bool_)
    first = region.walk.element[loops.first[:-1], 1]
    for side in range(4):
        line = np.abs(boundary.start[first, side % 2] - frame[side]) <= near
        line &= np.abs(boundary.end[first, side % 2] - frame[side]) <= near
        on_frame |= line
    element = chains.nodes.element[chains.first[:-1]]
    chosen: Bools = np.asarray(~on_frame[loops.loop[element]].any(axis=1))
    count = len(kinds)
    some, all_ = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
    for ends, keep in zip(chains.ends.tolist(), chosen.tolist(), strict=True):
        for vertex in ends:
            if vertex >= 0:
                all_[vertex] += 1
                some[vertex] += keep
    kept: Bools = np.asarray((some > 0) | (all_ == 0))
    kinds = ["cut" if 0 < some[v] < all_[v] else kind for v, kind in enumerate(kinds)]
    return chosen, np.where(kept, np.cumsum(kept) - 1, -1), kinds
