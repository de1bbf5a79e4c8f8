"""Dashes of strokes: against exact areas, lengths by other quadratures, and laws of motion."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import splinesdf as ss
from splinesdf.errors import InputError
from splinesdf.shapes.sources import dashes as dashes_module
from splinesdf.shapes.sources.dashes import Dashed, Pattern, dashed, path_length
from splinesdf.shapes.sources.pen import Pen
from splinesdf.shapes.sources.stroke import stroke_region
from splinesdf.shapes.sources.svg_path import parse_until
from tests.examples import examples
from tests.shapes.test_boundary import area, loops

Floats = NDArray[np.float64]

CIRCLE = "M10 0A10 10 0 1 1 -10 0A10 10 0 1 1 10 0Z"
SQUARE = "M0 0H10V10H0Z"
# Wide bends, so that no stroke turns over; the last one has a piece within rounding of a corner.
SMOOTH = "M0 0C40 0 40 40 0 40C-30 40-30 80 0 80A40 40 0 0 1 40 120"


def cut(path: str, *lengths: float, offset: float = 0.0) -> Dashed:
    found = parse_until(path)
    return dashed(found.loops, found.closed, Pattern(lengths, offset))


def painted(dashes: Dashed, pen: Pen) -> ss.Shape:
    open_ones = [False] * len(dashes.loops)
    return ss.Shape.from_pieces(
        stroke_region(dashes.loops, open_ones, pen, dashes.along), once=False
    )


def lengths_of(dashes: Dashed) -> list[float]:
    return [path_length([loop]) for loop in dashes.loops]


def ends_along_x(dashes: Dashed) -> list[tuple[float, float]]:
    return [(float(loop[0][0, 0]), float(loop[-1][-1, 0])) for loop in dashes.loops]


# By hand from SVG's rules: a line of 10, its pattern, and where its dashes are.
LINES = {
    "pairs": ((3, 2), 0, [(0, 3), (5, 8)]),
    "a dash that is cut off": ((4, 2), 0, [(0, 4), (6, 10)]),
    "a dash of what is left": ((3, 1), 0, [(0, 3), (4, 7), (8, 10)]),
    "three twice": ((1, 2, 3, 1, 2, 3), 0, [(0, 1), (3, 6), (7, 9)]),
    "into a dash": ((3, 2), 1, [(0, 2), (4, 7), (9, 10)]),
    "into a gap": ((3, 2), 4, [(1, 4), (6, 9)]),
    "where a dash ends": ((3, 2), 3, [(2, 5), (7, 10)]),
    "a whole period": ((3, 2), 5, [(0, 3), (5, 8)]),
    "many periods": ((3, 2), 5e9 + 1, [(0, 2), (4, 7), (9, 10)]),
    "before the start": ((3, 2), -1, [(1, 4), (6, 9)]),
    "far before the start": ((3, 2), -16, [(1, 4), (6, 9)]),
    "as good as none": ((3, 2), -1e-30, [(0, 3), (5, 8)]),
    "dots": ((0, 4), 0, [(0, 0), (4, 4), (8, 8)]),
    "none where the path ends": ((0, 5), 0, [(0, 0), (5, 5)]),
    "no gaps": ((6, 0), 0, [(0, 6), (6, 10)]),
    "longer than the path": ((30, 5), 0, [(0, 10)]),
    "nothing but gap": ((1, 20), 2, []),
    "dots where it starts": ((3, 2, 0, 5), 5, [(0, 0), (5, 8)]),
    "without end": ((math.inf, math.inf), 3, [(0, 10)]),
    "a dot, then nothing": ((0, math.inf), 0, [(0, 0)]),
}


@pytest.mark.parametrize("name", LINES)
def test_dashes_known_by_hand(name: str) -> None:
    lengths, offset, expected = LINES[name]
    dashes = cut("M0 0H10", *lengths, offset=offset)
    assert len(dashes.loops) == len(expected)
    for found, ends in zip(ends_along_x(dashes), expected, strict=True):
        assert found == pytest.approx(ends, abs=1e-14)


def test_every_path_begins_the_pattern_anew() -> None:
    dashes = cut("M0 0H4M0 5H4M0 9H4", 3, 2)
    assert ends_along_x(dashes) == [(0.0, 3.0)] * 3


@pytest.mark.parametrize(
    ("path", "lengths", "sizes"),
    [
        (SQUARE, (4, 1), [4.0] * 8),
        (SQUARE, (7, 9), [7.0, 7.0, 7.0]),
        ("M0 0H10V10H0V0", (7, 5), [7.0, 7.0, 7.0, 4.0]),
        (SQUARE, (7, 5), [11.0, 7.0, 7.0]),
        (SQUARE, (50, 1), [40.0]),
        (SQUARE, (20, 5), [35.0]),
    ],
)
def test_a_dash_over_the_start_of_a_closed_path_is_one(
    path: str, lengths: tuple[float, ...], sizes: list[float]
) -> None:
    found = sorted(lengths_of(cut(path, *lengths)), reverse=True)
    assert found == pytest.approx(sorted(sizes, reverse=True), rel=1e-14)


def test_where_it_goes_on_over_the_start_is_a_join() -> None:
    """Two arms of 3 with a square in common; a bevel fills half of the outer one."""
    for join, corner in (("miter", 1.0), ("bevel", 0.5)):
        shape = painted(cut(SQUARE, 3, 34), Pen(2.0, join=join))
        assert len(loops(shape.boundary)) == 1
        assert area(shape.boundary) == pytest.approx(12.0 - 1.0 + corner, rel=1e-12)


def test_a_line_has_so_many_rectangles() -> None:
    shape = painted(cut("M1 2L301 402", 3, 2), Pen(0.7))
    assert len(loops(shape.boundary)) == 100
    assert area(shape.boundary) == pytest.approx(100 * 3 * 0.7, rel=1e-12)


def test_a_circle_has_sectors_of_a_ring() -> None:
    shape = painted(cut(CIRCLE, 2, 1, offset=0.5), Pen(3.0))
    around, period = 20.0 * math.pi, 3.0
    whole = math.floor((around + 0.5) / period)
    # Cut at the start, and what goes on over it.
    total = whole * 2.0 - 0.5 + min(around + 0.5 - whole * period, 2.0)
    assert len(loops(shape.boundary)) == whole
    assert area(shape.boundary) == pytest.approx(3.0 * total, rel=1e-12)


@pytest.mark.parametrize(("cap", "size"), [("butt", 0.0), ("round", math.pi), ("square", 4.0)])
def test_a_dash_of_no_length_is_its_caps(cap: str, size: float) -> None:
    """Squares lie along the path, as SVG says, and not upright."""
    dashes = cut("M0 0L30 40", 0, 10)
    assert len(dashes.loops) == 5
    if not size:
        assert stroke_region(dashes.loops, [False] * 5, Pen(2.0, cap), dashes.along) == []
        return
    shape = painted(dashes, Pen(2.0, cap))
    assert len(loops(shape.boundary)) == 5
    assert area(shape.boundary) == pytest.approx(5 * size, rel=1e-9)
    ahead = np.array([[0.6, 0.8]])
    np.testing.assert_allclose(ss.signed_distance(shape, ahead), 0.0, atol=1e-12)


def test_a_path_of_no_length_has_its_dot_if_the_pattern_begins_with_a_dash() -> None:
    assert len(cut("M3 4h0", 1, 2).loops) == 1
    assert len(cut("M3 4h0", 1, 2, offset=1.5).loops) == 0


CURVES = {
    "two bends": [[0, 0], [8, 6], [-6, 6], [2, 12]],
    "a cusp": [[0, 0], [1, 1], [0, 1], [1, 0]],
    "nearly a cusp": [[0, 0], [1, 1.0001], [0, 1], [1, 0]],
    "a sharp bend in the middle": [[0, 0], [0.99999, 1], [1e-5, 1], [1, 0]],
    "a handle of no length": [[0, 0], [0, 0], [3, 4], [5, 5]],
    "there and back": [[0, 0], [5, 0], [1, 0]],
}


@pytest.mark.parametrize("name", CURVES)
def test_dashes_are_as_long_as_they_are_said(name: str) -> None:
    """Each by a quadrature of another kind, in thirty digits."""
    piece = np.array(CURVES[name], dtype=np.float64)
    assert path_length([[piece]]) == pytest.approx(float(length_of(piece)), rel=1e-12)
    dashes = dashed([[piece]], [False], Pattern((0.7, 0.45), 0.2))
    found = [float(length_of(loop[0])) for loop in dashes.loops]
    assert len(found) == math.ceil((float(length_of(piece)) + 0.2) / 1.15)
    assert found[:-1] == pytest.approx([0.5, *[0.7] * (len(found) - 2)], rel=1e-11)


def length_of(piece: Floats) -> mpmath.mpf:
    """By tanh-sinh, between the places where the speed is least."""
    with mpmath.workdps(30):
        degree = len(piece) - 1
        steps = [[degree * mpmath.mpf(float(x)) for x in step] for step in np.diff(piece, axis=0)]

        def speed(t: mpmath.mpf) -> mpmath.mpf:
            weights = [
                mpmath.binomial(degree - 1, k) * t**k * (1 - t) ** (degree - 1 - k)
                for k in range(degree)
            ]
            x, y = (
                sum(w * step[a] for w, step in zip(weights, steps, strict=True)) for a in (0, 1)
            )
            return mpmath.sqrt(x * x + y * y)

        t = np.linspace(0.0, 1.0, 1001)
        seen = np.array([float(speed(mpmath.mpf(float(at)))) for at in t[::10]])
        lowest = [k for k in range(1, 100) if seen[k] <= min(seen[k - 1], seen[k + 1])]
        cuts = [mpmath.mpf(0), mpmath.mpf(1)]
        for k in lowest:
            low, high = mpmath.mpf(k - 1) / 100, mpmath.mpf(k + 1) / 100
            for _ in range(90):
                one, other = low + (high - low) / 3, high - (high - low) / 3
                low, high = (low, other) if speed(one) < speed(other) else (one, high)
            cuts.append(low)
        return mpmath.quad(speed, sorted(cuts), maxdegree=9)


@given(
    first=st.floats(4.0, 30.0),
    gap=st.floats(4.0, 30.0),
    offset=st.floats(-99.0, 99.0),
    width=st.floats(0.1, 8.0),
)
@examples(4)
def test_dashes_and_what_is_between_are_the_whole_stroke(
    first: float, gap: float, offset: float, width: float
) -> None:
    """Where a stroke does not turn over, its area is its length times its width."""
    found = parse_until(SMOOTH)
    whole = width * path_length(found.loops)
    dashes = cut(SMOOTH, first, gap, offset=offset)
    between = cut(SMOOTH, gap, first, offset=offset - first)
    parts = [area(painted(one, Pen(width)).boundary) for one in (dashes, between)]
    assert sum(parts) == pytest.approx(whole, rel=1e-10)
    assert parts[0] == pytest.approx(width * sum(lengths_of(dashes)), rel=1e-10)
    both = Dashed([*dashes.loops, *between.loops], [*dashes.along, *between.along])
    assert area(painted(both, Pen(width)).boundary) == pytest.approx(whole, rel=1e-10)


@given(
    turn=st.floats(0.0, 6.3),
    power=st.integers(-60, 60),
    shift=st.sampled_from([0.0, 1.0, 1e4, 1e8]),
    offset=st.floats(-30.0, 30.0),
    path=st.sampled_from([SMOOTH, CIRCLE, SQUARE, "M0 0C40 0 0 0 40 30L0 0Q3 9 9 0"]),
)
@examples(30)
def test_dashes_move_and_grow_with_the_path(
    turn: float, power: int, shift: float, offset: float, path: str
) -> None:
    found = parse_until(path)
    scale = 2.0**power
    across = scale * np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    to = scale * shift * np.array([1.0, -0.7])
    moved = [[piece @ across + to for piece in loop] for loop in found.loops]
    here = dashed(found.loops, found.closed, Pattern((5.0, 3.0), offset))
    there = dashed(moved, found.closed, Pattern((5.0 * scale, 3.0 * scale), offset * scale))
    assert len(here.loops) == len(there.loops)
    # Rounding of the moved coordinates, of some hundred pieces in a row.
    near = 1e-14 * (100.0 + 10.0 * shift) * scale * len(found.loops[0])
    for one, other in zip(here.loops, there.loops, strict=True):
        ends = np.stack([one[0][0], one[-1][-1]]) @ across + to
        np.testing.assert_allclose(np.stack([other[0][0], other[-1][-1]]), ends, atol=near, rtol=0)


def test_no_crumb_is_left_behind_a_corner() -> None:
    """Sides of a third: rounding of their sums would turn each dash round the corner."""
    step = 1.0 / 3.0
    corners = "".join(f"h{step!r}v{step!r}" for _ in range(50))
    dashes = cut(f"M0.1 0.1{corners}", step, step)
    assert [len(loop) for loop in dashes.loops] == [1] * 50
    assert all(loop[0][0, 1] == loop[0][1, 1] for loop in dashes.loops)


def test_a_crumb_does_not_turn_its_cap() -> None:
    """A dash begins 1e-9 before two smooth pieces meet, at 27 degrees; they are compiled arcs."""
    angle = math.radians(27.0)
    (loop,) = cut(CIRCLE, 4, 60, offset=1e-9 - 10.0 * angle).loops
    start = loop[0][1] - loop[0][0]
    assert math.atan2(-start[0], start[1]) == pytest.approx(angle, abs=1e-9)
    assert path_length([loop]) == pytest.approx(4.0, rel=1e-12)


def test_a_crumb_at_the_end_does_not_turn_its_cap() -> None:
    """A dash ends 1e-9 behind where two smooth pieces meet, on the first of them, continued."""
    angle = math.radians(27.0)
    (loop,) = cut(CIRCLE, 4, 60, offset=4.0 - 1e-9 - 10.0 * angle).loops
    assert path_length([loop[-1:]]) > 0.5
    way = loop[-1][-1] - loop[-1][-2]
    assert math.atan2(-way[0], way[1]) == pytest.approx(angle, abs=1e-9)
    assert np.hypot(*loop[-1][-1]) == pytest.approx(10.0, rel=1e-12)
    assert path_length([loop]) == pytest.approx(4.0, rel=1e-12)


@pytest.mark.parametrize("behind", [False, True])
def test_a_crumb_at_a_corner_stays_where_it_is(behind: bool) -> None:
    """Continued, its neighbor would leave the path."""
    crumb = 1e-9
    if behind:
        (loop,) = cut("M0 0H1V1", 1.0 + crumb, 5).loops
        expected = [(0.0, 0.0), (1.0, 0.0), (1.0, crumb)]
    else:
        (loop,) = cut("M0 0H1V1", 0.5, 5, offset=-(1.0 - crumb)).loops
        expected = [(1.0 - crumb, 0.0), (1.0, 0.0), (1.0, 0.5 - crumb)]
    found = [*(piece[0] for piece in loop), loop[-1][-1]]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15)


def test_halving_ends_where_rounding_would_never_let_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dashes_module, "_EXACT", -1.0)
    monkeypatch.setattr(dashes_module, "_MOST_HALVINGS", 4)
    path = dashes_module._measured([np.array([(0.0, 0.0), (3.0, 4.0)])])
    assert path is not None
    assert len(path.low) == 2**5
    assert path.length == pytest.approx(5.0, rel=1e-14)


def test_where_halving_and_steps_end_dashes_are_near_what_is_asked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Lowered, as no path comes near these ceilings: nothing is lost, and nothing goes on."""
    whole = cut(SMOOTH, 5, 3)
    monkeypatch.setattr(dashes_module, "_MOST_HALVINGS", 1)
    monkeypatch.setattr(dashes_module, "_STEPS", 3)
    rough = cut(SMOOTH, 5, 3)
    assert len(rough.loops) == len(whole.loops)
    for one, other in zip(rough.loops, whole.loops, strict=True):
        ends = np.stack([other[0][0], other[-1][-1]])
        np.testing.assert_allclose(np.stack([one[0][0], one[-1][-1]]), ends, rtol=0, atol=0.5)


@pytest.mark.parametrize("lengths", [(1e-9, 1e-9), (1e-300, 0.0), (0.0, 1e-4), (1e-3, 1e-3, 0, 0)])
def test_too_many_dashes_are_refused_at_once(lengths: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match=r"at most 10,000 dashes, got [\d,]+$"):
        cut("M0 0H10V10M0 0H3", *lengths)
