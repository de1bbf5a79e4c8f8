"""What a program does beside the last pass along each contour, measured against the shape.

Earlier passes and ramps keep to the contour's distance, as the last pass does, and each pass goes
around as much as it; ways in and out stay where the tool may be.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import numpy as np

from splinesdf.distance.exact import signed_distance
from splinesdf.ground.arrays import Floats
from splinesdf.io.curves import curve_of
from splinesdf.io.enclosed import flattened
from splinesdf.io.programs import Move, Way, last_passes, read_program
from splinesdf.io.source_frame import Frame
from splinesdf.io.writers.milling import Milling
from splinesdf.shapes.shape import Shape

# Polylines of one curve from two starts differ in length by less than this share, the sag of chords
# within the tolerance.
_LENGTHS = 0.05
# Heights are the same within this share of the depth; tabs take this share of a contour at most.
_HEIGHT, _TABBED = 1e-5, 0.5
# A ramp goes so often around a contour at most, and is steeper around a shorter one.
_TURNS = 10
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
    if milling is not None and milling.ramp is not None:
        yield from _wrong_ramps([way for way in ways if way.contour in last], last, milling)
    nearest = max((way.distance for way in ways), default=0.0)
    for way in ways:
        if way.contour not in last:
            yield f"contour {way.contour + 1} has ways into it, and no pass"
            continue
        if way.name == "pass" and milling is not None:
            yield from _wrong_tabs(way, milling, frame)
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


def _wrong_ramps(ways: Sequence[Way], last: Mapping[int, Way], milling: Milling) -> Iterator[str]:
    """Passes that are not entered by a ramp from the one above, or by one steeper than allowed."""
    slope = math.tan(math.radians(milling.ramp or 0.0))
    above: dict[int, float] = {}
    ramp: Way | None = None
    for way in ways:
        if way.name == "ramp":
            ramp = way
        if way.name != "pass":
            continue
        top, off = above.get(way.contour, 0.0), _HEIGHT * milling.depth
        above[way.contour] = way.low
        name = f"the pass at Z{way.low:g} of contour {way.contour + 1}"
        if ramp is None or ramp.contour != way.contour or abs(ramp.low - way.low) > off:
            yield f"{name} has no ramp"
        elif abs(ramp.moves[0].heights[0] - top) > off:
            yield f"the ramp of {name} begins at Z{ramp.moves[0].heights[0]:g}, expected {top:g}"
        else:
            whole = sum(map(_length, last[way.contour].moves))
            allowed = max(slope, (top - way.low) / (_TURNS * whole)) * (1.0 + _LENGTHS)
            steep = [
                move.heights[0] - move.heights[1] - allowed * _length(move) for move in ramp.moves
            ]
            if max(steep) > off:
                yield f"the ramp of {name} is steeper than {milling.ramp:g} degrees"
        ramp = None


def _wrong_tabs(way: Way, milling: Milling, frame: Frame) -> Iterator[str]:
    """Tabs of a pass that are lost, too short or at another height, and lifts that are none."""
    name = f"the pass at Z{way.low:g} of contour {way.contour + 1}"
    lengths = [(_length(move), max(move.heights)) for move in way.moves]
    top = (milling.tab_height or 0.0) - milling.depth
    width = (milling.tab_width or 0.0) + 2.0 * frame.by * abs(way.distance)
    fit = math.floor(_TABBED * sum(length for length, _ in lengths) / width) if width else 0
    wanted = min(milling.tabs, fit) if way.low < top - _HEIGHT * milling.depth else 0
    found = [
        sum(length for length, _ in group)
        for high, group in groupby(lengths, lambda one: one[1] > way.low + _HEIGHT * milling.depth)
        if high
    ]
    if milling.laser_power is None and len(found) != wanted:
        yield f"{name} has {len(found)} tabs, expected {wanted}"
    wrong = [z for _, z in lengths if z > way.low and abs(z - top) > _HEIGHT * milling.depth]
    if wanted and wrong:
        yield f"{name} has a tab up to Z{wrong[0]:g}, expected {top:g}"
    if wanted and found and min(found) < width * (1.0 - _LENGTHS):
        yield f"{name} has a tab over {min(found):.6g}, expected {width:.6g}"


def _length(move: Move) -> float:
    if move.spoke is None:
        return abs(move.end - move.start)
    center = move.start + move.spoke
    turn = cmath.phase((move.end - center) / (move.start - center))
    turn = (-turn if move.clockwise else turn) % (2.0 * math.pi)
    return abs(move.spoke) * (turn or 2.0 * math.pi)


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
