"""Polygons of GeoJSON objects, and of whatever has a ``__geo_interface__``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, NamedTuple

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.brief import counted
from splinesdf.ground.limits import check_limit
from splinesdf.shapes.loops import check_count
from splinesdf.shapes.sources.compiled import polygon
from splinesdf.shapes.sources.holes import Filled, less_holes

TYPES = frozenset(
    ("FeatureCollection", "Feature", "GeometryCollection", "Polygon", "MultiPolygon", "Point",
     "MultiPoint", "LineString", "MultiLineString", "LinearRing")
)  # fmt: skip


class Polygons(NamedTuple):
    """Polygons, and what is found beside them."""

    rings: list[list[Floats]]  # of each polygon, its outline first
    left_out: Counter[str]
    has_z: list[bool]  # one True as soon as a point has more than two numbers
    corners: list[int]  # how many those of the first, the first two, ... have; 0 before
    elements: list[str]  # names of features and of geometries outside of these
    owner: list[int]  # of each polygon: which of the elements it is of

    def nothing(self) -> str:
        """What is said if there is no polygon."""
        words = ", ".join(f"{count} {name}" for name, count in self.left_out.items())
        return f"expected polygons, got {words or 'none'}"

    def filled(self, fill: str | None) -> tuple[list[Filled], tuple[str, ...]]:
        """What each polygon fills, and one line for each kind of thing that is not as expected.

        Parameters
        ----------
        fill : {"nonzero", "evenodd"}, optional
            The rule for the rings of a polygon, whichever is the outline; otherwise each is its
            outline less its holes.

        Raises
        ------
        InputError
            If there is no polygon.
        """
        if not self.rings:
            raise InputError(self.nothing())
        polygons = [[polygon(ring) for ring in rings] for rings in self.rings]
        if fill is not None:
            result = [Filled(rings, fill, nested=True) for rings in polygons]
        else:
            result = [less_holes(rings) for rings in polygons]
        notes = []
        if self.left_out:
            words = ", ".join(f"{count} {name}" for name, count in self.left_out.items())
            notes.append(f"left out: {words}")
        if self.has_z:
            notes.append("left out: the third coordinate of points")
        apart = sum(not region.nested for region in result)
        if apart:
            notes.append(
                f"{counted(apart, 'polygon')} with holes that are not within the outline, or over "
                'each other: filled is the outline less the holes (fill="evenodd": in turns)'
            )
        return result, tuple(notes)


def nothing_found() -> Polygons:
    """No polygons yet."""
    return Polygons([], Counter(), [], [0], [], [])


def polygons_of(value: Any) -> Polygons:
    """The polygons of a GeoJSON object, or of an object with a ``__geo_interface__``."""
    found = nothing_found()
    _collect(getattr(value, "__geo_interface__", value), found, 0)
    return found


def _collect(value: Any, found: Polygons, depth: int, *, named: bool = False) -> None:
    """Add the polygons of an object; if it is ``named``, they are of the last element."""
    check_limit("nesting", depth, "geometries within one another")
    if value is None:
        return
    kind = value.get("type") if isinstance(value, Mapping) else None
    if not isinstance(kind, str) or kind not in TYPES:
        raise InputError(f"expected a GeoJSON object, got one of type {kind!r:.40}")
    if kind == "FeatureCollection":
        for feature in _list(value, "features"):
            _collect(feature, found, depth + 1)
    elif kind == "Feature":
        found.elements.append(_name_of(value, len(found.elements) + 1))
        _collect(value.get("geometry"), found, depth + 1, named=True)
    elif kind == "GeometryCollection":
        for geometry in _list(value, "geometries"):
            _collect(geometry, found, depth + 1, named=named)
    else:
        if not named:
            found.elements.append(f"{kind} {len(found.elements) + 1}")
        if kind == "Polygon":
            add_polygon(_list(value, "coordinates"), found)
        elif kind == "MultiPolygon":
            for rings in _list(value, "coordinates"):
                add_polygon(rings, found)
        else:
            found.left_out[kind] += 1


def _name_of(feature: Mapping[str, Any], number: int) -> str:
    """A feature's id or name, else its number."""
    properties = feature.get("properties")
    named = properties.get("name") if isinstance(properties, Mapping) else None
    for name in (feature.get("id"), named):
        if isinstance(name, str | int | float) and not isinstance(name, bool) and str(name):
            return f"{name:g}" if isinstance(name, float) else str(name)
    return f"Feature {number}"


def _list(value: Mapping[str, Any], key: str) -> Sequence[Any]:
    result = value.get(key)
    if not isinstance(result, list | tuple):
        raise InputError(f"expected a list of {key} in a {value['type']}, got none")
    return result


def add_polygon(rings: Any, found: Polygons) -> None:
    """Add a polygon's rings, its outline first, to the last element."""
    if not isinstance(rings, list | tuple):
        raise InputError("expected a list of rings in a Polygon, got something else")
    corners = [_ring(ring, found) for ring in rings]
    if corners:
        found.rings.append(corners)
        found.owner.append(len(found.elements) - 1)
        found.corners.append(found.corners[-1] + sum(map(len, corners)))
        check_count(found.corners[-1])


def _ring(ring: Any, found: Polygons) -> Floats:
    points = isinstance(ring, list | tuple) and all(isinstance(p, list | tuple) for p in ring)
    if not points:
        raise InputError("expected a ring of points, got something else")
    if not all(len(p) >= 2 and all(map(_is_number, p[:2])) for p in ring):
        raise InputError("expected points of at least two numbers, got others")
    least, most = (some(map(len, ring), default=0) for some in (min, max))
    if least < most > 3:  # with three there may be heights that are not known everywhere
        raise InputError(
            f"expected points of equally many numbers in a ring, got {least} and {most}: is a "
            "comma missing?"
        )
    if any(len(point) > 2 for point in ring) and not found.has_z:
        found.has_z.append(True)
    return np.array([point[:2] for point in ring], dtype=np.float64).reshape(-1, 2)


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)
