"""Splines: their values in colors, as a surface, and their mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, as_floats, shown
from splinesdf.ground.brief import measured_in
from splinesdf.meshes import Mesh
from splinesdf.plot.curves import curves, flatness
from splinesdf.plot.figures import FAINT, INK, few_ticks, lattice, upright
from splinesdf.plot.shapes import outline
from splinesdf.shapes.shape import Shape
from splinesdf.splines.spline import SplineSDF

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import LineCollection
    from matplotlib.contour import QuadContourSet

_FIELD = "RdBu_r"
# Samples along the longer side of a field; about one for each dot of a panel at 800 dots.
_SAMPLES, _SURFACE_SAMPLES = 400, 120
_LEVELS = 14
# Beyond so many lines a vector file of the mesh is larger and slower than its bitmap.
_MOST_LINES = 20_000


def plot_field(
    spline: SplineSDF, ax: Axes, *, shape: Shape | None = None, levels: ArrayLike | None = None
) -> QuadContourSet:
    """Draw the spline's values as filled contours, its zero line dark.

    Parameters
    ----------
    spline : SplineSDF
    ax : Axes
    shape : Shape, optional
        Its boundary is drawn as a broad light line under the zero line, so that it shows where
        the two part.
    levels : array_like, shape (n,), optional
        Increasing; about fourteen round numbers unless given.

    Returns
    -------
    QuadContourSet
        For a color bar. The colors are symmetric about zero.

    Of a fit for bands, what is outside them is faded: nothing is promised there.
    """
    from matplotlib.ticker import MaxNLocator

    upright(ax, spline.y_down, _unit_of(spline.shape))
    x, y, points = lattice(spline.domain, _SAMPLES)
    value = spline(points)
    top = float(np.abs(value).max())
    chosen = (
        MaxNLocator(_LEVELS).tick_values(float(value.min()), float(value.max()))
        if levels is None
        else _check_levels(levels)
    )
    filled = ax.contourf(x, y, value, levels=chosen, cmap=_FIELD, vmin=-top, vmax=top, zorder=0.5)
    _fade_beyond_bands(spline, ax, x, y, value)
    if shape is not None:
        outline(shape, ax, color="white", linewidth=2.4)
    curves(spline.contours(0.0), ax, color=INK, linewidth=1.0)
    return filled


def plot_surface(spline: SplineSDF, ax: Any) -> None:
    """Draw the spline as a surface over its domain, with its zero line, on 3D axes."""
    x, y, points = lattice(spline.domain, _SURFACE_SAMPLES)
    value = spline(points)
    surface(ax, (x, y), value, unit=_unit_of(spline.shape))
    ax.set_box_aspect((np.ptp(x), np.ptp(y), np.ptp(value)), zoom=1.0)
    for contour in spline.contours(0.0):
        line = contour.points(flatness(spline.domain))
        ax.plot(line[:, 0], line[:, 1], np.zeros(len(line)), color=INK, linewidth=1.2, zorder=2)
    if spline.y_down:
        ax.yaxis.set_inverted(True)


def surface(
    ax: Any,
    lines: tuple[Floats, Floats],
    value: Floats,
    *,
    height: str = "distance",
    unit: float | None = None,
) -> None:
    """Draw values (n, m) above x (m,) and y (n,) on 3D axes, in colors symmetric about zero."""
    top = float(np.abs(value).max())
    ax.plot_surface(
        *np.meshgrid(*lines),
        value,
        cmap=_FIELD,
        vmin=-top,
        vmax=top,
        rcount=_SURFACE_SAMPLES,
        ccount=_SURFACE_SAMPLES,
        linewidth=0.0,
        antialiased=False,
        shade=False,
        zorder=1,
    )
    ax.computed_zorder = False  # else the surface would hide a line that lies in it
    # A distance climbs at 45 degrees: seen from higher than that no part of it hides another.
    ax.view_init(elev=52.0, azim=-60.0)
    ax.set_proj_type("ortho")
    ax.grid(visible=False)
    ax.tick_params(labelsize=8, labelcolor=INK, pad=0)
    ax.set_xlabel(f"x{measured_in(unit)}", fontsize=8, color=INK, labelpad=-4)
    ax.set_ylabel(f"y{measured_in(unit)}", fontsize=8, color=INK, labelpad=-4)
    ax.set_zlabel(f"{height}{measured_in(unit)}", fontsize=8, color=INK, labelpad=3)
    ax.patch.set_visible(False)  # else it would hide the label of axes to the left
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.pane.set_visible(False)
        axis.line.set_color(FAINT)
        axis.set_tick_params(color=FAINT)
        axis.set_major_locator(few_ticks(3))
    ax.zaxis.set_tick_params(pad=3)


def plot_mesh(
    spline_or_mesh: SplineSDF | Mesh,
    ax: Axes,
    *,
    shape: Shape | None = None,
    diagonals: bool = False,
) -> LineCollection:
    """Draw the sides of the cells, each once, and the shape's boundary if it is given.

    With ``diagonals`` also the two of every cell: the triangles on which the spline is quadratic.

    Returns
    -------
    LineCollection
        Two segments for each cell and two that close the domain; then the diagonals.
    """
    from matplotlib.collections import LineCollection

    if isinstance(spline_or_mesh, SplineSDF):
        mesh, y_down = spline_or_mesh.mesh, spline_or_mesh.y_down
        drawn = spline_or_mesh.shape
    else:
        mesh, y_down, drawn = spline_or_mesh, shape is not None and shape.y_down, shape
    upright(ax, y_down, _unit_of(drawn))
    # The left and the lower side of every cell; only the domain's other two are nobody's.
    x0, y0, x1, y1 = mesh.boxes.T
    left, low, right, high = mesh.domain
    segments = np.concatenate(
        [
            np.stack([x0, y0, x0, y1], axis=1),
            np.stack([x0, y0, x1, y0], axis=1),
            [(right, low, right, high), (left, high, right, high)],
            *([np.stack([x0, y0, x1, y1], 1), np.stack([x0, y1, x1, y0], 1)] if diagonals else []),
        ]
    ).reshape(-1, 2, 2)
    lines = LineCollection(
        list(segments),
        colors=FAINT,
        # Thinner where there are many, or they run together.
        linewidths=(0.6 if diagonals else 1.0) * min(0.6, 15.0 / np.sqrt(len(mesh.boxes))),
        capstyle="projecting",
        zorder=1.0,
        rasterized=len(segments) > _MOST_LINES,
    )
    ax.add_collection(lines)
    ax.autoscale_view()
    if shape is not None:
        outline(shape, ax, color=INK, linewidth=1.2)
    return lines


def _fade_beyond_bands(spline: SplineSDF, ax: Axes, x: Floats, y: Floats, value: Floats) -> None:
    """Veil where the distance is in no band of the fit."""
    bands = () if spline.made is None else spline.made.bands
    if not bands:
        return
    beyond = np.min([np.maximum(low - value, value - high) for low, high in bands], axis=0)
    if beyond.max() > 0.0:
        ax.contourf(x, y, beyond, levels=[0.0, beyond.max()], colors="white", alpha=0.6, zorder=0.6)


def _unit_of(shape: Shape | None) -> float | None:
    return None if shape is None else shape.unit


def _check_levels(levels: ArrayLike) -> Floats:
    chosen = as_floats(levels, "levels")
    increasing = chosen.ndim == 1 and len(chosen) > 1 and bool(np.all(np.diff(chosen) > 0.0))
    if not (increasing and np.isfinite(chosen).all()):
        raise InputError(f"expected two or more increasing levels, got {shown(levels)}")
    return chosen
