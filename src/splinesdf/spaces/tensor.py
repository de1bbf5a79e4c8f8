"""Spaces on a grid: one coefficient a cell and a ring of cells around the domain.

On unequal cells there is the quadratic element only; see [Wang2014].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from splinesdf.ground.arrays import Bools, Floats, Ints, whole
from splinesdf.meshes.grid import Grid
from splinesdf.spaces.element import Element
from splinesdf.spaces.tables import Evaluated


@dataclass(frozen=True, eq=False)
class TensorSpace:
    """B-splines of an element on a grid; see `splinesdf.spaces.space.Space`.

    Attributes
    ----------
    mesh : Grid
    element : Element
    whole : bool
        Whether a refinement halves all cells, as the uniform space does, or rows and columns.
    """

    mesh: Grid
    element: Element
    whole: bool = False

    @classmethod
    def on(cls, mesh: Grid, element: Element) -> TensorSpace:
        """The space on a grid, a uniform one if its cells are equal."""
        return cls(mesh, element, whole=mesh.is_uniform)

    @property
    def name(self) -> str:
        """Of the kind of space."""
        return "uniform" if self.whole else "tensor"

    @property
    def equal_cells(self) -> bool:
        """Whether all cells are equal."""
        return self.mesh.is_uniform

    @property
    def persistent(self) -> bool:
        """False: a refinement changes all cells."""
        return False

    @cached_property
    def places(self) -> Ints:
        """The cell (i, j) of each B-spline, the ring's from -1 on."""
        m, n = self.mesh.shape
        beyond = self.element.beyond
        index = np.meshgrid(np.arange(-1, m + beyond), np.arange(-1, n + beyond), indexing="ij")
        return np.stack(index, axis=-1).reshape(-1, 2)

    @cached_property
    def own(self) -> Bools:
        """All B-splines have a coefficient of their own."""
        return np.ones(len(self.places), dtype=np.bool_)

    @cached_property
    def cells(self) -> Ints:
        """The B-spline of each cell."""
        m, n = self.mesh.shape
        return np.arange(len(self.places)).reshape(self._counts)[1 : m + 1, 1 : n + 1].reshape(-1)

    @property
    def _counts(self) -> tuple[int, int]:
        """B-splines each way."""
        m, n = self.mesh.shape
        return m + 1 + self.element.beyond, n + 1 + self.element.beyond

    @cached_property
    def _centers_and_sides(self) -> tuple[Floats, Floats]:
        lines = self.mesh.x, self.mesh.y
        sides = [ghosted_sides(v, self.element.beyond) for v in lines]
        lows = [
            np.concatenate([v[:1] - h[:1], v, v[-1] + np.cumsum(h[len(v) + 1 :])])
            for v, h in zip(lines, sides, strict=True)
        ]
        middles = [low + self.element.center * h for low, h in zip(lows, sides, strict=True)]
        centers = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, 2)
        return centers, np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)

    def points(self, bsplines: Ints, offsets: Floats) -> Floats:
        """Places from the centers of B-splines, offsets (k, 2) in cells, as points (k, 2)."""
        centers, sides = self._centers_and_sides
        return np.asarray(centers[bsplines] + offsets * sides[bsplines])

    def numbers(self, coefficients: Floats) -> Floats:
        """The numbers of all cells from all coefficients."""
        table = coefficients.reshape(self._counts)
        if "tensor" in self.element.spaces:
            return tensor_ordinates(self.mesh, table)
        side = self.element.beyond + 2
        blocks = np.lib.stride_tricks.sliding_window_view(table, (side, side))
        return self.element.cell_numbers(blocks.reshape(-1, side * side))

    def refined(self, bad: Ints, quarters: Bools) -> TensorSpace:
        """All cells halved, or the rows and columns of bad ones."""
        if self.whole:
            return TensorSpace(self.mesh.halve(), self.element, self.whole)
        marked = np.zeros(len(self.cells), dtype=np.bool_)
        marked[bad] = True
        marked = marked.reshape(self.mesh.shape)
        mesh = self.mesh.insert(np.any(marked, axis=1), np.any(marked, axis=0))
        return TensorSpace(mesh, self.element, self.whole)

    def evaluator(self, table: Floats) -> Callable[[Evaluated], int]:
        """A function that fills values and derivatives from the element's table of all cells."""
        x, y = self.mesh.x, self.mesh.y
        if self.element.power_form is None:
            from splinesdf.spaces.kernels.polynomials import evaluate_polynomials

            return partial(evaluate_polynomials, x, y, table, self.element.degree)
        if self.element.degree == 4:
            from splinesdf.spaces.kernels.quartics import evaluate_quartic_grid

            return partial(evaluate_quartic_grid, x, y, table)
        from splinesdf.spaces.kernels.evaluation import evaluate_grid  # Numba loads only when used

        return partial(evaluate_grid, x, y, table)


def ghosted_sides(lines: Floats, beyond: int = 1) -> Floats:
    """Cell sides with one more before and so many beyond them, equal to their neighbors."""
    sides = np.diff(lines)
    return np.concatenate([sides[:1], sides, np.repeat(sides[-1:], beyond)])


def tensor_ordinates(mesh: Grid, coefficients: Floats) -> Floats:
    """The quadratic element's numbers from coefficients, on unequal cells too.

    Parameters
    ----------
    mesh : Grid
        m x n cells with sides h_i, k_j; the ring beyond has the sides of its neighbors.
    coefficients : ndarray, shape (m + 2, n + 2)
        One a cell, the ring included.

    Returns
    -------
    ndarray, shape (m n, 8)

    References
    ----------
    [Wang2014] Section 2, in the form: values at cell centers, interpolated linearly to the grid
    lines, ``(h_i c_{i-1} + h_{i-1} c_i) / (h_{i-1} + h_i)``.
    """
    to_x = _to_lines(coefficients, ghosted_sides(mesh.x))  # (m + 1, n + 2)
    to_y = _to_lines(coefficients.T, ghosted_sides(mesh.y)).T  # (m + 2, n + 1)
    vertex = _to_lines(to_x.T, ghosted_sides(mesh.y)).T  # (m + 1, n + 1)
    west, south = to_x[:, 1:-1], to_y[1:-1]
    parts = [
        vertex[:-1, :-1],
        vertex[1:, :-1],
        vertex[:-1, 1:],
        vertex[1:, 1:],
        south[:, :-1],
        west[1:],
        south[:, 1:],
        west[:-1],
    ]
    return np.stack([part.reshape(-1) for part in parts], axis=1)


def _to_lines(values: Floats, sides: Floats) -> Floats:
    """Linear interpolation along axis 0 from cell centers to the lines between them."""
    before, after = sides[:-1, None], sides[1:, None]
    return np.asarray((after * values[:-1] + before * values[1:]) / (before + after))


def bspline_coefficients(mesh: Grid, i: int, j: int) -> Floats:
    """Coefficients of the one B-spline of cell (i, j), where -1 and m, n are the ring."""
    m, n = mesh.shape
    i, j = whole(i, "i", least=-1, most=m), whole(j, "j", least=-1, most=n)
    result = np.zeros((m + 2, n + 2))
    result[i + 1, j + 1] = 1.0
    return result
