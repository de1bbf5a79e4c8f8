"""Figures of the spaces that the paper's Section 8 names, beside its own of S₂¹.

    bsplines            the B-splines: three as surfaces; all six from above, with their supports
    surfaces_gamma1 …   as Figures 5, 7, 9: the curve, the surface by S of S₃¹, by O of S₄²
    offsets_gamma1 …    as Figures 6, 8, 10: offsets +0.01 and -0.01 by both

References
----------
[Wang2014] Sections 5 and 8.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from splinesdf import plot
from splinesdf.errors import InputError
from splinesdf.fits.fit import FitResult
from splinesdf.fits.interpolation import interpolate
from splinesdf.ground.arrays import Floats
from splinesdf.meshes import Grid
from splinesdf.offsets.offset import deviation
from splinesdf.paper import tables as paper
from splinesdf.paper.panels import LEVEL, OFFSET, SYMBOLS, caption, draw_curve, new_page, title
from splinesdf.plot.fields import surface
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.splines.quasi import bspline
from splinesdf.splines.spline import SplineSDF

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NAMES = (
    "bsplines",
    *(f"{kind}_{name}" for name in paper.CURVES for kind in ("surfaces", "offsets")),
)
# Cells each way: those of the paper's Figures 5 to 10.
_CELLS = {"gamma1": 32, "gamma2": 32, "gamma3": 40}
_OPERATORS = {"S31": ("S₃¹", "S"), "quartic": ("S₄²", "O")}
# Symbol, element, family, cuts of a cell by diagonals.
_BSPLINES = (
    ("M₁₁₁₁", "quadratic", 0, 2),
    ("M₂₂₁", "S31", 0, 1),
    ("M₂₂₁₁", "quartic", 0, 2),
    ("M₂₁₂", "S31", 1, 1),
    ("M₂₂₂", "M222", 0, 1),
    ("M₁₁₂₂", "M1122", 0, 2),
)
# Half of what is shown around a B-spline's center: the largest support reaches to 2.5 cells.
_HALF = 2.6
_LINE = np.linspace(-_HALF, _HALF, 261)
# The level sets are followed to this share of the offset: captions tell their errors in digits.
_FOLLOWED = 1e-4
# Where a B-spline is told from zero: its values are a few roundings exact.
_ZERO = 1e-12


def space_figures(folder: Path) -> list[Path]:
    """Write ``spaces_bsplines.png`` and the others into a folder that is there."""
    paths = []
    for name in NAMES:
        path = folder / f"spaces_{name}.png"
        plot.save_figure(space_figure(name), path)
        paths.append(path)
    return paths


def space_figure(name: str) -> Figure:
    """One of the figures, by its name in `NAMES`.

    Raises
    ------
    InputError
        If the name is another one.
    MissingExtraError
        Without matplotlib.
    """
    if name not in NAMES:
        raise InputError(f"expected a figure of {', '.join(NAMES)}, got {name!r}")
    if name == "bsplines":
        return _bsplines()
    kind, curve = name.split("_")
    return _surfaces(curve) if kind == "surfaces" else _offsets(curve)


@cache
def _made(name: str, element: str) -> FitResult:
    """The spline of a curve on the cells of the paper's figures."""
    n, (_, operator) = _CELLS[name], _OPERATORS[element]
    shape = paper.shape(name)
    return interpolate(shape, (n, n), operator=operator, domain=paper.DOMAIN, element=element)


def _bsplines() -> Figure:
    made = new_page(8.6, right=0.03)
    for k, (symbol, element, family, cuts) in enumerate(_BSPLINES):
        spline, center = _around(element, family)
        value = spline(np.stack(np.meshgrid(_LINE, _LINE), axis=-1) + center)
        if k < 3:
            axes: Any = made.add_subplot(3, 3, k + 1, projection="3d")
            surface(axes, (_LINE, _LINE), value, height="value")
            axes.set_box_aspect((1.0, 1.0, 0.8))
            title(axes, "abc"[k], f"{symbol}, {float(spline(center)):.3g} at most")
        flat = made.add_subplot(3, 3, k + 4)
        _flat(flat, value, center % 1.0, cuts)
        title(flat, "defghi"[k], f"{symbol}, {_triangles(spline, cuts)} triangles")
    caption(
        made,
        "B-splines: the quadratic M₁₁₁₁ of S₂¹, the cubic M₂₂₁ of S₃¹ and the quartic M₂₂₁₁ of S₄² "
        "as surfaces (a, b, c). From above these (d, e, f), the second of the three families of "
        "cubics (g), M₂₂₂ on cells cut by one diagonal (h), and M₁₁₂₂ (i): their levels at tenths "
        "of the largest value, the cells and their diagonals, and the border of the support.",
    )
    return made


def _around(element: str, family: int) -> tuple[SplineSDF, Floats]:
    """A B-spline on unit cells, all of its support among them, and its center."""
    kind = ELEMENTS[element]
    spline = bspline(Grid.uniform((0.0, 0.0, 8.0, 8.0), 8, 8), 4, 4, kind, family)
    return spline, 4.0 + np.array(kind.centers[family])


def _triangles(spline: SplineSDF, cuts: int) -> int:
    """How many triangles the support has."""
    reached = np.any(np.abs(spline.element.ordinates(spline.ordinates)) > _ZERO, axis=2)
    # Below one diagonal are S and E, above it N and W.
    return int(np.count_nonzero(reached if cuts == 2 else reached.reshape(-1, 2, 2).any(axis=2)))


def _flat(ax: Axes, value: Floats, center: Floats, cuts: int) -> None:
    """Levels of values around a center, which is so far from the corner of its cell."""
    for at, along in zip(center, (ax.axvline, ax.axhline), strict=True):
        for line in np.arange(-3.0, 4.0) - at:
            along(line, color=plot.FAINT, linewidth=0.5, zorder=0.5)
    for step in np.arange(-7.0, 8.0):
        start = step - center[1] + center[0]
        ax.axline((0.0, start), slope=1.0, color=plot.FAINT, linewidth=0.3, zorder=0.5)
        if cuts == 2:
            start = step - center[1] - center[0]
            ax.axline((0.0, start), slope=-1.0, color=plot.FAINT, linewidth=0.3, zorder=0.5)
    levels = np.linspace(0.0, float(value.max()), 11)[1:]
    ax.contour(_LINE, _LINE, value, levels=levels[:-1], cmap="viridis_r", linewidths=0.9)
    ax.contour(_LINE, _LINE, value, levels=[_ZERO], colors=LEVEL, linewidths=1.6)
    ax.set_aspect("equal")
    ax.set_xlim(-_HALF, _HALF)
    ax.set_ylim(-_HALF, _HALF)
    ax.set_axis_off()


def _surfaces(name: str) -> Figure:
    made = new_page(3.6, right=0.04)
    symbol = SYMBOLS[name]
    axes = made.add_subplot(1, 3, 1)
    draw_curve(name, axes)
    title(axes, "a", f"the curve {symbol}")
    for k, (element, (space, operator)) in enumerate(_OPERATORS.items()):
        result = _made(name, element)
        axes = made.add_subplot(1, 3, k + 2, projection="3d")
        plot.plot_surface(result.spline, axes)
        title(axes, "bc"[k], f"{operator}({symbol}) in {space}, {plot.error_text(result)}")
    caption(
        made,
        f"The curve {symbol} and its signed distance by S of S₃¹ and by O of S₄² on "
        f"{_CELLS[name]} × {_CELLS[name]} equal cells, beside the paper's by V and by W of S₂¹. "
        f"{_errors(name)}",
    )
    return made


def _offsets(name: str) -> Figure:
    made = new_page(9.2)
    symbol = SYMBOLS[name]
    axes = made.subplots(2, 2, sharex=True, sharey=True)
    panels = [(sign, element) for sign in (1.0, -1.0) for element in _OPERATORS]
    for letter, (sign, element), ax in zip("abcd", panels, axes.flat, strict=True):
        space, operator = _OPERATORS[element]
        spline = _made(name, element).spline
        contours = spline.contours(sign * OFFSET, tolerance=_FOLLOWED * OFFSET)
        draw_curve(name, ax, dashed=True)
        plot.plot_contours(contours, ax, color=LEVEL)
        off = plot.at_most(deviation(paper.shape(name), contours))
        side = "+" if sign > 0.0 else "−"
        title(ax, letter, f"{operator}({symbol}) = {side}{OFFSET} in {space}")
        ax.set_xlabel(f"its distance is wrong by {off} at most", fontsize=8, color=plot.INK)
    caption(
        made,
        f"The curve {symbol} (blue, dashed) and its offsets (red) at the distance {OFFSET}, "
        "outside (a, b) and inside (c, d): level sets by S of S₃¹ and by O of S₄² on "
        f"{_CELLS[name]} × {_CELLS[name]} equal cells. {_errors(name)}",
    )
    return made


def _errors(name: str) -> str:
    results = {_OPERATORS[element][1]: _made(name, element) for element in _OPERATORS}
    centers = ", ".join(f"{key}\u00a0{result.centre_error:.2e}" for key, result in results.items())
    anywhere = ", ".join(f"{key}\u00a0{plot.error_text(result)}" for key, result in results.items())
    return (
        f"Largest error at the centers of cells, which is the paper's: {centers}; "
        f"anywhere, proved: {anywhere}."
    )
