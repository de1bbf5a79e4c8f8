"""Edges of a medial axis as polylines of disks, none of which is larger than the shape allows.

arcs (x, y, r) ──cut at two radii──> stretches ──halved──> chords ──each lowered by its sagitta──>

A chord between two disks of the axis runs beside it, where the shape is narrower: a cone that
moves along it would cut too deep. Points of a chord P0 P2 are off the arc with the control point P1
and the weight w by at most b (P1 - M), b = w / (1 + w), M the middle of the chord: the arc is
(1 - b') of a point of the chord and b' <= b of P1. As distances are 1-Lipschitz, the distance at a
point of the chord is at least its radius less b (|P1 - M| in the plane + that in r).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from splinesdf.contours.contour import halve
from splinesdf.errors import SplineSDFError
from splinesdf.ground.arrays import Bools, Floats
from splinesdf.medial.edge import AxisEdge

# Radii below this share of the largest are the cutting ones: rounding must not leave stretches
# that are nothing else.
_ROUNDING = 1e-12
# Halvings of an arc into chords: the sagitta goes down by four with each.
_HALVINGS = 30


class Groove(NamedTuple):
    """A polyline of disks between two places."""

    points: Floats  # (n, 3) x, y, r
    low: Floats  # (n,) how much smaller the disks are to be taken
    ends: tuple[int, int]  # vertices of the axis; -1 where it was cut


def grooves(
    edges: Sequence[AxisEdge], least: float, most: float, sagitta: float, off: float
) -> list[Groove]:
    """The parts of edges where radii are between two, as polylines.

    Parameters
    ----------
    edges : sequence of AxisEdge
    least, most : float
        Radii.
    sagitta : float
        How far chords may be off the arcs, in the plane and in r together.
    off : float
        How far arcs that are not exact may be off the axis.
    """
    result: list[Groove] = []
    for edge in edges:
        for arcs, weights, exact, ends in _stretches(edge, least, most):
            of = np.arange(len(arcs))
            for _ in range(_HALVINGS):
                rough = _sagittas(arcs, weights) > sagitta
                if not rough.any():
                    break
                of = np.repeat(of, np.where(rough, 2, 1))
                arcs, weights = halve(arcs, weights, rough)
            else:
                raise SplineSDFError(
                    f"an edge of the medial axis takes more than {_HALVINGS} halvings to be within "
                    f"{sagitta:.2g} of chords: raise the tolerance"
                )
            low = _sagittas(arcs, weights) + np.where(exact[of], 0.0, off)
            points = np.concatenate([arcs[:, 0], arcs[-1:, 2]])
            result.append(
                Groove(points, np.maximum(np.append(low, 0.0), np.append(0.0, low)), ends)
            )
    return result


def _sagittas(arcs: Floats, weights: Floats) -> Floats:
    aside = arcs[:, 1] - 0.5 * (arcs[:, 0] + arcs[:, 2])
    share = weights / (1.0 + weights)
    return np.asarray(share * (np.hypot(aside[:, 0], aside[:, 1]) + np.abs(aside[:, 2])))


def _stretches(
    edge: AxisEdge, least: float, most: float
) -> list[tuple[Floats, Floats, Bools, tuple[int, int]]]:
    """Runs of arcs with radii between two, and where they end."""
    pieces: list[tuple[Floats, float, bool]] = []
    for arc, weight, exact in zip(edge.arcs, edge.weights.tolist(), edge.exact, strict=True):
        cuts = sorted(t for level in (least, most) for t in _at_radius(arc[:, 2], weight, level))
        rest, before = (arc, weight), 0.0
        for t in cuts:
            one, rest = _cut(*rest, (t - before) / (1.0 - before))
            pieces.append((*one, bool(exact)))
            before = t
        pieces.append((*rest, bool(exact)))
    runs: list[list[int]] = [[]]
    slack = _ROUNDING * max(float(np.abs(edge.arcs[..., 2]).max()), least)
    for k, (arc, weight, _) in enumerate(pieces):
        middle = (0.5 * (arc[0, 2] + arc[2, 2]) + weight * arc[1, 2]) / (1.0 + weight)
        kept = least - slack <= middle <= most + slack and np.any(arc[0] != arc[2])
        if kept:
            runs[-1].append(k)
        elif runs[-1]:
            runs.append([])
    result = []
    for run in filter(None, runs):
        arcs = np.stack([pieces[k][0] for k in run])
        ends = (
            edge.start if run[0] == 0 else -1,
            edge.end if run[-1] == len(pieces) - 1 else -1,
        )
        weights = np.array([pieces[k][1] for k in run])
        result.append((arcs, weights, np.array([pieces[k][2] for k in run]), ends))
    return result


def _at_radius(radii: Floats, weight: float, level: float) -> list[float]:
    """Parameters inside an arc at which its radius is so much."""
    if not np.isfinite(level):
        return []
    a, b, c = (radii - level).tolist()
    # a (1 - t)^2 + 2 w b t (1 - t) + c t^2
    roots = np.roots([a - 2.0 * weight * b + c, 2.0 * (weight * b - a), a])
    real = roots.real[np.abs(roots.imag) <= 1e-12 * np.abs(roots)]
    return [float(t) for t in real if 1e-9 < t < 1.0 - 1e-9]


def _cut(arc: Floats, weight: float, t: float) -> tuple[tuple[Floats, float], tuple[Floats, float]]:
    """An arc in two at a parameter, each with weight 1 at its ends."""
    rows = np.column_stack([arc * np.array([[1.0], [weight], [1.0]]), [1.0, weight, 1.0]])
    one, two = (1.0 - t) * rows[:-1] + t * rows[1:]
    middle = (1.0 - t) * one + t * two
    parts = []
    for first, control, last in ((rows[0], one, middle), (middle, two, rows[2])):
        heavy = float(control[-1] / np.sqrt(first[-1] * last[-1]))
        parts.append((np.stack([row[:-1] / row[-1] for row in (first, control, last)]), heavy))
    return parts[0], parts[1]
