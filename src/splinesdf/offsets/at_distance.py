"""The offset at one distance: trimmed parallels, joined to loops, fitted by few arcs."""

from __future__ import annotations

import numpy as np

from splinesdf._arrays import Floats, Ints
from splinesdf._tables import Runs
from splinesdf.contour import Contour
from splinesdf.curves.shape import Shape
from splinesdf.offsets.loops import Loops, loops_of
from splinesdf.offsets.runs import runs_of
from splinesdf.offsets.trimmed import Stretches, trimmed


def contours_at(shape: Shape, distance: float, tolerance: float) -> list[Contour] | None:
    """The contours at a distance, or None if trimming leaves ends that do not fit together."""
    stretches = trimmed(shape, distance, tolerance) if distance else _whole(shape)
    loops = loops_of(shape, stretches, distance, tolerance)
    if loops is None:
        return None
    return _contours(shape, loops, distance, tolerance)


def _whole(shape: Shape) -> Stretches:
    """The boundary itself: the offset at the distance 0."""
    order = shape.joints.order
    return Stretches(
        np.column_stack([order, np.zeros_like(order)]), np.tile([0.0, 1.0], (len(order), 1))
    )


def _contours(shape: Shape, loops: Loops, distance: float, tolerance: float) -> list[Contour]:
    if len(loops.first) < 2:
        return []
    runs, starts = runs_of(shape, loops, distance)
    arcs, weights, owner = fitted(shape, runs, distance, np.full(len(runs.kind), tolerance))
    arcs += shape.boundary.origin
    cuts = np.searchsorted(owner, starts)
    return [
        Contour(arcs[a:b], weights[a:b], distance=distance, y_down=shape.y_down)
        for a, b in zip(cuts[:-1], cuts[1:], strict=True)
    ]


def fitted(
    shape: Shape, runs: Runs, distance: float, tolerance: Floats
) -> tuple[Floats, Floats, Ints]:
    """Arcs of all runs, relative to the boundary's origin, their weights, and their runs."""
    from splinesdf.kernels.conic_fit import fit_runs  # Numba loads only when it is used

    room = 4 * len(runs.kind) + 64
    while True:
        arcs, weights = np.empty((room, 3, 2)), np.empty(room)
        owner = np.empty(room, dtype=np.int64)
        count = fit_runs(
            shape.boundary, shape.joints, runs, distance, tolerance, arcs, weights, owner
        )
        if count <= room:
            return arcs[:count], weights[:count], owner[:count]
        room = count
