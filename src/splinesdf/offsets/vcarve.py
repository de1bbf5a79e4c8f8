"""V-carving: paths of a V-shaped bit along the medial axis, as deep as the shape is wide there.

medial axis ─┬─ narrower than the bit at its depth ──> grooves ──┐
             └─ wider ──> the level set of that width ───────────┴──> tours ──depth──> passes

The largest disks of a shape cover it, and max(r - |x - c|) over their centers c is the distance to
the boundary at x. So a cone that follows the axis at the depth r / tan(angle / 2) leaves a surface
that is as deep as the distance says, everywhere: `signed_distance` is the carved surface.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from splinesdf.contours.carve import Carve
from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, finite, positive
from splinesdf.medial.axis import MedialAxis
from splinesdf.medial.tracing import checked_tolerance, medial_axis
from splinesdf.offsets.grooves import Groove, grooves
from splinesdf.offsets.offset import offset
from splinesdf.offsets.tours import Way, tours, without_repeats
from splinesdf.shapes.shape import Shape, check_shape

# Shares of the tolerance, in the plane: for the axis, which is off in the plane and in r and
# lowered by as much; for branches that are left out; for chords, which are off and lowered by as
# much; and for the level set, which is this much farther inside. Together with what these cost
# twice they are below 1: 3 _AXIS + _PRUNED + 2 _CHORD + _LEVEL.
_AXIS, _PRUNED, _CHORD, _LEVEL = 0.0625, 0.125, 0.125, 0.4
# Fitted edges are off by the axis' tolerance in the plane and in r: the square root of 2, and some.
_BOTH = 1.5
# Radii that differ by this share of the largest are the same.
_ROUNDING = 1e-12
# More passes are a slip of a unit.
_MOST_PASSES = 1000


def vcarve(
    shape: Shape,
    angle: float = 60.0,
    depth: float | None = None,
    *,
    step_down: float | None = None,
    tip: float = 0.0,
    allowance: float = 0.0,
    tolerance: float | None = None,
) -> Carve:
    """Paths of a V-shaped bit that carves a shape up to its boundary.

    Parameters
    ----------
    shape : Shape
        What is carved away; the surface is at z = 0.
    angle : float
        Of the bit, from side to side, in degrees.
    depth : float, optional
        The most to carve: wider parts get a flat ground there, to be cleared by another tool along
        ``flat``. Default: as deep as the bit goes.
    step_down : float, optional
        The most to carve at once, in passes. Default: all.
    tip : float
        The diameter of the bit's flat end. Where the shape is narrower, nothing is carved.
    allowance : float
        What is left along the boundary, measured at the surface.
    tolerance : float, optional
        How far the carved surface may be above the exact one, in depth and across; 1e-3 of the
        shape's larger side unless given.

    Returns
    -------
    Carve
        Its surface is at the depth ``(distance to the boundary - allowance) / tan(angle / 2)``, at
        ``depth`` at most: nowhere deeper, but for rounding, and nowhere higher by more than the
        tolerance, but on the ground around ``flat``, and under a flat tip. Each connected part is
        carved without a lift, on ways that are carved already.

    Raises
    ------
    InputError
        If an argument cannot be used, or the tip fits nowhere.
    AxisIncomplete
        If the medial axis is not proved to be complete, see `medial_axis`.

    Examples
    --------
    >>> import splinesdf as ss
    >>> sign = ss.vcarve(ss.Shape.rectangle(0, 0, 40, 20), angle=90, depth=4)
    >>> sign.lifts, sign.deepest, [round(contour.area, 6) for contour in sign.flat]
    (1, 4.0, [384.0])
    >>> ss.write("sign.nc", sign, milling=ss.Milling(feed=600, spindle_speed=18000))
    """
    width = checked_tolerance(check_shape(shape), tolerance)
    if not 0.0 < finite(angle, "angle") < 180.0:
        raise InputError(f"expected an angle between 0 and 180 degrees, got {angle:g}")
    for name, value in (("tip", tip), ("allowance", allowance)):
        if finite(value, name) < 0.0:
            raise InputError(f"expected {name} of at least 0, got {value:g}")
    for name, given in (("depth", depth), ("step down", step_down)):
        if given is not None:
            positive(given, name)
    slope = 1.0 / math.tan(math.radians(0.5 * angle))
    bit = _Bit(slope, depth, 0.5 * tip + allowance, width * min(1.0, 1.0 / slope))
    axis = medial_axis(shape, _AXIS * bit.tolerance, prune=_PRUNED * bit.tolerance)
    paths = _paths(shape, axis, bit)
    if not paths:
        raise InputError(
            "expected a shape that the bit fits into, got one in which it fits nowhere: take a "
            f"smaller tip or allowance than {tip:g} and {allowance:g}"
        )
    flat: Sequence[Contour] = ()
    if depth is not None and bit.widest < float(axis.radius.max(initial=0.0)):
        flat = offset(shape, -bit.widest, tolerance=bit.tolerance, coarse=True)
    return Carve(
        tuple(_in_order([_in_passes(path, step_down) for path in paths])),
        tuple(flat),
        float(angle),
        None if depth is None else float(depth),
        float(tip),
        float(allowance),
        width,
        shape.name,
        shape.y_down,
        shape.unit,
        shape.page,
    )


class _Bit(NamedTuple):
    slope: float
    depth: float | None
    least: float  # the radius at the surface where it begins to carve
    tolerance: float  # in the plane

    @property
    def widest(self) -> float:
        """The distance from which on the ground is flat."""
        return math.inf if self.depth is None else self.depth / self.slope + self.least

    def heights(self, radii: Floats) -> Floats:
        """Heights where the surface may be as wide as these radii."""
        z = -self.slope * np.maximum(radii - self.least, 0.0) + 0.0
        return np.asarray(z if self.depth is None else np.maximum(z, -self.depth))

    def along(self, disks: Floats) -> Floats:
        """A polyline of disks (x, y, r) as one of x, y, z, with a point where z becomes 0.

        Without it the last chord before a corner would be too deep: lowered, but not at its end.
        """
        over = disks[:, 2] - self.least
        # What is 0 but for rounding of the radii needs none.
        side = np.sign(np.where(np.abs(over) <= _ROUNDING * disks[:, 2].max(), 0.0, over))
        before = np.flatnonzero(side[:-1] * side[1:] < 0.0)
        share = over[before] / (over[before] - over[before + 1])
        between = disks[before] + share[:, None] * (disks[before + 1] - disks[before])
        between[:, 2] = self.least
        every = np.insert(disks, before + 1, between, axis=0)
        return np.column_stack([every[:, :2], self.heights(every[:, 2])])


def _paths(shape: Shape, axis: MedialAxis, bit: _Bit) -> list[Floats]:
    """Tours along grooves and level sets, each of its whole depth."""
    level = bit.widest + _LEVEL * bit.tolerance
    found = grooves(
        axis.edges,
        bit.least,
        level,
        _CHORD * bit.tolerance,
        _BOTH * axis.tolerance,
    )
    rings: list[Floats] = []
    if bit.depth is not None:
        quarter = 0.25 * (_LEVEL - _CHORD - _BOTH * _AXIS) * bit.tolerance
        contours = offset(shape, -level, tolerance=quarter, coarse=True)
        rings = [contour.points(quarter) for contour in contours]
        rings = [np.append(ring, ring[:1], axis=0) for ring in rings]
    ways = _ways(axis, found, rings, level, bit)
    result = tours(ways)
    for vertex in np.flatnonzero(axis.degree == 0):
        radius = float(axis.radius[vertex])
        if bit.least <= radius <= level:
            z = bit.heights(axis.radius[vertex : vertex + 1])
            result.append(np.array([[*axis.points[vertex], z[0]]]))
    return result


def _ways(
    axis: MedialAxis, found: Sequence[Groove], rings: Sequence[Floats], level: float, bit: _Bit
) -> list[Way]:
    """Grooves and level sets as edges of one graph, as deep as the bit goes there."""
    # How far a groove's end may be moved to a corner of the level set, and be lowered for it.
    room = 0.25 * (_LEVEL - _CHORD - _BOTH * _AXIS) * bit.tolerance
    low = [groove.low.copy() for groove in found]
    points = [groove.points.copy() for groove in found]
    count = len(axis.radius)
    corners = np.concatenate([ring[:-1] for ring in rings]) if rings else np.empty((0, 2))
    free: list[tuple[int, int]] = []  # groove, end: not at a vertex
    for k, groove in enumerate(found):
        for end in (0, -1):
            if groove.ends[end] >= 0:
                continue
            free.append((k, end))
            here = groove.points[end]
            if not len(corners) or abs(here[2] - level) > room:
                continue
            apart = np.hypot(*(corners - here[:2]).T)
            nearest = int(np.argmin(apart))
            if apart[nearest] <= room:
                points[k][end, :2] = corners[nearest]
                beside = 1 if end == 0 else -2
                low[k][[end, beside]] += apart[nearest]
    # As low at a vertex as the lowest of its grooves.
    lowest = np.zeros(count)
    for k, groove in enumerate(found):
        for end in (0, -1):
            if groove.ends[end] >= 0:
                vertex = groove.ends[end]
                lowest[vertex] = max(lowest[vertex], low[k][end])
    places = np.array([points[k][end, :2] for k, end in free]).reshape(-1, 2)
    _, same = np.unique(np.concatenate([places, corners]) + 0.0, axis=0, return_inverse=True)
    numbers = count + same.reshape(-1)
    at = {one: int(numbers[i]) for i, one in enumerate(free)}
    ways = []
    for k, groove in enumerate(found):
        ends = []
        for end in (0, -1):
            vertex = groove.ends[end]
            if vertex >= 0:
                low[k][end] = lowest[vertex]
            ends.append(vertex if vertex >= 0 else at[k, end])
        lowered = points[k] - low[k][:, None] * [0.0, 0.0, 1.0]
        ways.append(Way(ends[0], ends[1], bit.along(lowered)))
    joined, after = set(at.values()), len(free)
    for ring in rings:
        own = numbers[after : after + len(ring) - 1].tolist()
        after += len(own)
        ways += _along(ring, own, joined, -(bit.depth or 0.0))
    return ways


def _along(ring: Floats, numbers: list[int], joined: set[int], z: float) -> list[Way]:
    """A closed polyline as edges between the points at which grooves end."""
    stops = [i for i, number in enumerate(numbers) if number in joined] or [0]
    result = []
    closed = np.column_stack([ring, np.full(len(ring), z)])[:-1]
    for i, stop in enumerate(stops):
        until = stops[i + 1] if i + 1 < len(stops) else stops[0] + len(numbers)
        rows = np.arange(stop, until + 1) % len(numbers)
        result.append(Way(numbers[stop], numbers[until % len(numbers)], closed[rows]))
    return result


def _in_passes(path: Floats, step_down: float | None) -> Floats:
    """The path again and again, there and back, each time deeper by a step."""
    deepest = -float(path[:, 2].min())
    if step_down is None or deepest <= step_down:
        return path
    if deepest > _MOST_PASSES * step_down:
        raise InputError(
            f"expected at most {_MOST_PASSES} passes, got a depth of {deepest:g} and "
            f"{step_down:g} a pass: check the units"
        )
    count = math.ceil(deepest / step_down - 1e-9)
    passes = []
    for k in range(1, count + 1):
        low = path[:, 2] if k == count else np.maximum(path[:, 2], -step_down * k)
        one = np.column_stack([path[:, :2], low])
        passes.append(one if k % 2 else one[::-1])
    return without_repeats(np.concatenate(passes))


def _in_order(paths: list[Floats]) -> list[Floats]:
    """Each path after the one that ends nearest to its start; first that at the lower left."""
    result: list[Floats] = []
    left = dict(enumerate(paths))
    starts = np.array([path[0, :2] for path in paths])
    here = starts.min(axis=0)
    while left:
        open_ = np.array(list(left))
        nearest = int(open_[np.argmin(np.hypot(*(starts[open_] - here).T))])
        result.append(left.pop(nearest))
        here = result[-1][-1, :2]
    return result
