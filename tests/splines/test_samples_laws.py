"""Laws of shapes from samples: moved, scaled, counted; and what a grid is too coarse for."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy import ndimage

import splinesdf as ss
from tests.examples import examples

Function = Callable[[np.ndarray, np.ndarray], np.ndarray]
NODES = np.linspace(-2.0, 2.0, 25)


def waves(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of a few random waves that fill the middle with parts and holes."""
    random = np.random.default_rng(seed)
    return random.uniform(-3.0, 3.0, (4, 2)), random.uniform(0.0, 6.3, 4), random.normal(size=4)


def islands(x: np.ndarray, y: np.ndarray, seed: int) -> np.ndarray:
    """Waves, and a wall around them that rises above the level before the border."""
    ways, phases, heights = waves(seed)
    sums = np.zeros(np.broadcast(x, y).shape)
    for (along, across), phase, height in zip(ways, phases, heights, strict=True):
        sums += height * np.cos(along * x + across * y + phase)
    return np.asarray(sums + 8.0 * ((x / 1.8) ** 8 + (y / 1.8) ** 8))


def counted(mask: np.ndarray) -> tuple[int, int]:
    """Parts and holes of a picture."""
    parts = ndimage.label(mask)[1]
    return parts, ndimage.label(~mask, np.ones((3, 3)))[1] - 1


def turns(shape: ss.Shape) -> list[float]:
    """The signed area of each loop, by its control points' fine polygon."""
    areas = []
    for first, last in zip(shape.loops[:-1], shape.loops[1:], strict=True):
        ends = np.array([shape.piece(i)[0] for i in range(first, last)])
        x, y = (ends - ends[0]).T
        areas.append(0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
    return areas


@examples(8)
@given(st.integers(0, 10**6), st.sampled_from([-0.5, 0.0, 0.7]))
def test_parts_and_holes_are_those_of_a_fine_picture(seed: int, level: float) -> None:
    """Where a picture counts the same a little above and below: no neck is too near to tell."""
    fine = np.linspace(-2.0, 2.0, 401)
    picture = islands(fine, fine[:, None], seed)
    counts = {counted(picture < level + shift) for shift in (-0.06, -0.03, 0.0, 0.03, 0.06)}
    assume(len(counts) == 1)
    parts, holes = counts.pop()
    assume(parts > 0)
    nodes = np.linspace(-2.0, 2.0, 65)
    shape = ss.from_level_set(islands(nodes, nodes[:, None], seed), nodes, nodes, level=level)
    assert shape.notes == ()
    areas = turns(shape)
    assert (sum(area > 0.0 for area in areas), sum(area < 0.0 for area in areas)) == (parts, holes)
    # Region, not only number: no point that is clear of the level has the wrong side.
    clear = np.abs(picture - level) > 0.06
    places = np.stack(np.meshgrid(fine, fine), axis=-1)[clear]
    assert ((ss.signed_distance(shape, places[::23]) < 0.0) == (picture[clear][::23] < level)).all()


@examples(8)
@given(
    st.integers(0, 10**6),
    st.tuples(st.integers(-(2**20), 2**20), st.integers(-(2**20), 2**20)),
    st.sampled_from([-40, -3, 0, 3, 40]),
    st.sampled_from([-900, -30, 0, 30, 900]),
    st.booleans(),
)
def test_moved_and_scaled(
    seed: int, shift: tuple[int, int], size: int, height: int, transposed: bool
) -> None:
    """Powers of two and whole numbers round nothing: the same arcs but for where they are."""
    values = islands(NODES, NODES[:, None], seed)
    assume((values < -0.1).any())
    shape = ss.from_level_set(values, NODES, NODES)
    points = np.random.default_rng(seed).uniform(-2.0, 2.0, (40, 2))
    here = ss.signed_distance(shape, points)
    scale, moved = 2.0**size, np.array(shift) * 2.0**size
    x, y = NODES * scale + moved[0], NODES * scale + moved[1]
    if transposed:
        values, points = values.T, points[:, ::-1]
    there = ss.from_level_set(np.ldexp(values, height), x, y)
    assert there.loop_count == shape.loop_count
    found = ss.signed_distance(there, points * scale + moved) / scale
    # Half a unit in the last place of the coordinates, of nodes, arcs and points.
    assert np.abs(found - here).max() <= 8.0 * np.spacing(max(map(abs, shift)) + 4.0)


def test_the_level_is_a_shift_of_the_values() -> None:
    values = islands(NODES, NODES[:, None], 3)
    shape = ss.from_level_set(values + 0.75, NODES, NODES, level=0.75)
    other = ss.from_level_set((values + 0.75) - 0.75, NODES, NODES)
    assert np.array_equal(shape.control, other.control)


def test_steps_differ_in_x_and_y() -> None:
    """Against the ellipse itself; with steps mixed up, or rows for columns, another curve comes."""
    x, y = np.linspace(-3.0, 3.0, 97), np.linspace(4.0, 6.0, 61)
    values = np.exp(0.4 * x) * ((x / 2.0) ** 2 + ((y[:, None] - 5.0) / 0.6) ** 2 - 1.0)
    shape = ss.from_level_set(values, x, y)
    t = np.linspace(0.0, 2.0 * np.pi, 500)
    on = np.stack([2.0 * np.cos(t), 5.0 + 0.6 * np.sin(t)], axis=1)
    assert np.abs(ss.signed_distance(shape, on)).max() <= 1e-5
    assert sum(turns(shape)) == pytest.approx(1.2 * np.pi, rel=1e-2)


def test_russo_and_smereka_s_ellipse_is_of_order_three() -> None:
    """Their function's slope is from a tenth to fifty; both ways, so that no part is missing."""

    t = np.linspace(0.0, 2.0 * np.pi, 2000)
    on = np.stack([4.0 * np.cos(t), 2.0 * np.sin(t)], axis=1)
    errors = []
    for count in (64, 128):
        x = np.linspace(-5.0, 5.0, count + 1)
        y = x[:, None]
        factor = 0.1 + (x - 3.5) ** 2 + (y - 2.0) ** 2
        values = factor * (np.sqrt(x**2 / 16.0 + y**2 / 4.0) - 1.0)
        shape = ss.from_level_set(values, x, x)
        assert shape.loop_count == 1
        ends = shape.control[shape.starts[:-1]]
        # Near the ellipse its distance is that of the equation over the slope, to second order.
        off = ends[:, 0] ** 2 / 16.0 + ends[:, 1] ** 2 / 4.0 - 1.0
        off /= np.hypot(ends[:, 0] / 8.0, ends[:, 1] / 2.0)
        back = np.abs(ss.signed_distance(shape, on)).max()
        errors.append(max(back, np.abs(off).max()))
    assert math.log2(errors[0] / errors[1]) >= 2.7
    assert errors[1] <= 1e-3


def test_a_level_set_that_leaves_the_grid_is_refused() -> None:
    """Also where it does so between nodes that are all above the level."""
    disk = NODES[:, None] ** 2 + (NODES - 1.7) ** 2 - 1.0
    with pytest.raises(ss.InputError, match="add rows and columns"):
        ss.from_level_set(disk, NODES, NODES)
    between = np.ones((9, 9))
    between[4, 1], between[4, 0], between[3, 0] = -0.1, 0.01, 0.001
    with pytest.raises(ss.InputError, match="add rows and columns"):
        ss.from_level_set(between, np.arange(9.0), np.arange(9.0))
    branches = NODES[:, None] ** 2 - NODES**2 + 0.5  # of a hyperbola
    with pytest.raises(ss.InputError, match="add rows and columns"):
        ss.from_level_set(branches, NODES, NODES)


def test_parts_that_are_narrower_than_the_grid_are_told() -> None:
    """One node below the level between high ones: the curve around it is nowhere."""
    values = np.ones((12, 14))
    values[2:5, 3:6] = [[1.0, 9.0, 1.0], [9.0, -1.0, 9.0], [1.0, 9.0, 1.0]]
    x, y = np.arange(14.0), np.arange(12.0)
    with pytest.raises(ss.InputError, match="sample it finer"):
        ss.from_level_set(values, x, y)
    values[7:10, 8:11] = -1.0
    shape = ss.from_level_set(values, x, y)
    assert shape.loop_count == 1
    assert [note for note in shape.notes if "at (4, 3)" in note and "1 node" in note]
    # A hole likewise, and one node that a mask has by itself is no such thing.
    with_hole = np.where(np.hypot(x - 6.5, y[:, None] - 5.5) < 4.6, -1.0, 1.0)
    with_hole[4:7, 5:8] = [[-1.0, -9.0, -1.0], [-9.0, 1.0, -9.0], [-1.0, -9.0, -1.0]]
    assert "at (6, 5)" in ss.from_level_set(with_hole, x, y).notes[0]
    mask = np.ones((12, 14))
    mask[3, 4] = mask[7, 8] = mask[8, 9] = -1.0
    assert ss.from_level_set(mask, x, y).notes == ()


def test_a_mask_may_come_near_the_border() -> None:
    """Regression: the parabola through 1, 1, -1 is below at the border, and masks were refused."""
    for margin in (1, 2, 3):
        mask = np.ones((16, 18))
        mask[margin:-margin, margin:-margin] = -1.0
        shape = ss.from_level_set(mask, np.arange(18.0), np.arange(16.0))
        # Half a step beyond the nodes, but for rounded corners; beside the border up to 0.15 more.
        wanted = (18.0 - 2.0 * margin) * (16.0 - 2.0 * margin)
        slack = 0.15 * 2.0 * (34.0 - 4.0 * margin) if margin == 1 else 0.0
        assert 0.98 * wanted < sum(turns(shape)) < wanted + slack
        assert shape.loop_count == 1


def test_a_checkerboard_is_told() -> None:
    """All samples alternate: the quasi-interpolant vanishes, and so would all that they say."""
    i, j = np.indices((20, 22))
    values = np.where((i + j) % 2 == 1, 1.0, -1.0)
    values[[0, 1, -2, -1]] = values[:, [0, 1, -2, -1]] = 1.0
    assert "sample it finer" in ss.from_level_set(values, np.arange(22.0), np.arange(20.0)).notes[0]


def test_nodes_in_single_precision_and_far_away() -> None:
    """Both are rounded by more than a millionth of a step: no unequal steps for that."""
    single = np.linspace(0.0, 1.0, 101).astype(np.float32)
    values = np.add.outer((np.linspace(0.0, 1.0, 101) - 0.5) ** 2, (single - 0.5) ** 2) - 0.09
    shape = ss.from_level_set(values, single, single)
    assert ss.signed_distance(shape, (0.5, 0.5)) == pytest.approx(-0.3, abs=1e-6)
    far = np.linspace(0.0, 0.1, 101) + 3e6
    step = np.arange(101.0) - 50.0
    shape = ss.from_level_set(np.add.outer(step**2, step**2) - 900.0, far, far)
    middle = (far[50], far[50])
    assert ss.signed_distance(shape, middle) == pytest.approx(-0.03, abs=1e-8)
    with pytest.raises(ss.InputError, match="nearer to the origin"):
        ss.from_level_set(np.add.outer(step**2, step**2) - 900.0, step + 1e15, step)


def test_one_node_beside_its_place_is_refused() -> None:
    x = np.linspace(0.0, 1.0, 101)
    values = np.add.outer((x - 0.5) ** 2, (x - 0.5) ** 2) - 0.09
    x[40] += 1e-7
    with pytest.raises(ss.InputError, match="equal steps"):
        ss.from_level_set(values, x, np.linspace(0.0, 1.0, 101))
