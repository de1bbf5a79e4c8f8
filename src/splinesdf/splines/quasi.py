"""Quasi-interpolants: from a function to a spline, with no linear system.

A coefficient is a few samples of the function around its cell, weighted:

      V: 1          W: -¼ · -¼        S:    · -⅛ ·         P:  · · -⅛      (here i + j even,
                        ·  2  ·            -⅛ 3/2 -⅛            · 5/4 ·      else the other
                       -¼ · -¼              · -⅛ ·            -⅛ ·  ·       diagonal)
      center        center, corners     neighboring centers    diagonal centers

V reproduces 1, x, y, xy; W, S and P all quadratics, P also across the levels of a quadtree.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.meshes import Grid, Mesh, Quadtree
from splinesdf.spaces import hierarchical_ordinates, tensor_ordinates
from splinesdf.spaces.tensor import ghosted_sides
from splinesdf.splines.spline import SplineSDF

Function = Callable[[Floats], Floats]
Operator = Literal["V", "W", "S", "P"]

# Offsets in cells and weights. Of P the row for i + j even and the row for i + j odd.
_CENTER = ((0.0, 0.0),)
_CORNERS = ((-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5))
_NEIGHBORS = ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0))
STENCILS: dict[str, tuple[tuple[tuple[float, float], ...], tuple[float, ...]]] = {
    "V": (_CENTER, (1.0,)),
    "W": (_CENTER + _CORNERS, (2.0, -0.25, -0.25, -0.25, -0.25)),
    "S": (_CENTER + _NEIGHBORS, (1.5, -0.125, -0.125, -0.125, -0.125)),
    "P": (((0.0, 0.0), (1.0, 1.0), (-1.0, -1.0)), (1.25, -0.125, -0.125)),
}


def quasi_interpolate(function: Function, mesh: Mesh, operator: str = "W") -> SplineSDF:
    """The spline that a quasi-interpolant makes of a function.

    Parameters
    ----------
    function : callable
        Values (n,) at points (n, 2). It is asked up to one and a half cells beyond the domain.
    mesh : Grid or Quadtree
    operator : {"V", "W", "S", "P"}
        S and P need square-symmetric neighbors: a uniform grid or a quadtree.

    Raises
    ------
    InputError
        If the operator is unknown or does not fit the mesh.

    References
    ----------
    [Wang2014] Section 3 (V, W); Sablonnière (S); [Speleers2016] for the quadtree.
    """
    check_operator(operator)
    if isinstance(mesh, Quadtree):
        tree = mesh

        def functional(level: int, cells: Ints) -> Floats:
            return uniform_functional(function, tree, operator, level, cells)

        return SplineSDF(mesh, hierarchical_ordinates(mesh, functional))
    if not isinstance(mesh, Grid):
        raise InputError(f"expected a Grid or a Quadtree, got {type(mesh).__name__}")
    if operator in "SP" and not mesh.is_uniform:
        raise InputError(f"operator {operator} needs equal cells: use W or V on a tensor grid")
    return SplineSDF(mesh, tensor_ordinates(mesh, _grid_coefficients(function, mesh, operator)))


def check_operator(operator: str) -> None:
    """Refuse names that are no operator."""
    if not isinstance(operator, str) or operator not in STENCILS:
        raise InputError(f"expected an operator of V, W, S, P, got {operator!r}")


def uniform_functional(
    function: Function, mesh: Quadtree, operator: str, level: int, cells: Ints
) -> Floats:
    """Coefficients of cells (n, 2) of one level of a quadtree, -> (n,)."""
    if len(cells) == 0:
        return np.empty(0)
    side = mesh.side(level)
    centers = np.array(mesh.domain[:2]) + (cells + 0.5) * side
    return _apply(function, operator, centers, np.broadcast_to(side, centers.shape), cells)


def _grid_coefficients(function: Function, mesh: Grid, operator: str) -> Floats:
    """Coefficients of every cell and of the ring, shape (m + 2, n + 2)."""
    m, n = mesh.shape
    sides = [ghosted_sides(v) for v in (mesh.x, mesh.y)]
    lows = [
        np.concatenate([v[:1] - h[:1], v]) for v, h in zip((mesh.x, mesh.y), sides, strict=True)
    ]
    middles = [low + 0.5 * h for low, h in zip(lows, sides, strict=True)]
    centers = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, 2)
    cell_sides = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)
    index = np.stack(np.meshgrid(np.arange(-1, m + 1), np.arange(-1, n + 1), indexing="ij"), -1)
    values = _apply(function, operator, centers, cell_sides, index.reshape(-1, 2))
    return values.reshape(m + 2, n + 2)


def _apply(
    function: Function, operator: str, centers: Floats, sides: Floats, cells: Ints
) -> Floats:
    offsets, weights = STENCILS[operator]
    result = np.zeros(len(centers))
    mirror = np.ones((len(centers), 2))
    if operator == "P":
        mirror[:, 0] = np.where((cells[:, 0] + cells[:, 1]) % 2 == 0, 1.0, -1.0)
    for offset, weight in zip(offsets, weights, strict=True):
        result += weight * function(centers + np.array(offset) * mirror * sides)
    return result
