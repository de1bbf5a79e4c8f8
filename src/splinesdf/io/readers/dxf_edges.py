"""Entities of DXF as Bézier pieces in the plane, from their own numbers.

An entity's plane is that of its extrusion: up, or down, which mirrors it. Others are tilted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.shapes.sources.compiled import compile_arc
from splinesdf.shapes.sources.nurbs import nurbs_pieces

# A direction that is off the vertical by less is rounding of a file's digits.
_UPRIGHT = 1e-9
# Numbers beyond this are no drawing's, and products of theirs overflow.
LARGEST = 1e100
# Arcs of a smaller bulge, the tangent of a quarter of their angle, are cubics to rounding: these
# miss 0.02 of the fifth power of the bulge, in chords. Larger: that could be seen; smaller: the
# center is so far away that its rounding is seen.
_SLIGHT = 1e-3
# Points whose heights differ by less than this share of the entity's size are in one plane.
_LEVEL = 1e-9
# Fit points by which a closed spline goes on beyond both ends. What is assumed there of the ends is
# halved at least with each point, and so below rounding where the spline is. Fewer: a corner where
# it begins; more: time.
_AROUND = 64


class Flat(Exception):
    """Why an entity bounds nothing."""


def is_tilted(entity: Any) -> bool:
    """Whether the entity's plane is not that of x and y."""
    up = entity.dxf.get("extrusion", (0.0, 0.0, 1.0))
    return math.hypot(up[0], up[1]) > _UPRIGHT * math.hypot(*up)


def _check_usable(*numbers: float) -> None:
    if not all(abs(number) <= LARGEST for number in numbers):
        raise Flat("with numbers beyond use")


def _line(entity: Any) -> Iterator[list[Floats]]:
    ends = np.array([tuple(entity.dxf.start), tuple(entity.dxf.end)])
    _check_usable(*ends.ravel())
    _check_level(ends)
    if np.array_equal(ends[0, :2], ends[1, :2]):
        raise Flat("of no length")
    yield [np.ascontiguousarray(ends[:, :2])]


def _arc(entity: Any) -> Iterator[list[Floats]]:
    first, last = math.radians(entity.dxf.start_angle), math.radians(entity.dxf.end_angle)
    _check_usable(first, last)
    sweep = math.fmod(last - first, 2.0 * math.pi)
    yield _round(entity, first, sweep + 2.0 * math.pi if sweep <= 0.0 else sweep)


def _circle(entity: Any) -> Iterator[list[Floats]]:
    yield _round(entity, 0.0, 2.0 * math.pi)


def _round(entity: Any, first: float, sweep: float) -> list[Floats]:
    """An arc in the entity's own plane, which may be mirrored."""
    radius = abs(float(entity.dxf.radius))
    if radius == 0.0:
        raise Flat("of no radius")
    x, y, _ = entity.dxf.center
    _check_usable(x, y, radius)
    mirror = _mirror(entity)
    return compile_arc((mirror * x, y), (mirror * radius, 0.0), (0.0, radius), first, sweep)


def _mirror(entity: Any) -> float:
    """-1 if x of the entity's plane runs the other way, as it does seen from below."""
    return -1.0 if entity.dxf.get("extrusion", (0.0, 0.0, 1.0))[2] < 0.0 else 1.0


def _ellipse(entity: Any) -> Iterator[list[Floats]]:
    x, y, _ = entity.dxf.center
    ax, ay, az = entity.dxf.major_axis
    if math.hypot(ax, ay) == 0.0 or abs(az) > _LEVEL * math.hypot(ax, ay):
        raise Flat("tilted")
    ratio, up = float(entity.dxf.ratio), _mirror(entity)
    _check_usable(x, y, ax, ay, ratio, entity.dxf.start_param, entity.dxf.end_param)
    # The minor axis is the extrusion times the major one.
    minor = -up * ay * ratio, up * ax * ratio
    first, last = float(entity.dxf.start_param), float(entity.dxf.end_param)
    sweep = math.fmod(last - first, 2.0 * math.pi)
    whole = abs(abs(last - first) - 2.0 * math.pi) < 1e-12
    sweep = 2.0 * math.pi if whole or sweep == 0.0 else sweep
    sweep = sweep + 2.0 * math.pi if sweep < 0.0 else sweep
    yield compile_arc((x, y), (ax, ay), minor, first, sweep)


def _lightweight(entity: Any) -> Iterator[list[Floats]]:
    corners = np.array(
        [(x, y, bulge) for x, y, bulge in entity.get_points("xyb")], dtype=np.float64
    )
    yield _bulged(corners.reshape(-1, 3), bool(entity.closed), _mirror(entity))


def _polyline(entity: Any) -> Iterator[list[Floats]]:
    if entity.is_poly_face_mesh or entity.is_polygon_mesh:
        raise Flat("a mesh")
    vertices = [v for v in entity.vertices if not v.dxf.get("flags", 0) & 16]  # no spline frame
    if not all(v.dxf.hasattr("location") for v in vertices):
        raise Flat("with a corner that is nowhere")
    places = np.array([tuple(v.dxf.location) for v in vertices], dtype=np.float64).reshape(-1, 3)
    if entity.is_3d_polyline:
        _check_level(places)
        bulges = np.zeros(len(places))
    else:
        bulges = np.array([float(v.dxf.get("bulge", 0.0)) for v in vertices])
    corners = np.column_stack([places[:, :2], bulges])
    yield _bulged(corners, bool(entity.is_closed), _mirror(entity))


def _bulged(corners: Floats, closed: bool, mirror: float) -> list[Floats]:
    """A polyline; where a corner has a bulge an arc leads to the next one."""
    if len(corners) == 0:
        raise Flat("without points")
    _check_usable(*corners.ravel())
    corners = corners * [mirror, 1.0, mirror]
    rows = list(corners)
    if closed:
        rows.append(corners[0])
    pieces: list[Floats] = []
    for (x0, y0, bulge), (x1, y1, _) in pairwise(rows):
        if (x0, y0) == (x1, y1):
            continue
        if bulge == 0.0:
            pieces.append(np.array([(x0, y0), (x1, y1)]))
            continue
        if abs(bulge) < _SLIGHT:
            pieces.append(_slight(np.array([x0, y0]), np.array([x1, y1]), float(bulge)))
            continue
        # The bulge is the tangent of a quarter of the angle, positive to the left of the chord.
        sweep = 4.0 * math.atan(bulge)
        aside = 0.25 * (1.0 - bulge * bulge) / bulge
        cx = 0.5 * (x0 + x1) - aside * (y1 - y0)
        cy = 0.5 * (y0 + y1) + aside * (x1 - x0)
        first = np.array([x0 - cx, y0 - cy])
        arc = compile_arc((cx, cy), first, (-first[1], first[0]), 0.0, sweep)
        arc[0][0], arc[-1][-1] = (x0, y0), (x1, y1)
        pieces += arc
    if not pieces:
        raise Flat("of no length")
    return pieces


def _slight(start: Floats, end: Floats, bulge: float) -> Floats:
    """An arc of a small bulge as a cubic, which touches the arc at its ends."""
    angle, (x, y) = 2.0 * math.atan(bulge), (1.0 + bulge * bulge) / 3.0 * (end - start)
    along, across = np.array([x, y]) * math.cos(angle), np.array([y, -x]) * math.sin(angle)
    return np.array([start, start + along + across, end - along + across, end])


def _spline(entity: Any) -> Iterator[list[Floats]]:
    closed = bool(entity.closed) and not entity.control_point_count()
    try:
        tool = _closed_through(entity) if closed else entity.construction_tool()
    except (ValueError, ArithmeticError, IndexError) as error:
        raise Flat("without a curve") from error
    control = np.array([tuple(point) for point in tool.control_points], dtype=np.float64)
    _check_level(control)
    weights = np.array(tool.weights(), dtype=np.float64)
    knots = np.array(tool.knots(), dtype=np.float64)
    # ezdxf rounds knots to the file's tolerance, which may be much of their range.
    own = np.array(entity.knots, dtype=np.float64)
    if len(own) == len(knots) and np.all(np.diff(own) >= 0.0):
        knots = own
    try:
        pieces = nurbs_pieces(
            control[:, :2],
            degree=int(tool.degree),
            knots=knots,
            weights=weights if len(weights) else None,
        )
    except InputError as error:
        raise Flat(str(error)[:80]) from error
    if closed and not _tangents(entity):
        pieces = pieces[_AROUND:-_AROUND]
        pieces[-1][-1] = pieces[0][0]
    yield pieces


def _tangents(entity: Any) -> list[Any]:
    """The directions at a spline's start and end, or none if the file does not say both."""
    names = ("start_tangent", "end_tangent")
    return [entity.dxf.get(name) for name in names] if all(map(entity.dxf.hasattr, names)) else []


def _closed_through(entity: Any) -> Any:
    """The curve through a closed spline's fit points.

    If the file does not say how it begins, it is as smooth there as elsewhere: it then goes through
    the points again before its start and beyond its end.
    """
    from ezdxf.math import fit_points_to_cad_cv

    points = np.array([tuple(point) for point in entity.fit_points], dtype=np.float64)
    points = points[np.any(points != np.roll(points, -1, axis=0), axis=1)]
    if len(points) < 3:
        raise Flat("through fewer than three places")
    _check_usable(*points.ravel())
    if tangents := _tangents(entity):
        return fit_points_to_cad_cv([*points, points[0]], tangents)
    return fit_points_to_cad_cv(
        points[np.arange(-_AROUND, len(points) + _AROUND + 1) % len(points)]
    )


def _check_level(points: Floats) -> None:
    """Refuse what is not in a plane of equal height."""
    if not np.isfinite(points).all():
        raise Flat("without finite points")
    heights = np.ptp(points[:, 2]) if len(points) else 0.0
    if heights > _LEVEL * float(np.abs(points).max(initial=1.0)):
        raise Flat("not level")


EDGES: dict[str, Callable[[Any], Iterator[list[Floats]]]] = {
    "ARC": _arc,
    "CIRCLE": _circle,
    "ELLIPSE": _ellipse,
    "LINE": _line,
    "LWPOLYLINE": _lightweight,
    "POLYLINE": _polyline,
    "SPLINE": _spline,
}
