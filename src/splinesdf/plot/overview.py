"""A fit in one picture."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.fits.fit import FitResult
from splinesdf.plot.curves import has_legend, offset_lines
from splinesdf.plot.fields import plot_field, plot_mesh
from splinesdf.plot.figures import INK, add_colorbar, at_most, new_figure
from splinesdf.plot.shapes import plot_shape
from splinesdf.shapes.shape import Shape

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def overview(result: FitResult, shape: Shape, contours: Iterable[Contour]) -> Figure:
    """The fit in one picture: shape, adaptive mesh and offsets on the left, the field beside it."""
    xmin, ymin, xmax, ymax = result.spline.domain
    # Beside labels and color bar a panel is 3.1 inches wide; above and below it is text.
    panel = float(np.clip(3.1 * (ymax - ymin) / (xmax - xmin), 1.2, 8.0))
    lines = list(contours)
    figure = new_figure(8.0, panel + (1.45 if has_legend(lines) else 1.0))
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    plot_shape(shape, left)
    plot_mesh(result.spline, left)
    offset_lines(lines, left)
    filled = plot_field(result.spline, right)
    parts = "shape, offsets and mesh" if lines else "shape and mesh"
    where = f" for {_ranges(result)}" if result.bands else ""
    for ax, title in (
        (left, f"{parts}: {result.cells:,} cells"),
        (right, f"signed distance, {error_text(result)}{where}"),
    ):
        ax.set_title(title, fontsize=9, color=INK)
        ax.set_xlim(xmin, xmax)
        ax.set_ylim(*((ymax, ymin) if shape.y_down else (ymin, ymax)))
    right.tick_params(labelleft=False)
    right.set_ylabel("")
    add_colorbar(filled, right, unit=shape.unit)
    return figure


def error_text(result: FitResult) -> str:
    """What is known of a fit's error, for a title: its bound, or the largest that was seen."""
    if result.bound is None:
        return f"error {at_most(result.error)}, not proved"
    return f"error ≤ {at_most(result.bound)}"


def _ranges(result: FitResult) -> str:
    """The bands: outside them nothing is promised."""
    texts = [f"{low:g} to {high:g}" if low < high else f"{low:g}" for low, high in result.bands]
    return ", ".join(texts).replace("-", "−")
