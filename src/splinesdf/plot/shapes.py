"""Shapes: what they fill and their boundary."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from splinesdf.distance.exact import signed_distance_grid
from splinesdf.plot.figures import INK, lattice, upright
from splinesdf.shapes.shape import Shape

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_FILL = "#e3e8ed"
# Samples along the longer side of what is filled; about one for each dot of a panel at 800 dots.
_SAMPLES = 400


def plot_shape(shape: Shape, ax: Axes) -> None:
    """Fill what the shape fills, by its fill rule, and draw its boundary."""
    plot_fill(shape, ax)
    outline(shape, ax, color=INK, linewidth=1.0)
    ax.autoscale_view(tight=False)


def plot_fill(shape: Shape, ax: Axes) -> None:
    """Fill what the shape fills, by its fill rule.

    That is where the exact distance is negative; matplotlib itself knows no even-odd rule.
    """
    upright(ax, shape.y_down, shape.unit)
    x, y, _ = lattice(shape.box, _SAMPLES)
    value = signed_distance_grid(shape, len(x), len(y), domain=shape.box).distance
    lowest = min(float(value.min()), 0.0) - shape.size
    filled = ax.contourf(x, y, value, levels=[lowest, 0.0], colors=[_FILL], zorder=0.5)
    # Filled contours claim their box without a margin, which would cut the boundary's line.
    filled.sticky_edges.x.clear()
    filled.sticky_edges.y.clear()
    ax.autoscale_view(tight=False)


def outline(shape: Shape, ax: Axes, *, color: str, linewidth: float) -> None:
    """Draw all that was drawn of the shape, and nothing else."""
    from matplotlib.collections import LineCollection

    style: dict[str, Any] = {"colors": color, "linewidths": linewidth, "joinstyle": "round"}
    ax.add_collection(LineCollection(shape.sample(24), zorder=2.0, **style))
    ax.autoscale_view()
