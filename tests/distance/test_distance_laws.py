"""Laws that the distance to real drawings obeys, whatever their contours do."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

import splinesdf as ss
from tests import oracles
from tests.drawn_when_asked import Drawn
from tests.glyphs import glyphs
from tests.named_shapes import Loops, rebuilt
from tests.precise import Bezier, precise_distance
from tests.real_shapes import around, beside, icons

# Two distances, each good to 1e-15 of the size; pieces that are moved or cut are rounded as well.
ROUNDING = 4e-15

GLYPHS = [f"DejaVuSans:{character}" for character in "Ag&Çßé8"]
ICONS = ["apple", "bug", "cart", "hurricane", "openai", "umbrella-fill"]
SHAPES = Drawn(
    {name: partial(glyphs().__getitem__, name) for name in GLYPHS}
    | {name: partial(icons().__getitem__, name) for name in ICONS}
)
names = pytest.mark.parametrize("name", list(SHAPES))


def probes(shape: ss.Shape) -> np.ndarray:
    return np.concatenate([around(shape, 200, 1), beside(shape, 200, 2)])


def check_same(shape: ss.Shape, change: Callable[[Loops], Loops]) -> None:
    """Nothing changes, and no side but where the distance is no more than rounding."""
    points = probes(shape)
    before, after = (ss.signed_distance(s, points) for s in (shape, rebuilt(shape, change)))
    rounding = ROUNDING * shape.size
    assert np.max(np.abs(np.abs(before) - np.abs(after))) < rounding
    clear = np.abs(before) > rounding
    assert np.array_equal(before[clear] < 0, after[clear] < 0)


@names
def test_backwards_nothing_changes(name: str) -> None:
    check_same(SHAPES[name], lambda loops: [[p[::-1] for p in reversed(loop)] for loop in loops])


@names
def test_other_start_points_and_order_change_nothing(name: str) -> None:
    check_same(
        SHAPES[name],
        lambda loops: [loop[len(loop) // 3 :] + loop[: len(loop) // 3] for loop in reversed(loops)],
    )


def halves(control: np.ndarray, t: float) -> list[np.ndarray]:
    levels = [control]
    while len(levels[-1]) > 1:
        levels.append((1 - t) * levels[-1][:-1] + t * levels[-1][1:])
    return [np.array([x[0] for x in levels]), np.array([x[-1] for x in reversed(levels)])]


@names
@pytest.mark.parametrize("t", [0.5, 0.3, 0.999])
def test_cutting_the_pieces_changes_nothing(name: str, t: float) -> None:
    check_same(
        SHAPES[name],
        lambda loops: [[half for piece in loop for half in halves(piece, t)] for loop in loops],
    )


@names
def test_higher_degrees_change_nothing(name: str) -> None:
    def raised(control: np.ndarray) -> np.ndarray:
        share = np.arange(1, len(control))[:, None] / len(control)
        inner = share * control[:-1] + (1 - share) * control[1:]
        return np.concatenate([control[:1], inner, control[-1:]])

    check_same(SHAPES[name], lambda loops: [[raised(p) for p in loop] for loop in loops])


@names
@pytest.mark.parametrize("angle", [0.1, 2.0, 4.5])
def test_turning_changes_nothing(name: str, angle: float) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    shape, points = SHAPES[name], probes(SHAPES[name])
    turned = rebuilt(shape, lambda loops: [[p @ turn.T for p in loop] for loop in loops])
    difference = ss.signed_distance(shape, points) - ss.signed_distance(turned, points @ turn.T)
    # Sides may differ where the distance is rounding; coordinates are below 1.5 sizes.
    assert np.max(np.abs(difference)) < 2 * ROUNDING * shape.size


@names
@pytest.mark.parametrize("scale", [1e-7, 1e-6, 1e-3, 1e3, 1e6])
def test_scaling(name: str, scale: float) -> None:
    shape, points = SHAPES[name], probes(SHAPES[name])
    scaled = rebuilt(shape, lambda loops: [[scale * p for p in loop] for loop in loops])
    difference = ss.signed_distance(scaled, scale * points) - scale * ss.signed_distance(
        shape, points
    )
    assert np.max(np.abs(difference)) < 2 * ROUNDING * scale * shape.size


@names
def test_powers_of_two_scale_exactly(name: str) -> None:
    shape, points = SHAPES[name], probes(SHAPES[name])
    scaled = rebuilt(shape, lambda loops: [[2.0**20 * p for p in loop] for loop in loops])
    difference = ss.signed_distance(scaled, 2.0**20 * points) / 2.0**20 - ss.signed_distance(
        shape, points
    )
    # The walk is the same; a constant of fixed size inside it would show.
    assert np.max(np.abs(difference)) <= ROUNDING * shape.size / 8


@names
def test_moving_away_from_the_origin(name: str) -> None:
    shape = SHAPES[name]
    # Whole numbers: glyphs are drawn in them, so that the moved pieces are the same exactly.
    offset = np.array([1e7, -1e7]) * 2.0 ** np.round(np.log2(shape.size / 1000.0))
    points = probes(shape)
    moved = rebuilt(shape, lambda loops: [[p + offset for p in loop] for loop in loops])
    difference = ss.signed_distance(moved, points + offset) - ss.signed_distance(shape, points)
    # Points and pieces are rounded to the grid of the far coordinates.
    assert np.max(np.abs(difference)) < 4 * np.spacing(np.abs(offset).max())


@pytest.mark.parametrize("name", ["DejaVuSans:&", "hurricane"])
@pytest.mark.parametrize(("scale", "offset"), [(1e-7, 0.0), (1e6, 0.0), (1.0, 1e7), (1e3, 1e7)])
def test_far_and_small_drawings_against_40_digits(name: str, scale: float, offset: float) -> None:
    shape = rebuilt(
        SHAPES[name], lambda loops: [[scale * p + offset for p in loop] for loop in loops]
    )
    points = np.concatenate([around(shape, 12, 3), beside(shape, 12, 4)])
    pieces = [Bezier(oracles.piece(shape, i)) for i in range(shape.piece_count)]
    found = np.abs(ss.signed_distance(shape, points))
    # The pieces as they came out are the measure, so only the distance's own rounding counts;
    # it works relative to the shape's middle.
    assert np.max(np.abs(found - precise_distance(pieces, points))) < ROUNDING * shape.size


@names
def test_distance_is_1_lipschitz(name: str) -> None:
    shape = SHAPES[name]
    rng = np.random.default_rng(5)
    start = probes(shape)
    step = shape.size * 10.0 ** rng.uniform(-12, 0, (len(start), 1)) * rng.normal(size=start.shape)
    one, other = ss.signed_distance(shape, start), ss.signed_distance(shape, start + step)
    assert np.all(np.abs(one - other) <= np.linalg.norm(step, axis=1) + ROUNDING * shape.size)


@names
def test_order_and_company_of_points_change_nothing(name: str) -> None:
    # The search goes from a point to the next; what it carries over must not show.
    shape, points = SHAPES[name], probes(SHAPES[name])
    together = ss.signed_distance(shape, points)
    order = np.random.default_rng(6).permutation(len(points))
    assert np.max(np.abs(ss.signed_distance(shape, points[order]) - together[order])) < (
        ROUNDING * shape.size
    )
    alone = np.array([float(ss.signed_distance(shape, point)) for point in points[::20]])
    assert np.max(np.abs(alone - together[::20])) < ROUNDING * shape.size
