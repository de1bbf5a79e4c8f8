"""Interpolation: the spline of a shape on a mesh that is given, and how good it is.

given mesh ─→ quasi-interpolate the exact distance ─→ bracket the largest error over the domain

One round of `fit`, without a tolerance: what the source paper does on m x n cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import index as as_whole

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import InputError
from splinesdf.fits.certificate import largest_error
from splinesdf.fits.fit import FitResult, FitStep, center_error
from splinesdf.fits.target import ShapeTarget
from splinesdf.fits.trials import Trial
from splinesdf.ground.arrays import Floats
from splinesdf.meshes import Box, Grid
from splinesdf.meshes.mesh import check_domain
from splinesdf.shapes.shape import Shape, check_shape
from splinesdf.spaces.elements import find_element
from splinesdf.spaces.space import space_on
from splinesdf.splines.provenance import Provenance

# A million cells are 64 MB of ordinates: beyond it the counts are a slip. As in `fit`.
_MAX_CELLS = 1_000_000
# Grid lines are at least this share of the largest coordinate apart: nearer, the rounding of the
# distance is as large as what the spline is made from, and slopes become noise.
_APART = 1e-13

CellCounts = tuple[int, int]
Knots = tuple[ArrayLike, ArrayLike]


def interpolate(
    shape: Shape,
    mesh: CellCounts | Knots | Sequence[ArrayLike],
    *,
    operator: str | None = None,
    domain: Box | None = None,
    element: str = "quadratic",
) -> FitResult:
    """Approximate the signed distance of a shape on a given mesh, with no tolerance to keep.

    Parameters
    ----------
    shape : Shape
    mesh : (m, n) or (x, y)
        Columns and rows of equal cells; or the knots of a tensor grid, two increasing arrays of
        shapes (m + 1,) and (n + 1,).
    operator : str, optional
        The quasi-interpolant. Of the quadratic element W (unless given), V, S or P; of the others
        as in `fit`. S and P need equal cells. None of them has the distance's values at points, as
        an interpolant in the strict sense would.
    domain : (xmin, ymin, xmax, ymax), optional
        For (m, n); knots are a domain. As in `fit` unless given.
    element : {"quadratic", "quartic", "cubic", "S31", "M222", "M1122"}
        As in `fit`.

    Returns
    -------
    FitResult
        ``error`` is the largest |s - u| over the domain, ``bound`` a proved upper bound of it and
        ``centre_error`` the source paper's error, at cell centers only. ``tolerance`` is None and
        ``stopped`` is "given".

    Raises
    ------
    InputError
        If the mesh has no cells or more than a million, its knots do not increase, or it does not
        suit the operator.

    References
    ----------
    [Wang2014] Section 3.

    Examples
    --------
    >>> import splinesdf as ss
    >>> result = ss.interpolate(ss.example("gamma1"), (8, 8), domain=(0, 0, 1, 1))
    >>> result.cells, result.error <= result.bound
    (64, True)
    """
    check_shape(shape)
    kind, grid = find_element(element), _grid(shape, mesh, domain)
    operator = kind.defaults["given"] if operator is None else operator
    kind.operator(operator)
    target, space = ShapeTarget(shape), space_on(grid, kind)
    trial = Trial(target, shape, space, operator)
    spline = trial.spline
    low, high = largest_error(target, spline, trial.center)
    # The bracket is half a percent wide, and a center may be where the error is largest.
    center = center_error(spline, trial.center, np.empty((0, 2)))
    step = FitStep(grid, grid.cell_count, max(low, center), center, trial.evaluations)
    made = Provenance(
        tolerance=None,
        error=step.error,
        bound=max(high, center),
        bands=(),
        space="uniform" if np.ndim(mesh[0]) == 0 else "tensor",
        operator=operator,
        stopped="given",
        evaluations=trial.evaluations,
    )
    return FitResult(replace(spline, made=made), (step,))


def _grid(shape: Shape, mesh: CellCounts | Knots | Sequence[ArrayLike], domain: Box | None) -> Grid:
    """The grid that is meant."""
    try:
        first, second = mesh
        kinds = np.ndim(first), np.ndim(second)
    except (TypeError, ValueError):
        kinds = (-1, -1)
    if kinds == (0, 0):
        m, n = _counts(first, second)
        box = shape.default_domain(0.0) if domain is None else check_domain(domain)
        grid = Grid.uniform(box, m, n)
    elif kinds == (1, 1):
        if domain is not None:
            raise InputError("expected no domain beside knots, which are one: leave it out")
        x, y = _numbers("x", first), _numbers("y", second)
        grid = Grid(x, y)
    else:
        got = " ".join(repr(mesh).split())
        raise InputError(
            f"expected a mesh (m, n) of cells each way, or a pair of arrays of knots, got {got:.80}"
        )
    for name, lines in (("x", grid.x), ("y", grid.y)):
        _check_lines(name, lines)
    check_domain(grid.domain)
    _check_count(*grid.shape)
    return grid


def _counts(first: object, second: object) -> CellCounts:
    try:
        m, n = as_whole(first), as_whole(second)  # type: ignore[arg-type]
    except TypeError as error:
        raise InputError(
            f"expected whole numbers of cells each way, got ({first!r:.40}, {second!r:.40})"
        ) from error
    _check_count(m, n)
    return m, n


def _check_count(m: int, n: int) -> None:
    if not (m > 0 and n > 0 and m * n <= _MAX_CELLS):
        raise InputError(f"expected a mesh of 1 to {_MAX_CELLS:,} cells, got {m} x {n}")


def _numbers(name: str, values: object) -> Floats:
    try:
        # A copy, so that no later change of the caller's reaches the spline.
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"expected knots in {name} as numbers, got others") from error


def _check_lines(name: str, lines: Floats) -> None:
    if len(lines) < 2:
        raise InputError(f"expected two knots in {name} or more, got {len(lines)}")
    if not np.isfinite(lines).all():
        raise InputError(f"expected finite knots in {name}, got NaN or infinity")
    gaps = np.diff(lines)
    apart = _APART * float(np.abs(lines).max())
    if not gaps.min() > apart:
        i = int(np.argmin(gaps))
        raise InputError(
            f"expected grid lines in {name} that increase by more than {apart:.1g}, got "
            f"{float(lines[i])!r} and then {float(lines[i + 1])!r}"
        )
