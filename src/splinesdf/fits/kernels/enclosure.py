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

from splinesdf.arclets.tables import Arclets, Bends, Candidates
from splinesdf.distance.kernels.branches import find_chains, find_points, side_of
from splinesdf.distance.kernels.feet import gather
from splinesdf.fits.kernels.bands import meets, seen, seen_in_bands
from splinesdf.fits.tables import Asked, Brackets
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
# Differences that are added to a mean to bound the largest of them, and halvings for the share of
# each. More: sharper bounds where many branches meet; each costs about 50 ns.
_ADDED, _SHARE_STEPS = 6, 8
# Rounding in distances and ordinates, as a share of the largest coordinate.
_GRAIN = 256 * 2.220446049250313e-16


@kernel
def enclose(
    arclets: Arclets, bends: Bends, candidates: Candidates, asked: Asked, brackets: Brackets
) -> None:
    """Bracket max |s - u| over triangles.

    Parameters
    ----------
    arclets, bends : Arclets, Bends
    candidates : Candidates
        The arclets that can be closest, for groups of triangles.
    asked : Asked
        Triangles, and when to stop. Coordinates are relative to ``arclets.origin``.
    brackets : Brackets
        Filled, for both halves of each triangle. A half is left as soon as its error is known to
        exceed ``asked.enough``.
    """
    stack = _stack()
    for k in range(asked.triangles.shape[0]):
        _enclose_one(arclets, bends, candidates, asked, k, stack, brackets)


@kernel
def steepest(triangles: Floats, slopes: Floats) -> None:
    """Fill the largest slope of the spline on each triangle (n, 12)."""
    for k in range(triangles.shape[0]):
        slopes[k] = _steepest(triangles[k])


@kernel
def quarter(triangles: Floats, quarters: Floats) -> None:
    """Fill the halves of both halves of each triangle: (n, 12) -> (4 n, 12)."""
    for k in range(triangles.shape[0]):
        quarters[4 * k] = triangles[k]
        _halve(quarters, 4 * k, 4 * k + 2)
        _halve(quarters, 4 * k, 4 * k + 1)
        _halve(quarters, 4 * k + 2, 4 * k + 3)


@kernel
def _stack() -> tuple[Floats, Ints, Ints, Floats, Floats, Floats]:
    """Room for the parts of a triangle that are still to be looked at, and for one of them."""
    size = _DEPTH + 4
    return (
        np.empty((size, 12)),  # corners A B C, coefficients
        np.empty((size, 3), dtype=np.int64),  # how often halved, how many arclets, which half
        np.empty((size, _MOST), dtype=np.int64),  # those arclets
        np.empty((_MOST, 8)),  # see `gather`
        np.empty((_POINTS, 12)),  # see `find_chains` and `_bound`
        np.empty(3),  # s - u at the corners
    )


@kernel
def _enclose_one(
    arclets: Arclets,
    bends: Bends,
    candidates: Candidates,
    asked: Asked,
    k: int,
    stack: tuple[Floats, Ints, Ints, Floats, Floats, Floats],
    brackets: Brackets,
) -> None:
    """Bracket the error on both halves of triangle k."""
    arcs, rows, second = arclets.arcs, bends.rows, bends.second
    parts, sizes, lists, near, models, errors = stack
    group = asked.group[k]
    kept = candidates.nodes[candidates.starts[group] : candidates.starts[group + 1]]
    parts[0] = asked.triangles[k]
    sizes[0, 0], sizes[0, 1], sizes[0, 2] = 0, _listed(arclets.tree, kept, lists[0]), 0
    size = 1
    anchor_x, anchor_y, anchored = asked.anchor[k, 0], asked.anchor[k, 1], asked.anchor[k, 2]
    grain = _GRAIN * (asked.largest + abs(anchored))
    lows, highs = brackets.low[k], brackets.high[k]
    lows[:], highs[:] = asked.low[k], 0.0
    brackets.counts[k, :] = False
    effort = 0
    while size > 0:
        size -= 1
        depth, half = sizes[size, 0], sizes[size, 2]
        # Halves come one after the other, the second one first.
        effort = 0 if depth == 1 else effort + 1
        low = lows[half] if depth > 0 else min(lows[0], lows[1])
        if low > asked.enough:
            continue
        triangle, c = parts[size], parts[size, 6:]
        px, py = 0.5 * (triangle[0] + triangle[2]), 0.5 * (triangle[1] + triangle[3])
        r = _radius(triangle, px, py)
        exact = False
        nearest, spare = 0.0, 0.0
        sign, chains = 0, 0
        lo, hi = -np.inf, np.inf
        value, room, margin = 0.0, np.inf, np.inf
        errors[:] = 0.0
        if sizes[size, 1] >= 0:
            sizes[size, 1], nearest, exact = gather(
                arcs, rows, second, lists[size], sizes[size, 1], (px, py, r), near
            )
            away = math.sqrt((px - anchor_x) ** 2 + (py - anchor_y) ** 2)
            if away + grain < abs(anchored):
                sign = 1 if anchored > 0.0 else -1
            elif exact:
                sign = side_of(bends, lists[size], near, sizes[size, 1], nearest, grain)
        if exact:
            chains = find_chains(
                arclets, bends, lists[size], sizes[size, 1], px, py, r, (near, models)
            )
            if (chains > 1 or models[0, 5] > 0.0) and (sign == 0 or nearest <= r + grain):
                chains = 0
            if sign != 0:
                value = 0.25 * (c[0] + 2.0 * c[3] + c[1]) - sign * nearest
                reach = (1.0 + _steepest(triangle)) * r + grain
                lo, hi, room = value - reach, value + reach, grain
        if chains == 0 and sizes[size, 1] >= 0 and sign != 0 and depth >= _POINT_DEPTH:
            spare = _SPARE * max(asked.threshold, low) * 0.5 ** (0.5 * depth)
            chains = find_points(
                arclets, bends, lists[size], sizes[size, 1], (px, py, r), spare, near, models
            )
            effort += chains // _DEAR
        if chains > 0:
            enough = max(asked.threshold, (1.0 + asked.tight) * low)
            lower, upper, margin = _bound(
                triangle, c, px, py, sign, chains, models, enough, spare, grain, errors
            )
            lo, hi = max(lo, lower), min(hi, upper)
        if asked.bands.shape[0] > 0:
            # All that the distance may be on the triangle, as it is 1-Lipschitz.
            reach = math.sqrt((px - anchor_x) ** 2 + (py - anchor_y) ** 2) + r + grain
            low_u, high_u = anchored - reach, anchored + reach
            if exact and sign != 0:
                low_u = max(low_u, sign * nearest - r - grain)
                high_u = min(high_u, sign * nearest + r + grain)
            if not meets(asked, low_u, high_u, c, grain):
                continue
            found = seen_in_bands(asked, c, errors, margin, value, room, max(lo, -hi))
        else:
            found = seen(errors, margin, value, room)
        low = max(low, found)
        bound = max(-lo, hi)
        good = bound <= max(asked.threshold, (1.0 + asked.tight) * low)
        if depth == 0:
            # If it is not good enough, each half is asked by itself.
            if good and low <= asked.enough:
                lows[:] = np.maximum(lows, found)
                highs[:] = bound
                brackets.counts[k, :] = True
                continue
        else:
            lows[half] = low
            brackets.counts[k, half] = True
            passed_on = bound == np.inf and (depth > asked.patience or sizes[size, 1] < 0)
            if low > asked.enough:
                highs[half] = np.inf
                continue
            if passed_on and brackets.open_count[0] < brackets.open_from.shape[0]:
                place = brackets.open_count[0]
                brackets.open_count[0] += 1
                brackets.open_from[place] = 2 * k + half
                brackets.open_triangles[place] = triangle
                continue
            if good or depth == _DEPTH or effort > asked.effort:
                highs[half] = max(highs[half], bound)
                continue
        _halve(parts, size, size + 1)
        sizes[size, 0] = depth + 1
        sizes[size + 1] = sizes[size]
        if depth == 0:
            sizes[size + 1, 2] = 1
        if sizes[size, 1] > 0:
            lists[size + 1, : sizes[size, 1]] = lists[size, : sizes[size, 1]]
        size += 2


@uncounted
def _halve(parts: Floats, at: int, other: int) -> None:
    """Put one half of triangle ``at`` in its place and the other one in place ``other``."""
    ax, ay, bx, by, cx, cy, aa, bb, cc, ab, bc, ca = parts[at]
    mx, my = 0.5 * (ax + bx), 0.5 * (ay + by)
    am, mb, mc = 0.5 * (aa + ab), 0.5 * (ab + bb), 0.5 * (ca + bc)
    mm = 0.5 * (am + mb)
    parts[at] = (cx, cy, ax, ay, mx, my, cc, aa, mm, ca, am, mc)
    parts[other] = (bx, by, cx, cy, mx, my, bb, cc, mm, bc, mc, mb)


@uncounted
def _listed(tree: Floats, kept: Ints, ids: Ints) -> int:
    """Fill the arclets under some nodes; how many they are, -1 if they are too many."""
    count = 0
    for node in kept:
        first, end = int(tree[node, 6]), int(tree[node, 7])
        if count + end - first > _MOST:
            return -1
        for i in range(first, end):
            ids[count] = i
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
    steepest = 0.0
    for pair in (
        (c[0] - c[5], c[3] - c[5]),
        (c[3] - c[4], c[1] - c[4]),
        (c[5] - c[2], c[4] - c[2]),
    ):
        # The gradient g has g . u = 2 pair[0] and g . v = 2 pair[1].
        x, y = pair[0] * vy - pair[1] * uy, pair[1] * ux - pair[0] * vx
        steepest = max(steepest, x * x + y * y)
    return float(scale * math.sqrt(steepest))


@kernel
def _bound(
    triangle: Floats,
    c: Floats,
    px: float,
    py: float,
    sign: int,
    chains: int,
    models: Floats,
    enough: float,
    spare: float,
    grain: float,
    errors: Floats,
) -> tuple[float, float, float]:
    """Lower and upper bound of the error on a triangle, and the margin of those at its corners.

    These are filled into ``errors``. The coefficients of each chain's difference are put behind
    its model, in models[:, 6:].
    """
    single = chains == 1 and models[0, 5] == 0.0
    scale = 1.0 if single else float(sign)
    ax, ay = triangle[2] - px, triangle[3] - py
    cx, cy = triangle[4] - px, triangle[5] - py
    lower, upper = -np.inf, -np.inf
    most_rest = 0.0
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
        least = min(q[0], q[1], q[2], q[3], q[4], q[5])
        most = max(q[0], q[1], q[2], q[3], q[4], q[5])
        lower = max(lower, least - rest)
        upper = max(upper, most + rest)
        most_rest = max(most_rest, rest)
    for v in range(3):
        value = -np.inf
        for m in range(chains):
            value = max(value, models[m, 6 + v])
        errors[v] = scale * value
    if chains > 1 and -lower > enough:
        lower = max(lower, _mean(models, chains, enough))
    upper += spare
    if scale < 0.0:
        lower, upper = -upper, -lower
    return lower - grain, upper + grain, most_rest + spare + grain


@kernel
def _mean(models: Floats, chains: int, enough: float) -> float:
    """A lower bound of the largest of all differences on a triangle: that of a mean of some (2.10).

    To the best one, another is added that is large where the mean is smallest, a few times.
    """
    one, best = 0, -np.inf
    for m in range(chains):
        least = models[m, 6:].min()
        if least > best:
            one, best = m, least
    mean = models[one, 6:].copy()
    rest = models[one, 4]
    bound = best - rest
    for _ in range(_ADDED):
        if -bound <= enough:
            break
        worst = 0
        for v in range(1, 6):
            if mean[v] < mean[worst]:
                worst = v
        other = 0
        for m in range(chains):
            if models[m, 6 + worst] > models[other, 6 + worst]:
                other = m
        q = models[other, 6:]
        share = _best_share(mean, q)
        rest = max(rest, models[other, 4])
        for v in range(6):
            mean[v] = share * mean[v] + (1.0 - share) * q[v]
        bound = max(bound, mean.min() - rest)
    return float(bound)


@uncounted
def _best_share(q: Floats, other: Floats) -> float:
    """The share of q in the mean of both that makes its smallest coefficient largest."""
    low, high = 0.0, 1.0
    for _ in range(_SHARE_STEPS):
        share = 0.5 * (low + high)
        least, rising = np.inf, 0.0
        for k in range(6):
            value = share * q[k] + (1.0 - share) * other[k]
            if value < least:
                least, rising = value, q[k] - other[k]
        if rising > 0.0:
            low = share
        else:
            high = share
    return 0.5 * (low + high)
