"""Which arclets can be told without looking not to enter the disks of another one's offset.

An arclet's own chain, as far as it turns by less than half a turn and neither has a corner toward
the offset nor bends by more than 1 / |d| toward it, cannot enter the disk of radius |d| that
touches the arclet (Schur's theorem). Corners that turn by t in all enter it by |d| t^2 / 2 w, where
1 / |d| less the curvature beside them is w / |d|: where that is rounding they do no harm, and which
of both is nearer could not be told.
"""

from __future__ import annotations

import math

from splinesdf.arclets.thresholds import CUSP, DENTS
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.ground.jit import kernel, uncounted
from splinesdf.offsets.tables import Turns

# How far a chain may turn (radians) and still be called the arclet's own. It must be below pi, by
# more than an arclet turns.
_OWN_TURN = 2.0
# Least w, see above, beside a corner of a chain that is not looked at.
_WIDTH = 0.5


@kernel
def own_chains(turns: Turns, bends: Floats, distance: float, bent: Bools, reach: Ints) -> None:
    """Fill which arclets bend too much, and how far each one's own chain reaches.

    Parameters
    ----------
    turns : Turns
    bends : ndarray
        Rows of `Bends`.
    distance : float
        Positive to the right of the boundary, which is outward.
    bent : ndarray of bool, shape (n,)
        Filled, by arclet: whether its parallel may run backward somewhere.
    reach : ndarray, shape (n, 3)
        Filled, by place in ``turns.order``: how many of the following and how many of the
        preceding arclets belong to the chain; 1 if one of the chain is bent, else 0.
    """
    order, loops, turn = turns.order, turns.loops, turns.turn
    for i in range(bent.shape[0]):
        low, high = bends[i, 0], bends[i, 1]
        # written so that infinite ranges and NaN count as bent
        bent[i] = not (1.0 + low * distance > 0.0 and 1.0 + high * distance > 0.0)
    for j in range(loops.shape[0] - 1):
        first, size = loops[j], loops[j + 1] - loops[j]
        for backward in range(2):
            count = 0
            total = dents = 0.0
            for n in range(size):
                p = size - 1 - n if backward else n
                while count < size - 1:
                    # the last one in the chain, the next one, and the joint between them
                    if backward:
                        last = order[first + (p - count) % size]
                        other = order[first + (p - count - 1) % size]
                        angle = turn[other]
                    else:
                        last = order[first + (p + count) % size]
                        other = order[first + (p + count + 1) % size]
                        angle = turn[last]
                    dent = _dent(angle, distance)
                    if dent > 0.0 and not (
                        dents + dent <= DENTS
                        and _is_wide(bends, last, distance)
                        and _is_wide(bends, other, distance)
                    ):
                        break
                    more = abs(angle) + turns.turning[other]
                    if count > 0 and total + more > _OWN_TURN:
                        break
                    total += more
                    dents += dent
                    count += 1
                reach[first + p, backward] = count
                if count > 0:
                    # what the first step of this chain was, the next one has behind it
                    other = (
                        order[first + (p - 1) % size] if backward else order[first + (p + 1) % size]
                    )
                    angle = turn[other] if backward else turn[order[first + p]]
                    total -= abs(angle) + turns.turning[other]
                    count -= 1
                    dents -= _dent(angle, distance)
                    if count == 0:
                        total = dents = 0.0
        for p in range(size):
            reach[first + p, 2] = 0
        # Whether a bent one is in the chain: distance to the nearest bent one on either side.
        for backward in range(2):
            since = 2 * size
            for n in range(2 * size):
                p = (2 * size - 1 - n if not backward else n) % size
                i, before = order[first + p], order[first + (p - 1) % size]
                back = max(abs(turn[i]), abs(turn[before])) > math.pi - CUSP
                since = 0 if bent[i] or back else since + 1
                if since <= reach[first + p, backward]:
                    reach[first + p, 2] = 1


@uncounted
def _dent(angle: float, distance: float) -> float:
    """How far a joint turns toward the offset."""
    return max(0.0, -angle if distance > 0.0 else angle)


@uncounted
def _is_wide(bends: Floats, i: int, distance: float) -> bool:
    """Whether an arclet bends toward the offset by clearly less than 1 / |d|."""
    low, high = bends[i, 0], bends[i, 1]
    return bool(1.0 + low * distance > _WIDTH and 1.0 + high * distance > _WIDTH)
