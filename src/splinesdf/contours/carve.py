"""`Carve`: the paths of a V-shaped bit, and the areas that are left flat."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.ground.arrays import Floats, Page
from splinesdf.ground.brief import brief, counted
from splinesdf.ground.values import by_value


@by_value
@dataclass(frozen=True, eq=False)
class Carve:
    """Paths in space along which a V-shaped bit carves a shape; the surface is at z = 0.

    Attributes
    ----------
    paths : tuple of ndarray, shape (n, 3)
        x, y and z of the bit's tip, each path straight from point to point without a lift.
    flat : tuple of Contour
        Around what is as deep as ``depth`` and flat, to be cleared by another tool.
    angle : float
        Of the bit, from side to side, in degrees.
    depth : float or None
        The most that is carved, below the surface.
    tip : float
        The diameter of the bit's flat end.
    allowance : float
        What is left along the boundary.
    tolerance : float
        How far the carved surface may be above the exact one.
    name, y_down, unit, page : str, bool, float, tuple
        The shape's.

    Examples
    --------
    >>> import splinesdf as ss
    >>> carve = ss.vcarve(ss.Shape.rectangle(0, 0, 40, 20), angle=90)
    >>> carve
    <Carve rectangle: 1 path, length 104.9, 10 deep>
    >>> carve.lifts, carve.paths[0].shape
    (1, (8, 3))
    """

    paths: tuple[Floats, ...]
    flat: tuple[Contour, ...]
    angle: float
    depth: float | None
    tip: float
    allowance: float
    tolerance: float
    name: str = ""
    y_down: bool = False
    unit: float | None = None
    page: Page | None = None

    def __repr__(self) -> str:
        return brief(
            "Carve",
            self.name,
            counted(len(self.paths), "path"),
            f"length {self.length:.4g}",
            f"{self.deepest:.4g} deep",
        )

    @property
    def lifts(self) -> int:
        """How often the bit is lifted: once after each path."""
        return len(self.paths)

    @property
    def length(self) -> float:
        """The length of all paths in the plane."""
        return sum(float(np.hypot(*np.diff(path[:, :2], axis=0).T).sum()) for path in self.paths)

    @property
    def deepest(self) -> float:
        """How deep the bit goes below the surface."""
        return max(-float(path[:, 2].min()) for path in self.paths)

    @property
    def slope(self) -> float:
        """How deep the bit cuts for each unit from its side: 1 / tan(angle / 2)."""
        return 1.0 / math.tan(math.radians(0.5 * self.angle))
