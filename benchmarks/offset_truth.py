"""The exact trimmed offset of a shape, and how far an answer is from it, both ways.

boundary ─normals of length d→ points ─exact distance is d?→ true offset ─┐
answer ─vertices and points between→ exact distances, less d              ├→ Hausdorff distance
answer ─as a fine polyline─────────────────────────────────── nearest ────┘
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import splinesdf as ss
from splinesdf.arclets.points import points_at, tangents_at
from splinesdf.arclets.tangents import end_tangents, turns
from splinesdf.contours.contour import Contour, evaluate

# Points of the boundary whose normals are shot. More: finer looks at what an answer lacks, slower;
# far fewer: a lost piece could fall between two.
SAMPLES = 20_000
# Normals shot in a corner's fan.
FAN = 65
# A normal's end belongs to the offset if its exact distance is the one asked to this share of the
# size. Exact distances are good to 1e-14 of it: smaller, and true points go missing; larger, and
# points a little beyond where the offset is trimmed are called true.
ROUNDING = 1e-13
# Halvings of the gap between the last true point and the first untrue one: ends where offsets are
# trimmed are then known to rounding.
HALVINGS = 45
# Where arcs and chords are asked for their distance; the error of a chord is largest at one third
# to two thirds or at its ends, an arc's has a few bumps.
ON_ARCS = np.linspace(0.0, 1.0, 17)
ON_CHORDS = (0.0, 0.25, 0.5, 0.75)
# What flattening an answer of arcs may add to its error, as a share of the tolerance.
FLATTENED = 0.01

# From parameters along a part of the boundary and a distance to ends of normals of that length.
NormalEnd = Callable[[np.ndarray, float], np.ndarray]


@dataclass(frozen=True)
class Truth:
    """The exact trimmed offset, as points of it."""

    shape: ss.Shape
    distance: float
    points: np.ndarray


@dataclass(frozen=True)
class Answer:
    """What a library gave: arcs, or closed polylines whose first point is not repeated."""

    contours: list[Contour]
    lines: list[np.ndarray]
    pieces: int  # arcs, or arcs and chords, or vertices, as the library counts
    numbers: int  # floating point numbers that describe them


@dataclass(frozen=True)
class Miss:
    """Lengths, the two halves of a Hausdorff distance."""

    spurious: float  # of the answer from the truth: the largest |exact distance - distance|
    lacking: float  # of the truth from the answer

    @property
    def worst(self) -> float:
        return max(self.spurious, self.lacking)


def true_offset(shape: ss.Shape, distance: float) -> Truth:
    """Ends of normals, in corners of fans of them, where nothing nearer trims them away."""
    runs = [*_smooth_runs(shape), *_fans(shape)]
    kept = []
    for at, normal_end in runs:
        points = normal_end(at, distance)
        true = _is_true(shape, points, distance)
        kept.append(points[true])
        kept.append(_trimmed_ends(shape, distance, at, true, normal_end))
    return Truth(shape, distance, np.concatenate(kept) if kept else np.empty((0, 2)))


def miss(truth: Truth, answer: Answer, tolerance: float) -> Miss:
    """Both halves of the Hausdorff distance; infinite where one side is empty and not the other."""
    if not answer.contours and not answer.lines:
        worst = np.inf if len(truth.points) else 0.0
        return Miss(0.0, worst)
    shape, distance = truth.shape, truth.distance
    asked = [evaluate(c.arcs, c.weights, ON_ARCS).reshape(-1, 2) for c in answer.contours]
    for line in answer.lines:
        to_next = np.roll(line, -1, axis=0) - line
        asked += [line + share * to_next for share in ON_CHORDS]
    spurious = max(
        float(np.abs(ss.signed_distance(shape, points) - distance).max()) for points in asked
    )
    if not len(truth.points):
        return Miss(np.inf, 0.0)
    closed = [np.concatenate([line, line[:1]]) for line in answer.lines]
    closed += [contour.points(FLATTENED * tolerance) for contour in answer.contours]
    return Miss(spurious, _farthest(truth.points, closed))


def _farthest(points: np.ndarray, lines: list[np.ndarray]) -> float:
    """The largest distance of the points from polylines, by a tree of runs of eight sides."""
    import shapely

    runs = []
    for line in lines:
        whole = (len(line) - 1) // 8
        starts = 8 * np.arange(whole)
        if whole:
            runs.append(shapely.linestrings(line[starts[:, None] + np.arange(9)]))
        if 8 * whole < len(line) - 1:
            runs.append(np.array([shapely.linestrings(line[8 * whole :])]))
    tree = shapely.STRtree(np.concatenate(runs))
    _, distance = tree.query_nearest(
        shapely.points(points), all_matches=False, return_distance=True
    )
    return float(np.max(distance))


def _is_true(shape: ss.Shape, points: np.ndarray, distance: float) -> np.ndarray:
    missed = np.abs(ss.signed_distance(shape, points) - distance)
    return np.asarray(missed <= ROUNDING * max(shape.size, abs(distance)))


def _smooth_runs(shape: ss.Shape) -> list[tuple[np.ndarray, NormalEnd]]:
    """Parameters along all arclets (number + share), and what they lead to."""
    boundary = shape.boundary
    each = max(9, SAMPLES // len(boundary.start))

    def normal_end(at: np.ndarray, distance: float) -> np.ndarray:
        arclet = np.minimum(np.floor(at).astype(np.int64), len(boundary.start) - 1)
        share = at - arclet
        tangent = tangents_at(boundary, arclet, share)
        feet = points_at(boundary, arclet, share) + boundary.origin
        return feet + distance * _outward(tangent)

    # All arclets in one run: a gap between two of them may look trimmed, and its halving then ends
    # at their ends, where normals are shot anyway.
    inside = np.linspace(0.0, 1.0, each)
    inside[-1] = 1.0 - 1e-12  # the share 1 would be the next arclet's 0
    return [((np.arange(len(boundary.start))[:, None] + inside).ravel(), normal_end)]


def _fans(shape: ss.Shape) -> list[tuple[np.ndarray, NormalEnd]]:
    """For every corner: shares of the turn, and the normals between those of its two sides."""
    boundary = shape.boundary
    turn = turns(boundary)
    _, arriving = end_tangents(boundary)
    result = []
    for corner in np.flatnonzero(np.abs(turn) > 1e-9):
        first = _outward(arriving[corner : corner + 1])[0]
        tip = boundary.end[corner] + boundary.origin

        def normal_end(
            at: np.ndarray,
            distance: float,
            first: np.ndarray = first,
            tip: np.ndarray = tip,
            angle: float = float(turn[corner]),
        ) -> np.ndarray:
            cosine, sine = np.cos(at * angle), np.sin(at * angle)
            spread = [cosine * first[0] - sine * first[1], sine * first[0] + cosine * first[1]]
            return tip + distance * np.stack(spread, axis=-1)

        result.append((np.linspace(0.0, 1.0, FAN), normal_end))
    return result


def _outward(tangents: np.ndarray) -> np.ndarray:
    """Unit normals to the right of tangents: the inside is on the boundary's left."""
    return np.stack([tangents[:, 1], -tangents[:, 0]], -1) / np.hypot(*tangents.T)[:, None]


def _trimmed_ends(
    shape: ss.Shape, distance: float, at: np.ndarray, true: np.ndarray, normal_end: NormalEnd
) -> np.ndarray:
    """True points as near as rounding allows to where the offset is trimmed."""
    change = np.flatnonzero(true[1:] != true[:-1])
    good = np.where(true[change], at[change], at[change + 1])
    bad = np.where(true[change], at[change + 1], at[change])
    for _ in range(HALVINGS if len(change) else 0):
        middle = 0.5 * (good + bad)
        fine = _is_true(shape, normal_end(middle, distance), distance)
        good, bad = np.where(fine, middle, good), np.where(fine, bad, middle)
    return normal_end(good, distance) if len(change) else np.empty((0, 2))
