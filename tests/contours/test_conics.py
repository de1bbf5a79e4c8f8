"""What arcs are, and what consecutive ones are together, against circles that are known."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from splinesdf.contours.conics import Element, Kind, classify, elements, unfolded
from splinesdf.contours.contour import Contour, evaluate
from tests.chains import (
    circle,
    circular,
    ellipse,
    from_arc,
    joined,
    line,
    mixed_chain,
    slot,
    turned,
)


@given(
    radius=st.floats(1e-3, 1e3),
    x=st.floats(-100.0, 100.0),
    start=st.floats(0.0, 6.28),
    sweep=st.floats(0.2, 3.0),
    way=st.sampled_from([-1.0, 1.0]),
)
def test_a_circular_arc_is_found_with_its_circle(
    radius: float, x: float, start: float, sweep: float, way: float
) -> None:
    arc = circular(radius, complex(x, 1.0), start, way * sweep, 1)
    found = classify(arc.arcs, arc.weights)
    assert found.kind.tolist() == [Kind.CIRCLE]
    # The sagitta, sweep²/8 of the radius, carries the rounding of the coordinates.
    grain = 1e-15 * (abs(x) + radius + 1.0) * 40.0 / sweep**2
    assert found.radius[0] == pytest.approx(radius, abs=grain)
    assert abs(complex(*found.center[0]) - complex(x, 1.0)) <= grain
    assert found.sweep[0] == pytest.approx(way * sweep, abs=grain / radius)


def test_kinds_by_weight() -> None:
    chain = mixed_chain()
    kinds = classify(chain.arcs, chain.weights).kind.tolist()
    assert kinds == [Kind.PARABOLA, Kind.LINE, Kind.HYPERBOLA, Kind.ELLIPSE, Kind.LINE]


@pytest.mark.parametrize("weight", [1e-3, 1.0, 1e3])
def test_a_line_is_one_whatever_its_weight(weight: float) -> None:
    arcs = np.array([[[0.0, 0.0], [0.1, 0.3], [1.0, 3.0]]])
    assert classify(arcs, np.array([weight])).kind.tolist() == [Kind.LINE]


def test_what_is_nearly_a_circle_is_none() -> None:
    ring = circle()
    assert (classify(ring.arcs, ring.weights * (1.0 + 1e-12)).kind == Kind.ELLIPSE).all()
    nearly = ellipse(1.0 + 1e-12, 1.0)
    assert (classify(nearly.arcs, nearly.weights).kind == Kind.ELLIPSE).all()


def test_a_line_that_turns_back_is_no_line() -> None:
    arcs = np.array([[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]])
    assert classify(arcs, np.ones(1)).kind.tolist() != [Kind.LINE]


@pytest.mark.parametrize("count", [3, 4, 7, 100])
@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_parts_of_a_circle_are_one_full_circle(count: int, way: float) -> None:
    (found,) = elements(circular(3.0, 7 - 2j, 0.3, way * 2.0 * math.pi, count))
    assert found.is_full
    assert found.sweep == way * 2.0 * math.pi
    assert found.count == count
    assert found.radius == pytest.approx(3.0, rel=1e-13)
    assert abs(found.center - (7 - 2j)) <= 1e-13


def test_far_from_the_origin_a_circle_is_as_good_as_its_coordinates() -> None:
    (found,) = elements(circle(1.0, (1e6, 1e6)))
    assert found.is_full
    assert abs(found.center - (1e6 + 1e6j)) <= 1e-9


@pytest.mark.parametrize("first", range(8))
def test_a_slot_is_four_elements_wherever_it_begins(first: int) -> None:
    whole = from_arc(slot(), first)
    for chain, sign in ((whole, 1.0), (turned(whole), -1.0)):
        found = elements(chain)
        assert sorted(piece.kind for piece in found) == [Kind.LINE] * 2 + [Kind.CIRCLE] * 2
        assert sum(piece.count for piece in found) == 8
        for piece, other in zip(found, [*found[1:], found[0]], strict=True):
            assert piece.end == other.start
        arcs = [piece for piece in found if piece.kind is Kind.CIRCLE]
        assert {round(piece.center.real, 12) for piece in arcs} == {-2.5, 2.5}
        assert all(piece.sweep == pytest.approx(sign * math.pi, rel=1e-13) for piece in arcs)


def test_what_only_touches_is_not_merged() -> None:
    bent = elements(line(0j, 1 + 0j, 2 + 1e-9j))
    assert len(bent) == 2
    back = elements(line(0j, 2 + 0j, 1 + 0j))
    assert len(back) == 2
    tangent = joined(
        circular(1.0, 0j, 0.0, 0.5 * math.pi, 1),
        circular(1.0 + 1e-9, -1e-9j, 0.5 * math.pi, 0.5 * math.pi, 1),
        closed=False,
    )
    assert len(elements(tangent)) == 2
    s_shaped = joined(
        circular(1.0, 0j, 0.0, 0.5 * math.pi, 1),
        circular(1.0, 2j, -0.5 * math.pi, -0.5 * math.pi, 1),
        closed=False,
    )
    assert len(elements(s_shaped)) == 2


def test_flat_arcs_do_not_drift_into_a_line() -> None:
    """Each next one is straight to rounding, all of them together are not."""
    # Four ulp of coordinates of 1000 are 9e-13. An arc bulges by 3e-13, all of them by 1e-6.
    long = circular(1e3, 0j, 0.0, 1e-4, 2000)
    assert (classify(long.arcs, long.weights).kind == Kind.LINE).all()
    found = elements(long)
    assert {piece.kind for piece in found} == {Kind.LINE}
    # Sixteen ulp, 3.6e-12, are what a line of 1.7e-4 bulges by: three arcs and a bit.
    assert 450 <= len(found) <= 1000
    assert sum(piece.count for piece in found) == 2000
    for piece in found:
        rows = np.arange(piece.first, piece.first + piece.count)
        joints = long.arcs[rows, 2] @ [1.0, 1j]
        way = piece.end - piece.start
        assert np.abs(((joints - piece.start) * way.conjugate()).imag).max() <= 4e-12 * abs(way)


def test_cutting_keeps_the_ends_and_the_circle() -> None:
    (whole,) = elements(circle(2.0, (1.0, 1.0)))
    parts = whole.parts(math.pi)
    assert len(parts) == 2
    assert (parts[0].start, parts[-1].end) == (whole.start, whole.end)
    assert parts[0].end == parts[1].start == pytest.approx(-1 + 1j)
    assert len(whole.parts(2.0 * math.pi / 3.0)) == 3
    (straight,) = elements(line(0j, 4 + 0j))
    assert [piece.end for piece in straight.cut([0.25])] == [1 + 0j, 4 + 0j]


def test_what_has_no_extent_is_left_out() -> None:
    arcs = np.array([[[0.0, 0.0]] * 3, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]])
    assert len(elements(Contour(arcs, np.ones(2), closed=False))) == 1


@pytest.mark.parametrize("weight", [1e-3, 0.4, 1.0, 30.0])
@pytest.mark.parametrize("height", [0.0, 5e-324, 1e-250, 1e-17])
def test_a_fold_is_two_lines_to_its_tip(weight: float, height: float) -> None:
    """Regression: an ellipse with an axis of 1e-227 overflowed in the writer of SVG."""
    arcs = np.array([[[0.0, 0.0], [2.0, height], [1.0, 0.0]]])
    fold = Contour(arcs, np.array([weight]), closed=False)
    cut = unfolded(fold)
    farthest = evaluate(arcs, np.array([weight]), np.linspace(0.0, 1.0, 200_001))[0, :, 0].max()
    if farthest == 1.0:
        assert cut is fold
        return
    assert classify(cut.arcs, cut.weights).kind.tolist() == [Kind.LINE] * 2
    # Between samples the tip reaches farther by the square of half a step.
    assert 0.0 <= cut.arcs[0, 2, 0] - farthest + 1e-15 <= 1e-8 * max(weight, 1.0) ** 2
    assert cut.arcs[1, 2].tolist() == [1.0, 0.0]


def test_what_comes_back_to_its_start_is_no_point() -> None:
    arcs = np.array([[[1.0, 1.0], [3.0, 1.0], [1.0, 1.0]]])
    there, back = elements(unfolded(Contour(arcs, np.ones(1))))
    assert (there.start, there.end, back.end) == (1 + 1j, 2 + 1j, 1 + 1j)


def test_a_flat_arc_is_cut_on_itself() -> None:
    """Regression: seen from a center 1e12 away, rounding put the cut 1e-4 beside the arc."""
    radius = 1e12
    arc = Element(Kind.CIRCLE, 0, 1, 0j, 1 + 0j, complex(0.5, radius), radius, 1.0 / radius)
    for share in (0.1, 0.5, 0.9):
        first, last = arc.cut([share])
        assert first.end == last.start == pytest.approx(share, abs=1e-11)
