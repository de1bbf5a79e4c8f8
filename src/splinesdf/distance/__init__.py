"""Exact distance."""

from splinesdf.distance.exact import (
    Projection,
    closest_point,
    distance_and_gradient,
    project,
    signed_distance,
    signed_distance_grid,
)
from splinesdf.meshes.lattice import DistanceGrid

__all__ = [
    "DistanceGrid",
    "Projection",
    "closest_point",
    "distance_and_gradient",
    "project",
    "signed_distance",
    "signed_distance_grid",
]
