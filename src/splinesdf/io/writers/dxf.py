"""Contours as DXF: one rational SPLINE of degree 2 each, without loss."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np

from splinesdf.contour import Contour, box, mirrored
from splinesdf.errors import MissingExtraError

# Bits of a SPLINE's flags (group code 70).
_CLOSED, _RATIONAL, _PLANAR = 1, 4, 8


def dxf_text(contours: Sequence[Contour], tolerance: float) -> str:
    """A drawing of SPLINE entities on one layer per distance, without a unit.

    Each arc is one Bézier segment: the inner knots are double, so the curve passes through the
    arcs' ends. A closed contour is a clamped curve that ends where it starts. Contours of a
    source whose y axis points down are mirrored back, or the part would be cut mirrored. The
    tolerance is not needed.
    """
    try:
        from ezdxf.filemanagement import new
    except ImportError as error:
        raise MissingExtraError(
            'writing DXF needs ezdxf: python -m pip install "splinesdf[dxf]"'
        ) from error
    document = new("R2010")
    document.header["$INSUNITS"] = 0  # none: ezdxf's own default is meters
    space = document.modelspace()
    for contour in contours:
        layer = f"distance_{float(contour.distance) + 0.0!r}"  # + 0.0 turns -0.0 into 0.0
        if layer not in document.layers:
            document.layers.add(layer)
        count = len(contour.arcs)
        arcs = _upright(contour).arcs
        control = np.concatenate([arcs[:, :2].reshape(-1, 2), arcs[-1:, 2]])
        weights = np.ones(2 * count + 1)
        weights[1::2] = contour.weights
        spline = space.add_rational_spline(
            control_points=[(x, y, 0.0) for x, y in control.tolist()],
            weights=weights.tolist(),
            degree=2,
            knots=[0.0, *np.repeat(np.arange(count + 1.0), 2).tolist(), float(count)],
            dxfattribs={"layer": layer},
        )
        spline.dxf.flags = _RATIONAL | _PLANAR | (_CLOSED if contour.closed else 0)
    # So that a viewer opens on the drawing, not on the origin.
    xmin, ymin, xmax, ymax = box([_upright(contour) for contour in contours])
    document.set_modelspace_vport(
        height=1.1 * max(xmax - xmin, ymax - ymin),
        center=(0.5 * (xmin + xmax), 0.5 * (ymin + ymax)),
    )
    text = io.StringIO()
    document.write(text)
    return text.getvalue()


def _upright(contour: Contour) -> Contour:
    """The contour with y pointing up."""
    return mirrored(contour) if contour.y_down else contour
