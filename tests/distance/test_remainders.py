"""Remainders of models on disks, beside those of exact distances: they hold, and are sharp."""

from __future__ import annotations

import math

import numpy as np
import pytest

from splinesdf.distance.kernels import branches
from splinesdf.distance.tables import Bent
from tests.compiled import from_python

find_branches = from_python(branches.find_branches)
find_point_branches = from_python(branches.find_point_branches)
# Ends of an arclet that points of a disk have a foot in, as `fill_foot_table` has them.
START, END = 2.0, 4.0
DISK = np.array(
    [(a * math.cos(b), a * math.sin(b)) for a in np.linspace(0.0, 1.0, 21) for b in range(200)]
)


def remainder(exact: np.ndarray, model: np.ndarray, way: np.ndarray) -> float:
    """How far a model is off on a disk, at most, at points ``way`` from its middle."""
    u, gx, gy, k = model[:4]
    along = way[:, 1] * gx - way[:, 0] * gy
    return float(np.abs(u + way @ [gx, gy] + 0.5 * k * along * along - exact).max())


def beside_a_circle(bend: float, points: np.ndarray) -> np.ndarray:
    """The signed distance to a circle through the origin, along the x-axis there."""
    away = np.hypot(points[:, 0], points[:, 1] - 1.0 / bend)
    return math.copysign(1.0, bend) * away - 1.0 / bend


@pytest.mark.parametrize("r", [0.001, 0.003])
@pytest.mark.parametrize("bend", [-1.0, 1.0])
@pytest.mark.parametrize("jump", [0.1, 0.3, 1.0])
@pytest.mark.parametrize("u", [-0.3, 0.4])
def test_where_two_circles_meet_smoothly(bend: float, jump: float, u: float, r: float) -> None:
    """With a jump of the curvature that is a share of its other changes on the disk."""
    # Level sets through p have the curvature k, and behind the joint one that is larger.
    k = bend / (1.0 + bend * u)
    other = 1.0 / (1.0 / (k * (1.0 + jump * r * abs(k))) - u)
    bends = np.array([bend, other])
    rows = np.zeros((2, 11))
    rows[:, :2] = rows[:, 3:5] = bends[:, None]
    rows[:, 5] = rows[:, 7] = 1.0
    arcs = np.zeros((2, 16))  # ends and starts but for the origin are not read
    bent = Bent(arcs, np.array([1, -1]), rows, np.zeros((2, 5, 1)), np.array([-1, 0]))
    near, models = np.zeros((2, 9)), np.zeros((4, 12))
    # Distance, parameter, way from the foot to p, curvature, tangent, ends.
    near[0] = abs(u), 1.0, 0.0, -u, bend, 1.0, 0.0, END, 0.0
    near[1] = abs(u), 0.0, 0.0, -u, other, 1.0, 0.0, START, 0.0
    assert find_branches(bent, np.array([0, 1]), 2, (0.0, -u, r), near, models) == 1
    points = r * DISK - [0.0, u]
    sides = [beside_a_circle(b, points) for b in bends]
    exact = np.where(points[:, 0] < 0.0, *sides)
    real, said = remainder(exact, models[0], r * DISK), models[0, 4]
    assert real <= said <= 1.2 * real


@pytest.mark.parametrize("share", [0.003, 0.03, 0.1])
def test_points_of_a_curve(share: float) -> None:
    arcs = np.array([[1.0, 0.4, 0.3, 0.0, 0.0, 0.4, 0.3] + [0.0] * 9])
    rows = np.zeros((1, 11))
    rows[0, 9] = 0.5
    bent = Bent(arcs, np.array([-1]), rows, np.zeros((1, 5, 1)), np.array([-1]))
    near, models = np.zeros((1, 9)), np.zeros((8, 12))
    near[0, 0] = 2.0
    px, py = np.array([0.2, 0.15]) + 2.0 * np.array([-0.6, 0.8])
    count = find_point_branches(bent, np.array([0]), 1, (px, py, 2.0 * share), 0.3, near, models)
    assert count == 2
    for model, point in zip(models[:2], ((0.0, 0.0), (0.4, 0.3)), strict=True):
        exact = np.hypot(*(2.0 * share * DISK + [px, py] - point).T)
        real, said = remainder(exact, model, 2.0 * share * DISK), model[4]
        assert real <= said <= (1.0 + 3.0 * share) * real
