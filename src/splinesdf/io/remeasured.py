"""A file of contours read back, by other code than wrote it, and measured against the distance.

file ─→ `Curve`s (`curves`) ─┬─→ the worst point: dense samples, then ever closer around the worst
                             ├─→ what they enclose, all those of a distance together (`enclosed`)
                             └─→ of G-code: passes, ways in and out, words (`programs`, `passes`)
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.distance.exact import signed_distance
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.paths import as_path
from splinesdf.io.curves import Curve, curves_in
from splinesdf.io.enclosed import Sides, check_sides, flattened
from splinesdf.io.passes import wrong_ways
from splinesdf.io.source_frame import Frame, Told, frame_of
from splinesdf.io.writers.milling import Milling
from splinesdf.io.writers.options import GCODE
from splinesdf.shapes.shape import Shape

# Samples on each segment, and around each suspect in each of the rounds that zoom in by four: the
# deviation of a segment has a few bumps. The last round's spacing is then 1e-5 of a segment, and
# what a bump has above its highest sample is no more than 1e-10 of it.
_SAMPLES = 12
_ROUNDS = 6
# Suspects: the highest samples, as the highest bump need not have the highest sample.
_SUSPECTS = 64
# A curve no larger than so many units in the last place of its coordinates is a point.
_ULPS = 64.0


@dataclass(frozen=True)
class Worst:
    """Where a file is farthest from the distances it stands for.

    Attributes
    ----------
    deviation : float
        The largest | exact distance - distance that the file says |.
    point : (float, float)
        Where, in the file's own coordinates.
    distance : float
        Of which curve.
    curves : dict of float to int
        How many curves there are at each distance.
    gap : float
        The largest way between the ends of a curve, all of which should be closed.
    points : int
        How many curves have no extent, but for rounding: what is left where an offset was lost.
    sides : tuple of Sides
        For each distance, whether what is nearer is what the curves enclose; points in the file's
        own coordinates.
    faults : tuple of str
        Of G-code: what is wrong with words, passes, and ways into and out of contours.
    """

    deviation: float
    point: tuple[float, float]
    distance: float
    curves: dict[float, int]
    gap: float
    points: int
    sides: tuple[Sides, ...]
    faults: tuple[str, ...] = ()

    def keeps(self, tolerance: float) -> bool:
        """Whether all of it is within a tolerance, closed, and encloses what it should."""
        near = self.deviation <= tolerance and self.gap <= tolerance
        right = not self.faults and not any(sides.wrong for sides in self.sides)
        return near and not self.points and right


def measure_file(
    path: str | os.PathLike[str],
    shape: Shape,
    distances: Sequence[float],
    tolerance: float,
    told: Told | None = None,
    written: Sequence[Contour] = (),
    milling: Milling | None = None,
    clearing: Collection[float] = (),
) -> Worst:
    """Read a file of contours back and measure it against the exact distance to the shape.

    Parameters
    ----------
    path : str or path
    shape : Shape
        What the contours are offsets of.
    distances : sequence of float
        What the contours stand for, those at which nothing should be left included: WKT has no
        place for it, so there each curve counts for the nearest of these.
    tolerance : float
        How far points must be from the level for their side of the curves to count.
    told : Told, optional
        How `write` was told to place them. The file is judged in the shape's coordinates.
    written : sequence of Contour
        All that the file holds: needed where the origin is a corner of their box, or its center.
    milling : Milling, optional
        What `write` was told of a program: depths and passes are judged by it.
    clearing : collection of float
        Distances of curves that are nowhere nearer to the boundary, and farther elsewhere, as those
        between the rings of a pocket.

    Raises
    ------
    InputError
        If the file cannot be read, holds no curve, or declares another unit than asked for.
    """
    curves = curves_in(path)
    if not curves:
        raise InputError(f"{os.fspath(path)}: expected at least one curve, found none")
    frame = frame_of(as_path(path), shape, told or Told(), written, tolerance)
    by = frame.by
    faults: tuple[str, ...] = ()
    if as_path(path).suffix.lower() in GCODE:
        faults = tuple(wrong_ways(as_path(path), milling, shape, frame, tolerance, clearing))
    worst, where, gap = (-1.0, math.nan), (math.nan, math.nan), 0.0
    no_extent = 0
    lines: dict[float, list[Floats]] = {}
    for curve in curves:
        level = curve.distance
        if math.isnan(level):
            first = float(signed_distance(shape, frame.to_source(curve.at(np.zeros(1))))[0])
            level = float(distances[int(np.argmin(np.abs(np.asarray(distances) - first)))])
        line = flattened(curve.at, curve.count, by * tolerance)
        lines.setdefault(level, []).append(frame.to_source(line))
        gap = max(gap, math.dist(line[0], line[-1]) / by)
        no_extent += float(np.ptp(line, axis=0).max()) <= _ULPS * np.spacing(np.abs(line).max())
        sides = np.positive if level in clearing else np.abs
        found, point = _worst_of(curve, level, shape, frame, sides)
        if not found <= worst[0]:
            worst, where = (found, level), point
    checked = [
        check_sides(
            shape,
            level,
            lines.get(level, []),
            tolerance,
            _turn(as_path(path), level, frame.mirrored),
        )
        for level in dict.fromkeys([*map(float, distances), *lines])
        if level not in clearing
    ]
    return Worst(
        *(worst[0], where, worst[1]),
        {level: len(some) for level, some in lines.items()},
        gap,
        int(no_extent),
        tuple(replace(sides, point=frame.to_file(sides.point)) for sides in checked),
        faults,
    )


def _turn(file: Path, distance: float, flip: bool) -> int:
    """Which way around, in the shape's coordinates, curves are to run; 0 if it does not matter."""
    suffix = file.suffix.lower()
    if suffix == ".geojson":
        # RFC 7946: outer rings from x to y, holes the other way.
        return -1 if flip else 1
    if suffix not in GCODE:
        return 0
    # What stays is the shape if the way is around it; climb milling has it on the right.
    climb = re.search(r"^[(;] ?within .* climb milling", file.read_text("utf-8"), re.MULTILINE)
    left = (distance < 0.0) == (climb is not None)
    return 1 if left != flip else -1


def _worst_of(
    curve: Curve, level: float, shape: Shape, frame: Frame, sides: Callable[[Floats], Floats]
) -> tuple[float, tuple[float, float]]:
    """The largest deviation along a curve, and its point; above the level only, or below, too."""

    def off(at: Floats) -> tuple[Floats, Floats]:
        points = curve.at(at.ravel())
        found = sides(signed_distance(shape, frame.to_source(points)) - level)
        return found.reshape(at.shape), points

    at = np.linspace(0.0, float(curve.count), _SAMPLES * curve.count + 1)
    apart, _ = off(at)
    best = at[np.argsort(apart)[-_SUSPECTS:]]
    width = 1.0 / _SAMPLES
    for _ in range(_ROUNDS):
        near = best[:, None] + np.linspace(-width, width, 9)
        near = np.clip(near, 0.0, float(curve.count))
        apart, _ = off(near)
        best = np.take_along_axis(near, np.argmax(apart, axis=1)[:, None], axis=1)[:, 0]
        width *= 0.25
    apart, points = off(best)
    at_worst = int(np.argmax(apart))
    x, y = points[at_worst].tolist()
    return float(apart[at_worst]), (x, y)
