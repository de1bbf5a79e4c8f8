"""Fit: refine a mesh until the spline is proved to be within a tolerance of the exact distance.

start ─→ quasi-interpolate ─→ bracket the error of cells that changed ─→ all good? ─ yes ─→ reached
             ↑                                                             │ no
             └──── halve the cells around the bad quarters of bad cells ←──┴─ too many? ─→ max_cells
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from splinesdf.errors import InputError, ToleranceNotReached
from splinesdf.fits.certificate import Wanted, cell_errors, largest_error
from splinesdf.fits.trials import GridTrial, TreeTrial, Trial
from splinesdf.ground.arrays import Bools, Floats, as_floats, finite, positive, shown, whole
from splinesdf.meshes import Box, Grid, Mesh, Quadtree
from splinesdf.meshes.mesh import check_domain
from splinesdf.meshes.quadtree import DEEPEST
from splinesdf.shapes.shape import Shape
from splinesdf.spaces.quadratic_c1 import center_ordinates
from splinesdf.splines.provenance import Provenance
from splinesdf.splines.quasi import check_operator
from splinesdf.splines.spline import SplineSDF

Stopped = Literal["refining", "reached", "max_cells", "min_side", "given"]
Band = tuple[float, float]

# Cells along the domain's longer side at the start. More: cells wasted where the distance is
# smooth; fewer: more rounds for nothing, each a halving.
_START = 4
# A million cells are 64 MB of ordinates and minutes of work: beyond it something is wrong.
_MAX_CELLS = 1_000_000
# Rounding of the distance, in units of the largest coordinate, with what the proof adds for it: no
# tolerance below it can be kept.
_ROUNDING = 1e-13
# Cells of the finest level along a side: pairs of their numbers must fit into one of 63 bits.
_LATTICE = 2**30


@dataclass(frozen=True, eq=False)
class FitStep:
    """One round of the loop: the mesh, what it costs and how good it is.

    Attributes
    ----------
    mesh : Mesh
    cells : int
    error : float
        What was seen of |s - u|, with bands around them too. Cells are left as soon as they are
        known to be bad, so only the last step's is the maximum.
    centre_error : float
        As in `FitResult`.
    evaluations : int
        Exact distances asked so far.
    """

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
        With the shape in ``.shape`` and these figures in ``.made``.
    tolerance : float or None
        What was asked; None of `interpolate`, which is asked for none.
    error : float
        The largest |s - u| over what counts, from below: over the whole domain, or where a
        band is. With a certificate the true maximum is between it and ``bound``.
    centre_error : float
        The paper's error: the largest |s - u| at the centers of cells that count. It is three to
        six times too small and only here to compare with the paper.
    bound : float or None
        A proved upper bound of the error (docs/theory/certificate.md), not more than half a
        percent above it, but where that cannot be had; None with ``certify=False``.
    cells : int
    stopped : {"reached", "max_cells", "min_side", "refining", "given"}
        Why the loop ended; "refining" in the steps before the last. "given": there was no loop,
        as `interpolate` takes the mesh that it is given.
    history : tuple of FitStep
    evaluations : int
        Exact distances asked for the spline; the proof finds closest points of its own.
    bands : tuple of (float, float)
        Empty for the whole domain.
    """

    spline: SplineSDF
    tolerance: float | None
    error: float
    centre_error: float
    bound: float | None
    cells: int
    stopped: Stopped
    history: tuple[FitStep, ...]
    evaluations: int
    bands: tuple[Band, ...] = ()


def fit(
    shape: Shape,
    *,
    tolerance: float,
    space: str = "hierarchical",
    operator: str | None = None,
    band: Band | Sequence[Band] | None = None,
    domain: Box | None = None,
    start: tuple[int, int] | None = None,
    max_cells: int = _MAX_CELLS,
    min_side: float = 0.0,
    certify: bool = True,
) -> FitResult:
    """Approximate the signed distance of a shape to a tolerance.

    Parameters
    ----------
    shape : Shape
    tolerance : float
        Largest |s - u| allowed, in the shape's unit.
    space : {"hierarchical", "tensor", "uniform"}
    operator : {"S", "W", "V", "P"}, optional
        The quasi-interpolant, see `splinesdf.splines.quasi`. Unless given S, which needs the
        fewest cells at ridges of the distance; for bands P, which reproduces quadratics across
        levels and needs the fewest around smooth levels; W on a tensor grid, which has neither.
    band : pair of float, or several, optional
        Keep the tolerance only where lo <= u <= hi or lo <= s <= hi; elsewhere the spline may
        be anything that does not take values of the band.
    domain : (xmin, ymin, xmax, ymax), optional
        The shape's box grown by a tenth of its size (and by the bands' largest hi) unless given.
    start : pair of int, optional
        Cells each way to start from; four along the longer side unless given.
    max_cells : int
        No result has more cells: stop when the next round would make more.
    min_side : float
        Stop when a cell that is not good enough has a side below twice this.
    certify : bool
        Refine until the tolerance is proved to be kept. It costs little, but for outlines of
        thousands of corners at a coarse tolerance: twice the time. Otherwise what a proof would
        need a closer look for is sampled and believed, and ``bound`` is None.

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
        certify=certify,
    )
    return require_reached(result)


def require_reached(result: FitResult) -> FitResult:
    """The last result of `fit_steps`, or `ToleranceNotReached` if it missed its tolerance."""
    if result.stopped in ("reached", "given"):
        return result
    advice = {
        "max_cells": "raise max_cells or tolerance, or ask for a band",
        "min_side": "lower min_side or raise tolerance",
        "refining": "take the next result",
    }[result.stopped]
    missed = ">" if result.error > (result.tolerance or 0.0) else "is not proved to be within the"
    raise ToleranceNotReached(
        f"error {result.error:.3g} {missed} tolerance {result.tolerance:.3g} after {result.cells} "
        f"cells ({result.stopped}): {advice}",
        result=result,
    )


def fit_steps(
    shape: Shape,
    *,
    tolerance: float,
    space: str = "hierarchical",
    operator: str | None = None,
    band: Band | Sequence[Band] | None = None,
    domain: Box | None = None,
    start: tuple[int, int] | None = None,
    max_cells: int = _MAX_CELLS,
    min_side: float = 0.0,
    certify: bool = True,
) -> Iterator[FitResult]:
    """The loop of `fit`, one result a round; the last one says why it ended and raises nothing."""
    bands = _check_bands(band)
    if operator is None:
        # The fewest cells, by docs/fit.md: S where there are ridges, P around smooth levels.
        operator = "W" if space == "tensor" else "P" if len(bands) else "S"
    check_operator(operator)
    outward = float(max(bands.max(initial=0.0), 0.0))
    box = shape.default_domain(outward) if domain is None else check_domain(domain)
    largest = max(abs(value) for value in (*shape.box, *box))
    tolerance = positive(tolerance, "tolerance")
    max_cells = whole(max_cells, "max_cells", least=1, most=2**63 - 1)
    min_side = finite(min_side, "min_side")
    if min_side < 0.0:
        raise InputError(f"expected min_side from 0 on, got {min_side:g}")
    if tolerance <= _ROUNDING * largest:
        raise InputError(
            f"expected a tolerance above rounding, {_ROUNDING * largest:.1g} for this shape, "
            f"got {tolerance:.4g}"
        )
    trial = _first_trial(shape, space, box, _first_cells(box, start, max_cells), operator)
    wanted = Wanted(threshold=tolerance, enough=tolerance, around=True, proved=certify)
    history: tuple[FitStep, ...] = ()
    while True:
        spline, cells = trial.spline, trial.changed
        errors = cell_errors(shape, spline, cells, trial.center[cells], bands, wanted)
        trial.learn(cells, errors)
        known = trial.known
        bad = known.counts & known.over.any(axis=1)
        count = len(bad)
        stopped = _verdict(spline.mesh, bad, min_side)
        if stopped == "refining" and trial.plan(np.flatnonzero(bad)) > max_cells:
            stopped = "max_cells"
        error, bound = float(known.low[known.counts].max(initial=0.0)), None
        if stopped != "refining":
            error, bound = largest_error(shape, spline, trial.center, bands, known)
            # What is left to do around bands may be nothing in them.
            stopped = "reached" if certify and bound <= tolerance else stopped
        center = center_error(spline, trial.center, bands)
        history = (*history, FitStep(spline.mesh, count, error, center, trial.evaluations))
        yield result_of(
            spline,
            tolerance=tolerance,
            error=error,
            bound=bound if certify else None,
            history=history,
            space=space,
            operator=operator,
            stopped=stopped,
            bands=tuple((float(low), float(high)) for low, high in bands),
        )
        if stopped != "refining":
            return
        trial.refine()


def result_of(
    spline: SplineSDF,
    *,
    tolerance: float | None,
    error: float,
    bound: float | None,
    history: tuple[FitStep, ...],
    space: str,
    operator: str,
    stopped: Stopped,
    bands: tuple[Band, ...] = (),
) -> FitResult:
    """The result whose last step is that of the history; its spline knows how it was made."""
    last = history[-1]
    made = Provenance(
        tolerance=tolerance,
        error=error,
        bound=bound if bound is not None and np.isfinite(bound) else None,
        bands=bands,
        space=space,
        operator=operator,
        stopped=stopped,
        evaluations=last.evaluations,
    )
    return FitResult(
        spline=replace(spline, made=made),
        tolerance=tolerance,
        error=error,
        centre_error=last.centre_error,
        bound=made.bound,
        cells=last.cells,
        stopped=stopped,
        history=history,
        evaluations=last.evaluations,
        bands=bands,
    )


def center_error(spline: SplineSDF, exact: Floats, bands: Floats) -> float:
    """The largest |s - u| at the centers of cells, those in a band if there are any."""
    middle = center_ordinates(spline.ordinates)[1]
    counts = np.full(len(middle), len(bands) == 0)
    for low, high in bands:
        counts |= (middle >= low) & (middle <= high) | (exact >= low) & (exact <= high)
    return float(np.abs(middle - exact)[counts].max(initial=0.0))


def _check_bands(bands: Band | Sequence[Band] | None) -> Floats:
    """One band or several as an array (k, 2)."""
    if bands is None:
        return np.empty((0, 2))
    array = as_floats(bands, "a band (lo, hi) or several")
    array = array.reshape(1, 2) if array.shape == (2,) else array
    if array.ndim != 2 or array.shape[1] != 2 or len(array) == 0:
        raise InputError(f"expected a band (lo, hi) or several, got {shown(bands)}")
    if not (np.isfinite(array).all() and np.all(array[:, 0] <= array[:, 1])):
        raise InputError(f"expected a band with finite lo <= hi, got {shown(bands)}")
    return array


def _first_trial(
    shape: Shape, space: str, box: Box, start: tuple[int, int], operator: str
) -> Trial:
    if space == "hierarchical":
        return TreeTrial(shape, box, start, operator)
    if space in ("tensor", "uniform"):
        return GridTrial(shape, Grid.uniform(box, *start), operator, space == "uniform")
    raise InputError(f"expected space 'hierarchical', 'tensor' or 'uniform', got {space!r}")


def _first_cells(box: Box, start: tuple[int, int] | None, max_cells: int) -> tuple[int, int]:
    """Cells each way to start from, never more than ``max_cells``."""
    if start is None:
        width, height = box[2] - box[0], box[3] - box[1]
        for count in range(_START, 0, -1):
            side = max(width, height) / count
            m, n = max(1, round(width / side)), max(1, round(height / side))
            if m * n <= max_cells:
                break
    else:
        m, n = _check_start(start)
    if m * n > max_cells:
        raise InputError(
            f"expected max_cells of at least the cells to start from, got {max_cells} for {m} x {n}"
        )
    return m, n


def _check_start(start: tuple[int, int]) -> tuple[int, int]:
    try:
        m, n = start
    except (TypeError, ValueError) as error:
        raise InputError(f"expected start as two whole numbers, got {shown(start)}") from error
    m, n = (whole(count, "start", least=1, most=_MAX_CELLS) for count in (m, n))
    if m * n > _MAX_CELLS:
        raise InputError(f"expected a start of 1 to {_MAX_CELLS:,} cells, got {m} x {n}")
    return m, n


def _verdict(mesh: Mesh, bad: Bools, min_side: float) -> Stopped:
    if not bad.any():
        return "reached"
    boxes = mesh.boxes[bad]
    smallest = float(np.min(boxes[:, 2:] - boxes[:, :2]))
    too_deep = isinstance(mesh, Quadtree) and (
        mesh.depth >= DEEPEST or max(mesh.shape) << mesh.depth >= _LATTICE
    )
    return "min_side" if smallest < 2.0 * min_side or too_deep else "refining"
