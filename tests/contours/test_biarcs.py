"""Contours of lines and circular arcs: near, smooth, few, and what is one already stays."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import splinesdf as ss
from splinesdf.contours.biarcs import _smooth_joints
from splinesdf.contours.conics import Kind, classify, elements, rounding
from splinesdf.contours.contour import Contour, halve
from tests.chains import circle, ellipse, from_arc, line, mixed_chain, open_chain, slot, turned
from tests.examples import examples
from tests.named_shapes import gamma
from tests.nearness import apart, dense


def check(contour: Contour, tolerance: float, sag: float | None = None) -> Contour:
    """All that is promised; the result."""
    sag = 1e-3 * tolerance if sag is None else sag
    result = ss.as_arcs(contour, tolerance=tolerance)
    # The result's points are rounded once more, which tells on arcs of a few roundings.
    found = classify(result.arcs, result.weights, 2.0 * rounding(result.arcs))
    assert set(found.kind.tolist()) <= {Kind.LINE, Kind.CIRCLE}
    assert np.nanmax(np.abs(found.sweep), initial=0.0) <= 0.5 * math.pi * (1.0 + 1e-9)
    assert apart(dense(contour), result, sag).max() <= tolerance + sag
    assert apart(dense(result), contour, sag).max() <= tolerance + sag
    assert result.closed == contour.closed
    assert np.array_equal(result.arcs[0, 0], contour.arcs[0, 0])
    assert np.array_equal(result.arcs[-1, 2], contour.arcs[-1, 2])
    return result


def jumps(contour: Contour) -> np.ndarray:
    """The tangent's jumps where arcs meet, in radians."""
    into = contour.arcs[:, 2] - contour.arcs[:, 1]
    out = np.roll(contour.arcs[:, 1] - contour.arcs[:, 0], -1, axis=0)
    angles = np.angle((out @ [1.0, 1j]) / (into @ [1.0, 1j]))
    return np.abs(angles if contour.closed else angles[:-1])


@pytest.mark.parametrize("tolerance", [1.0, 1e-2, 1e-4])
@pytest.mark.parametrize(
    "contour", [mixed_chain(), open_chain(), ellipse(), ellipse(3.0, 1e-2), turned(mixed_chain())]
)
def test_near_both_ways(contour: Contour, tolerance: float) -> None:
    check(contour, tolerance)


@pytest.mark.parametrize("first", range(4))
def test_an_ellipse_is_smooth_wherever_it_begins(first: int) -> None:
    result = check(from_arc(ellipse(), first), 1e-4)
    # Rounding of coordinates of size 3 over legs of about 0.05.
    assert jumps(result).max() <= 1e-13


def test_lines_circles_and_corners_stay() -> None:
    chain = mixed_chain()
    result = ss.as_arcs(chain, tolerance=1e-3)
    for kept in (1, 4):
        assert (result.arcs[:, ::2] == chain.arcs[kept, ::2]).all(axis=(1, 2)).sum() == 1
    corners = np.sort(jumps(chain))
    found = np.sort(jumps(result))
    # Where tangents jump by more than rounding, they jump as before.
    assert (found[: -len(corners)] <= 1e-12).all()
    assert found[-len(corners) :] == pytest.approx(corners, abs=1e-12)


@pytest.mark.parametrize("contour", [slot(), circle(3.0, (7.0, -2.0)), turned(slot())])
def test_what_is_made_of_arcs_comes_back_to_the_bit(contour: Contour) -> None:
    result = ss.as_arcs(contour, tolerance=1e-6)
    assert np.array_equal(result.arcs[:, ::2], contour.arcs[:, ::2])
    assert np.array_equal(result.weights, contour.weights)
    # Of lines, P1 is put in the middle, which it was but for the last bit.
    assert_allclose(result.arcs, contour.arcs, rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize("first", [0, 1, 2])
def test_a_line_gives_its_tangent_to_the_curve_beside_it(first: int) -> None:
    """Chains are smooth to a millionth only; what is made of them is to rounding."""
    parabola = np.array([[[1.0, 0.0], [2.0, 1e-6], [2.5, 1.0]]])
    closing = np.array([[[2.5, 1.0], [3.0, 2.0], [-3.0, 2.0]], [[-3.0, 2.0], [-2.0, 0.0], [0, 0]]])
    straight = line(0j, 1 + 0j)
    arcs = np.concatenate([straight.arcs, parabola, closing])
    chain = from_arc(Contour(arcs, np.ones(4)), first)
    result = check(chain, 1e-4)
    # Beyond the two corners and what the line does not touch.
    at_line = np.flatnonzero((result.arcs[:, 0] == [1.0, 0.0]).all(axis=1))
    assert jumps(result)[at_line - 1].max() <= 1e-12
    assert np.sort(jumps(result))[-3] <= 1e-12


def test_lines_are_given_their_middle() -> None:
    arcs = np.array([[[0.0, 0.0], [0.1, 0.3], [1.0, 3.0]]])
    result = ss.as_arcs(Contour(arcs, np.array([7.0]), closed=False), tolerance=1e-3)
    assert result.weights.tolist() == [1.0]
    assert result.arcs[0, 1].tolist() == [0.5, 1.5]


def test_the_joints_of_conics_cost_nothing() -> None:
    """Cut into hundreds of conics, a curve takes as many arcs as before."""
    whole = ellipse()
    arcs, weights = whole.arcs, whole.weights
    for _ in range(7):
        arcs, weights = halve(arcs, weights, np.ones(len(arcs), dtype=np.bool_))
    cut = Contour(arcs, weights)
    for tolerance in (1e-2, 1e-4, 1e-6):
        few = len(check(whole, tolerance).arcs)
        assert abs(len(check(cut, tolerance).arcs) - few) <= 2


def test_the_number_of_arcs_grows_with_the_third_root() -> None:
    tolerances = 10.0 ** -np.arange(2.0, 10.0)
    counts = [len(ss.as_arcs(ellipse(), tolerance=t).arcs) for t in tolerances]
    slope = np.polyfit(np.log(tolerances[2:]), np.log(counts[2:]), 1)[0]
    assert slope == pytest.approx(-1.0 / 3.0, abs=0.02)
    # A biarc of length l misses a curve by |d curvature / d length| l³ / 324, so that it takes
    # 2 ∫ (|d curvature / d length| / (324 tolerance))^(1/3) arcs as the tolerance goes to 0: here
    # 258.9 at 1e-6.
    assert counts[4] <= 1.1 * 258.9


def test_offsets_take_few_arcs() -> None:
    contours = ss.offset(gamma("gamma2"), [-0.02, 0.02], tolerance=1e-6)
    results = [check(contour, 1e-4, 1e-8) for contour in contours]
    assert sum(len(elements(result)) for result in results) <= 60
    assert max(jumps(result).max() for result in results) <= 1e-5


@examples(40)
@given(
    weight=st.sampled_from([1e-3, 0.1, 0.9, 1.0, 3.0, 1e3]),
    x=st.floats(-3.0, 4.0),
    y=st.floats(-5.0, 5.0),
    far=st.sampled_from([0.0, 1e6]),
    power=st.integers(-5, 0),
)
def test_any_arc(weight: float, x: float, y: float, far: float, power: int) -> None:
    arc = np.array([[[0.0, 0.0], [x, y], [1.0, 0.0]]]) + far
    # At 1e6 coordinates are rounded to 1e-10, and the tangents of short legs with them.
    check(Contour(arc, np.array([weight]), closed=False), 10.0**power, 10.0 ** (power - 3))


def test_a_fold_keeps_its_tip() -> None:
    arcs = np.array([[[0.0, 0.0], [4.0, 0.0], [1.0, 0.0]]])
    check(Contour(arcs, np.ones(1), closed=False), 1e-4)


def test_tiny_arcs_of_rounding_do_not_disturb() -> None:
    whole = ellipse()
    tip = whole.arcs[0, 0] + [0.0, 1e-14]
    tiny = np.array([[whole.arcs[0, 0], 0.5 * (whole.arcs[0, 0] + tip), tip]])
    arcs = np.concatenate([tiny, whole.arcs])
    arcs[1, 0] = tip
    chain = Contour(arcs, np.append(1.0, whole.weights))
    assert len(check(chain, 1e-3).arcs) <= len(check(whole, 1e-3).arcs) + 2


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.nan, 1e-20])
def test_a_bad_tolerance_is_refused(tolerance: float) -> None:
    with pytest.raises(ss.InputError, match="tolerance"):
        ss.as_arcs(circle(), tolerance=tolerance)


def test_level_and_parent_are_kept() -> None:
    outer = ellipse()
    inner = Contour(0.5 * outer.arcs, outer.weights, True, -2.0, True, outer)
    result = ss.as_arcs(inner, tolerance=1e-3)
    assert (result.distance, result.y_down, result.parent) == (-2.0, True, outer)


@pytest.mark.parametrize("way", [(0.0, 0.0), (64.0, -32.0), (-4096.0, 0.0)])
def test_the_same_arcs_wherever_it_lies(way: tuple[float, float]) -> None:
    """Lengths are differences: a line next to the origin is no shorter than elsewhere."""
    # Two parabolas, and between them, in the origin, lines of 2e-3 and of 0.5, all smooth.
    curve = np.array([[[-2.0, -1.0], [-1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [1.0, 0.0], [2.0, 1]]])
    for length in (2.0**-9, 0.5):
        between = line(0j, complex(length)).arcs
        arcs = np.concatenate([curve[:1], between, curve[1:] + np.array([length, 0.0])])
        chain = Contour(arcs + way, np.ones(3), closed=False)
        result = check(chain, 1e-2)
        exact = (result.arcs[:, ::2] == between[:, ::2] + way).all(axis=(1, 2))
        # Shorter than the tolerance it is passed through, else it stays to the bit.
        assert exact.sum() == (0 if length < 1e-2 else 1)
        home = ss.as_arcs(Contour(arcs, np.ones(3), closed=False), tolerance=1e-2)
        assert len(result.arcs) == len(home.arcs)
        assert_allclose(result.arcs - way, home.arcs, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("way", [(0.0, 0.0), (-1.0, 0.0), (64.0, -32.0), (-4096.0, 0.0)])
def test_short_legs_are_told_by_their_length_not_their_place(way: tuple[float, float]) -> None:
    """Where a leg is as long as 4096 grains, rounding turns it by 8 / 4096, not by 1e-3 elsewhere.

    Long, short, long: both joints of the short piece turn by a thousandth, that of two long ones
    as well.
    """
    legs = np.array([0.5, 0.5, 2.0**-20, 2.0**-20, 0.5, 0.5, 0.5, 0.5])
    angles = 1e-3 * np.array([0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0])
    steps = legs[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    # On a lattice far below the grain, so that moving it rounds nothing.
    points = np.round(points * 2.0**40) / 2.0**40 + way
    pieces = np.stack([points[:-2:2], points[1:-1:2], points[2::2]], axis=1)
    smooth = _smooth_joints(False, pieces, 2.0**-32)
    assert smooth.tolist() == [False, True, True, False]


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_the_same_biarcs_whichever_joint_is_the_origin(tolerance: float) -> None:
    """How closely a biarc is measured goes with its length, not with how far out it ends."""
    arcs = np.array([[[1.0, 0.5], [2.0, 3.0], [4.0, 1.0]], [[4.0, 1.0], [6.0, -1.0], [9.0, 2.0]]])
    chain = Contour(arcs, np.array([1.0, 1.5]), closed=False)
    here = ss.as_arcs(chain, tolerance=tolerance)
    assert len(here.arcs) >= 10
    for joint in here.arcs[:, 2]:
        # On a lattice, so that moving it rounds nothing.
        way = np.round(joint * 2.0**30) / 2.0**30
        there = ss.as_arcs(replace(chain, arcs=arcs - way), tolerance=tolerance)
        assert len(there.arcs) == len(here.arcs)
        assert_allclose(there.arcs + way, here.arcs, rtol=0.0, atol=1e-11)


def test_a_point_stays_one() -> None:
    point = Contour(np.full((3, 3, 2), 3.0), np.array([1.0, 0.5, 2.0]))
    assert ss.as_arcs(point, tolerance=1e-3).arcs.tolist() == [[[3.0, 3.0]] * 3]
