from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from tests import naive
from tests.named_shapes import FORMULAS, UNIT, curve, gamma

# Leaves that were needed when this was written; ten more in a hundred are a loss.
LEAVES = {
    ("gamma1", 1e-2): 124,
    ("gamma1", 2e-3): 364,
    ("gamma1", 1e-3): 472,
    ("gamma2", 1e-2): 133,
    ("gamma2", 2e-3): 577,
    ("gamma2", 1e-3): 1114,
    ("gamma2", 1e-4): 10195,
    ("gamma3", 1e-2): 574,
    ("gamma3", 2e-3): 3937,
    ("gamma3", 1e-3): 8131,
}
# Those of operator P in a band around one level.
LEAVES_OF_P = {
    ("gamma1", 1e-4): 208,
    ("gamma1", 1e-5): 832,
    ("gamma2", 1e-4): 463,
    ("gamma2", 1e-5): 1102,
}


@pytest.fixture(scope="module")
def oracle() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Fresh random points and their distance by the naive search, for each curve.

    With 10,000 samples the search is right to 1e-7 even where two branches tie, a ten-thousandth
    of the smallest tolerance here.
    """
    points = np.random.default_rng(99).uniform(0, 1, (100_000, 2))
    result = {}
    for name in FORMULAS:
        distance = naive.curve_distance(
            lambda t, n=name: curve(n, t), 0.0, 2 * np.pi, points, samples=10_000
        )
        result[name] = (points, distance)
    return result


@pytest.mark.parametrize(("name", "tolerance"), LEAVES)
def test_tolerance_is_kept_with_few_leaves(
    name: str, tolerance: float, oracle: dict[str, tuple[np.ndarray, np.ndarray]]
) -> None:
    result = ss.fit(gamma(name), tolerance=tolerance, domain=UNIT)
    points, distance = oracle[name]
    value = result.spline(points)
    # The oracle has no sign; away from the curve the spline has the right one.
    error = np.abs(np.abs(value) - distance)
    near = distance < 2 * tolerance
    signed = np.where(ss.signed_distance(gamma(name), points[near]) < 0, -1.0, 1.0)
    error[near] = np.abs(value[near] - signed * distance[near])
    assert error.max() <= result.bound <= tolerance
    assert result.error <= result.bound <= 1.0051 * result.error
    assert result.cells <= 1.1 * LEAVES[name, tolerance]
    assert result.stopped == "reached"


@pytest.mark.parametrize("space", ["hierarchical", "tensor", "uniform"])
@pytest.mark.parametrize("operator", ["W", "V"])
def test_every_space_keeps_the_tolerance(space: str, operator: str) -> None:
    tolerance = 2e-2
    result = ss.fit(gamma("gamma2"), tolerance=tolerance, space=space, operator=operator)
    xmin, ymin, xmax, ymax = result.spline.domain
    points = np.random.default_rng(1).uniform((xmin, ymin), (xmax, ymax), (100_000, 2))
    error = np.abs(result.spline(points) - ss.signed_distance(gamma("gamma2"), points)).max()
    assert error <= result.bound <= tolerance
    assert result.centre_error <= result.error
    assert [step.cells for step in result.history] == sorted(s.cells for s in result.history)


def test_band_keeps_the_tolerance_where_it_is_asked() -> None:
    shape, band, tolerance = gamma("gamma2"), (-0.03, 0.01), 1e-5
    result = ss.fit(shape, tolerance=tolerance, band=band, domain=UNIT)
    points = np.random.default_rng(2).uniform(0, 1, (300_000, 2))
    exact, value = ss.signed_distance(shape, points), result.spline(points)

    def within(values: np.ndarray) -> np.ndarray:
        return (values >= band[0]) & (values <= band[1])

    counts = within(exact) | within(value)
    assert counts.sum() > 10_000
    assert np.abs(value - exact)[counts].max() <= tolerance
    with pytest.raises(ss.ToleranceNotReached):  # the whole domain asks for far more
        ss.fit(shape, tolerance=tolerance, domain=UNIT, max_cells=2 * result.cells)


def test_stop_reasons_are_named_and_keep_the_best_fit() -> None:
    with pytest.raises(ss.ToleranceNotReached, match="max_cells") as caught:
        ss.fit(gamma("gamma2"), tolerance=1e-4, max_cells=500)
    assert caught.value.result.stopped == "max_cells"
    assert caught.value.result.error > 1e-4
    assert np.isfinite(caught.value.result.spline((0.2, 0.4)))
    with pytest.raises(ss.ToleranceNotReached, match="min_side"):
        ss.fit(gamma("gamma2"), tolerance=1e-4, min_side=0.05)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.nan, np.inf, 1e-17])
def test_bad_tolerances_are_refused(tolerance: float) -> None:
    with pytest.raises(ss.InputError, match="tolerance"):
        ss.fit(gamma("gamma1"), tolerance=tolerance)


@pytest.mark.parametrize(
    "options",
    [{"space": "cubic"}, {"operator": "Z"}, {"domain": (1, 0, 0, 1)}, {"band": (1.0, 0.0)}],
)
def test_bad_options_are_refused(options: dict[str, object]) -> None:
    with pytest.raises(ss.InputError, match="expected"):
        ss.fit(gamma("gamma1"), tolerance=0.1, **options)


def test_unclosed_domain_values_and_queries_of_the_spline() -> None:
    shape = gamma("gamma1")
    spline = ss.fit(shape, tolerance=1e-4, band=(-0.1, 0.1)).spline
    points = np.random.default_rng(3).uniform(0.1, 0.9, (2000, 2))
    exact = ss.signed_distance(shape, points)
    points = points[np.abs(exact) < 0.09]
    exact = exact[np.abs(exact) < 0.09]
    assert np.array_equal(spline.inside(points), exact < 0) or np.abs(exact).min() < 1e-4
    landed = spline.closest_point(points)
    assert np.abs(ss.signed_distance(shape, landed)).max() < 3e-4  # three times the tolerance
    normal = spline.normal(points)
    assert np.allclose(np.linalg.norm(normal, axis=1), 1.0)
    exact_normal = (points - ss.closest_point(shape, points)) / exact[:, None]
    # Normals are good to the square root of the tolerance, up to a constant.
    assert np.abs(normal - exact_normal)[np.abs(exact) > 1e-3].max() < 2 * np.sqrt(1e-4)


@pytest.mark.parametrize("tolerance", [1.0, 1e3, 1e60, 1e300])
def test_a_huge_tolerance_is_answered_with_the_true_error(tolerance: float) -> None:
    """What is kept is far better than what was asked, and what is said of it is true."""
    shape = gamma("gamma2")
    points = np.random.default_rng(6).uniform(0.0, 1.0, (20_000, 2))
    exact = ss.signed_distance(shape, points)
    for band in (None, (-0.05, 0.05)):
        result = ss.fit(shape, tolerance=tolerance, domain=UNIT, band=band)
        assert result.bound is not None
        off = np.abs(result.spline(points) - exact)
        counts = np.ones(len(points), dtype=bool) if band is None else np.abs(exact) <= 0.05
        assert 0.9 * result.error <= off[counts].max() <= result.bound <= 1.01 * result.error
        assert result.error < 0.5 * shape.size


@pytest.mark.parametrize(
    "cells", ["x", 0, -1, 1.5, True, None, float("inf"), float("nan"), 10**400]
)
def test_max_cells_is_a_number_of_cells(cells: object) -> None:
    with pytest.raises(ss.InputError, match=r"max_cells"):
        ss.fit(gamma("gamma1"), tolerance=0.1, max_cells=cells)  # type: ignore[arg-type]


def test_max_cells_as_people_write_a_million() -> None:
    assert ss.fit(gamma("gamma1"), tolerance=0.1, max_cells=1e6).cells > 1  # type: ignore[arg-type]


@pytest.mark.parametrize(("name", "tolerance"), LEAVES_OF_P)
def test_the_diagonal_of_operator_p_follows_the_cell(name: str, tolerance: float) -> None:
    """Where cells are halved, P has order three only if its diagonal alternates between cells.

    With one diagonal for all it keeps order two, and takes three to six times as many cells.
    """
    band = (-0.02, -0.02)
    result = ss.fit(gamma(name), tolerance=tolerance, band=band, domain=UNIT, operator="P")
    assert result.stopped == "reached"
    assert result.cells == pytest.approx(LEAVES_OF_P[name, tolerance], rel=0.1)
