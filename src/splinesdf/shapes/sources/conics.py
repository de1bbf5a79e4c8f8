"""Conic arcs of contours as pieces: an offset becomes a shape again.

Straight arcs and parabolas are exact; others are compiled, good to a few units in the last place.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError, OpenContourError
from splinesdf.ground.arrays import Floats
from splinesdf.shapes.sources.nurbs import nurbs_pieces

# A middle point this near to the chord, as a share of the largest coordinate, is on it.
_ROUNDING = 4.0 * 2.220446049250313e-16
_KNOTS = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])


def contour_loops(contours: Iterable[Contour]) -> list[list[Floats]]:
    """The loops of closed contours of one level, inside on the left as they are.

    Raises
    ------
    OpenContourError
        If a contour is open.
    InputError
        If there is none, or they are of several levels.
    """
    given = list(contours)
    if not given:
        raise InputError("expected at least one contour, got none")
    for contour in given:
        if not isinstance(contour, Contour):
            raise InputError(f"expected contours, got {type(contour).__name__}")
        if not contour.closed:
            raise OpenContourError("expected closed contours, got one that leaves the domain")
    levels = sorted({contour.distance for contour in given})
    if len(levels) > 1:
        raise InputError(
            f"expected contours of one distance, got {levels[0]:g} and {levels[-1]:g}: those of "
            "each are a shape of their own"
        )
    return [
        [
            piece
            for arc, weight in zip(contour.arcs, contour.weights, strict=True)
            for piece in _pieces(arc, float(weight))
        ]
        for contour in given
    ]


def _pieces(arc: Floats, weight: float) -> list[Floats]:
    if _is_straight(arc):
        return [arc[[0, 2]]]
    if weight == 1.0:
        return [arc]
    return nurbs_pieces(arc, degree=2, knots=_KNOTS, weights=[1.0, weight, 1.0])


def _is_straight(arc: Floats) -> bool:
    """Whether the middle control point lies on the chord, to rounding, so that the arc does."""
    chord, leg = arc[2] - arc[0], arc[1] - arc[0]
    across = abs(chord[0] * leg[1] - chord[1] * leg[0])
    rounding = _ROUNDING * float(np.abs(arc).max())
    return bool(across <= rounding * np.hypot(*chord))
