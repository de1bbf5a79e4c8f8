"""The judges of offsets judged: exact contours pass, and each fault is found and named."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.contours.contour import Contour
from tests.chains import circle
from tests.mechanical import AWKWARD, parts
from tests.offset_checks import judge
from tests.offset_count import loop_counts
from tests.offset_crossings import meetings

TOLERANCE = 1e-4
SQUARE = ss.Shape.from_points([(0, 0), (2, 0), (2, 2), (0, 2)])


def reversed_(contour: Contour) -> Contour:
    return replace(contour, arcs=contour.arcs[::-1, ::-1], weights=contour.weights[::-1])


def ring(d: float) -> list[Contour]:
    """The exact offset of the washer, radii 11 and 5."""
    outer = circle(11.0 + d, distance=d)
    return [outer, replace(reversed_(circle(5.0 - d, distance=d)), parent=outer)]


def polygon(points: list[tuple[float, float]], d: float) -> Contour:
    corners = np.array(points, dtype=np.float64)
    ends = np.roll(corners, -1, axis=0)
    return Contour(
        np.stack([corners, 0.5 * (corners + ends), ends], 1), np.ones(len(corners)), distance=d
    )


def inner_square(d: float = -0.5) -> Contour:
    low, high = -d, 2.0 + d
    return polygon([(low, low), (high, low), (high, high), (low, high)], d)


# What the shape and the distance say is counted once for all contours that claim to be the level.
counted = cache(loop_counts)


def kinds(contours: list[Contour], d: float, shape: ss.Shape | None = None) -> set[str]:
    shape = shape or parts()["washer"]
    return judge(shape, contours, d, TOLERANCE, counts=counted(shape, d)).kinds


@pytest.mark.parametrize("d", [0.5, -0.5, 2.5, -2.9, 0.0])
def test_exact_rings_pass(d: float) -> None:
    verdict = judge(parts()["washer"], ring(d), d, TOLERANCE)
    assert not verdict.failures
    assert not verdict.undecided
    assert verdict.deviation < 1e-13
    assert verdict.corners == 0


@pytest.mark.parametrize("d", [-0.5, -0.99, 0.0])
def test_exact_squares_pass(d: float) -> None:
    verdict = judge(SQUARE, [inner_square(d)], d, TOLERANCE)
    assert not verdict.failures
    assert verdict.corners == 4


def test_a_lost_loop_is_found() -> None:
    assert kinds(ring(0.5)[:1], 0.5) == {"count", "missing"}
    assert kinds([], 0.5) == {"count", "missing"}


def test_an_invented_loop_is_found() -> None:
    found = kinds([*ring(-0.5), circle(0.01, (8.0, 0.0), -0.5)], -0.5)
    assert {"count", "deviation", "parent"} <= found


def test_a_reversed_loop_is_found() -> None:
    outer, inner = ring(0.5)
    assert kinds([outer, reversed_(inner)], 0.5) == {"side"}


def test_a_wrong_parent_is_found() -> None:
    outer, inner = ring(0.5)
    assert kinds([outer, replace(inner, parent=None)], 0.5) == {"parent"}
    assert kinds([outer, replace(inner, parent=circle(11.5))], 0.5) == {"parent"}


def test_another_distance_is_found() -> None:
    assert kinds([replace(contour, distance=0.4) for contour in ring(0.5)], 0.5) == {
        "chain",
        "parent",
    }


def test_an_open_loop_is_found() -> None:
    outer, inner = ring(0.5)
    cut = replace(outer, arcs=outer.arcs[:3], weights=outer.weights[:3], closed=False)
    assert "chain" in kinds([cut, replace(inner, parent=cut)], 0.5)


def moved(contour: Contour, joint: int, by: np.ndarray) -> Contour:
    """A joint moved with its neighboring control points, so that tangents stay."""
    arcs = contour.arcs.copy()
    arcs[joint, :2] += by
    arcs[joint - 1, 1:] += by
    return replace(contour, arcs=arcs)


def test_a_joint_moved_by_two_tolerances_is_found() -> None:
    outer, inner = ring(0.5)
    wrong = moved(outer, 1, 2.0 * TOLERANCE * np.array([0.0, 1.0]))
    assert "deviation" in kinds([wrong, replace(inner, parent=wrong)], 0.5)
    right = moved(outer, 1, 0.5 * TOLERANCE * np.array([0.0, 1.0]))
    assert "deviation" not in kinds([right, replace(inner, parent=right)], 0.5)


@pytest.mark.parametrize("turn", [1e-5, 1e-3, 1e-2])
def test_a_corner_that_the_offset_has_not_is_found(turn: float) -> None:
    outer, inner = ring(0.5)
    arcs = outer.arcs.copy()
    arcs[0, 1] += turn * 11.5 * np.array([1.0, 0.0])  # the tangent at (11.5, 0) turns
    wrong = replace(outer, arcs=arcs)
    assert "jump" in kinds([wrong, replace(inner, parent=wrong)], 0.5)


def test_a_corner_of_the_wrong_kind_is_found() -> None:
    """A square's outer offset, its corners left sharp."""
    verdict = judge(SQUARE, [inner_square(0.5)], 0.5, TOLERANCE)
    assert {"jump", "deviation"} <= verdict.kinds


def test_a_rounded_corner_is_found() -> None:
    """Cut by an arc that stays within the tolerance."""
    square = inner_square()
    cut = 2.0 * TOLERANCE
    a, tip, b = (0.5 + cut, 0.5), (0.5, 0.5), (0.5, 0.5 + cut)
    corner = np.array([[b, tip, a]])
    arcs = np.concatenate([corner, square.arcs])
    arcs[1, 0], arcs[-1, 2] = a, b
    rounded = replace(square, arcs=arcs, weights=np.ones(len(arcs)))
    assert kinds([rounded], -0.5, SQUARE) == {"blunt"}


def test_loops_that_meet_are_found() -> None:
    assert len(meetings([circle(), circle(1.0, (0.5, 0.0))])) == 2
    assert len(meetings([circle(), circle(1.0, (2.0, 0.0))])) == 1
    assert len(meetings([circle(), circle(1.0, (2.0 + 1e-12, 0.0))])) == 0
    assert len(meetings([circle(), circle(1.0 - 1e-8)])) == 0
    assert len(meetings([circle(), circle()])) > 0


def test_a_loop_that_crosses_itself_is_found() -> None:
    eight = polygon([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)], 0.0)
    assert len(meetings([eight])) == 1
    square = inner_square()
    hook = square.arcs.copy()
    hook[0, 1] = (2.0, 0.5)  # a straight arc that runs beyond its end and back
    assert len(meetings([replace(square, arcs=hook)])) > 0
    spike = polygon([(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 1.0)], 0.0)
    assert len(meetings([spike])) > 0
    thin = polygon([(0.0, 0.0), (2.0, 0.0), (1.0, 1e-9), (1.0, 1.0)], 0.0)
    assert len(meetings([thin])) == 0


@pytest.mark.parametrize(
    ("part", "distance", "loops"),
    [
        ("washer", -2.98, 2),
        ("washer", -3.02, 0),
        ("washer", 4.999999, 2),
        ("washer", 5.000001, 1),
        ("flange", -9.0, 6),  # sharp triangles between the holes
        ("slotted link", -9.0, 2),  # crescents
        ("T-slot profile", 3.05, 1),
        ("T-slot profile", 3.15, 5),
    ],
)
def test_loops_are_counted(part: str, distance: float, loops: int) -> None:
    assert loop_counts(parts()[part], distance) == [loops]


@pytest.mark.parametrize("part", ["washer", "T-slot profile"])
def test_counts_say_when_they_do_not_know(part: str) -> None:
    assert len(loop_counts(parts()[part], AWKWARD[part][0])) > 1
