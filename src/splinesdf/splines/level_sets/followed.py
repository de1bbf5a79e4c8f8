"""Level sets of a spline of a higher degree: those of a C¹ quadratic spline that is close to it.

its cells ─→ quasi-interpolate it ─→ difference to it in Bernstein form ─→ small at the level? ─ yes
                   ↑                                                           │ no
                   └─────────────────── halve the cells around ←───────────────┘

Halves of cells have their diagonals on those of the cells, so that on each triangle of the
quadratic spline q both are polynomials, and the ordinates of their difference bound it. It is
bounded where either may take the level: there |q - s| is at most what is allowed, so that s is
within that of the level all along the arcs; elsewhere both are on the same side of it.
"""

from __future__ import annotations

from functools import cache
from math import comb
from typing import NamedTuple

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, Ints, finite
from splinesdf.meshes import Grid, Mesh, Quadtree
from splinesdf.spaces.element import CORNERS, Element, bernstein, monomials
from splinesdf.spaces.hierarchical import HierarchicalSpace
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.space import interpolated

# Of a fit's bound, what contours may miss of the spline. Smaller: twice as many arcs for a tenth of
# it; larger: contours are worse than the fit.
_SHARE = 0.1
# Share of the largest number of a cell below which a difference is rounding: no less is allowed.
_ROUNDING = 1e-14
# Rounds, each a halving at most, and cells: a hundred million arcs are no contour.
_ROUNDS, _MOST_CELLS = 40, 1_000_000
# Operator P reproduces quadratics across levels: borders between sizes of cells cost no order.
_OPERATOR = "P"


class _Here(NamedTuple):
    """Where points are in a spline's cells."""

    cell: Ints  # (n,)
    place: Floats  # (n, 2) s, t from the cell's center in cells
    side: Floats  # (n,) of the cell, in roots


def allowed_beside(element: Element, bound: float | None, tolerance: float | None) -> float:
    """How far from a level a spline may be on its contours: asked, or a share of its bound."""
    if tolerance is not None:
        return tolerance
    if not bound:
        raise InputError(
            f"expected a tolerance of contours for a {element.name} spline without a bound of its "
            "error, got none"
        )
    return _SHARE * bound


def followed(
    mesh: Mesh, element: Element, numbers: Floats, level: float, allowed: float
) -> tuple[Quadtree, Floats]:
    """A quadratic spline, mesh and ordinates, that differs by no more than is allowed at a level.

    Raises
    ------
    InputError
        If the difference that is allowed is below rounding, or a million cells do not do.
    """
    level, tree = finite(level, "level"), _at_zero(mesh)
    least = _ROUNDING * float(np.abs(numbers).max())
    if not allowed > least:
        raise InputError(
            f"expected a tolerance of contours above rounding, {least:.1g} here, got {allowed:.3g}"
        )
    polynomials = element.polynomials(numbers)

    def values(points: Floats) -> Floats:
        here = _locate(tree, _in_roots(tree, points))
        number = _triangle(here.place)
        return _evaluated(element.degree, polynomials[here.cell, number], here.place)

    space = HierarchicalSpace(tree, QUADRATIC)
    for _ in range(_ROUNDS):
        ordinates = interpolated(space, values, _OPERATOR)
        bad = _bad(tree, element.degree, polynomials, space, ordinates, (level, allowed))
        if not bad.any():
            found = space.mesh
            return Quadtree(
                mesh.domain, found.shape, found.level, found.index, found.child
            ), ordinates
        cells = np.flatnonzero(bad)
        space = space.refined(cells, np.ones((len(cells), 4), dtype=np.bool_))
        if space.mesh.cell_count > _MOST_CELLS:
            break
    raise InputError(
        f"expected contours within {allowed:.3g} that {_MOST_CELLS:,} cells can follow, got others:"
        " raise their tolerance"
    )


def _bad(
    tree: Quadtree,
    degree: int,
    polynomials: Floats,
    space: HierarchicalSpace,
    ordinates: Floats,
    asked: tuple[float, float],
) -> Bools:
    """Cells in which the difference may be more than is allowed, and matters."""
    level, allowed = asked
    mesh = space.mesh
    depth = mesh.level[mesh.leaves].astype(np.float64)
    side = np.exp2(-depth)
    center = np.asarray((mesh.index[mesh.leaves] + 0.5) * side[:, None])
    here = _locate(tree, center)
    scale = side / here.side
    # The triangle of the spline's that each of a cell's four lies in, by their centroids.
    inner = here.place[:, None] + scale[:, None, None] * CORNERS.mean(axis=1)
    rows = np.take_along_axis(polynomials[here.cell], _triangle(inner)[..., None], axis=1)
    exact = _moved(degree, rows, here.place, scale)
    close = np.zeros_like(exact)
    places = [monomials(degree).index(power) for power in monomials(2)]
    close[..., places] = QUADRATIC.polynomials(ordinates)
    to_ordinates = _from_powers(degree)
    spline, difference = (
        np.einsum("tok,ntk->nto", to_ordinates, values) for values in (exact, close - exact)
    )
    low, high = spline.min(axis=(1, 2)), spline.max(axis=(1, 2))
    found = QUADRATIC.ordinates(ordinates)
    least, most = found.min(axis=(1, 2)), found.max(axis=(1, 2))
    clear = (high < level) & (most < level) | (low > level) & (least > level)
    return np.asarray(~clear & (np.abs(difference).max(axis=(1, 2)) > allowed))


def _at_zero(mesh: Mesh) -> Quadtree:
    """The same cells, in the same order, from zero on: their places are not rounded far away."""
    xmin, ymin, xmax, ymax = mesh.domain
    domain = (0.0, 0.0, xmax - xmin, ymax - ymin)
    if isinstance(mesh, Quadtree):
        return Quadtree(domain, mesh.shape, mesh.level, mesh.index, mesh.child)
    assert isinstance(mesh, Grid)
    return Quadtree.uniform(domain, *mesh.shape)


def _in_roots(tree: Quadtree, points: Floats) -> Floats:
    return np.asarray(points * (np.array(tree.shape) / np.array(tree.domain[2:])))


def _locate(tree: Quadtree, points: Floats) -> _Here:
    """The cells of points (n, 2) in roots; beyond the domain those next to them go on."""
    root = np.clip(np.floor(points), 0, np.array(tree.shape) - 1).astype(np.int64)
    node = root[:, 0] * tree.shape[1] + root[:, 1]
    local, side = points - root, np.ones(len(points))
    for _ in range(tree.depth):
        inner = np.flatnonzero(tree.child[node] >= 0)
        half = (local[inner] >= 0.5).astype(np.int64)
        node[inner] = tree.child[node[inner]] + 2 * half[:, 0] + half[:, 1]
        local[inner] = 2.0 * local[inner] - half
        side[inner] *= 0.5
    return _Here(tree.cell_of[node], local - 0.5, side)


def _triangle(place: Floats) -> Ints:
    """S E N W of places (..., 2) in a cell; beyond it, that at the nearest side."""
    s, t = np.moveaxis(place, -1, 0)
    below, right = s > t, s > -t
    return np.asarray(np.where(below, np.where(right, 1, 0), np.where(right, 2, 3)))


def _evaluated(degree: int, polynomials: Floats, place: Floats) -> Floats:
    """Values of polynomials (n, k), each at its own place (n, 2)."""
    s, t = place.T
    result = np.zeros(len(place))
    for k, (a, b) in enumerate(monomials(degree)):
        result += polynomials[:, k] * s**a * t**b
    return result


def _moved(degree: int, polynomials: Floats, origin: Floats, scale: Floats) -> Floats:
    """The polynomials (n, 4, k) in places from an origin (n, 2), in cells of another size."""
    order = {power: k for k, power in enumerate(monomials(degree))}
    result = np.zeros_like(polynomials)
    for (a, b), k in order.items():
        for p in range(a + 1):
            for q in range(b + 1):
                factor = comb(a, p) * comb(b, q) * origin[:, 0] ** (a - p) * origin[:, 1] ** (b - q)
                factor = (factor * scale ** (p + q))[:, None]
                result[..., order[p, q]] += factor * polynomials[..., k]
    return result


@cache
def _from_powers(degree: int) -> Floats:
    """Ordinates on the triangles S E N W from powers of s and t, (4, k, k)."""
    return np.stack([np.linalg.inv(bernstein(degree, corners).T) for corners in CORNERS])
