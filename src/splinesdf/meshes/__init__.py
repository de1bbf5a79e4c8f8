"""Criss-cross meshes: rectangular cells, each cut into four triangles by its diagonals.

Every mesh answers the same questions (see `Mesh`), so whatever uses one knows only cells:

    V2 ──E6── V3        corners of a cell: SW, SE, NW, NE
    │ ╲    ╱ │          sides:            S, E, N, W
    E7   C   E5
    │ ╱    ╲ │
    V0 ──E4── V1
"""

from splinesdf.meshes.grid import Grid
from splinesdf.meshes.mesh import Box, Mesh
from splinesdf.meshes.quadtree import Quadtree

__all__ = ["Box", "Grid", "Mesh", "Quadtree"]
