"""The B-spline coefficients of a spline on a grid, found again from its cells.

sides ──steps of the alternating coefficients──> all but the ring's corners ──corners──> all
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.meshes import Grid
from splinesdf.spaces.element import Element
from splinesdf.spaces.space import space_on
from splinesdf.spaces.tensor import ghosted_sides

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF

# Cells fit together if ordinates made of the coefficients agree with theirs to this share of the
# largest. Smaller: thousands of steps, and sides of many sizes, are refused for their rounding;
# larger: changed ordinates pass.
_ROUNDING = 1e-10
# Elements whose B-splines have at most one dependence; of others there are many coefficients.
_KNOWN = ("quadratic", "quartic", "cubic")


def coefficients(spline: SplineSDF) -> Floats:
    """The coefficients of the B-splines of a quadratic, quartic or cubic spline on a grid.

    Returns
    -------
    ndarray, shape (m + 2, n + 2), of a quartic spline (m + 3, n + 3)
        Entry (i + 1, j + 1) is that of ``splinesdf.splines.quasi.bspline(mesh, i, j, element)``, i
        along x and j along y: one of each of the m x n cells, and of the ring around them. The
        quadratic and the quartic B-splines with (-1)^(i + j) h_i k_j, the sides of their cells, sum
        to zero, so that the coefficients are known but for a multiple of that: these have none of
        it, they are orthogonal to it.

    Raises
    ------
    InputError
        If the spline is on a quadtree, of another element, or none of B-splines; or if rounding
        hides them: sides that shrink from large to tiny (by 1e6) and grow again.

    Examples
    --------
    >>> import splinesdf as ss
    >>> made = ss.interpolate(ss.Shape.circle((0, 0), 1), (6, 5))
    >>> made.spline.coefficients().shape
    (8, 7)
    """
    mesh, element = spline.mesh, spline.element
    if not isinstance(mesh, Grid) or element.name not in _KNOWN:
        raise InputError(
            f"expected a spline of the element {', '.join(_KNOWN)} on a grid, whose B-splines have "
            f"a coefficient a cell, got a {element.name} one of {mesh.description}: make it by "
            "interpolate or quasi_interpolate on a Grid"
        )
    space = space_on(mesh, element)  # refuses what has no such B-splines there
    own = spline.ordinates
    if "tensor" in element.spaces:
        found = _found(mesh, own)
    else:
        found = _found_in_blocks(mesh.shape, element, own)
    largest = max(float(np.abs(own).max()), float(np.abs(found).max()))
    if not np.abs(space.numbers(found.reshape(-1)) - own).max() <= _ROUNDING * largest:
        raise InputError(
            "expected a spline of B-splines, got one whose cells do not fit together: its "
            "ordinates were changed, or sides of its cells differ by more than rounding allows"
        )
    return found


def _found_in_blocks(shape: tuple[int, int], element: Element, numbers: Floats) -> Floats:
    """Coefficients on equal cells, from those that reach a cell, by its numbers.

    If (-1)^(i + j) makes no numbers, they are known of each cell but for a multiple of that: with
    these signs, but for a constant, so that steps from one coefficient to the next are known.
    """
    m, n = shape
    side = element.before + 1 + element.beyond
    signs = (-1.0) ** np.add.outer(np.arange(m + side - 1), np.arange(n + side - 1))
    one = signs[:side, :side]
    blocks = numbers @ np.linalg.pinv(element.from_coefficients).T
    blocks = blocks.reshape(m, n, side, side)
    if np.abs(element.from_coefficients @ one.reshape(-1)).max() > _ROUNDING:
        # Each from a cell in whose middle it is, as far as there is one.
        p, q = np.arange(m + side - 1)[:, None], np.arange(n + side - 1)
        i, j = (np.clip(at - side // 2, 0, count - 1) for at, count in ((p, m), (q, n)))
        return np.asarray(blocks[i, j, p - i, q - j])
    blocks = blocks * one * signs[:m, :n, None, None]
    steps = [np.diff(blocks, axis=2), np.diff(blocks, axis=3)]
    p, q = np.arange(m + side - 2)[:, None], np.arange(n + side - 1)
    i, j = (np.clip(at - side // 2, 0, count - 1) for at, count in ((p, m), (q, n)))
    i = np.maximum(i, p - side + 2)
    middle = (n + side - 1) // 2
    along_x = steps[0][i, j, p - i, q - j][:, middle : middle + 1]
    p, q = np.arange(m + side - 1)[:, None], np.arange(n + side - 2)
    i, j = (np.clip(at - side // 2, 0, count - 1) for at, count in ((p, m), (q, n)))
    j = np.maximum(j, q - side + 2)
    along_y = steps[1][i, j, p - i, q - j]
    d = _summed(along_x, 0) + _summed(along_y.T, middle).T
    return np.asarray(signs * (d - d.mean()))


def _found(mesh: Grid, ordinates: Floats) -> Floats:
    """Coefficients by steps from cell to cell.

    On a line between two cells the spline's side is (h' c + h c') / (h + h'). With the null
    spline's signs and sides, c = (-1)^(i + j) h_i k_j d, that is a difference of two d.
    """
    m, n = mesh.shape
    h, k = ghosted_sides(mesh.x), ghosted_sides(mesh.y)
    cells = ordinates.reshape(m, n, 8)
    x_sides = np.concatenate([cells[:, :, 7], cells[-1:, :, 5]])  # (m + 1, n)
    y_sides = np.concatenate([cells[:, :, 4], cells[:, -1:, 6]], axis=1)  # (m, n + 1)
    signs = (-1.0) ** np.add.outer(np.arange(m + 2), np.arange(n + 2))
    x_steps, y_steps = 1.0 / h[:-1] + 1.0 / h[1:], 1.0 / k[:-1] + 1.0 / k[1:]
    along_x = -signs[:-1, 1:-1] * x_sides * x_steps[:, None] / k[1:-1]
    along_y = -signs[1:-1, :-1] * y_sides * y_steps / h[1:-1, None]
    # From the largest cell: d grows toward small ones, and so does the rounding of its steps.
    i, j = int(np.argmax(h[1:-1])), int(np.argmax(k[1:-1]))
    d = np.zeros((m + 2, n + 2))
    d[1:-1, 1:-1] = _summed(along_x[1:-1, j : j + 1], i) + _summed(along_y[:, 1:-1].T, j).T
    d[1:-1, 0], d[1:-1, -1] = d[1:-1, 1] - along_y[:, 0], d[1:-1, -2] + along_y[:, -1]
    d[0, 1:-1], d[-1, 1:-1] = d[1, 1:-1] - along_x[0], d[-2, 1:-1] + along_x[-1]
    # The ring's corners are only in the ordinates at the domain's corners, which are the mean of
    # the side at the corner and the one beyond it.
    for i, corner in ((0, (0, 2)), (-1, (1, 3))):
        for j, place in ((0, corner[0]), (-1, corner[1])):
            beyond = 2.0 * cells[i, j, place] - x_sides[i, j]
            step = signs[0 if i == 0 else -2, j] * beyond * x_steps[i] / k[j]
            d[i, j] = d[1, j] + step if i == 0 else d[-2, j] - step
    null = signs * np.multiply.outer(h, k)
    result = null * d
    return np.asarray(result - null * (np.sum(null * result) / np.sum(null * null)))


def _summed(steps: Floats, start: int) -> Floats:
    """What is zero at row ``start`` and has these differences, (n - 1, k) to (n, k)."""
    after = np.cumsum(steps[start:], axis=0)
    before = -np.cumsum(steps[:start][::-1], axis=0)[::-1]
    return np.concatenate([before, np.zeros((1, steps.shape[1])), after])
