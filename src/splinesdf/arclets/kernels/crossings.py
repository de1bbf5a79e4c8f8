r"""Where arclets cross or touch: pairs whose boxes overlap, then the roots of one smooth function.

Two arclets whose directions leave a gap can both be seen as graphs over one axis u:

      v                  b     The offset e(u) = v_a(u) - v_b(u) is smooth; where it changes sign
      |   a    ____---         the arclets cross. It is interpolated by polynomials of degree 7,
      |     \_/                halved until they fit: the Bernstein coefficients then show roots
      +-----------------> u    and, if all are within the tolerance, arcs on top of each other.

Ends that lie within the tolerance on the other arclet are found by themselves, so that touching
in a corner, T-junctions and the ends of a common stretch do not depend on the sign of rounding.
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.arclet import below, point_on
from splinesdf.arclets.tables import Interpolation, Met
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel, uncounted

# Pairs of nodes that wait to be looked at: a walk of two balanced trees over 2^60 arclets.
_STACK = 512
# Halvings of a common stretch. Where a cusp makes the offset as steep as a root, halving goes on
# until the rest is below the tolerance, 2^-47 of the size.
DEPTH = 50
# An end and the other arclet at the same u may be this many times farther apart than they are:
# the steepest graph has a slope of 2.4.
_STEEP = 2.6
_STEPS = 80
_LAST_STEP = 1e-9
_LAST_BISECTION = 1e-16


@kernel
def fill_crossings(
    boxes: Floats,
    ranges: Ints,
    following: Ints,
    arcs: Floats,
    cone: Floats,
    tolerance: float,
    interpolation: Interpolation,
    met: Met,
) -> None:
    """Fill pairs of arclets and the parameters at which they cross, touch, or begin to coincide.

    Parameters
    ----------
    boxes, ranges, following, arcs : ndarray
        Of `Arclets`.
    cone : ndarray, shape (n, 2)
        Middle and half width of the directions of each arclet, as angles.
    tolerance : float
        Nearer than this counts as touching.
    interpolation : Interpolation
    met : Met
        Filled.
    """
    stack = np.empty((_STACK, 2), dtype=np.int64)
    stack[0, 0] = stack[0, 1] = 0
    size = 1
    looked = 0
    while size > 0:
        size -= 1
        one, other = stack[size, 0], stack[size, 1]
        if one != other and not _boxes_meet(boxes, one, other, tolerance):
            continue
        count_one = ranges[one, 1] - ranges[one, 0]
        count_other = ranges[other, 1] - ranges[other, 0]
        if count_one == 1 and count_other == 1:
            if one != other:
                looked += 1
                if met.found[0] > met.most[0] or looked > met.most[1]:
                    met.found[1] = 1
                    return
                i, j = ranges[one, 0], ranges[other, 0]
                _meet(arcs, following, cone, tolerance, interpolation, i, j, met)
            continue
        if count_one < count_other:
            one, other = other, one
        left, right = below(one, ranges[one, 0], ranges[one, 1])
        if one == other:
            stack[size, 0], stack[size, 1] = left, right
            stack[size + 1, 0], stack[size + 1, 1] = left, left
            stack[size + 2, 0], stack[size + 2, 1] = right, right
            size += 3
        else:
            stack[size, 0], stack[size, 1] = left, other
            stack[size + 1, 0], stack[size + 1, 1] = right, other
            size += 2


@uncounted
def _boxes_meet(boxes: Floats, one: int, other: int, tolerance: float) -> bool:
    return bool(
        boxes[one, 0] <= boxes[other, 2] + tolerance
        and boxes[other, 0] <= boxes[one, 2] + tolerance
        and boxes[one, 1] <= boxes[other, 3] + tolerance
        and boxes[other, 1] <= boxes[one, 3] + tolerance
    )


@uncounted
def _meet(
    arcs: Floats,
    following: Ints,
    cone: Floats,
    tolerance: float,
    interpolation: Interpolation,
    i: int,
    j: int,
    met: Met,
) -> None:
    """Add the places where arclets i and j meet, other than a joint of theirs."""
    joined, back = following[i] == j, following[j] == i
    if joined != back:
        # Seen from the joint, one runs backwards. Directions that have none in common, but for
        # what rounding does to them, never lead to the same place again.
        turn = _remainder(cone[i, 0] - cone[j, 0] + math.pi, 2.0 * math.pi)
        shorter = min(_chord(arcs, i), _chord(arcs, j))
        if (abs(turn) - cone[i, 1] - cone[j, 1]) * shorter > tolerance:
            return
    ux, uy = _axis(cone, i, j)
    low_i, high_i = _reach(arcs, i, ux, uy)
    low_j, high_j = _reach(arcs, j, ux, uy)
    low, high = max(low_i, low_j), min(high_i, high_j)
    if high < low - tolerance:
        return
    for end in range(4):
        a, b = (i, j) if end < 2 else (j, i)
        t = float(end % 2)
        x, y = point_on(arcs, a, t)
        other_t = _at(arcs, b, ux, uy, x * ux + y * uy)
        other_x, other_y = point_on(arcs, b, other_t)
        if math.hypot(x - other_x, y - other_y) > _STEEP * tolerance:
            continue
        if end < 2:
            t_i, t_j = t, other_t
        else:
            t_i, t_j = other_t, t
        is_joint = (joined and t_i == 1.0 and t_j == 0.0) or (back and t_i == 0.0 and t_j == 1.0)
        if not is_joint:
            _add(met, i, t_i, j, t_j)
    if high - low <= tolerance:
        return
    if arcs[i, 0] == 1.0 and arcs[j, 0] == 1.0:
        at_low, at_high = _offset(arcs, i, j, ux, uy, low), _offset(arcs, i, j, ux, uy, high)
        # On top of each other they have no crossing but the ends of their common stretch.
        if at_low * at_high < 0.0 and max(abs(at_low), abs(at_high)) > tolerance:
            u = low + (high - low) * at_low / (at_low - at_high)
            t, s = _at(arcs, i, ux, uy, u), _at(arcs, j, ux, uy, u)
            _add(met, i, t, j, s)
        return
    values, control, spans = interpolation.values, interpolation.control, interpolation.spans
    nodes, to_control = interpolation.nodes, interpolation.to_control
    to_checks = interpolation.to_checks
    # Places in ``control``, as variables: for each literal `_beside` would be compiled anew.
    start, end = int(np.int64(0)), int(np.int64(7))
    spans[0, 0], spans[0, 1] = low, high
    least, most = low, high
    size = 1
    while size > 0:
        size -= 1
        low, high = spans[size, 0], spans[size, 1]
        for k in range(15):
            values[k] = _offset(arcs, i, j, ux, uy, low + (high - low) * nodes[k])
        miss = 0.0
        for k in range(7):
            guess = 0.0
            for m in range(8):
                guess += to_checks[k, m] * values[m]
            miss = max(miss, abs(values[8 + k] - guess))
        smallest, largest = np.inf, -np.inf
        changes = 0
        last = 0.0
        for k in range(8):
            control[k] = 0.0
            for m in range(8):
                control[k] += to_control[k, m] * values[m]
            smallest, largest = min(smallest, control[k]), max(largest, control[k])
            if control[k] * last < 0.0:
                changes += 1
            if control[k] != 0.0:
                last = control[k]
        at_low, at_high = values[0], values[7]
        # Zero in an end, as in a joint: what is beside it tells whether the arcs cross again.
        if low == least and at_low == 0.0:
            at_low = _beside(control, start, tolerance)
        if high == most and at_high == 0.0:
            at_high = _beside(control, end, tolerance)
        # A zero where two halves meet belongs to one of them.
        crosses = (at_low < 0.0) != (at_high < 0.0)
        if smallest > 2.0 * miss or largest < -2.0 * miss:
            continue
        flat = max(largest, -smallest) + miss <= tolerance
        if flat and low == least and high == most:
            return
        fits = miss <= 0.25 * tolerance
        if flat or (fits and changes <= 1) or high - low <= tolerance or size + 2 > DEPTH:
            if crosses:
                u = 0.5 * (low + high)
                if not flat:
                    u = _root(arcs, i, j, ux, uy, (low, high), (at_low, at_high))
                _add(met, i, _at(arcs, i, ux, uy, u), j, _at(arcs, j, ux, uy, u))
            continue
        middle = 0.5 * (low + high)
        spans[size, 0], spans[size, 1] = low, middle
        spans[size + 1, 0], spans[size + 1, 1] = middle, high
        size += 2


@uncounted
def _add(met: Met, i: int, t: float, j: int, s: float) -> None:
    found = met.found[0]
    if found < met.pair.shape[0]:
        met.pair[found, 0], met.pair[found, 1] = i, j
        met.at[found, 0], met.at[found, 1] = t, s
    met.found[0] = found + 1


@uncounted
def _axis(cone: Floats, i: int, j: int) -> tuple[float, float]:
    """The unit vector along which both arclets move on: across the widest gap in directions."""
    # Directions that differ by half a turn are the same here.
    turn = _remainder(cone[j, 0] - cone[i, 0], math.pi)
    low = min(-cone[i, 1], turn - cone[j, 1])
    high = max(cone[i, 1], turn + cone[j, 1])
    between = abs(turn) - cone[i, 1] - cone[j, 1]
    if math.pi - (high - low) >= between:
        angle = cone[i, 0] + 0.5 * (low + high)
    else:
        inner = cone[i, 1] + 0.5 * between
        angle = cone[i, 0] + math.copysign(inner, turn) + 0.5 * math.pi
    return math.cos(angle), math.sin(angle)


@uncounted
def _remainder(value: float, period: float) -> float:
    """The value less the nearest multiple of the period."""
    return float(value - period * math.floor(value / period + 0.5))


@uncounted
def _chord(arcs: Floats, i: int) -> float:
    return math.hypot(arcs[i, 1] - arcs[i, 3], arcs[i, 2] - arcs[i, 4])


@uncounted
def _reach(arcs: Floats, i: int, ux: float, uy: float) -> tuple[float, float]:
    start = arcs[i, 3] * ux + arcs[i, 4] * uy
    end = arcs[i, 1] * ux + arcs[i, 2] * uy
    return min(start, end), max(start, end)


@uncounted
def _at(arcs: Floats, i: int, ux: float, uy: float, u: float) -> float:
    """The parameter at which arclet i is at u, or the end that is nearer to it."""
    start = arcs[i, 3] * ux + arcs[i, 4] * uy
    end = arcs[i, 1] * ux + arcs[i, 2] * uy
    forward = 1.0 if end >= start else -1.0
    if (u - start) * forward <= 0.0:
        return 0.0
    if (u - end) * forward >= 0.0:
        return 1.0
    low, high = 0.0, 1.0
    t = float((u - start) / (end - start))
    last = 3 + 2 * int(arcs[i, 0])
    if last == 5:
        return t
    for _ in range(_STEPS):
        value = slope = 0.0
        for k in range(last, 3, -2):
            step = arcs[i, k] * ux + arcs[i, k + 1] * uy
            slope = slope * t + value + step
            value = (value + step) * t
        miss = (start - u) + value
        if miss * forward < 0.0:
            low = t
        else:
            high = t
        moved = t - miss / slope if slope != 0.0 else low - 1.0
        last_step = _LAST_STEP
        if not low <= moved <= high:
            moved = 0.5 * (low + high)
            last_step = _LAST_BISECTION
        moved_by = abs(moved - t)
        t = moved
        if moved_by <= last_step:
            break
    return t


@uncounted
def _offset(arcs: Floats, i: int, j: int, ux: float, uy: float, u: float) -> float:
    x, y = point_on(arcs, i, _at(arcs, i, ux, uy, u))
    other_x, other_y = point_on(arcs, j, _at(arcs, j, ux, uy, u))
    return float((y - other_y) * ux - (x - other_x) * uy)


@uncounted
def _beside(control: Floats, end: int, tolerance: float) -> float:
    """The offset beside an end at which it is zero: that of the next coefficient that is not."""
    for n in range(1, 8):
        value = control[abs(end - n)]
        if abs(value) > tolerance:
            return float(value)
    return float(control[end])


@uncounted
def _root(
    arcs: Floats,
    i: int,
    j: int,
    ux: float,
    uy: float,
    span: tuple[float, float],
    ends: tuple[float, float],
) -> float:
    """Where the offset is zero, given that it changes sign once: false position and halving."""
    low, high = span
    at_low, at_high = ends
    halve = False
    for _ in range(_STEPS):
        if at_low == 0.0 or at_high == 0.0:
            break
        u = low - at_low * (high - low) / (at_high - at_low)
        if halve or not low < u < high:
            u = 0.5 * (low + high)
        if not low < u < high:
            break
        value = _offset(arcs, i, j, ux, uy, u)
        width = high - low
        if (value < 0.0) == (at_low < 0.0):
            low, at_low = u, value
        else:
            high, at_high = u, value
        # One end may stay where it is: then the next step halves.
        halve = high - low > 0.5 * width
    return low if abs(at_low) <= abs(at_high) else high
