"""The curves of a file that `write` made, by other code than wrote it.

DXF by ezdxf, SVG by the reader of path data, G-code by an interpreter of its own (`programs`), the
others as points ─→ `Curve`s
"""

from __future__ import annotations

import csv
import json
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from splinesdf.arclets.points import evaluate_bezier
from splinesdf.ground.arrays import Floats
from splinesdf.ground.paths import as_path
from splinesdf.io.programs import Way, last_passes, read_program
from splinesdf.io.writers.options import GCODE
from splinesdf.shapes.sources.svg_path import parse_path


@dataclass(frozen=True)
class Curve:
    """A connected curve in a file: ``at`` takes parameters in [0, count] to points (m, 2).

    The distance it stands for is NaN where the file does not say.
    """

    distance: float
    count: int
    at: Callable[[Floats], Floats]


def curves_in(path: str | os.PathLike[str]) -> list[Curve]:
    """The curves of a file that `write` made, in the file's own coordinates."""
    file = as_path(path)
    return list(_READERS[file.suffix.lower()](file))


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
    """The last pass along each contour."""
    ways, _ = read_program(file, None)
    return map(curve_of, last_passes(ways))


def curve_of(way: Way) -> Curve:
    """A way of the tool as a curve in the plane."""
    pieces: list[Callable[[Floats], Floats]] = []
    for move in way.moves:
        if move.spoke is None:
            pieces.append(partial(_on_line, move.start, move.end))
        else:
            pieces += _turned(move.start, move.end, move.spoke, move.clockwise)
    return _joined(way.distance, pieces)


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
