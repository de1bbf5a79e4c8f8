r"""Proved bounds of the error of a spline over cells, by branch and bound on triangles.

On a small triangle the distance is the smallest of a few smooth functions, one for each chain of
arclets that can be closest there, and each of them is a Taylor polynomial of degree 2, known from
one closest point, up to a proved remainder. The spline is quadratic too, so their difference is,
and the Bernstein coefficients of a quadratic bound it. Where there is no such structure (next to
a focal point, at a corner of the curve) the distance is at least 1-Lipschitz. A triangle that is
not decided is halved. The derivation stands in docs/theory/certificate.md; equation numbers below
are those of that page.

                 C                  A triangle has its longest side from A to B and is halved
               / | \                from its middle to C. Its coefficients: AA BB CC AB BC CA.
             /   |   \
           A --- M --- B
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.tables import Candidates
from splinesdf.distance.kernels.branches import find_branches, find_point_branches, side_of
from splinesdf.distance.kernels.feet import fill_foot_table
from splinesdf.distance.tables import Bent
from splinesdf.fits.kernels.bands import least_of, meets, most_of, seen, seen_in_bands
from splinesdf.fits.kernels.means import least_of_means
from splinesdf.fits.tables import Asked, Brackets, Limits, Parts
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted

# Arclets near a triangle that are looked at. More: slower in cells where many meet; fewer: cells
# around a detail of many short arclets must be cut smaller until few are near.
_MOST = 32
# Points of the curve that stand for it where there are no such chains, from so many halvings on.
# More: costly; fewer: next to focal points triangles must be smaller.
_POINTS, _POINT_DEPTH = 256, 2
# Share of what is good enough that these points may miss; it shrinks with the triangles, which
# see less of the curve. Smaller: more points.
_SPARE = 0.03
# Halvings of a cell's triangles. Each divides the length by sqrt(2): here by 2^11, where the
# Lipschitz bound is within half a percent of what a kink adds to the error of a cell.
_DEPTH = 23
# What a triangle costs where so many points stand for the curve, in triangles without.
_DEAR = 8
# Rounding in distances and ordinates, as a share of the largest coordinate.
_GRAIN = 256 * 2.220446049250313e-16


@kernel
def enclose(
    tree: Floats,
    candidates: Candidates,
    bent: Bent,
    asked: Asked,
    limits: Limits,
    brackets: Brackets,
) -> None:
    """Bracket max |s - u| over triangles.

    Parameters
    ----------
    tree : ndarray
        Of `Arclets`.
    candidates : Candidates
        The arclets that can be closest, for groups of triangles.
    bent : Bent
    asked : Asked
        Triangles; coordinates are relative to the origin of the arclets.
    limits : Limits
        When to stop.
    brackets : Brackets
        Filled, for both halves of each triangle. A half is left as soon as its error is known to
        exceed ``limits.enough``.
    """
    size = _DEPTH + 4
    parts = Parts(
        np.empty((size, 12)),
        np.empty((size, 3), dtype=np.int64),
        np.empty((size, _MOST), dtype=np.int64),
        np.empty((_MOST, 9)),
        np.empty((_POINTS, 12)),
        np.empty(3),
        np.empty(6),
    )
    for k in range(asked.triangles.shape[0]):
        first, end = candidates.starts[asked.group[k]], candidates.starts[asked.group[k] + 1]
        for e in range(12):
            parts.triangles[0, e] = asked.triangles[k, e]
        parts.sizes[0, 0], parts.sizes[0, 2] = 0, 0
        parts.sizes[0, 1] = _listed(tree, candidates.nodes, first, end, parts.lists)
        for half in range(2):
            brackets.low[k, half], brackets.high[k, half] = asked.low[k, half], 0.0
            brackets.counts[k, half] = False
        _enclose_one(bent, asked.anchor[k], limits, k, parts, brackets)


@kernel
def steepest(triangles: Floats, slopes: Floats) -> None:
    """Fill the largest slope of the spline on each triangle (n, 12)."""
    for k in range(triangles.shape[0]):
        slopes[k] = _steepest(triangles[k])


@kernel
def quarter(triangles: Floats, quarters: Floats) -> None:
    """Fill the halves of both halves of each triangle: (n, 12) -> (4 n, 12)."""
    for k in range(triangles.shape[0]):
        for e in range(12):
            quarters[4 * k, e] = triangles[k, e]
        _halve(quarters, 4 * k, 4 * k + 2)
        _halve(quarters, 4 * k, 4 * k + 1)
        _halve(quarters, 4 * k + 2, 4 * k + 3)


@uncounted
def _enclose_one(
    bent: Bent, anchor: Floats, limits: Limits, k: int, parts: Parts, brackets: Brackets
) -> None:
    """Bracket the error on both halves of triangle k, which is the first of the parts."""
    sizes = parts.sizes
    lows, highs = brackets.low[k], brackets.high[k]
    size, effort = 1, 0
    while size > 0:
        size -= 1
        depth, half = sizes[size, 0], sizes[size, 2]
        # Halves come one after the other, the second one first.
        effort = 0 if depth == 1 else effort + 1
        low = lows[half] if depth > 0 else min(lows[0], lows[1])
        if low > limits.enough:
            continue
        counts, found, bound, spent = _look(bent, anchor, limits, parts, size, low)
        effort += spent
        if not counts:
            continue
        low = max(low, found)
        good = bound <= max(limits.threshold, (1.0 + limits.tight) * low)
        if depth == 0:
            # If it is not good enough, each half is asked by itself.
            if good and low <= limits.enough:
                for h in range(2):
                    lows[h], highs[h] = max(lows[h], found), bound
                    brackets.counts[k, h] = True
                continue
        else:
            lows[half] = low
            brackets.counts[k, half] = True
            passed_on = bound == np.inf and (depth > limits.patience or sizes[size, 1] < 0)
            if low > limits.enough:
                highs[half] = np.inf
                continue
            if passed_on and brackets.open_count[0] < brackets.open_from.shape[0]:
                place = brackets.open_count[0]
                brackets.open_count[0] += 1
                brackets.open_from[place] = 2 * k + half
                for e in range(12):
                    brackets.open_triangles[place, e] = parts.triangles[size, e]
                continue
            if good or depth == _DEPTH or effort > limits.effort:
                highs[half] = max(highs[half], bound)
                continue
        _split(parts, size)
        size += 2


@uncounted
def _look(
    bent: Bent, anchor: Floats, limits: Limits, parts: Parts, at: int, low: float
) -> tuple[bool, float, float, int]:
    """Bounds of the error on one part, of which it is known to be at least low.

    Whether it counts for the bands, what the error is at least and at most there, and the effort.
    """
    triangle, c, ids = parts.triangles[at], parts.triangles[at, 6:], parts.lists[at]
    errors, near, models = parts.errors, parts.near, parts.models
    depth, count = parts.sizes[at, 0], parts.sizes[at, 1]
    grain = _GRAIN * (limits.largest + abs(anchor[2])) + anchor[3]
    px, py = 0.5 * (triangle[0] + triangle[2]), 0.5 * (triangle[1] + triangle[3])
    r = _radius(triangle, px, py)
    disk = (px, py, r)
    away = math.sqrt((px - anchor[0]) ** 2 + (py - anchor[1]) ** 2)
    exact = False
    nearest, spare, sign, chains, effort = 0.0, 0.0, 0, 0, 0
    lo, hi = -np.inf, np.inf
    value, room, margin = 0.0, np.inf, np.inf
    for v in range(3):
        errors[v] = 0.0
    if count >= 0:
        count, nearest, exact = fill_foot_table(
            bent.arcs, bent.rows, bent.second, ids, count, disk, near
        )
        parts.sizes[at, 1] = count
        if away + grain < abs(anchor[2]):
            sign = 1 if anchor[2] > 0.0 else -1
        elif exact:
            sign = side_of(bent, ids, count, near, nearest, grain)
    if exact:
        chains = find_branches(bent, ids, count, disk, near, models)
        if (chains > 1 or models[0, 5] > 0.0) and (sign == 0 or nearest <= r + grain):
            chains = 0
        if sign != 0:
            value = 0.25 * (c[0] + 2.0 * c[3] + c[1]) - sign * nearest
            reach = (1.0 + _steepest(triangle)) * r + grain
            lo, hi, room = value - reach, value + reach, grain
    if chains == 0 and count >= 0 and sign != 0 and depth >= _POINT_DEPTH:
        spare = _SPARE * max(limits.threshold, low) * 0.5 ** (0.5 * depth)
        chains = find_point_branches(bent, ids, count, disk, spare, near, models)
        effort = chains // _DEAR
    if chains > 0:
        enough = max(limits.threshold, (1.0 + limits.tight) * low)
        lower, upper, margin = _bound(triangle, disk, sign, chains, (enough, spare, grain), parts)
        lo, hi = max(lo, lower), min(hi, upper)
    if limits.bands.shape[0] == 0:
        return True, seen(errors, margin, value, room), max(-lo, hi), effort
    # All that the distance may be on the triangle, as it is 1-Lipschitz.
    reach = away + r + grain
    low_u, high_u = anchor[2] - reach, anchor[2] + reach
    if exact and sign != 0:
        low_u = max(low_u, sign * nearest - r - grain)
        high_u = min(high_u, sign * nearest + r + grain)
    if not meets(limits.bands, limits.around, low_u, high_u, c, grain):
        return False, 0.0, np.inf, effort
    asked = c, errors, margin, value, room, max(lo, -hi)
    found = seen_in_bands(limits.bands, limits.around, *asked)
    return True, found, max(-lo, hi), effort


@uncounted
def _split(parts: Parts, at: int) -> None:
    """Put one half of a part in its place and the other one after it."""
    triangles, sizes, lists = parts.triangles, parts.sizes, parts.lists
    _halve(triangles, at, at + 1)
    depth, count = sizes[at, 0], sizes[at, 1]
    sizes[at, 0] = depth + 1
    sizes[at + 1, 0], sizes[at + 1, 1] = depth + 1, count
    sizes[at + 1, 2] = 1 if depth == 0 else sizes[at, 2]
    for j in range(count):
        lists[at + 1, j] = lists[at, j]


@uncounted
def _halve(triangles: Floats, at: int, other: int) -> None:
    """Put one half of triangle ``at`` in its place and the other one in place ``other``."""
    t, u = triangles[at], triangles[other]
    ax, ay, bx, by, cx, cy = t[0], t[1], t[2], t[3], t[4], t[5]
    aa, bb, cc, ab, bc, ca = t[6], t[7], t[8], t[9], t[10], t[11]
    mx, my = 0.5 * (ax + bx), 0.5 * (ay + by)
    am, mb, mc = 0.5 * (aa + ab), 0.5 * (ab + bb), 0.5 * (ca + bc)
    mm = 0.5 * (am + mb)
    t[0], t[1], t[2], t[3], t[4], t[5] = cx, cy, ax, ay, mx, my
    t[6], t[7], t[8], t[9], t[10], t[11] = cc, aa, mm, ca, am, mc
    u[0], u[1], u[2], u[3], u[4], u[5] = bx, by, cx, cy, mx, my
    u[6], u[7], u[8], u[9], u[10], u[11] = bb, cc, mm, bc, mc, mb


@uncounted
def _listed(tree: Floats, nodes: Ints, start: int, stop: int, lists: Ints) -> int:
    """Fill the first list with arclets under some nodes; how many, -1 if they are too many."""
    count = 0
    for k in range(start, stop):
        first, end = int(tree[nodes[k], 6]), int(tree[nodes[k], 7])
        if count + end - first > _MOST:
            return -1
        for i in range(first, end):
            lists[0, count] = i
            count += 1
    return count


@uncounted
def _radius(triangle: Floats, px: float, py: float) -> float:
    """How far the corners are from p."""
    a = (triangle[0] - px) ** 2 + (triangle[1] - py) ** 2
    c = (triangle[4] - px) ** 2 + (triangle[5] - py) ** 2
    return math.sqrt(max(a, c)) * (1.0 + 1e-14)


@uncounted
def _steepest(triangle: Floats) -> float:
    """The largest slope of the spline on a triangle: its gradient is linear, so at a corner."""
    c = triangle[6:]
    ux, uy = triangle[0] - triangle[4], triangle[1] - triangle[5]
    vx, vy = triangle[2] - triangle[4], triangle[3] - triangle[5]
    scale = 2.0 / abs(ux * vy - uy * vx)
    steepest = max(0.0, _squared(c[0] - c[5], c[3] - c[5], ux, uy, vx, vy))
    steepest = max(steepest, _squared(c[3] - c[4], c[1] - c[4], ux, uy, vx, vy))
    steepest = max(steepest, _squared(c[5] - c[2], c[4] - c[2], ux, uy, vx, vy))
    return float(scale * math.sqrt(steepest))


@uncounted
def _squared(in_u: float, in_v: float, ux: float, uy: float, vx: float, vy: float) -> float:
    """The square of a vector g, to scale, with g . u = 2 in_u and g . v = 2 in_v."""
    x, y = in_u * vy - in_v * uy, in_v * ux - in_u * vx
    return x * x + y * y


@uncounted
def _bound(
    triangle: Floats,
    disk: tuple[float, float, float],
    sign: int,
    chains: int,
    margins: tuple[float, float, float],
    parts: Parts,
) -> tuple[float, float, float]:
    """Lower and upper bound of the error on a triangle, and the margin of those at its corners.

    These are filled into ``parts.errors``. The coefficients of each chain's difference are put
    behind its model, in models[:, 6:]. ``margins`` are what is good enough, what the models may
    miss, and rounding.
    """
    c, models, errors = triangle[6:], parts.models, parts.errors
    px, py, _ = disk
    enough, spare, grain = margins
    single = chains == 1 and models[0, 5] == 0.0
    scale = 1.0 if single else float(sign)
    ax, ay = triangle[2] - px, triangle[3] - py
    cx, cy = triangle[4] - px, triangle[5] - py
    lower, upper, most_rest = -np.inf, -np.inf, 0.0
    for m in range(chains):
        u, gx, gy, k, rest = models[m, 0], models[m, 1], models[m, 2], models[m, 3], models[m, 4]
        if not single and u < 0.0:
            u, gx, gy, k = -u, -gx, -gy, -k
        # Along the level set; the sign of this direction does not matter.
        a, b = ay * gx - ax * gy, cy * gx - cx * gy
        step_a, step_c = ax * gx + ay * gy, cx * gx + cy * gy
        q = models[m, 6:]
        q[0] = scale * c[0] - (u - step_a + 0.5 * k * a * a)
        q[1] = scale * c[1] - (u + step_a + 0.5 * k * a * a)
        q[2] = scale * c[2] - (u + step_c + 0.5 * k * b * b)
        q[3] = scale * c[3] - (u - 0.5 * k * a * a)
        q[4] = scale * c[4] - (u + 0.5 * (step_a + step_c) + 0.5 * k * a * b)
        q[5] = scale * c[5] - (u + 0.5 * (step_c - step_a) - 0.5 * k * a * b)
        lower = max(lower, least_of(q) - rest)
        upper = max(upper, most_of(q) + rest)
        most_rest = max(most_rest, rest)
    for v in range(3):
        value = -np.inf
        for m in range(chains):
            value = max(value, models[m, 6 + v])
        errors[v] = scale * value
    if chains > 1 and -lower > enough:
        lower = max(lower, least_of_means(models, chains, enough, parts.mean))
    upper += spare
    if scale < 0.0:
        lower, upper = -upper, -lower
    return lower - grain, upper + grain, most_rest + spare + grain
