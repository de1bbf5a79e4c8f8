"""Contours as DXF: polylines with bulges where they are exact, rational splines elsewhere."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from splinesdf.contours.biarcs import arc_elements
from splinesdf.contours.conics import Element, Kind, elements, unfolded
from splinesdf.contours.contour import Contour, box
from splinesdf.errors import MissingExtraError
from splinesdf.io.writers.options import MILLIMETERS, Options, dxf_unit

# Bits of a SPLINE's flags (group code 70).
_CLOSED, _RATIONAL, _PLANAR = 1, 4, 8
# An arc that readers of its center would miss by more than this share of its chord is drawn as a
# spline, which is exact. Smaller, and arcs that others make with few digits are splines.
_FLAT = 1e-9
# Colors of layers by the AutoCAD color index, one distance after the other: each stands out from
# a white background by a contrast of 3 at least, and from AutoCAD's dark one. More of them would
# look alike. Red, ochre, pink, olive, magenta; blue, green, teal, lime, violet.
_OUTSIDE, _INSIDE = (1, 42, 230, 54, 6), (150, 92, 134, 72, 200)
_SHAPE = 7  # black or white, whatever the background is not


def dxf_text(contours: Sequence[Contour], options: Options) -> str:
    """A drawing with one entity for each contour, on one layer per distance.

    What a machine cuts without loss comes as what its control knows: a full circle as CIRCLE, a
    contour of lines and circular arcs as LWPOLYLINE with bulges, a single open one as LINE or
    ARC. A contour with other conics is one rational SPLINE of degree 2, exactly: each arc is one
    Bezier segment, the inner knots are double, so the curve passes through the arcs' ends. With
    ``arcs`` such contours, too, are made of lines and circular arcs, within the tolerance.

    Layers have a color each: warm outside, cold inside, next to one another never the same.
    """
    try:
        from ezdxf.filemanagement import new
    except ImportError as error:
        raise MissingExtraError(
            'writing DXF needs ezdxf: python -m pip install "splinesdf[dxf]"'
        ) from error
    document = new("R2010")
    # None if it is not known, as ezdxf's own default is meters.
    unit = options.unit if options.units is None else MILLIMETERS[options.units]
    document.header["$INSUNITS"] = dxf_unit(unit)
    document.header["$MEASUREMENT"] = 0 if options.units == "inch" else 1
    space = document.modelspace()
    layers = _layers({float(contour.distance) + 0.0 for contour in contours})
    for layer, color in layers.values():
        document.layers.add(layer, color=color)
    for chain in contours:
        layer, _ = layers[float(chain.distance) + 0.0]
        if options.arcs:
            pieces = arc_elements(chain, tolerance=options.tolerance)
        else:
            chain = unfolded(chain)
            pieces = elements(chain)
        _add(space, chain, pieces, {"layer": layer}, exact=not options.arcs)
    # So that a viewer opens on the drawing, not on the origin.
    xmin, ymin, xmax, ymax = box(contours)
    document.set_modelspace_vport(
        height=1.1 * max(xmax - xmin, ymax - ymin),
        center=(0.5 * (xmin + xmax), 0.5 * (ymin + ymax)),
    )
    text = io.StringIO()
    document.write(text)
    return text.getvalue()


def _layers(distances: set[float]) -> dict[float, tuple[str, int]]:
    """The name and the color of each distance's layer, those nearer to the shape first."""
    result = {}
    for inside, colors in ((False, _OUTSIDE), (True, _INSIDE)):
        some = sorted((d for d in distances if d and (d < 0.0) == inside), key=abs)
        for rank, distance in enumerate(some):
            result[distance] = (f"distance_{distance!r}", colors[rank % len(colors)])
    if 0.0 in distances:
        result[0.0] = ("distance_0.0", _SHAPE)
    return result


def _add(
    space: Any,
    contour: Contour,
    pieces: Sequence[Element],
    attributes: dict[str, str],
    *,
    exact: bool,
) -> None:
    """Add the contour, of which these are the elements, to a layout."""
    plain = all(piece.kind in (Kind.LINE, Kind.CIRCLE) for piece in pieces)
    if exact and any(piece.is_flat(_FLAT * abs(piece.end - piece.start)) for piece in pieces):
        plain = False
    if not pieces or not plain:
        _add_spline(space, contour, attributes)
    elif pieces[0].is_full:
        _add_circular(space, pieces[0], attributes)
    elif len(pieces) > 1 or contour.closed:
        _add_polyline(space, contour, pieces, attributes)
    elif pieces[0].kind is Kind.LINE:
        space.add_line(_xy(pieces[0].start), _xy(pieces[0].end), dxfattribs=attributes)
    else:
        _add_circular(space, pieces[0], attributes)


def _add_circular(space: Any, piece: Element, attributes: dict[str, str]) -> None:
    """CIRCLE, or ARC, which always turns counterclockwise."""
    if piece.is_full:
        space.add_circle(_xy(piece.center), piece.radius, dxfattribs=attributes)
        return
    angles = [
        math.degrees(math.atan2(spoke.imag, spoke.real))
        for spoke in (piece.start - piece.center, piece.end - piece.center)
    ]
    if piece.sweep < 0.0:
        angles.reverse()
    space.add_arc(_xy(piece.center), piece.radius, *angles, dxfattribs=attributes)


def _add_polyline(
    space: Any, contour: Contour, pieces: Sequence[Element], attributes: dict[str, str]
) -> None:
    """LWPOLYLINE; the bulge is the tangent of a quarter of the sweep, up to that of a half turn."""
    vertices = []
    for piece in pieces:
        for part in piece.parts(math.pi):
            bulge = math.tan(0.25 * part.sweep) if part.kind is Kind.CIRCLE else 0.0
            vertices.append((*_xy(part.start), bulge))
    if not contour.closed:
        vertices.append((*_xy(pieces[-1].end), 0.0))
    space.add_lwpolyline(vertices, format="xyb", close=contour.closed, dxfattribs=attributes)


def _add_spline(space: Any, contour: Contour, attributes: dict[str, str]) -> None:
    """SPLINE; a closed contour is a clamped curve that ends where it starts."""
    count = len(contour.arcs)
    control = np.concatenate([contour.arcs[:, :2].reshape(-1, 2), contour.arcs[-1:, 2]])
    weights = np.ones(2 * count + 1)
    weights[1::2] = contour.weights
    spline = space.add_rational_spline(
        control_points=[(x, y, 0.0) for x, y in control.tolist()],
        weights=weights.tolist(),
        degree=2,
        knots=[0.0, *np.repeat(np.arange(count + 1.0), 2).tolist(), float(count)],
        dxfattribs=attributes,
    )
    spline.dxf.flags = _RATIONAL | _PLANAR | (_CLOSED if contour.closed else 0)


def _xy(point: complex) -> tuple[float, float]:
    return point.real, point.imag
