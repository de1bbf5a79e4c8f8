"""Pieces cut into arclets: nothing is lost, each is monotone and thin, and tables say the same."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.arclets.tables import Arclets
from tests import oracles
from tests.examples import examples
from tests.glyphs import glyphs
from tests.mechanical import parts
from tests.named_shapes import gamma

SHAPES = {
    "gamma2": lambda: gamma("gamma2"),
    "gamma3": lambda: gamma("gamma3"),
    "glyph": lambda: glyphs()["DejaVuSans:&"],
    "gear": lambda: parts()["trapezoid gear"],
    "part": lambda: ss.example("part"),
}
T = np.linspace(0.0, 1.0, 9)


def de_casteljau(control: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Points of one piece, (k, 2) at (n,), by the textbook."""
    points = np.repeat(control[None], len(t), axis=0)
    while points.shape[1] > 1:
        points = (1.0 - t)[:, None, None] * points[:, :-1] + t[:, None, None] * points[:, 1:]
    return points[:, 0]


def along(arclets: Arclets, i: int, t: np.ndarray) -> np.ndarray:
    """Points of one arclet by its powers, in the shape's own coordinates."""
    powers = t[:, None] ** np.arange(arclets.power.shape[1])
    return powers @ arclets.power[i] + arclets.start[i] + arclets.origin


def bent(control: np.ndarray) -> ss.Shape:
    """A piece of any degree, closed by its chord."""
    return ss.Shape.from_pieces([[control, control[[-1, 0]]]])


def judged(shape: ss.Shape) -> None:
    arclets = shape.arclets
    size = shape.size + np.abs(shape.control).max()
    for piece in range(shape.piece_count):
        rows = np.flatnonzero(arclets.piece == piece)
        rows = rows[np.argsort(arclets.interval[rows, 0])]
        # Together they are the piece, but for what is rounding in a cusp.
        assert arclets.interval[rows[0], 0] == 0.0
        assert arclets.interval[rows[-1], 1] == 1.0
        assert (arclets.interval[rows[1:], 0] >= arclets.interval[rows[:-1], 1]).all()
        control = oracles.piece(shape, piece)
        for i in rows.tolist():
            low, high = arclets.interval[i]
            expected = de_casteljau(control, low + (high - low) * T)
            assert np.abs(along(arclets, i, T) - expected).max() <= 1e-13 * size


@pytest.mark.parametrize("name", SHAPES)
def test_arclets_are_their_pieces(name: str) -> None:
    judged(SHAPES[name]())


@pytest.mark.parametrize("name", SHAPES)
def test_arclets_are_monotone_and_thin(name: str) -> None:
    arclets = SHAPES[name]().arclets
    grain = 1e-13 * np.abs(arclets.boxes[0]).max()
    for i in range(len(arclets.start)):
        points = along(arclets, i, np.linspace(0.0, 1.0, 65)) - arclets.origin
        steps = np.diff(points, axis=0) * np.sign(points[-1] - points[0])
        assert steps.min() >= -grain
        chord = points[-1] - points[0]
        across = points[:, 0] * chord[1] - points[:, 1] * chord[0]
        assert np.ptp(across) <= 0.1 * (chord @ chord) + grain


@pytest.mark.parametrize("name", SHAPES)
def test_rows_say_what_the_powers_say(name: str) -> None:
    # Coefficients of x, of y and of the square of the length, of twice the arclet's degree.
    arclets = SHAPES[name]().arclets
    for i, row in enumerate(arclets.arcs):
        d = int(row[0])
        points = T[:, None] ** np.arange(arclets.power.shape[1]) @ arclets.power[i]
        assert np.array_equal(row[1:5], [*arclets.end[i], *arclets.start[i]])
        assert np.array_equal(row[5 : 5 + 2 * d], arclets.power[i, 1 : d + 1].ravel())
        assert not arclets.power[i, d + 1 :].any()
        if d == 1:
            assert row[7] == pytest.approx(1.0 / (arclets.power[i, 1] @ arclets.power[i, 1]))
            continue
        table = row[5 + 2 * d : 5 + 2 * d + 3 * (2 * d + 1)].reshape(3, -1)
        x, y, squares = (de_casteljau(column[:, None], T)[:, 0] for column in table)
        reach = np.abs(points).max()
        assert np.abs(np.column_stack([x, y]) - points).max() <= 1e-14 * reach
        assert np.abs(squares - (points**2).sum(axis=1)).max() <= 1e-13 * reach**2


@pytest.mark.parametrize("name", SHAPES)
def test_boxes_and_capsules_are_around_all_below(name: str) -> None:
    arclets = SHAPES[name]().arclets
    points = np.stack([along(arclets, i, T) for i in range(len(arclets.start))]) - arclets.origin
    for node, (first, last) in enumerate(arclets.range):
        below = points[first:last].reshape(-1, 2)
        grain = 1e-13 * np.abs(arclets.boxes[0]).max()
        assert (arclets.boxes[node, :2] <= below + grain).all()
        assert (below - grain <= arclets.boxes[node, 2:]).all()
        x, y, dx, dy, inverse, radius = arclets.tree[node, :6]
        share = np.clip(((below - [x, y]) @ [dx, dy]) * inverse, 0.0, 1.0)
        apart = below - [x, y] - share[:, None] * [dx, dy]
        assert np.hypot(*apart.T).max() <= radius
        assert arclets.chain[node] == (arclets.run[first] == arclets.run[last - 1])


@examples(60)
@given(
    st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=3, max_size=7),
    st.sampled_from([1.0, 1e-6, 1e7]),
)
def test_pieces_of_any_degree_are_cut(points: list[tuple[int, int]], scale: float) -> None:
    control = scale * np.array(points, dtype=np.float64)
    # Neither a point nor to and fro along a line.
    assume(np.linalg.matrix_rank(control - control[0]) == 2)
    judged(bent(control))


def test_a_shape_with_more_arclets_than_there_was_room_for_is_cut_again() -> None:
    # A loop of the highest degree that one can draw by hand: many turns in one piece.
    t = np.arange(14)
    control = np.column_stack([t, 50.0 * (-1.0) ** t])
    shape = bent(control)
    assert len(shape.arclets.start) > 6  # room for one line, and five of the other
    judged(shape)
