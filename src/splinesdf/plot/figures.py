"""Figures and their look: how they are made, colored, labelled and saved."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from splinesdf.errors import InputError, MissingExtraError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.atomic import atomic_file
from splinesdf.ground.brief import measured_in
from splinesdf.ground.paths import as_path
from splinesdf.meshes import Box

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import QuadContourSet
    from matplotlib.figure import Figure

FORMATS = (".pdf", ".png", ".svg")
INK = "#22303c"
INSIDE, OUTSIDE = "#0072b2", "#d55e00"
FAINT = "#8c98a4"
# Dots an inch of PNG: a figure of eight inches is 1600 dots wide and crisp when shown at 800.
_DPI = 200


def new_figure(width: float, height: float) -> Figure:
    """An empty figure, sizes in inches.

    Raises
    ------
    MissingExtraError
        Without matplotlib.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError(
            'pictures need matplotlib: python -m pip install "splinesdf[plot]"'
        ) from error
    return Figure(figsize=(width, height), layout="constrained")


def save_figure(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure to a ``.png``, ``.svg`` or ``.pdf`` file, whole or not at all.

    Raises
    ------
    InputError
        If the extension is another one, or the file cannot be written.
    """
    suffix = check_format(path)
    from matplotlib import rc_context

    # Without the date and with fixed names inside, the same picture is the same file.
    date = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}[suffix]
    with atomic_file(path) as file, rc_context({"svg.hashsalt": "splinesdf"}):
        figure.savefig(file, format=suffix[1:], dpi=_DPI, metadata=date)


def check_format(path: str | os.PathLike[str]) -> str:
    """The extension, in lower case, or an `InputError` if no figure can be written to it."""
    suffix = as_path(path).suffix.lower()
    if suffix not in FORMATS:
        raise InputError(
            f"expected a picture's name ending in {', '.join(FORMATS)}, got {os.fspath(path)!r}"
        )
    return suffix


def at_most(value: float) -> str:
    """Three digits of a positive number, rounded up, so that a caption never says too little.

    With two, an error below its tolerance could be shown as one above it.
    """
    unit = 10.0 ** (math.floor(math.log10(value)) - 2) if value > 0.0 else 1.0
    # What rounding adds to a number that has only three digits must not make it the next one.
    return f"{math.ceil(value / unit * (1.0 - 1e-12)) * unit:.3g}"


def add_colorbar(filled: QuadContourSet, ax: Axes, *, unit: float | None = None) -> None:
    """A color bar as high as the axes, for what `plot_field` returns: distances in the unit."""
    bar = ax.figure.colorbar(filled, cax=ax.inset_axes((1.03, 0.0, 0.035, 1.0)))
    bar.set_label(f"distance{measured_in(unit)}", fontsize=8, color=INK)
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8, labelcolor=INK, length=0.0)


def few_ticks(count: int = 5) -> Any:
    """A locator of few round numbers along an axis."""
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(count)


def upright(ax: Axes, y_down: bool, unit: float | None = None) -> None:
    """Equal units each way, y pointing down if the source's does, named and quiet axes."""
    ax.set_aspect("equal")
    if y_down:
        ax.yaxis.set_inverted(True)
    ax.set_xlabel(f"x{measured_in(unit)}", fontsize=8, color=INK)
    ax.set_ylabel(f"y{measured_in(unit)}{' (downward)' if y_down else ''}", fontsize=8, color=INK)
    ax.xaxis.set_major_locator(few_ticks())
    ax.yaxis.set_major_locator(few_ticks())
    ax.tick_params(labelsize=8, labelcolor=INK, length=0.0)
    for side in ax.spines.values():
        side.set_visible(False)


def lattice(box: Box, samples: int) -> tuple[Floats, Floats, Floats]:
    """Equidistant x (m,) and y (n,) over a box, and their points (n, m, 2) as matplotlib wants."""
    xmin, ymin, xmax, ymax = box
    step = max(xmax - xmin, ymax - ymin) / samples
    x = np.linspace(xmin, xmax, max(2, round((xmax - xmin) / step) + 1))
    y = np.linspace(ymin, ymax, max(2, round((ymax - ymin) / step) + 1))
    return x, y, np.stack(np.meshgrid(x, y), axis=-1)
