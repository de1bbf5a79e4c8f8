"""`max_cells` is a maximum: no result of a fit, reached or not, has more cells than that."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.fits.fit import fit_steps
from tests.named_shapes import gamma

SPACES = ("hierarchical", "tensor", "uniform")
MOST = 3000
BAR = ss.Shape.from_points([[0.0, 0.0], [5.0, 0.0], [5.0, 1.0], [0.0, 1.0]])
# Tolerances that need more than `MOST` cells in every space, and one that does not everywhere.
CASES = {
    "gamma1": (gamma("gamma1"), {"tolerance": 1e-4}),
    "gamma2": (gamma("gamma2"), {"tolerance": 1e-4}),
    "gamma3 coarse": (gamma("gamma3"), {"tolerance": 2e-2}),
    "bar": (BAR, {"tolerance": 1e-4, "start": (5, 3)}),
    "band": (gamma("gamma2"), {"tolerance": 1e-7, "band": (-0.03, 0.01)}),
}


def results(name: str, space: str, max_cells: int) -> list[ss.FitResult]:
    shape, options = CASES[name]
    return list(fit_steps(shape, space=space, max_cells=max_cells, **options))


@cache
def long_run(name: str, space: str) -> tuple[int, ...]:
    return tuple(result.cells for result in results(name, space, MOST))


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("name", CASES)
@given(max_cells=st.integers(16, MOST))
@example(max_cells=16)
@example(max_cells=256)
@settings(max_examples=12)
def test_a_fit_goes_as_far_as_max_cells_allows_and_no_further(
    name: str, space: str, max_cells: int
) -> None:
    found = results(name, space, max_cells)
    assert all(len(r.spline.ordinates) == r.cells <= max_cells for r in found)
    assert [step.cells for step in found[-1].history] == [r.cells for r in found]
    # The same rounds as with more cells allowed, up to the first that has too many.
    allowed = [cells for cells in long_run(name, space) if cells <= max_cells]
    assert [r.cells for r in found] == allowed
    assert found[-1].stopped in ("reached", "max_cells")
    if found[-1].stopped == "reached":
        assert found[-1].bound <= found[-1].tolerance


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("max_cells", [*range(1, 21), 255, 256, 257])
def test_no_fit_has_more_cells_than_allowed(space: str, max_cells: int) -> None:
    # Also with fewer than the four cells each way that a fit starts from of itself.
    with pytest.raises(ss.ToleranceNotReached, match="max_cells") as caught:
        ss.fit(gamma("gamma2"), tolerance=1e-6, space=space, max_cells=max_cells)
    result = caught.value.result
    assert 1 <= result.cells == len(result.spline.ordinates) <= max_cells
    assert all(step.cells <= max_cells for step in result.history)
    assert np.isfinite(result.bound)


@pytest.mark.parametrize("space", SPACES)
def test_sixteen_by_sixteen_stays_sixteen_by_sixteen(space: str) -> None:
    """The result on the exception had 1,024 cells where 256 were allowed."""
    with pytest.raises(ss.ToleranceNotReached) as caught:
        ss.fit(gamma("gamma2"), tolerance=1e-4, space=space, start=(16, 16), max_cells=256)
    assert caught.value.result.cells == 256
    assert caught.value.result.stopped == "max_cells"


@pytest.mark.parametrize("space", SPACES)
def test_a_fit_that_reaches_its_tolerance_with_too_many_cells_has_not_reached_it(
    space: str,
) -> None:
    enough = ss.fit(gamma("gamma1"), tolerance=1e-2, space=space)
    exactly = ss.fit(gamma("gamma1"), tolerance=1e-2, space=space, max_cells=enough.cells)
    assert exactly.cells == enough.cells
    with pytest.raises(ss.ToleranceNotReached, match="max_cells") as caught:
        ss.fit(gamma("gamma1"), tolerance=1e-2, space=space, max_cells=enough.cells - 1)
    assert caught.value.result.cells == enough.history[-2].cells


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize(("start", "max_cells"), [((16, 16), 255), ((1, 2), 1)])
def test_a_start_of_more_cells_than_allowed_is_refused(
    space: str, start: tuple[int, int], max_cells: int
) -> None:
    m, n = start
    with pytest.raises(ss.InputError, match=f"max_cells.*{m} x {n}"):
        ss.fit(gamma("gamma1"), tolerance=0.1, space=space, start=start, max_cells=max_cells)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("max_cells", [0, -5])
def test_no_cells_at_all_are_refused(space: str, max_cells: int) -> None:
    with pytest.raises(ss.InputError, match="max_cells"):
        ss.fit(gamma("gamma1"), tolerance=0.1, space=space, max_cells=max_cells)


@pytest.mark.parametrize("max_cells", [1, 3, 7, 12])
def test_a_start_for_few_cells_keeps_to_the_domain_s_proportions(max_cells: int) -> None:
    first = next(fit_steps(BAR, tolerance=1e-3, domain=(-1, -1, 7, 2), max_cells=max_cells))
    # Of 8 x 3: 4 x 2 cells, 3 x 1, 2 x 1, or the one.
    assert first.spline.mesh.shape == {1: (1, 1), 3: (3, 1), 7: (3, 1), 12: (4, 2)}[max_cells]
