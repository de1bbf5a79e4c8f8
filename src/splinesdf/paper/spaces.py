"""The spaces that the paper's Section 8 names, on its curves: a table that it did not print.

Γ₁, Γ₂, Γ₃ on n x n cells of the unit square, by every operator of S₂¹ (the quadratic element), of
S₃¹ (the mean of its three families of cubics) and of S₄² (the quartic element): the paper's error,
at the centers of cells; the true one; and the one near the curve, away from ridges of the distance,
which is where orders show.

References
----------
[Wang2014] Sections 5 and 8.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from splinesdf.distance.exact import signed_distance
from splinesdf.fits.interpolation import interpolate
from splinesdf.ground.arrays import Floats
from splinesdf.paper import tables as paper

COUNTS = (4, 8, 16, 32, 64, 128)
# The spaces by their elements, each with its operators from coarse to fine.
SPACES = {"S21": ("quadratic", "VWSP"), "S31": ("S31", "VS"), "S42": ("quartic", "VCDO")}
# "Near" is |u| up to this, and as far as that from where the petals of Γ₃ meet: there the distance
# has ridges that run into the curve.
NEAR, _FROM_MEETING = 0.02, 0.15
_MEETING = {"gamma3": (9 / 20, 9 / 20)}
# Points each way of the lattice of which those near a curve are taken. More: the maximum seen is
# nearer to the true one, which it misses by some percent at most; fewer: quicker.
_POINTS = 700


@dataclass(frozen=True)
class SpaceRow:
    """One row: a curve, an operator and a mesh.

    Attributes
    ----------
    curve : {"gamma1", "gamma2", "gamma3"}
    space : {"S21", "S31", "S42"}
    operator : str
    n : int
        Columns and rows of cells.
    error : float
        The paper's error: the largest |s - u| at the cell centers.
    true_error : float
        The largest |s - u| over the whole domain.
    order : float or None
        log2 of the true error on half as many cells each way over this one's.
    near_error : float
        The largest |s - u| seen at points with |u| <= `NEAR`.
    near_order : float or None
        As ``order``.
    """

    curve: str
    space: str
    operator: str
    n: int
    error: float
    true_error: float
    order: float | None
    near_error: float
    near_order: float | None


def space_rows(
    curves: Sequence[str] = paper.CURVES, counts: Sequence[int] = COUNTS
) -> Iterator[SpaceRow]:
    """The table, row by row; ``counts`` double from one to the next."""
    for name in curves:
        points, exact = _near(name)
        for space, (element, operators) in SPACES.items():
            for operator in operators:
                before: SpaceRow | None = None
                for n in counts:
                    made = interpolate(
                        paper.shape(name),
                        (n, n),
                        operator=operator,
                        domain=paper.DOMAIN,
                        element=element,
                    )
                    near = float(np.abs(made.spline(points) - exact).max())
                    before = SpaceRow(
                        curve=name,
                        space=space,
                        operator=operator,
                        n=n,
                        error=made.centre_error,
                        true_error=made.error,
                        order=None if before is None else math.log2(before.true_error / made.error),
                        near_error=near,
                        near_order=None if before is None else math.log2(before.near_error / near),
                    )
                    yield before


@cache
def _near(name: str) -> tuple[Floats, Floats]:
    """Points near a curve, and their exact distances."""
    # Off the lines of all meshes, and from no corner of the square.
    line = (np.arange(_POINTS) + 1.0 / math.e) / _POINTS
    points = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    exact = signed_distance(paper.shape(name), points)
    near = np.abs(exact) <= NEAR
    if name in _MEETING:
        near &= np.hypot(*(points - _MEETING[name]).T) >= _FROM_MEETING
    return points[near], exact[near]
