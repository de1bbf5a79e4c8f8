"""A shape from samples on a grid: where any function of the plane is below a level.

samples ──a cell around each──> coefficients ──> C¹ quadratic spline ──level set──> arcs ──> shape

What the function is beside the level does not matter: its slope may be anything but zero there.
From the shape on all is exact, so this is how a level set that lost its slope becomes a distance
again.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, as_floats, finite
from splinesdf.meshes import Grid
from splinesdf.shapes.shape import Shape
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.tensor import tensor_ordinates
from splinesdf.splines.spline import SplineSDF

# Steps of a grid that differ by more than this share of one are not equal: what coordinates with a
# few printed digits differ by is less. Larger: the level set is moved by as much.
_EQUAL = 1e-6
# Samples beyond the grid that are continued from it on each side: one for the ring of cells around
# the domain, one for their neighbors.
_BEYOND = 2


def from_level_set(
    values: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    *,
    level: float = 0.0,
    name: str = "",
) -> Shape:
    """The region where samples of a function on a grid are below a level.

    The samples become the C¹ quadratic quasi-interpolant S, which reproduces quadratic functions
    and is within h³ of smooth ones, h the step; its level set consists of conic arcs, exactly. It
    lies off the function's own by about that error over the slope. Of a mask, or any function that
    jumps, it is a smooth curve within a step of where it jumps.

    Parameters
    ----------
    values : array_like, shape (ny, nx)
        ``values[j, i]`` at (x[i], y[j]), as `splinesdf.signed_distance_grid` has them.
    x, y : array_like, shapes (nx,), (ny,)
        Increasing, in equal steps; at least four each. Steps in x and y may differ.
    level : float
    name : str

    Returns
    -------
    Shape

    Raises
    ------
    InputError
        If a value is not finite, the steps are not equal, nothing is below the level, or what is
        reaches the border of the grid.

    Examples
    --------
    >>> import numpy as np, splinesdf as ss
    >>> x = y = np.linspace(-2.0, 2.0, 41)
    >>> phi = np.add.outer(y**2, x**2) - 1.0  # a circle, but no distance
    >>> shape = ss.from_level_set(phi, x, y)
    >>> float(np.round(ss.signed_distance(shape, (0.5, 0.0)), 9))
    -0.5
    """
    samples, lines = as_floats(values, "values"), [_line(x, "x"), _line(y, "y")]
    wanted = len(lines[1]), len(lines[0])
    if samples.shape != wanted:
        raise InputError(f"expected values of shape {wanted}, one a node, got {samples.shape}")
    if not np.isfinite(samples).all():
        raise InputError("expected finite values, got NaN or infinity: fill or cut them off")
    below = samples.T - finite(level, "level")
    if not (below < 0.0).any():
        raise InputError(f"expected values below the level {level:g}, got none")
    border = np.concatenate([below[[0, -1]].ravel(), below[:, [0, -1]].ravel()])
    if (border <= 0.0).any():
        raise InputError(
            "expected values above the level all along the border of the grid, got others: what "
            "is inside must end within it, so add rows and columns"
        )
    spline = SplineSDF(_grid(lines), tensor_ordinates(_grid(lines), _coefficients(below)))
    contours = spline.contours(0.0)
    if not contours or not all(contour.closed for contour in contours):
        raise InputError("expected a level set that is closed within the grid, got another")
    return Shape.from_contours(contours, name=name)


def _line(values: ArrayLike, key: str) -> Floats:
    line = as_floats(values, key)
    if line.ndim != 1 or len(line) < 4:
        raise InputError(f"expected at least four nodes {key} in a row, got shape {line.shape}")
    steps = np.diff(line)
    if not np.isfinite(line).all() or not (steps > 0.0).all():
        raise InputError(f"expected increasing nodes {key}")
    if np.ptp(steps) > _EQUAL * steps.mean():
        raise InputError(
            f"expected nodes {key} in equal steps, got from {steps.min():.6g} to {steps.max():.6g}"
        )
    return line


def _grid(lines: list[Floats]) -> Grid:
    """Cells around the nodes."""
    edges = []
    for line in lines:
        half = 0.5 * (line[-1] - line[0]) / (len(line) - 1)
        edges.append(np.linspace(line[0] - half, line[-1] + half, len(line) + 1))
    return Grid(edges[0], edges[1])


def _coefficients(samples: Floats) -> Floats:
    """Those of the cells around the nodes and of a ring around them, by the operator S."""
    wide = samples
    for axis in (0, 1):
        for _ in range(_BEYOND):
            wide = _continued(np.moveaxis(wide, axis, 0))
            wide = np.moveaxis(wide, 0, axis)
    result = np.zeros((wide.shape[0] - 2, wide.shape[1] - 2))
    operator = QUADRATIC.operators["S"]
    for (a, b), weight in zip(operator.offsets, operator.weights, strict=True):
        i, j = 1 + int(a), 1 + int(b)
        result += weight * wide[i : i + result.shape[0], j : j + result.shape[1]]
    return result


def _continued(values: Floats) -> Floats:
    """One more value at each end of axis 0, on the parabola through the last three."""
    first = 3.0 * values[0] - 3.0 * values[1] + values[2]
    last = 3.0 * values[-1] - 3.0 * values[-2] + values[-3]
    return np.concatenate([first[None], values, last[None]])
