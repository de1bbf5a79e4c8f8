"""`SplineSDF`: a C¹ piecewise polynomial function on a mesh, and what one asks of a distance."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, as_floats, as_points
from splinesdf.ground.blocks import in_blocks
from splinesdf.ground.brief import brief, counted, without_caches
from splinesdf.ground.card import Picture, card
from splinesdf.ground.doors import public
from splinesdf.ground.values import by_value
from splinesdf.meshes import Box, Mesh
from splinesdf.meshes.lattice import DistanceGrid, Nodes, grid_nodes
from splinesdf.meshes.mesh import check_domain, frames
from splinesdf.shapes.shape import Shape
from splinesdf.spaces.element import Element
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.space import Space, space_on
from splinesdf.spaces.tables import Evaluated
from splinesdf.splines.archive import (
    Archive,
    archive_dict,
    archive_from,
    write_archive,
)
from splinesdf.splines.border import border_of, extend_lattice
from splinesdf.splines.cell_arrays import to_arrays
from splinesdf.splines.coefficients import coefficients
from splinesdf.splines.differentiable import to_jax, to_torch
from splinesdf.splines.finite_elements import to_skfem
from splinesdf.splines.levels import contours
from splinesdf.splines.nodes import values_at_nodes
from splinesdf.splines.provenance import Provenance
from splinesdf.splines.shader import to_glsl
from splinesdf.splines.tables import Border
from splinesdf.splines.triangles import triangles
from splinesdf.splines.wgsl import to_wgsl

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# After the first step along the gradient, which an exact distance would make the last, so many
# Newton steps bring the point onto the zero level set. Each squares what is left of the error.
_CORRECTIONS = 3
# With fewer nodes of a grid a cell than this, to go from node to node is quicker than from cell
# to cell.
_NODES = 8

Outside = Literal["extend", "nan"]


@by_value
@without_caches
@dataclass(frozen=True, eq=False)
class SplineSDF:
    """A C¹ spline, quadratic unless said otherwise, read as a signed distance.

    What is asked outside its domain is answered by the extension

        F(p) = min over q on the domain's border of  s(q) + |p - q|,

    1-Lipschitz whatever the spline, and as good as the spline: if the shape lies in the domain,
    |F - u| <= the largest |s - u| on the border, in the whole plane. (The segment from p to its
    closest point meets the border, so u(p) = min of u(q) + |p - q|; then s is put for u.) Of a
    fit for a band, or of a shape that leaves the domain, F only continues what the spline has at
    the border. Beside the border F may be less than s, by twice the error at most.

    What takes points also takes ``outside``: "extend", or "nan" for NaN there (``inside``: False).
    Points that are not finite give NaN.

    Attributes
    ----------
    mesh : Grid or Quadtree
    ordinates : ndarray, shape (n_cells, numbers)
        What determines each cell: eight Bernstein-Bézier ordinates of the quadratic element, the
        fifteen numbers of its power form of the quartic one.
    name : str
    y_down : bool
        As in `Shape`: only pictures and writers look at this. If there is a shape, both are its
        own: the defaults stand for them, anything else is refused.
    shape : Shape or None
        What the spline approximates, so that the exact distance stays at hand.
    made : Provenance or None
        From what request it was made, and how well it answers it.
    element : Element
        What its B-splines are, see ``splinesdf.spaces``: quadratic unless given. Others are not
        drawn by pages, nor, but for quartic ones, by shaders.

    Examples
    --------
    >>> import splinesdf as ss
    >>> sdf = ss.fit(ss.Shape.from_formula("cos(t)", "sin(t)"), tolerance=0.01).spline
    >>> points = [[0.5, 0.0], [0.0, 2.0]]
    >>> sdf(points).round(1).tolist(), sdf([0.5, 0.0], [0.0, 2.0]).round(1).tolist()
    ([-0.5, 1.0], [-0.5, 1.0])
    >>> values, gradients = sdf.value_and_gradient(points)
    >>> bool((gradients == sdf.gradient(points)).all())
    True
    >>> sdf.normal(points).round(1).tolist(), sdf.closest_point(points).round(1)[0].tolist()
    ([[1.0, 0.0], [0.0, 1.0]], [1.0, 0.0])
    >>> sdf.inside(points).tolist(), sdf.hessian(points).shape, sdf.curvature(points).shape
    ([True, False], (2, 2, 2), (2,))
    >>> len(sdf.contours(0.0)), sdf.grid(5, 4).distance.shape
    (1, (4, 5))
    >>> axes = sdf.plot()
    >>> sdf.save("disk.npz")
    >>> ss.SplineSDF.from_dict(sdf.to_dict()) == sdf
    True
    """

    mesh: Mesh
    ordinates: Floats
    name: str = ""
    y_down: bool = False
    shape: Shape | None = None
    made: Provenance | None = None
    element: Element = QUADRATIC

    def __post_init__(self) -> None:
        ordinates, numbers = as_floats(self.ordinates, "ordinates"), self.element.numbers
        if ordinates.ndim != 2 or ordinates.shape[1] != numbers:
            shape = f"(n_cells, {numbers})"
            raise InputError(f"expected ordinates of shape {shape}, got {ordinates.shape}")
        object.__setattr__(self, "ordinates", ordinates)
        if self.shape is None:
            return
        name, y_down = self.name or self.shape.name, self.y_down or self.shape.y_down
        if (name, y_down) != (self.shape.name, self.shape.y_down):
            raise InputError(
                f"expected the name {self.shape.name!r:.60} and y_down={self.shape.y_down} of the "
                f"shape, got {name!r:.60} and y_down={y_down}: change those of the shape"
            )
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "y_down", y_down)

    def __repr__(self) -> str:
        cells = counted(len(self.ordinates), "cell")
        errors = "" if self.made is None else self.made.errors
        return brief("SplineSDF", self.name, cells, self.mesh.description, errors)

    @property
    def domain(self) -> Box:
        """The box on which the spline is defined: xmin, ymin, xmax, ymax."""
        return self.mesh.domain

    def __call__(
        self, points: ArrayLike, y: ArrayLike | None = None, *, outside: Outside = "extend"
    ) -> Floats:
        """Values at points of shape (..., 2), or at x and y that broadcast to (...): (...,)."""
        at = as_points(points, y)
        return self._evaluate(at, 0, outside)[0].reshape(at.shape[:-1])

    def grid(
        self,
        nx: Nodes,
        ny: int | None = None,
        *,
        domain: Box | None = None,
        outside: Outside = "extend",
    ) -> DistanceGrid:
        """Values at the nodes of a grid, its border included, quicker than point by point.

        Parameters
        ----------
        nx, ny : int
            Nodes each way, at least 2: two numbers, a pair of them, or one for both.
        domain : (xmin, ymin, xmax, ymax), optional
            The spline's own unless given.
        outside : {"extend", "nan"}

        Returns
        -------
        DistanceGrid
            As of `splinesdf.signed_distance_grid`: ``distance[j, i]`` is the value at
            (x[i], y[j]), to rounding.
        """
        _check_outside(outside)
        box = self.domain if domain is None else check_domain(domain)
        x, y = grid_nodes(nx, ny, box)
        few = len(x) * len(y) < _NODES * len(self.ordinates)
        if few or self.element.degree != 2:
            points = np.stack(np.meshgrid(x, y), axis=-1)
            return DistanceGrid(x, y, self(points, outside=outside))
        distance = values_at_nodes(self.mesh, self._frames, self._table, x, y)
        if outside == "extend":
            extend_lattice(self.domain, self._border, x, y, distance)
        return DistanceGrid(x, y, distance)

    def gradient(self, points: ArrayLike, *, outside: Outside = "extend") -> Floats:
        """Gradients, shape (..., 2) -> (..., 2); outside the domain they are unit vectors."""
        array = as_points(points)
        return self._evaluate(array, 1, outside)[1].reshape(array.shape)

    def value_and_gradient(
        self, points: ArrayLike, *, outside: Outside = "extend"
    ) -> tuple[Floats, Floats]:
        """Values and gradients in one pass, shape (..., 2) -> (...,), (..., 2)."""
        array = as_points(points)
        value, gradient, _ = self._evaluate(array, 1, outside)
        return value.reshape(array.shape[:-1]), gradient.reshape(array.shape)

    def hessian(self, points: ArrayLike, *, outside: Outside = "extend") -> Floats:
        """Second derivatives, shape (..., 2) -> (..., 2, 2); of quadratics they jump."""
        array = as_points(points)
        return self._evaluate(array, 2, outside)[2][:, [0, 1, 1, 2]].reshape(*array.shape, 2)

    def normal(self, points: ArrayLike, *, outside: Outside = "extend") -> Floats:
        """Unit vectors along the gradient, shape (..., 2) -> (..., 2); outward at the curve.

        Where |s - u| <= e and both have second derivatives of at most M in sum, the gradient is
        within 2 √(M e) of that of the distance (Landau), and the normal within twice that. So the
        normal is right to the square root of the tolerance away from the medial axis and wrong
        on it. NaN where the gradient vanishes, which happens only near the medial axis.
        """
        gradient = self.gradient(points, outside=outside)
        length = np.hypot(gradient[..., 0], gradient[..., 1])[..., None]
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(gradient / length)

    def curvature(self, points: ArrayLike, *, outside: Outside = "extend") -> Floats:
        """Curvature of the level set through each point, positive where the inside is convex.

        Shape (..., 2) -> (...,). Second derivatives of a quadratic spline jump from triangle to
        triangle: away from the medial axis the error is of the order of the cell's side h, where
        the value's is h³ and the gradient's h². A fit to a tolerance has h ~ tolerance^(1/3).
        (Of a quartic spline they go on: h², h⁴ and h³, and h ~ tolerance^(1/4).)

        The shape knows better: with ``found = splinesdf.project(shape, points)`` the level set's
        curvature is ``k / (1 + k * found.distance)``, ``k = found.curvature``, to rounding.
        """
        array = as_points(points)
        _, gradient, second = self._evaluate(array, 2, outside)
        (x, y), (xx, xy, yy) = gradient.T, second.T
        with np.errstate(invalid="ignore", divide="ignore"):
            bend = (xx * y * y - 2.0 * xy * x * y + yy * x * x) / np.hypot(x, y) ** 3
        return np.asarray(bend.reshape(array.shape[:-1]))

    def closest_point(self, points: ArrayLike, *, outside: Outside = "extend") -> Floats:
        """The point of the zero level set near each point, shape (..., 2) -> (..., 2).

        One step ``p - s grad s``, exact for an exact distance, then Newton steps onto ``s = 0``.
        Away from the medial axis it is within the fit's tolerance of the curve; on it, it is
        meaningless. With ``outside="nan"``: NaN also if a step leaves the domain.
        """
        array = as_points(points)
        result = array.reshape(-1, 2)
        for _ in range(1 + _CORRECTIONS):
            value, gradient, _second = self._evaluate(result, 1, outside)
            with np.errstate(invalid="ignore", divide="ignore"):
                squared = np.sum(gradient * gradient, axis=1)
                result = np.ascontiguousarray(result - (value / squared)[:, None] * gradient)
        return result.reshape(array.shape)

    def inside(self, points: ArrayLike, *, outside: Outside = "extend") -> Bools:
        """Whether the value is negative, shape (..., 2) -> (...,)."""
        return np.asarray(self(points, outside=outside) < 0.0)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the values in colors on axes, the current ones unless given, and return them."""
        axes: Axes = public("plot").drawn(self, ax)
        return axes

    def _repr_html_(self) -> str:
        return self._card("SplineSDF")

    def _card(self, kind: str) -> str:
        xmin, ymin, xmax, ymax = self.domain
        figures = {
            "cells": f"{len(self.ordinates):,} ({self.mesh.description})",
            "domain": f"{xmax - xmin:.6g} × {ymax - ymin:.6g}",
            "errors": "not known" if self.made is None else self.made.errors,
        }
        zero = self.contours() if self.element.degree == 2 or self._bound else []
        picture = Picture([c.points() for c in zero], self.domain, "nonzero", self.y_down)
        return card(kind, self.name, figures, picture)

    contours = contours
    coefficients = coefficients
    triangles = triangles
    to_arrays = to_arrays
    to_skfem = to_skfem
    to_glsl = to_glsl
    to_wgsl = to_wgsl
    to_jax = to_jax
    to_torch = to_torch

    def to_dict(self) -> dict[str, Any]:
        """All that a saved file holds, as texts, numbers, lists and dicts, for JSON.

        docs/fields.md says what is where, and evaluates a spline from it. Raises as `save`.
        """
        return archive_dict(self._archive)

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> SplineSDF:
        """The spline that `to_dict` gave, to the bit; raises `InputError` if it is not one."""
        return cls(*archive_from(content))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the spline to an ``.npz`` or ``.json`` file, its shape and provenance with it.

        Both hold the same, to the bit. The file is whole or not there: if the writing is cut
        short, killed even, what stood under the name before is untouched. `splinesdf.load` reads
        it.

        Raises
        ------
        InputError
            If the name ends otherwise, the file cannot be written, or a number of the spline is
            not finite.
        """
        write_archive(path, self._archive)

    @property
    def _bound(self) -> float | None:
        return None if self.made is None else self.made.bound

    @property
    def _archive(self) -> Archive:
        return Archive(*(getattr(self, name) for name in Archive._fields))

    @cached_property
    def _frames(self) -> Floats:
        return frames(self.mesh.local_boxes)

    @cached_property
    def _table(self) -> Floats:
        return self.element.table(self.ordinates)

    @cached_property
    def _space(self) -> Space:
        return space_on(self.mesh, self.element)

    @cached_property
    def _border(self) -> Border:
        return border_of(self.mesh, self.element, self.ordinates)

    def _evaluate(
        self, array: Floats, order: int, outside: Outside
    ) -> tuple[Floats, Floats, Floats]:
        _check_outside(outside)
        points = array.reshape(-1, 2)
        count = len(points)
        value = np.empty(count)
        gradient = np.empty((count if order > 0 else 0, 2))
        hessian = np.empty((count if order > 1 else 0, 3))
        evaluate = self._space.evaluator(self._table)

        def work(part: slice) -> None:
            asked = Evaluated(points[part], value[part], gradient[part], hessian[part])
            if evaluate(asked) > 0 and outside == "extend":
                self._extend(asked)

        in_blocks(count, work)
        return value, gradient, hessian

    def _extend(self, evaluated: Evaluated) -> None:
        from splinesdf.splines.kernels.extension import extend

        extend(np.array(self.domain), self._border, evaluated)


def _check_outside(outside: str) -> None:
    if outside not in ("extend", "nan"):
        raise InputError(f"expected outside 'extend' or 'nan', got {outside!r:.60}")
