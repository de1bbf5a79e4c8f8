"""The source paper's grids beside our fit, at the same true error, for `fits`."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

from benchmarks.fit_cases import Case, seconds
from benchmarks.tables import OURS, Entry
from splinesdf.errors import ToleranceNotReached
from splinesdf.fits.fit import FitResult, fit_steps

MOST = 300_000  # cells beyond which the paper's method gives up


def given_up(case: Case, share: float, **options: Any) -> FitResult:
    """A fit, or the last round that had no more than `MOST` cells."""
    try:
        return case.fit(share, max_cells=MOST, **options)
    except ToleranceNotReached as stopped:
        best: FitResult = stopped.result
        return best


def uniform(case: Case, share: float) -> FitResult:
    """The coarsest uniform grid of n x n cells that keeps the tolerance, or the last.

    By bisection, of odd n and of even ones: where a ridge lies on the square's axis, as gamma1's
    does, it runs through centers or along edges, and one is far better than the other.
    """
    return min((bisected(case, share, odd) for odd in (1, 0)), key=by_cells)


def by_cells(result: FitResult) -> tuple[bool, int]:
    return result.stopped != "reached", result.cells


def on_grid(case: Case, share: float, n: int) -> FitResult:
    """The uniform grid of n x n cells."""
    options: dict[str, Any] = {"space": "uniform", "operator": "W", "domain": case.domain}
    return next(fit_steps(case.shape, tolerance=share, start=(n, n), **options))


def bisected(case: Case, share: float, odd: int) -> FitResult:
    """The coarsest of the grids whose n is odd, or even, or the last."""

    def at(half: int) -> FitResult:
        return on_grid(case, share, 2 * half - odd)

    half = 1
    while (found := at(half)).stopped != "reached":
        if 16 * half * half > MOST:
            return found
        half *= 2
    low, high = half // 2, half
    while high - low > 1:
        middle = (low + high) // 2
        tried = at(middle)
        if tried.stopped == "reached":
            high, found = middle, tried
        else:
            low = middle
    return found


METHODS: dict[str, Callable[[Case, float], FitResult]] = {
    "hierarchical S": lambda case, share: case.fit(share),
    "hierarchical W": lambda case, share: case.fit(share, operator="W"),
    "tensor W": partial(given_up, space="tensor", operator="W"),
    "uniform W": uniform,
}


def entries(case: Case, share: float, rounds: int) -> list[Entry]:
    """The paper's grids beside our default, for the report."""
    found = {name: run(case, share) for name, run in METHODS.items()}
    runs = {name: partial(run, case, share) for name, run in METHODS.items()}
    # Most of its time goes into looking for the grid.
    known = "uniform W, the grid known"
    found[known] = found["uniform W"]
    runs[known] = partial(on_grid, case, share, round(math.sqrt(found[known].cells)))
    times = [seconds([run], rounds)[0][0] for run in runs.values()]
    return [
        Entry(
            f"{case.name}, {share:.0e}",
            OURS if name == "hierarchical S" else name,
            took,
            found[name].error,
            f"{found[name].cells:,}",
            "" if found[name].stopped == "reached" else f"gave up beyond {MOST:,} cells",
        )
        for name, took in zip(runs, times, strict=True)
    ]
