"""Level sets of a C¹ quadratic spline: closed chains of conic arcs, tangents continuous.

cells the level may pass ─→ crossings, once for each edge segment ─→ pairs in each triangle
    ─→ chains from crossing to crossing ─→ conic arcs (P0, P1, P2, weight)

Those of a spline of a higher degree are followed by a quadratic one: see `followed`.
"""

from splinesdf.splines.level_sets.chains import contours
from splinesdf.splines.level_sets.followed import allowed_beside, followed

__all__ = ["allowed_beside", "contours", "followed"]
