"""Fits in bands of distances: kept where they are asked, however thin they are."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.fits.fit import fit_around
from tests.named_shapes import UNIT, gamma
from tests.real_shapes import icons


def error_in(result: ss.FitResult, shape: ss.Shape, seed: int = 3) -> float:
    """The largest |s - u| at random points of the bands, by the exact distance or the spline."""
    xmin, ymin, xmax, ymax = result.spline.domain
    random = np.random.default_rng(seed)
    points = random.uniform((xmin, ymin), (xmax, ymax), (100_000, 2))
    # Those near the exact levels as well: along the gradient, which is that of the distance.
    exact = ss.signed_distance(shape, points)
    _, gradient = ss.distance.distance_and_gradient(shape, points)
    for level in {value for band in result.bands for value in band}:
        points = np.concatenate([points, points[:100_000] + (level - exact)[:, None] * gradient])
    points = points[np.isfinite(points).all(axis=1)]
    inside = np.all((points >= (xmin, ymin)) & (points <= (xmax, ymax)), axis=1)
    points = points[inside]
    exact, value = ss.signed_distance(shape, points), result.spline(points)
    counts = np.zeros(len(points), dtype=bool)
    for low, high in result.bands:
        counts |= (exact >= low) & (exact <= high) | (value >= low) & (value <= high)
    assert np.count_nonzero(counts) > 100
    return float(np.abs(value - exact)[counts].max())


@pytest.mark.parametrize("operator", ["P", "S", "W"])
def test_several_bands(operator: str) -> None:
    shape, bands = gamma("gamma2"), [(-0.03, -0.02), (0.01, 0.01), (0.1, 0.12)]
    result = ss.fit(shape, tolerance=1e-4, band=bands, domain=UNIT, operator=operator)
    assert result.bands == tuple(bands)
    assert error_in(result, shape) <= result.bound <= 1e-4
    whole = ss.fit(shape, tolerance=1e-4, domain=UNIT)
    assert result.cells < 0.5 * whole.cells


def test_bands_are_united() -> None:
    shape = gamma("gamma1")
    one = ss.fit(shape, tolerance=1e-3, band=(-0.1, 0.05))
    both = ss.fit(
        shape, tolerance=1e-3, band=[(-0.1, -0.02), (-0.02, 0.05)], domain=one.spline.domain
    )
    assert one.cells == both.cells


def test_a_band_thinner_than_the_tolerance_is_not_missed() -> None:
    shape = icons()["github"]
    for level in (-0.3, 0.2, 1.0):
        result = ss.fit(shape, tolerance=1e-3, band=(level, level + 1e-9))
        assert error_in(result, shape) <= result.bound <= 1e-3


def test_a_band_that_is_met_in_one_spot() -> None:
    """A disk's deepest point: the level set is a circle of radius 1e-4."""
    shape = ss.Shape.from_svg_path("M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0z")
    level = -1.0 + 1e-4
    result = ss.fit(shape, tolerance=1e-5, band=(level, level))
    (loop,) = result.spline.contours(level)
    points = loop.points(1e-6)
    assert np.abs(ss.signed_distance(shape, points) - level).max() <= 1e-5


def test_a_band_that_is_nowhere_costs_nothing() -> None:
    shape = gamma("gamma1")
    result = ss.fit(shape, tolerance=1e-6, band=(-0.9, -0.8), domain=UNIT)
    assert result.spline.contours(-0.85) == []
    assert result.error == result.bound == 0.0


@pytest.mark.parametrize(
    "band",
    [
        [],
        (1.0, 0.0),
        (np.nan, 1.0),
        (0.0, np.inf),
        (0.0,),
        (0.0, 1.0, 2.0),
        "ab",
        [(0.0, 1.0), (2.0, 1.0)],
        [[(0.0, 1.0)]],
        [(0.0, 1.0), (2.0,)],
        3.0,
    ],
)
def test_bad_bands_are_refused_in_one_line(band: object) -> None:
    with pytest.raises(ss.InputError, match="band") as caught:
        ss.fit(gamma("gamma1"), tolerance=0.1, band=band)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("name", "distance"), [("gamma2", 0.02), ("github", -0.4)])
def test_a_fit_for_contours_only_is_the_fit(name: str, distance: float) -> None:
    shape = icons()[name] if name in icons() else gamma(name)
    tolerance = 1e-3 * shape.size
    measured = ss.fit(shape, tolerance, band=(distance, distance), max_cells=10_000)
    plain = fit_around(shape, distance, tolerance, max_cells=10_000)
    assert plain.mesh == measured.spline.mesh
    assert np.array_equal(plain.ordinates, measured.spline.ordinates)
    errors = []
    for make in (
        lambda: ss.fit(shape, 1e-3 * tolerance, band=(distance, distance), max_cells=500),
        lambda: fit_around(shape, distance, 1e-3 * tolerance, max_cells=500),
    ):
        with pytest.raises(ss.ToleranceNotReached) as caught:
            make()
        errors.append(str(caught.value))
    assert errors[0] == errors[1]
