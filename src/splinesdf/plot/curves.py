"""Contours as lines, and offsets with their distances."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.meshes import Box
from splinesdf.plot.figures import INK, INSIDE, OUTSIDE
from splinesdf.plot.shapes import plot_shape
from splinesdf.shapes.shape import Shape

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Polylines that stand for arcs leave them by at most this share of the drawing: a tenth of a dot.
_FLATNESS = 1e-4
# Beyond so many distances a legend names only the two sides.
_MOST_LABELS = 4
# In which direction the names of the first distance and of the next ones are, radians, so that
# those of close ones are apart.
_FIRST_NAME, _NEXT_NAME = 0.3, 0.6
# Dashes tell the inside where there are no colors, as in print.
_STYLES: dict[float, tuple[str, Any]] = {
    -1.0: (INSIDE, (0.0, (4.0, 1.5))),
    0.0: (INK, "solid"),
    1.0: (OUTSIDE, "solid"),
}


def plot_contours(contours: Sequence[Contour], ax: Axes, *, color: str) -> None:
    """Draw contours in one color, and nothing else."""
    curves(contours, ax, color=color, linewidth=1.4)


def plot_offsets(shape: Shape, contours: Iterable[Contour], ax: Axes) -> None:
    """Draw the shape and contours at distances from it, dashed inside.

    A few distances stand at their contours; of many a legend says from where to where they are.
    """
    plot_shape(shape, ax)
    offset_lines(list(contours), ax)


def offset_lines(contours: Sequence[Contour], ax: Axes) -> None:
    """The contours, their color and dashes the side of the shape they are on, and their names."""
    distances = sorted({contour.distance for contour in contours})
    many = has_legend(contours)
    for side, (color, style) in _STYLES.items():
        here = [c for c in contours if np.sign(c.distance) == side]
        curves(here, ax, color=color, linewidth=1.0 if many else 1.4, style=style)
    if many:
        _legend(distances, ax)
        return
    for number, distance in enumerate(distances):
        here = [contour for contour in contours if contour.distance == distance]
        _name(max(here, key=lambda contour: contour.length), number, ax)


def has_legend(contours: Sequence[Contour]) -> bool:
    """Whether there are too many distances to name each where it is."""
    return len({contour.distance for contour in contours}) > _MOST_LABELS


def _name(contour: Contour, number: int, ax: Axes) -> None:
    """The contour's distance beside it, where it reaches farthest in a direction of its own."""
    line = contour.points()
    angle = _FIRST_NAME + number * _NEXT_NAME
    x, y = line[np.argmax(line @ [math.cos(angle), math.sin(angle)])]
    ax.annotate(
        _signed(contour.distance),
        (x, y),
        fontsize=7,
        color=_STYLES[float(np.sign(contour.distance))][0],
        ha="center",
        va="center",
        zorder=4.0,
        bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none"},
    )


def _legend(distances: Sequence[float], ax: Axes) -> None:
    """From where to where the distances are on each side."""
    from matplotlib.lines import Line2D

    handles = []
    for side, (color, style) in _STYLES.items():
        here = [d for d in distances if np.sign(d) == side]
        if here:
            text = " to ".join(dict.fromkeys((_signed(here[0]), _signed(here[-1]))))
            handles.append(Line2D([], [], color=color, linestyle=style, linewidth=1.4, label=text))
    ax.legend(
        handles=handles,
        fontsize=8,
        labelcolor=INK,
        # Below the numbers and the name of the axis, where it hides nothing.
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0),
        borderaxespad=3.8,
        ncols=len(handles),
        frameon=False,
        handlelength=2.0,
    )


def _signed(distance: float) -> str:
    return f"{distance:+.6g}".replace("-", "−") if distance else "0"


def curves(
    contours: Sequence[Contour],
    ax: Axes,
    *,
    color: str,
    linewidth: float,
    style: str | tuple[float, tuple[float, ...]] = "solid",
) -> None:
    """Draw contours as lines that the eye cannot tell from them."""
    from matplotlib.collections import LineCollection

    if not contours:
        return
    every = np.concatenate([contour.arcs.reshape(-1, 2) for contour in contours])
    allowed = flatness((*every.min(axis=0), *every.max(axis=0)))
    lines = [contour.points(allowed) for contour in contours]
    ax.add_collection(
        LineCollection(
            lines,
            colors=color,
            linewidths=linewidth,
            linestyles=[style],
            joinstyle="round",
            zorder=3.0,
        )
    )
    ax.autoscale_view()


def flatness(box: Box) -> float:
    """How far a polyline may be from the arcs of a drawing in this box."""
    return _FLATNESS * max(box[2] - box[0], box[3] - box[1])
