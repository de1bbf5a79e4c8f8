"""The offset at one distance: trimmed parallels, joined to loops, fitted by few conic arcs."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.points import angles
from splinesdf.arclets.tables import FREE
from splinesdf.arclets.thresholds import CUSP
from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.offsets.loops import loops_of
from splinesdf.offsets.runs import runs_of
from splinesdf.offsets.tables import Loops, RunArcs, Runs
from splinesdf.offsets.trimmed import parallels_at, selected, smooth_turn, trimmed, whole
from splinesdf.shapes.shape import Shape

# Runs whose arcs meet others, though the exact offset is clear, are fitted again to this share of
# the tolerance and, if need be, to its powers; and how many fits there are in all.
_CLOSER, _ROUNDS = 0.125, 5
# Arcs nearer to each other than this share of the largest coordinate meet, except up to the second
# share from a corner, where arcs leave it side by side and rounding brings them as near.
_APART, _FROM_CORNER = 1e-12, 1e-7
# Arcs below this share of their loop, and the second of the tolerance, are stubs that rounding
# leaves. Larger: real arcs are lost; smaller: stubs stay.
_STUB, _LOOSE = 1e-11, 0.03


class Attempt(NamedTuple):
    """Contours at one distance, and whether they are fit for use."""

    contours: list[Contour]
    clear: bool  # arcs meet at common ends only, and no contour turns back on itself


class LoopArcs(NamedTuple):
    """Conic arcs of loops, one loop after the other."""

    arcs: Floats  # (n, 3, 2) control points
    weights: Floats  # (n,) of the middle control points
    first: Ints  # (n_loops + 1,) loop j has the arcs first[j]:first[j + 1]
    clear: bool  # arcs meet at common ends only
    turns_back: bool  # a loop has a cusp


def contours_at(
    shape: Shape, distance: float, tolerance: float, *, shift: float = 0.0
) -> Attempt | None:
    """Trim, join and fit the contours at a distance; None if ends of segments find no start.

    Parameters
    ----------
    distance : float
        Asked for, as each contour says.
    tolerance : float
        Of the arcs: the shift is not part of it.
    shift : float
        By how much more than the distance the contours are really off.
    """
    moved = distance + shift
    # After a small shift, walls that were just twice the distance apart end in two crossings close
    # to each other, which trimming must separate.
    apart = abs(shift) or tolerance
    smooth = smooth_turn(moved, tolerance)
    segments = trimmed(shape, moved, apart, smooth) if moved else whole(shape)
    loops = loops_of(shape, segments, moved, tolerance)
    if loops is None:
        return None
    if len(loops.first) < 2:
        return Attempt([], True)
    fit = _fit_clear_of_itself(shape, loops, moved, tolerance)
    contours = [
        Contour(
            fit.arcs[a:b],
            fit.weights[a:b],
            distance=distance,
            y_down=shape.y_down,
            unit=shape.unit,
            page=shape.page,
        )
        for a, b in pairwise(fit.first)
    ]
    # After a shift nothing runs back along itself: turns back are tips, nearly as sharp as cusps.
    return Attempt(contours, fit.clear and not (fit.turns_back and shift == 0.0))


def _fit_clear_of_itself(shape: Shape, loops: Loops, distance: float, tolerance: float) -> LoopArcs:
    """Fit few arcs to loops, then again, closer, to free runs whose arcs meet others."""
    runs, starts = runs_of(shape, loops, distance, tolerance)
    allowed = np.full(len(runs.kind), tolerance)
    fitted = _fitted(shape, runs, distance, allowed)
    left = _ROUNDS
    while True:
        found = _without_stubs(fitted, runs.kind, starts, tolerance)
        first = np.searchsorted(found.owner, starts)
        following = np.arange(1, len(found.arcs) + 1)
        following[first[1:] - 1] = first[:-1]
        meeting = np.unique(found.owner[_meeting(found, following)])
        # Lines and circles do not depend on the tolerance.
        again = meeting[runs.kind[meeting] == FREE]
        left -= 1
        if not len(again) or not left:
            break
        allowed[again] *= _CLOSER
        fitted = _refitted(shape, runs, distance, allowed, fitted, again)
    arcs = found.arcs + shape.boundary.origin
    return LoopArcs(arcs, found.weights, first, not len(meeting), _turns_back(arcs, following))


def _refitted(
    shape: Shape, runs: Runs, distance: float, tolerance: Floats, fitted: RunArcs, again: Ints
) -> RunArcs:
    """Fit some runs again, and keep the arcs of all others."""
    rows = [np.arange(a, b) for a, b in zip(runs.first[again], runs.first[again + 1], strict=True)]
    some = Runs(
        selected(runs.segments, np.concatenate(rows)),
        np.cumsum([0, *map(len, rows)]),
        runs.kind[again],
        runs.center[again],
        runs.sweep[again],
        runs.closed[again],
    )
    new = _fitted(shape, some, distance, tolerance[again])
    kept = ~np.isin(fitted.owner, again)
    owner = np.concatenate([fitted.owner[kept], again[new.owner]])
    _check_count(len(owner), tolerance)
    order = np.argsort(owner, kind="stable")
    return RunArcs(
        np.concatenate([fitted.arcs[kept], new.arcs])[order],
        np.concatenate([fitted.weights[kept], new.weights])[order],
        owner[order],
    )


def _without_stubs(fitted: RunArcs, kind: Ints, starts: Ints, tolerance: float) -> RunArcs:
    """Leave out stubs, and let a longer free neighbor reach to where they led.

    Noise in directions leaves them next to ends that stand still.
    """
    arcs, weights, owner = fitted
    loop = np.searchsorted(starts, owner, side="right") - 1
    first = np.flatnonzero(np.diff(loop, prepend=-1))
    size = np.maximum.reduceat(arcs.max(axis=1), first) - np.minimum.reduceat(
        arcs.min(axis=1), first
    )
    extent = np.ptp(arcs, axis=1).max(axis=1)
    stub = extent <= np.minimum(_STUB * size.max(axis=1), _LOOSE * tolerance)[loop]
    if not stub.any():
        return fitted
    arcs, kept = arcs.copy(), ~stub
    count = np.bincount(loop)
    for at in np.flatnonzero(stub).tolist():
        begin, many = int(first[loop[at]]), int(count[loop[at]])
        around = [begin + (at - begin + step) % many for step in (-1, 1)]
        # A line or a circle would not stay what it is.
        bends = [not stub[k] and kind[owner[k]] == FREE for k in around]
        if not any(bends):
            kept[at] = True
        elif bends[0] and (not bends[1] or extent[around[0]] >= extent[around[1]]):
            arcs[around[0], 2] = arcs[at, 2]
        else:
            arcs[around[1], 0] = arcs[at, 0]
    return RunArcs(arcs[kept], weights[kept], owner[kept])


def _turns_back(arcs: Floats, following: Ints) -> bool:
    """Whether a contour has a cusp, as where the skeleton runs along the level, to rounding."""
    before = arcs[:, 2] - arcs[:, 1]
    after = arcs[following, 1] - arcs[following, 0]
    return bool((np.abs(angles(before, after)) > np.pi - CUSP).any())


def _fitted(shape: Shape, runs: Runs, distance: float, tolerance: Floats) -> RunArcs:
    """Fit arcs to all runs, each within its tolerance."""
    from splinesdf.offsets.kernels.conic_fit import fit_runs  # Numba loads only when it is used

    room = 4 * len(runs.kind) + 64
    while True:
        arcs, weights = np.empty((room, 3, 2)), np.empty(room)
        owner = np.empty(room, dtype=np.int64)
        filled = RunArcs(arcs, weights, owner)
        count = fit_runs(parallels_at(shape, distance), runs, tolerance, filled)
        _check_count(count, tolerance)
        if count <= room:
            return RunArcs(arcs[:count], weights[:count], owner[:count])
        room = count


def _check_count(count: int, tolerance: Floats) -> None:
    """Refuse tolerances that take more arcs than anybody has a use for."""
    from splinesdf.offsets.kernels.conic_fit import MOST_ARCS

    if count > MOST_ARCS:
        raise InputError(
            f"expected a tolerance for which {MOST_ARCS:,} arcs are enough, got "
            f"{tolerance.min():.2g}: raise it"
        )


def _in_slabs(points: Floats) -> Ints:
    """An order of points (n, 2) by slabs across x, in each by y: (n,)."""
    count = len(points)
    slab = np.empty(count, dtype=np.int64)
    slab[np.argsort(points[:, 0])] = np.arange(count) // (int(count**0.5) + 1)
    return np.lexsort((points[:, 1], slab))


def _meeting(fitted: RunArcs, following: Ints) -> Ints:
    """Find arcs that meet other arcs elsewhere than at a common end."""
    from splinesdf.contours.kernels.meetings import (
        find_meetings,  # Numba loads only when it is used
    )

    arcs, weights, _ = fitted
    order = _in_slabs(arcs[:, 1])
    room = 64
    while True:
        pairs = np.empty((room, 2), dtype=np.int64)
        largest = float(np.abs(arcs).max())
        apart = (_APART * largest, _FROM_CORNER * largest)
        count = find_meetings(arcs, weights, following, order, apart, pairs)
        if count <= room:
            return pairs[:count].ravel()
        room = count
