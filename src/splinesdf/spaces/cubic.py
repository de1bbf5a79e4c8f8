"""The cubic element: the box spline M₂₂₁ on cells cut by the diagonal from SW to NE, C¹.

It is C² across the diagonals, so that both cubics of a cell differ by one cubed truncated power. A
cell is the ten ordinates of the triangle below the diagonal and that of the corner NW:

    10 ─  ·  ─  ·  ─  9        corners SW, SE, NE of the triangle below are the ordinates 0, 6, 9
    │                 │        (the order of `element.indices`); those above follow, but for NW
    ·     ·     5     8
    │                 │
    ·     2     4     7
    │                 │
    0 ─   1  ─  3  ─  6

All of these splines have the order 3, one less than their degree: for cubics on this mesh that is
the best there is (de Boor and Höllig). The operator S reproduces all quadratics.

References
----------
[Wang2014] Section 8 names the space S₃¹; de Boor, Höllig and Riemenschneider, Box Splines (1993).
"""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.spaces.element import Element, Operator, indices, reparametrized

# Six times the B-spline's ordinates in the 3 x 3 cells of its support, i outside, j inside: below
# the diagonal (SW SE NE) and above it (SW NE NW).
_BELOW_AND_ABOVE = (
    ((0, 0, 0, 0, 0, 0, 0, 0, 1, 2), (0, 0, 0, 0, 0, 0, 2, 1, 0, 0)),
    ((0, 0, 0, 1, 1, 1, 2, 3, 2, 1), (0, 0, 0, 1, 0, 0, 1, 0, 0, 0)),
    ((0, 0, 0, 0, 0, 0, 1, 0, 0, 0), (0, 0, 0, 0, 0, 0, 0, 0, 0, 0)),
    ((0, 0, 0, 0, 0, 1, 0, 0, 0, 1), (0, 0, 0, 1, 1, 1, 1, 2, 3, 2)),
    ((2, 3, 4, 2, 4, 4, 1, 2, 3, 2), (2, 4, 3, 4, 4, 2, 2, 3, 2, 1)),
    ((1, 2, 1, 3, 1, 0, 2, 1, 0, 0), (1, 1, 0, 0, 0, 0, 0, 0, 0, 0)),
    ((0, 0, 0, 0, 0, 0, 0, 0, 0, 0), (0, 0, 0, 0, 0, 0, 0, 0, 0, 1)),
    ((1, 0, 1, 0, 0, 0, 0, 0, 0, 0), (1, 1, 2, 0, 1, 3, 0, 0, 1, 2)),
    ((2, 1, 0, 0, 0, 0, 0, 0, 0, 0), (2, 0, 1, 0, 0, 0, 0, 0, 0, 0)),
)
_DEGREE = 3
# Above the diagonal (SW NE NW), the ordinate at NW, and the two beside it.
NORTHWEST = indices(_DEGREE).index((0, 0, 3))
BESIDE = tuple(indices(_DEGREE).index(index) for index in ((1, 0, 2), (0, 1, 2)))


def _from_coefficients() -> Floats:
    """In a cell the B-spline of neighbor (a, b) is what it is in cell (1 - a, 1 - b) of its 9."""
    columns = [
        (*_BELOW_AND_ABOVE[8 - k][0], _BELOW_AND_ABOVE[8 - k][1][NORTHWEST]) for k in range(9)
    ]
    return np.array(columns, dtype=np.float64).T / 6.0


def to_ordinates(own: tuple[int, ...]) -> Floats:
    """From the ordinates below the diagonal, and those above it that are not given by these."""
    below = np.hstack([np.eye(10), np.zeros((10, len(own)))])
    # Above, the cubic from below goes on, but for its own ordinates.
    above = reparametrized(_DEGREE, np.array([(1, 0, 0), (0, 0, 1), (1, -1, 1)])) @ below
    above[list(own)] = np.eye(len(own), 10 + len(own), 10)
    return on_four_triangles(_DEGREE, below, above)


def on_four_triangles(degree: int, below: Floats, above: Floats) -> Floats:
    """Ordinates of S E N W from those below and above the diagonal, each (ordinates, k)."""
    # S, E in corners SW SE NE and N, W in corners SW NE NW; the center is halfway on the diagonal.
    south = np.array([(1, 0, 0), (0, 1, 0), (0.5, 0, 0.5)])
    east = np.array([(0, 1, 0), (0, 0, 1), (0.5, 0, 0.5)])
    north = np.array([(0, 1, 0), (0, 0, 1), (0.5, 0.5, 0)])
    west = np.array([(0, 0, 1), (1, 0, 0), (0.5, 0.5, 0)])
    return np.stack(
        [
            reparametrized(degree, corners) @ matrix
            for corners, matrix in ((south, below), (east, below), (north, above), (west, above))
        ]
    )


def _mask() -> Floats:
    """For each parity of a child, padded by places of weight 0."""
    even = [(0, 0, 5), (-1, 0, 1), (0, -1, 1), (-1, -1, 1)]
    upper = [(0, 0, 4), (0, 1, 2), (-1, 0, 2), (0, 0, 0)]
    right = [(0, 0, 4), (1, 0, 2), (0, -1, 2), (0, 0, 0)]
    odd = [(0, 0, 5), (1, 0, 1), (0, 1, 1), (1, 1, 1)]
    return np.array([even, upper, right, odd]) / (1.0, 1.0, 8.0)


CUBIC = Element(
    name="cubic",
    bspline="M2210",
    degree=_DEGREE,
    from_coefficients=_from_coefficients(),
    to_ordinates=to_ordinates((NORTHWEST,)),
    mask=_mask(),
    operators={
        "S": Operator(
            ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1)),
            (17 / 12, -1 / 12, -1 / 12, -1 / 12, -1 / 12, -1 / 24, -1 / 24),
        ),
        "V": Operator(((0, 0),), (1.0,)),
    },
    defaults={"given": "S", "bands": "S", "everywhere": "S"},
    spaces=("uniform",),
)
