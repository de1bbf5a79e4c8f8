"""A shape from samples on a grid: where any function of the plane is below a level.

samples ──a cell around each──> coefficients ──> C¹ quadratic spline ──level set──> arcs ──> shape

What the function is beside the level does not matter: its slope may be anything but zero there.
From the shape on all is exact, so this is how a level set that lost its slope becomes a distance
again.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, as_floats, finite
from splinesdf.meshes import Grid
from splinesdf.shapes.shape import Shape
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.tensor import tensor_ordinates
from splinesdf.splines.spline import SplineSDF

# Nodes that are off equal steps by more than this share of one, and by more than the last place of
# their coordinates, are not equal. Larger: the level set is moved by as much; smaller: coordinates
# with seven printed digits are refused.
_EQUAL = 1e-6
# Steps of fewer units in the last place of the coordinates are refused. Fewer: cells around the
# nodes have no width; more: grids of thousands of nodes are refused where their shapes are not.
_FEWEST_UNITS = 1024.0
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
        Its notes say where parts, holes or necks are too narrow for the grid: the samples at nodes
        have a side there that the curve has not, or the other way round, nor have the nodes around.

    Raises
    ------
    InputError
        If a value is not finite, the steps are not equal, nothing is below the level, or what is
        reaches the border of the grid, or is narrower than the grid can show.

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
    level = finite(level, "level")
    if not (samples < level).any():
        raise InputError(f"expected values below the level {level:g}, got none")
    below = _above_zero(samples.T, level)
    border = np.concatenate([below[[0, -1]].ravel(), below[:, [0, -1]].ravel()])
    if (border <= 0.0).any():
        raise InputError(
            "expected values above the level all along the border of the grid, got others: what "
            "is inside must end within it, so add rows and columns"
        )
    coefficients = _coefficients(below)
    spline = SplineSDF(_grid(lines), tensor_ordinates(_grid(lines), coefficients))
    contours = spline.contours(0.0)
    if not all(contour.closed for contour in contours):
        raise InputError(
            "expected a level set that is closed within the grid, got one that reaches its border: "
            "add rows and columns of values above the level"
        )
    if not contours:
        raise InputError(
            "expected a region below the level of some steps of the grid, got one narrower than "
            "it can show: sample it finer"
        )
    shape = Shape.from_contours(contours, name=name)
    return replace(shape, notes=(*shape.notes, *_narrow(below, coefficients, lines)))


def _line(values: ArrayLike, key: str) -> Floats:
    line = as_floats(values, key)
    if line.ndim != 1 or len(line) < 4:
        raise InputError(f"expected at least four nodes {key} in a row, got shape {line.shape}")
    steps = np.diff(line)
    if not np.isfinite(line).all() or not (steps > 0.0).all():
        raise InputError(f"expected increasing nodes {key}")
    largest = np.abs(line).max()
    if steps.mean() < _FEWEST_UNITS * np.spacing(largest):
        raise InputError(
            f"expected nodes {key} at steps that coordinates of {largest:g} can show, got "
            f"{steps.mean():.3g}: move them nearer to the origin"
        )
    off = float(np.abs(line - np.linspace(line[0], line[-1], len(line))).max())
    # What single precision rounded is known to its own last place.
    single = isinstance(values, np.ndarray) and values.dtype == np.float32
    rounding = np.spacing(largest.astype(np.float32) if single else largest)
    if off > max(_EQUAL * steps.mean(), rounding):
        raise InputError(
            f"expected nodes {key} in equal steps, got steps from {steps.min():.6g} to "
            f"{steps.max():.6g}, and one node {off:.2g} beside its place"
        )
    return line


def _above_zero(samples: Floats, level: float) -> Floats:
    """Samples less the level, times a power of two, so that sums of them stay within the floats."""
    power = int(np.frexp(max(float(np.abs(samples).max()), abs(level)))[1])
    return np.asarray(np.ldexp(samples, -power) - np.ldexp(level, -power))


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
    """One more value at each end of axis 0, on the parabola through the last three.

    Where that would fall to the level, beside a mask's edge two nodes from the border, the last one
    again: what is below the level ends within the grid.
    """
    first = 3.0 * values[0] - 3.0 * values[1] + values[2]
    last = 3.0 * values[-1] - 3.0 * values[-2] + values[-3]
    first = np.where(first > 0.0, first, values[0])
    last = np.where(last > 0.0, last, values[-1])
    return np.concatenate([first[None], values, last[None]])


def _narrow(samples: Floats, coefficients: Floats, lines: list[Floats]) -> tuple[str, ...]:
    """A note on nodes where spline and samples have other sides, and no node around has theirs.

    A curve that is a little off changes the side of nodes beside it, but then a neighbor is on the
    side they have lost. So what is told are parts and holes that vanish or come from nowhere.
    """
    beside = coefficients[:-2, 1:-1] + coefficients[2:, 1:-1]
    beside += coefficients[1:-1, :-2] + coefficients[1:-1, 2:]
    found = 0.5 * coefficients[1:-1, 1:-1] + 0.125 * beside
    lost = np.zeros(samples.shape, dtype=np.bool_)
    for one, other in ((samples, found), (found, samples)):
        lost |= (one < 0.0) & ~_around(other < 0.0)
        lost |= (one > 0.0) & ~_around(other > 0.0)
    if not lost.any():
        return ()
    count, (i, j) = np.count_nonzero(lost), np.argwhere(lost)[0]
    return (
        f"narrower than the grid can show at {count} nodes, as at ({lines[0][i]:g}, "
        f"{lines[1][j]:g}): parts or holes may be missing or surplus there; sample it finer",
    )


def _around(mask: Bools) -> Bools:
    """Whether a node or one of the eight around it is in the mask."""
    for axis in (0, 1):
        rows = np.moveaxis(mask, axis, 0)
        wide = rows.copy()
        wide[1:] |= rows[:-1]
        wide[:-1] |= rows[1:]
        mask = np.moveaxis(wide, 0, axis)
    return mask
