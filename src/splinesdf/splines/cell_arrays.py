"""The cells of a quadratic spline and the index that finds them, as arrays for other programs.

    p ──x, y──> root (i, j) ──child──> ... ──child──> cell ──cells──> a0 ... a7 ──s, t──> value

A grid is a tree of roots only, so one evaluator does for all; docs/howto/elsewhere.md has one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.meshes import Grid, Quadtree

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF


def to_arrays(spline: SplineSDF) -> dict[str, NDArray[Any]]:
    """All that evaluates the spline, as arrays: its cells and the index that finds them.

    Returns
    -------
    dict of ndarray
        ``low``, ``high`` : (2,)
            The domain's corners.
        ``x``, ``y`` : (m + 1,), (n + 1,)
            Lines between the root cells, measured from ``low``.
        ``child`` : (nodes,), int64
            Root (i, j) is node ``i * n + j``. A node is either halved both ways, and this is the
            first of its children SW, NW, SE, NE, which follow one another; or it is a cell, and
            this is ``-1 - cell``.
        ``cells`` : (n_cells, 8)
            With s and t from -1/2 to 1/2 across a cell, its value is ``a0 + a1 s + a2 t + a3 s² +
            a4 s t + a5 t² + a6 max(s - t, 0)² + a7 max(s + t, 0)²``.

        They are new at each call, and ``numpy.savez`` takes them: ``savez(path, **arrays)``.

    Raises
    ------
    InputError
        If the spline is cubic.

    Examples
    --------
    >>> import splinesdf as ss
    >>> arrays = ss.interpolate(ss.example("gamma1"), (3, 2)).spline.to_arrays()
    >>> {name: array.shape for name, array in arrays.items()}
    {'low': (2,), 'high': (2,), 'x': (4,), 'y': (3,), 'child': (6,), 'cells': (6, 8)}
    """
    if spline.element.degree != 2:
        raise InputError(f"expected a quadratic spline, got a {spline.element.name} one")
    mesh = spline.mesh
    assert isinstance(mesh, Grid | Quadtree)
    low, high = np.reshape(np.array(mesh.domain, dtype=np.float64), (2, 2))
    if isinstance(mesh, Quadtree):
        child = np.where(mesh.child >= 0, mesh.child, -1 - mesh.cell_of)
        x, y = (
            side * np.arange(count + 1.0)
            for side, count in zip(mesh.side(0), mesh.shape, strict=True)
        )
    else:
        child = -1 - np.arange(mesh.cell_count)
        x, y = mesh.x - mesh.x[0], mesh.y - mesh.y[0]
    cells: Floats = np.array(spline.element.table(spline.ordinates), order="C")
    return {"low": low, "high": high, "x": x, "y": y, "child": child, "cells": cells}
