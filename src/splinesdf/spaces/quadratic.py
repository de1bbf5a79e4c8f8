"""The quadratic element: the Zwart-Powell element, the box spline M₁₁₁₁, C¹ on a criss-cross mesh.

A cell is the ordinates at its four corners and in the middles of its four sides:

    V2 ──E6── V3       E halfway along a side, D (not stored) halfway along a half-diagonal:
    │ D    D │         the mean of the two E beside that corner;
    E7   C   E5        C (not stored) at the center: the mean of the four E.
    │ D    D │               C
    V0 ──E4── V1          D0    D1        the bottom triangle
                        V0   E4   V1

Its quasi-interpolants, a coefficient as a few weighted samples around its cell:

      V: 1          W: -¼ · -¼        S:    · -⅛ ·         P:  · · -⅛      (here i + j even,
                        ·  2  ·            -⅛ 3/2 -⅛            · 5/4 ·      else the other
                       -¼ · -¼              · -⅛ ·            -⅛ ·  ·       diagonal)
      center        center, corners     neighboring centers    diagonal centers

V reproduces 1, x, y, xy; W, S and P all quadratics, P also across the levels of a quadtree.

References
----------
[Wang2014] Sections 2 and 3 (V, W); Sablonnière (S).
"""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.spaces.element import Element, Operator

# The corners and the side of each triangle S E N W, run so that the center lies to the left: first
# corner, side, second corner; as columns of the ordinates.
TRIANGLES = ((0, 4, 1), (1, 5, 3), (3, 6, 2), (2, 7, 0))
# Columns of the E beside each corner.
_BESIDE = ((4, 7), (4, 5), (6, 7), (5, 6))


def center_ordinates(ordinates: Floats) -> tuple[Floats, Floats]:
    """The ordinates that follow: D beside V0 V1 V2 V3 as (n, 4), and C as (n,)."""
    south, east, north, west = ordinates[:, 4:].T
    beside = np.stack([south + west, south + east, north + west, north + east], axis=1) * 0.5
    return beside, ordinates[:, 4:].mean(axis=1)


def power_form(ordinates: Floats) -> Floats:
    """Coefficients a0 ... a7 of `splinesdf.spaces.kernels.evaluation`, (n, 8)."""
    sw, se, nw, ne = ordinates[:, :4].T
    west = ordinates[:, 7]
    beside, center = center_ordinates(ordinates)
    d_sw, d_nw = beside[:, 0], beside[:, 2]
    # The left triangle (s < -|t|) sees neither truncated power. From its center go p = -(s + t)
    # toward SW and q = t - s toward NW, both from 0 to 1 along a side; there it is
    # C(1-p-q)² + SW p² + NW q² + 2 D_SW p(1-p-q) + 2 D_NW q(1-p-q) + 2 W p q.
    pp, qq = center + sw - 2.0 * d_sw, center + nw - 2.0 * d_nw
    pq = 2.0 * (center - d_sw - d_nw + west)
    p, q = 2.0 * (d_sw - center), 2.0 * (d_nw - center)
    linear_s, linear_t = -(p + q), q - p
    ss, st, tt = pp + qq + pq, 2.0 * (pp - qq), pp + qq - pq
    at_se = center + 0.5 * (linear_s - linear_t) + 0.25 * (ss - st + tt)
    at_ne = center + 0.5 * (linear_s + linear_t) + 0.25 * (ss + st + tt)
    return np.ascontiguousarray(
        np.stack([center, linear_s, linear_t, ss, st, tt, se - at_se, ne - at_ne], axis=1)
    )


def _from_coefficients() -> Floats:
    """V is the mean of the four coefficients around a corner, E of the two at a side."""
    block = np.zeros((8, 3, 3))
    for corner in range(4):
        i, j = corner % 2, corner // 2
        block[corner, i : i + 2, j : j + 2] = 0.25
    for side, beside in enumerate(((1, 0), (2, 1), (1, 2), (0, 1))):
        block[4 + side, 1, 1] = block[(4 + side, *beside)] = 0.5
    return block.reshape(8, 9)


def _to_ordinates() -> Floats:
    """The order of `indices`: AA AB AC BB BC CC, C the center."""
    result = np.zeros((4, 6, 8))
    for triangle, (a, side, b) in zip(result, TRIANGLES, strict=True):
        triangle[0, a] = triangle[3, b] = triangle[1, side] = 1.0
        triangle[2, _BESIDE[a]] = triangle[4, _BESIDE[b]] = 0.5
        triangle[5, 4:] = 0.25
    return result


_CENTER = ((0.0, 0.0),)
_CORNERS = ((-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5))
_NEIGHBORS = ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0))
_DIAGONAL = ((1.0, 1.0), (-1.0, -1.0))

QUADRATIC = Element(
    name="quadratic",
    bspline="M1111",
    degree=2,
    from_coefficients=_from_coefficients(),
    to_ordinates=_to_ordinates(),
    # Half of the parent's and a quarter of each of the parent's neighbors on the child's sides.
    mask=np.array(
        [
            [(0.0, 0.0, 0.5), (a, 0.0, 0.25), (0.0, b, 0.25)]
            for a in (-1.0, 1.0)
            for b in (-1.0, 1.0)
        ]
    ),
    operators={
        "V": Operator(_CENTER, (1.0,), equal_cells=False),
        "W": Operator(_CENTER + _CORNERS, (2.0, -0.25, -0.25, -0.25, -0.25), equal_cells=False),
        "S": Operator(_CENTER + _NEIGHBORS, (1.5, -0.125, -0.125, -0.125, -0.125)),
        "P": Operator(_CENTER + _DIAGONAL, (1.25, -0.125, -0.125), by_parity=True),
    },
    # The fewest cells, by docs/fit.md: S where there are ridges, P around smooth levels.
    defaults={"given": "W", "bands": "P", "everywhere": "S", "tensor": "W"},
    spaces=("hierarchical", "tensor", "uniform"),
    power_form=power_form,
)
