"""Kinds of arclets: straight ones and parts of circles, to rounding, whatever they came from.

An arc of an SVG path, a NURBS circle and a formula of cosines are all polynomial pieces by now, so
that their points decide. The kind is that of whole pieces: a short enough part of any curve is
straight, to rounding.
"""

from __future__ import annotations

import numpy as np

from splinesdf.arclets.tables import Arclets, Kinds

# Points of a straight or round piece may be off by this share of the largest coordinate, for
# rounding and compilation (4 ulp). Larger: curves that only look like circles lose their own
# shape by as much; smaller: circles are not recognized, and come back as several conics.
_OFF = 32 * 2.220446049250313e-16
# A piece whose radius is above this many times its length is no part of a circle: the center is all
# rounding. Larger: offsets are joined about centers that are off; smaller: flat arcs come back
# as conics, within the tolerance.
_FLATTEST = 1e6


def kinds(boundary: Arclets) -> Kinds:
    """Find the kind of every arclet, and the centers of round arclets."""
    from splinesdf.arclets.kernels.kinds import fill_kinds  # Numba loads only when it is used

    count = len(boundary.piece)
    # Rounding and compilation happened before the origin was moved.
    rounding = _OFF * float(np.abs(boundary.boxes[0]).max() + np.abs(boundary.origin).max())
    found = Kinds(np.empty(count, dtype=np.int64), np.empty((count, 2)))
    three = np.empty((int(boundary.piece.max()) + 1, 3, 2))
    limits = (rounding, _FLATTEST)
    fill_kinds(boundary.arcs, boundary.piece, boundary.interval, limits, three, found)
    return found
