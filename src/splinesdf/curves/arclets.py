"""Arclets: a boundary cut into short, nearly straight arcs under a tree of boxes.

    pieces ──split where y turns──> y-monotone ──halve while they bulge──> arclets ──halve the
    list──> tree

The distance kernel asks three things of an arclet: a box, the squared distance to a point as a
Bernstein polynomial (two multiplications a coefficient, thanks to ``gram`` and ``linear``), and
points and derivatives near a parameter. The winding kernel needs only that y is monotone.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf._arrays import Bools, Floats, Ints
from splinesdf._tables import Arclets

# An arclet's control points stay within this share of its chord's length from the chord (about
# 45 degrees of turning). Smaller: more arclets, tighter boxes, fewer Newton steps, a deeper tree.
# It is a matter of speed only: no guarantee depends on it.
_BULGE = 0.1
# Halvings after which a piece is taken as it is. Only pieces that shrink to a point (cusps, where
# the chord vanishes as fast as the bulge) get there; the kernel is exact on them all the same.
_HALVINGS = 12
# Halvings to bracket each turn of y; two turns closer than 2^-40 of a piece are one, to rounding.
_TURN_HALVINGS = 40


def build_arclets(control: Floats, starts: Ints, loops: Ints) -> Arclets:
    """Cut the pieces of a shape (see `Shape`) into arclets and put the tree of boxes over them."""
    corners = control[starts[:-1]]
    low, high = control.min(axis=0), control.max(axis=0)
    origin = 0.5 * (low + high)
    degrees = np.diff(starts) - 1
    parts = []
    for degree in np.unique(degrees):
        chosen = np.flatnonzero(degrees == degree)
        arcs = control[starts[chosen][:, None] + np.arange(degree + 1)] - origin
        parts.append((int(degree), *_cut(arcs, chosen)))
    order = np.lexsort(
        (
            np.concatenate([interval[:, 0] for *_, interval in parts]),
            np.concatenate([piece for _, _, piece, _ in parts]),
        )
    )
    degree = np.concatenate([np.full(len(arcs), d, dtype=np.int64) for d, arcs, _, _ in parts])
    piece = np.concatenate([piece for _, _, piece, _ in parts])[order]
    interval = np.concatenate([interval for *_, interval in parts])[order]
    most = int(degree.max())
    padded = [_tables(arcs, d, most) for d, arcs, _, _ in parts]
    power, gram, linear, boxes = (
        np.ascontiguousarray(np.concatenate(column)[order]) for column in zip(*padded, strict=True)
    )
    start = np.concatenate([arcs[:, 0] for _, arcs, _, _ in parts])[order]
    # Where a piece begins, take the piece's own first point: the cut must not move it by an ulp.
    fresh = interval[:, 0] == 0.0
    start[fresh] = corners[piece[fresh]] - origin
    loop = np.searchsorted(loops, piece, side="right") - 1
    end = start[following_in_loop(loop)]
    boxes[:, :2] = np.minimum(boxes[:, :2], np.minimum(start, end))
    boxes[:, 2:] = np.maximum(boxes[:, 2:], np.maximum(start, end))
    tree_boxes, tree_range, chain = _tree(boxes, loop)
    return Arclets(
        origin=origin,
        degree=degree[order],
        start=np.ascontiguousarray(start),
        end=np.ascontiguousarray(end),
        power=power,
        gram=gram,
        linear=linear,
        piece=piece,
        interval=np.ascontiguousarray(interval),
        boxes=tree_boxes,
        range=tree_range,
        chain=chain,
    )


def following_in_loop(loop: Ints) -> Ints:
    """The arclet after each one, given each one's loop, in order; the last one's is the first."""
    first = np.flatnonzero(np.diff(loop, prepend=-1))
    result = np.arange(1, len(loop) + 1)
    result[np.append(first[1:], len(loop)) - 1] = first
    return result


def _cut(arcs: Floats, piece: Ints) -> tuple[Floats, Ints, Floats]:
    """Split pieces of one degree: y-monotone first, then thin. Returns arcs, piece, interval."""
    interval = np.broadcast_to([0.0, 1.0], (len(arcs), 2)).copy()
    if arcs.shape[1] == 2:
        return arcs, piece, interval
    done = []
    todo = (arcs, piece, interval)
    for _ in range(_TURN_HALVINGS):
        turns = _sign_changes(np.diff(todo[0][:, :, 1], axis=1))
        done.append(_take(todo, turns == 0))
        done.append(_split(_take(todo, turns == 1), None))
        todo = _split(_take(todo, turns > 1), 0.5)
        if len(todo[0]) == 0:
            break
    done.append(todo)
    todo = _join(done)
    done = []
    for _ in range(_HALVINGS):
        thick = _bulge(todo[0]) > _BULGE
        done.append(_take(todo, ~thick))
        todo = _split(_take(todo, thick), 0.5)
        if len(todo[0]) == 0:
            break
    done.append(todo)
    return _join(done)


Cut = tuple[Floats, Ints, Floats]


def _take(cut: Cut, chosen: Bools) -> Cut:
    return cut[0][chosen], cut[1][chosen], cut[2][chosen]


def _join(cuts: list[Cut]) -> Cut:
    return (
        np.concatenate([c[0] for c in cuts]),
        np.concatenate([c[1] for c in cuts]),
        np.concatenate([c[2] for c in cuts]),
    )


def _split(cut: Cut, at: float | None) -> Cut:
    """Both parts of every arc, cut at the parameter ``at``, or where y turns if that is None."""
    arcs, piece, interval = cut
    if len(arcs) == 0:
        return cut
    t = np.full(len(arcs), at) if at is not None else _turn(np.diff(arcs[:, :, 1], axis=1))
    left, right = _halves(arcs, t)
    middle = interval[:, 0] + t * (interval[:, 1] - interval[:, 0])
    return (
        np.concatenate([left, right]),
        np.concatenate([piece, piece]),
        np.concatenate(
            [np.column_stack([interval[:, 0], middle]), np.column_stack([middle, interval[:, 1]])]
        ),
    )


def _halves(arcs: Floats, t: Floats) -> tuple[Floats, Floats]:
    """De Casteljau at one parameter an arc: the control points of both parts."""
    t = t.reshape(-1, *([1] * (arcs.ndim - 1)))
    left, right = np.empty_like(arcs), np.empty_like(arcs)
    points = arcs
    last = arcs.shape[1] - 1
    for k in range(last + 1):
        left[:, k] = points[:, 0]
        right[:, last - k] = points[:, -1]
        points = (1.0 - t) * points[:, :-1] + t * points[:, 1:]
    return left, right


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
    """Largest distance of a control point from the chord, as a share of the chord."""
    chord = arcs[:, -1] - arcs[:, 0]
    length = np.hypot(chord[:, 0], chord[:, 1])
    offset = arcs[:, 1:-1] - arcs[:, :1]
    across = np.abs(offset[..., 0] * chord[:, None, 1] - offset[..., 1] * chord[:, None, 0])
    along = offset[..., 0] * chord[:, None, 0] + offset[..., 1] * chord[:, None, 1]
    outside = np.maximum(np.maximum(-along, along - length[:, None] ** 2), 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.max(across + outside, axis=1, initial=0.0) / length**2
    return np.where(length > 0.0, ratio, np.inf)


def _tables(arcs: Floats, degree: int, most: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Power basis, gram and linear coefficients (padded to degree ``most``), and boxes."""
    count, d = len(arcs), degree
    local = arcs - arcs[:, :1]
    power = np.zeros((count, most + 1, 2))
    for k in range(1, d + 1):
        # forward differences: the k-th power coefficient is binom(d, k) times the k-th of them
        power[:, k] = math.comb(d, k) * np.diff(local, n=k, axis=1)[:, 0]
    gram = np.zeros((count, 2 * most + 1))
    linear = np.zeros((count, 2 * most + 1, 2))
    for k in range(2 * d + 1):
        for i in range(max(0, k - d), min(d, k) + 1):
            weight = math.comb(d, i) * math.comb(d, k - i) / math.comb(2 * d, k)
            gram[:, k] += weight * np.sum(local[:, i] * local[:, k - i], axis=1)
            linear[:, k] += weight * local[:, i]
    boxes = np.concatenate([arcs.min(axis=1), arcs.max(axis=1)], axis=1)
    return power, gram, linear, boxes


def _tree(boxes: Floats, loop: Ints) -> tuple[Floats, Ints, Ints]:
    """Preorder tree over the arclets in their order along the curve, made level by level."""
    count = len(boxes)
    node = np.zeros(1, dtype=np.int64)
    first, last = np.zeros(1, dtype=np.int64), np.full(1, count)
    ranges = np.empty((2 * count - 1, 2), dtype=np.int64)
    levels = []
    while len(node):
        ranges[node] = np.column_stack([first, last])
        inner = last - first > 1
        node, first, last = node[inner], first[inner], last[inner]
        levels.append(node)
        middle = (first + last) // 2
        node, first, last = (
            np.concatenate([node + 1, node + 2 * (middle - first)]),
            np.concatenate([first, middle]),
            np.concatenate([middle, last]),
        )
    result = np.empty((2 * count - 1, 4))
    leaves = ranges[:, 1] - ranges[:, 0] == 1
    result[leaves] = boxes[ranges[leaves, 0]]
    for node in reversed(levels):
        right = node + 2 * ((ranges[node, 0] + ranges[node, 1]) // 2 - ranges[node, 0])
        result[node, :2] = np.minimum(result[node + 1, :2], result[right, :2])
        result[node, 2:] = np.maximum(result[node + 1, 2:], result[right, 2:])
    chain = (loop[ranges[:, 0]] == loop[ranges[:, 1] - 1]).astype(np.int64)
    return result, ranges, chain
