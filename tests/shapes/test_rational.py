"""Conic arcs compiled together: the pieces are those of each arc by itself."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.shapes.sources import rational
from splinesdf.shapes.sources.nurbs import nurbs_pieces
from splinesdf.shapes.sources.rational import rational_pieces
from tests.examples import examples

ROOT = 0.5**0.5


def alone(arc: np.ndarray, weight: float) -> list[np.ndarray]:
    return nurbs_pieces(arc, degree=2, knots=[0, 0, 0, 1, 1, 1], weights=[1.0, weight, 1.0])


@pytest.fixture
def others(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The weights of the arcs that go to `nurbs_pieces`, as they go."""
    gone: list[float] = []

    def noted(arc: np.ndarray, **given: Any) -> list[np.ndarray]:
        gone.append(given["weights"][1])
        return nurbs_pieces(arc, **given)

    monkeypatch.setattr(rational, "nurbs_pieces", noted)
    return gone


def assert_same(
    found: list[list[np.ndarray]], arcs: np.ndarray, weights: np.ndarray | list[float]
) -> None:
    """The same pieces of each arc, in order and joined, within two units in the last place."""
    assert len(found) == len(arcs)
    for pieces, arc, weight in zip(found, arcs, weights, strict=True):
        expected = alone(arc, float(weight))
        assert [len(piece) for piece in pieces] == [len(piece) for piece in expected]
        for before, after in pairwise(pieces):
            np.testing.assert_array_equal(before[-1], after[0])
        allowed = 2.0 * np.spacing(np.abs(arc).max())
        np.testing.assert_allclose(
            np.concatenate(pieces), np.concatenate(expected), rtol=0, atol=allowed
        )


@examples(30)
@given(
    st.integers(0, 10**6),
    st.sampled_from([0.3, 1.0, 6.0]),
    st.sampled_from([(0.0, 1.0), (1e6, 1.0), (0.0, 1e-9), (100.0, 1e-6), (-3e40, 1e40)]),
    st.sampled_from([1.0, 1e-3, 1e-7]),
)
def test_together_as_one_by_one(
    seed: int, spread: float, place: tuple[float, float], flatness: float
) -> None:
    """Weights from 1e-6 to 1e6, far origins, tiny sizes, arcs near to their chords."""
    random = np.random.default_rng(seed)
    arcs = random.normal(size=(5, 3, 2))
    middles = 0.5 * (arcs[:, 0] + arcs[:, 2])
    arcs[:, 1] = middles + flatness * (arcs[:, 1] - middles)
    arcs = place[0] + place[1] * arcs
    weights = 10.0 ** random.uniform(-spread, spread, 5)
    with pytest.MonkeyPatch.context() as patch:
        patch.delattr(rational, "nurbs_pieces")
        found = rational_pieces(arcs, weights)
    assert_same(found, arcs, weights)


def test_more_than_are_compiled_at_once(others: list[float]) -> None:
    """With arcs in between that `nurbs_pieces` gets: of wide weights."""
    random = np.random.default_rng(3)
    count = rational._TOGETHER + 5
    arcs, weights = random.normal(size=(count, 3, 2)), random.uniform(0.3, 3.0, count)
    weights[[0, 7, count - 1]] = 1e9, 1e-9, 1e7
    assert_same(rational_pieces(arcs, weights), arcs, weights)
    assert others == [1e9, 1e-9, 1e7]


@pytest.mark.parametrize(("most", "some"), [(2, False), (9, True), (20, True)])
def test_arcs_that_resist_are_left_to_the_other_road(
    most: int, some: bool, others: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    random = np.random.default_rng(4)
    arcs, weights = random.normal(size=(12, 3, 2)), 10.0 ** random.uniform(-2.0, 2.0, 12)
    monkeypatch.setattr(rational, "_MOST_INTERVALS", most)
    assert_same(rational_pieces(arcs, weights), arcs, weights)
    assert 0 < len(others) < 12 if some else len(others) == 12


def test_a_jump_between_the_halves_is_left_to_the_other_road(
    others: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rational, "_ROUNDING_GAP", -1.0)
    arcs = np.random.default_rng(5).normal(size=(3, 3, 2))
    assert_same(rational_pieces(arcs, np.full(3, 0.5)), arcs, np.full(3, 0.5))
    assert others == [0.5] * 3


def test_none() -> None:
    assert rational_pieces(np.empty((0, 3, 2)), np.empty(0)) == []


def test_refused_as_by_itself() -> None:
    """The first arc that is refused says so, whatever lies before and behind it."""
    arcs = np.random.default_rng(6).normal(size=(3, 3, 2))
    for bad in (-1.0, 0.0, 3e13):
        with pytest.raises(ss.InputError) as expected:
            alone(arcs[1], bad)
        with pytest.raises(ss.InputError) as refused:
            rational_pieces(arcs, np.array([0.5, bad, 0.7]))
        assert str(refused.value) == str(expected.value)


def test_quarters_of_a_circle() -> None:
    """Judged by the circle alone: on it, all the way around, in order, each once."""
    around = np.array(
        [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
    )
    arcs = np.stack([around[i : i + 3] for i in (0, 2, 4, 6)]).astype(np.float64)
    pieces = [piece for each in rational_pieces(arcs, np.full(4, ROOT)) for piece in each]
    assert all(
        np.array_equal(before[-1], after[0])
        for before, after in zip(pieces, pieces[1:] + pieces[:1], strict=True)
    )
    shape = ss.Shape.from_pieces([pieces])
    points = shape.sample(20)[0]
    np.testing.assert_allclose(np.hypot(*points.T), 1.0, rtol=0, atol=2e-15)
    angles = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    assert (np.diff(angles) > 0.0).all()
    assert angles[-1] - angles[0] == pytest.approx(2.0 * np.pi, abs=1e-12)
