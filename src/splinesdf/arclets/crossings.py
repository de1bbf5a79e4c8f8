"""Where the arclets of a shape cross, touch or run on top of each other."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.interpolation import CHECKS, NODES, TO_CHECKS, TO_CONTROL
from splinesdf.arclets.tables import Arclets, Interpolation, Met
from splinesdf.arclets.tree import search_tree
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.limits import limits_in_use, too_much

# Steps between control points below this share of the arclet's size have no direction: at a
# cusp they are rounding.
_NO_STEP = 1e-12
# Room for crossings at first; a drawing with more is searched once more with as much as it needs.
_CAPACITY = 4096


class Crossings(NamedTuple):
    """Places that two arclets share; each row stands for two, one on each arclet."""

    pair: Ints  # (n, 2) arclets
    at: Floats  # (n, 2) their parameters


def find_crossings(arclets: Arclets, tolerance: float) -> Crossings:
    """All crossings and touching ends of different arclets, other than joints of neighbors.

    Parameters
    ----------
    arclets : Arclets
    tolerance : float
        Nearer than this counts as touching. Crossings within the tolerance of each other, as of
        arcs that touch without an angle, may be found as one or as several.

    Raises
    ------
    InputError
        If there are more, or more pairs of arcs side by side, than the limits in use.
    """
    from splinesdf.arclets.kernels import (
        crossings as intersections,  # Numba loads only when it is used
    )

    cone, among = _cones(arclets), search_tree(arclets)
    # Of three checks between each two nodes the middle one will do here: halving finds the rest.
    nodes = np.concatenate([NODES, CHECKS[1::3]])
    interpolation = Interpolation(
        to_control=TO_CONTROL,
        to_checks=TO_CHECKS[1::3].copy(),
        nodes=nodes,
        values=np.empty(len(nodes)),
        control=np.empty(len(TO_CONTROL)),
        spans=np.empty((intersections.DEPTH + 2, 2)),
    )
    limits, capacity = limits_in_use(), _CAPACITY
    while True:
        met = Met(
            pair=np.empty((capacity, 2), dtype=np.int64),
            at=np.empty((capacity, 2)),
            found=np.zeros(2, dtype=np.int64),
            most=np.array([limits.crossings, limits.pairs], dtype=np.int64),
        )
        intersections.fill_crossings(
            among.boxes,
            among.range,
            arclets.following,
            arclets.arcs,
            cone,
            tolerance,
            interpolation,
            met,
        )
        count = int(met.found[0])
        many = count > limits.crossings
        if many or met.found[1]:
            raise too_much(
                "crossings" if many else "pairs",
                f"expected contours with up to {limits.crossings:,} crossings and touching places"
                if many
                else f"expected contours with up to {limits.pairs:,} pairs of arcs side by side",
            )
        if count <= capacity:
            return Crossings(met.pair[:count], met.at[:count])
        capacity = count


def control_points(power: Floats) -> Floats:
    """Bernstein-Bézier points of arcs (n, degree + 1, 2) given in powers of the parameter."""
    return np.asarray(_from_powers(power.shape[1] - 1) @ power)


@cache
def _from_powers(degree: int) -> Floats:
    """The matrix that takes coefficients of powers to Bernstein-Bézier points."""
    return np.array(
        [
            [math.comb(k, j) / math.comb(degree, j) for j in range(degree + 1)]
            for k in range(degree + 1)
        ]
    )


def degrees(arclets: Arclets) -> Ints:
    """The degree of each arclet."""
    return arclets.arcs[:, 0].astype(np.int64)


def _cones(arclets: Arclets) -> Floats:
    """Middle and half width of the directions that each arclet takes, shape (n, 2)."""
    chord = arclets.end - arclets.start
    cone = np.zeros((len(chord), 2))
    cone[:, 0] = np.arctan2(chord[:, 1], chord[:, 0])
    degree = degrees(arclets)
    for d in np.unique(degree[degree > 1]):
        chosen = np.flatnonzero(degree == d)
        steps = np.diff(control_points(arclets.power[chosen, : d + 1]), axis=1)
        along = chord[chosen, None]
        across = along[..., 0] * steps[..., 1] - along[..., 1] * steps[..., 0]
        angle = np.arctan2(across, np.sum(along * steps, axis=-1))
        length = np.hypot(steps[..., 0], steps[..., 1])
        angle[length <= _NO_STEP * length.max(axis=1, keepdims=True)] = 0.0
        low, high = angle.min(axis=1), angle.max(axis=1)
        cone[chosen, 0] += 0.5 * (low + high)
        cone[chosen, 1] = 0.5 * (high - low)
    return cone
