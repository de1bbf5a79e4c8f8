"""Shapes from samples of functions that are no distances."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import splinesdf as ss

Function = Callable[[np.ndarray, np.ndarray], np.ndarray]


def sampled(function: Function, count: int, half: float = 2.0) -> tuple[np.ndarray, np.ndarray]:
    x = np.linspace(-half, half, count)
    return function(*np.meshgrid(x, x)), x


def test_a_quadratic_is_reproduced_whatever_its_slope() -> None:
    values, x = sampled(lambda x, y: 7.0 * (x * x + 4.0 * y * y - 1.0), 24)
    shape = ss.from_level_set(values, x, x, name="ellipse")
    assert (shape.name, shape.loop_count) == ("ellipse", 1)
    t = np.linspace(0.0, 2.0 * np.pi, 500)
    on = np.stack([np.cos(t), 0.5 * np.sin(t)], axis=1)
    assert np.abs(ss.signed_distance(shape, on)).max() <= 1e-13
    # The origin is half an axis from the nearest point.
    assert ss.signed_distance(shape, (0.0, 0.0)) == pytest.approx(-0.5, abs=1e-13)


def test_the_level_and_the_steps_are_free() -> None:
    x, y = np.linspace(-3.0, 3.0, 40), np.linspace(10.0, 20.0, 31)
    values = np.add.outer((y - 15.0) ** 2, x**2)
    shape = ss.from_level_set(values, x, y, level=4.0)
    assert ss.signed_distance(shape, [(0.0, 15.0), (0.0, 18.0)]) == pytest.approx([-2.0, 1.0])


def test_holes_and_several_parts() -> None:
    def rings(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return (np.hypot(x, y) - 1.0) ** 2 - 0.09

    values, x = sampled(rings, 121)
    shape = ss.from_level_set(values, x, x)
    assert shape.loop_count == 2
    places = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.6)]
    assert np.sign(ss.signed_distance(shape, places)).tolist() == [1, -1, 1]


def test_the_curve_is_of_order_three() -> None:
    """Against the exact curve: points of r = 1 + 0.2 cos 3t, where the function vanishes."""

    t = np.linspace(0.0, 2.0 * np.pi, 2000)

    def zero(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        r = np.hypot(x, y)
        cosine = 4.0 * (x / r) ** 3 - 3.0 * (x / r)
        return (r - 1.0 - 0.2 * cosine) * (5.0 + x * y) * np.exp(0.3 * x)

    on = (1.0 + 0.2 * np.cos(3.0 * t))[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)
    counts, errors = np.array([32, 64, 128]), []
    for count in counts:
        values, x = sampled(zero, int(count))
        errors.append(np.abs(ss.signed_distance(ss.from_level_set(values, x, x), on)).max())
    assert np.polyfit(np.log(1.0 / counts), np.log(errors), 1)[0] == pytest.approx(3.0, abs=0.35)
    assert errors[-1] < 1e-5


def test_a_level_set_that_lost_its_slope_is_a_distance_again() -> None:
    part = ss.Shape.from_points([(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)], smooth=True)
    found = ss.signed_distance_grid(part, 200, 180)
    lost = np.sinh(found.distance) * (2.0 + np.sin(5.0 * found.x))
    shape = ss.from_level_set(lost, found.x, found.y)
    again = ss.signed_distance_grid(shape, 200, 180, domain=part.default_domain())
    step = found.x[1] - found.x[0]
    assert np.abs(again.distance - found.distance).max() <= 0.2 * step**2


def test_a_mask_and_a_picture_are_within_a_step() -> None:
    x = np.linspace(-2.0, 2.0, 101)
    disk = np.hypot(*np.meshgrid(x, x)) < 1.0
    shape = ss.from_level_set(np.where(disk, -1.0, 1.0), x, x)
    t = np.linspace(0.0, 2.0 * np.pi, 200)
    on = np.stack([np.cos(t), np.sin(t)], axis=1)
    assert np.abs(ss.signed_distance(shape, on)).max() <= 0.04
    grey = gaussian_filter(disk.astype(float), 1.5)
    shape = ss.from_level_set(-grey, x, x, level=-0.5)
    assert np.abs(ss.signed_distance(shape, on)).max() <= 0.02


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"values": np.ones((9, 8))}, "below the level 0"),
        ({"values": -np.ones((9, 8))}, "all along the border"),
        ({"values": np.full((9, 8), np.nan)}, "finite values"),
        ({"values": np.ones((8, 9))}, r"shape \(9, 8\)"),
        ({"x": np.arange(8.0) ** 2}, "equal steps"),
        ({"x": -np.arange(8.0)}, "increasing"),
        ({"x": np.arange(3.0)}, "at least four"),
        ({"level": np.inf}, "level"),
    ],
)
def test_what_makes_no_shape_is_refused(change: dict[str, object], expected: str) -> None:
    given: dict[str, object] = {"values": np.ones((9, 8)), "x": np.arange(8.0), "y": np.arange(9.0)}
    with pytest.raises(ss.InputError, match=expected):
        ss.from_level_set(**{**given, **change})  # type: ignore[arg-type]
