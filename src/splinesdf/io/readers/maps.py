"""Polygons of maps: GeoJSON, and WKT.

text ──> geometries ──rings of polygons, holes by position──> regions ──union──> one shape
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.source import Options, Source
from splinesdf.shapes.region import region
from splinesdf.shapes.shape import Shape
from splinesdf.shapes.sources.compiled import polygon

GEOJSON_TYPES = frozenset(
    ("FeatureCollection", "Feature", "GeometryCollection", "Polygon", "MultiPolygon", "Point",
     "MultiPoint", "LineString", "MultiLineString")
)  # fmt: skip
# Geometries within geometries. More: Python's calls run out; nothing that is drawn has more.
_DEEPEST = 100
_WKT = re.compile(r"\s*(?:([A-Za-z]+)|([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|([(),;=]))")


class _Found(NamedTuple):
    """What is in a map."""

    polygons: list[list[Floats]]  # rings of each, its outline first
    left_out: Counter[str]
    has_z: list[bool]  # one True as soon as a point has more than two numbers


def geojson_shape(source: Source, options: Options) -> Shape:
    """The union of all polygons of a GeoJSON document."""
    try:
        content = json.loads(source.text(), parse_int=float)
    except (ValueError, RecursionError) as error:
        raise InputError(f"expected GeoJSON, got something else: {error}") from error
    found = _Found([], Counter(), [])
    _collect(content, found, 0)
    return map_shape(found, source, options, degrees=True)


def map_shape(found: _Found, source: Source, options: Options, *, degrees: bool) -> Shape:
    """The union of polygons, and notes on what else there is."""
    if not found.polygons:
        words = ", ".join(f"{count} {name}" for name, count in found.left_out.items())
        raise InputError(f"expected polygons, got {words or 'none'}")
    notes = []
    if found.left_out:
        words = ", ".join(f"{count} {name}" for name, count in found.left_out.items())
        notes.append(f"left out: {words}")
    if found.has_z:
        notes.append("left out: the third coordinate of points")
    corners = np.concatenate([ring for rings in found.polygons for ring in rings])
    if degrees and np.all(np.abs(corners) <= [180.0, 90.0]):
        notes.append(
            "all coordinates could be degrees of longitude and latitude: if so, distances are in "
            "degrees, and not the same in both directions"
        )
    parts = [[polygon(ring) for ring in rings] for rings in found.polygons]
    if len(parts) == 1:
        loops, fill = parts[0], options.fill or "evenodd"
    else:
        regions = [region(part, options.fill or "evenodd") for part in parts]
        loops, fill = [loop for found_loops in regions for loop in found_loops], "nonzero"
    return Shape.from_pieces(
        loops, fill=fill, close=True, name=source.stem, notes=tuple(notes), once=False
    )


def _collect(value: Any, found: _Found, depth: int) -> None:
    """Add the polygons of a GeoJSON object."""
    if depth > _DEEPEST:
        raise InputError(f"expected geometries nested up to {_DEEPEST} deep, got deeper ones")
    if value is None:
        return
    kind = value.get("type") if isinstance(value, dict) else None
    if not isinstance(kind, str) or kind not in GEOJSON_TYPES:
        raise InputError(f"expected a GeoJSON object, got one of type {kind!r:.40}")
    if kind == "FeatureCollection":
        for feature in _list(value, "features"):
            _collect(feature, found, depth + 1)
    elif kind == "Feature":
        _collect(value.get("geometry"), found, depth + 1)
    elif kind == "GeometryCollection":
        for geometry in _list(value, "geometries"):
            _collect(geometry, found, depth + 1)
    elif kind == "Polygon":
        _add(_list(value, "coordinates"), found)
    elif kind == "MultiPolygon":
        for rings in _list(value, "coordinates"):
            _add(rings, found)
    else:
        found.left_out[kind] += 1


def _list(value: dict[str, Any], key: str) -> list[Any]:
    result = value.get(key)
    if not isinstance(result, list):
        raise InputError(f"expected a list of {key} in a {value['type']}, got none")
    return result


def _add(rings: Any, found: _Found) -> None:
    if not isinstance(rings, list):
        raise InputError("expected a list of rings in a Polygon, got something else")
    corners = [_ring(ring, found) for ring in rings]
    if corners:
        found.polygons.append(corners)


def _ring(ring: Any, found: _Found) -> Floats:
    if not isinstance(ring, list) or not all(isinstance(point, list) for point in ring):
        raise InputError("expected a ring of points, got something else")
    if not all(len(point) >= 2 and all(isinstance(x, float) for x in point[:2]) for point in ring):
        raise InputError("expected points of at least two numbers, got others")
    if any(len(point) > 2 for point in ring) and not found.has_z:
        found.has_z.append(True)
    return np.array([point[:2] for point in ring], dtype=np.float64).reshape(-1, 2)


def wkt_shape(source: Source, options: Options) -> Shape:
    """The union of all polygons of well-known text, one geometry after the other."""
    tokens = list(_tokens(source.text()))
    found, at = _Found([], Counter(), []), 0
    while at < len(tokens):
        if tokens[at] == ";":
            at += 1
        elif tokens[at].upper() == "SRID" and tokens[at + 1 : at + 2] == ["="]:
            at += 3
        else:
            at = _geometry(tokens, at, found, 0)
    return map_shape(found, source, options, degrees=False)


def _tokens(text: str) -> Iterator[str]:
    at = 0
    text = text.rstrip()
    while at < len(text):
        match = _WKT.match(text, at)
        if match is None:
            raise InputError(
                f"expected well-known text, got {text[at : at + 20]!r} at character {at + 1}"
            )
        at = match.end()
        yield next(group for group in match.groups() if group is not None)


def _geometry(tokens: list[str], at: int, found: _Found, depth: int) -> int:
    """Read a geometry from a token on; the token after it."""
    if depth > _DEEPEST:
        raise InputError(f"expected geometries nested up to {_DEEPEST} deep, got deeper ones")
    kind, at = _take(tokens, at).upper(), at + 1
    if at < len(tokens) and tokens[at].upper() in ("Z", "M", "ZM"):
        at += 1
    if at < len(tokens) and tokens[at].upper() == "EMPTY":
        return at + 1
    if kind == "GEOMETRYCOLLECTION":
        at = _expect(tokens, at, "(")
        while True:
            at = _geometry(tokens, at, found, depth + 1)
            if _take(tokens, at) != ",":
                return _expect(tokens, at, ")")
            at += 1
    value, at = _nested(tokens, at)
    if kind == "POLYGON":
        _add(value, found)
    elif kind == "MULTIPOLYGON":
        for rings in value:
            _add(rings, found)
    elif kind in ("POINT", "MULTIPOINT", "LINESTRING", "MULTILINESTRING"):
        found.left_out[kind] += 1
    else:
        raise InputError(f"expected a POLYGON or MULTIPOLYGON, got {kind[:30]!r}")
    return at


def _nested(tokens: list[str], at: int) -> tuple[list[Any], int]:
    """Lists within brackets, numbers without commas between them as one point."""
    at = _expect(tokens, at, "(")
    stack: list[list[Any]] = [[]]
    point: list[float] = []
    while stack:
        token, at = _take(tokens, at), at + 1
        if token == "(":
            stack.append([])
            if len(stack) > _DEEPEST:
                raise InputError(f"expected brackets up to {_DEEPEST} deep, got deeper ones")
        elif token in (",", ")"):
            if point:
                stack[-1].append(point)
                point = []
            if token == ")":
                done = stack.pop()
                if not stack:
                    return done, at
                stack[-1].append(done)
        else:
            try:
                point.append(float(token))
            except ValueError as error:
                raise InputError(f"expected a number, got {token[:30]!r}") from error
    raise AssertionError  # the loop ends at the last bracket


def _take(tokens: list[str], at: int) -> str:
    if at >= len(tokens):
        raise InputError("expected well-known text, got one that is cut short")
    return tokens[at]


def _expect(tokens: list[str], at: int, sign: str) -> int:
    if _take(tokens, at) != sign:
        raise InputError(f"expected {sign!r} in well-known text, got {tokens[at][:30]!r}")
    return at + 1
