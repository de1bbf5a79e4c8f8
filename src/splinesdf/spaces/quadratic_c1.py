"""One cell of a spline, whatever its mesh: forms of its eight ordinates.

V2 ──E6── V3       E halfway along a side, D (not stored) halfway along a half-diagonal,
│ D    D │         C (not stored) at the center. The bottom triangle, for one, is
E7   C   E5
│ D    D │               C
V0 ──E4── V1          D01 D1
                    V0  E4  V1
"""

from __future__ import annotations

import numpy as np

from splinesdf.ground.arrays import Floats

# The corners and the side of each triangle in the order bottom, right, top, left, run so that the
# center lies to the left: first corner, side, second corner; as columns of the ordinates.
TRIANGLES = ((0, 4, 1), (1, 5, 3), (3, 6, 2), (2, 7, 0))


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


def frames(boxes: Floats) -> Floats:
    """Centers and inverse sides of cells: (n, 4) -> (n, 4)."""
    return np.ascontiguousarray(
        np.concatenate(
            [0.5 * (boxes[:, :2] + boxes[:, 2:]), 1.0 / (boxes[:, 2:] - boxes[:, :2])], axis=1
        )
    )


def sampling_matrix(offsets: Floats) -> Floats:
    """The matrix that takes ordinates to values at points of the cell: (p, 2) -> (8, p).

    Parameters
    ----------
    offsets : ndarray, shape (p, 2)
        Offsets from the center in cells, between -1/2 and 1/2.
    """
    s, t = offsets.T
    basis = np.stack(
        [
            np.ones_like(s),
            s,
            t,
            s * s,
            s * t,
            t * t,
            np.maximum(s - t, 0.0) ** 2,
            np.maximum(s + t, 0.0) ** 2,
        ]
    )
    return np.asarray(power_form(np.eye(8)) @ basis)
