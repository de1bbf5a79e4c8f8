"""Arclets: a boundary cut into short, nearly straight arcs under a tree of boxes and capsules.

    pieces ──split where x or y turns──> monotone ──halve while they bulge──> arclets ──halve
    the list──> tree

The distance kernel asks three things of an arclet: a capsule around it, the squared distance to
a point as a Bernstein polynomial (two multiplications a coefficient, thanks to ``gram`` and
``linear``), and points and derivatives near a parameter. The winding kernel needs only that y is
monotone, the search for crossings that directions stay within a quadrant.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.curvature import curvature_ranges, thickness
from splinesdf.arclets.tables import Arclets
from splinesdf.arclets.tree import along_z, build_hierarchy
from splinesdf.ground.arrays import Bools, Floats, Ints

# An arclet's control points stay within this share of its chord's length from the chord (about
# 45 degrees of turning). Smaller: more arclets, tighter capsules, fewer Newton steps, a deeper
# tree. It is a matter of speed only: no guarantee depends on it.
_BULGE = 0.1
# Nor does an arclet bend so fast anywhere that it would turn by more than this (radians) on its
# length: spikes and ends like cusps are cut off. Larger: curvature is known so badly beside them
# that proofs of a fit's error take long; smaller: more arclets. Again a matter of speed only.
_BENT = 2.0
# Halvings after which a piece is taken as it is. Only pieces that shrink to a point (cusps, where
# the chord vanishes as fast as the bulge) get there; the kernel is exact on them all the same.
_HALVINGS = 12
# Nor is anything cut that is smaller than this share of its piece, or, for rounding, the second one
# of the largest coordinate. Smaller: next to a cusp directions of what is cut off are rounding;
# larger: curves far from the origin are not cut, and not understood.
_SMALLEST, _LOST = 1e-8, 1e-12
# A step between control points below this share of the largest coordinate is rounding: the x of a
# straight vertical piece must not be seen to turn, nor that of an arc that ends where it turns.
# Too large: a real turn is missed, and the winding number is wrong within that share of the size
# of the curve there.
_NO_STEP = 64 * 2.220446049250313e-16


class Arcs(NamedTuple):
    """Some arcs of one degree, and where they come from."""

    # (n, degree + 1, 2) less a point of each one's piece, such as its cusp: near to that, numbers
    # are as good as they are small, and directions no rounding.
    control: Floats
    start: Floats  # (n, 2) where the first of them lies
    piece: Ints  # (n,) which piece of the shape
    interval: Floats  # (n, 2) the parameters of that piece at the arc's start and end


class Sequences(NamedTuple):
    """How arcs follow one another."""

    label: Ints  # (n,) which run the arc belongs to
    place: Ints  # (n,) its place in the run
    closed: Bools  # (n_runs,) whether the last one leads to the first one


def build_arclets(control: Floats, starts: Ints, loops: Ints) -> Arclets:
    """Cut the pieces of a shape (see `Shape`) into arclets and put the tree over them."""
    origin = 0.5 * (control.min(axis=0) + control.max(axis=0))
    largest = float(np.abs(control).max())
    degrees = np.diff(starts) - 1
    groups = []
    for degree in np.unique(degrees):
        chosen = np.flatnonzero(degrees == degree)
        arcs = control[starts[chosen][:, None] + np.arange(degree + 1)]
        interval = np.broadcast_to([0.0, 1.0], (len(arcs), 2)).copy()
        groups.append(_cut(Arcs(arcs, arcs[:, 0] - origin, chosen, interval), largest))
    piece = np.concatenate([group.piece for group in groups])
    order = np.lexsort((np.concatenate([group.interval[:, 0] for group in groups]), piece))
    place = np.empty(len(piece), dtype=np.int64)
    place[order] = np.arange(len(piece))
    label = np.searchsorted(loops, piece, side="right") - 1
    return assemble(groups, Sequences(label, place, np.ones(len(loops) - 1, dtype=bool)), origin)


def _near_slow_ends(arcs: Arcs) -> Arcs:
    """The arcs less the end at which each is slower, and has its cusp if it has one."""
    control = arcs.control
    first, last = (np.abs(control[:, a] - control[:, b]).max(axis=1) for a, b in ((0, 1), (-1, -2)))
    ends = np.where((first <= last)[:, None, None], control[:, :1], control[:, -1:])
    return arcs._replace(control=control - ends)


def assemble(groups: list[Arcs], runs: Sequences, origin: Floats) -> Arclets:
    """Tables and tree of arcs that are short and monotone already.

    Parameters
    ----------
    groups : list of Arcs
        One a degree, relative to ``origin``.
    runs : Sequences
        Of the arcs of all groups, one group after the other. Sequences that are near one another
        become neighbors in the tree.
    origin : ndarray, shape (2,)
    """
    degree = np.concatenate(
        [np.full(len(arcs.control), arcs.control.shape[1] - 1, dtype=np.int64) for arcs in groups]
    )
    start = np.concatenate([arcs.start for arcs in groups])
    end = np.concatenate([ends(arcs) for arcs in groups])
    order = np.lexsort((runs.place, _near_ones_together(start, runs.label)[runs.label]))
    label = runs.label[order]
    following = _following(label, runs.closed)
    start, end = start[order], end[order]
    end = np.where((following >= 0)[:, None], start[following], end)
    most = int(degree.max())
    padded = [_tables(arcs, most) for arcs in groups]
    power, bernstein, boxes, radius = (
        np.ascontiguousarray(np.concatenate(column)[order]) for column in zip(*padded, strict=True)
    )
    boxes[:, :2] = np.minimum(boxes[:, :2], np.minimum(start, end))
    boxes[:, 2:] = np.maximum(boxes[:, 2:], np.maximum(start, end))
    node_boxes, tree, ranges, chain = build_hierarchy(start, end, boxes, radius, label)
    return Arclets(
        origin=origin,
        start=np.ascontiguousarray(start),
        end=np.ascontiguousarray(end),
        power=power,
        piece=np.concatenate([arcs.piece for arcs in groups])[order],
        interval=np.ascontiguousarray(np.concatenate([arcs.interval for arcs in groups])[order]),
        run=label,
        following=following,
        arcs=_rows(degree[order], start, end, power, bernstein),
        tree=tree,
        boxes=node_boxes,
        range=ranges,
        chain=chain,
    )


def _rows(degree: Ints, start: Floats, end: Floats, power: Floats, bernstein: Floats) -> Floats:
    """The rows of `Arclets.arcs`."""
    most = power.shape[1] - 1
    rows = np.zeros((len(degree), 8 * (most + 1)))
    rows[:, 0], rows[:, 1:3], rows[:, 3:5] = degree, end, start
    for d in np.unique(degree):
        chosen = degree == d
        rows[chosen, 5 : 5 + 2 * d] = power[chosen, 1 : d + 1].reshape(-1, 2 * d)
        table = bernstein[chosen, :, : 2 * d + 1].reshape(-1, 3 * (2 * d + 1))
        rows[chosen, 5 + 2 * d : 5 + 2 * d + table.shape[1]] = table
    line = degree == 1
    squared = np.sum(power[line, 1] ** 2, axis=1)
    # So short that the inverse would overflow: its first point is as good as any other.
    point = squared < np.finfo(np.float64).tiny
    rows[line, 7] = np.where(point, 0.0, 1.0 / np.where(point, 1.0, squared))
    return rows


def _near_ones_together(start: Floats, label: Ints) -> Ints:
    """A rank for each run, along the Z-shaped curve through the middles of their first points."""
    count = int(label.max()) + 1
    if count == 1:
        return np.zeros(1, dtype=np.int64)
    total = np.zeros((count, 3))
    np.add.at(total, label, np.column_stack([start, np.ones(len(start))]))
    middle = total[:, :2] / total[:, 2:]
    key = along_z(middle, 16)
    rank = np.empty(count, dtype=np.int64)
    rank[np.argsort(key, kind="stable")] = np.arange(count)
    return rank


def _following(label: Ints, closed: Bools) -> Ints:
    """The arclet after each one, given the runs that they lie in, in order; -1 at an open end."""
    first = np.flatnonzero(np.diff(label, prepend=-1))
    result = np.arange(1, len(label) + 1)
    result[np.append(first[1:], len(label)) - 1] = np.where(closed[label[first]], first, -1)
    return result


def _cut(arcs: Arcs, largest: float) -> Arcs:
    """Split pieces of one degree: where x or y turns first, then until they are thin.

    ``largest`` is the largest absolute coordinate of the shape, in its own system.
    """
    if arcs.control.shape[1] == 2:
        return arcs
    noise = _NO_STEP * float(np.maximum(np.abs(arcs.start), np.abs(ends(arcs))).max())
    own = np.zeros(int(arcs.piece.max()) + 1)
    own[arcs.piece] = np.ptp(arcs.control, axis=1).max(axis=1)
    arcs = _near_slow_ends(arcs)
    for axis in (0, 1):
        arcs = _split_turns(arcs, axis, noise)
    # Two turns in one place, as in a cusp, leave a part between them that is all rounding.
    whole = (arcs.interval[:, 0] == 0.0) & (arcs.interval[:, 1] == 1.0)
    arcs = _take(arcs, whole | (np.ptp(arcs.control, axis=1).max(axis=1) > noise))
    # A cusp inside a piece is an end by now.
    arcs = _near_slow_ends(arcs)
    done = []
    for _ in range(_HALVINGS):
        size = np.ptp(arcs.control, axis=1).max(axis=1)
        thick = (_bulge(arcs.control) > _BULGE) | (_most_bent(arcs.control) > _BENT)
        thick &= size > np.maximum(_SMALLEST * own[arcs.piece], _LOST * largest)
        done.append(_take(arcs, ~thick))
        arcs = split(_take(arcs, thick), 0.5)
        if len(arcs.control) == 0:
            break
    return _join([*done, arcs])


def _split_turns(arcs: Arcs, axis: int, noise: float) -> Arcs:
    """Split so that one coordinate is monotone along every arc."""
    done = []
    while True:  # halving halves the steps, too: about as often as a number has bits, all are noise
        steps = np.diff(arcs.control[:, :, axis], axis=1)
        steps[np.abs(steps) <= noise] = 0.0
        turns = _sign_changes(steps)
        done.append(_take(arcs, turns == 0))
        if np.any(turns == 1):
            whole = _take(arcs, turns == 1)
            halves = split(whole, _turn(steps[turns == 1]))
            # A turn beside an end, where a formula's pieces begin, is rounding in where it is: the
            # coordinate does not change between them, and the speck would have no direction.
            change = np.ptp(halves.control[:, :, axis], axis=1).reshape(2, -1)
            clear = (change > noise).all(axis=0)
            done.append(_take(whole, ~clear))
            done.append(_take(halves, np.tile(clear, 2)))
        arcs = split(_take(arcs, turns > 1), 0.5)
        if len(arcs.control) == 0:
            return _join(done)


def _take(arcs: Arcs, chosen: Bools) -> Arcs:
    control, start, piece, interval = arcs
    return Arcs(control[chosen], start[chosen], piece[chosen], interval[chosen])


def _join(parts: list[Arcs]) -> Arcs:
    return Arcs(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def split(arcs: Arcs, at: float | Floats) -> Arcs:
    """Both parts of every arc, all first parts before all second ones, cut at a parameter."""
    if len(arcs.control) == 0:
        return arcs
    t = np.broadcast_to(at, len(arcs.control))
    middle = arcs.interval[:, 0] + t * (arcs.interval[:, 1] - arcs.interval[:, 0])
    first, second = np.empty_like(arcs.control), np.empty_like(arcs.control)
    points = arcs.control
    last = points.shape[1] - 1
    for k in range(last + 1):  # de Casteljau
        first[:, k] = points[:, 0]
        second[:, last - k] = points[:, -1]
        points = (1.0 - t)[:, None, None] * points[:, :-1] + t[:, None, None] * points[:, 1:]
    between = arcs.start + (second[:, 0] - first[:, 0])
    return Arcs(
        np.concatenate([first, second]),
        np.concatenate([arcs.start, between]),
        np.concatenate([arcs.piece, arcs.piece]),
        np.concatenate(
            [
                np.column_stack([arcs.interval[:, 0], middle]),
                np.column_stack([middle, arcs.interval[:, 1]]),
            ]
        ),
    )


def ends(arcs: Arcs) -> Floats:
    """Where the last control points lie: (n, 2)."""
    return np.asarray(arcs.start + (arcs.control[:, -1] - arcs.control[:, 0]))


def _turn(slope: Floats) -> Floats:
    """The root of Bernstein polynomials with exactly one sign change, by bisection."""
    low, high = np.zeros(len(slope)), np.ones(len(slope))
    rising = _first_sign(slope) < 0
    for _ in range(54):
        middle = 0.5 * (low + high)
        values = slope
        t = middle[:, None]
        while values.shape[1] > 1:
            values = (1.0 - t) * values[:, :-1] + t * values[:, 1:]
        before = (values[:, 0] < 0) == rising
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return 0.5 * (low + high)


def _first_sign(values: Floats) -> Floats:
    signs = np.sign(values)
    first = np.argmax(signs != 0, axis=1)
    return np.asarray(signs[np.arange(len(values)), first])


def _sign_changes(values: Floats) -> Ints:
    """Sign changes along axis 1, zeros passed over."""
    count = np.zeros(len(values), dtype=np.int64)
    last = np.zeros(len(values))
    for column in np.sign(values).T:
        count += (column * last) < 0
        last = np.where(column != 0, column, last)
    return count


def _bulge(arcs: Floats) -> Floats:
    """Largest distance of a control point from the chord's segment, as a share of the chord."""
    chord = arcs[:, -1] - arcs[:, 0]
    length = np.hypot(chord[:, 0], chord[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = thickness(arcs) / length
    return np.where(length > 0.0, ratio, np.inf)


def _most_bent(arcs: Floats) -> Floats:
    """The largest curvature times the length of the chord."""
    low, high, _ = curvature_ranges(arcs)
    chord = arcs[:, -1] - arcs[:, 0]
    length = np.hypot(chord[:, 0], chord[:, 1])
    # One that comes back to its start is bent, however long: infinite times zero is no number.
    return np.where(length > 0.0, np.maximum(high, -low), np.inf) * np.where(
        length > 0.0, length, 1.0
    )


def _tables(arcs: Arcs, most: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Power basis, Bernstein coefficients (n, 3, 2 most + 1), boxes, thickness; padded."""
    count, d = len(arcs.control), arcs.control.shape[1] - 1
    local = arcs.control - arcs.control[:, :1]
    power = np.zeros((count, most + 1, 2))
    for k in range(1, d + 1):
        # forward differences: the k-th power coefficient is binom(d, k) times the k-th of them
        power[:, k] = math.comb(d, k) * np.diff(local, n=k, axis=1)[:, 0]
    bernstein = np.zeros((count, 3, 2 * most + 1))
    for k in range(2 * d + 1):
        for i in range(max(0, k - d), min(d, k) + 1):
            weight = math.comb(d, i) * math.comb(d, k - i) / math.comb(2 * d, k)
            bernstein[:, :2, k] += weight * local[:, i]
            bernstein[:, 2, k] += weight * np.sum(local[:, i] * local[:, k - i], axis=1)
    boxes = np.tile(arcs.start, 2)
    boxes += np.concatenate([local.min(axis=1), local.max(axis=1)], axis=1)
    return power, bernstein, boxes, thickness(local)
