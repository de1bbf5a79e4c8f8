"""Which parts of the parallel curves are the offset: those that nothing else is nearer to.

A point of the parallel at the distance d is on the offset if the open disk of radius |d| around it
is empty. For a stretch of it, of radius r around its middle p, that is decided at once for all
its points where possible, otherwise for its halves:

* something is nearer to p than |d| - r: nothing of the stretch is on the offset;
* an arclet is farther from p than |d| + r: it does not matter for this stretch;
* between, the arclet's distance along the stretch has the value e, the slope e' and, by the
  ranges of both curvatures, a second derivative in a known range. That proves it to stay beyond
  |d|, or to stay below, or to be monotone: then it passes |d| once, and where is found by
  iteration.

The arclet's own chain, as far as it turns by less than half a turn and neither has a corner
toward the offset nor bends by more than 1 / |d| toward it, cannot enter the disk (Schur's
theorem), so it is not looked at. Where a chain does bend by more, the parallel has turning points;
the stretches between them are also compared with the exact distance at their ends.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.nearest import room_to_search
from splinesdf.arclets.tables import Scratch
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.offsets.kernels.clearance import bend_range, clearance_at, clip
from splinesdf.offsets.kernels.gather import gather, is_near, one_is_nearer, surfaces
from splinesdf.offsets.kernels.parallels import parallel_point
from splinesdf.offsets.tables import Chains, Parallels, Trimmed, Walls, Workroom

# Halvings of an arclet to separate where its parallel runs forward from where it runs backward.
# What is then undecided is 1/4096 of it next to a turning point, less than 1e-14 of the offset.
_TURNING = 12
# The parallel of an arclet is but a point if it is shorter by this factor, as that of a circle at
# its own radius. Larger: what is left out may be larger than a speck (see `offsets.loops`);
# smaller: rounding in curvatures, some 1e-11, makes thousands of stretches of such a point.
_POINT = 1e-9
# An arclet that may bend without limit, next to a cusp, is taken in so many equal parts.
_CUSP_PARTS = 64
# A stretch whose reach is not small against |d| is halved rather than compared with more than a few
# arclets, as most of it will soon be seen to be no offset at all. More: time is spent on those;
# fewer: on stretches.
_COARSE, _FEW = 32.0, 24
# Of each stretch between turning points, so many parts have their ends compared.
_COMPARED = 4
# Parts of a stretch that are looked at to find one to which nothing is nearer; each is a quarter of
# it at most. More: time, next to cusps, where nothing is proved; fewer: short ones are missed.
_LOOKED = 32
# Steps to where the offset is left. Bisection alone would need 53; the secants need about 8.
_STEPS = 80
# By how much a disk may be entered, in grains, before a stretch that is compared is cut: normals
# next to where a curve stands still are noisy. Larger: cuts are farther from the corners that they
# are moved to, and small turning points are missed.
_ENTERED = 64.0
# Stretches of one element that are looked at. Only where two boundaries are |d| apart to rounding
# over a length are there so many; from then on, stretches that reach no farther than a share of
# |d| count as their middles do.
_PATIENCE, _IMPATIENT = 5_000, 1e-5
# Stretches that are looked at in all: minutes. More: what has no end in sight goes on; fewer: what
# has one is refused.
MOST_LOOKS = 50_000_000


@kernel
def trim(
    parallels: Parallels,
    walls: Walls,
    chains: Chains,
    smooth: float,
    shortest: float,
    elements: Ints,
    spans: Floats,
) -> int:
    """Fill the stretches of parallels and arcs around corners that are the offset, in order.

    Parameters
    ----------
    parallels : Parallels
    walls : Walls
    chains : Chains
    smooth : float
        A joint that turns by less (radians) is none.
    shortest : float
        A stretch that reaches no farther counts as its middle does.
    elements : ndarray, shape (room, 2)
        Filled: the arclet, and 1 for the arc around its end.
    spans : ndarray, shape (room, 2)
        Filled: the parameters where the stretch starts and ends.

    Returns
    -------
    int
        How many there are; if more than there is room for, only those are filled; -1 if more
        than `MOST_LOOKS` would have to be looked at.
    """
    room = Workroom(
        np.empty((_CUSP_PARTS + 2**_TURNING, 2)),
        np.empty(4 * walls.arcs.shape[0] + 1024, dtype=np.int64),
        np.empty((4096, 4)),
        np.empty((_LOOKED + 2, 2)),
        room_to_search(walls.arcs),
    )
    counts = np.zeros(3, dtype=np.int64)
    _trim(parallels, walls, chains, (smooth, shortest), room, Trimmed(elements, spans, counts))
    return -1 if counts[2] > MOST_LOOKS else int(counts[0])


@uncounted
def _trim(
    parallels: Parallels,
    walls: Walls,
    chains: Chains,
    limits: tuple[float, float],
    room: Workroom,
    found: Trimmed,
) -> None:
    """Fill the stretches, see `trim`, unless there is too much to look at."""
    order, loops, reach = chains.order, chains.loops, chains.reach
    turn, distance = parallels.turn, parallels.distance
    radius = abs(distance)
    smooth, shortest = limits
    parts, counts = room.parts, found.counts
    for j in range(loops.shape[0] - 1):
        first, size = loops[j], loops[j + 1] - loops[j]
        for p in range(size):
            i = order[first + p]
            for corner in range(2):
                if corner and not turn[i] * distance > smooth * radius:
                    continue
                after = (p + 1) % size
                behind, ahead = reach[first + p, 1], reach[first + p, 0]
                compared = reach[first + p, 2] > 0
                if corner:
                    ahead = 1 + reach[first + after, 0]
                    compared = compared or reach[first + after, 2] > 0
                own = (first, p - behind, min(behind + ahead + 1, size))
                element = (i, corner)
                count = 1
                parts[0, 0], parts[0, 1] = 0.0, 1.0
                if not corner and chains.bent[i]:
                    count = _forward(parallels, walls.bends, element, parts)
                counts[1] = counts[0]
                for k in range(count):
                    _trim_stretch(
                        parallels,
                        walls,
                        chains.place,
                        (element, (parts[k, 0], parts[k, 1]), own, compared),
                        shortest,
                        room,
                        found,
                    )
                    if counts[2] > MOST_LOOKS:
                        return


@uncounted
def _forward(parallels: Parallels, bends: Floats, element: tuple[int, int], parts: Floats) -> int:
    """The parts of a bent arclet where its parallel runs forward, in order; how many."""
    i = element[0]
    distance = parallels.distance
    row = bends[i]
    if 1.0 + max(row[0] * distance, row[1] * distance) <= _POINT:
        return 0
    # Of 1 + kappa d with the parameter.
    change = abs(distance) * bends[i, 2] * bends[i, 9]
    count = 0
    if not change < np.inf:
        for k in range(_CUSP_PARTS):
            a, b = k / _CUSP_PARTS, (k + 1) / _CUSP_PARTS
            middle = parallel_point(parallels, element, 0.5 * (a + b))
            if middle[4] > 0.0:
                parts[count, 0], parts[count, 1] = a, b
                count += 1
        return count
    at, depth = 0, 0  # the part from at / 2^depth to (at + 1) / 2^depth
    while True:
        width = 1.0 / (1 << depth)
        a = at * width
        middle = parallel_point(parallels, element, a + 0.5 * width)
        # 1 / (1 + kappa d), from the curvature of the parallel
        bound = 0.5 * width * change
        # 1 + kappa d = 1 / (1 - d curvature)
        value = 1.0 / (1.0 - distance * middle[5]) if middle[5] < np.inf else 0.0
        decided = depth == _TURNING or abs(value) > bound
        if decided:
            if value > 0.0 and (depth < _TURNING or value > bound):
                parts[count, 0], parts[count, 1] = a, a + width
                count += 1
            while depth > 0 and at & 1:
                at >>= 1
                depth -= 1
            if depth == 0:
                return count
            at += 1
        else:
            at, depth = 2 * at, depth + 1


@uncounted
def _trim_stretch(
    parallels: Parallels,
    walls: Walls,
    place: Ints,
    stretch: tuple[tuple[int, int], tuple[float, float], tuple[int, int, int], bool],
    shortest: float,
    room: Workroom,
    found: Trimmed,
) -> None:
    """Append what is left of one stretch, see `trim`."""
    element, (start, stop), own, compared = stretch
    near, stack, scratch = room.near, room.stack, room.scratch
    counts = found.counts
    distance = parallels.distance
    radius, grain = abs(distance), walls.grain
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = start, stop, -1.0, 0.0
    size, looked = 1, 0
    while size > 0 and counts[2] <= MOST_LOOKS:
        size -= 1
        a, b, base, number = (
            stack[size, 0],
            stack[size, 1],
            int(stack[size, 2]),
            int(stack[size, 3]),
        )
        looked += 1
        counts[2] += 1
        m = 0.5 * (a + b)
        middle = parallel_point(parallels, element, m)
        x, y = middle[0], middle[1]
        ax, ay, _, _, _, _ = parallel_point(parallels, element, a)
        bx, by, _, _, _, _ = parallel_point(parallels, element, b)
        reach = math.sqrt((ax - x) ** 2 + (ay - y) ** 2)
        reach = max(reach, math.sqrt((bx - x) ** 2 + (by - y) ** 2)) + grain
        if base < 0:
            if is_near(walls, x, y, radius - reach, scratch):
                continue
            most = near.shape[0] // 2
            if _COARSE * reach > radius and size + 2 < stack.shape[0] and a < m < b:
                most = _FEW
            # No point of the stretch is farther from its chord.
            least, bend = bend_range(walls.bends, distance, element, middle[5], b - a)
            bent, length = max(abs(least), abs(bend)), 1.12 * reach
            bulge = 0.5 * bent * length**2 + grain
            number = gather(
                walls.tree,
                place,
                (x, y, radius + reach),
                ((ax, ay, bx, by), radius + bulge),
                own,
                near,
                most,
                scratch.nodes,
            )
            if number < 0:
                # Long walls side by side: one of them does what halving would do without end.
                if one_is_nearer(
                    parallels, walls, place, (element, a, b), own, (bent, length), scratch
                ):
                    continue
                stack[size, 0], stack[size, 1], stack[size, 2] = m, b, -1.0
                stack[size + 1, 0], stack[size + 1, 1], stack[size + 1, 2] = a, m, -1.0
                size += 2
                continue
            base, top = 0, number
        else:
            top = base + number
        low, high, left, gone = clip(
            parallels, walls, (element, a, b, reach), (base, number, top), near, scratch
        )
        if gone:
            continue
        if left > 0:
            small = reach <= shortest or not a < m < b
            small = small or (looked > _PATIENCE and reach <= _IMPATIENT * radius)
            if not small and size + 2 < stack.shape[0] and top + left < near.shape[0]:
                if 2 * left > number:
                    # few have gone: the halves share the list as it was, which costs no room
                    left, top = number, base
                m = 0.5 * (low + high)
                stack[size, 0], stack[size, 1], stack[size, 2], stack[size, 3] = m, high, top, left
                stack[size + 1, 0], stack[size + 1, 1] = low, m
                stack[size + 1, 2], stack[size + 1, 3] = top, left
                size += 2
                continue
            beyond = True
            for k in range(left):
                j = near[top + k]
                beyond = beyond and clearance_at(parallels, walls, element, j, m, scratch) > 0.0
            if not beyond:
                continue
        if compared:
            _compare(parallels, walls, element, (low, high), shortest, room, found)
        else:
            _append(element, (low, high), found)


@uncounted
def _compare(
    parallels: Parallels,
    walls: Walls,
    element: tuple[int, int],
    span: tuple[float, float],
    shortest: float,
    room: Workroom,
    found: Trimmed,
) -> None:
    """Append the parts of a stretch at whose points nothing is nearer than |d|."""
    low, high = span
    scratch = room.scratch
    point = parallel_point(parallels, element, low)
    limit = abs(parallels.distance) - _ENTERED * walls.grain
    before = is_near(walls, point[0], point[1], limit, scratch)
    began = last = low
    for k in range(1, _COMPARED + 1):
        t = high if k == _COMPARED else low + (high - low) * k / _COMPARED
        point = parallel_point(parallels, element, t)
        now = is_near(walls, point[0], point[1], limit, scratch)
        if now and before:
            clear = surfaces(
                parallels, walls, element, (last, t), (limit, shortest), room.spans, scratch
            )
            if last < clear < t:
                began = _changes(parallels, walls, element, (clear, last), limit, scratch)
                ends = _changes(parallels, walls, element, (clear, t), limit, scratch)
                _append(element, (began, ends), found)
        elif now:
            ends = _changes(parallels, walls, element, (last, t), limit, scratch)
            _append(element, (began, ends), found)
        elif before:
            began = _changes(parallels, walls, element, (t, last), limit, scratch)
        last, before = t, now
    if not before:
        _append(element, (began, high), found)


@uncounted
def _changes(
    parallels: Parallels,
    walls: Walls,
    element: tuple[int, int],
    span: tuple[float, float],
    limit: float,
    scratch: Scratch,
) -> float:
    """The last parameter, from the first one on, at which nothing is nearer than the limit."""
    clear, near = span
    for _ in range(_STEPS):
        m = 0.5 * (clear + near)
        if m in (clear, near):
            break
        point = parallel_point(parallels, element, m)
        if is_near(walls, point[0], point[1], limit, scratch):
            near = m
        else:
            clear = m
    return clear


@uncounted
def _append(element: tuple[int, int], span: tuple[float, float], found: Trimmed) -> None:
    """One more stretch, or a longer last one if that ended here."""
    elements, spans = found.elements, found.spans
    total, since = found.counts[0], found.counts[1]
    if since < total <= spans.shape[0] and spans[total - 1, 1] == span[0]:
        spans[total - 1, 1] = span[1]
        return
    if total < spans.shape[0]:
        elements[total, 0], elements[total, 1] = element
        spans[total, 0], spans[total, 1] = span
    found.counts[0] = total + 1
