"""The source paper's Figures 5-12, drawn again: the same panels under the same numbers.

    5, 7, 9     of Γ₁, Γ₂, Γ₃: (a) the curve, (b) the surface by V, (c) by W; uniform splines
    6, 8, 10    their offsets: (a) +0.01 by W, (b) +0.01 by V, (c) -0.01 by W, (d) -0.01 by V
    11, 12      of Γ₁, Γ₂: the tensor meshes with their diagonals, (a) by W, (b) by V

The splines are those of the last round of the paper's Algorithm 2. Ours are negative inside; the
paper's surfaces are positive inside, and the captions say so.

References
----------
[Wang2014] Section 5, Examples 1-5.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from splinesdf import plot
from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError
from splinesdf.fits.fit import FitResult
from splinesdf.fits.interpolation import interpolate
from splinesdf.offsets.offset import deviation
from splinesdf.paper import tables as paper
from splinesdf.paper.panels import LEVEL, OFFSET, SYMBOLS, caption, draw_curve, new_page, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NUMBERS = tuple(range(5, 13))


def figures(folder: str | os.PathLike[str]) -> list[Path]:
    """Write ``figure_05.png`` to ``figure_12.png`` into a folder, which is made if need be.

    Returns
    -------
    list of Path
        The files, in the order of the paper.

    Raises
    ------
    InputError
        If the folder cannot be made or written to.
    MissingExtraError
        Without matplotlib.
    """
    target = Path(folder)
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot make the folder {os.fspath(folder)!r}: {reason}") from error
    paths = []
    for number in NUMBERS:
        path = target / f"figure_{number:02}.png"
        plot.save_figure(figure(number), path)
        paths.append(path)
    return paths


def figure(number: int) -> Figure:
    """One of the paper's Figures 5-12, with its panels, their titles and a caption.

    Raises
    ------
    InputError
        If the number is another one.
    MissingExtraError
        Without matplotlib.
    """
    if number not in NUMBERS:
        raise InputError(f"expected a figure of 5 to 12, got {number!r}")
    if number > 10:
        return _meshes(number, paper.CURVES[number - 11])
    name = paper.CURVES[(number - 5) // 2]
    return _surfaces(number, name) if number % 2 else _offsets(number, name)


@cache
def final(name: str, mesh: paper.MeshName, operator: str) -> FitResult:
    """The spline at which the paper's algorithm ends, its error at centers and its true error."""
    *_, last = paper.rounds(name, mesh, operator)
    grid = last.grid
    if mesh == "tensor":
        return interpolate(paper.shape(name), (grid.x, grid.y), operator=operator)
    return interpolate(paper.shape(name), grid.shape, operator=operator, domain=paper.DOMAIN)


def _surfaces(number: int, name: str) -> Figure:
    made = new_page(3.6, right=0.04)
    symbol = SYMBOLS[name]
    axes = made.add_subplot(1, 3, 1)
    draw_curve(name, axes)
    title(axes, "a", f"the curve {symbol}")
    results = {operator: final(name, "uniform", operator) for operator in "VW"}
    for k, (operator, result) in enumerate(results.items()):
        axes = made.add_subplot(1, 3, k + 2, projection="3d")
        plot.plot_surface(result.spline, axes)
        title(axes, "bc"[k], f"{operator}({symbol}), {plot.error_text(result)}")
    caption(
        made,
        f"Figure {number}. "
        f"The curve {symbol} and its signed distance by V and by W on {_cells(results['W'])} equal "
        "cells. Here the distance is negative inside and the surface dips there; the paper's "
        "surfaces are positive inside, ours upside down. The dark line is the zero level. "
        f"{_errors(results)}",
    )
    return made


def _offsets(number: int, name: str) -> Figure:
    made = new_page(9.2)
    symbol = SYMBOLS[name]
    axes = made.subplots(2, 2, sharex=True, sharey=True)
    results = {operator: final(name, "uniform", operator) for operator in "WV"}
    panels = [(sign, operator) for sign in (1.0, -1.0) for operator in "WV"]
    for letter, (sign, operator), ax in zip("abcd", panels, axes.flat, strict=True):
        contours = results[operator].spline.contours(sign * OFFSET)
        draw_curve(name, ax, dashed=True)
        plot.plot_contours(contours, ax, color=LEVEL)
        off = plot.at_most(deviation(paper.shape(name), contours))
        side = "+" if sign > 0.0 else "−"
        title(ax, letter, f"{operator}({symbol}) = {side}{OFFSET}: {_chains(contours)}")
        ax.set_xlabel(f"its distance is wrong by {off} at most", fontsize=8, color=plot.INK)
    caption(
        made,
        f"Figure {number}. "
        f"The curve {symbol} (blue, dashed) and its offsets (red) at the distance {OFFSET}, "
        "outside (a, b) and inside (c, d): level sets of W and V on "
        f"{_cells(results['W'])} equal cells. "
        "Here the distance is negative inside, so that −0.01 is inside; the paper's surfaces are "
        f"positive inside. {_errors(results)}",
    )
    return made


def _meshes(number: int, name: str) -> Figure:
    made = new_page(5.1)
    symbol = SYMBOLS[name]
    results = {operator: final(name, "tensor", operator) for operator in "WV"}
    axes = made.subplots(1, 2, sharex=True, sharey=True)
    for letter, (operator, result), ax in zip("ab", results.items(), axes, strict=True):
        plot.plot_mesh(result.spline, ax, diagonals=True)
        draw_curve(name, ax)
        title(
            ax, letter, f"{operator}({symbol}): {_cells(result)} cells, {plot.error_text(result)}"
        )
    caption(
        made,
        f"Figure {number}. "
        f"The tensor meshes at which the paper's refinement ends for {symbol}, with both diagonals "
        "of every cell: on each triangle the spline is one quadratic. It halves the columns and "
        f"rows of cells whose centers are off by {paper.SIGMA:g} or more, until there are none or "
        f"more than {paper.MOST_CELLS} cells. Between the centers the error is larger. "
        f"{_errors(results)}",
    )
    return made


def _chains(contours: Sequence[Contour]) -> str:
    """How many curves there are, and whether some leave the square."""
    closed = sum(contour.closed for contour in contours)
    counts = [(closed, "closed"), (len(contours) - closed, "that leaves the square")]
    texts = []
    for count, kind in counts:
        noun = "curve" if count == 1 else "curves"
        if count:
            texts.append(f"{count} {kind} {noun}" if kind == "closed" else f"{count} {noun} {kind}")
    return ", ".join(texts)


def _cells(result: FitResult) -> str:
    m, n = _grid_shape(result)
    return f"{m} × {n}"


def _grid_shape(result: FitResult) -> tuple[int, int]:
    boxes = result.spline.mesh.boxes
    return len(np.unique(boxes[:, 0])), len(np.unique(boxes[:, 1]))


def _errors(results: dict[str, FitResult]) -> str:
    """The paper's error and the true one, for a caption."""
    centers = ", ".join(f"{key}\u00a0{result.centre_error:.2e}" for key, result in results.items())
    anywhere = ", ".join(f"{key}\u00a0{plot.error_text(result)}" for key, result in results.items())
    return (
        f"Largest error at the centers of cells, which is the paper's: {centers}; "
        f"anywhere, proved: {anywhere}."
    )
