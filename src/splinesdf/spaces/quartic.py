"""The quartic element: the box spline M₂₂₁₁ on a criss-cross mesh, C², and C³ across diagonals.

There is one B-spline for each vertex, over the 4 x 4 cells around it but for half a cell in each
corner; it belongs to the cell at whose lower left corner the vertex is:

    ·   ·   ·   ·          the coefficients at the 4 x 4 vertices around a cell
    ·   o───o   ·          make its numbers
    ·   V───o   ·
    ·   ·   ·   ·

A cell is the 15 numbers of its power form, with s, t from its center in cells:

    q00 + q10 s + q01 t + q20 s² + q11 s t + q02 t² + q30 s³ + q21 s² t + q12 s t² + q03 t³
        + q31 s³ t + q13 s t³ + γ ((s + t)⁴ + (s - t)⁴) + α (s - t)₊⁴ + β (s + t)₊⁴

Quartics of this kind have two numbers more; all splines of these B-splines have q40 = q04 and
q22 = 6 q04. The splines have the order 4, which is the most that local functionals reach, although
quartics are in the space. Its quasi-interpolants, from samples at vertices:

    V: 1     C:       -1/6          D: -1/12  ·  -1/12    O:              7/240
                 -1/6  5/3  -1/6         ·   4/3   ·           23/720  -25/72  23/720
                      -1/6             -1/12  ·  -1/12   7/240 -25/72  193/90 -25/72  7/240 ...

V reproduces 1, x, y, xy; C, D and O all cubics, across the levels of a quadtree as well. O has the
least error of them, a twentieth of C's.

References
----------
[Wang2014] Section 8 names the space S₄²; de Boor, Höllig and Riemenschneider, Box Splines (1993).
"""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.spaces.element import CORNERS, Element, Operator, bernstein, monomials

_DEGREE = 4
# 96 times the numbers of a cell from the coefficients at the vertices around it, those below
# first in each of the columns from left to right.
_NUMBERS = (
    (0, 1, 1, 0, 1, 22, 22, 1, 1, 22, 22, 1, 0, 1, 1, 0),
    (0, -6, -6, 0, -2, -28, -28, -2, 2, 28, 28, 2, 0, 6, 6, 0),
    (0, -2, 2, 0, -6, -28, 28, 6, -6, -28, 28, 6, 0, -2, 2, 0),
    (0, 12, 12, 0, 0, -12, -12, 0, 0, -12, -12, 0, 0, 12, 12, 0),
    (0, 12, -12, 0, 12, 24, -24, -12, -12, -24, 24, 12, 0, -12, 12, 0),
    (0, 0, 0, 0, 12, -12, -12, 12, 12, -12, -12, 12, 0, 0, 0, 0),
    (0, -8, -8, 0, 0, 24, 24, 0, 0, -24, -24, 0, 0, 8, 8, 0),
    (0, -24, 24, 0, 0, 24, -24, 0, 0, 24, -24, 0, 0, -24, 24, 0),
    (0, 0, 0, 0, -24, 24, 24, -24, 24, -24, -24, 24, 0, 0, 0, 0),
    (0, 0, 0, 0, -8, 24, -24, 8, -8, 24, -24, 8, 0, 0, 0, 0),
    (8, -8, 8, -8, -16, 0, 0, 16, 8, 24, -24, -8, 0, -16, 16, 0),
    (8, -24, 24, -8, 0, 0, 0, 0, -8, 24, -24, 8, 0, 0, 0, 0),
    (1, -1, -1, 1, -2, 2, 2, -2, 1, -1, -1, 1, 0, 0, 0, 0),
    (0, -2, 4, -2, 2, 0, -6, 4, -4, 6, 0, -2, 2, -4, 2, 0),
    (-2, 4, -2, 0, 4, -6, 0, 2, -2, 0, 6, -4, 0, 2, -4, 2),
)
# Powers of s and t that the first twelve numbers go with.
_POWERS = (
    (0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (3, 1), (1, 3)
)  # fmt: skip
# (s - t)⁴ and (s + t)⁴ by powers.
_FALLING = {(4, 0): 1.0, (3, 1): -4.0, (2, 2): 6.0, (1, 3): -4.0, (0, 4): 1.0}
_RISING = {power: abs(value) for power, value in _FALLING.items()}
# Triangles S E N W in which s - t, and s + t, are positive.
_RIGHT, _LEFT = (1.0, 1.0, 0.0, 0.0), (0.0, 1.0, 1.0, 0.0)
# 16 times the fine coefficients of one coarse one, by steps from -2 to 2 in both directions.
_MASK = ((0, 1, 2, 1, 0), (1, 4, 6, 4, 1), (2, 6, 8, 6, 2), (1, 4, 6, 4, 1), (0, 1, 2, 1, 0))


def power_form(numbers: Floats) -> Floats:
    """What `splinesdf.spaces.kernels.quartics` reads is what a cell is."""
    return np.ascontiguousarray(numbers)


def _to_ordinates() -> Floats:
    order = {power: k for k, power in enumerate(monomials(_DEGREE))}
    result = np.zeros((4, len(order), len(_NUMBERS)))
    for matrix, corners, right, left in zip(result, CORNERS, _RIGHT, _LEFT, strict=True):
        powers = np.zeros_like(matrix)
        for column, power in enumerate(_POWERS):
            powers[order[power], column] = 1.0
        for power, k in order.items():
            falling, rising = _FALLING.get(power, 0.0), _RISING.get(power, 0.0)
            powers[k, 12:] = falling + rising, right * falling, left * rising
        # All of them are multiples of 1/384.
        exact = np.linalg.solve(bernstein(_DEGREE, corners).T, powers)
        matrix[:] = np.round(384.0 * exact) / 384.0
    return result


def _mask() -> Floats:
    """For each parity of a vertex, padded by places of weight 0."""
    result = np.zeros((4, 6, 3))
    for parity, rows in enumerate(result):
        i, j = divmod(parity, 2)
        steps = [
            ((i - a) // 2, (j - b) // 2, _MASK[a + 2][b + 2] / 16.0)
            for a in range(-2, 3)
            for b in range(-2, 3)
            if (i - a) % 2 == 0 and (j - b) % 2 == 0 and _MASK[a + 2][b + 2]
        ]
        rows[: len(steps)] = steps
    return result


_CENTER = ((0.0, 0.0),)
_NEIGHBORS = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
_DIAGONAL = ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0))
_SECOND = ((2.0, 0.0), (-2.0, 0.0), (0.0, 2.0), (0.0, -2.0))

QUARTIC = Element(
    name="quartic",
    bspline="M2211",
    degree=_DEGREE,
    from_coefficients=np.array(_NUMBERS) / 96.0,
    to_ordinates=_to_ordinates(),
    mask=_mask(),
    operators={
        "O": Operator(
            _CENTER + _NEIGHBORS + _DIAGONAL + _SECOND,
            (193 / 90, *4 * (-25 / 72,), *4 * (23 / 720,), *4 * (7 / 240,)),
        ),
        "C": Operator(_CENTER + _NEIGHBORS, (5 / 3, *4 * (-1 / 6,))),
        "D": Operator(_CENTER + _DIAGONAL, (4 / 3, *4 * (-1 / 12,))),
        "V": Operator(_CENTER, (1.0,)),
    },
    defaults={"given": "O", "bands": "O", "everywhere": "O"},
    spaces=("hierarchical", "uniform"),
    centers=((0.0, 0.0),),
    power_form=power_form,
)
