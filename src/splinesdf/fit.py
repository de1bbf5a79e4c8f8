"""Fit: refine a mesh until the spline is within a tolerance of the exact distance, everywhere.

start ─→ quasi-interpolate ─→ measure ─→ all cells good? ── yes ─→ measure finely ─→ reached
           ↑                                  │ no                    │ a cell is bad
           └──────────── refine bad cells ←───┴───────────────────────┘
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from operator import index as as_whole
from typing import Literal

import numpy as np

from splinesdf._arrays import Bools, Floats, Ints, positive
from splinesdf.curves.shape import Shape
from splinesdf.distance import signed_distance
from splinesdf.errors import InputError, ToleranceNotReached
from splinesdf.measure import CellErrors, cell_errors, may_meet, sharpen
from splinesdf.meshes import Box, Grid, Mesh, Quadtree
from splinesdf.meshes.mesh import check_domain
from splinesdf.meshes.quadtree import DEEPEST, cell_keys
from splinesdf.probes import probes
from splinesdf.quasi import check_operator, quasi_interpolate, uniform_functional
from splinesdf.spaces import hierarchical_ordinates
from splinesdf.spline import SplineSDF

Stopped = Literal["refining", "reached", "max_cells", "min_side"]
Band = tuple[float, float]

# Cells along the domain's longer side at the start. More: cells wasted where the distance is
# smooth; fewer: more rounds for nothing, each a halving.
_START = 4
# A million cells are 64 MB of ordinates and minutes of work: beyond it something is wrong.
_MAX_CELLS = 1_000_000
# Rounding of the distance, in units of the largest coordinate: no tolerance below it can be kept.
_ROUNDING = 1e-14


@dataclass(frozen=True, eq=False)
class FitStep:
    """One round of the loop: the mesh, what it costs and how good it is."""

    mesh: Mesh
    cells: int
    error: float
    centre_error: float
    evaluations: int


@dataclass(frozen=True, eq=False)
class FitResult:
    """A fit and what is known about it.

    Attributes
    ----------
    spline : SplineSDF
    tolerance : float
        What was asked.
    error : float
        The largest |s - u| found by a search over every cell that counts (all of them, or
        those that may meet the band), finer where it is large.
    centre_error : float
        The paper's error: the largest |s - u| at the centers of these cells. It is three to
        six times too small and only here to compare with the paper.
    bound : float or None
        A proved upper bound of the error; None, as no certificate was asked for.
    cells : int
    stopped : {"reached", "max_cells", "min_side", "refining"}
        Why the loop ended; "refining" in the steps before the last.
    history : tuple of FitStep
    evaluations : int
        Exact distances asked.
    band : pair of float or None
    """

    spline: SplineSDF
    tolerance: float
    error: float
    centre_error: float
    bound: float | None
    cells: int
    stopped: Stopped
    history: tuple[FitStep, ...]
    evaluations: int
    band: Band | None = None


def fit(
    shape: Shape,
    *,
    tolerance: float,
    space: str = "hierarchical",
    operator: str = "W",
    band: Band | None = None,
    domain: Box | None = None,
    start: tuple[int, int] | None = None,
    max_cells: int = _MAX_CELLS,
    min_side: float = 0.0,
) -> FitResult:
    """Approximate the signed distance of a shape to a tolerance.

    Parameters
    ----------
    shape : Shape
    tolerance : float
        Largest |s - u| allowed, in the shape's unit.
    space : {"hierarchical", "tensor", "uniform"}
    operator : {"W", "V", "S", "P"}
        The quasi-interpolant, see `splinesdf.quasi`.
    band : pair of float, optional
        Keep the tolerance only where lo <= u <= hi or lo <= s <= hi; elsewhere the spline may
        be anything that does not take values of the band.
    domain : (xmin, ymin, xmax, ymax), optional
        The shape's box grown by a tenth of its size (and by the band's hi) unless given.
    start : pair of int, optional
        Cells each way to start from; four along the longer side unless given.
    max_cells : int
        Stop when there are more cells.
    min_side : float
        Stop when a cell that is not good enough has a side below twice this.

    Returns
    -------
    FitResult

    Raises
    ------
    ToleranceNotReached
        With the best fit so far in ``result``, if the loop ended for another reason.
    InputError

    References
    ----------
    [Wang2014] Algorithm 2, with the true error in place of the error at cell centers.
    """
    *_, result = fit_steps(
        shape,
        tolerance=tolerance,
        space=space,
        operator=operator,
        band=band,
        domain=domain,
        start=start,
        max_cells=max_cells,
        min_side=min_side,
    )
    return require_reached(result)


def require_reached(result: FitResult) -> FitResult:
    """The last result of `fit_steps`, or `ToleranceNotReached` if it missed its tolerance."""
    if result.stopped == "reached":
        return result
    advice = {
        "max_cells": "raise max_cells or tolerance, or ask for a band",
        "min_side": "lower min_side or raise tolerance",
        "refining": "take the next result",
    }[result.stopped]
    raise ToleranceNotReached(
        f"error {result.error:.3g} > tolerance {result.tolerance:.3g} after {result.cells} cells "
        f"({result.stopped}): {advice}",
        result=result,
    )


def fit_steps(
    shape: Shape,
    *,
    tolerance: float,
    space: str = "hierarchical",
    operator: str = "W",
    band: Band | None = None,
    domain: Box | None = None,
    start: tuple[int, int] | None = None,
    max_cells: int = _MAX_CELLS,
    min_side: float = 0.0,
) -> Iterator[FitResult]:
    """The loop of `fit`, one result a round; the last one says why it ended and raises nothing."""
    check_operator(operator)
    if band is not None:
        band = _check_band(band)
    outward = 0.0 if band is None else max(band[1], 0.0)
    box = shape.default_domain(outward) if domain is None else check_domain(domain)
    largest = max(abs(value) for value in (*shape.box, *box))
    tolerance = positive(tolerance, "tolerance")
    if tolerance <= _ROUNDING * largest:
        raise InputError(
            f"expected a tolerance above rounding, {_ROUNDING * largest:.1g} for this shape, "
            f"got {tolerance:.4g}"
        )
    distance = _Counted(lambda points: signed_distance(shape, points))
    mesh = _start_mesh(space, box, start)
    interpolate = _interpolator(distance, operator)
    points, exact = _probe(distance, shape, band, mesh)
    previous: tuple[SplineSDF, CellErrors, Bools] | None = None
    history: tuple[FitStep, ...] = ()
    while True:
        spline = interpolate(mesh, shape)
        errors, counts = _measure(distance, spline, band, previous)
        # What the samples of a cell may have stepped over.
        np.maximum.at(errors.largest, spline.mesh.locate(points), np.abs(spline(points) - exact))
        bad = counts & (errors.largest > tolerance)
        if not bad.any():
            chosen = np.flatnonzero(counts)
            fine = sharpen(distance, spline, chosen, _rows(errors, chosen), tolerance)
            errors.largest[chosen] = fine
            bad = counts & (errors.largest > tolerance)
            if not bad.any():
                # Good everywhere: now how good, as exactly as the search can tell.
                top = float(fine.max(initial=0.0))
                errors.largest[chosen] = sharpen(
                    distance, spline, chosen, _rows(errors, chosen), top
                )
        previous = (spline, errors, counts)
        error = float(errors.largest[counts].max(initial=0.0))
        center = float(errors.center[counts].max(initial=0.0))
        cells = len(spline.ordinates)
        history = (*history, FitStep(mesh, cells, error, center, distance.count))
        stopped = _verdict(mesh, bad, cells, max_cells, min_side)
        yield FitResult(
            spline=spline,
            tolerance=tolerance,
            error=error,
            centre_error=center,
            bound=None,
            cells=cells,
            stopped=stopped,
            history=history,
            evaluations=distance.count,
            band=band,
        )
        if stopped != "refining":
            return
        mesh = _refine(mesh, bad, space)


class _Counted:
    """A function that counts the points it is asked for."""

    def __init__(self, function: Callable[[Floats], Floats]) -> None:
        self._function = function
        self.count = 0

    def __call__(self, points: Floats) -> Floats:
        self.count += len(points)
        return self._function(points)


def _check_band(band: Band) -> Band:
    try:
        low, high = (float(value) for value in band)
    except (TypeError, ValueError) as error:
        raise InputError(f"expected a band (lo, hi), got {band!r}") from error
    if not (np.isfinite(low) and np.isfinite(high) and low <= high):
        raise InputError(f"expected a band with lo <= hi, got {band!r}")
    return low, high


def _start_mesh(space: str, box: Box, start: tuple[int, int] | None) -> Mesh:
    width, height = box[2] - box[0], box[3] - box[1]
    side = max(width, height) / _START
    m, n = max(1, round(width / side)), max(1, round(height / side))
    if start is not None:
        m, n = _check_start(start)
    if space == "hierarchical":
        return Quadtree.uniform(box, m, n)
    if space in ("tensor", "uniform"):
        return Grid.uniform(box, m, n)
    raise InputError(f"expected space 'hierarchical', 'tensor' or 'uniform', got {space!r}")


def _check_start(start: tuple[int, int]) -> tuple[int, int]:
    try:
        m, n = (as_whole(count) for count in start)
    except (TypeError, ValueError) as error:
        raise InputError(f"expected start as two whole numbers, got {start!r}") from error
    if not (m > 0 and n > 0 and m * n <= _MAX_CELLS):
        raise InputError(f"expected a start of 1 to {_MAX_CELLS:,} cells, got {m} x {n}")
    return m, n


def _interpolator(distance: _Counted, operator: str) -> Callable[[Mesh, Shape], SplineSDF]:
    """Quasi-interpolation that asks for no coefficient of a quadtree twice."""
    known: dict[int, tuple[Ints, Floats]] = {}

    def interpolate(mesh: Mesh, shape: Shape) -> SplineSDF:
        if not isinstance(mesh, Quadtree):
            spline = quasi_interpolate(distance, mesh, operator)
            return SplineSDF(mesh, spline.ordinates, shape.name, shape.y_down)
        tree = mesh

        def functional(level: int, cells: Ints) -> Floats:
            keys = cell_keys(cells)  # sorted, as the space asks for them in that order
            old_keys, old = known.get(level, (np.empty(0, dtype=np.int64), np.empty(0)))
            values = np.empty(len(cells))
            at = np.minimum(np.searchsorted(old_keys, keys), max(len(old_keys) - 1, 0))
            have = old_keys[at] == keys if len(old_keys) else np.zeros(len(keys), dtype=bool)
            values[have] = old[at[have]]
            values[~have] = uniform_functional(distance, tree, operator, level, cells[~have])
            known[level] = (keys, values)
            return values

        return SplineSDF(mesh, hierarchical_ordinates(mesh, functional), shape.name, shape.y_down)

    return interpolate


def _probe(
    distance: _Counted, shape: Shape, band: Band | None, mesh: Mesh
) -> tuple[Floats, Floats]:
    """Points in the domain that no part of the shape hides from, and the exact distances there."""
    steps = (0.0,) if band is None else (*band, 0.5 * (band[0] + band[1]))
    points = probes(distance, shape, steps)
    points = points[mesh.locate(points) >= 0]
    return points, distance(points)


def _measure(
    distance: _Counted,
    spline: SplineSDF,
    band: Band | None,
    previous: tuple[SplineSDF, CellErrors, Bools] | None,
) -> tuple[CellErrors, Bools]:
    """Errors of all cells, and which cells count; a cell that did not change is not asked again."""
    count = len(spline.ordinates)
    errors = CellErrors(*(np.zeros(count) for _ in range(3)))
    counts = np.ones(count, dtype=bool)
    fresh = np.ones(count, dtype=bool)
    if previous is not None and isinstance(spline.mesh, Quadtree):
        new, old = _unchanged(spline, previous[0])
        for now, before in zip(errors, previous[1], strict=True):
            now[new] = before[old]
        counts[new] = previous[2][old]
        fresh[new] = False
    cells = np.flatnonzero(fresh)
    if band is not None:
        counts[cells] = may_meet(distance, spline, cells, band)
        cells = cells[counts[cells]]
    for now, value in zip(errors, cell_errors(distance, spline, cells), strict=True):
        now[cells] = value
    return errors, counts


def _unchanged(spline: SplineSDF, before: SplineSDF) -> tuple[Ints, Ints]:
    """Cells of a quadtree spline that an older one has with the same ordinates, in both numbers."""
    mesh, old_mesh = spline.mesh, before.mesh
    assert isinstance(mesh, Quadtree)
    assert isinstance(old_mesh, Quadtree)
    same_new, same_old = [], []
    levels, index = mesh.level[mesh.leaves], mesh.index[mesh.leaves]
    for level in range(old_mesh.depth + 1):
        cells = np.flatnonzero(levels == level)
        node = old_mesh.find(level, index[cells])
        old_cell = np.where(node >= 0, old_mesh.cell_of[node], -1)
        cells, old_cell = cells[old_cell >= 0], old_cell[old_cell >= 0]
        same = np.all(spline.ordinates[cells] == before.ordinates[old_cell], axis=1)
        same_new.append(cells[same])
        same_old.append(old_cell[same])
    return np.concatenate(same_new), np.concatenate(same_old)


def _rows(errors: CellErrors, rows: Ints) -> CellErrors:
    return CellErrors(*(values[rows] for values in errors))


def _verdict(mesh: Mesh, bad: Bools, cells: int, max_cells: int, min_side: float) -> Stopped:
    if not bad.any():
        return "reached"
    if cells > max_cells:
        return "max_cells"
    boxes = mesh.boxes[bad]
    smallest = float(np.min(boxes[:, 2:] - boxes[:, :2]))
    too_deep = isinstance(mesh, Quadtree) and mesh.depth >= DEEPEST
    return "min_side" if smallest < 2.0 * min_side or too_deep else "refining"


def _refine(mesh: Mesh, bad: Bools, space: str) -> Mesh:
    if isinstance(mesh, Quadtree):
        return mesh.refine(bad)
    assert isinstance(mesh, Grid)
    if space == "uniform":
        return mesh.halve()
    marked = bad.reshape(mesh.shape)
    return mesh.insert(np.any(marked, axis=1), np.any(marked, axis=0))
