"""What cubic and quartic splines answer on level sets and outside their domain."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid, Quadtree
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.splines.level_sets.followed import followed
from splinesdf.splines.quasi import quasi_interpolate
from splinesdf.splines.spline import SplineSDF
from tests import naive_tree
from tests.named_shapes import UNIT, gamma


def waves(points: np.ndarray) -> np.ndarray:
    """Many ovals, saddles and open lines at 0.3."""
    x, y = points.T
    return np.asarray(np.sin(9 * x + 1) * np.cos(7 * y) + 0.2 * x)


def wavy(element: str) -> SplineSDF:
    if element == "cubic":
        return quasi_interpolate(waves, Grid.uniform(UNIT, 14, 11), None, ELEMENTS["cubic"])
    mesh = Quadtree.uniform(UNIT, 6, 5)
    for seed in range(2):
        marked = np.random.default_rng(seed).random(len(mesh.leaves)) < 0.15
        mesh = naive_tree.refine(mesh, marked)
    return quasi_interpolate(waves, mesh, "O", ELEMENTS["quartic"])


@pytest.mark.parametrize("element", ["cubic", "quartic"])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_contours_keep_their_tolerance_and_miss_nothing(element: str, tolerance: float) -> None:
    spline, level = wavy(element), 0.3
    found = spline.contours(level, tolerance=tolerance)
    points = np.concatenate([contour.points() for contour in found])
    inside = np.all((points > 1e-9) & (points < 1.0 - 1e-9), axis=1)
    assert np.abs(spline(points[inside]) - level).max() <= tolerance * (1.0 + 1e-9)
    assert len({contour.closed for contour in found}) == 2
    # By counting: sign changes between neighbors on lines of a fine grid are where contours are.
    x = np.linspace(0.0, 1.0, 801)
    sign = spline(np.stack(np.meshgrid(x, x), axis=-1), outside="nan") < level
    changes = np.argwhere(sign[:, 1:] != sign[:, :-1])
    at = np.stack([x[changes[:, 1]] + 0.000625, x[changes[:, 0]]], axis=1)
    near = np.array([np.hypot(*(points - p).T).min() for p in at])
    step = max(float(np.hypot(*np.diff(contour.points(), axis=0).T).max()) for contour in found)
    assert len(at) > 1000
    assert near.max() <= step + 2e-3
    # And every point of a contour has a change beside it: nothing is surplus.
    both = np.concatenate([at, np.argwhere(sign[1:] != sign[:-1])[:, ::-1] / 800.0])
    apart = np.array([np.hypot(*(both - p).T).min() for p in points[inside]])
    assert apart.max() <= 6e-3


@pytest.mark.parametrize("element", ["cubic", "quartic"])
def test_tangents_of_contours_go_on(element: str) -> None:
    for contour in wavy(element).contours(0.3, tolerance=1e-5):
        start = contour.arcs[:, 1] - contour.arcs[:, 0]
        end = contour.arcs[:, 2] - contour.arcs[:, 1]
        start, end = (v / np.hypot(*v.T)[:, None] for v in (start, end))
        if not contour.closed:
            start, end = start[1:], end[:-1]
        else:
            end = np.roll(end, 1, axis=0)
        assert np.abs(start - end).max() <= 1e-5


def test_contours_of_a_fit_stay_within_a_tenth_of_its_bound() -> None:
    shape = gamma("gamma2")
    result = ss.fit(shape, tolerance=1e-6, band=(-0.02, -0.02), domain=UNIT, element="quartic")
    assert result.cells <= 1000
    assert result.bound is not None
    (contour,) = result.spline.contours(-0.02)
    assert contour.closed
    points = contour.points()
    assert np.abs(result.spline(points) + 0.02).max() <= 0.1 * result.bound
    assert np.abs(ss.signed_distance(shape, points) + 0.02).max() <= 1.1 * result.bound


def test_contours_far_from_the_origin_are_those_near_it() -> None:
    near, far = (
        ss.fit(ss.Shape.circle((at, at), 1.0), 1e-5, band=(0.01, 0.01), element="quartic").spline
        for at in (0.0, 1e6)
    )
    (one,), (other,) = near.contours(0.01), far.contours(0.01)
    radius = np.hypot(*(other.points() - 1e6).T)
    assert len(one.arcs) == len(other.arcs)
    assert np.abs(radius - 1.01).max() <= 1.1e-5


def test_contours_without_a_bound_want_a_tolerance() -> None:
    spline = wavy("quartic")
    with pytest.raises(ss.InputError, match="tolerance of contours for a quartic spline without"):
        spline.contours(0.3)
    with pytest.raises(ss.InputError, match="above rounding"):
        spline.contours(0.3, tolerance=1e-18)
    with pytest.raises(ss.InputError, match="tolerance"):
        spline.contours(0.3, tolerance=-1.0)


@pytest.mark.parametrize(("ceiling", "value"), [("_MOST_CELLS", 154), ("_ROUNDS", 1)])
def test_contours_that_too_many_cells_would_follow_are_refused(
    ceiling: str, value: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The mesh has 154 cells, and one round is not enough: nothing that is worse is returned."""
    spline = wavy("cubic")
    monkeypatch.setitem(followed.__globals__, ceiling, value)
    with pytest.raises(ss.InputError, match="cells can follow, got others: raise their tolerance"):
        spline.contours(0.3, tolerance=1e-3)


@pytest.mark.parametrize("element", ["cubic", "quartic"])
def test_outside_is_the_least_of_border_and_distance(element: str) -> None:
    spline = wavy(element)
    points = np.random.default_rng(0).random((200, 2)) * 3.0 - 1.0
    points = points[np.any((points < 0.0) | (points > 1.0), axis=1)]
    along = np.linspace(0.0, 1.0, 4001)
    zero = np.zeros_like(along)
    sides = [(along, zero), (along, zero + 1.0), (zero, along), (zero + 1.0, along)]
    border = np.concatenate([np.stack(side, axis=1) for side in sides])
    values = spline(border)
    naive = np.array([(values + np.hypot(*(border - p).T)).min() for p in points])
    found, slope = spline.value_and_gradient(points)
    # The samples miss the least value by what s + distance rises in half a step, at most.
    assert (found <= naive + 1e-11).all()
    assert np.abs(found - naive).max() <= 2e-4
    assert np.hypot(*slope.T) == pytest.approx(1.0, abs=1e-12)
    grid = spline.grid(31, 17, domain=(-1.0, -1.0, 2.0, 2.0))
    nodes = np.stack(np.meshgrid(grid.x, grid.y), axis=-1)
    assert np.abs(grid.distance - spline(nodes)).max() <= 1e-15
