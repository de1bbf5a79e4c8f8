"""Laws of splines and fits: C¹ across every edge; closest points, normals and curvatures."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.meshes import Grid, Quadtree
from splinesdf.spaces.quadratic import TRIANGLES, center_ordinates
from splinesdf.splines.quasi import quasi_interpolate
from splinesdf.splines.spline import SplineSDF
from tests.naive_tree import refine
from tests.named_shapes import UNIT, gamma
from tests.trees import hierarchical_ordinates

ELL = ss.Shape.from_points([(0.1, 0.1), (0.9, 0.1), (0.9, 0.5), (0.4, 0.5), (0.4, 0.9), (0.1, 0.9)])
SHAPES = {"gamma1": gamma("gamma1"), "gamma2": gamma("gamma2"), "ell": ELL}
FITS = [("gamma1", 1e-2), ("gamma1", 1e-4), ("gamma2", 1e-3), ("ell", 1e-2), ("ell", 1e-3)]


def random_spline(seed: int) -> SplineSDF:
    """A three-level mesh and a coefficient at random for every function on it."""
    random = np.random.default_rng(seed)
    mesh = Quadtree.uniform((-3.0, 2.0, 5.0, 7.0), 5, 4)
    for share in (0.15, 0.05):
        mesh = refine(mesh, random.random(len(mesh.leaves)) < share)
    while mesh.depth < 2:
        deepest = np.flatnonzero(mesh.level[mesh.leaves] == mesh.depth)
        mesh = refine(mesh, np.arange(len(mesh.leaves)) == deepest[0])
    assert mesh.depth == 2

    def coefficients(level: int, cells: Ints) -> Floats:
        return random.normal(size=len(cells))

    return SplineSDF(mesh, hierarchical_ordinates(mesh, coefficients))


def in_triangle(spline: SplineSDF, cells: Ints, which: int, points: Floats) -> Floats:
    """Value and gradient of one triangle's quadratic, anywhere: (n,), (n, 2) -> (n, 3)."""
    first, side, second = TRIANGLES[which]
    boxes, ordinates = spline.mesh.boxes[cells], spline.ordinates[cells]
    beside, center = center_ordinates(ordinates)
    corner = np.stack([boxes[:, [i, j]] for j in (1, 3) for i in (0, 2)], axis=1)
    middle = corner.mean(axis=1)
    one, two = corner[:, first] - middle, corner[:, second] - middle
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    slope_a = np.column_stack([two[:, 1], -two[:, 0]]) / area[:, None]
    slope_b = np.column_stack([-one[:, 1], one[:, 0]]) / area[:, None]
    a = np.sum(slope_a * (points - middle), axis=1)
    b = np.sum(slope_b * (points - middle), axis=1)
    c = 1.0 - a - b
    # de Casteljau: the three quadratic's values one step up are half its derivatives as well.
    at_a = ordinates[:, first] * a + ordinates[:, side] * b + beside[:, first] * c
    at_b = ordinates[:, side] * a + ordinates[:, second] * b + beside[:, second] * c
    at_c = beside[:, first] * a + beside[:, second] * b + center * c
    gradient = 2.0 * (slope_a * (at_a - at_c)[:, None] + slope_b * (at_b - at_c)[:, None])
    return np.column_stack([at_a * a + at_b * b + at_c * c, gradient])


def edges(mesh: Quadtree) -> list[tuple[Ints, int, Ints, int, Floats, Floats]]:
    """All inner edges, cut at hanging vertices: cell, triangle, cell, triangle, two ends."""
    boxes, corners = mesh.boxes, mesh.corners
    every = np.arange(len(boxes))
    middle = 0.5 * (boxes[:, :2] + boxes[:, 2:])
    result = []
    # Half-diagonals: triangle and the next one share the corner where the first ends.
    for which in range(4):
        end = TRIANGLES[which][2]
        corner = boxes[:, [2 * (end % 2), 1 + 2 * (end // 2)]]
        result.append((every, which, every, (which + 1) % 4, middle, corner))
    for axis, here, there in ((0, 1, 3), (1, 2, 0)):
        # East of one cell is west of the other, north is south; they share more than a point.
        other = 1 - axis
        meet = corners[:, None, axis + 2] == corners[None, :, axis]
        low = np.maximum(corners[:, None, other], corners[None, :, other])
        high = np.minimum(corners[:, None, other + 2], corners[None, :, other + 2])
        one, two = np.nonzero(meet & (low < high))
        start, stop = np.empty((len(one), 2)), np.empty((len(one), 2))
        start[:, axis] = stop[:, axis] = boxes[one, axis + 2]
        start[:, other] = np.maximum(boxes[one, other], boxes[two, other])
        stop[:, other] = np.minimum(boxes[one, other + 2], boxes[two, other + 2])
        result.append((one, here, two, there, start, stop))
    return result


@pytest.mark.parametrize("seed", range(20))
def test_value_and_gradient_are_continuous_across_every_edge(seed: int) -> None:
    spline = random_spline(seed)
    mesh = spline.mesh
    assert isinstance(mesh, Quadtree)
    size = np.abs(spline.ordinates).max()
    steepest = size / (mesh.boxes[:, 2:] - mesh.boxes[:, :2]).min()
    inner = edges(mesh)
    # Every cell has four half-diagonals, and every length of side inside is met once: it adds up
    # to half of all sides but the border's.
    sides = sum(float(np.abs(stop - start).sum()) for *_, start, stop in inner[4:])
    every = float(2.0 * (mesh.boxes[:, 2:] - mesh.boxes[:, :2]).sum())
    xmin, ymin, xmax, ymax = mesh.domain
    assert sides == pytest.approx(0.5 * (every - 2.0 * (xmax - xmin + ymax - ymin)))
    for one, here, two, there, start, stop in inner:
        # The jumps are quadratic and linear along an edge: zero at three points is zero.
        for share in (0.0, 0.4, 1.0):
            points = start + share * (stop - start)
            jump = in_triangle(spline, one, here, points) - in_triangle(spline, two, there, points)
            assert np.max(np.abs(jump[:, 0])) <= 1e-12 * size
            assert np.max(np.abs(jump[:, 1:])) <= 1e-12 * steepest


def test_what_is_evaluated_is_what_the_law_above_is_about() -> None:
    spline = random_spline(0)
    boxes = spline.mesh.boxes
    cells = np.arange(len(boxes))
    middle = 0.5 * (boxes[:, :2] + boxes[:, 2:])
    for which, toward in enumerate(((0.0, -0.4), (0.4, 0.0), (0.0, 0.4), (-0.4, 0.0))):
        points = middle + np.array(toward) * (boxes[:, 2:] - boxes[:, :2])
        expected = in_triangle(spline, cells, which, points)
        value, gradient = spline.value_and_gradient(points)
        assert value == pytest.approx(expected[:, 0], abs=1e-13)
        assert gradient == pytest.approx(expected[:, 1:], abs=1e-12)


@cache
def fitted(name: str, tolerance: float) -> SplineSDF:
    return ss.fit(SHAPES[name], tolerance=tolerance, domain=UNIT).spline


def outward(shape: ss.Shape, points: Floats) -> Floats:
    """The gradient of the exact distance."""
    found = ss.project(shape, points)
    return np.asarray((points - found.point) / found.distance[..., None])


def away_from_skeleton(shape: ss.Shape, points: Floats, radius: float) -> Floats:
    """The points with no jump of the distance's gradient within this radius.

    It jumps on the skeleton: by the angle of the corner on the branch into a corner, which is a
    right one here, by more elsewhere. Where the level sets bend so much that it turns by half a
    radian within the radius, the point is left out as well.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, 17)[:-1]
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    around = points[:, None] + radius * np.concatenate([0.5 * circle, circle])
    turned = outward(shape, around) - outward(shape, points)[:, None]
    return points[np.hypot(turned[..., 0], turned[..., 1]).max(axis=1) < 0.5]


@pytest.mark.parametrize(("name", "tolerance"), FITS)
def test_closest_point_lands_within_three_tolerances_of_the_curve(
    name: str, tolerance: float
) -> None:
    points = np.random.default_rng(2).uniform(-0.5, 1.5, (10_000, 2))
    points = away_from_skeleton(SHAPES[name], points, np.sqrt(tolerance))
    assert len(points) > 5000
    landed = fitted(name, tolerance).closest_point(points)
    assert np.max(np.abs(ss.signed_distance(SHAPES[name], landed))) <= 3.0 * tolerance


@pytest.mark.parametrize(("name", "tolerance"), FITS)
def test_normal_is_right_to_the_root_of_the_tolerance(name: str, tolerance: float) -> None:
    shape, spline = SHAPES[name], fitted(name, tolerance)
    # With e = s - u, |e| <= tolerance, |D²e| <= M within the radius r of p: the mean slope of e
    # along its gradient through p says |grad e| <= tolerance / r + M r / 2. With r the root of the
    # tolerance that is (1 + M / 2) r; a unit vector along a vector is off by twice as much: C =
    # 2 + M. M is measured about p, from the spline's Hessian and the distance's, 1 / (1/kappa + u).
    radius = np.sqrt(tolerance)
    low, high = radius, 1.0 - radius
    points = np.random.default_rng(3).uniform(low, high, (6_000, 2))
    points = away_from_skeleton(shape, points, radius)
    turn = np.linspace(0.0, 2.0 * np.pi, 17)[:-1]
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    around = points[:, None] + radius * np.concatenate([[[0.0, 0.0]], 0.5 * circle, circle])
    found = ss.project(shape, around)
    with np.errstate(divide="ignore", invalid="ignore"):
        bend = np.abs(1.0 / (1.0 / found.curvature + found.distance))
    bend += np.linalg.norm(spline.hessian(around), ord=2, axis=(-2, -1))
    constant = 2.0 + bend.max(axis=1)
    normal = spline.normal(points)
    off = np.hypot(*(normal - outward(shape, points)).T)
    assert np.hypot(*normal.T) == pytest.approx(1.0, abs=1e-15)
    assert len(points) > 1500
    assert np.all(off <= constant * radius)
    # On these shapes M is no large constant: this was 2.9 at most, in other fits of the three.
    assert np.max(off) <= 4.0 * radius


@pytest.mark.parametrize(("name", "first"), [("gamma1", 32), ("gamma2", 64)])
def test_curvature_converges_with_order_one(name: str, first: int) -> None:
    shape = gamma(name)
    points = np.random.default_rng(4).uniform(0.05, 0.95, (40_000, 2))
    found = ss.project(shape, points)
    points = points[np.abs(found.distance) < 0.02]
    found = ss.project(shape, points)
    # The exact alternative of the docstring.
    exact = found.curvature / (1.0 + found.curvature * found.distance)
    counts = first * np.array([1, 2, 4, 8])
    errors = []
    for count in counts:
        grid = Grid.uniform(UNIT, int(count), int(count))
        spline = quasi_interpolate(lambda p: ss.signed_distance(shape, p), grid, "W")
        errors.append(np.max(np.abs(spline.curvature(points) - exact)))
    order = np.polyfit(np.log(1.0 / counts), np.log(errors), 1)[0]
    assert order == pytest.approx(1.0, abs=0.2)


def test_curvature_outside_the_domain_is_that_of_the_extension() -> None:
    # Of a disk's distance all level sets are circles about its center.
    t = np.linspace(0.0, 2.0 * np.pi, 65)[:-1]
    disk = ss.Shape.from_points(0.5 + 0.3 * np.column_stack([np.cos(t), np.sin(t)]), smooth=True)
    spline = ss.fit(disk, tolerance=1e-5, domain=UNIT, band=(-0.1, 0.5)).spline
    points = np.array([(2.0, 0.5), (0.5, 3.0), (2.0, 2.0), (-1.0, 0.3)])
    radius = np.hypot(*(points - 0.5).T)
    assert spline.curvature(points) == pytest.approx(1.0 / radius, rel=0.1)
