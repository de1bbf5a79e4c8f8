"""The source paper's examples: its curves, its two algorithms as printed, its Tables 1-7.

    formula ─→ Shape ─→ exact distance ─→ quasi-interpolant ─→ error at cell centers < sigma?
                                                 ↑                            │ no
                                                 └──── halve marked cells ←───┘

Nothing else in the package uses this: `splinesdf.fit` has the true error in the paper's place.

References
----------
[Wang2014] R.-H. Wang, Q.-J. Guo, C.-G. Zhu, C.-J. Li, Multivariate spline approximation of the
signed distance function, J. Comput. Appl. Math. 265 (2014) 276-289.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from functools import cache
from importlib import resources
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.distance.exact import signed_distance
from splinesdf.errors import InputError
from splinesdf.fits.certificate import largest_error
from splinesdf.fits.target import ShapeTarget
from splinesdf.ground.arrays import Floats, as_points
from splinesdf.meshes import Box, Grid
from splinesdf.shapes.shape import Shape
from splinesdf.shapes.sources.formula import ParametricCurve, parse_curve
from splinesdf.splines.quasi import quasi_interpolate
from splinesdf.splines.spline import SplineSDF

MeshName = Literal["uniform", "tensor"]

CURVES = ("gamma1", "gamma2", "gamma3")
DOMAIN: Box = (0.0, 0.0, 1.0, 1.0)
# The paper's constants: what the error at a center may be, the smallest side to halve, and the
# number of cells beyond which it stops.
SIGMA, RHO, MOST_CELLS = 2e-3, 2e-4, 1000
_UNIFORM_START = {"gamma1": 4, "gamma2": 4, "gamma3": 5}
_UNIFORM_ROUNDS = 4
_TENSOR_START = 10
_TABLES: tuple[tuple[int, str, MeshName, str], ...] = (
    (1, "gamma1", "uniform", "VW"),
    (2, "gamma2", "uniform", "VW"),
    (3, "gamma3", "uniform", "VW"),
    (4, "gamma1", "tensor", "W"),
    (5, "gamma1", "tensor", "V"),
    (6, "gamma2", "tensor", "W"),
    (7, "gamma2", "tensor", "V"),
)


@dataclass(frozen=True)
class Row:
    """One row of a table: one round of the paper's Algorithm 2.

    Attributes
    ----------
    table : int
    curve : {"gamma1", "gamma2", "gamma3"}
    mesh : {"uniform", "tensor"}
    operator : {"V", "W"}
    k : int
        Refinements so far.
    m, n : int
        Columns and rows of cells.
    error : float
        The paper's error: the largest |s - u| at the cell centers.
    printed : float or None
        What the paper prints there, misprints included; None if it has no such row.
    true_error : float
        The largest |s - u| over the whole domain.
    """

    table: int
    curve: str
    mesh: MeshName
    operator: str
    k: int
    m: int
    n: int
    error: float
    printed: float | None
    true_error: float


class Round(NamedTuple):
    """One round of Algorithm 2: the spline and the errors of its cells."""

    spline: SplineSDF
    grid: Grid
    center: Floats  # (n,) exact distances at the centers of the cells
    errors: Floats  # (n,) |s - u| there


def formula(name: str) -> ParametricCurve:
    """The paper's curve as its formulas; ``name`` is one of `CURVES`."""
    text = _formula_file(name)
    return parse_curve(text["x"], text["y"], text["t"])


@cache
def shape(name: str) -> Shape:
    """The paper's curve as a shape; ``name`` is one of `CURVES`.

    The fill rule is nonzero: gamma3 is traced twice, so even-odd would leave nothing inside.
    """
    text = _formula_file(name)
    return Shape.from_formula(text["x"], text["y"], t=text["t"], fill="nonzero", name=text["name"])


def _formula_file(name: str) -> dict[str, Any]:
    if name not in CURVES:
        raise InputError(f"expected a curve of {', '.join(CURVES)}, got {name!r}")
    file = resources.files("splinesdf") / "data" / f"{name}.json"
    text: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return text


def closest_point_newton(
    curve: ParametricCurve,
    points: ArrayLike,
    *,
    samples: int = 40,
    tolerance: float = 1e-5,
    max_steps: int = 5,
) -> Floats:
    """The paper's Algorithm 1: the point of a curve nearest to each point, perhaps.

    Newton's method on h(t) = (curve(t) - p) · curve'(t), from the nearest of a few equidistant
    samples, until |h| < ``tolerance``. It is here as a reference; use
    `splinesdf.closest_point`, which is exact.

    Parameters
    ----------
    curve : ParametricCurve
    points : array_like, shape (..., 2)
    samples : int
        Equidistant parameters, the start included and the end not.
    tolerance : float
        On |h| after a step, which has the unit of an area.
    max_steps : int

    Returns
    -------
    ndarray, shape (..., 2)
        NaN where h' vanishes in a step, that is where the point is a center of curvature of the
        curve at the parameter reached: gamma2 and the point (0, 0.4), for one. Nothing makes the
        result a minimum rather than a maximum, or the global one; and after ``max_steps`` it is
        whatever has been reached.

    References
    ----------
    [Wang2014] Algorithm 1, with its constants N = 40, tau = 1e-5, N1 = 5 as defaults.
    """
    if samples < 1 or max_steps < 0:
        raise InputError(
            f"expected samples >= 1 and max_steps >= 0, got {samples!r} and {max_steps!r}"
        )
    array = as_points(points)
    targets = array.reshape(-1, 2)
    grid = curve.start + (curve.stop - curve.start) / samples * np.arange(float(samples))
    apart = curve(grid)[None] - targets[:, None]
    t = grid[np.argmin(np.sum(apart * apart, axis=-1), axis=1)]
    active = np.arange(len(targets))
    for _ in range(max_steps):
        value, slope = _stationarity(curve, t[active], targets[active])
        with np.errstate(divide="ignore", invalid="ignore"):
            t[active] -= value / slope
        value, _ = _stationarity(curve, t[active], targets[active])
        active = active[~(np.abs(value) < tolerance)]
    return curve(t).reshape(array.shape)


def _stationarity(curve: ParametricCurve, t: Floats, targets: Floats) -> tuple[Floats, Floats]:
    """The function h of `closest_point_newton` and its derivative, each (n,)."""
    at, first, second = curve.jet(t)
    value = np.sum((at - targets) * first, axis=1)
    return value, np.sum(first * first + (at - targets) * second, axis=1)


def rounds(name: str, mesh: MeshName, operator: str) -> Iterator[Round]:
    """The paper's Algorithm 2 on one of its curves, round by round.

    Parameters
    ----------
    name : {"gamma1", "gamma2", "gamma3"}
    mesh : {"uniform", "tensor"}
        Uniform: every cell is halved three times. Tensor: a line through the middle of the column
        and of the row of every cell whose center is off by ``SIGMA`` or more.
    operator : {"V", "W"}

    References
    ----------
    [Wang2014] Algorithm 2.
    """
    curve = shape(name)

    def distance(points: Floats) -> Floats:
        return signed_distance(curve, points)

    start = _UNIFORM_START[name] if mesh == "uniform" else _TENSOR_START
    grid = Grid.uniform(DOMAIN, start, start)
    k = 0
    while True:
        spline = quasi_interpolate(distance, grid, operator)
        center = distance(0.5 * (grid.boxes[:, :2] + grid.boxes[:, 2:]))
        errors = np.abs(spline.element.at_centers(spline.ordinates) - center)
        yield Round(spline, grid, center, errors)
        k += 1
        if mesh == "uniform":
            if k == _UNIFORM_ROUNDS:
                return
            grid = grid.halve()
            continue
        sides = grid.boxes[:, 2:] - grid.boxes[:, :2]
        marked = (errors >= SIGMA) & (sides.min(axis=1) >= RHO)
        if not marked.any() or len(marked) > MOST_CELLS:
            return
        marked = marked.reshape(grid.shape)
        grid = grid.insert(marked.any(axis=1), marked.any(axis=0))


def tables() -> Iterator[Row]:
    """Tables 1-7 of the paper, computed again, with the true error beside the paper's.

    References
    ----------
    [Wang2014] Section 5.
    """
    printed = _printed()
    for table, name, mesh, operators in _TABLES:
        for operator in operators:
            for k, (spline, grid, center, errors) in enumerate(rounds(name, mesh, operator)):
                yield Row(
                    table=table,
                    curve=name,
                    mesh=mesh,
                    operator=operator,
                    k=k,
                    m=grid.shape[0],
                    n=grid.shape[1],
                    error=float(errors.max()),
                    printed=printed.get((table, operator, k)),
                    true_error=largest_error(ShapeTarget(shape(name)), spline, center)[0],
                )


def _printed() -> dict[tuple[int, str, int], float]:
    """The errors that the paper prints, by table, operator and refinements."""
    text = (resources.files("splinesdf") / "data" / "paper_tables.csv").read_text(encoding="utf-8")
    return {
        (int(row["table"]), row["operator"], int(row["k"])): float(row["printed"])
        for row in csv.DictReader(text.splitlines())
    }


def as_json(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """Rows as dictionaries for JSON, the keys being the names of the attributes of `Row`."""
    return [asdict(row) for row in rows]
