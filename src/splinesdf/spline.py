"""`SplineSDF`: a C¹ piecewise-quadratic function on a mesh, and what one asks of a distance."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from splinesdf._arrays import Bools, Floats, as_points
from splinesdf._blocks import in_blocks
from splinesdf.contour import Contour
from splinesdf.level_sets import contours
from splinesdf.meshes import Box, Grid, Mesh
from splinesdf.spaces import bspline_coefficients, tensor_ordinates
from splinesdf.spaces.cells import frames, power_form
from splinesdf.spline_file import Archive, read_archive, write_archive

# After the first step along the gradient, which an exact distance would make the last, so many
# Newton steps bring the point onto the zero level set. Each squares what is left of the error.
_CORRECTIONS = 3


@dataclass(frozen=True, eq=False)
class SplineSDF:
    """A C¹ quadratic spline on a criss-cross mesh, read as a signed distance.

    Outside its domain every answer is NaN (and ``inside`` False).

    Attributes
    ----------
    mesh : Grid or Quadtree
    ordinates : ndarray, shape (n_cells, 8)
        Bernstein-Bézier ordinates of each cell (see `splinesdf.spaces`).
    name : str
    y_down : bool
        As in `Shape`: only pictures and writers look at this.
    """

    mesh: Mesh
    ordinates: Floats
    name: str = ""
    y_down: bool = False

    @property
    def domain(self) -> Box:
        """The box on which the spline is defined: xmin, ymin, xmax, ymax."""
        return self.mesh.domain

    def __call__(self, points: ArrayLike) -> Floats:
        """Values, shape (..., 2) -> (...,)."""
        array = as_points(points)
        return self._evaluate(array, 0)[0].reshape(array.shape[:-1])

    def gradient(self, points: ArrayLike) -> Floats:
        """Gradients, shape (..., 2) -> (..., 2)."""
        array = as_points(points)
        return self._evaluate(array, 1)[1].reshape(array.shape)

    def value_and_gradient(self, points: ArrayLike) -> tuple[Floats, Floats]:
        """Values and gradients in one pass, shape (..., 2) -> (...,), (..., 2)."""
        array = as_points(points)
        value, gradient, _ = self._evaluate(array, 1)
        return value.reshape(array.shape[:-1]), gradient.reshape(array.shape)

    def hessian(self, points: ArrayLike) -> Floats:
        """Second derivatives, shape (..., 2) -> (..., 2, 2): constant on each triangle."""
        array = as_points(points)
        second = self._evaluate(array, 2)[2]
        return second[:, [0, 1, 1, 2]].reshape(*array.shape, 2)

    def normal(self, points: ArrayLike) -> Floats:
        """Unit vectors along the gradient, shape (..., 2) -> (..., 2); outward at the curve.

        NaN where the gradient vanishes, which happens only near the medial axis.
        """
        gradient = self.gradient(points)
        length = np.hypot(gradient[..., 0], gradient[..., 1])[..., None]
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(gradient / length)

    def curvature(self, points: ArrayLike) -> Floats:
        """Curvature of the level set through each point, positive where the inside is convex.

        Shape (..., 2) -> (...,). It is constant along no curve: second derivatives of a quadratic
        spline jump from triangle to triangle and carry an error of the order of the cell's side.
        """
        array = as_points(points)
        _, gradient, second = self._evaluate(array, 2)
        (x, y), (xx, xy, yy) = gradient.T, second.T
        with np.errstate(invalid="ignore", divide="ignore"):
            bend = (xx * y * y - 2.0 * xy * x * y + yy * x * x) / np.hypot(x, y) ** 3
        return np.asarray(bend.reshape(array.shape[:-1]))

    def closest_point(self, points: ArrayLike) -> Floats:
        """The point of the zero level set near each point, shape (..., 2) -> (..., 2).

        One step ``p - s grad s``, exact for an exact distance, then Newton steps onto ``s = 0``.
        On the medial axis it is meaningless. NaN outside the domain, or if a step leaves it.
        """
        array = as_points(points)
        result = array.reshape(-1, 2)
        for _ in range(1 + _CORRECTIONS):
            value, gradient, _second = self._evaluate(result, 1)
            with np.errstate(invalid="ignore", divide="ignore"):
                squared = np.sum(gradient * gradient, axis=1)
                result = np.ascontiguousarray(result - (value / squared)[:, None] * gradient)
        return result.reshape(array.shape)

    def inside(self, points: ArrayLike) -> Bools:
        """Whether the value is negative, shape (..., 2) -> (...,)."""
        return np.asarray(self(points) < 0.0)

    def contours(self, level: float) -> list[Contour]:
        """The level set ``s = level`` as chains of conic arcs, lower values on their left.

        Closed and with a continuous tangent, but for those that leave the domain (``closed`` is
        False) and where the gradient vanishes. Left and right as x turns into y.
        """
        return contours(self.mesh, self.ordinates, level, y_down=self.y_down)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the spline to an ``.npz`` file, whole or not at all; `splinesdf.load` reads it."""
        write_archive(path, Archive(self.mesh, self.ordinates, self.name, self.y_down))

    @cached_property
    def _frames(self) -> Floats:
        return frames(self.mesh.boxes)

    @cached_property
    def _powers(self) -> Floats:
        return power_form(self.ordinates)

    def _evaluate(self, array: Floats, order: int) -> tuple[Floats, Floats, Floats]:
        from splinesdf.kernels.ordinates import evaluate  # Numba loads only when it is used

        points = array.reshape(-1, 2)
        count = len(points)
        value = np.empty(count)
        gradient = np.empty((count if order > 0 else 0, 2))
        hessian = np.empty((count if order > 1 else 0, 3))
        cell_frames, powers, mesh = self._frames, self._powers, self.mesh

        def work(part: slice) -> None:
            evaluate(
                cell_frames,
                powers,
                mesh.locate(points[part]),
                points[part],
                value[part],
                gradient[part],
                hessian[part],
            )

        in_blocks(count, work)
        return value, gradient, hessian


def load(path: str | os.PathLike[str]) -> SplineSDF:
    """Read a spline that `SplineSDF.save` wrote; raises `InputError` if it is not one."""
    return SplineSDF(*read_archive(path))


def bspline(mesh: Grid, i: int, j: int) -> SplineSDF:
    """The B-spline of cell (i, j) of a grid, -1 and m, n being the ring around the domain.

    It is positive inside an octagon in the 3 x 3 cells around (i, j); all of them sum to one.

    References
    ----------
    [Wang2014] Theorem 5 and the 41 values after it.
    """
    return SplineSDF(mesh, tensor_ordinates(mesh, bspline_coefficients(mesh, i, j)))
