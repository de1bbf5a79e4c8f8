"""How loops turn as a whole, also where both branches of a cusp coincide to rounding."""

from __future__ import annotations

import math

import numpy as np
import pytest

import splinesdf as ss


def sliver() -> np.ndarray:
    """A polygon from x = 0 to 1, at one end thinner than what tells the sides of a tip.

    Yet thick enough to be there: rounding is 1e-16, and up to 1e-13 counts as no width.
    """
    x = np.linspace(0.0, 1.0, 61)
    gap = np.interp(x, [0.0, x[1], 0.6, 0.8, 1.0], [0.0, 8e-14, 8e-14, 1e-4, 0.0])
    above = np.stack([x, gap], axis=1)[-2:0:-1]
    return np.concatenate([np.stack([x, 0.0 * x], axis=1), above])


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("hole", [False, True])
def test_a_sliver_turns_once_to_its_own_side(hole: bool, reverse: bool) -> None:
    """Left around what is filled, right around a hole, whichever way it was drawn."""
    loops = [sliver()[::-1] if reverse else sliver()]
    if hole:
        loops.append(np.array([(-0.05, -0.5), (1.05, -0.5), (1.05, 0.5), (-0.05, 0.5)]))
    pieces = [list(np.stack([loop, np.roll(loop, -1, axis=0)], axis=1)) for loop in loops]
    joints = ss.Shape.from_pieces(pieces, close=True, fill="evenodd").joints
    # Lines do not turn: it is all in the corners.
    turns = np.add.reduceat(joints.turn[joints.order], joints.loops[:-1])
    exact = [-1.0, 1.0] if hole else [1.0]
    assert np.sort(turns / (2.0 * math.pi)) == pytest.approx(exact, abs=1e-9)
    # Both tips are there, and point where the loop turns.
    tips = joints.turn[np.abs(joints.turn) > 3.0]
    assert tips.tolist() == pytest.approx([exact[0] * math.pi] * 2, abs=1e-2)
