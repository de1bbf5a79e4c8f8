"""Edges as curves: exact conics between lines, circles and points, fitted ones between others.

spans of chains with one pair of sites ─→ exact, if both have a closed form ─→ checked by distance
                                      └─→ fitted: halved, with new disks, until within the tolerance
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.medial.between import Pool, pool_of, with_middles
from splinesdf.medial.chords import Region
from splinesdf.medial.conics import (
    apexes,
    conic_points,
    controls,
    off_sites,
    slopes,
    weights,
)
from splinesdf.medial.faces import NEAR
from splinesdf.medial.graph import Chains
from splinesdf.medial.tables import FREE, STRAIGHT

# What an arc may be off at the disks that it is measured at, as a share of the tolerance: between
# them it may be off more.
_SAFE = 0.7
# Arcs shorter than this share of the tolerance are straight.
_SHORT = 0.3
# Halvings of one span. Each shortens what is left to half, so that rounding is reached before.
_HALVINGS = 40
# Arcs of all edges. More: memory; a tolerance that takes more is below what anybody has a use for.
_MOST = 400_000
# Exact arcs go through the disks between their ends, as near as nearest points are found.
_ON = 1e-7
# Weights of fitted arcs: beyond, an arc is halved.
_LIGHT, _HEAVY = 0.05, 20.0


class Curves(NamedTuple):
    """Conic arcs of all edges, in order along each."""

    edge: Ints  # (n,)
    arcs: Floats  # (n, 3, 3) control points x, y, r
    weights: Floats  # (n,)
    feet: Floats  # (n, 2, 2, 2) where each starts and ends, on the right and on the left
    exact: Bools  # (n,)
    error: float  # how far fitted arcs are off, where measured, over the share that is safe
    failed: int  # spans in which no disks were found


class _Spans(NamedTuple):
    """Parts of chains between two places where a site changes."""

    first: Ints  # (n,) nodes
    last: Ints  # (n,)
    element: Ints  # (n, 2) on the right and on the left
    exact: Bools  # (n,)


def curves_of(region: Region, chains: Chains, tolerance: float) -> Curves:
    """Arcs for all chains."""
    if not len(chains.ends):
        return _nothing()
    pool = pool_of(region, chains, slopes_of(chains))
    spans = _spans(region, chains)
    done: list[tuple[Ints, Floats, Floats, Bools]] = []  # nodes, controls, weights, exact
    exact = spans.exact
    first, last, element = spans.first[exact], spans.last[exact], spans.element[exact]
    rest = [np.column_stack([spans.first, spans.last])[~exact]]
    while len(first):
        start, end = pool.disk[first], pool.disk[last]
        control, good = controls(start, end, pool.slope[first], pool.slope[last])
        lines = (region.walk.element[element, 0] == STRAIGHT).all(axis=1)
        control = np.where(lines[:, None], 0.5 * (start + end), control)
        weight, heavy = _exact_weights(region, start, end, control, element)
        good = (good | lines) & heavy
        good &= _checked(region, start, end, control, weight, element)
        arcs = np.stack([start, control, end], axis=1)
        good &= _through(pool, arcs, weight, first, last) <= _ON * region.size
        done.append(
            (
                np.column_stack([first, last])[good],
                control[good],
                weight[good],
                np.ones(np.count_nonzero(good), dtype=np.bool_),
            )
        )
        bad = ~good
        short = bad & (last - first < 2)
        rest.append(np.column_stack([first, last])[short])
        halved = bad & ~short
        middle = (first + last)[halved] // 2
        first, last = (
            np.concatenate([first[halved], middle]),
            np.concatenate([middle, last[halved]]),
        )
        element = np.concatenate([element[halved], element[halved]])
    failed, error = 0, 0.0
    todo = np.concatenate(rest)
    if len(todo):
        pool, fitted, error, failed = _fitted(region, pool, todo, tolerance)
        done += fitted
    nodes, control, weight, is_exact = (
        np.concatenate(column) for column in zip(*done, strict=True)
    )
    order = np.argsort(pool.order[nodes[:, 0]], kind="stable")
    nodes, control, weight = nodes[order], control[order], weight[order]
    start, end = pool.disk[nodes[:, 0]], pool.disk[nodes[:, 1]]
    starts = pool.order[chains.first[:-1]]
    edge = np.searchsorted(starts, pool.order[nodes[:, 0]], side="right") - 1
    return Curves(
        edge,
        np.stack([start, control, end], axis=1),
        weight,
        pool.foot[nodes],
        is_exact[order],
        error / _SAFE,
        failed,
    )


def _nothing() -> Curves:
    none = np.empty(0, dtype=np.int64)
    feet = np.empty((0, 2, 2, 2))
    return Curves(none, np.empty((0, 3, 3)), np.empty(0), feet, none > 0, 0.0, 0)


def slopes_of(chains: Chains) -> Floats:
    """Directions at all nodes; at an end in a maximum of curvature, along the normal."""
    nodes = chains.nodes
    result = slopes(nodes.normal)
    normal = nodes.normal[:, 0]
    lost = np.isnan(result[:, 0])
    forward = np.zeros(len(result), dtype=np.bool_)
    forward[chains.first[:-1]] = True
    sign = np.where(forward, 1.0, -1.0)
    along = sign[:, None] * np.column_stack([normal, np.ones(len(normal))])
    return np.where(lost[:, None], along, result)


def _spans(region: Region, chains: Chains) -> _Spans:
    """Segments of chains with the same pair of sites, joined."""
    site, kind = region.walk.element[:, 2], region.walk.element[:, 0]
    segments = np.ones(len(chains.nodes.disk), dtype=np.bool_)
    segments[chains.first[1:] - 1] = False
    segment = np.flatnonzero(segments)
    ahead, behind = site[chains.ahead[segment]], site[chains.behind[segment]]
    mixed = (ahead != behind).any(axis=1)
    new = np.ones(len(segment), dtype=np.bool_)
    new[1:] = (ahead[1:] != ahead[:-1]).any(axis=1) | (segment[1:] != segment[:-1] + 1)
    new |= mixed
    new[1:] |= mixed[:-1]
    # A closed chain of one pair of sites is cut in three: an arc that comes back is none.
    for j in np.flatnonzero(chains.ends[:, 0] == chains.ends[:, 1]).tolist():
        low, high = np.searchsorted(segment, chains.first[j : j + 2] - [0, 1])
        if high - low > 2:
            new[[low + (high - low) // 3, low + 2 * (high - low) // 3]] = True
    first = segment[new]
    last = segment[np.append(np.flatnonzero(new)[1:] - 1, len(segment) - 1)] + 1
    element = chains.ahead[first]
    exact = ~mixed[new] & (kind[element] != FREE).all(axis=1)
    return _Spans(first, last, element, exact)


def _exact_weights(
    region: Region, start: Floats, end: Floats, control: Floats, element: Ints
) -> tuple[Floats, Bools]:
    """Weights by the cone of either site, of which one may be a plane."""
    right, left = (apexes(region.walk, element[:, k]) for k in (0, 1))
    apex = np.where(np.isnan(right[:, :1]), left, right)
    # An axis between a line and a circle, or a point, is a parabola; between lines it is straight.
    plane = np.isnan(right[:, 0]) | np.isnan(left[:, 0])
    weight, good = weights(start, end, control, apex)
    return np.where(plane, 1.0, weight), good | plane


def _checked(
    region: Region, start: Floats, end: Floats, control: Floats, weight: Floats, element: Ints
) -> Bools:
    """Whether arcs are as far from both sites as their radius says."""
    arcs = np.stack([start, control, end], axis=1)
    off = np.zeros(len(arcs))
    for t in (0.25, 0.5, 0.75):
        disks = conic_points(arcs, weight, t)
        for k in (0, 1):
            off = np.maximum(off, off_sites(region.walk, element[:, k], disks))
    return np.asarray(off <= NEAR * region.size)


def _through(pool: Pool, arcs: Floats, weight: Floats, first: Ints, last: Ints) -> Floats:
    """How far arcs are off the disks of a chain that are between their ends: (n,)."""
    count = np.maximum(last - first - 1, 0)
    row = np.repeat(np.arange(len(first)), count)
    off = np.zeros(len(first))
    node = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + first[row] + 1
    span = pool.order[last] - pool.order[first]
    share = (pool.order[node] - pool.order[first[row]]) / np.where(span > 0.0, span, 1.0)[row]
    np.maximum.at(off, row, off_arc(arcs[row], weight[row], pool.disk[node], share))
    return off


def _fitted(
    region: Region, pool: Pool, todo: Ints, tolerance: float
) -> tuple[Pool, list[tuple[Ints, Floats, Floats, Bools]], float, int]:
    """Arcs within the tolerance, and how far they are off at most."""
    done: list[tuple[Ints, Floats, Floats, Bools]] = []
    worst, failed, total, chained = 0.0, 0, 0, len(pool.order)
    # Nodes at the start, the first quarter, the middle, the third quarter and the end.
    five = np.full((len(todo), 5), -1)
    five[:, 0], five[:, 4] = todo.T
    for _ in range(_HALVINGS):
        if not len(five):
            break
        pool, five, lost = with_middles(region, pool, five)
        control, weight, off = _fit(pool, chained, five)
        little = _reach(pool, chained, five) <= _SHORT * tolerance
        middle = 0.5 * (pool.disk[five[:, 0]] + pool.disk[five[:, 4]])
        good = (off <= _SAFE * tolerance) & ~lost
        straight = ~good & little
        control = np.where(straight[:, None], middle, control)
        weight = np.where(straight, 1.0, weight)
        worst = max(worst, float(off[good].max(initial=0.0)))
        given_up = lost & ~little & ~good
        failed += int(np.count_nonzero(given_up))
        keep = good | straight | given_up
        control = np.where(given_up[:, None], middle, control)
        weight = np.where(given_up, 1.0, weight)
        done.append(
            (
                five[keep][:, [0, 4]],
                control[keep],
                weight[keep],
                np.zeros(np.count_nonzero(keep), dtype=np.bool_),
            )
        )
        total += int(np.count_nonzero(keep))
        left, right = five[~keep][:, [0, 0, 1, 2, 2]], five[~keep][:, [2, 2, 3, 4, 4]]
        five = np.concatenate([left, right])
        five[:, [1, 3]] = -1
        if total + len(five) > _MOST:
            failed += len(five)
            break
    else:
        failed += len(five)
    return pool, done, worst, failed


def _reach(pool: Pool, chained: int, five: Ints) -> Floats:
    """How far the disks of a part are from its first one at most, in (x, y, r): (n,)."""
    row, node = _inside(pool, chained, five)
    apart = pool.disk[five] - pool.disk[five[:, :1]]
    reach = np.sqrt(np.sum(apart * apart, axis=2)).max(axis=1)
    apart = pool.disk[node] - pool.disk[five[row, 0]]
    np.maximum.at(reach, row, np.sqrt(np.sum(apart * apart, axis=1)))
    return np.asarray(reach)


def _inside(pool: Pool, chained: int, five: Ints) -> tuple[Ints, Ints]:
    """Disks of the chain that are between the ends of parts: the part and the disk of each."""
    known = pool.order[:chained]
    first = np.searchsorted(known, pool.order[five[:, 0]], side="right")
    count = np.searchsorted(known, pool.order[five[:, 4]], side="left") - first
    count = np.maximum(count, 0)
    row = np.repeat(np.arange(len(five)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + first[row]


def _fit(pool: Pool, chained: int, five: Ints) -> tuple[Floats, Floats, Floats]:
    """Control points and weights of arcs, and how far disks between are off."""
    start, end = pool.disk[five[:, 0]], pool.disk[five[:, 4]]
    control, good = controls(start, end, pool.slope[five[:, 0]], pool.slope[five[:, 4]])
    middle = pool.disk[five[:, 2]]
    early, late, apart = control - start, end - start, middle - start
    a, b, c = (
        np.sum(one * other, axis=1) for one, other in ((early, early), (early, late), (late, late))
    )
    e, f = np.sum(early * apart, axis=1), np.sum(late * apart, axis=1)
    det = a * c - b * b
    with np.errstate(divide="ignore", invalid="ignore"):
        second, third = (e * c - f * b) / det, (f * a - e * b) / det
        weight = second / (2.0 * np.sqrt((1.0 - second - third) * third))
    flat = det <= 1e-18 * a * c
    weight = np.where(flat, 1.0, weight)
    control = np.where((flat & ~good)[:, None], 0.5 * (start + end), control)
    with np.errstate(invalid="ignore"):
        good = (good | flat) & (weight > _LIGHT) & (weight < _HEAVY)
    weight = np.where(good, weight, 1.0)
    control = np.where(good[:, None], control, 0.5 * (start + end))
    arcs = np.stack([start, control, end], axis=1)
    off = np.zeros(len(five))
    for k, t in ((1, 0.25), (2, 0.5), (3, 0.75)):
        off = np.maximum(off, off_arc(arcs, weight, pool.disk[five[:, k]], t))
    # Disks of the chain that are between: they are where elements meet, as the halves need not be.
    row, node = _inside(pool, chained, five)
    low, high = pool.order[five[:, 0]], pool.order[five[:, 4]]
    share = (pool.order[node] - low[row]) / np.where(high > low, high - low, 1.0)[row]
    np.maximum.at(off, row, off_arc(arcs[row], weight[row], pool.disk[node], share))
    return control, weight, np.where(good, off, np.inf)


def off_arc(arcs: Floats, weight: Floats, points: Floats, guess: float | Floats) -> Floats:
    """How far points (n, k) are from rational quadratics (n, 3, k), each from its own: (n,)."""
    t = np.broadcast_to(np.asarray(guess, dtype=np.float64), (len(arcs),))
    best = np.full(len(arcs), np.inf)
    for _ in range(6):
        a, b, c = (1.0 - t) ** 2, 2.0 * weight * t * (1.0 - t), t * t
        da, db, dc = -2.0 * (1.0 - t), 2.0 * weight * (1.0 - 2.0 * t), 2.0 * t
        total, slope = a + b + c, da + db + dc
        top = a[:, None] * arcs[:, 0] + b[:, None] * arcs[:, 1] + c[:, None] * arcs[:, 2]
        rise = da[:, None] * arcs[:, 0] + db[:, None] * arcs[:, 1] + dc[:, None] * arcs[:, 2]
        at = top / total[:, None]
        velocity = (rise - slope[:, None] * at) / total[:, None]
        apart = points - at
        best = np.minimum(best, np.sqrt(np.sum(apart * apart, axis=1)))
        squared = np.sum(velocity * velocity, axis=1)
        step = np.sum(apart * velocity, axis=1) / np.where(squared > 0.0, squared, 1.0)
        t = np.clip(t + step, 0.0, 1.0)
    return np.asarray(best)
