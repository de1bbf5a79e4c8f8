"""Whether the curves of a file clear a pocket: no point that the tool reaches is far from all.

The distance to the curves changes by no more than the way. So a square whose center is nearer to
them than the radius, by half its diagonal, is cleared; of the others all four quarters are asked,
until they are as small as the tolerance. This shares no code with what made the paths.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.distance.exact import signed_distance
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.paths import as_path
from splinesdf.io.curves import curves_in
from splinesdf.io.enclosed import flattened
from splinesdf.io.source_frame import Told, frame_of
from splinesdf.shapes.shape import Shape

# Squares along the longer side at first, and the most squares of all sizes: beyond, nothing is
# proved, and that is said.
_FIRST, _MOST = 64, 20_000_000


class Cleared(NamedTuple):
    """What curves clear.

    Attributes
    ----------
    asked : int
        Points whose distance was asked.
    left : float
        How much farther than the radius and half the tolerance the farthest point is, at most 0 if
        nothing is left.
    point : (float, float)
        That point, in the shape's coordinates.
    """

    asked: int
    left: float
    point: tuple[float, float]


def left_by(
    path: str | os.PathLike[str],
    shape: Shape,
    radius: float,
    tolerance: float,
    told: Told,
    written: Sequence[Contour],
) -> Cleared:
    """The worst point of a pocket that no curve of a file comes near enough to, by the tolerance.

    Raises
    ------
    InputError
        If the tolerance is so small that more than 20,000,000 points would have to be asked.
    """
    frame = frame_of(as_path(path), shape, told, written, tolerance)
    # The sag of chords is a share of the tolerance, and counts against the curves.
    sag = 0.125 * tolerance
    lines = [flattened(c.at, c.count, frame.by * sag) for c in curves_in(path)]
    paths = _boundary([frame.to_source(line) for line in lines])
    xmin, ymin, xmax, ymax = shape.box
    half = 0.5 * max(xmax - xmin, ymax - ymin) / _FIRST
    sides = ((xmin, xmax), (ymin, ymax))
    x, y = (np.arange(low + half, high + half, 2.0 * half) for low, high in sides)
    centers = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    worst, where, asked = -math.inf, (math.nan, math.nan), 0
    while len(centers):
        asked += len(centers)
        if asked > _MOST:
            raise InputError(
                f"expected a pocket that {_MOST:,} points prove to be cleared, but the tolerance "
                f"{tolerance:.3g} needs more: raise it"
            )
        reach = math.sqrt(2.0) * half
        inside = signed_distance(shape, centers) + radius
        centers, inside = centers[inside <= reach], inside[inside <= reach]
        far = np.abs(signed_distance(paths, centers)) - radius
        # Only points at which the center of the tool may be count: the rest is the wall's.
        may = inside <= 0.0
        if may.any() and float(far[may].max()) > worst:
            at = int(np.argmax(np.where(may, far, -math.inf)))
            worst, where = float(far[at]), (float(centers[at, 0]), float(centers[at, 1]))
        if worst > tolerance or reach <= sag:
            break
        centers = centers[far + reach > 0.5 * tolerance]
        half *= 0.5
        quarters = half * np.array([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
        centers = (centers[:, None] + quarters).reshape(-1, 2)
    return Cleared(asked, worst - 0.5 * tolerance, where)


def _boundary(lines: Sequence[Floats]) -> Shape:
    """Closed polylines that may cross as one set of lines, whatever lies within them."""
    loops = [[np.stack(pair) for pair in pairwise(line)] for line in lines]
    return Shape.from_pieces(loops, fill="evenodd", close=True)
