"""Contours as polylines, and how often the contours themselves turn about points.

    contours ─ arcs halved till chords are near ─→ lines ─ crossings ─→ winding number ─┐
                     └─ arcs still off their chords ─ halved beside points ─→ changes ──┴─→ result

A quarter circle of radius R within s of its chords takes R / s to the power 1/2 of them: millions,
where tolerances are fine and offsets far. So arcs are halved only so often, and once more where a
point is so near to a chord that it may lie between it and its arc.

Nothing of the package is used but the arrays of a `Contour`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from splinesdf.contours.contour import Contour
from tests import oracles

# The most halvings of an arc's parameter for its line; and of a chord's, beside points.
HALVINGS, MORE = 12, 16
# A conic's largest distance from a chord is that at the middle, but for what its weight changes.
BULGE = 2.0
# So many numbers at once.
CHUNK = 2**22


@dataclass(frozen=True)
class Line:
    """A contour as a closed polyline, and the stretch of the arc over each of its chords."""

    points: np.ndarray  # (n + 1, 2), the first one again at the end
    arc: np.ndarray  # (n,) rows of the contour
    ends: np.ndarray  # (n, 2) parameters
    off: np.ndarray  # (n,) how far the chord's middle is from the arc's
    arcs: np.ndarray
    weights: np.ndarray


def flattened(contour: Contour, origin: np.ndarray, sag: float) -> Line:
    """A contour moved by ``-origin``, each arc halved till chords are within ``sag``, or often."""
    arcs, weights = contour.arcs - origin, contour.weights
    halved, off = np.zeros(len(arcs), dtype=np.int64), np.zeros(len(arcs))
    left = np.arange(len(arcs))
    for halvings in range(HALVINGS + 1):
        halved[left] = halvings
        t = np.linspace(0.0, 1.0, 2 * 2**halvings + 1)
        points = on_arcs(arcs[left], weights[left], t)
        start, middle, end = points[:, :-1:2], points[:, 1::2], points[:, 2::2]
        off[left] = np.linalg.norm(middle - 0.5 * (start + end), axis=-1).max(axis=1, initial=0.0)
        left = left[off[left] > sag]
    row = np.repeat(np.arange(len(arcs)), 2**halved)
    first = np.repeat(np.cumsum(2**halved) - 2**halved, 2**halved)
    begin = (np.arange(len(row)) - first) / 2.0 ** halved[row]
    ends = np.stack([begin, begin + 0.5 ** halved[row]], axis=1)
    line = on_arc(arcs[row], weights[row], begin[:, None])[:, 0]
    return Line(np.concatenate([line, line[:1]]), row, ends, off[row], arcs, weights)


def winding_number(lines: Sequence[Line], points: np.ndarray, sag: float) -> np.ndarray:
    """How often the contours turn about points that are no nearer than ``sag``."""
    number = oracles.winding_number([line.points for line in lines], points)
    for line in lines:
        number += between(line, points, sag)
    return number


def between(line: Line, points: np.ndarray, sag: float) -> np.ndarray:
    """What the winding number about points changes from chords to their arcs."""
    change = np.zeros(len(points), dtype=np.int64)
    rough = np.flatnonzero(line.off > sag)
    if len(rough) == 0:
        return change
    chords = shapely.linestrings(np.stack([line.points[rough], line.points[rough + 1]], axis=1))
    within = BULGE * line.off[rough].max()
    near, which = shapely.STRtree(chords).query(
        shapely.points(points), predicate="dwithin", distance=within
    )
    if len(near) == 0:
        return change
    chord = rough[which]
    halvings = int(np.ceil(0.5 * np.log2(line.off[chord].max() / sag)))
    assert halvings <= MORE, f"arcs {line.off[chord].max():.3g} off their chords, for {sag:.3g}"
    step = np.linspace(0.0, 1.0, 2**halvings + 1)
    for part in np.array_split(np.arange(len(near)), 1 + len(near) * len(step) // CHUNK):
        rows, at = chord[part], points[near[part]]
        begin, end = line.ends[rows].T[:, :, None]
        row = line.arc[rows]
        fine = on_arc(line.arcs[row], line.weights[row], begin + step * (end - begin))
        # The very ends of the chord, which the other chords go on from.
        fine[:, 0], fine[:, -1] = line.points[rows], line.points[rows + 1]
        turns = crossings(fine, at) - crossings(fine[:, [0, -1]], at)
        np.add.at(change, near[part], turns)
    return change


def crossings(lines: np.ndarray, points: np.ndarray) -> np.ndarray:
    """How often open lines cross the ray in +x from a point each, up: (n, m, 2), (n, 2) -> (n,)."""
    x, y = points.T[:, :, None]
    a, b = lines[:, :-1], lines[:, 1:]
    left_of = (b[..., 0] - a[..., 0]) * (y - a[..., 1]) - (x - a[..., 0]) * (b[..., 1] - a[..., 1])
    above_a, above_b = a[..., 1] > y, b[..., 1] > y
    up, down = ~above_a & above_b & (left_of > 0), above_a & ~above_b & (left_of < 0)
    result: np.ndarray = up.sum(axis=1) - down.sum(axis=1)
    return result


def on_arcs(arcs: np.ndarray, weights: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Rational quadratic Bézier curves at parameters: (n, 3, 2), (n,), (m,) -> (n, m, 2)."""
    return on_arc(arcs, weights, np.broadcast_to(t, (len(arcs), len(t))))


def on_arc(arcs: np.ndarray, weights: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Each at its own parameters: (n, 3, 2), (n,), (n, m) -> (n, m, 2)."""
    a, b, c = (1.0 - t) ** 2, 2.0 * t * (1.0 - t) * weights[:, None], t**2
    heavy = a[..., None] * arcs[:, None, 0] + b[..., None] * arcs[:, None, 1]
    result: np.ndarray = (heavy + c[..., None] * arcs[:, None, 2]) / (a + b + c)[..., None]
    return result
