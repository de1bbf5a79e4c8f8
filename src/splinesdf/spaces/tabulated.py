"""Elements that are no more than a table: exact ordinates of box splines in a file of data.

A cell of M222 or M1122 is the coefficients of the B-splines that reach it; the numbers of a cell of
S31, the mean of three families of cubics, are those of the `cubic` and two more. They are here to
compare with, on uniform grids only: polynomials are evaluated triangle by triangle.

    M222     quartics, C², cells cut by one diagonal, one B-spline a vertex; order 4
    M1122    quartics, C², C³ across grid lines, cells cut by both, one B-spline a cell; order 4
    S31      cubics, C¹, cells cut by one diagonal: M₂₂₁, M₂₁₂ and M₁₂₂, whose axes are the three
             directions of the mesh, so that their mean prefers none of them; order 3

References
----------
[Wang2014] Section 8 names the spaces; de Boor, Höllig and Riemenschneider, Box Splines (1993).
"""

from __future__ import annotations

import json
from functools import cache
from importlib import resources

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.spaces import cubic
from splinesdf.spaces.element import Element, Operator

# The ordinates of a B-spline by cells (i, j), as seen from the cell that it belongs to.
_Cells = dict[tuple[int, int], Floats]


@cache
def _table(bspline: str) -> _Cells:
    """Ordinates (4 or 2, ordinates) of a B-spline, on the triangles of its cells."""
    text = (resources.files("splinesdf") / "data" / "box_splines.json").read_text(encoding="utf-8")
    table = json.loads(text)[bspline]
    cells = {}
    for key, ordinates in table["cells"].items():
        i, j = (int(part) for part in key.split(","))
        cells[i, j] = np.array(ordinates, dtype=np.float64) / table["denominator"]
    return cells


def _from_reached(cells: _Cells, before: int, beyond: int) -> Floats:
    """Those of the coefficients around a cell whose B-splines reach it, as a matrix."""
    around = range(-before, beyond + 1)
    reached = [(-a, -b) in cells for a in around for b in around]
    return np.eye(len(reached))[reached]


def _to_ordinates(cells: _Cells, degree: int, before: int, beyond: int) -> Floats:
    """Ordinates of S E N W from the coefficients of the B-splines that reach a cell."""
    around = range(-before, beyond + 1)
    columns = [cells[-a, -b] for a in around for b in around if (-a, -b) in cells]
    table = np.stack(columns, axis=2)
    return table if len(table) == 4 else cubic.on_four_triangles(degree, *table)


def _mean_of_families() -> Floats:
    """The 13 numbers of a cell from the coefficients around it of each of the three families."""
    above = [*cubic.BESIDE, cubic.NORTHWEST]
    columns = [
        np.zeros(13) if cells is None else np.concatenate([cells[0], cells[1][above]])
        for name in ("M2210", "M2120", "M1220")
        for cells in (_table(name).get((-a, -b)) for a in range(-1, 3) for b in range(-1, 3))
    ]
    return np.stack(columns, axis=1) / 3.0


_CENTER = ((0.0, 0.0),)
_AXES = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
_RISING, _FALLING = ((1.0, 1.0), (-1.0, -1.0)), ((1.0, -1.0), (-1.0, 1.0))
_SECOND = ((2.0, 0.0), (-2.0, 0.0), (0.0, 2.0), (0.0, -2.0))
_UNIFORM = ("uniform",)
_V = Operator(_CENTER, (1.0,))
_FAR, _NEAR = 2 * (-1 / 12,), 2 * (-1 / 24,)  # of a family of S31: twice in it, and once

S31 = Element(
    name="S31",
    bspline="M2210 M2120 M1220",
    degree=3,
    from_coefficients=_mean_of_families(),
    to_ordinates=cubic.to_ordinates((*cubic.BESIDE, cubic.NORTHWEST)),
    mask=None,
    operators={
        "S": Operator(
            _CENTER + _AXES + _RISING,
            (17 / 12, *_FAR, *_FAR, *_NEAR),
            others=((17 / 12, *_FAR, *_NEAR, *_FAR), (17 / 12, *_NEAR, *_FAR, *_FAR)),
        ),
        "V": Operator(_CENTER, (1.0,), others=((1.0,), (1.0,))),
    },
    defaults={"given": "S"},
    spaces=_UNIFORM,
    centers=((0.5, 0.5), (0.0, 0.5), (0.5, 0.0)),
)

M222 = Element(
    name="M222",
    bspline="M2220",
    degree=4,
    from_coefficients=_from_reached(_table("M2220"), 1, 2),
    to_ordinates=_to_ordinates(_table("M2220"), 4, 1, 2),
    mask=None,
    operators={
        "O": Operator(
            _CENTER + _AXES + _RISING + _SECOND + ((2.0, 2.0), (-2.0, -2.0)),
            (141 / 80, *6 * (-17 / 120,), *6 * (7 / 480,)),
        ),
        "X": Operator(_CENTER + _AXES + _RISING, (3 / 2, *6 * (-1 / 12,))),
        "V": _V,
    },
    defaults={"given": "O"},
    spaces=_UNIFORM,
    centers=((0.0, 0.0),),
)

M1122 = Element(
    name="M1122",
    bspline="M1122",
    degree=4,
    from_coefficients=_from_reached(_table("M1122"), 2, 2),
    to_ordinates=_to_ordinates(_table("M1122"), 4, 2, 2),
    mask=None,
    operators={
        "O": Operator(
            _CENTER + _AXES + _RISING + _FALLING + _SECOND,
            (3643 / 1440, *4 * (-19 / 40,), *4 * (149 / 2880,), *4 * (47 / 1152,)),
        ),
        "C": Operator(_CENTER + _AXES, (11 / 6, *4 * (-5 / 24,))),
        "D": Operator(_CENTER + _RISING + _FALLING, (17 / 12, *4 * (-5 / 48,))),
        "V": _V,
    },
    defaults={"given": "O"},
    spaces=_UNIFORM,
    before=2,
)
