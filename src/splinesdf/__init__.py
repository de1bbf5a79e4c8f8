"""Closed curves to a compact C¹ piecewise-quadratic signed distance function."""

from splinesdf.contour import Contour
from splinesdf.curves.shape import Shape
from splinesdf.distance import closest_point, signed_distance
from splinesdf.errors import (
    InputError,
    MissingExtraError,
    OpenContourError,
    SplineSDFError,
    ToleranceNotReached,
)
from splinesdf.fit import FitResult, fit
from splinesdf.io.input import read
from splinesdf.io.output import write
from splinesdf.offset import offset
from splinesdf.spline import SplineSDF, load

__version__ = "0.1.0"
__all__ = [
    "Contour",
    "FitResult",
    "InputError",
    "MissingExtraError",
    "OpenContourError",
    "Shape",
    "SplineSDF",
    "SplineSDFError",
    "ToleranceNotReached",
    "closest_point",
    "fit",
    "load",
    "offset",
    "read",
    "signed_distance",
    "write",
]
