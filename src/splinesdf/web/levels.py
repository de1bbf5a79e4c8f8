"""Exact offsets for the page: their arcs, how far off they are, and their files."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.errors import MissingExtraError
from splinesdf.ground.arrays import Floats
from splinesdf.io.output import write
from splinesdf.offsets.offset import deviation, least_tolerance, offset
from splinesdf.shapes.shape import Shape
from splinesdf.splines.spline import SplineSDF

# The tolerance of exact offsets, as shares of the shape's size and of the distance. Smaller: more
# arcs, and those of a page without a server take room; larger: seen to be off from fewer zooms on.
_OF_SIZE, _OF_DISTANCE = 1e-6, 1e-3
# About so many distances on each side lie ready in a page. More: the file grows by some kB each;
# fewer: the nearest one is farther from where the slider is.
_EACH_SIDE = 4
KINDS = ("svg", "dxf")


@dataclass(frozen=True)
class Level:
    """The exact offset at one distance.

    Attributes
    ----------
    distance, tolerance : float
    deviation : float
        How far the exact distance is from it at most, measured at nine points of each arc.
    contours : tuple of Contour
    """

    distance: float
    tolerance: float
    deviation: float
    contours: tuple[Contour, ...]

    @property
    def rows(self) -> Floats:
        """P0, P1, P2 and the weight of P1 for each arc, chain after chain: (n, 7)."""
        rows = [np.column_stack([c.arcs.reshape(-1, 6), c.weights]) for c in self.contours]
        return np.concatenate([np.empty((0, 7)), *rows])

    @property
    def figures(self) -> dict[str, Any]:
        """What the page says about it."""
        return {
            "distance": self.distance,
            "tolerance": self.tolerance,
            "deviation": self.deviation,
            "count": sum(len(contour.arcs) for contour in self.contours),
        }


def level_at(shape: Shape, distance: float) -> Level:
    """The exact offset at a distance, as closely as the page shows it.

    Raises
    ------
    InputError, ToleranceNotReached
        As `splinesdf.offset`.
    """
    wanted = _OF_SIZE * shape.size
    if distance:
        wanted = min(wanted, _OF_DISTANCE * abs(distance))
    tolerance = max(wanted, least_tolerance(shape, abs(distance)))
    contours = offset(shape, distance, tolerance=tolerance)
    return Level(distance, tolerance, deviation(shape, contours), tuple(contours))


def ready_distances(spline: SplineSDF) -> list[float]:
    """Round distances from the deepest inside outward, those of the domain."""
    values = spline.ordinates[:, :4]
    depth, room = -float(values.min()), float(values.max())
    if depth <= 0.0:
        return [0.0]
    step = _round_below(depth / _EACH_SIDE)
    inside = min(math.floor(depth / step), 2 * _EACH_SIDE)
    outside = min(math.floor(max(room, 0.0) / step), _EACH_SIDE)
    return [float(f"{step * number:.6g}") for number in range(-inside, outside + 1)]


def _round_below(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = float(f"1e{math.floor(math.log10(value))}")
    return max((one * power for one in (1.0, 2.0, 5.0) if one * power <= value), default=power)


def level_file(level: Level, kind: str) -> str:
    """What `splinesdf.write` puts into a file of this kind, empty if there is nothing to write.

    Raises
    ------
    MissingExtraError
        For ``dxf`` without ezdxf.
    """
    if not level.contours:
        return ""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"offset.{kind}"
        write(path, level.contours)
        return path.read_text(encoding="utf-8")


def level_files(levels: Sequence[Level]) -> dict[str, list[str]]:
    """The files of all levels by kind; without a kind whose library is not installed."""
    files = {}
    for kind in KINDS:
        try:
            files[kind] = [level_file(level, kind) for level in levels]
        except MissingExtraError:
            continue
    return files
