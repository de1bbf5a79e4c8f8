"""What a fit in bands says of its error: attained in a band, below its bound, below the tolerance.

Regression: a triangle's middle counted that is not in the band, so that `error` was up to five
times the bound. The whole sweep is `python -m benchmarks.bands`.
"""

from __future__ import annotations

import pytest

import splinesdf as ss
from splinesdf.fits.fit import fit_steps
from tests.band_checks import Case, complaint, found_error, random_case


def triangle(*corners: tuple[float, float]) -> ss.Shape:
    return ss.Shape.from_points(corners)


EXAMPLES = {
    "square": Case("square", triangle((0, 0), (1, 0), (1, 1), (0, 1)), [(0.0, 0.03)], 0.003),
    "level": Case("level", triangle((0.7, 0.5), (0.7, 0.2), (0.6, 0.8)), [(0.012, 0.012)], 0.0018),
    "two levels": Case(
        "two levels",
        triangle((0.8, 0), (0.4, 0.3), (0.8, 0.8)),
        [(-0.016, -0.016), (0.016, 0.016)],
        0.0024,
    ),
    "both sides": Case(
        "both sides", triangle((0.8, 0), (0.4, 0.3), (0.8, 0.8)), [(-0.016, 0.016)], 0.0024
    ),
    "where nothing is": Case(
        "where nothing is", triangle((0.1, 0.8), (0.3, 0.8), (0.6, 0.9)), [(-0.05, -0.025)], 0.005
    ),
}
# Of the sweep's, polygons with coarse tolerances: half a second each.
SEEDS = [k for k in range(60) if (c := random_case(k)).tolerance > 2e-3 and "poly" in c.name]


def check(case: Case, result: ss.FitResult) -> None:
    assert complaint(case, result, found_error(case, result)) == ""


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples(name: str) -> None:
    case = EXAMPLES[name]
    result = case.fit()
    check(case, result)
    assert result.centre_error <= result.bound


@pytest.mark.parametrize("seed", SEEDS)
def test_random_fits_in_bands(seed: int) -> None:
    case = random_case(seed)
    check(case, case.fit())


@pytest.mark.parametrize("space", ["tensor", "uniform"])
def test_on_grids(space: str) -> None:
    case = EXAMPLES["both sides"]
    check(case, case.fit(space=space))


@pytest.mark.parametrize("name", EXAMPLES)
def test_without_a_proof(name: str) -> None:
    case = EXAMPLES[name]
    result = case.fit(certify=False)
    assert result.bound is None
    found = found_error(case, result)
    assert found <= 1.01 * case.tolerance
    assert result.error <= min(1.002 * found + 1e-13, case.tolerance)


def test_a_level_that_is_nowhere_has_no_error() -> None:
    result = EXAMPLES["where nothing is"].fit()
    assert result.error == result.bound == 0.0
    assert result.spline.contours(-0.03) == []


def test_a_spline_is_not_left_on_the_wrong_side_of_a_level() -> None:
    """Regression: only points in the band counted, and cells were halved for ever at its end."""
    case = random_case(25)
    *_, result = fit_steps(case.shape, tolerance=case.tolerance, band=case.bands, max_cells=4000)
    assert result.stopped == "reached"


def test_a_fit_that_was_stopped_says_what_is_not_known() -> None:
    case = EXAMPLES["square"]
    with pytest.raises(ss.ToleranceNotReached) as caught:
        case.fit(max_cells=100)
    result = caught.value.result
    assert result.bound > case.tolerance
    assert (result.error > case.tolerance) == ("> tolerance" in str(caught.value))
    found = found_error(case, result)
    assert result.error <= 1.002 * found
    assert found <= result.bound
