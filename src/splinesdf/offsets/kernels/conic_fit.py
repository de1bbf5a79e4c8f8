"""Runs of parallels as few conic arcs: tangents kept, the deviation under a tolerance.

Each arc is taken as long as the tolerance allows, which makes as few as can be; it ends at the
latest where the curve bends to the other side, as a conic cannot.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.tables import ROUND, STRAIGHT
from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.offsets.kernels.conic_arc import conic_arc, look, run_point
from splinesdf.offsets.tables import Fitted, Parallels, Path, RunArcs, Runs

# An arc is measured at so many times as many points before it is taken.
_FINER = 4.0
# Straight and round runs are cut to arcs of at most a quarter of a circle.
_QUARTER = 0.5 * math.pi + 1e-6
# Parts of an element whose bending is compared to find where it changes sides, and how much of a
# turn over the element's length counts as bending.
_PARTS, _BENDS = 8, 1e-9
# The next length that is tried as a share of one that fits; of one that does not when looked at
# closely; and how near to the longest an arc is long enough.
_GROWTH, _SHRINK, _NEAR = 1.7, 0.95, 0.03
# What a length is aimed at, and what is enough, as shares of the deviation allowed: the fifth root
# of the latter is within 5 % of the longest.
_AIM, _ENOUGH = 0.9, 0.8
# Points of one arc that are looked at, at most.
_ROOM = 4096
# No arc is shorter than this share of an element.
_SHORTEST = 1e-6
# What reaches no farther than this share of the tolerance is no reason to end an arc, whatever its
# directions: so small, they are rounding. Larger: tangents jump where a chord takes its place;
# smaller: next to ends that stand still, stubs by the thousand.
_LITTLE = 0.03
# Points of an element that are looked at for that.
_LOOKED = 6
# Arcs of all runs: a tolerance that takes more is below what anybody has a use for. More: memory.
MOST_ARCS = 2_000_000


@kernel
def fit_runs(parallels: Parallels, runs: Runs, tolerance: Floats, room: RunArcs) -> int:
    """Fill the arcs of all runs, in order; how many there are, even if there is no room for all.

    It ends early once there are more than `MOST_ARCS`.

    Parameters
    ----------
    parallels : Parallels
    runs : Runs
    tolerance : ndarray, shape (n_runs,)
    room : RunArcs
        Filled.
    """
    found = Fitted(room, np.zeros(1, dtype=np.int64))
    segments = runs.segments
    points = np.empty((_ROOM, 2))
    breaks = np.empty(_PARTS * 64 + 8)
    for r in range(runs.first.shape[0] - 1):
        begin, end = runs.first[r], runs.first[r + 1]
        path = Path(
            segments.elements[begin:end],
            segments.spans[begin:end],
            (segments.start[begin, 0], segments.start[begin, 1]),
            (segments.end[end - 1, 0], segments.end[end - 1, 1]),
            runs.closed[r],
        )
        kind = runs.kind[r]
        if kind == STRAIGHT:
            _straight(path, r, found)
        elif kind == ROUND:
            _round(path, (runs.center[r, 0], runs.center[r, 1]), runs.sweep[r], r, found)
        else:
            if _PARTS * (end - begin) + 8 > breaks.shape[0]:
                breaks = np.empty(2 * _PARTS * (end - begin) + 8)
            count = _find_breaks(parallels, path, breaks)
            _free(parallels, path, (r, count), tolerance[r], breaks, points, found)
    return int(found.total[0])


@uncounted
def _append(
    one: tuple[float, float, float, float, float, float, float], r: int, found: Fitted
) -> None:
    total, room = found.total[0], found.room
    if total < room.weights.shape[0]:
        arcs = room.arcs
        arcs[total, 0, 0], arcs[total, 0, 1] = one[0], one[1]
        arcs[total, 1, 0], arcs[total, 1, 1] = one[2], one[3]
        arcs[total, 2, 0], arcs[total, 2, 1] = one[4], one[5]
        room.weights[total] = one[6]
        room.owner[total] = r
    found.total[0] = total + 1


@uncounted
def _straight(path: Path, r: int, found: Fitted) -> None:
    ax, ay = path.start
    bx, by = path.end
    _append((ax, ay, 0.5 * (ax + bx), 0.5 * (ay + by), bx, by, 1.0), r, found)


@uncounted
def _round(path: Path, center: tuple[float, float], sweep: float, r: int, found: Fitted) -> None:
    """Arcs of a circle, equal ones; both ends of the run are kept to the bit."""
    x, y = center
    ax, ay = path.start
    ex, ey = path.end
    radius = 0.5 * (math.hypot(ax - x, ay - y) + math.hypot(ex - x, ey - y))
    began = math.atan2(ay - y, ax - x)
    # Tangents say how often it goes round; where it ends, the end itself.
    ended = math.atan2(ey - y, ex - x)
    sweep = ended - began + 2.0 * math.pi * round((sweep - ended + began) / (2.0 * math.pi))
    count = max(1, math.ceil(abs(sweep) / _QUARTER))
    half = 0.5 * sweep / count
    weight = math.cos(half)
    for k in range(count):
        angle = began + sweep * (k + 1) / count
        bx, by = x + radius * math.cos(angle), y + radius * math.sin(angle)
        if k == count - 1:
            bx, by = ex, ey
        angle -= half
        mx, my = x + radius / weight * math.cos(angle), y + radius / weight * math.sin(angle)
        _append((ax, ay, mx, my, bx, by, weight), r, found)
        ax, ay = bx, by


@uncounted
def _find_breaks(parallels: Parallels, path: Path, breaks: Floats) -> int:
    """Fill where a run must be cut, its ends included: where it bends to the other side."""
    stretches = path.spans.shape[0]
    breaks[0] = 0.0
    count = 1
    side = 0.0
    last = 0.0
    for k in range(stretches):
        for part in range(_PARTS + 1):
            place = k + part / _PARTS if part < _PARTS else k + 1.0
            # just before a joint and just behind it
            inside = place if part > 0 else k + 1e-9
            point = run_point(parallels, path, inside)
            now = point[5]
            if not abs(now) * abs(point[4]) > _BENDS:
                continue
            if now * side < 0.0:
                a, b = last, inside
                for _ in range(60):
                    middle = 0.5 * (a + b)
                    if middle in (a, b):
                        break
                    if run_point(parallels, path, middle)[5] * side > 0.0:
                        a = middle
                    else:
                        b = middle
                # not at a hair's breadth from a joint
                nearest = float(round(b))
                breaks[count] = nearest if abs(b - nearest) < 1e-8 else b
                if breaks[count] > breaks[count - 1] and breaks[count] < stretches:
                    count += 1
            side, last = now, inside
    breaks[count] = float(stretches)
    return count + 1


@uncounted
def _free(
    parallels: Parallels,
    path: Path,
    run: tuple[int, int],
    tolerance: float,
    breaks: Floats,
    points: Floats,
    found: Fitted,
) -> None:
    """Append as few arcs as can be between the breaks of a run."""
    r, count = run
    step = 1.0
    node = _node(parallels, path, 0.0)
    for b in range(count - 1):
        place, limit = breaks[b], breaks[b + 1]
        while place < limit and found.total[0] <= MOST_ARCS:
            at = _farthest(parallels, path, (place, limit, step), node, tolerance, points)
            while True:
                other = _node(parallels, path, at)
                off, px, py, w = conic_arc(
                    parallels, path, (place, at), (node, other), tolerance, _FINER, points
                )
                if off <= 1.0:
                    break
                if _is_little(parallels, path, (place, at), node, tolerance):
                    px, py, w = 0.5 * (node[0] + other[0]), 0.5 * (node[1] + other[1]), 1.0
                    break
                if at - place < _SHORTEST:
                    # Directions are rounding here, as next to a cusp: a chord has to do.
                    at = _chord(parallels, path, (place, limit), node, tolerance, points)
                    other = _node(parallels, path, at)
                    px, py, w = 0.5 * (node[0] + other[0]), 0.5 * (node[1] + other[1]), 1.0
                    break
                at = place + _SHRINK * (at - place)
            _append((node[0], node[1], px, py, other[0], other[1], w), r, found)
            step = at - place
            place, node = at, other


@uncounted
def _chord(
    parallels: Parallels,
    path: Path,
    span: tuple[float, float],
    node: tuple[float, float, float, float],
    tolerance: float,
    points: Floats,
) -> float:
    """How far a straight line from a place may go, at most to a limit, whatever its direction."""
    place, limit = span
    length = limit - place
    while True:
        at = limit if length == limit - place else place + length
        x, y, _, _ = _node(parallels, path, at)
        cx, cy = x - node[0], y - node[1]
        chord = math.hypot(cx, cy)
        start = node[0], node[1]
        worst = 0.0
        count = look(parallels, path, (place, at), start, 1.0, max(chord, tolerance), points)
        for k in range(count):
            px, py = points[k, 0] - node[0], points[k, 1] - node[1]
            share = (px * cx + py * cy) / (chord * chord) if chord > 0.0 else 0.0
            share = min(max(share, 0.0), 1.0)
            worst = max(worst, math.hypot(px - share * cx, py - share * cy))
        if (count > 0 and worst <= 0.5 * tolerance) or place + 0.5 * length <= place:
            return at
        length = 0.5 * length


@uncounted
def _farthest(
    parallels: Parallels,
    path: Path,
    span: tuple[float, float, float],
    node: tuple[float, float, float, float],
    tolerance: float,
    points: Floats,
) -> float:
    """About how far one arc from a place can go, at most to a limit; a first step is given."""
    place, limit, step = span
    low, high = 0.0, np.inf
    # not to leave a little piece before the limit
    length = limit - place if limit - place < 1.3 * step else step
    while True:
        at = limit if place + length >= limit else place + length
        other = _node(parallels, path, at)
        off, _, _, _ = conic_arc(
            parallels, path, (place, at), (node, other), tolerance, 1.0, points
        )
        if off <= 1.0:
            low = length
            if at == limit:
                return limit
            if off > _ENOUGH:
                return at
        elif _is_little(parallels, path, (place, at), node, tolerance):
            low = length
            if at == limit:
                return limit
        else:
            high = length
        if high < _SHORTEST:
            return min(place + _SHORTEST, limit)
        if high - low < _NEAR * low:
            return place + low
        # The error grows with the fifth power of the length.
        length *= min(max((_AIM / max(off, 1e-9)) ** 0.2, 0.3), _GROWTH)
        if not low < length < high:
            length = _GROWTH * low if high == np.inf else 0.5 * (low + high)


@uncounted
def _is_little(
    parallels: Parallels,
    path: Path,
    span: tuple[float, float],
    node: tuple[float, float, float, float],
    tolerance: float,
) -> bool:
    """Whether a part of a run stays within a share of the tolerance about its start."""
    place, end = span
    count = _LOOKED * (math.ceil(end) - int(place))
    for k in range(count, 0, -1):
        at = place + (end - place) * k / count
        row = run_point(parallels, path, at)
        if math.hypot(row[0] - node[0], row[1] - node[1]) > _LITTLE * tolerance:
            return False
    return True


@uncounted
def _node(parallels: Parallels, path: Path, place: float) -> tuple[float, float, float, float]:
    """Point and tangent where an arc may end; the run's own ends to the bit."""
    x, y, tx, ty, _, _ = run_point(parallels, path, place)
    if place == 0.0:
        x, y = path.start
    elif place == path.spans.shape[0]:
        x, y = path.end
        if path.closed:
            _, _, tx, ty, _, _ = run_point(parallels, path, 0.0)
    return x, y, tx, ty
