"""The source paper's Figures 5-12, drawn again; which is which, and the captions, are ours.

    5        the three curves and what they enclose
    6, 7     signed distance of gamma1 and of gamma2 as a surface, by W
    8, 9     offsets of gamma1 at ±0.01, by W and by V
    10, 11   offsets of gamma2 at ±0.01, by W and by V
    12       the four tensor meshes behind them

All but the first are made from the last round of Algorithm 2 (Tables 4-7).
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from splinesdf import paper, plot
from splinesdf.errors import InputError
from splinesdf.offset import deviation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# The paper's delta.
_OFFSET = 0.01
_SYMBOLS = {"gamma1": "Γ₁", "gamma2": "Γ₂", "gamma3": "Γ₃"}
# Half the side of a close-up: the offsets are then far enough apart to be told from the curve.
_CLOSE = 0.06


def figures(folder: str | os.PathLike[str]) -> list[Path]:
    """Write ``figure05.png`` to ``figure12.png`` into a folder, which is made if need be.

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
    last = {
        (name, operator): list(paper.rounds(name, "tensor", operator))[-1]
        for name in ("gamma1", "gamma2")
        for operator in "WV"
    }
    pictures: list[Callable[[], Figure]] = [_curves]
    pictures += [partial(_surface, name, last[name, "W"]) for name in ("gamma1", "gamma2")]
    pictures += [partial(_offsets, *key, final) for key, final in last.items()]
    pictures += [partial(_meshes, last)]
    paths = []
    for number, picture in enumerate(pictures, start=5):
        path = target / f"figure{number:02}.png"
        plot.save_figure(picture(), path)
        paths.append(path)
    return paths


def _curves() -> Figure:
    figure = plot.new_figure(8.0, 3.0)
    axes = figure.subplots(1, 3, sharex=True, sharey=True, gridspec_kw={"wspace": 0.1})
    for name, ax in zip(paper.CURVES, axes, strict=True):
        plot.plot_shape(paper.shape(name), ax)
        _title(ax, _SYMBOLS[name])
        _unit_square(ax)
    return figure


def _surface(name: str, final: paper.Round) -> Figure:
    figure = plot.new_figure(8.0, 3.7)
    left = figure.add_subplot(1, 2, 1, projection="3d")
    plot.plot_surface(final.spline, left)
    right = figure.add_subplot(1, 2, 2)
    plot.add_colorbar(plot.plot_field(final.spline, right), right)
    _title(right, _caption(name, "W", final))
    _unit_square(right)
    return figure


def _offsets(name: str, operator: str, final: paper.Round) -> Figure:
    shape = paper.shape(name)
    contours = [c for sign in (-1, 1) for c in final.spline.contours(sign * _OFFSET)]
    figure = plot.new_figure(8.0, 4.3)
    left, right = figure.subplots(1, 2)
    for ax in (left, right):
        plot.plot_offsets(shape, contours, ax)
    _title(left, _caption(name, operator, final))
    _unit_square(left)
    # The curve's leftmost part: there gamma2 has its dent.
    x, y = paper.formula(name)(np.array([np.pi]))[0]
    right.set_xlim(x - _CLOSE, x + _CLOSE)
    right.set_ylim(y - _CLOSE, y + _CLOSE)
    right.get_legend().remove()
    _title(right, f"close up; at most {plot.at_most(deviation(shape, contours))} off")
    return figure


def _meshes(last: dict[tuple[str, str], paper.Round]) -> Figure:
    figure = plot.new_figure(8.0, 8.2)
    axes = figure.subplots(2, 2, sharex=True, sharey=True)
    for ((name, operator), final), ax in zip(last.items(), axes.flat, strict=True):
        plot.plot_mesh(final.grid, ax, shape=paper.shape(name))
        _title(ax, _caption(name, operator, final))
        _unit_square(ax)
    return figure


def _caption(name: str, operator: str, final: paper.Round) -> str:
    m, n = final.grid.shape
    return f"{_SYMBOLS[name]} by {operator}, {m} × {n} cells"


def _title(ax: Axes, text: str) -> None:
    ax.set_title(text, fontsize=9, color=plot.INK)


def _unit_square(ax: Axes) -> None:
    xmin, ymin, xmax, ymax = paper.DOMAIN
    ax.set_xlim(xmin, xmax)
    ax.set_ylim(ymin, ymax)
