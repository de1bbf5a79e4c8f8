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
        """The cell (i, j) of each B-spline, the ring's from -1 (or -2) on; family after family."""
        m, n = self.mesh.shape
        first, beyond = -self.element.before, self.element.beyond
        index = np.meshgrid(
            np.arange(first, m + beyond), np.arange(first, n + beyond), indexing="ij"
        )
        return np.tile(np.stack(index, axis=-1).reshape(-1, 2), (len(self.element.centers), 1))

    @cached_property
    def family(self) -> Ints:
        """Of the element's families, that of each B-spline."""
        families = len(self.element.centers)
        return np.asarray(np.repeat(np.arange(families), len(self.places) // families))

    @cached_property
    def own(self) -> Bools:
        """All B-splines have a coefficient of their own."""
        return np.ones(len(self.places), dtype=np.bool_)

    @cached_property
    def cells(self) -> Ints:
        """The B-spline of each cell, of the first family."""
        (m, n), first = self.mesh.shape, self.element.before
        every = np.arange(len(self.places)).reshape(self._counts)[0]
        return np.asarray(every[first : first + m, first : first + n].reshape(-1))

    @property
    def _counts(self) -> tuple[int, int, int]:
        """Families, and B-splines of each both ways."""
        (m, n), more = self.mesh.shape, self.element.before + self.element.beyond
        return len(self.element.centers), m + more, n + more

    @cached_property
    def _centers_and_sides(self) -> tuple[Floats, Floats]:
        lines, before = (self.mesh.x, self.mesh.y), self.element.before
        sides = [ghosted_sides(v, self.element.beyond, before) for v in lines]
        lows = [
            np.concatenate(
                [v[0] - np.cumsum(h[:before])[::-1], v, v[-1] + np.cumsum(h[len(v) + before :])]
            )
            for v, h in zip(lines, sides, strict=True)
        ]
        centers = [
            _pairs([low + at * h for low, h, at in zip(lows, sides, center, strict=True)])
            for center in self.element.centers
        ]
        return np.concatenate(centers), np.tile(_pairs(sides), (len(centers), 1))

    def points(self, bsplines: Ints, offsets: Floats) -> Floats:
        """Places from the centers of B-splines, offsets (k, 2) in cells, as points (k, 2)."""
        centers, sides = self._centers_and_sides
        return np.asarray(centers[bsplines] + offsets * sides[bsplines])

    def numbers(self, coefficients: Floats) -> Floats:
        """The numbers of all cells from all coefficients."""
        table, cells = coefficients.reshape(self._counts), self.mesh.cell_count
        if "tensor" in self.element.spaces:
            return tensor_ordinates(self.mesh, table[0])
        side = self.element.before + 1 + self.element.beyond
        blocks = np.lib.stride_tricks.sliding_window_view(table, (side, side), axis=(1, 2))
        return self.element.cell_numbers(np.moveaxis(blocks, 0, 2).reshape(cells, -1))

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


def _pairs(lines: list[Floats]) -> Floats:
    """All pairs of one of each of two, (n, 2), the second running first."""
    return np.asarray(np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2))


def ghosted_sides(lines: Floats, beyond: int = 1, before: int = 1) -> Floats:
    """Cell sides with so many more before and beyond them, equal to their neighbors."""
    sides = np.diff(lines)
    return np.concatenate([np.repeat(sides[:1], before), sides, np.repeat(sides[-1:], beyond)])


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
