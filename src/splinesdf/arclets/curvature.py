"""How much arclets bend: proved ranges of curvature, for bounds of a distance's derivatives.

With u the signed distance to a smooth arc, negative on its left, s its arc length and kappa its
curvature, u has the second derivative k = kappa / (1 + kappa u) along its level sets, none across
them, and k changes along a level set by (d kappa / ds) / (1 + kappa u)^3: ranges of kappa and of
d kappa / ds are all that bounds of a distance's derivatives need.
"""

from __future__ import annotations

import numpy as np

from splinesdf.arclets.crossings import degrees
from splinesdf.arclets.cutting import pascal
from splinesdf.arclets.points import previous_of
from splinesdf.arclets.tables import Arclets, Bends
from splinesdf.ground.arrays import Floats

# An arclet whose speed at an end is below this share of its piece, as in a cusp, or a straight one
# that is shorter, has directions that are half rounding: nothing is claimed of it. Nor of one below
# the third share of the drawing, which is what rounding leaves of ends. Smaller: proofs rest on
# directions that are wrong by 1e-16 over this; larger: more small arclets whose neighborhoods need
# a closer look.
_SLOW, _SHORT, _LOST = 2e-7, 1e-8, 1e-11


def bends(arclets: Arclets) -> Bends:
    """Ranges of curvature and unit tangents of all arclets."""
    from splinesdf.arclets.kernels.bends import Bending, fill_bends  # Numba loads only when used

    degree = degrees(arclets)
    count, most = len(degree), int(degree.max())
    largest = float(np.abs(arclets.boxes[0]).max())
    least = np.where(degree > 1, _SLOW, _SHORT) * _piece_sizes(arclets)
    # Rounding in points of the curve.
    grain = 16.0 * np.finfo(np.float64).eps * largest
    bending = Bending(pascal(2 * most + 1), np.maximum(least, _LOST * largest), grain)
    rows, second = np.empty((count, 11)), np.empty((count, 5, max(2 * most - 1, 1)))
    fill_bends(arclets.arcs, bending, rows, second)
    return Bends(rows, second, previous_of(arclets.following))


def _piece_sizes(arclets: Arclets) -> Floats:
    """Half the size of each arclet's piece, as far as it is there: (n,)."""
    count = int(arclets.piece.max()) + 1
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    for points in (arclets.start, arclets.end):
        np.minimum.at(low, arclets.piece, points)
        np.maximum.at(high, arclets.piece, points)
    return np.asarray(0.5 * (high - low).max(axis=1)[arclets.piece])
