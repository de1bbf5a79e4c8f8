"""The numbers of a spline as shaders read them: float32, four a texel, in whole rows.

    cells ──power form, float32──> two texels a cell, or four ┐
    mesh ──lines, or nodes of the tree──> four numbers a texel ┴──> table (rows, 2048, 4)
                                                where these begin ──> text of a function

The numbers are in a texture or a buffer, as compilers take seconds for some hundred cells in the
text. A shader has float32 and no doubles, so places within a cell are found by halving shares of a
root cell, which float32 does exactly; what is left is the rounding of the point itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.glsl import corners
from splinesdf.meshes import Grid, Quadtree

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF

# Texels in a row of the table, and rows: the size of texture that all of WebGL2 has. More: a phone
# refuses the table; fewer: fits that would do are refused. It is room for 1.8 million
# cells, quartic ones half as many.
WIDE, _HIGH = 2048, 2048


class ShaderTable(NamedTuple):
    """A table for a shader, and how its text finds a cell in it.

    Attributes
    ----------
    table : ndarray of float32, shape (rows, 2048, 4)
    first : int
        Texel at which the numbers of the index begin, after two (degree 4: four) for each cell.
    way : {"tree", "equal", "lines"}
        Nodes of a quadtree, equal cells (no numbers), or the lines of a grid.
    counts : (int, int)
        Root cells each way.
    depth : int
        Halvings at most.
    """

    table: NDArray[np.float32]
    first: int
    way: Literal["tree", "equal", "lines"]
    counts: tuple[int, int]
    depth: int


def shader_table(spline: SplineSDF) -> ShaderTable:
    """The table of a spline, or an `InputError` if float32 or a texture does not hold it."""
    if spline.element.power_form is None:
        raise InputError(
            f"expected a quadratic or quartic spline for shaders, got a {spline.element.name} one"
        )
    mesh, powers = spline.mesh, spline.element.table(spline.ordinates)
    # Fifteen numbers of the quartic element and a zero.
    powers = np.pad(powers, [(0, 0), (0, -powers.shape[1] % 4)])
    assert isinstance(mesh, Grid | Quadtree)
    corners(mesh.domain)  # refuses what is too far from the origin
    depth, numbers = 0, np.empty(0)
    way: Literal["tree", "equal", "lines"] = "equal"
    if isinstance(mesh, Quadtree):
        way, depth = "tree", mesh.depth
        numbers = np.where(mesh.child >= 0, mesh.child, -1 - mesh.cell_of).astype(np.float64)
    elif not mesh.is_uniform:
        way, numbers = "lines", np.concatenate([_lines(mesh.x, "x"), _lines(mesh.y, "y")])
    return ShaderTable(_table(powers, numbers), powers.size // 4, way, mesh.shape, depth)


def _lines(lines: Floats, axis: str) -> Floats:
    if np.any(np.diff(lines.astype(np.float32)) <= 0.0):
        raise InputError(
            f"expected grid lines {axis} that float32 tells apart, got steps of "
            f"{np.diff(lines).min():.3g}: move the shape nearer to the origin"
        )
    return lines


def _table(powers: Floats, numbers: Floats) -> NDArray[np.float32]:
    """The texels of the cells, then four numbers a texel, in whole rows."""
    count = powers.size // 4 + -(-len(numbers) // 4)
    rows = -(-count // WIDE)
    if rows > _HIGH:
        raise InputError(
            f"expected a spline of at most {WIDE * _HIGH:,} texels for a shader, got {count:,}: "
            "raise the fit's tolerance, or give it a band"
        )
    flat = np.zeros(4 * rows * WIDE)
    flat[: powers.size] = powers.reshape(-1)
    flat[powers.size : powers.size + len(numbers)] = numbers
    with np.errstate(over="ignore"):
        table = flat.astype(np.float32).reshape(rows, WIDE, 4)
    if not np.isfinite(table).all():
        raise InputError("expected a spline whose numbers float32 can hold, got one beyond 3e38")
    return table
