"""What the figures of the paper and of its other spaces share: pages, curves, titles, captions."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from splinesdf import plot
from splinesdf.paper import tables as paper

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SYMBOLS = {"gamma1": "Γ₁", "gamma2": "Γ₂", "gamma3": "Γ₃"}
# The paper's delta.
OFFSET = 0.01
# The paper's colors, in shades that color-blind readers tell apart; in print the dashes do.
CURVE, LEVEL = plot.INSIDE, plot.OUTSIDE
_DASHES = (0.0, (5.0, 2.0))
# How often the formula runs through the curve: twice would fill the gaps of a dashed line.
_TRACES = {"gamma1": 1, "gamma2": 1, "gamma3": 2}
# Chords of so many points leave the curves by 3e-6: a hundredth of a dot.
_POINTS = 1000
# Letters on a line of a caption, which is as wide as the figure.
_LINE = 118


def new_page(height: float, *, right: float = 0.0) -> Figure:
    """A figure with room between its panels: numbers of neighbors must not touch.

    At the right a share of the width is kept free, as the layout does not see labels of 3D axes.
    """
    made = plot.new_figure(8.0, height)
    made.set_layout_engine(
        "constrained",
        w_pad=0.1,
        h_pad=0.08,
        wspace=0.03,
        hspace=0.02,
        rect=(0.0, 0.0, 1.0 - right, 1.0),
    )
    return made


def draw_curve(name: str, ax: Axes, *, dashed: bool = False) -> None:
    """The region inside the curve, the curve, and the unit square around it."""
    plot.plot_fill(paper.shape(name), ax)
    formula = paper.formula(name)
    stop = formula.start + (formula.stop - formula.start) / _TRACES[name]
    x, y = formula(np.linspace(formula.start, stop, _POINTS)).T
    style = _DASHES if dashed else "solid"
    ax.plot(x, y, color=CURVE, linewidth=1.1, linestyle=style, zorder=2.5)
    xmin, ymin, xmax, ymax = paper.DOMAIN
    ax.set_xlim(xmin, xmax)
    ax.set_ylim(ymin, ymax)
    for side in ax.spines.values():
        side.set(visible=True, color=plot.FAINT, linewidth=0.6)


def title(ax: Axes, letter: str, text: str) -> None:
    """Write above a panel."""
    ax.set_title(f"({letter})  {text}", fontsize=9, color=plot.INK, loc="left")


def caption(made: Figure, text: str) -> None:
    """Write below the panels."""
    lines: Iterable[str] = textwrap.wrap(text, _LINE)
    made.supxlabel("\n".join(lines), x=0.02, ha="left", fontsize=9, color=plot.INK)
