"""Clips and masks of SVG: the regions that drawings are cut to.

A clip is the union of what its children fill. A mask is read where it is a clip in other words: its
children are white or black and opaque, and then white adds to it and black takes away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.svg_outlines import rectangle
from splinesdf.io.readers.svg_transform import Matrix, inverse, mapped
from splinesdf.shapes.region import Loops, intersection, region

# A drawing inside a rectangle up to this share of its sides is not cut: rounding of its transform.
_BESIDE = 1e-9


@dataclass(frozen=True, eq=False)
class Clip:
    """A region that a drawing is cut to.

    Attributes
    ----------
    loops : list of lists of ndarray
        Around it, inside on the left.
    window : (Matrix, width, height) or None
        The map of a rectangle from (0, 0), if it is one: most drawings are inside.
    """

    loops: Loops
    window: tuple[Matrix, float, float] | None = None

    def cut(self, loops: Loops) -> Loops:
        """What is inside, of a region with the inside on the left."""
        if not loops:
            return []
        if self.window is not None and _is_inside(loops, *self.window):
            return loops
        return intersection(loops, self.loops)


def window(matrix: Matrix, width: float, height: float) -> Clip:
    """The clip to a rectangle from (0, 0) under a map."""
    loops = [mapped(loop, matrix) for loop in rectangle(0.0, 0.0, width, height)]
    return Clip(region(loops, "nonzero"), (matrix, width, height))


def _is_inside(loops: Loops, matrix: Matrix, width: float, height: float) -> bool:
    points: Floats = np.concatenate([piece for loop in loops for piece in loop])
    back = inverse(matrix)
    if back is None:
        return False
    x = back.a * points[:, 0] + back.c * points[:, 1] + back.e
    y = back.b * points[:, 0] + back.d * points[:, 1] + back.f
    return bool(
        x.min() >= -_BESIDE * width
        and y.min() >= -_BESIDE * height
        and x.max() <= (1.0 + _BESIDE) * width
        and y.max() <= (1.0 + _BESIDE) * height
    )
