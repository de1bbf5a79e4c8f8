"""Disks that touch three arcs of a face at least: where branches of a medial axis meet.

Unknown are the center c and the radius r; of each arc the foot p of the center is known, so that
|c - p| - r has the gradient ((c - p) / |c - p|, -1): three such equations are solved by Newton's
method. A disk that another arc of the face reaches into is given up for one that touches that arc.
"""

from __future__ import annotations

import math

from splinesdf.arclets.kernels.arclet import derivatives, point_on
from splinesdf.arclets.kernels.nearest import room_to_search, search
from splinesdf.arclets.tables import Searched
from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.medial.kernels.frames import FIRST, NONE, ROOT, frame
from splinesdf.medial.tables import FAN, KIND, OWNER, ROUND, STRAIGHT, Arcs, Met, Walk

# Steps of Newton's method, and triples of arcs that are tried for one face. At these ceilings the
# face is divided by more chords.
_STEPS, _TRIPLES = 60, 24
# A step of the center that is this share of the largest coordinate changes nothing.
_STILL = 1e-16
# Parts of an arclet in which feet are looked for: arclets turn by less than half a right angle.
_PARTS = 4
_FAR = math.inf


@kernel
def junctions(
    searched: Searched, walk: Walk, arcs: Arcs, guess: Floats, near: float, met: Met
) -> None:
    """Fill for each face an empty disk that touches three of its arcs, and how many it touches.

    Parameters
    ----------
    searched, walk : Searched, Walk
    arcs : Arcs
        Of each face at least three.
    guess : ndarray, shape (n_faces, 3)
        Center and radius of some disk near by.
    near : float
        Distances from the center that differ by less are equal.
    met : Met
        Filled.
    """
    scratch = room_to_search(searched.arcs)
    for f in range(guess.shape[0]):
        met.found[f] = 0
        first, count = arcs.first[f], arcs.first[f + 1] - arcs.first[f]
        a, b, c = FIRST, count // 3, (2 * count) // 3
        tried = 0
        x, y, r = guess[f, 0], guess[f, 1], guess[f, 2]
        while tried < _TRIPLES:
            tried += 1
            solved, x, y, r = _solve(walk, arcs, first, (a, b, c), (x, y, r), met, near)
            if not solved:
                if count > 12:
                    break
                # Without a lead all triples are tried in turn.
                c += 1
                if c == count:
                    b += 1
                    c = b + 1
                    if c >= count:
                        a += 1
                        b, c = a + 1, a + 2
                        if c >= count:
                            a, b, c = 0, 1, 2
                x, y, r = guess[f, 0], guess[f, 1], guess[f, 2]
                continue
            worst, least, touched = NONE, r - near, 0
            for k in range(count):
                d = _foot(walk, arcs, first + k, x, y, met)
                if abs(d - r) <= near:
                    touched += 1
                if d < least:
                    worst, least = k, d
            if worst < 0:
                scratch.nodes[0] = 0
                _, hit, _ = search(
                    searched.tree, searched.arcs, (x, y), r - near, ROOT, NONE, -1.0, scratch
                )
                if hit < 0 and touched >= 3:
                    met.found[f] = touched
                    met.center[f, 0], met.center[f, 1], met.radius[f] = x, y, r
                    met.chosen[f, 0], met.chosen[f, 1], met.chosen[f, 2] = a, b, c
                break
            # The arc that reaches in takes the place of the one that leaves the smallest disk.
            best, keep = r, 0
            bx, by, br = x, y, r
            for out in range(3):
                ta, tb, tc = _with(a, b, c, out, worst)
                ok, sx, sy, sr = _solve(walk, arcs, first, (ta, tb, tc), (x, y, r), met, near)
                left = a if out == 0 else (b if out == 1 else c)
                if (
                    ok
                    and sr < best + near
                    and _foot(walk, arcs, first + left, sx, sy, met) >= sr - near
                ):
                    best, keep = sr, out + 1
                    bx, by, br = sx, sy, sr
            if keep == 0:
                break
            a, b, c = _with(a, b, c, keep - 1, worst)
            x, y, r = bx, by, br


@uncounted
def _with(a: int, b: int, c: int, out: int, other: int) -> tuple[int, int, int]:
    """Three numbers in order, one of them replaced."""
    if out == 0:
        a = other
    elif out == 1:
        b = other
    else:
        c = other
    if a > b:
        a, b = b, a
    if b > c:
        b, c = c, b
    if a > b:
        a, b = b, a
    return a, b, c


@uncounted
def _solve(
    walk: Walk,
    arcs: Arcs,
    first: int,
    three: tuple[int, int, int],
    disk: tuple[float, float, float],
    met: Met,
    near: float,
) -> tuple[bool, float, float, float]:
    """The disk that touches three arcs, by Newton's method from another one."""
    x, y, r = disk
    i, j, k = first + three[0], first + three[1], first + three[2]
    scale = r
    before = _FAR
    for step in range(_STEPS):
        ax, ay, ad = _arm(walk, arcs, i, x, y, met)
        bx, by, bd = _arm(walk, arcs, j, x, y, met)
        cx, cy, cd = _arm(walk, arcs, k, x, y, met)
        # Differences leave two equations for the center.
        ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
        f, g = bd - ad, cd - ad
        det = ux * vy - uy * vx
        if det == 0.0 or det != det:
            return False, x, y, r
        dx, dy = -(f * vy - g * uy) / det, -(ux * g - vx * f) / det
        length = math.sqrt(dx * dx + dy * dy)
        most = max(ad, 0.25 * scale)
        if length > most:
            dx, dy = dx * most / length, dy * most / length
        x, y = x + dx, y + dy
        r = (ad + bd + cd) / 3.0
        off = max(abs(f), abs(g))
        if length <= _STILL * scale or (off <= 0.01 * near and length >= 0.5 * before and step > 2):
            break
        before = length
    ad = _foot(walk, arcs, i, x, y, met)
    bd = _foot(walk, arcs, j, x, y, met)
    cd = _foot(walk, arcs, k, x, y, met)
    r = (ad + bd + cd) / 3.0
    good = max(abs(ad - r), abs(bd - r), abs(cd - r)) <= near
    return good and x == x, x, y, r


@uncounted
def _arm(
    walk: Walk, arcs: Arcs, k: int, x: float, y: float, met: Met
) -> tuple[float, float, float]:
    """Unit vector from the foot of a point on an arc, and the distance."""
    d = _foot(walk, arcs, k, x, y, met)
    px, py, nx, ny = frame(walk, met.element[k], met.at[k])
    if d > 0.0:
        kind = walk.element[met.element[k], KIND]
        if kind != STRAIGHT:
            return (x - px) / d, (y - py) / d, d
        mx, my = (x - px) / d, (y - py) / d
        # Off the ends of a straight arc its foot is a point.
        if mx * nx + my * ny < 0.999999999:
            return mx, my, d
    return nx, ny, d


@uncounted
def _foot(walk: Walk, arcs: Arcs, k: int, x: float, y: float, met: Met) -> float:
    """The distance of a point from an arc; its foot there is filled in."""
    e, last = arcs.element[k, 0], arcs.element[k, 1]
    low = arcs.at[k, 0]
    best = _FAR
    while True:
        high = arcs.at[k, 1] if e == last else 1.0
        d, u = _foot_on(walk, e, low, high, x, y)
        if d < best:
            best = d
            met.element[k], met.at[k] = e, u
        if e == last:
            break
        e, low = arcs.after[e], 0.0
    met.distance[k] = best
    return float(best)


@uncounted
def _foot_on(
    walk: Walk, e: int, low: float, high: float, x: float, y: float
) -> tuple[float, float]:
    """Distance of a point from a part of an element, and the parameter of its foot there."""
    i = walk.element[e, OWNER]
    kind = walk.element[e, KIND]
    arcs = walk.arcs
    if kind == FAN:
        px, py = point_on(arcs, i, 1.0)
        vx, vy = x - px, y - py
        tx, ty = walk.numbers[e, 0], walk.numbers[e, 1]
        u = math.atan2(-ty * vy - tx * vx, -ty * vx + tx * vy) / walk.numbers[e, 7]
        return math.sqrt(vx * vx + vy * vy), min(max(u, low), high)
    degree = int(arcs[i, 0])
    if degree == 1:
        vx, vy = x - arcs[i, 3], y - arcs[i, 4]
        t = min(max((vx * arcs[i, 5] + vy * arcs[i, 6]) * arcs[i, 7], low), high)
        px, py = point_on(arcs, i, t)
        if low < t < high:
            # Along the normal: rounding in the foot is not in the distance.
            return abs(-(x - px) * walk.numbers[e, 1] + (y - py) * walk.numbers[e, 0]), t
        return math.sqrt((x - px) ** 2 + (y - py) ** 2), t
    px, py = point_on(arcs, i, low)
    best, at = (x - px) ** 2 + (y - py) ** 2, low
    px, py = point_on(arcs, i, high)
    other = (x - px) ** 2 + (y - py) ** 2
    if other < best:
        best, at = other, high
    before = _slope(arcs, i, low, x, y)
    a = low
    for part in range(1, _PARTS + 1):
        b = low + (high - low) * part / _PARTS
        slope = _slope(arcs, i, b, x, y)
        if before < 0.0 <= slope:
            t = _root(arcs, i, (a, b), x, y)
            px, py = point_on(arcs, i, t)
            other = (x - px) ** 2 + (y - py) ** 2
            if other <= best:
                best, at = other, t
        a, before = b, slope
    if kind == ROUND and low < at < high:
        vx, vy = x - walk.numbers[e, 4], y - walk.numbers[e, 5]
        return abs(math.sqrt(vx * vx + vy * vy) - abs(walk.numbers[e, 6])), at
    return math.sqrt(best), at


@uncounted
def _slope(arcs: Floats, i: int, t: float, x: float, y: float) -> float:
    """(c(t) - p) . c'(t) of an arclet."""
    cx = cy = dx = dy = 0.0
    for k in range(3 + 2 * int(arcs[i, 0]), 3, -2):
        dx, dy = dx * t + cx + arcs[i, k], dy * t + cy + arcs[i, k + 1]
        cx, cy = (cx + arcs[i, k]) * t, (cy + arcs[i, k + 1]) * t
    return float((cx + arcs[i, 3] - x) * dx + (cy + arcs[i, 4] - y) * dy)


@uncounted
def _root(arcs: Floats, i: int, span: tuple[float, float], x: float, y: float) -> float:
    """Where (c(t) - p) . c'(t) goes from negative to positive: Newton's method within a bracket."""
    low, high = span
    t = 0.5 * (low + high)
    for _ in range(60):
        cx, cy, dx, dy, ddx, ddy = derivatives(arcs, i, t)
        cx, cy = cx + arcs[i, 3] - x, cy + arcs[i, 4] - y
        h = cx * dx + cy * dy
        slope = dx * dx + dy * dy + (cx * ddx + cy * ddy)
        if h < 0.0:
            low = t
        else:
            high = t
        moved = t - h / slope if slope > 0.0 else low - 1.0
        if not low <= moved <= high:
            moved = 0.5 * (low + high)
        step = abs(moved - t)
        t = moved
        if step <= 1e-16 or high - low <= 1e-16:
            break
    return t


@kernel
def feet(walk: Walk, arcs: Arcs, centers: Floats, met: Met) -> None:
    """Fill the feet of points, one for each arc, and their distances."""
    for k in range(centers.shape[0]):
        _foot(walk, arcs, k, centers[k, 0], centers[k, 1], met)
