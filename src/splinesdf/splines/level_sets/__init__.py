"""Level sets of a C¹ quadratic spline: closed chains of conic arcs, tangents continuous.

cells the level may pass ─→ crossings, once for each edge segment ─→ pairs in each triangle
    ─→ chains from crossing to crossing ─→ conic arcs (P0, P1, P2, weight)
"""

from splinesdf.splines.level_sets.chains import contours

__all__ = ["contours"]
