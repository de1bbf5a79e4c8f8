"""Where a medial axis ends, known before it is traced: corners, and maxima of curvature.

The disk of curvature where curvature has a maximum is a maximal disk if it is empty; with the
corners that point out of the region these are all the places at which a medial axis can end.
Maxima are proved: the derivative of curvature has the sign of a polynomial, whose Bernstein
coefficients bound the number of its roots.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.arclets.crossings import control_points
from splinesdf.arclets.curvature import derivative, product
from splinesdf.arclets.points import points_at, tangents_at
from splinesdf.arclets.tables import Arclets
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.medial.tables import (
    ARC,
    BEND_LEAF,
    CORNER,
    CUSP_LEAF,
    FREE,
    ROUND,
    WHOLE,
    Leaves,
    Loops,
    Walk,
)
from splinesdf.medial.walk import curvature_at

# Two maxima are one if curvature does not fall by more than this share of it between them: what
# compilation leaves of curvature. Larger: branches are lost that are shorter than this share of a
# radius; smaller: noise makes ends, which are given up as they come to nothing.
_FALL = 1e-8
# Coefficients below this share of their terms are rounding, and have no sign.
_NOISE = 1e-13
# Pieces of a degree above the first are compiled, to 4 ulp. On arclets of theirs that are shorter
# than this share of the box, as next to cusps, curvature is rounding: between their neighbors it is
# taken to rise or fall. Larger: ends are overlooked in details of that size; smaller: noise makes
# ends, and the axis is refused.
_DRAWN, _LOST = 3, 1e-5
# Halvings of an arclet in which the derivative of curvature may have several roots. It is a
# polynomial, so that few are needed; at the ceiling its middle is taken for a root.
_HALVINGS = 24
# Roots by bisection: to 1e-9 of an arclet. Curvature is level there, so that its maximum, and the
# center of curvature, are known to rounding.
_BISECTIONS = 30


class Bent(NamedTuple):
    """Places of the walk where curvature starts, ends or turns, in order."""

    element: Ints  # (n,)
    at: Floats  # (n,)
    bend: Floats  # (n,) positive where the region is convex


def turns_of_curvature(boundary: Arclets, arclet: Ints) -> tuple[Ints, Floats]:
    """All places inside of free arclets where the derivative of curvature changes its sign.

    Returns
    -------
    row : ndarray of int, shape (n,)
        Which of the arclets given.
    at : ndarray, shape (n,)
        The parameter there, increasing for each arclet.
    """
    rows, places = [np.empty(0, dtype=np.int64)], [np.empty(0)]
    degree = boundary.arcs[arclet, 0].astype(np.int64)
    for d in np.unique(degree[degree > 1]):
        chosen = np.flatnonzero(degree == d)
        control = control_points(boundary.power[arclet[chosen], : d + 1])
        slopes, noise = _slopes(np.ascontiguousarray(control.transpose(1, 2, 0)))
        row, at = _roots(slopes, noise)
        rows.append(chosen[row])
        places.append(at)
    row, at = np.concatenate(rows), np.concatenate(places)
    order = np.lexsort((at, row))
    return row[order], at[order]


def _slopes(control: Floats) -> tuple[Floats, Floats]:
    """Bernstein coefficients (k, n) of a polynomial with the sign of curvature's derivative.

    And how much of them is rounding. (c' x c''') |c'|^2 - 3 (c' x c'') (c' . c'').
    """
    first = derivative(control)
    second = derivative(first)
    third = derivative(second)
    cross = product(first[:, 0], second[:, 1]) - product(first[:, 1], second[:, 0])
    squared = product(first[:, 0], first[:, 0]) + product(first[:, 1], first[:, 1])
    cross_third = product(first[:, 0], third[:, 1]) - product(first[:, 1], third[:, 0])
    along = product(first[:, 0], second[:, 0]) + product(first[:, 1], second[:, 1])
    one, other = product(cross_third, squared), product(cross, along)
    most = max(len(one), len(other))
    one, other = _raised(one, most), _raised(other, most)
    size = [np.abs(part).max(axis=(0, 1)) for part in (first, second, third)]
    noise = _NOISE * (size[0] ** 3 * size[2] + 3.0 * (size[0] * size[1]) ** 2)
    return one - 3.0 * other, noise


def _raised(coefficients: Floats, count: int) -> Floats:
    """Bernstein coefficients of polynomials, raised to as many."""
    while len(coefficients) < count:
        n = len(coefficients)
        share = np.arange(n + 1)[:, None] / n
        before = np.concatenate([coefficients[:1], coefficients])
        behind = np.concatenate([coefficients, coefficients[-1:]])
        coefficients = share * before + (1.0 - share) * behind
    return coefficients


def _roots(values: Floats, noise: Floats) -> tuple[Ints, Floats]:
    """Where polynomials in Bernstein form (k, n) change sign in (0, 1), to rounding."""
    row, low, high = np.arange(values.shape[1]), np.zeros(values.shape[1]), np.ones(values.shape[1])
    rows, places = [np.empty(0, dtype=np.int64)], [np.empty(0)]
    depth = 0
    while len(row):  # none is left after the last halving, whose changes all count as one
        signs = np.where(np.abs(values) <= noise[row], 0.0, np.sign(values))
        changes = np.zeros(len(row), dtype=np.int64)
        last = np.zeros(len(row))
        for sign in signs:
            changes += sign * last < 0.0
            last = np.where(sign != 0.0, sign, last)
        single = (changes == 1) if depth < _HALVINGS else (changes > 0)
        if single.any():
            at = _bisected(values[:, single])
            rows.append(row[single])
            places.append(low[single] + at * (high - low)[single])
        rest = (changes > 1) & ~single
        first, second = _halves(values[:, rest])
        middle = 0.5 * (low + high)[rest]
        values = np.concatenate([first, second], axis=1)
        row, low, high = (
            np.tile(row[rest], 2),
            np.concatenate([low[rest], middle]),
            np.concatenate([middle, high[rest]]),
        )
        depth += 1
    return np.concatenate(rows), np.concatenate(places)


def _halves(values: Floats) -> tuple[Floats, Floats]:
    first, second = np.empty_like(values), np.empty_like(values)
    points, last = values, len(values) - 1
    for k in range(last + 1):
        first[k], second[last - k] = points[0], points[-1]
        points = 0.5 * (points[:-1] + points[1:])
    return first, second


def _bisected(values: Floats) -> Floats:
    """The root of each polynomial with one change of sign, by halving it."""
    low, width = np.zeros(values.shape[1]), np.ones(values.shape[1])
    significant = np.argmax(np.abs(values) > 0.0, axis=0)
    began = np.sign(values[significant, np.arange(values.shape[1])])
    for _ in range(_BISECTIONS):
        first, second = _halves(values)
        width = 0.5 * width
        later = np.sign(first[-1]) == began
        low = np.where(later, low + width, low)
        values = np.where(later, second, first)
    return low + 0.5 * width


def leaves_of(boundary: Arclets, walk: Walk, loops: Loops) -> Leaves:
    """Corners, and maxima of curvature, of which disks that are not empty must be left out."""
    corners = np.flatnonzero(loops.corner)
    arclet = walk.element[corners, 1]
    found = [
        (
            np.column_stack([corners, np.zeros(len(corners))]),
            np.column_stack([corners, np.zeros(len(corners))]),
            boundary.start[arclet],
            np.zeros(len(corners)),
            np.full(len(corners), CORNER),
        )
    ]
    bent = _bent(boundary, walk, loops)
    peaks: list[tuple[int, int, bool]] = []
    firsts = np.searchsorted(bent.element, loops.first)
    # Loops that are nowhere convex but in corners have no others; polygons have none at all.
    total = np.concatenate([[0], np.cumsum(bent.bend > 0.0)])
    convex = total[firsts[1:]] > total[firsts[:-1]]
    for j in np.flatnonzero(convex).tolist():
        peaks += _peaks(bent, walk, loops, int(firsts[j]), int(firsts[j + 1]))
    if peaks:
        found.append(_of_peaks(peaks, bent, boundary, walk))
    return Leaves(*(np.concatenate(column) for column in zip(*found, strict=True)))


def _bent(boundary: Arclets, walk: Walk, loops: Loops) -> Bent:
    """Curvature where elements start and end, and between where it turns."""
    kind, owner = walk.element[:, 0], walk.element[:, 1]
    count = len(kind)
    free = np.flatnonzero(kind == FREE)
    row, at = turns_of_curvature(boundary, owner[free])
    inside = curvature_at(boundary, owner[free][row], at)
    start = np.where(
        kind == 3, -np.inf, np.where(kind == FREE, walk.numbers[:, 7], walk.numbers[:, 8])
    )
    element = np.concatenate([np.arange(count), free[row], np.arange(count)])
    places = np.concatenate([np.zeros(count), at, np.ones(count)])
    bend = np.concatenate([start, inside, walk.numbers[:, 8]])
    order = np.lexsort((places, element))
    arclet = owner[element]
    compiled = (kind[element] == FREE) & (boundary.arcs[arclet, 0] > _DRAWN)
    lost = compiled & (loops.length[element] < _LOST * float(np.ptp(boundary.boxes[0])))
    kept = order[~lost[order] | np.isinf(bend[order])]
    return Bent(element[kept], places[kept], bend[kept])


def _peaks(
    bent: Bent, walk: Walk, loops: Loops, first: int, last: int
) -> list[tuple[int, int, bool]]:
    """Maxima of curvature along one loop: first and last row of each, and whether it is all."""
    # Levels: runs of rows with one curvature. A corner is higher than all.
    levels: list[list[float]] = []  # value, first row, last row
    site = walk.element[:, 2]
    for row in range(first, last):
        e, value = int(bent.element[row]), float(bent.bend[row])
        if bent.at[row] == 0.0 and loops.corner[e]:
            levels.append([np.inf, -1, -1])
        if levels and levels[-1][1] >= 0:
            before = levels[-1]
            one = int(bent.element[int(before[2])])
            round_ = walk.element[e, 0] == ROUND and site[e] == site[one]
            if (
                round_
                or value == before[0]
                or (np.isfinite(value) and abs(value - before[0]) <= 1e-14 * abs(value))
            ):
                before[2] = row
                continue
        levels.append([value, row, row])
    if len(levels) > 1 and levels[0][1] >= 0 and levels[-1][1] >= 0:
        e, one = int(bent.element[int(levels[0][1])]), int(bent.element[int(levels[-1][2])])
        if (walk.element[e, 0] == ROUND and site[e] == site[one]) or levels[0][0] == levels[-1][0]:
            levels[0][1] = levels[-1][1]
            levels.pop()
    if len(levels) == 1:
        value, low, high = levels[0]
        return [(int(low), int(high), True)] if value > 0.0 and low >= 0 else []
    kept = _persistent([level[0] for level in levels])
    return [
        (int(levels[k][1]), int(levels[k][2]), False)
        for k in kept
        if levels[k][1] >= 0 and levels[k][0] > 0.0
    ]


def _persistent(values: list[float]) -> list[int]:
    """Maxima of a closed sequence of values between which it falls by more than rounding."""
    count = len(values)
    extremes: list[int] = []
    for k in range(count):
        before, value, behind = values[k - 1], values[k], values[(k + 1) % count]
        if (value > before) != (behind > value):
            extremes.append(k)
    level = np.array([values[k] for k in extremes])
    while len(extremes) > 2:
        # The smallest rise or fall between neighbors.
        other = np.roll(level, -1)
        high, low = np.maximum(level, other), np.minimum(level, other)
        with np.errstate(invalid="ignore", divide="ignore"):
            fall = np.where(np.isinf(high) | np.isinf(low), np.inf, (high - low) / np.abs(high))
        at = int(np.argmin(fall))
        if not fall[at] <= _FALL:
            break
        # Both go, so that maxima and minima still alternate.
        gone = {at, (at + 1) % len(extremes)}
        extremes = [e for k, e in enumerate(extremes) if k not in gone]
        level = np.delete(level, list(gone))
    return [
        e
        for k, e in enumerate(extremes)
        if values[e] > values[extremes[k - 1]] or len(extremes) == 1
    ]


def _of_peaks(
    peaks: list[tuple[int, int, bool]], bent: Bent, boundary: Arclets, walk: Walk
) -> tuple[Floats, Floats, Floats, Floats, Ints]:
    """The disks of curvature at maxima."""
    low = np.array([peak[0] for peak in peaks])
    high = np.array([peak[1] for peak in peaks])
    whole = np.array([peak[2] for peak in peaks])
    e, u, bend = bent.element[low], bent.at[low], bent.bend[low]
    arclet = walk.element[e, 1]
    foot = points_at(boundary, arclet, u)
    radius = np.where(np.isinf(bend), 0.0, 1.0 / bend)
    tangent = np.where((u >= 1.0)[:, None], walk.numbers[e, 2:4], walk.numbers[e, :2])
    inside = (u > 0.0) & (u < 1.0)
    velocity = _velocity(boundary, arclet, u)
    tangent = np.where(inside[:, None], velocity, tangent)
    center = foot + radius[:, None] * np.column_stack([-tangent[:, 1], tangent[:, 0]])
    circle = walk.element[e, 0] == ROUND
    center = np.where(circle[:, None], walk.numbers[e, 4:6], center)
    kind = np.where(low == high, BEND_LEAF, ARC)
    kind = np.where(radius == 0.0, CUSP_LEAF, np.where(whole, WHOLE, kind))
    return (
        np.column_stack([e, u]),
        np.column_stack([bent.element[high], bent.at[high]]),
        center,
        radius,
        kind,
    )


def _velocity(boundary: Arclets, arclet: Ints, at: Floats) -> Floats:
    vector = tangents_at(boundary, arclet, at)
    return np.asarray(vector / np.hypot(vector[:, 0], vector[:, 1])[:, None])
