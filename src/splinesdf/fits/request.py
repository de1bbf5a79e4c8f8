"""The request to a fit: the options of `fit`, checked and with their defaults."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypedDict

import numpy as np

from splinesdf.errors import InputError
from splinesdf.fits.target import Target
from splinesdf.ground.arrays import Floats, as_floats, finite, positive, shown, whole
from splinesdf.ground.options import check_known, with_options
from splinesdf.meshes import Box
from splinesdf.meshes.mesh import check_domain
from splinesdf.spaces.elements import find_element
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.space import Space, first_space

Band = tuple[float, float]

# Cells along the domain's longer side at the start. More: cells wasted where the distance is
# smooth; fewer: more rounds for nothing, each a halving.
_START = 4
# The tolerance, as a share of the larger side of the shape's box, if none is given. Larger: ridges
# and corners look blunt in a picture; smaller: cells that nobody asked for.
_SHARE = 1e-3
# A million cells are 64 MB of ordinates and minutes of work: beyond it something is wrong.
_MAX_CELLS = 1_000_000
# Rounding of the distance, in units of the largest coordinate, with what the proof adds for it: no
# tolerance below it can be kept.
_ROUNDING = 1e-13


class FitOptions(TypedDict, total=False):
    """The options of `splinesdf.fit`, which says what they mean."""

    space: str
    element: str
    operator: str | None
    band: Band | Sequence[Band] | None
    domain: Box | None
    start: tuple[int, int] | None
    max_cells: int
    min_side: float
    certify: bool


DEFAULTS: FitOptions = {
    "space": "hierarchical",
    "element": QUADRATIC.name,
    "operator": None,
    "band": None,
    "domain": None,
    "start": None,
    "max_cells": _MAX_CELLS,
    "min_side": 0.0,
    "certify": True,
}
fit_options = with_options(FitOptions, DEFAULTS)


class Request(NamedTuple):
    """A fit's task: tolerance, where it counts, the space to start from, and limits."""

    tolerance: float
    bands: Floats  # (k, 2) none for the whole domain
    space: Space  # to start from
    operator: str
    max_cells: int
    min_side: float
    certify: bool


def default_tolerance(box: Box) -> float:
    """The tolerance of a fit of what has this box, if none is given."""
    xmin, ymin, xmax, ymax = box
    return _SHARE * max(xmax - xmin, ymax - ymin)


def request_of(target: Target, tolerance: float | None, options: FitOptions) -> Request:
    """The request that options make, or an `InputError`."""
    check_known("fit", options, FitOptions)
    asked: FitOptions = {**DEFAULTS, **options}
    bands, element = _check_bands(asked["band"]), find_element(asked["element"])
    name, operator, domain = asked["space"], asked["operator"], asked["domain"]
    if operator is None:
        operator = element.default_operator(name, len(bands) > 0)
    element.operator(operator)
    outward = float(max(bands.max(initial=0.0), 0.0))
    box = target.domain(outward) if domain is None else check_domain(domain)
    largest = max(abs(value) for value in (*target.box, *box))
    tolerance = default_tolerance(target.box) if tolerance is None else tolerance
    tolerance = positive(tolerance, "tolerance")
    max_cells = whole(asked["max_cells"], "max_cells", least=1, most=2**63 - 1)
    min_side = finite(asked["min_side"], "min_side")
    if min_side < 0.0:
        raise InputError(f"expected min_side from 0 on, got {min_side:g}")
    if tolerance <= _ROUNDING * largest:
        raise InputError(
            f"expected a tolerance above rounding, {_ROUNDING * largest:.1g} for this shape, "
            f"got {tolerance:.4g}"
        )
    space = first_space(name, element, box, _first_cells(box, asked["start"], max_cells))
    return Request(tolerance, bands, space, operator, max_cells, min_side, bool(asked["certify"]))


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


def _first_cells(box: Box, start: tuple[int, int] | None, max_cells: int) -> tuple[int, int]:
    """Cells each way to start from, never more than ``max_cells``."""
    if start is None:
        width, height = box[2] - box[0], box[3] - box[1]
        sides = (max(width, height) / count for count in range(_START, 0, -1))
        counts = ((max(1, round(width / side)), max(1, round(height / side))) for side in sides)
        m, n = next((m, n) for m, n in counts if m * n <= max_cells)  # the last are 1 x 1
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
