"""Fit: refine a mesh until the spline is proved to be within a tolerance of the exact distance.

start ─→ quasi-interpolate ─→ bracket the error of cells that changed ─→ all good? ─ yes ─→ reached
             ↑                                                             │ no
             └──── halve the cells around the bad quarters of bad cells ←──┴─ too many? ─→ max_cells
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, NoReturn, Unpack, cast

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import ToleranceNotReached
from splinesdf.fits.certificate import ROUGH, Wanted, cell_errors, largest_error
from splinesdf.fits.request import Band, FitOptions, fit_options, request_of
from splinesdf.fits.target import ShapeTarget
from splinesdf.fits.trials import Trial
from splinesdf.ground.arrays import Bools, Floats
from splinesdf.ground.brief import brief, counted
from splinesdf.ground.doors import public
from splinesdf.ground.progress import Report, checked_report, tell
from splinesdf.meshes import Mesh
from splinesdf.shapes.shape import Shape, check_shape
from splinesdf.splines.provenance import Provenance
from splinesdf.splines.spline import Outside, SplineSDF

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Stopped = Literal["refining", "reached", "max_cells", "min_side", "given"]


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
        With the shape in ``.shape``, and what was asked and found in ``.made``.
    history : tuple of FitStep
        The rounds so far; the last one is this result's.

    Examples
    --------
    >>> import splinesdf as ss
    >>> result = ss.fit(ss.example("gamma1"), tolerance=0.01)
    >>> result.error <= result.bound <= 0.01, result.stopped
    (True, 'reached')
    >>> float(result((0.5, 0.5))) < 0.0
    True
    >>> axes = result.plot()
    """

    spline: SplineSDF
    history: tuple[FitStep, ...]

    def __repr__(self) -> str:
        cells = counted(self.cells, "cell")
        return brief("FitResult", self.spline.name, cells, self._made.errors)

    def __call__(
        self, points: ArrayLike, y: ArrayLike | None = None, *, outside: Outside = "extend"
    ) -> Floats:
        """The spline's values at points of shape (..., 2), or at x and y: (...,)."""
        return self.spline(points, y, outside=outside)

    def __getattr__(self, name: str) -> NoReturn:
        # Not found here: what is asked may be what the spline answers.
        known = not name.startswith("_") and hasattr(SplineSDF, name)
        hint = f": ask its spline, result.spline.{name}" if known else ""
        raise AttributeError(f"a FitResult has no {name!r}{hint}")

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the values and the mesh on axes, the current ones unless given, and return them."""
        axes: Axes = public("plot").drawn(self, ax)
        return axes

    def _repr_html_(self) -> str:
        return self.spline._card("FitResult")

    @property
    def _made(self) -> Provenance:
        assert self.spline.made is not None
        return self.spline.made

    @property
    def tolerance(self) -> float | None:
        """The largest |s - u| that was asked for; None of `interpolate`."""
        return self._made.tolerance

    @property
    def error(self) -> float:
        """The largest |s - u| over what counts, from below.

        Over the whole domain, or where a band is. With a certificate the true maximum is between
        it and ``bound``.
        """
        return self._made.error

    @property
    def centre_error(self) -> float:
        """The paper's error: the largest |s - u| at the centers of cells that count.

        It is three to six times too small and only here to compare with the paper.
        """
        return self.history[-1].centre_error

    @property
    def bound(self) -> float | None:
        """A proved upper bound of the error (docs/theory/certificate.md).

        Not more than half a percent above it, but where that cannot be had; None with
        ``certify=False``.
        """
        return self._made.bound

    @property
    def cells(self) -> int:
        """How many cells the mesh has."""
        return self.history[-1].cells

    @property
    def stopped(self) -> Stopped:
        """Why the loop ended: "reached", "max_cells", "min_side", "refining", "given".

        "refining" in the steps before the last. "given": there was no loop, as `interpolate`
        takes the mesh that it is given.
        """
        return cast(Stopped, self._made.stopped)

    @property
    def evaluations(self) -> int:
        """Exact distances asked for the spline; the proof finds closest points of its own."""
        return self._made.evaluations

    @property
    def bands(self) -> tuple[Band, ...]:
        """Where the tolerance is kept; empty for the whole domain."""
        return self._made.bands


@fit_options
def fit(
    shape: Shape,
    tolerance: float | None = None,
    *,
    progress: Report | None = None,
    **options: Unpack[FitOptions],
) -> FitResult:
    """Approximate the signed distance of a shape to a tolerance.

    Parameters
    ----------
    shape : Shape
    tolerance : float, optional
        Largest |s - u| allowed, in the shape's unit: 1e-3 of the larger side of its box unless
        given. The result says in ``.tolerance`` what it was.
    progress : callable, optional
        Called after each round with a `Progress`: ``print``, for example. What it raises ends the
        fit.

    Other Parameters
    ----------------
    space : {"hierarchical", "tensor", "uniform"}
    element : {"quadratic", "quartic", "cubic", "S31", "M222", "M1122"}
        The B-splines, see ``splinesdf.spaces``. Quartic ones are C², of order 4, and pay around
        levels of smooth outlines at small tolerances, and for curvature; not on tensor grids.
        The others are for comparison, in uniform space only: cubic ones and their mean S31, C¹ of
        order 3 as quadratic ones, and the quartic M222 and M1122, see docs/fit.md.
    operator : str, optional
        The quasi-interpolant. Of the quadratic element S, W, V or P: unless given S, which needs
        the fewest cells at ridges of the distance; for bands P, which reproduces quadratics across
        levels and needs the fewest around smooth levels; W on a tensor grid, which has neither.
        Of the quartic one O (unless given), C, D or V; of cubic ones S or V; of M222 O, X or V, of
        M1122 O, C, D or V.
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

    Examples
    --------
    >>> import splinesdf as ss
    >>> disk = ss.Shape.from_formula("cos(t)", "sin(t)")
    >>> result = ss.fit(disk, tolerance=0.01, band=(-0.1, 0.1))
    >>> abs(float(result.spline((1.05, 0.0))) - 0.05) <= result.bound <= 0.01
    True
    """
    report = checked_report(progress)
    for result in fit_steps(shape, tolerance, **options):
        text = f"{counted(result.cells, 'cell')}, error {result.error:.2e}"
        tell(report, text, len(result.history))
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


@fit_options
def fit_steps(
    shape: Shape, tolerance: float | None = None, **options: Unpack[FitOptions]
) -> Iterator[FitResult]:
    """The loop of `fit`, one result a round; the last one says why it ended and raises nothing."""
    yield from _rounds(shape, tolerance, options, measured=True)


def fit_around(shape: Shape, distance: float, tolerance: float, *, max_cells: int) -> SplineSDF:
    """Approximate as `fit` does around one level, for its contours only.

    The tolerance is proved to be kept. The largest error is not looked for, which takes longer
    than the fit where the boundary runs back and forth within rounding.

    Raises
    ------
    ToleranceNotReached
    """
    options: FitOptions = {"band": (distance, distance), "max_cells": max_cells}
    *_, result = _rounds(shape, tolerance, options, measured=False)
    return require_reached(result).spline


def _rounds(
    shape: Shape, tolerance: float | None, options: FitOptions, *, measured: bool
) -> Iterator[FitResult]:
    """The loop; unless its largest error is measured, a fit that is proved has no bound."""
    target = ShapeTarget(check_shape(shape))
    asked = request_of(target, tolerance, options)
    tolerance, bands, certify = asked.tolerance, asked.bands, asked.certify
    trial = Trial(target, shape, asked.space, asked.operator)
    wanted = Wanted(tolerance, enough=tolerance, around=True, missed=ROUGH, proved=certify)
    history: tuple[FitStep, ...] = ()
    while True:
        spline, cells = trial.spline, trial.changed
        errors = cell_errors(target, spline, cells, trial.center[cells], bands, wanted)
        trial.learn(cells, errors)
        known = trial.known
        bad = known.counts & known.over.any(axis=1)
        count = len(bad)
        stopped = _verdict(spline.mesh, bad, asked.min_side)
        if stopped == "refining" and trial.plan(np.flatnonzero(bad)) > asked.max_cells:
            stopped = "max_cells"
        error, bound = float(known.low[known.counts].max(initial=0.0)), None
        if stopped != "refining" and (measured or stopped != "reached"):
            error, bound = largest_error(target, spline, trial.center, bands, known)
            # What is left to do around bands may be nothing in them.
            stopped = "reached" if certify and bound <= tolerance else stopped
        center = center_error(spline, trial.center, bands)
        history = (*history, FitStep(spline.mesh, count, error, center, trial.evaluations))
        made = Provenance(
            tolerance=tolerance,
            error=error,
            bound=bound if certify and bound is not None and np.isfinite(bound) else None,
            bands=tuple((float(low), float(high)) for low, high in bands),
            space=asked.space.name,
            operator=asked.operator,
            stopped=stopped,
            evaluations=trial.evaluations,
        )
        yield FitResult(replace(spline, made=made), history)
        if stopped != "refining":
            return
        trial.refine()


def center_error(spline: SplineSDF, exact: Floats, bands: Floats) -> float:
    """The largest |s - u| at the centers of cells, those in a band if there are any."""
    middle = spline.element.at_centers(spline.ordinates)
    counts = np.full(len(middle), len(bands) == 0)
    for low, high in bands:
        counts |= (middle >= low) & (middle <= high) | (exact >= low) & (exact <= high)
    return float(np.abs(middle - exact)[counts].max(initial=0.0))


def _verdict(mesh: Mesh, bad: Bools, min_side: float) -> Stopped:
    if not bad.any():
        return "reached"
    boxes = mesh.boxes[bad]
    smallest = float(np.min(boxes[:, 2:] - boxes[:, :2]))
    too_small = smallest < 2.0 * min_side or not mesh.can_halve
    return "min_side" if too_small else "refining"
