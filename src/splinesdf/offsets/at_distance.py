"""The offset at one distance: trimmed parallels, joined to loops, fitted by few arcs."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.joints import CUSP
from splinesdf.arclets.points import angles
from splinesdf.arclets.tables import FREE
from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.offsets.loops import loops_of
from splinesdf.offsets.runs import runs_of
from splinesdf.offsets.specks import Loops
from splinesdf.offsets.tables import Runs
from splinesdf.offsets.trimmed import Stretches, parallels_at, smooth_turn, trimmed
from splinesdf.shapes.shape import Shape

# Arcs that meet within the tolerance where the exact offset does not are fitted again, to this
# share of the tolerance and, if need be, to its powers.
_CLOSER, _ROUNDS = 0.125, 5
# Arcs nearer to one another than this share of the largest coordinate meet; but arcs that leave a
# corner side by side are no farther apart, for rounding, up to the second one from it.
_APART, _FROM_CORNER = 1e-12, 1e-7
# Arcs below this share of their loop, and of the tolerance, are rounding. Larger: real ones are
# lost; smaller: stubs stay.
_STUB, _LOOSE = 1e-11, 0.03


class Found(NamedTuple):
    """The contours at one distance."""

    contours: list[Contour]
    clear: bool  # no two arcs meet but at their ends, and no contour turns back on itself


def contours_at(
    shape: Shape, distance: float, tolerance: float, *, shift: float = 0.0
) -> Found | None:
    """The contours at a distance, or None if trimming leaves ends that do not fit together.

    Parameters
    ----------
    shift : float
        How much farther out they really are; the tolerance is what is left beside it.
    """
    moved = distance + shift
    # Moved by little, walls that were just twice the distance apart end in two crossings close to
    # each other: trimming must tell them apart.
    apart = abs(shift) or tolerance
    smooth = smooth_turn(moved, tolerance)
    stretches = trimmed(shape, moved, apart, smooth) if moved else _whole(shape)
    loops = loops_of(shape, stretches, moved, tolerance)
    if loops is None:
        return None
    fit = _fit_clear_of_itself(shape, loops, moved, tolerance)
    if fit is None:
        return Found([], True)
    arcs, weights, cuts, clear, backward = fit
    contours = [
        Contour(arcs[a:b], weights[a:b], distance=distance, y_down=shape.y_down)
        for a, b in pairwise(cuts)
    ]
    # Moved, nothing runs back along itself: what turns back are tips, nearly as sharp as cusps.
    return Found(contours, clear and not (backward and shift == 0.0))


def _whole(shape: Shape) -> Stretches:
    """The boundary itself: the offset at the distance 0."""
    order = shape.joints.order
    return Stretches(
        np.column_stack([order, np.zeros_like(order)]), np.tile([0.0, 1.0], (len(order), 1))
    )


def _fit_clear_of_itself(
    shape: Shape, loops: Loops, distance: float, tolerance: float
) -> tuple[Floats, Floats, Ints, bool, bool] | None:
    """Arcs, weights, where each loop's arcs start, whether none meet, whether one turns back."""
    if len(loops.first) < 2:
        return None
    runs, starts = runs_of(shape, loops, distance, tolerance)
    allowed = np.full(len(runs.kind), tolerance)
    for _ in range(_ROUNDS):
        arcs, weights, owner = _fitted(shape, runs, distance, allowed)
        arcs, weights, owner = _without_stubs(arcs, weights, owner, runs.kind, starts, tolerance)
        cuts = np.searchsorted(owner, starts)
        following = np.arange(1, len(arcs) + 1)
        following[cuts[1:] - 1] = cuts[:-1]
        meeting = np.unique(owner[_meeting(arcs, weights, following)])
        if not len(meeting):
            break
        allowed[meeting] *= _CLOSER
    arcs += shape.boundary.origin
    return arcs, weights, cuts, not len(meeting), _turns_back(arcs, following)


def _without_stubs(
    arcs: Floats, weights: Floats, owner: Ints, kind: Ints, starts: Ints, tolerance: float
) -> tuple[Floats, Floats, Ints]:
    """Leave out arcs that are rounding, and let a longer neighbor reach to where they led.

    They are what the noise in directions leaves next to ends that stand still.
    """
    loop = np.searchsorted(starts, owner, side="right") - 1
    first = np.flatnonzero(np.diff(loop, prepend=-1))
    size = np.maximum.reduceat(arcs.max(axis=1), first) - np.minimum.reduceat(
        arcs.min(axis=1), first
    )
    extent = np.ptp(arcs, axis=1).max(axis=1)
    stub = extent <= np.minimum(_STUB * size.max(axis=1), _LOOSE * tolerance)[loop]
    if not stub.any():
        return arcs, weights, owner
    arcs, kept = arcs.copy(), ~stub
    count = np.bincount(loop)
    for at in np.flatnonzero(stub).tolist():
        begin, many = int(first[loop[at]]), int(count[loop[at]])
        around = [begin + (at - begin + step) % many for step in (-1, 1)]
        # A neighbor that is free need not stay what it is.
        bends = [not stub[k] and kind[owner[k]] == FREE for k in around]
        if not any(bends):
            kept[at] = True
        elif bends[0] and (not bends[1] or extent[around[0]] >= extent[around[1]]):
            arcs[around[0], 2] = arcs[at, 2]
        else:
            arcs[around[1], 0] = arcs[at, 0]
    return arcs[kept], weights[kept], owner[kept]


def _turns_back(arcs: Floats, following: Ints) -> bool:
    """Whether a contour has a cusp: where the skeleton runs along the level, to rounding."""
    before = arcs[:, 2] - arcs[:, 1]
    after = arcs[following, 1] - arcs[following, 0]
    return bool((np.abs(angles(before, after)) > np.pi - CUSP).any())


def _fitted(
    shape: Shape, runs: Runs, distance: float, tolerance: Floats
) -> tuple[Floats, Floats, Ints]:
    """Arcs of all runs, relative to the boundary's origin, their weights, and their runs."""
    from splinesdf.offsets.kernels.conic_fit import (  # Numba loads only when it is used
        MOST_ARCS,
        fit_runs,
    )

    room = 4 * len(runs.kind) + 64
    while True:
        arcs, weights = np.empty((room, 3, 2)), np.empty(room)
        owner = np.empty(room, dtype=np.int64)
        count = fit_runs(parallels_at(shape, distance), runs, tolerance, arcs, weights, owner)
        if count > MOST_ARCS:
            raise InputError(
                f"expected a tolerance for which {MOST_ARCS:,} arcs are enough, got "
                f"{tolerance.min():.2g}: raise it"
            )
        if count <= room:
            return arcs[:count], weights[:count], owner[:count]
        room = count


def _meeting(arcs: Floats, weights: Floats, following: Ints) -> Ints:
    """Arcs that meet another one elsewhere than at an end they share."""
    from splinesdf.contours.kernels.meetings import (
        find_meetings,  # Numba loads only when it is used
    )

    order = np.argsort(arcs[:, :, 0].min(axis=1))
    room = 64
    while True:
        pairs = np.empty((room, 2), dtype=np.int64)
        largest = float(np.abs(arcs).max())
        apart = (_APART * largest, _FROM_CORNER * largest)
        count = find_meetings(arcs, weights, following, order, apart, pairs)
        if count <= room:
            return pairs[:count].ravel()
        room = count
