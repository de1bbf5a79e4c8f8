"""Quasi-interpolants: from a function to a spline, with no linear system.

A coefficient is a few samples of the function, weighted: the operators of `splinesdf.spaces`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from splinesdf.ground.arrays import Floats, whole
from splinesdf.meshes import Grid, Mesh
from splinesdf.spaces.element import Element
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.space import interpolated, space_on
from splinesdf.spaces.tensor import bspline_coefficients, tensor_ordinates
from splinesdf.splines.spline import SplineSDF

Function = Callable[[Floats], Floats]


def quasi_interpolate(
    function: Function, mesh: Mesh, operator: str | None = None, element: Element = QUADRATIC
) -> SplineSDF:
    """The spline that a quasi-interpolant makes of a function.

    Parameters
    ----------
    function : callable
        Values (n,) at points (n, 2). It is asked up to two cells beyond the domain.
    mesh : Grid or Quadtree
    operator : str, optional
        A name of the element's: V, W (the default), S or P of the quadratic one. S and P need
        square-symmetric neighbors: a uniform grid or a quadtree.
    element : Element

    Raises
    ------
    InputError
        If the operator is unknown or does not fit the mesh, or the element does not.

    References
    ----------
    [Wang2014] Section 3 (V, W); Sablonnière (S); [Speleers2016] for the quadtree.
    """
    operator = element.defaults["given"] if operator is None else operator
    numbers = interpolated(space_on(mesh, element), function, operator)
    return SplineSDF(mesh, numbers, element=element)


def bspline(mesh: Grid, i: int, j: int, element: Element = QUADRATIC, family: int = 0) -> SplineSDF:
    """The B-spline of cell (i, j) of a grid, -1 and m, n being the ring around the domain.

    The quadratic one is positive inside an octagon in the 3 x 3 cells around (i, j). That of the
    quartic element, whose ring goes to m + 1, n + 1, has its center in the cell's lower left
    corner, and is positive inside the 4 x 4 cells around that less half a cell in each corner. All
    of a family of an element sum to one.

    Parameters
    ----------
    mesh : Grid
    i, j : int
    element : Element
    family : int
        Which of the element's, from 0 on; only S31 has three.

    References
    ----------
    [Wang2014] Theorem 5 and the 41 values after it.
    """
    first, families = -element.before, len(element.centers)
    family = whole(family, "family", least=0, most=families - 1)
    if "tensor" in element.spaces:
        return SplineSDF(mesh, tensor_ordinates(mesh, bspline_coefficients(mesh, i, j)))
    space = space_on(mesh, element)
    last_i, last_j = (int(last) for last in space.places.max(axis=0))
    i, j = whole(i, "i", least=first, most=last_i), whole(j, "j", least=first, most=last_j)
    coefficients = np.zeros(len(space.places))
    here = np.all(space.places == (i, j), axis=1) & (space.family == family)
    coefficients[here] = families  # as their mean is taken
    return SplineSDF(mesh, space.numbers(coefficients), element=element)
