"""Closed curves to a compact C¹ piecewise-quadratic signed distance function."""

from splinesdf import plot
from splinesdf.contours.biarcs import as_arcs
from splinesdf.contours.contour import Contour
from splinesdf.distance.exact import (
    Projection,
    closest_point,
    project,
    signed_distance,
    signed_distance_grid,
)
from splinesdf.errors import (
    InputError,
    MissingExtraError,
    OpenContourError,
    SplineSDFError,
    ToleranceNotReached,
)
from splinesdf.fits.fit import FitResult, fit
from splinesdf.fits.interpolation import interpolate
from splinesdf.ground.limits import Limits
from splinesdf.ground.progress import Progress
from splinesdf.io.input import example, read, read_all
from splinesdf.io.output import write
from splinesdf.io.writers.options import Milling
from splinesdf.meshes.lattice import DistanceGrid
from splinesdf.offsets.offset import offset
from splinesdf.rasters.atlas import atlas
from splinesdf.rasters.layout import Atlas
from splinesdf.rasters.texture import Texture, texture
from splinesdf.shapes.shape import Shape
from splinesdf.splines.loading import load
from splinesdf.splines.samples import from_level_set
from splinesdf.splines.spline import SplineSDF
from splinesdf.splines.triangles import Triangles

__version__ = "0.1.0"
__all__ = [
    "Atlas",
    "Contour",
    "DistanceGrid",
    "FitResult",
    "InputError",
    "Limits",
    "Milling",
    "MissingExtraError",
    "OpenContourError",
    "Progress",
    "Projection",
    "Shape",
    "SplineSDF",
    "SplineSDFError",
    "Texture",
    "ToleranceNotReached",
    "Triangles",
    "as_arcs",
    "atlas",
    "closest_point",
    "example",
    "fit",
    "from_level_set",
    "interpolate",
    "load",
    "offset",
    "plot",
    "project",
    "read",
    "read_all",
    "signed_distance",
    "signed_distance_grid",
    "texture",
    "write",
]
