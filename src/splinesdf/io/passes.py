"""What a program does beside the last pass along each contour, measured against the shape.

Earlier passes and ramps keep to the contour's distance, as the last pass does, and each pass goes
around as much as it; ways in and out stay where the tool may be.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from splinesdf.distance.exact import signed_distance
from splinesdf.ground.arrays import Floats
from splinesdf.io.curves import curve_of
from splinesdf.io.enclosed import flattened
from splinesdf.io.programs import Way, last_passes, read_program
from splinesdf.io.source_frame import Frame
from splinesdf.io.writers.milling import Milling
from splinesdf.shapes.shape import Shape

# Polylines of one curve from two starts differ in length by less than this share, the sag of chords
# within the tolerance.
_LENGTHS = 0.05
# Points along each piece of a way.
_SAMPLES = 12


class _Measures(NamedTuple):
    """Of a pass: the area that it goes around, with its sign, its length, and from end to start."""

    area: float
    length: float
    gap: float

    def is_as(self, other: _Measures, tolerance: float) -> bool:
        """Whether both are the same way around, each within the tolerance of one curve."""
        # Where that is convex the area between is at most its length times the width between.
        allowed = 2.0 * tolerance * other.length + 4.0 * math.pi * tolerance**2
        return (
            abs(self.area - other.area) <= allowed
            and abs(self.length - other.length) <= _LENGTHS * other.length + 4.0 * tolerance
            and abs(self.gap - other.gap) <= 2.0 * tolerance
        )


def wrong_ways(
    file: Path,
    milling: Milling | None,
    shape: Shape,
    frame: Frame,
    tolerance: float,
    clearing: Collection[float],
) -> Iterator[str]:
    """Sentences on what is wrong with a program's words, depths, passes and ways beside these.

    ``clearing`` is `measure_file`'s.
    """
    ways, faults = read_program(file, milling)
    yield from faults
    last = {way.contour: way for way in last_passes(ways)}
    measured = {number: _measures(way, frame, tolerance) for number, way in last.items()}
    nearest = max((way.distance for way in ways), default=0.0)
    for way in ways:
        if way.contour not in last:
            yield f"contour {way.contour + 1} has ways into it, and no pass"
            continue
        if last[way.contour] is way:
            continue
        points = frame.to_source(_points(way))
        exact = signed_distance(shape, points)
        off = exact - way.distance
        if way.name == "lead":
            # Where the tool may be: farther outside, or farther inside if the shape is cut away.
            beyond = float((-off if way.distance >= 0.0 else off).max())
            if way.distance in clearing:
                beyond = float(exact.max()) - nearest
        else:
            beyond = float((off if way.distance in clearing else np.abs(off)).max())
        if not beyond <= tolerance:
            yield (
                f"a {way.name} of contour {way.contour + 1}, at Z{way.low:g}, is {beyond:.4g} from "
                f"where it may be, more than {tolerance:.4g}"
            )
        if way.name == "pass" and not _measures(way, frame, tolerance).is_as(
            measured[way.contour], tolerance
        ):
            yield (
                f"the pass at Z{way.low:g} of contour {way.contour + 1} does not go around what "
                "the last one goes around"
            )


def _points(way: Way) -> Floats:
    curve = curve_of(way)
    return curve.at(np.linspace(0.0, curve.count, _SAMPLES * curve.count + 1))


def _measures(way: Way, frame: Frame, tolerance: float) -> _Measures:
    curve = curve_of(way)
    line = frame.to_source(flattened(curve.at, curve.count, frame.by * tolerance))
    gap = math.dist(line[0], line[-1])
    x, y = (line - line[0]).T
    area = 0.5 * float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    return _Measures(area, float(np.hypot(np.diff(x), np.diff(y)).sum()), gap)
