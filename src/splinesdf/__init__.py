"""Closed curves to a compact C¹ piecewise-quadratic signed distance function."""

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
from splinesdf.spline import SplineSDF

__version__ = "0.1.0"
