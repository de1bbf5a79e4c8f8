"""Splines on quadtrees from any functional, by the package's own hierarchy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from splinesdf.meshes import Quadtree
from splinesdf.spaces.hierarchical import HierarchicalSpace
from splinesdf.spaces.quadratic import QUADRATIC


def hierarchical_ordinates(
    mesh: Quadtree, functional: Callable[[int, np.ndarray], np.ndarray]
) -> np.ndarray:
    """Ordinates (n_cells, 8) whose own coefficients are ``functional(level, cells)``, (n,)."""
    space = HierarchicalSpace(mesh, QUADRATIC)
    values = np.zeros(len(space.own))
    for level in range(int(space.nodes.level.max()) + 1):
        chosen = np.flatnonzero(space.own & (space.nodes.level == level))
        values[chosen] = functional(level, space.places[chosen])
    return space.numbers(values)
