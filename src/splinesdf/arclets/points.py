"""Points and directions of arclets for many parameters at once, and angles between vectors."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from splinesdf.arclets.tables import Arclets
from splinesdf.ground.arrays import Floats, Ints


def points_at(arclets: Arclets, arclet: Ints, t: Floats) -> Floats:
    """Points of arclets (n,) at parameters (n,), relative to the origin; ends to the last bit."""
    result = np.zeros((len(arclet), 2))
    for k in range(arclets.power.shape[1] - 1, 0, -1):
        result = (result + arclets.power[arclet, k]) * t[:, None]
    result += arclets.start[arclet]
    return np.where((t == 1.0)[:, None], arclets.end[arclet], result)


def derivatives_at(arclets: Arclets, arclet: Ints, t: Floats) -> tuple[Floats, Floats]:
    """First and second derivatives of arclets (n,) at parameters (n,), each of shape (n, 2)."""
    first, second = np.zeros((len(arclet), 2)), np.zeros((len(arclet), 2))
    for k in range(arclets.power.shape[1] - 1, 0, -1):
        coefficient = arclets.power[arclet, k]
        second = second * t[:, None] + k * (k - 1) * coefficient if k > 1 else second
        first = first * t[:, None] + k * coefficient
    return first, second


def tangents_at(arclets: Arclets, arclet: Ints, t: Floats) -> Floats:
    """First derivatives, or the chord where the curve stands still for a moment, as in a cusp."""
    first, _ = derivatives_at(arclets, arclet, t)
    still = ~np.any(first != 0.0, axis=1)
    return np.where(still[:, None], (arclets.end - arclets.start)[arclet], first)


def previous_of(following: Ints) -> Ints:
    """What leads to each one, given what each leads to; -1 for none, both ways: (n,)."""
    linked = np.flatnonzero(following >= 0)
    previous = np.full(len(following), -1)
    previous[following[linked]] = linked
    return previous


def angles(first: Floats, second: Floats) -> Floats:
    """How far to turn left from one direction (n, 2) to the other, in (-pi, pi]: (n,)."""
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return np.asarray(np.arctan2(cross, np.sum(first * second, axis=1)))


def off_chord(points: Floats) -> Floats:
    """How far the middle ones of points (n, k, 2) are off the lines through the others: (n,)."""
    chord, apart = points[:, -1] - points[:, 0], points[:, 1:-1] - points[:, :1]
    length = np.hypot(chord[:, 0], chord[:, 1])
    cross = np.abs(chord[:, None, 0] * apart[..., 1] - chord[:, None, 1] * apart[..., 0])
    far = np.hypot(apart[..., 0], apart[..., 1]).max(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        off = cross.max(axis=1) / length
    return np.asarray(np.where(length > 0.0, off, far))


def bezier_points(control: Floats, t: Floats) -> tuple[Floats, Floats]:
    """Points and derivatives of pieces (..., degree + 1, 2) at parameters (...)."""
    grid = np.broadcast_shapes(control.shape[:-2], t.shape)
    points, slopes = np.empty((*grid, 2)), np.empty((*grid, 2))
    degree, s = control.shape[-2] - 1, 1.0 - t
    # One coordinate of one control point at a time: NumPy is slow along axes as short as these.
    for axis in (0, 1):
        row = [control[..., k, axis] for k in range(degree + 1)]
        while len(row) > 2:
            row = [s * one + t * other for one, other in pairwise(row)]
        start, end = row
        points[..., axis] = start + t * (end - start)
        slopes[..., axis] = degree * (end - start)
    return points, slopes


def evaluate_bezier(control: Floats, parameters: Floats) -> Floats:
    """Points of a Bézier piece by de Casteljau: (degree + 1, 2), (n,) -> (n, 2)."""
    t = parameters[:, None, None]
    points = np.broadcast_to(control, (len(parameters), *control.shape))
    while points.shape[1] > 1:
        points = (1.0 - t) * points[:, :-1] + t * points[:, 1:]
    return points[:, 0]


def sampled_loops(control: Floats, starts: Ints, loops: Ints, count: int) -> list[Floats]:
    """Loops of pieces as closed polylines, ``count`` equal steps a piece, one on a straight one."""
    parameters = np.linspace(0.0, 1.0, count, endpoint=False)
    result = []
    for first, last in pairwise(loops):
        pieces = [control[starts[i] : starts[i + 1]] for i in range(first, last)]
        parts = [
            evaluate_bezier(piece, parameters[:1] if len(piece) == 2 else parameters)
            for piece in pieces
        ]
        result.append(np.concatenate([*parts, parts[0][:1]]))
    return result
