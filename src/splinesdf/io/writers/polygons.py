"""Contours as polygons with holes: GeoJSON and WKT, flattened, coordinates as in the source.

A contour that nothing encloses is a polygon's outer ring, and so is one inside a hole; what they
directly enclose (`Contour.parent`) are its holes. Open contours are lines.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from splinesdf.contours.contour import Contour, halve
from splinesdf.ground.arrays import Floats
from splinesdf.io.writers.options import Options


@dataclass
class _Polygon:
    """An outer contour and its holes, or an open contour."""

    outer: Contour
    holes: list[Contour] = field(default_factory=list)


def geojson_text(contours: Sequence[Contour], options: Options) -> str:
    """A FeatureCollection; the properties of a feature are ``distance`` and ``closed``.

    Coordinates are in no particular reference system; outer rings turn from x to y, holes the
    other way (RFC 7946).
    """
    features = []
    for polygon in _polygons(contours):
        closed = polygon.outer.closed
        rings = [ring.tolist() for ring in _rings(polygon, options.tolerance)]
        features.append(
            {
                "type": "Feature",
                "properties": {"distance": float(polygon.outer.distance), "closed": closed},
                "geometry": {
                    "type": "Polygon" if closed else "LineString",
                    "coordinates": rings if closed else rings[0],
                },
            }
        )
    return json.dumps({"type": "FeatureCollection", "features": features}) + "\n"


def wkt_text(contours: Sequence[Contour], options: Options) -> str:
    """One POLYGON, or LINESTRING for an open contour, a line."""
    lines = []
    for polygon in _polygons(contours):
        rings = [
            "(" + ", ".join(f"{x!r} {y!r}" for x, y in ring.tolist()) + ")"
            for ring in _rings(polygon, options.tolerance)
        ]
        closed = polygon.outer.closed
        lines.append(f"POLYGON ({', '.join(rings)})" if closed else f"LINESTRING {rings[0]}")
    return "\n".join(lines) + "\n"


def _polygons(contours: Sequence[Contour]) -> list[_Polygon]:
    """In the order of their outer contours. A hole without its parent is a polygon of its own."""
    holes = {id(contour) for contour in contours if contour.closed and _depth(contour) % 2 == 1}
    polygons = {id(c): _Polygon(c) for c in contours if id(c) not in holes}
    for contour in contours:
        if id(contour) in holes:
            if id(contour.parent) in polygons:
                polygons[id(contour.parent)].holes.append(contour)
            else:
                polygons[id(contour)] = _Polygon(contour)
    return list(polygons.values())


def _depth(contour: Contour) -> int:
    """How many contours enclose this one."""
    depth, parent = 0, contour.parent
    while parent is not None:
        depth, parent = depth + 1, parent.parent
    return depth


def _rings(polygon: _Polygon, tolerance: float) -> list[Floats]:
    """Points of the outer ring and of the holes; those of an open contour as they run."""
    if not polygon.outer.closed:
        return [polygon.outer.points(tolerance)]
    rings = []
    for contour, side in [(polygon.outer, 1.0), *((hole, -1.0) for hole in polygon.holes)]:
        ring = _ring(contour, tolerance)
        rings.append(ring if side * contour.area >= 0.0 else ring[::-1])
    return rings


def _ring(contour: Contour, tolerance: float) -> Floats:
    """The contour's points, four at least: a ring needs them, however coarse the tolerance."""
    points = contour.points(tolerance)
    arcs, weights = contour.arcs, contour.weights
    while len(points) < 4:
        arcs, weights = halve(arcs, weights, np.ones(len(arcs), dtype=np.bool_))
        points = np.concatenate([arcs[:, 0], arcs[-1:, 2]])
    return points
