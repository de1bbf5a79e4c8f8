"""Pictures: shapes, meshes, fields and offsets, drawn on matplotlib axes that the caller owns.

No function here touches matplotlib's global state (pyplot): a figure is made by `new_figure`, drawn
on, and written by `save_figure`. Blue is inside, vermilion outside: told apart by color-blind
readers too, and in print.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.contours.contour import Contour
from splinesdf.distance.exact import signed_distance_grid
from splinesdf.errors import InputError, MissingExtraError
from splinesdf.fits.fit import FitResult
from splinesdf.ground.arrays import Floats, as_floats, shown
from splinesdf.ground.atomic import atomic_file
from splinesdf.ground.paths import as_path
from splinesdf.meshes import Box, Mesh
from splinesdf.shapes.shape import Shape
from splinesdf.splines.spline import SplineSDF

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import LineCollection
    from matplotlib.contour import QuadContourSet
    from matplotlib.figure import Figure

FORMATS = (".pdf", ".png", ".svg")
INK = "#22303c"
INSIDE, OUTSIDE = "#0072b2", "#d55e00"
_FILL, FAINT = "#e3e8ed", "#8c98a4"
_FIELD = "RdBu_r"
# Dots an inch of PNG: a figure of eight inches is 1600 dots wide and crisp when shown at 800.
_DPI = 200
# Samples along the longer side of what is drawn; about one for each dot of a panel at 800 dots.
_SAMPLES = 400
_SURFACE_SAMPLES = 120
# Polylines that stand for arcs leave them by at most this share of the drawing: a tenth of a dot.
_FLATNESS = 1e-4
_LEVELS = 14
# Beyond so many lines a vector file of the mesh is larger and slower than its bitmap.
_MOST_LINES = 20_000
# Beyond so many distances the legend names only the two sides.
_MOST_LABELS = 4


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


def plot_shape(shape: Shape, ax: Axes) -> None:
    """Fill what the shape fills, by its fill rule, and draw its boundary."""
    plot_fill(shape, ax)
    _outline(shape, ax, color=INK, linewidth=1.0)
    ax.autoscale_view(tight=False)


def plot_fill(shape: Shape, ax: Axes) -> None:
    """Fill what the shape fills, by its fill rule.

    That is where the exact distance is negative; matplotlib itself knows no even-odd rule.
    """
    _upright(ax, shape.y_down)
    x, y, _ = _lattice(shape.box, _SAMPLES)
    value = signed_distance_grid(shape, len(x), len(y), domain=shape.box).distance
    lowest = min(float(value.min()), 0.0) - shape.size
    filled = ax.contourf(x, y, value, levels=[lowest, 0.0], colors=[_FILL], zorder=0.5)
    # Filled contours claim their box without a margin, which would cut the boundary's line.
    filled.sticky_edges.x.clear()
    filled.sticky_edges.y.clear()
    ax.autoscale_view(tight=False)


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
    """
    from matplotlib.ticker import MaxNLocator

    _upright(ax, spline.y_down)
    x, y, points = _lattice(spline.domain, _SAMPLES)
    value = spline(points)
    top = float(np.abs(value).max())
    chosen = (
        MaxNLocator(_LEVELS).tick_values(float(value.min()), float(value.max()))
        if levels is None
        else _check_levels(levels)
    )
    filled = ax.contourf(x, y, value, levels=chosen, cmap=_FIELD, vmin=-top, vmax=top, zorder=0.5)
    if shape is not None:
        _outline(shape, ax, color="white", linewidth=2.4)
    _curves(spline.contours(0.0), ax, color=INK, linewidth=1.0)
    return filled


def plot_surface(spline: SplineSDF, ax: Any) -> None:
    """Draw the spline as a surface over its domain, with its zero line, on 3D axes."""
    x, y, points = _lattice(spline.domain, _SURFACE_SAMPLES)
    value = spline(points)
    top = float(np.abs(value).max())
    ax.plot_surface(
        *np.meshgrid(x, y),
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
    ax.computed_zorder = False  # else the surface would hide the line that lies in it
    for contour in spline.contours(0.0):
        line = contour.points(_flatness(spline.domain))
        ax.plot(line[:, 0], line[:, 1], np.zeros(len(line)), color=INK, linewidth=1.2, zorder=2)
    ax.set_box_aspect((np.ptp(x), np.ptp(y), np.ptp(value)), zoom=1.0)
    # A distance climbs at 45 degrees: seen from higher than that no part of it hides another.
    ax.view_init(elev=52.0, azim=-60.0)
    ax.set_proj_type("ortho")
    ax.grid(visible=False)
    ax.tick_params(labelsize=8, labelcolor=INK, pad=0)
    ax.set_xlabel("x", fontsize=8, color=INK, labelpad=-4)
    ax.set_ylabel("y", fontsize=8, color=INK, labelpad=-4)
    ax.set_zlabel("distance", fontsize=8, color=INK, labelpad=3)
    ax.patch.set_visible(False)  # else it would hide the label of axes to the left
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.pane.set_visible(False)
        axis.line.set_color(FAINT)
        axis.set_tick_params(color=FAINT)
        axis.set_major_locator(_few_ticks(3))
    ax.zaxis.set_tick_params(pad=3)
    if spline.y_down:
        ax.yaxis.set_inverted(True)


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
    else:
        mesh, y_down = spline_or_mesh, shape is not None and shape.y_down
    _upright(ax, y_down)
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
        _outline(shape, ax, color=INK, linewidth=1.2)
    return lines


def plot_offsets(shape: Shape, contours: Iterable[Contour], ax: Axes) -> None:
    """Draw the shape and contours at distances from it, named in a legend."""
    plot_shape(shape, ax)
    _offset_lines(list(contours), ax)


def overview(result: FitResult, shape: Shape, contours: Iterable[Contour]) -> Figure:
    """The fit in one picture: shape, adaptive mesh and offsets on the left, the field beside it."""
    xmin, ymin, xmax, ymax = result.spline.domain
    # Beside labels and color bar a panel is 3.3 inches wide; above and below it is text.
    panel = float(np.clip(3.3 * (ymax - ymin) / (xmax - xmin), 1.2, 8.0))
    figure = new_figure(8.0, panel + 0.85)
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    plot_shape(shape, left)
    plot_mesh(result.spline, left)
    _offset_lines(list(contours), left)
    filled = plot_field(result.spline, right)
    for ax, title in (
        (left, f"shape, offsets and mesh: {result.cells:,} cells"),
        (right, f"signed distance, error ≤ {at_most(result.error)}"),
    ):
        ax.set_title(title, fontsize=9, color=INK)
        ax.set_xlim(xmin, xmax)
        ax.set_ylim(*((ymax, ymin) if shape.y_down else (ymin, ymax)))
    right.tick_params(labelleft=False)
    add_colorbar(filled, right)
    return figure


def at_most(value: float) -> str:
    """Two digits of a positive number, rounded up, so that a caption never says too little."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1) if value > 0.0 else 1.0
    # What rounding adds to a number that has only two digits must not make it the next one.
    return f"{math.ceil(value / unit * (1.0 - 1e-12)) * unit:.2g}"


def add_colorbar(filled: QuadContourSet, ax: Axes) -> None:
    """A color bar as high as the axes, for what `plot_field` returns."""
    bar = ax.figure.colorbar(filled, cax=ax.inset_axes((1.03, 0.0, 0.035, 1.0)))
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8, labelcolor=INK, length=0.0)


def plot_contours(contours: Sequence[Contour], ax: Axes, *, color: str) -> None:
    """Draw contours in one color, and nothing else."""
    _curves(contours, ax, color=color, linewidth=1.4)


def _offset_lines(contours: Sequence[Contour], ax: Axes) -> None:
    """The contours, their color the side of the shape they are on, and a legend."""
    for side, color in ((-1.0, INSIDE), (0.0, INK), (1.0, OUTSIDE)):
        here = [c for c in contours if np.sign(c.distance) == side]
        _curves(here, ax, color=color, linewidth=1.4)
    labels = _labels(sorted({contour.distance for contour in contours}))
    if labels:
        from matplotlib.lines import Line2D

        ax.legend(
            handles=[Line2D([], [], color=color, linewidth=1.4) for _, color in labels],
            labels=[text for text, _ in labels],
            fontsize=8,
            labelcolor=INK,
            # Below the numbers of the axis, where it hides nothing.
            loc="upper center",
            bbox_to_anchor=(0.5, 0.0),
            borderaxespad=2.0,
            ncols=len(labels),
            frameon=False,
            handlelength=1.4,
        )


def _labels(distances: Sequence[float]) -> list[tuple[str, str]]:
    """Text and color for each distance, or for each side if there are many."""
    colors = {-1.0: INSIDE, 0.0: INK, 1.0: OUTSIDE}
    if len(distances) <= _MOST_LABELS:
        return [(_signed(d), colors[float(np.sign(d))]) for d in distances]
    result = []
    for side, color in colors.items():
        here = [d for d in distances if np.sign(d) == side]
        if here:
            ends = dict.fromkeys((_signed(here[0]), _signed(here[-1])))
            result.append((" to ".join(ends), color))
    return result


def _signed(distance: float) -> str:
    return f"{distance:+.6g}".replace("-", "−") if distance else "0"


def _curves(contours: Sequence[Contour], ax: Axes, *, color: str, linewidth: float) -> None:
    from matplotlib.collections import LineCollection

    if not contours:
        return
    every = np.concatenate([contour.arcs.reshape(-1, 2) for contour in contours])
    flatness = _flatness((*every.min(axis=0), *every.max(axis=0)))
    lines = [contour.points(flatness) for contour in contours]
    ax.add_collection(
        LineCollection(lines, colors=color, linewidths=linewidth, joinstyle="round", zorder=3.0)
    )
    ax.autoscale_view()


def _outline(shape: Shape, ax: Axes, *, color: str, linewidth: float) -> None:
    from matplotlib.collections import LineCollection

    style: dict[str, Any] = {"colors": color, "linewidths": linewidth, "joinstyle": "round"}
    ax.add_collection(LineCollection(shape.sample(24), zorder=2.0, **style))
    ax.autoscale_view()


def _lattice(box: Box, samples: int) -> tuple[Floats, Floats, Floats]:
    """Equidistant x (m,) and y (n,) over a box, and their points (n, m, 2) as matplotlib wants."""
    xmin, ymin, xmax, ymax = box
    step = max(xmax - xmin, ymax - ymin) / samples
    x = np.linspace(xmin, xmax, max(2, round((xmax - xmin) / step) + 1))
    y = np.linspace(ymin, ymax, max(2, round((ymax - ymin) / step) + 1))
    return x, y, np.stack(np.meshgrid(x, y), axis=-1)


def _flatness(box: Box) -> float:
    return _FLATNESS * max(box[2] - box[0], box[3] - box[1])


def _few_ticks(count: int = 5) -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(count)


def _upright(ax: Axes, y_down: bool) -> None:
    """Equal units each way, y pointing down if the source's does, and quiet axes."""
    ax.set_aspect("equal")
    if y_down:
        ax.yaxis.set_inverted(True)
    ax.xaxis.set_major_locator(_few_ticks())
    ax.yaxis.set_major_locator(_few_ticks())
    ax.tick_params(labelsize=8, labelcolor=INK, length=0.0)
    for side in ax.spines.values():
        side.set_visible(False)


def _check_levels(levels: ArrayLike) -> Floats:
    chosen = as_floats(levels, "levels")
    increasing = chosen.ndim == 1 and len(chosen) > 1 and bool(np.all(np.diff(chosen) > 0.0))
    if not (increasing and np.isfinite(chosen).all()):
        raise InputError(f"expected two or more increasing levels, got {shown(levels)}")
    return chosen
