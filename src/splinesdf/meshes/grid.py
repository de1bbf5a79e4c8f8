"""Grid: cells between the lines of two lists, uniform or not."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, Ints, as_floats, shown
from splinesdf.ground.brief import brief, without_caches
from splinesdf.ground.values import by_value
from splinesdf.meshes.mesh import Box, check_counts, check_domain


@by_value
@without_caches
@dataclass(frozen=True, eq=False)
class Grid:
    """A rectangular grid of m x n cells.

    Cell (i, j), number ``i * n + j``, is between ``x[i]``, ``x[i + 1]`` and ``y[j]``, ``y[j + 1]``.

    Attributes
    ----------
    x, y : ndarray, shapes (m + 1,), (n + 1,)
        Increasing grid lines.
    """

    x: Floats
    y: Floats

    def __post_init__(self) -> None:
        for name in ("x", "y"):
            lines = as_floats(getattr(self, name), f"grid lines {name}")
            if lines.ndim != 1:
                raise InputError(f"expected grid lines {name} in a row, got shape {lines.shape}")
            object.__setattr__(self, name, lines)

    @classmethod
    def uniform(cls, domain: Box, m: int, n: int) -> Grid:
        """Divide the domain into m x n equal cells."""
        xmin, ymin, xmax, ymax = check_domain(domain)
        m, n = check_counts(m, n)
        return cls(np.linspace(xmin, xmax, m + 1), np.linspace(ymin, ymax, n + 1))

    @classmethod
    def from_lines(cls, x: ArrayLike, y: ArrayLike) -> Grid:
        """The grid with these lines, which must increase."""
        lines = [as_floats(values, f"grid lines {name}") for values, name in ((x, "x"), (y, "y"))]
        for name, values in zip("xy", lines, strict=True):
            increasing = values.ndim == 1 and len(values) > 1 and bool(np.all(np.diff(values) > 0))
            if not (increasing and np.isfinite(values).all()):
                raise InputError(f"expected increasing grid lines {name}, got {shown(values)}")
        return cls(*lines)

    def __repr__(self) -> str:
        return brief("Grid", "", "{} x {} cells".format(*self.shape))

    kind: ClassVar = "grid"
    description: ClassVar = "grid"
    can_halve: ClassVar = True

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays that determine it, as a file holds them."""
        return {"x": self.x, "y": self.y}

    @property
    def shape(self) -> tuple[int, int]:
        """Cells each way."""
        return len(self.x) - 1, len(self.y) - 1

    @property
    def cell_count(self) -> int:
        """How many cells it has."""
        return (len(self.x) - 1) * (len(self.y) - 1)

    @property
    def domain(self) -> Box:
        """The box that the cells tile."""
        return float(self.x[0]), float(self.y[0]), float(self.x[-1]), float(self.y[-1])

    @cached_property
    def is_uniform(self) -> bool:
        """True if the cells are equal to rounding."""
        return all(
            bool(np.ptp(np.diff(v)) <= 1e-12 * (np.ptp(v) + np.max(np.abs(v))))
            for v in (self.x, self.y)
        )

    @cached_property
    def boxes(self) -> Floats:
        """The cells, shape (m n, 4)."""
        return _boxes(self.x, self.y)

    @cached_property
    def local_boxes(self) -> Floats:
        """The cells from the domain's lower left corner, shape (m n, 4)."""
        return _boxes(self.x - self.x[0], self.y - self.y[0])

    @property
    def corners(self) -> Ints:
        """Lattice corners, two units a cell, so that no vertex is the middle of a side."""
        m, n = self.shape
        i, j = 2 * np.repeat(np.arange(m), n), 2 * np.tile(np.arange(n), m)
        return np.column_stack([i, j, i + 2, j + 2])

    def halve(self) -> Grid:
        """Every cell in four."""
        return self.insert(np.ones(self.shape[0], dtype=bool), np.ones(self.shape[1], dtype=bool))

    def insert(self, columns: Bools, rows: Bools) -> Grid:
        """A grid line through the middle of every marked column and row."""
        middles = [0.5 * (v[:-1] + v[1:]) for v in (self.x, self.y)]
        return Grid(
            np.sort(np.concatenate([self.x, middles[0][columns]])),
            np.sort(np.concatenate([self.y, middles[1][rows]])),
        )


def _boxes(x: Floats, y: Floats) -> Floats:
    m, n = len(x) - 1, len(y) - 1
    x0, y0 = np.repeat(x[:-1], n), np.tile(y[:-1], m)
    x1, y1 = np.repeat(x[1:], n), np.tile(y[1:], m)
    return np.column_stack([x0, y0, x1, y1])
