"""What a cell must know of a shape: the few parts of its boundary that can be closest there."""

from __future__ import annotations

import numpy as np

from splinesdf.arclets.tables import Arclets, Candidates, Cells
from splinesdf.ground.arrays import Floats


def candidates_of_cells(boundary: Arclets, cells: Cells) -> Candidates:
    """Candidates of all cells of a quadtree, each found among its parent's."""
    from splinesdf.arclets.kernels.culling import (  # Numba loads only when it is used
        MOST_KEPT,
        cull_cells,
    )

    count = len(cells.starts) - 1
    starts = np.empty(count + 1, dtype=np.int64)
    nodes = np.empty(count * MOST_KEPT, dtype=np.int64)
    cull_cells(boundary.tree, boundary.arcs, cells, starts, nodes)
    return Candidates(starts, nodes)


def candidates_of_boxes(boundary: Arclets, boxes: Floats) -> Candidates:
    """Candidates of boxes (n, 4), each found by itself."""
    from splinesdf.arclets.kernels.culling import (  # Numba loads only when it is used
        MOST_KEPT,
        cull_boxes,
    )

    starts = np.empty(len(boxes) + 1, dtype=np.int64)
    nodes = np.empty(len(boxes) * MOST_KEPT, dtype=np.int64)
    cull_boxes(boundary.tree, boundary.arcs, boxes, starts, nodes)
    return Candidates(starts, nodes)
