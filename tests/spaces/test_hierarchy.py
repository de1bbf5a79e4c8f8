"""The tree that grows, against the slow way; and what refining a quarter is for."""

from __future__ import annotations

import numpy as np
import pytest

from splinesdf.fits.target import ShapeTarget
from splinesdf.fits.trials import Trial
from splinesdf.meshes import Quadtree
from splinesdf.spaces.hierarchical import leaves, owned, quadtree, refined, roots
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.space import first_space
from tests import naive_tree
from tests.named_shapes import UNIT, gamma
from tests.trees import hierarchical_ordinates

ROOTS = [(1, 1), (1, 4), (3, 1), (2, 3), (4, 4)]


def random_tree(shape: tuple[int, int], seed: int) -> Quadtree:
    random = np.random.default_rng(seed)
    mesh = Quadtree.uniform((0.0, 0.0, float(shape[0]), float(shape[1])), *shape)
    for _ in range(5):
        mesh = naive_tree.refine(mesh, random.random(len(mesh.leaves)) < 0.15)
    return mesh


@pytest.mark.parametrize("shape", ROOTS)
@pytest.mark.parametrize("seed", range(4))
def test_naive_equals_fast(shape: tuple[int, int], seed: int) -> None:
    mesh = random_tree(shape, seed)

    def functional(level: int, cells: np.ndarray) -> np.ndarray:
        place = (cells + 0.5) * 2.0**-level
        return np.sin(3.0 * place[:, 0] + level) + np.cos(5.0 * place[:, 1])

    slow = naive_tree.hierarchical_ordinates(mesh, functional)
    assert np.abs(hierarchical_ordinates(mesh, functional) - slow).max() <= 1e-14


@pytest.mark.parametrize("shape", ROOTS)
def test_all_four_quarters_are_the_block_of_nine(shape: tuple[int, int]) -> None:
    random = np.random.default_rng(5)
    mesh = Quadtree.uniform((0.0, 0.0, 1.0, 1.0), *shape)
    nodes = roots(shape, 1)
    for _ in range(6):
        marked = random.random(len(mesh.leaves)) < 0.1
        bad = leaves(nodes)[marked]
        nodes = refined(nodes, bad, np.ones((len(bad), 4), dtype=bool))
        mesh = naive_tree.refine(mesh, marked)
        grown = quadtree(nodes, mesh.domain)
        for name in ("level", "index", "child"):
            assert np.array_equal(getattr(grown, name), getattr(mesh, name))


def test_a_bad_quarter_gets_functions_of_the_next_level() -> None:
    random = np.random.default_rng(6)
    nodes = roots((4, 4), 1)
    for _ in range(5):
        cells = leaves(nodes)
        bad = random.choice(cells, 3, replace=False)
        quarters = np.zeros((3, 4), dtype=bool)
        quarters[np.arange(3), random.integers(0, 4, 3)] = True
        before = len(nodes.level)
        nodes = refined(nodes, bad, quarters)
        own = owned(nodes)
        for node, quarter in zip(bad, np.argmax(quarters, axis=1), strict=True):
            # Children are numbered with j fastest, quarters (SW SE NW NE) with i fastest.
            child = nodes.child[node] + 2 * (quarter & 1) + (quarter >> 1)
            assert own[child]
        # 2 x 2 cells, and what coarser neighbors need: not the whole block of 3 x 3.
        assert len(nodes.level) - before <= 3 * 4 * 6 + 4 * 40


@pytest.mark.parametrize(("operator", "most"), [("S", 1.7), ("P", 1.7), ("V", 1.7), ("W", 2.6)])
def test_no_distance_is_asked_twice_between_levels(operator: str, most: float) -> None:
    asked: list[np.ndarray] = []

    class Recorded(ShapeTarget):
        def values(self, points: np.ndarray) -> np.ndarray:
            asked.append(points)
            return super().values(points)

    shape = gamma("gamma2")
    space = first_space("hierarchical", QUADRATIC, UNIT, (4, 4))
    trial = Trial(Recorded(shape), shape, space, operator)
    for _ in range(5):
        size = np.abs(trial.center)
        bad = np.flatnonzero(size < np.median(size))
        trial.known.over[:] = True
        planned = trial.plan(bad)
        trial.refine()
        assert len(trial.center) == planned
    points = np.concatenate(asked)
    assert trial.evaluations == len(points)
    inside = np.all((points > 0.0) & (points < 1.0), axis=1)
    _, times = np.unique(points[inside], axis=0, return_counts=True)
    assert times.max() == 1
    assert trial.evaluations <= most * len(trial.center)
