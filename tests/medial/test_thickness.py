"""Narrow places, largest disks: closed forms, and dense samples of the boundary."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from tests.named_shapes import gamma


def test_walls_of_a_plate_with_a_hole() -> None:
    plate = ss.Shape.rectangle(0, 0, 10, 4) - ss.Shape.circle((3, 2), 1.5)
    found = ss.thickness(plate)
    assert [place.width for place in found] == pytest.approx([0.5, 0.5, 1.5, 4.0], abs=1e-12)
    np.testing.assert_allclose(found[2].point, [0.75, 2.0], atol=1e-7)
    for place in found:
        assert np.hypot(*(place.feet[1] - place.feet[0])) == pytest.approx(place.width, abs=1e-12)


def test_a_ring_is_narrowest_where_its_hole_is_nearest() -> None:
    """Around a closed edge, which may begin anywhere; also outside, where one has no vertices."""
    for angle in (0.0, 1.0, 2.0, 4.0):
        hole = np.array([np.cos(angle), np.sin(angle)])
        (place,) = ss.thickness(ss.Shape.circle((0, 0), 3) - ss.Shape.circle(tuple(hole), 1))
        assert place.width == pytest.approx(1.0, abs=1e-12)
        np.testing.assert_allclose(place.point, 2.5 * hole, atol=1e-6)
        x, y = place.point
        assert repr(place) == f"<Narrow: 1 at ({x:.6g}, {y:.6g})>"
    ring = ss.Shape.circle((0, 0), 2) - ss.Shape.circle((0, 0), 1.5)
    around = ring | ss.Shape.circle((0.25, 0), 0.5)
    (place,) = ss.thickness(around, side="outside")
    assert place.width == pytest.approx(0.75, abs=1e-12)
    (edge,) = ss.medial_axis(around, side="outside").edges
    assert (edge.start, edge.end) == (-1, -1)
    assert [2.0 * edge.smallest, 2.0 * edge.largest] == pytest.approx([0.75, 1.25], abs=1e-9)


def test_what_is_refused() -> None:
    plate = ss.Shape.rectangle(0, 0, 4, 2)
    with pytest.raises(ss.InputError, match='side "inside" or "outside", got'):
        ss.thickness(plate, side="left")  # type: ignore[arg-type]
    with pytest.raises(ss.InputError, match='domain with side="outside" only'):
        ss.thickness(plate, domain=(0, 0, 9, 9))
    least = 4.0 * ss.medial_axis(plate).length / 1e6
    assert ss.local_thickness(plate, [2.0, 0.5], tolerance=1.001 * least) == pytest.approx(2.0)
    with pytest.raises(ss.InputError, match=f"at least {least:.2g}, which takes 1,000,000 disks"):
        ss.local_thickness(plate, [2.0, 0.5], tolerance=0.999 * least)


def test_channels_between_disks() -> None:
    shape = ss.Shape.circle((0, 0), 1) | ss.Shape.circle((3, 0), 1) | ss.Shape.circle((0, 5), 1)
    found = ss.thickness(shape, side="outside")
    expected = [1.0, 3.0, np.hypot(3.0, 5.0) - 2.0]
    assert [place.width for place in found[:2]] == pytest.approx(expected[:2], abs=1e-12)
    assert all(place.width == pytest.approx(expected[2]) for place in found[2:])


def test_parallel_walls_have_one_place_in_their_middle() -> None:
    (place,) = ss.thickness(ss.Shape.rectangle(0, 0, 4, 2))
    assert place.width == 2.0
    np.testing.assert_allclose(place.point, [2.0, 1.0], atol=1e-12)
    (ring,) = ss.thickness(ss.Shape.circle((0, 0), 2) - ss.Shape.circle((0, 0), 1.5))
    assert ring.width == pytest.approx(0.5, abs=1e-12)
    assert ss.thickness(ss.Shape.circle((0, 0), 2)) == []


def test_the_waist_of_a_curve_is_that_of_dense_samples() -> None:
    shape = ss.Shape.from_formula("(2 + cos(2*t))*cos(t)", "(2 + cos(2*t))*sin(t)")
    (place,) = ss.thickness(shape)
    t = np.linspace(0.0, 2.0 * np.pi, 20001)
    points = np.column_stack([(2 + np.cos(2 * t)) * np.cos(t), (2 + np.cos(2 * t)) * np.sin(t)])
    waist = points[np.abs(t - 0.5 * np.pi) < 0.3][:, None] - points[np.abs(t - 1.5 * np.pi) < 0.3]
    assert place.width == pytest.approx(np.hypot(*waist[::10, ::10].T).min(), abs=1e-5)
    assert place.width == pytest.approx(2.0, abs=1e-12)


@pytest.mark.parametrize("name", ["gamma1", "gamma2"])
def test_largest_disks_are_those_of_dense_samples(name: str) -> None:
    """1 / R is the supremum of 2 n.(p - q) / |p - q|^2 over the boundary."""
    shape = gamma(name)
    [dense] = shape.sample(1500)
    at = np.linspace(0, len(dense) - 2, 40).astype(int)
    points, ahead = dense[at], dense[at + 1] - dense[at - 1]
    normal = np.column_stack([-ahead[:, 1], ahead[:, 0]]) / np.hypot(*ahead.T)[:, None]
    normal *= np.sign(shape.signed_distance(points - 1e-4 * normal))[:, None]
    found = ss.maximal_disk(shape, points)
    apart = dense[None] - points[:, None]
    squared = np.sum(apart * apart, axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        k = 2.0 * np.einsum("nj,nmj->nm", normal, apart) / squared
    k[squared < 1e-4] = -np.inf  # beside the point itself differences are rounding
    np.testing.assert_allclose(found.radius, 1.0 / k.max(axis=1), rtol=2e-2)
    assert np.abs(-ss.signed_distance(shape, found.center) - found.radius).max() <= 1e-12


def test_disks_in_corners() -> None:
    shape = ss.Shape.from_points([[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]])
    found = ss.maximal_disk(shape, [[0.0, 0.0], [1.0, 1.0], [np.nan, 0.0]])
    assert found.radius[0] == 0.0
    # Between the corner (1, 1) and both sides, along the diagonal.
    assert found.radius[1] == pytest.approx(2.0 - np.sqrt(2.0), abs=1e-12)
    assert np.isnan(found.radius[2])


def test_local_thickness_is_that_of_the_disk_that_covers() -> None:
    rectangle = ss.Shape.rectangle(0, 0, 4, 2)
    points = np.array([[2.0, 0.1], [1.0, 1.0], [0.05, 0.05], [9.0, 0.0], [np.nan, 0.0]])
    found = ss.local_thickness(rectangle, points, tolerance=1e-3)
    # Of disks in the corner, r (2 - sqrt 2) / 2 ... the one through the point: |p - (r, r)| = r.
    d = 0.05 * np.sqrt(2.0)
    corner = 2.0 * d / (np.sqrt(2.0) - 1.0)
    np.testing.assert_allclose(found[:2], 2.0, atol=3e-3)
    assert found[2] == pytest.approx(corner, abs=2e-2)
    assert found[3] == 0.0
    assert np.isnan(found[4])
    assert (found[:3] >= -2.0 * rectangle.signed_distance(points[:3]) - 2e-3).all()
