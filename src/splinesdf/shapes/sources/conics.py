"""Conic arcs of contours as pieces: an offset becomes a shape again.

Straight arcs and parabolas are exact; others are compiled, good to a few units in the last place.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import accumulate, chain, pairwise

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError, OpenContourError
from splinesdf.ground.arrays import Bools, Floats
from splinesdf.shapes.sources.rational import rational_pieces

# A middle point this near to the chord, as a share of the largest coordinate, is on it.
_ROUNDING = 4.0 * 2.220446049250313e-16


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
    counts = [len(contour.arcs) for contour in given]
    pieces = _pieces(
        np.concatenate([contour.arcs for contour in given]),
        np.concatenate([contour.weights for contour in given]),
    )
    ends = [0, *accumulate(counts)]
    return [list(chain(*pieces[first:last])) for first, last in pairwise(ends)]


def _pieces(arcs: Floats, weights: Floats) -> list[list[Floats]]:
    """The pieces of each arc: those that need compiling are compiled together."""
    straight = _are_straight(arcs)
    rational = np.flatnonzero(~straight & (weights != 1.0))
    pieces = [
        [arc[[0, 2]] if is_straight else arc]
        for arc, is_straight in zip(arcs, straight, strict=True)
    ]
    compiled = rational_pieces(arcs[rational], weights[rational])
    for row, found in zip(rational.tolist(), compiled, strict=True):
        pieces[row] = found
    return pieces


def _are_straight(arcs: Floats) -> Bools:
    """Whether the middle control points lie on the chords, to rounding, so that the arcs do."""
    chord, leg = arcs[:, 2] - arcs[:, 0], arcs[:, 1] - arcs[:, 0]
    across = np.abs(chord[:, 0] * leg[:, 1] - chord[:, 1] * leg[:, 0])
    rounding = _ROUNDING * np.abs(arcs).max(axis=(1, 2))
    return np.asarray(across <= rounding * np.hypot(*chord.T))
