"""Tangents of arclets at their ends, and how the curve turns from one arclet to the next.

Two tables of them are needed. Bounds of curvature and the curvature of closest points are about
the curve as it is drawn: `end_tangents` are its derivatives. Offsets need directions that are more
than rounding, and the same from both sides of a smooth joint: `settled` leaves velocities out that
are noise, `splinesdf.arclets.joints` makes the rest. Elsewhere both differ by rounding only.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.crossings import control_points, degrees
from splinesdf.arclets.points import angles, previous_of, tangents_at
from splinesdf.arclets.tables import Arclets
from splinesdf.ground.arrays import Floats, Ints

# A velocity at an end is rounding, and the arclet stands still there, if its control step is below
# the first share of the largest coordinate and the second of that to the next control point.
# Larger: offsets are off by as much; smaller: their normals there are noise.
_STILL, _STANDS = 1e-12, 1e-3


class EndTangents(NamedTuple):
    """Vectors along the curve where every arclet starts and ends, of any length."""

    leaving: Floats  # (n, 2) at its start
    arriving: Floats  # (n, 2) at its end


def end_tangents(arclets: Arclets) -> EndTangents:
    """First derivatives at both ends, or the chord where they vanish."""
    every = np.arange(len(arclets.start))
    at_start = tangents_at(arclets, every, np.zeros(len(every)))
    return EndTangents(at_start, tangents_at(arclets, every, np.ones(len(every))))


def turns(arclets: Arclets) -> Floats:
    """Angles by which the curve turns left where arclets end, 0 if nothing follows: (n,)."""
    leaving, arriving = end_tangents(arclets)
    turn = angles(arriving, leaving[arclets.following])
    return np.where(arclets.following >= 0, turn, 0.0)


def turns_at_ends(arclets: Arclets) -> Floats:
    """Angles by which the curve turns left at the start and the end of each arclet: (n, 2)."""
    turn = turns(arclets)
    previous = previous_of(arclets.following)
    return np.column_stack([np.where(previous >= 0, turn[previous], 0.0), turn])


def settled(arclets: Arclets) -> tuple[Floats, EndTangents]:
    """Let arclets that stand still to rounding stand still exactly, and take tangents there.

    Returns
    -------
    arcs : ndarray
        As in `Arclets`, up to the power basis.
    tangents : EndTangents
        Velocities; where these are rounding, from the next derivative, and then the chord.
    """
    arcs = arclets.arcs.copy()
    degree = degrees(arclets)
    noise = _STILL * float(np.abs(arclets.boxes[0]).max() + np.abs(arclets.origin).max())
    tangents = EndTangents(*(arclets.end - arclets.start for _ in range(2)))
    for d in np.unique(degree[degree > 1]):
        rows = np.flatnonzero(degree == d)
        control = control_points(arclets.power[rows, : d + 1])
        stands = np.zeros(len(rows), dtype=np.bool_)
        for points, result, sign in (
            (control, tangents.leaving, 1.0),
            (control[:, ::-1], tangents.arriving, -1.0),
        ):
            step, next_step = (np.abs(points[:, k] - points[:, 0]).max(axis=1) for k in (1, 2))
            still = (step <= noise) & (step <= _STANDS * next_step)
            points[still, 1] = points[still, 0]
            stands |= still
            for k in (2, 1):
                vector = sign * d * (points[:, k] - points[:, 0])
                known = np.any(vector != 0.0, axis=1)
                result[rows[known]] = vector[known]
        for k in range(1, d + 1):
            arcs[rows[stands], 3 + 2 * k : 5 + 2 * k] = (
                math.comb(d, k) * np.diff(control[stands], n=k, axis=1)[:, 0]
            )
    return arcs, tangents


def led_on(tangents: EndTangents, following: Ints) -> EndTangents:
    """Give arclets without extent, which rounding leaves, the direction of their followers.

    So all of a corner in such a place is where it is reached, and no part of it is lost.
    """
    vectors = [vector.copy() for vector in tangents]
    for _ in range(len(following)):  # a row of them takes as many rounds as it is long
        still = [~np.any(vector != 0.0, axis=1) for vector in vectors]
        points = np.flatnonzero(still[0] | still[1])
        if len(points) in (0, len(following)):
            break
        vector = vectors[0][following[points]]
        for k in (0, 1):
            vectors[k][points] = vector
    return EndTangents(*vectors)
