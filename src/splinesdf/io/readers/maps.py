"""Polygons of maps: GeoJSON, and well-known text.

text ──> geometries ──rings of polygons, holes by position──> regions ──union──> one shape
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.limits import check_limit
from splinesdf.io.readers.reading import Part, Reading
from splinesdf.io.readers.source import Options, Source
from splinesdf.shapes.sources.geojson import Polygons, add_polygon, nothing_found, polygons_of

_WKT = re.compile(r"\s*(?:([A-Za-z]+)|([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|([(),;=]))")
# Coordinates beside x and y, which some programs write as a part of the word before.
_HEIGHTS = re.compile(r"(?<=[A-Z])(?:ZM|Z|M)$")


def geojson_reading(source: Source, options: Options) -> Reading:
    """The polygons of a GeoJSON document, an element for each feature or geometry."""
    try:
        content = json.loads(source.text(), parse_int=float)
    except (ValueError, RecursionError) as error:
        raise InputError(f"expected GeoJSON, got something else: {error}") from error
    return _reading(polygons_of(content), source, options, degrees=True)


def _reading(found: Polygons, source: Source, options: Options, *, degrees: bool) -> Reading:
    """Polygons, and notes on what else there is."""
    regions, notes = found.filled(options.fill)
    parts = [Part(k, one.loops, one.rule) for k, one in zip(found.owner, regions, strict=True)]
    corners = np.concatenate([ring for rings in found.rings for ring in rings])
    if degrees and np.all(np.abs(corners) <= [180.0, 90.0]):
        notes += (
            "all coordinates could be degrees of longitude and latitude: if so, distances are in "
            "degrees, and not the same in both directions",
        )
    return Reading(source.stem, found.elements, parts, [], notes=notes)


def wkt_reading(source: Source, options: Options) -> Reading:
    """The polygons of well-known text, one geometry after the other, each an element."""
    tokens = list(_tokens(source.text()))
    found, at = nothing_found(), 0
    while at < len(tokens):
        if tokens[at] == ";":
            at += 1
        elif tokens[at].upper() == "SRID" and tokens[at + 1 : at + 2] == ["="]:
            at += 3
        else:
            at = _geometry(tokens, at, found, 0)
    return _reading(found, source, options, degrees=False)


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


def _geometry(tokens: list[str], at: int, found: Polygons, depth: int) -> int:
    """Read a geometry from a token on; the token after it."""
    check_limit("nesting", depth, "geometries within one another")
    kind, at = _HEIGHTS.sub("", _take(tokens, at).upper()), at + 1
    if kind != "GEOMETRYCOLLECTION":  # its geometries are elements each
        found.elements.append(f"{kind[:20]} {len(found.elements) + 1}")
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
        add_polygon(value, found)
    elif kind == "MULTIPOLYGON":
        for rings in value:
            add_polygon(rings, found)
    elif kind in ("POINT", "MULTIPOINT", "LINESTRING", "MULTILINESTRING"):
        found.left_out[kind] += 1
    else:
        raise InputError(f"expected a POLYGON or MULTIPOLYGON, got {kind[:30]!r}")
    return at


def _nested(tokens: list[str], at: int) -> tuple[list[Any], int]:
    """Lists within brackets, EMPTY left out; numbers without commas between them are one point."""
    at = _expect(tokens, at, "(")
    stack: list[list[Any]] = [[]]
    point: list[float] = []
    while True:  # up to the last bracket, or there is no token to take
        token, at = _take(tokens, at), at + 1
        if token == "(":
            stack.append([])
            check_limit("nesting", len(stack), "brackets within one another")
        elif token in (",", ")"):
            if point:
                stack[-1].append(point)
                point = []
            if token == ")":
                done = stack.pop()
                if not stack:
                    return done, at
                stack[-1].append(done)
        elif token.upper() != "EMPTY":
            try:
                point.append(float(token))
            except ValueError as error:
                raise InputError(f"expected a number, got {token[:30]!r}") from error


def _take(tokens: list[str], at: int) -> str:
    if at >= len(tokens):
        raise InputError("expected well-known text, got one that is cut short")
    return tokens[at]


def _expect(tokens: list[str], at: int, sign: str) -> int:
    if _take(tokens, at) != sign:
        raise InputError(f"expected {sign!r} in well-known text, got {tokens[at][:30]!r}")
    return at + 1
