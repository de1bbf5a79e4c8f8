"""`Element`: a family of B-splines on equal cells, as small tables.

All that hierarchy, quasi-interpolation, certificate, evaluation and archive know of a spline's
cells they ask of its element, so that another box spline is one more file like `quadratic`:

    coefficients around a cell ─ from_coefficients ─→ its numbers ─ to_ordinates ─→ ordinates

Whatever the split of a cell into triangles, ordinates are those of its four triangles S E N W
between a side and the center (see `splinesdf.meshes`): a split by one diagonal is coarser, and its
polynomials are these as well.

The ordinates b_abc (a + b + c = degree) of a triangle come with a falling, then b falling. Its
corners are the side's two, counterclockwise, then the center.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import factorial, isqrt

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.values import by_value

# Corners of the triangles S E N W, from the cell's center in cells.
_HALF = 0.5
CORNERS = np.array(
    [
        [(-_HALF, -_HALF), (_HALF, -_HALF), (0.0, 0.0)],
        [(_HALF, -_HALF), (_HALF, _HALF), (0.0, 0.0)],
        [(_HALF, _HALF), (-_HALF, _HALF), (0.0, 0.0)],
        [(-_HALF, _HALF), (-_HALF, -_HALF), (0.0, 0.0)],
    ]
)


@dataclass(frozen=True)
class Operator:
    """The functional of a quasi-interpolant: a coefficient as weighted samples of the function.

    Attributes
    ----------
    offsets : tuple of (float, float)
        Places of the samples from the B-spline's center, in cells.
    weights : tuple of float
        They sum to one.
    by_parity : bool
        Whether x is mirrored for B-splines (i, j) with odd i + j.
    equal_cells : bool
        Whether it needs a grid of equal cells, or a quadtree.
    others : tuple of tuple of float
        Weights of the element's further families of B-splines, if it has any.
    """

    offsets: tuple[tuple[float, float], ...]
    weights: tuple[float, ...]
    by_parity: bool = False
    equal_cells: bool = True
    others: tuple[tuple[float, ...], ...] = ()

    def coefficients(
        self, places: Ints, family: Ints, sample: Callable[[Floats], Floats]
    ) -> Floats:
        """Coefficients of the B-splines at places (n, 2), shape (n,).

        Parameters
        ----------
        places : ndarray, shape (n, 2)
            The cells i, j of their level.
        family : ndarray, shape (n,)
            Of the element's families.
        sample : callable
            Answers the function (n,) at offsets (n, 2) in cells from the B-splines' centers.
        """
        mirror = np.ones((len(places), 2))
        if self.by_parity:
            mirror[:, 0] = np.where((places[:, 0] + places[:, 1]) % 2 == 0, 1.0, -1.0)
        result = np.zeros(len(places))
        weights = np.array([self.weights, *self.others])
        for offset, weight in zip(self.offsets, weights.T, strict=True):
            result += weight[family] * sample(np.array(offset) * mirror)
        return result


@by_value
@dataclass(frozen=True, eq=False)
class Element:
    """A family of B-splines, one a cell and one for each cell of a ring around the domain.

    Those that reach into a cell are of the 3 x 3 cells around it, from one before to one beyond; or
    of 4 x 4, from one before to two beyond, where a B-spline's center is its cell's lower left
    corner; or of 5 x 5. There may be several such families, whose mean is taken.

    Attributes
    ----------
    name : str
        "quadratic", "cubic", "quartic", "S31", "M222", "M1122".
    bspline : str
        The box spline: how often it has the directions (1,0) (0,1) (1,1) (1,-1).
    degree : int
    from_coefficients : ndarray, shape (numbers, 9, 16 or 25)
        A cell's numbers from the coefficients of the cells around it, j running first; family after
        family.
    to_ordinates : ndarray, shape (4, (degree + 1) (degree + 2) / 2, numbers)
        The Bernstein-Bézier ordinates of the triangles S E N W from a cell's numbers.
    mask : ndarray, shape (4, k, 3), or None
        Subdivision: for a child (i, j) of its parent, number 2 (i % 2) + j % 2, the places of
        coarser B-splines from the parent and their weights. None where there are no quadtrees.
    operators : mapping of str to Operator
        The quasi-interpolants by name.
    defaults : mapping of str to str
        Names of those that are used unless another is asked for: on a mesh that is "given", in
        "bands", "everywhere" in the domain, and on a "tensor" grid.
    spaces : tuple of str
        The kinds of space that it spans, see `splinesdf.spaces.space`.
    centers : tuple of (float, float)
        Where a B-spline's center is in its cell, for each family: (0.5, 0.5), or (0, 0) for the
        lower left corner.
    before : int
        How many cells before a cell, to the left or below, have B-splines that reach it.
    power_form : callable, optional
        From numbers (n, numbers) to the truncated powers that `splinesdf.spaces.kernels` reads:
        (n, 8) of degree 2, in `evaluation`, (n, 15) of degree 4, in `quartics`. Without it a cell
        is evaluated triangle by triangle.
    """

    name: str
    bspline: str
    degree: int
    from_coefficients: Floats
    to_ordinates: Floats
    mask: Floats | None
    operators: Mapping[str, Operator]
    defaults: Mapping[str, str]
    spaces: tuple[str, ...]
    centers: tuple[tuple[float, float], ...] = ((0.5, 0.5),)
    before: int = 1
    power_form: Callable[[Floats], Floats] | None = None

    @property
    def numbers(self) -> int:
        """How many numbers a cell is."""
        return len(self.from_coefficients)

    @property
    def beyond(self) -> int:
        """How many cells beyond a cell, to the right or above, have B-splines that reach it."""
        families = len(self.centers)
        return isqrt(self.from_coefficients.shape[1] // families) - 1 - self.before

    def operator(self, name: str) -> Operator:
        """The quasi-interpolant of a name, or an `InputError`."""
        if not isinstance(name, str) or name not in self.operators:
            known = ", ".join(self.operators)
            raise InputError(f"expected an operator of {known}, got {name!r:.60}")
        return self.operators[name]

    def default_operator(self, space: str, in_bands: bool) -> str:
        """The name of the quasi-interpolant that a fit uses unless told otherwise.

        Also in spaces that the element does not span, which are refused with their names.
        """
        asked = "tensor" if space == "tensor" else "bands" if in_bands else "everywhere"
        return self.defaults.get(asked, self.defaults["given"])

    def cell_numbers(self, blocks: Floats) -> Floats:
        """Numbers of cells from the coefficients around them, (n, columns) -> (n, numbers)."""
        return _product(blocks, self.from_coefficients)

    def ordinates(self, numbers: Floats) -> Floats:
        """Ordinates of the triangles of cells, (n, numbers) -> (n, 4, ordinates)."""
        rows = self.to_ordinates.reshape(-1, self.numbers)
        return _product(numbers, rows).reshape(-1, *self.to_ordinates.shape[:2])

    def at_centers(self, numbers: Floats) -> Floats:
        """The spline at the centers of cells, (n, numbers) -> (n,)."""
        return _product(numbers, self.to_ordinates[:1, -1])[:, 0]

    def table(self, numbers: Floats) -> Floats:
        """The table that evaluation reads: truncated powers of cells, or triangles' polynomials."""
        return self.polynomials(numbers) if self.power_form is None else self.power_form(numbers)

    def polynomials(self, numbers: Floats) -> Floats:
        """Coefficients of s^a t^b, s and t from the center in cells, in each triangle of cells.

        The order is that of `monomials`: (n, numbers) -> (n, 4, monomials).
        """
        return np.asarray(np.einsum("tkm,nm->ntk", self._to_polynomials, numbers, order="C"))

    @cached_property
    def _to_polynomials(self) -> Floats:
        rows = [
            bernstein(self.degree, corners).T @ matrix
            for corners, matrix in zip(CORNERS, self.to_ordinates, strict=True)
        ]
        return np.stack(rows)


def _product(values: Floats, matrix: Floats) -> Floats:
    """The product values @ matrix.T, summed from the first column to the last.

    Not by `@`: a library sums in an order of its own, with other last bits on other machines.
    """
    result = np.zeros((len(values), len(matrix)))
    for k, row in enumerate(matrix):
        for e in np.flatnonzero(row):
            result[:, k] += row[e] * values[:, e]
    return result


def monomials(degree: int) -> list[tuple[int, int]]:
    """Exponents of s and t, a rising, then b rising."""
    return [(a, b) for a in range(degree + 1) for b in range(degree + 1 - a)]


def indices(degree: int) -> list[tuple[int, int, int]]:
    """The ordinates' indices a, b, c in their order."""
    falling = range(degree, -1, -1)
    return [(a, b, degree - a - b) for a, b in product(falling, falling) if a + b <= degree]


def bernstein(degree: int, corners: Floats) -> Floats:
    """The Bernstein polynomials of a triangle by powers of s and t: (ordinates, monomials)."""
    (ax, ay), (bx, by), (cx, cy) = corners
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    # Barycentric coordinates as constant, s, t.
    lines = [
        ((px * qy - py * qx) / area, (py - qy) / area, (qx - px) / area)
        for (px, py), (qx, qy) in (((bx, by), (cx, cy)), ((cx, cy), (ax, ay)), ((ax, ay), (bx, by)))
    ]
    order = {power: k for k, power in enumerate(monomials(degree))}
    rows = np.zeros((len(order), len(order)))
    for row, index in zip(rows, indices(degree), strict=True):
        terms = {(0, 0): float(factorial(degree))}
        for (constant, in_s, in_t), times in zip(lines, index, strict=True):
            for _ in range(times):
                grown: dict[tuple[int, int], float] = {}
                for (a, b), value in terms.items():
                    for power, by in (((a, b), constant), ((a + 1, b), in_s), ((a, b + 1), in_t)):
                        grown[power] = grown.get(power, 0.0) + value * by
                terms = grown
            terms = {power: value / factorial(times) for power, value in terms.items()}
        for power, value in terms.items():
            row[order[power]] = value
    return rows


def reparametrized(degree: int, corners: Floats) -> Floats:
    """Ordinates on another triangle from those on one: the matrix of the blossom.

    Parameters
    ----------
    degree : int
    corners : ndarray, shape (3, 3)
        The other triangle's corners in barycentric coordinates of the first one.

    Returns
    -------
    ndarray, shape (ordinates, ordinates)
    """
    every = indices(degree)
    result = np.zeros((len(every), len(every)))
    for row, index in zip(result, every, strict=True):
        shares = {(0, 0, 0): 1.0}
        for corner, times in zip(corners, index, strict=True):
            for _ in range(times):
                grown: dict[tuple[int, int, int], float] = {}
                for (a, b, c), share in shares.items():
                    for moved, by in zip(
                        ((a + 1, b, c), (a, b + 1, c), (a, b, c + 1)), corner, strict=True
                    ):
                        grown[moved] = grown.get(moved, 0.0) + share * by
                shares = grown
        for at, share in shares.items():
            row[every.index(at)] = share
    return result
