"""A file of contours read back, by other code than wrote it, and measured against the distance.

DXF by ezdxf, SVG by the reader of path data, G-code by an interpreter of its own, the others as
points ─→ `Curve`s ─┬─→ the worst point: dense samples, then ever closer around the worst
                    └─→ what they enclose, all those of a distance together (`enclosed`)
"""

from __future__ import annotations

import csv
import json
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from splinesdf.arclets.points import evaluate_bezier
from splinesdf.contours.contour import Contour
from splinesdf.distance.exact import signed_distance
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.paths import as_path
from splinesdf.io.enclosed import Sides, check_sides, flattened
from splinesdf.io.source_frame import Frame, Told, frame_of
from splinesdf.io.writers.options import GCODE
from splinesdf.shapes.shape import Shape
from splinesdf.shapes.sources.svg_path import parse_path

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
class Curve:
    """A connected curve in a file: ``at`` takes parameters in [0, count] to points (m, 2).

    The distance it stands for is NaN where the file does not say.
    """

    distance: float
    count: int
    at: Callable[[Floats], Floats]


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
    """

    deviation: float
    point: tuple[float, float]
    distance: float
    curves: dict[float, int]
    gap: float
    points: int
    sides: tuple[Sides, ...]

    def keeps(self, tolerance: float) -> bool:
        """Whether all of it is within a tolerance, closed, and encloses what it should."""
        near = self.deviation <= tolerance and self.gap <= tolerance
        return near and not self.points and not any(sides.wrong for sides in self.sides)


def measure_file(
    path: str | os.PathLike[str],
    shape: Shape,
    distances: Sequence[float],
    tolerance: float,
    told: Told | None = None,
    written: Sequence[Contour] = (),
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
        found, point = _worst_of(curve, level, shape, frame)
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
    ]
    return Worst(
        *(worst[0], where, worst[1]),
        {level: len(some) for level, some in lines.items()},
        gap,
        int(no_extent),
        tuple(replace(sides, point=frame.to_file(sides.point)) for sides in checked),
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
    climb = re.search(r"^\(within .* climb milling\)", file.read_text("utf-8"), re.MULTILINE)
    left = (distance < 0.0) == (climb is not None)
    return 1 if left != flip else -1


def curves_in(path: str | os.PathLike[str]) -> list[Curve]:
    """The curves of a file that `write` made, in the file's own coordinates."""
    file = as_path(path)
    return list(_READERS[file.suffix.lower()](file))


def _worst_of(
    curve: Curve, level: float, shape: Shape, frame: Frame
) -> tuple[float, tuple[float, float]]:
    """The largest deviation along a curve, and its point."""

    def off(at: Floats) -> tuple[Floats, Floats]:
        points = curve.at(at.ravel())
        return np.abs(signed_distance(shape, frame.to_source(points)) - level).reshape(
            at.shape
        ), points

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


# --- how each format is read ---------------------------------------------------------------------


def _polyline(distance: float, points: Any) -> Curve:
    array = np.asarray(points, dtype=np.float64)
    places = np.arange(len(array), dtype=np.float64)

    def at(u: Floats) -> Floats:
        return np.stack([np.interp(u, places, array[:, k]) for k in (0, 1)], axis=-1)

    return Curve(distance, len(array) - 1, at)


def _joined(distance: float, pieces: Sequence[Callable[[Floats], Floats]]) -> Curve:
    """Pieces, each over [0, 1], as one curve."""

    def at(u: Floats) -> Floats:
        which = np.minimum(u.astype(np.int64), len(pieces) - 1)
        points = np.zeros((len(u), 2))
        order = np.argsort(which, kind="stable")
        bounds = np.searchsorted(which[order], np.arange(len(pieces) + 1))
        for k in np.unique(which).tolist():
            rows = order[bounds[k] : bounds[k + 1]]
            points[rows] = pieces[k](u[rows] - k)
        return points

    return Curve(distance, len(pieces), at)


def _read_csv(file: Path) -> Iterator[Curve]:
    parts: dict[tuple[str, str], list[tuple[float, float]]] = {}
    with file.open(encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            key = row["contour"], row["distance"]
            parts.setdefault(key, []).append((float(row["x"]), float(row["y"])))
    for (_, distance), points in parts.items():
        yield _polyline(float(distance), points)


def _read_geojson(file: Path) -> Iterator[Curve]:
    for feature in json.loads(file.read_text(encoding="utf-8"))["features"]:
        geometry, distance = feature["geometry"], float(feature["properties"]["distance"])
        rings = geometry["coordinates"]
        for ring in rings if geometry["type"] == "Polygon" else [rings]:
            yield _polyline(distance, ring)


def _read_wkt(file: Path) -> Iterator[Curve]:
    for ring in re.findall(r"\(([^()]+)\)", file.read_text(encoding="utf-8")):
        yield _polyline(math.nan, [pair.split() for pair in ring.split(",")])


def _read_svg(file: Path) -> Iterator[Curve]:
    for group in ElementTree.parse(file).getroot().iter("{http://www.w3.org/2000/svg}g"):
        if "data-distance" not in group.attrib:
            continue
        for path in group:
            for pieces in parse_path(path.attrib["d"]):
                yield _joined(
                    float(group.attrib["data-distance"]),
                    [partial(evaluate_bezier, piece) for piece in pieces],
                )


def _read_dxf(file: Path) -> Iterator[Curve]:
    from ezdxf.filemanagement import readfile

    entities: Any = readfile(file).modelspace()
    for entity in entities:
        distance = float(entity.dxf.layer.removeprefix("distance_"))
        polyline = entity.dxftype() == "LWPOLYLINE"
        yield _joined(distance, _polyline_pieces(entity) if polyline else _dxf_pieces(entity))


def _polyline_pieces(entity: Any) -> list[Callable[[Floats], Floats]]:
    """Lines and arcs in the direction of the polyline; a bulge is the tangent of a quarter arc."""
    rows = [(complex(x, y), bulge) for x, y, bulge in entity.get_points("xyb")]
    pieces: list[Callable[[Floats], Floats]] = []
    for (start, bulge), (end, _) in pairwise([*rows, *rows[:1]] if entity.closed else rows):
        if bulge == 0.0:
            pieces.append(partial(_on_line, start, end))
            continue
        center = 0.5 * (start + end) + 0.25j * (end - start) * (1.0 / bulge - bulge)
        pieces += _arc(start, end, center, 4.0 * math.atan(bulge))
    return pieces


def _dxf_pieces(entity: Any) -> list[Callable[[Floats], Floats]]:
    """Each of a simple entity's segments over [0, 1]."""
    kind = entity.dxftype()
    if kind == "SPLINE":
        curve = entity.construction_tool()
        return [partial(_on_spline, curve, *span) for span in pairwise(sorted(set(curve.knots())))]
    if kind == "LINE":
        start, end = entity.dxf.start, entity.dxf.end
        return [partial(_on_line, complex(start.x, start.y), complex(end.x, end.y))]
    center = complex(entity.dxf.center.x, entity.dxf.center.y)
    radius, low, sweep = entity.dxf.radius, 0.0, 2.0 * math.pi
    if kind == "ARC":
        low = math.radians(entity.dxf.start_angle)
        sweep = math.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0)
    # In four, so that samples are as dense as on other segments.
    turn = 0.25 * sweep
    return [partial(_on_circle, center, (radius, 0.0), low + k * turn, turn) for k in range(4)]


def _on_spline(curve: Any, low: float, high: float, t: Floats) -> Floats:
    places = (low + t * (high - low)).tolist()
    return np.array([(p.x, p.y) for p in curve.points(places)])


def _on_line(start: complex, end: complex, t: Floats) -> Floats:
    points = start + t * (end - start)
    return np.stack([points.real, points.imag], axis=-1)


def _on_circle(
    center: complex, radii: tuple[float, float], low: float, turn: float, t: Floats
) -> Floats:
    """An arc from an angle on, its radius (at first, and how it changes) growing evenly."""
    points = center + (radii[0] + t * radii[1]) * np.exp(1j * (low + t * turn))
    return np.stack([points.real, points.imag], axis=-1)


def _read_gcode(file: Path) -> Iterator[Curve]:
    """Each run of G1, G2 and G3 in the plane between two G0; I and J are from the arc's start."""
    pieces: list[Callable[[Floats], Floats]] = []
    distance, here = math.nan, 0j
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.startswith("(distance "):
            distance = float(line.removeprefix("(distance ").removesuffix(")"))
        words = {w[0]: float(w[1:]) for w in re.sub(r"\(.*?\)", "", line).split()}
        end = complex(words.get("X", here.real), words.get("Y", here.imag))
        move = words.get("G")
        if move == 0.0 and pieces:
            yield _joined(distance, pieces)
            pieces = []
        elif move == 1.0 and "X" in words:
            pieces.append(partial(_on_line, here, end))
        elif move in (2.0, 3.0) and "X" in words:
            pieces += _turned(here, end, complex(words["I"], words["J"]), move == 2.0)
        here = end


def _turned(
    start: complex, end: complex, spoke: complex, clockwise: bool
) -> list[Callable[[Floats], Floats]]:
    """An arc about where the spoke from its start leads."""
    center = start + spoke
    low = math.atan2(-spoke.imag, -spoke.real)
    sweep = (math.atan2((end - center).imag, (end - center).real) - low) % (2.0 * math.pi)
    sweep = sweep - 2.0 * math.pi if clockwise else sweep
    if start == end:
        sweep = -2.0 * math.pi if clockwise else 2.0 * math.pi
    return _arc(start, end, center, sweep)


def _arc(
    start: complex, end: complex, center: complex, sweep: float
) -> list[Callable[[Floats], Floats]]:
    """An arc in four parts, its radius going evenly from that of the start to that of the end."""
    spoke = start - center
    first, last, low = abs(spoke), abs(end - center), math.atan2(spoke.imag, spoke.real)
    turn, growth = 0.25 * sweep, 0.25 * (last - first)
    return [
        partial(_on_circle, center, (first + k * growth, growth), low + k * turn, turn)
        for k in range(4)
    ]


_READERS: Mapping[str, Callable[[Path], Iterator[Curve]]] = {
    ".csv": _read_csv,
    ".dxf": _read_dxf,
    ".geojson": _read_geojson,
    ".svg": _read_svg,
    ".wkt": _read_wkt,
} | dict.fromkeys(sorted(GCODE), _read_gcode)
