"""How loops turn as a whole, also where both branches of a cusp coincide to rounding."""

from __future__ import annotations

import math

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.joints import joints
from splinesdf.arclets.tangents import EndTangents, led_on
from splinesdf.arclets.vertices import vertices


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


def test_arclets_without_extent_point_where_their_followers_do() -> None:
    """Two in a row, one alone that only ends in a point, and a loop of nothing else."""
    vectors = np.array(
        [(1.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.0, 2.0), (3.0, 3.0), (0.0, 0.0), (0.0, 0.0)]
    )
    arriving = vectors.copy()
    arriving[4] = 0.0
    following = np.array([1, 2, 3, 4, 0, 6, 5])
    found = led_on(EndTangents(vectors, arriving), following)
    assert found.leaving.tolist() == [
        [1.0, 0.0], [0.0, 2.0], [0.0, 2.0], [0.0, 2.0], [1.0, 0.0], [0.0, 0.0], [0.0, 0.0]
    ]  # fmt: skip
    assert np.array_equal(found.arriving, found.leaving)


def test_a_vertex_that_rounding_took_a_branch_from_is_none() -> None:
    """Three triangles that share a corner: as one vertex, its branches around it."""
    fans = "M0 0L4 -1L4 1Z M0 0L-1 4L-3 4Z M0 0L-3 -4L-1 -4Z"
    boundary = ss.Shape.from_svg_path(fans).boundary
    found = vertices(boundary)
    assert len(found.ends) == 3
    assert sorted(found.inside) == sorted(found.outside)
    assert not (found.inside == found.outside).any()
    end = boundary.end.copy()
    end[found.ends[0]] += 1e-9
    assert len(vertices(boundary._replace(end=end)).ends) == 0


@pytest.mark.parametrize("outside", [False, True])
def test_each_arclet_has_one_follower_where_rounding_moved_branches_off_a_vertex(
    outside: bool,
) -> None:
    """Of four triangles that share a corner; the others take each other's followers there."""
    fans = "M0 0L4 -1L4 1Z M0 0L1 4L-1 4Z M0 0L-4 1L-4 -1Z M0 0L-1 -4L1 -4Z"
    boundary = ss.Shape.from_svg_path(fans).boundary
    (arriving,) = np.flatnonzero((boundary.start == (-1.0, 4.0)).all(axis=1))
    (leaving,) = np.flatnonzero((boundary.end == (-4.0, 1.0)).all(axis=1))
    start, end = boundary.start.copy(), boundary.end.copy()
    end[arriving, 0] -= 1e-15
    start[leaving, 0] -= 2e-15
    moved = boundary._replace(start=start, end=end)
    found = vertices(moved)
    assert len(found.ends) == 3
    made = joints(moved, found, outside=outside)
    assert sorted(made.order) == sorted(made.following) == list(range(12))
    assert np.abs(start[made.following] - end).max() <= 2e-15
    assert made.following[arriving] == leaving
