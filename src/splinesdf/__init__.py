"""Closed curves to a compact C¹ piecewise-quadratic signed distance function."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from splinesdf import plot
    from splinesdf.batches.batch import BatchReport, batch
    from splinesdf.batches.item import BatchRow
    from splinesdf.contours.biarcs import as_arcs
    from splinesdf.contours.carve import Carve
    from splinesdf.contours.contour import Contour
    from splinesdf.distance.exact import (
        Projection,
        closest_point,
        project,
        signed_distance,
        signed_distance_grid,
    )
    from splinesdf.distance.tiled import signed_distance_array
    from splinesdf.errors import (
        AxisIncomplete,
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
    from splinesdf.io.writers.milling import Milling
    from splinesdf.medial.axis import MedialAxis
    from splinesdf.medial.edge import AxisEdge
    from splinesdf.medial.thickness import (
        MaximalDisks,
        Narrow,
        local_thickness,
        maximal_disk,
        thickness,
    )
    from splinesdf.medial.tracing import medial_axis
    from splinesdf.meshes.lattice import DistanceGrid
    from splinesdf.offsets.offset import offset
    from splinesdf.offsets.pocket import Pocket, pocket
    from splinesdf.offsets.vcarve import vcarve
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
    "AxisEdge",
    "AxisIncomplete",
    "BatchReport",
    "BatchRow",
    "Carve",
    "Contour",
    "DistanceGrid",
    "FitResult",
    "InputError",
    "Limits",
    "MaximalDisks",
    "MedialAxis",
    "Milling",
    "MissingExtraError",
    "Narrow",
    "OpenContourError",
    "Pocket",
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
    "batch",
    "closest_point",
    "example",
    "fit",
    "from_level_set",
    "interpolate",
    "load",
    "local_thickness",
    "maximal_disk",
    "medial_axis",
    "offset",
    "plot",
    "pocket",
    "project",
    "read",
    "read_all",
    "signed_distance",
    "signed_distance_array",
    "signed_distance_grid",
    "texture",
    "thickness",
    "vcarve",
    "write",
]

# Where each name is. It is imported when it is first asked for: all of them take three times as
# long as NumPy, and most programs need a few. Editors and type checkers read the imports above.
_MODULES = {
    "batches.batch": (
        "BatchReport",
        "batch",
    ),
    "batches.item": ("BatchRow",),
    "contours.biarcs": ("as_arcs",),
    "contours.carve": ("Carve",),
    "contours.contour": ("Contour",),
    "distance.exact": (
        "Projection",
        "closest_point",
        "project",
        "signed_distance",
        "signed_distance_grid",
    ),
    "distance.tiled": ("signed_distance_array",),
    "errors": (
        "AxisIncomplete",
        "InputError",
        "MissingExtraError",
        "OpenContourError",
        "SplineSDFError",
        "ToleranceNotReached",
    ),
    "fits.fit": (
        "FitResult",
        "fit",
    ),
    "fits.interpolation": ("interpolate",),
    "ground.limits": ("Limits",),
    "ground.progress": ("Progress",),
    "io.input": (
        "example",
        "read",
        "read_all",
    ),
    "io.output": ("write",),
    "medial.axis": ("MedialAxis",),
    "medial.edge": ("AxisEdge",),
    "medial.thickness": (
        "MaximalDisks",
        "Narrow",
        "local_thickness",
        "maximal_disk",
        "thickness",
    ),
    "medial.tracing": ("medial_axis",),
    "io.writers.milling": ("Milling",),
    "meshes.lattice": ("DistanceGrid",),
    "offsets.offset": ("offset",),
    "offsets.pocket": (
        "Pocket",
        "pocket",
    ),
    "offsets.vcarve": ("vcarve",),
    "rasters.atlas": ("atlas",),
    "rasters.layout": ("Atlas",),
    "rasters.texture": (
        "Texture",
        "texture",
    ),
    "shapes.shape": ("Shape",),
    "splines.loading": ("load",),
    "splines.samples": ("from_level_set",),
    "splines.spline": ("SplineSDF",),
    "splines.triangles": ("Triangles",),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        found = getattr(importlib.import_module(f"splinesdf.{_HOME[name]}"), name)
    elif name == "plot":
        found = importlib.import_module("splinesdf.plot")
    else:
        raise AttributeError(f"module 'splinesdf' has no attribute {name!r}")
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
