"""`Target`: the questions of a fit and its certificate to a shape.

The loop of `fit` and the certificate know nothing else of what they approximate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from splinesdf.distance.exact import signed_distance
from splinesdf.distance.tables import Bent
from splinesdf.fits.tables import Asked, Brackets, Limits
from splinesdf.ground.arrays import Floats
from splinesdf.meshes import Box
from splinesdf.shapes.shape import Shape

# What rounding of a point to the shape's own coordinates takes of a share that is 256 units in the
# last place: four units, where half of one is enough each way. Smaller: bounds far from the origin
# are no bounds.
_ASKED = 4.0 / 256.0


class Target(Protocol):
    """An object with a distance. Simplices are relative to `origin`, points are not."""

    @property
    def box(self) -> Box:
        """Around its boundary."""

    @property
    def origin(self) -> Floats:
        """Where its own coordinates begin."""

    def domain(self, outward: float) -> Box:
        """The box that a fit takes unless another is given; it has what is so far outward."""

    def values(self, points: Floats) -> Floats:
        """Exact signed distances."""

    def largest(self, boxes: Floats) -> float:
        """The largest coordinate as far as rounding of distances in boxes is concerned."""

    def largest_in(self, domain: Box) -> float:
        """The largest coordinate of a domain and the boundary, from `origin`."""

    def enclose(self, boxes: Floats, asked: Asked, limits: Limits, brackets: Brackets) -> None:
        """Bracket the error of a spline on simplices, as many in each box."""


@dataclass(frozen=True)
class ShapeTarget:
    """A plane shape as a `Target`.

    Attributes
    ----------
    shape : Shape
    """

    shape: Shape

    @property
    def box(self) -> Box:
        """Around its boundary."""
        return self.shape.box

    @property
    def origin(self) -> Floats:
        """Where its own coordinates begin."""
        return self.shape.boundary.origin

    def domain(self, outward: float) -> Box:
        """The box that a fit takes unless another is given; it has what is so far outward."""
        return self.shape.default_domain(outward)

    def values(self, points: Floats) -> Floats:
        """Exact signed distances."""
        return signed_distance(self.shape, points)

    def largest(self, boxes: Floats) -> float:
        """The largest coordinate as far as rounding is concerned, which is that of differences.

        Points that are asked for exact distances are rounded in the shape's own coordinates.
        """
        local = max(np.abs(boxes).max(initial=0.0), np.abs(self.shape.boundary.boxes[0]).max())
        return float(local + _ASKED * (local + np.abs(self.origin).max()))

    def largest_in(self, domain: Box) -> float:
        """The largest coordinate of a domain and the boundary, from `origin`."""
        corners = np.array(domain) - np.tile(self.origin, 2)
        return float(max(np.abs(corners).max(), np.abs(self.shape.boundary.boxes[0]).max()))

    def enclose(self, boxes: Floats, asked: Asked, limits: Limits, brackets: Brackets) -> None:
        """Bracket the error of a spline on triangles, as many in each box."""
        from splinesdf.arclets.culling import candidates_of_boxes
        from splinesdf.fits.kernels.enclosure import enclose  # Numba loads only when it is used

        boundary, bends = self.shape.boundary, self.shape.bends
        bent = Bent(boundary.arcs, boundary.following, bends.rows, bends.second, bends.previous)
        candidates = candidates_of_boxes(boundary, boxes)
        enclose(boundary.tree, candidates, bent, asked, limits, brackets)
