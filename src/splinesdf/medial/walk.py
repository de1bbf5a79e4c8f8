"""The boundary as the foot of a maximal disk walks along it, corners as fans of normals."""

from __future__ import annotations

import numpy as np

from splinesdf.arclets.points import derivatives_at, points_at
from splinesdf.arclets.tables import Arclets, Joints
from splinesdf.arclets.thresholds import SMOOTH
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.medial.tables import FAN, FREE, ROUND, STRAIGHT, Loops, Walk
from splinesdf.shapes.shape import Shape

# Centers of circular arcs that go on smoothly, and their radii, differ by less than this share of
# the largest coordinate: they are one circle. Larger: circles that were drawn as different ones
# lose what tells them apart; smaller: rounding in centers of short arcs makes several of one.
_ONE_CIRCLE = 1e-9
# Straight arclets are one line if the joint turns by less: rounding.
_ONE_LINE = 1e-13
# A speed below this share of the arclet's largest is that of a cusp: the curvature there is taken
# from higher derivatives.
_STANDS = 1e-9
# Curvature that grows by this factor between a hundredth and a ten thousandth of an arclet from
# its end is infinite there: it grows like the inverse of the parameter, or faster.
_GROWS = 5.0


def walk_of(shape: Shape) -> tuple[Walk, Loops]:
    """The walk around the inside of a shape."""
    boundary, joints, kinds = shape.boundary, shape.joints, shape.kinds
    order, turn = joints.order, joints.turn
    count = len(order)
    fan = turn[order] < -SMOOTH
    # The elements in order: each arclet, followed by the fan at its end.
    place = np.arange(count) + np.cumsum(fan) - fan
    total = count + int(np.count_nonzero(fan))
    owner, kind = np.empty(total, dtype=np.int64), np.full(total, FAN)
    owner[place], kind[place] = order, kinds.kind[order]
    owner[place[fan] + 1] = order[fan]
    first = np.append(place, total)[joints.loops]
    loop = np.repeat(np.arange(len(first) - 1), np.diff(first))
    after = np.arange(1, total + 1)
    after[first[1:] - 1] = first[:-1]
    before = np.empty(total, dtype=np.int64)
    before[after] = np.arange(total)
    of_arclet = np.full((count, 5), -1)
    of_arclet[owner[place], 0] = place
    of_arclet[order[fan], 2] = place[fan] + 1
    of_arclet[:, 1][joints.following] = of_arclet[:, 2]
    of_arclet[joints.following, 3], of_arclet[:, 4] = np.arange(count), joints.following
    numbers = np.zeros((total, 10))
    is_fan = kind == FAN
    numbers[:, :4] = joints.tangents[owner]
    fans = np.flatnonzero(is_fan)
    numbers[fans, :2] = joints.tangents[owner[fans], 2:]
    numbers[fans, 2:4] = joints.tangents[owner[after[fans]], :2]
    numbers[fans, 7] = turn[owner[fans]]
    corner = np.zeros(total, dtype=np.bool_)
    corner[after[place[turn[order] > SMOOTH]]] = True
    _circles(boundary, kinds.center, kind, owner, numbers)
    site = _sites(boundary, joints, kind, owner, numbers, before, first)
    ends = _curvatures(boundary, joints, kind, owner, numbers)
    numbers[:, 7] = np.where(is_fan, numbers[:, 7], ends[:, 0])
    # Of an arclet with one curvature, that; of others it is computed where it is asked for.
    numbers[:, 8] = ends[:, 1]
    numbers[:, 9] = np.maximum(ends[:, 0], np.where(corner, -np.inf, ends[before, 1]))
    element = np.ascontiguousarray(np.column_stack([kind, owner, site]))
    length = np.hypot(*(boundary.end - boundary.start)[owner].T)
    length = np.where(is_fan, np.abs(numbers[:, 7]) * shape.size, length)
    return (
        Walk(element, numbers, np.ascontiguousarray(joints.arcs), of_arclet),
        Loops(first, loop, before, after, corner, length, _euler(boundary, joints)),
    )


def _circles(boundary: Arclets, center: Floats, kind: Ints, owner: Ints, numbers: Floats) -> None:
    """Fill centers and radii of circular elements, negative where the region is outside."""
    rows = np.flatnonzero(kind == ROUND)
    arclet = owner[rows]
    middle = points_at(boundary, arclet, np.full(len(arclet), 0.5))
    numbers[rows, 4:6] = center[arclet]
    arm = center[arclet] - middle
    chord = boundary.end[arclet] - boundary.start[arclet]
    left = chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0] > 0.0
    radius = np.hypot(arm[:, 0], arm[:, 1])
    numbers[rows, 6] = np.where(left, radius, -radius)


def _sites(
    boundary: Arclets,
    joints: Joints,
    kind: Ints,
    owner: Ints,
    numbers: Floats,
    before: Ints,
    first: Ints,
) -> Ints:
    """Number what has one closed form: lines, circles, corners; and smooth runs of free pieces."""
    total = len(kind)
    largest = float(np.abs(boundary.boxes[0]).max())
    last = owner[before]
    turn = np.abs(joints.turn[last])
    same = (kind == kind[before]) & (kind != FAN) & (before != np.arange(total))
    one_piece = boundary.piece[owner] == boundary.piece[last]
    smooth = turn <= SMOOTH
    near = np.abs(numbers[:, 4:7] - numbers[before, 4:7]).max(axis=1) <= _ONE_CIRCLE * largest
    joined = (
        same
        & smooth
        & (
            (one_piece & (kind == STRAIGHT))
            | (kind == FREE)
            | ((kind == STRAIGHT) & (turn <= _ONE_LINE))
            | ((kind == ROUND) & near)
        )
    )
    return _by_loops(joined, before, first)


def _by_loops(joined: np.ndarray, before: Ints, first: Ints) -> Ints:
    """The first element of each row of joined ones, around loops."""
    site = np.arange(len(joined))
    whole = np.logical_and.reduceat(joined, first[:-1])
    joined = joined.copy()
    joined[first[:-1][whole]] = False
    jump = np.where(joined, before, site)
    for _ in range(int(np.ceil(np.log2(len(joined) + 1)))):  # each looks twice as far
        jump = jump[jump]
    return np.asarray(jump)


def _curvatures(
    boundary: Arclets, joints: Joints, kind: Ints, owner: Ints, numbers: Floats
) -> Floats:
    """Curvature of elements at start and end, positive where the region is convex: (n, 2)."""
    result = np.zeros((len(kind), 2))
    result[kind == FAN] = -np.inf
    rows = np.flatnonzero(kind == ROUND)
    result[rows] = 1.0 / numbers[rows, 6][:, None]
    rows = np.flatnonzero(kind == FREE)
    power = boundary._replace(power=_power(boundary, joints))
    for end in (0, 1):
        result[rows, end] = curvature_at(power, owner[rows], np.full(len(rows), float(end)))
    return result


def _power(boundary: Arclets, joints: Joints) -> Floats:
    """The power basis of arclets whose velocities that are rounding are zero."""
    power = boundary.power.copy()
    degree = joints.arcs[:, 0].astype(np.int64)
    for d in np.unique(degree):
        rows = np.flatnonzero(degree == d)
        power[rows, 1 : d + 1] = joints.arcs[rows, 5 : 5 + 2 * d].reshape(-1, d, 2)
    return power


def curvature_at(boundary: Arclets, arclet: Ints, t: Floats) -> Floats:
    """Curvature at parameters (n,), infinite where the curve stands still as in a cusp."""
    first, second = derivatives_at(boundary, arclet, t)
    speed = np.hypot(first[:, 0], first[:, 1])
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        result = cross / speed**3
    largest = np.abs(boundary.power[arclet, 1:]).max(axis=(1, 2), initial=0.0)
    still = np.flatnonzero(speed <= _STANDS * largest)
    if len(still):
        # Beside it: a curvature that grows toward the place is infinite there.
        values = []
        for aside in (1e-2, 1e-4):
            at = np.where(t[still] > 0.5, 1.0 - aside, aside)
            first, second = derivatives_at(boundary, arclet[still], at)
            beside = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
            with np.errstate(divide="ignore", invalid="ignore"):
                values.append(beside / np.hypot(first[:, 0], first[:, 1]) ** 3)
        far, near = values
        grows = np.abs(near) > _GROWS * np.abs(far)
        result[still] = np.where(grows, np.copysign(np.inf, near), np.where(near == near, near, 0))
    return np.asarray(result)


def _euler(boundary: Arclets, joints: Joints) -> int:
    """Components less holes: loops around the region less those around what is not of it."""
    areas = np.add.reduceat(twice_areas(boundary)[joints.order], joints.loops[:-1])
    return int(np.count_nonzero(areas > 0.0) - np.count_nonzero(areas < 0.0))


def twice_areas(boundary: Arclets) -> Floats:
    """What each arclet adds to twice the area of its loop, by Green's theorem: (n,)."""
    power = boundary.power
    degrees = np.arange(power.shape[1])
    of_both = degrees[None, :] / np.maximum(degrees[:, None] + degrees[None, :], 1)
    x, y = power[..., 0], power[..., 1]
    bulges = np.einsum("ni,ij,nj->n", x, of_both, y) - np.einsum("ni,ij,nj->n", y, of_both, x)
    start, end = boundary.start, boundary.end
    return np.asarray(bulges + start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0])
