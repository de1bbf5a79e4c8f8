"""Judges of offsets: a shape, a distance, a tolerance, and the contours that claim to be the level.

    judge ─┬─ chain      closed, joints the same to the bit, no arc without a direction
           ├─ side       the inside on the left
           ├─ parent     as the polygons lie in each other, by GEOS
           ├─ deviation  the exact distance, densely, and more densely around the worst
           ├─ jump       tangents agree, or the exact gradient jumps likewise (offset_corners)
           ├─ blunt      where the exact gradient jumps there is a corner
           ├─ meet       arcs have nothing in common but their joints (offset_crossings)
           ├─ count      as many loops as the exact distance has (offset_count)
           └─ missing    what lies at the distance along normals of the boundary is there

Of the package they use `ss.project` and `Contour`'s own points, nothing that makes offsets.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely

import splinesdf as ss
from splinesdf.contours.contour import Contour, evaluate, halve
from tests import oracles
from tests.offset_corners import blunt_corners, corners_of, false_corners
from tests.offset_count import loop_counts
from tests.offset_crossings import meetings

EPS = float(np.finfo(np.float64).eps)
# Rounding of distances and coordinates, a share of the largest coordinate: a few units.
ROUNDING = 16.0 * EPS
# Points an arc, an arc's error having a few bumps; arcs whose worst spot is looked at more closely.
SAMPLES = np.linspace(0.0, 1.0, 33)
WORST = 64
# Normals for `missing`.
NORMALS = 2000
# Where the level runs to a sharp point, its ends may miss the exact one by more than the
# tolerance: this many. More: lost ends go unseen.
TIP = 20.0


@dataclass
class Verdict:
    """What was found wrong: pairs of a kind (see the module) and words; and what was measured."""

    failures: list[tuple[str, str]] = field(default_factory=list)
    undecided: list[str] = field(default_factory=list)
    deviation: float = 0.0
    corners: int = 0

    def fail(self, kind: str, text: str) -> None:
        self.failures.append((kind, text))

    @property
    def kinds(self) -> set[str]:
        return {kind for kind, _ in self.failures}


def judge(
    shape: ss.Shape,
    contours: Sequence[Contour],
    distance: float,
    tolerance: float,
    *,
    counts: Sequence[int] | None = None,
    seed: int = 0,
) -> Verdict:
    """All checks of the contours of one distance; ``counts`` if `loop_counts` is known."""
    verdict = Verdict()
    check_count(verdict, contours, loop_counts(shape, distance) if counts is None else counts)
    check_missing(verdict, shape, contours, distance, tolerance, seed)
    if not contours:
        return verdict
    check_chains(verdict, contours, distance)
    check_side(verdict, shape, contours, tolerance)
    check_parents(verdict, contours, tolerance)
    check_deviation(verdict, shape, contours, distance, tolerance)
    corners = corners_of(contours)
    verdict.corners = len(corners.turn)
    for text in false_corners(shape, corners, distance, tolerance):
        verdict.fail("jump", text)
    for text in blunt_corners(shape, contours, corners, distance, tolerance):
        verdict.fail("blunt", text)
    for place in meetings(contours):
        verdict.fail("meet", f"arcs meet at {place}")
    return verdict


def check_count(verdict: Verdict, contours: Sequence[Contour], counts: Sequence[int]) -> None:
    if not counts[0] <= len(contours) <= counts[-1]:
        verdict.fail("count", f"{len(contours)} loops instead of {list(counts)}")
    elif len(counts) > 1:
        verdict.undecided.append(f"{len(contours)} loops, may be any of {list(counts)}")


def check_chains(verdict: Verdict, contours: Sequence[Contour], distance: float) -> None:
    for number, contour in enumerate(contours):
        arcs = contour.arcs
        if not contour.closed or not np.array_equal(arcs[:, 2], np.roll(arcs[:, 0], -1, axis=0)):
            verdict.fail("chain", f"loop {number} is not closed")
        if contour.distance != distance:
            verdict.fail("chain", f"loop {number} is of distance {contour.distance!r}")
        if (arcs[:, 0] == arcs[:, 2]).all(axis=-1).any():
            verdict.fail("chain", f"loop {number} has an arc that ends where it starts")


def check_side(
    verdict: Verdict, shape: ss.Shape, contours: Sequence[Contour], tolerance: float
) -> None:
    """The distance grows from left to right across the middle of each arc.

    Measured over a small part of the tolerance, so that thin places do not matter, and above
    rounding; arcs too short for that are left out.
    """
    step = max(1e-3 * tolerance, 1e-11 * shape.size)
    for number, contour in enumerate(contours):
        chords = contour.arcs[:, 2] - contour.arcs[:, 0]
        length = np.hypot(*chords.T)
        middles = evaluate(contour.arcs, contour.weights, np.array([0.5]))[:, 0]
        right = (
            step * np.stack([chords[:, 1], -chords[:, 0]], -1) / np.maximum(length, EPS)[:, None]
        )
        grows = ss.signed_distance(shape, middles + right)
        grows -= ss.signed_distance(shape, middles - right)
        wrong = (grows < -0.01 * step) & (length > 4.0 * step)
        if wrong.any():
            verdict.fail("side", f"loop {number}: inside on the right at {middles[wrong][0]}")


def check_parents(verdict: Verdict, contours: Sequence[Contour], tolerance: float) -> None:
    """The smallest polygon around most of a loop's joints is its parent; signs alternate."""
    fine = max(0.01 * tolerance, 1e-9 * extent(contours))
    polygons = [shapely.Polygon(outline(contour, fine)) for contour in contours]
    areas = np.array([polygon.area for polygon in polygons])
    for polygon in polygons:
        shapely.prepare(polygon)
    for number, contour in enumerate(contours):
        joints = contour.arcs[:: max(1, len(contour.arcs) // 9), 0]
        inside = [shapely.contains_xy(p, joints).mean() > 0.5 for p in polygons]
        around = [k for k in np.flatnonzero(inside) if k != number]
        expected = contours[min(around, key=lambda k: areas[k])] if around else None
        if contour.parent is not expected:
            verdict.fail("parent", f"loop {number} of {len(contours)} at depth {len(around)}")
        if (contour.area > 0.0) != (len(around) % 2 == 0):
            verdict.fail("side", f"loop {number} has area {contour.area:.3g} at {len(around)}")


def outline(contour: Contour, fine: float) -> np.ndarray:
    points = contour.points(fine)
    if len(points) < 4:  # no polygon for GEOS
        points = evaluate(contour.arcs, contour.weights, SAMPLES).reshape(-1, 2)
    return points


def extent(contours: Sequence[Contour]) -> float:
    points = np.concatenate([contour.arcs[:, 0] for contour in contours])
    return float(np.ptp(points, axis=0).max())


def slack(shape: ss.Shape, distance: float) -> float:
    """What rounding may add to a distance."""
    return ROUNDING * (float(np.abs(shape.control).max()) + abs(distance))


def check_deviation(
    verdict: Verdict,
    shape: ss.Shape,
    contours: Sequence[Contour],
    distance: float,
    tolerance: float,
) -> None:
    arcs = np.concatenate([contour.arcs for contour in contours])
    weights = np.concatenate([contour.weights for contour in contours])
    arcs, weights = shortened(arcs, weights, shape.size / 100.0)
    miss = np.abs(ss.signed_distance(shape, evaluate(arcs, weights, SAMPLES)) - distance)
    worst = float(miss.max())
    step = SAMPLES[1]
    rows = np.argsort(-miss.max(axis=1))[:WORST]
    spots = SAMPLES[miss[rows].argmax(axis=1)]
    for _ in range(3):
        around = np.clip(spots[:, None] + step * np.linspace(-1.0, 1.0, 17), 0.0, 1.0)
        points = np.stack(
            [evaluate(arcs[[r]], weights[[r]], t)[0] for r, t in zip(rows, around, strict=True)]
        )
        miss = np.abs(ss.signed_distance(shape, points) - distance)
        spots, step = around[np.arange(len(rows)), miss.argmax(axis=1)], step / 8.0
        worst = max(worst, float(miss.max()))
    verdict.deviation = worst
    if worst > tolerance + slack(shape, distance):
        verdict.fail("deviation", f"{worst / tolerance:.4f} tolerances")


def shortened(
    arcs: np.ndarray, weights: np.ndarray, longest: float
) -> tuple[np.ndarray, np.ndarray]:
    """The same arcs, halved until none is longer: a long one may pass something small."""
    while (long := np.hypot(*(arcs[:, 2] - arcs[:, 0]).T) > longest).any():
        arcs, weights = halve(arcs, weights, long)
    return arcs, weights


def normals(shape: ss.Shape, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Random points of what was drawn, and unit normals there, to either side."""
    rng = np.random.default_rng(seed)
    length = [
        np.linalg.norm(np.diff(oracles.piece(shape, i), axis=0), axis=1).sum()
        for i in range(shape.piece_count)
    ]
    pieces = rng.choice(shape.piece_count, size=count, p=np.array(length) / np.sum(length))
    points, ways = places_and_ways(shape, pieces, rng.random(count))
    lengths = np.linalg.norm(ways, axis=1)
    sign = rng.choice([-1.0, 1.0], count)
    good = lengths > 0.0
    normal = np.stack([-ways[:, 1], ways[:, 0]], -1)[good] * (sign / lengths)[good, None]
    return points[good], normal


def places_and_ways(
    shape: ss.Shape, pieces: np.ndarray, t: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Points of pieces at parameters, and the last two control points' difference: (n, 2) each."""
    degrees = np.diff(shape.starts)[pieces] - 1
    places, ways = np.empty((len(pieces), 2)), np.empty((len(pieces), 2))
    for degree in np.unique(degrees):
        rows = np.flatnonzero(degrees == degree)
        s = t[rows, None, None]
        control = shape.control[shape.starts[pieces[rows], None] + np.arange(degree + 1)]
        while control.shape[1] > 2:
            control = (1.0 - s) * control[:, :-1] + s * control[:, 1:]
        places[rows] = (1.0 - s[:, 0]) * control[:, 0] + s[:, 0] * control[:, 1]
        ways[rows] = control[:, 1] - control[:, 0]
    return places, ways


def check_missing(
    verdict: Verdict,
    shape: ss.Shape,
    contours: Sequence[Contour],
    distance: float,
    tolerance: float,
    seed: int,
) -> None:
    """Points of the exact level, found along normals, are within the tolerance of the contours.

    Where the distance runs on along the normal beyond the level by a tolerance both ways, what is
    a tolerance wrong at most must cross there. Next to the skeleton ends may be lost, and where
    the distance does not run on at all, there is a ridge and no contour.
    """
    points, normal = normals(shape, NORMALS, seed)
    points = points + abs(distance) * normal
    rounding = 4.0 * slack(shape, distance)
    there = np.abs(ss.signed_distance(shape, points) - distance) < rounding
    points, normal = points[there], normal[there] * (1.0 if distance >= 0.0 else -1.0)
    crossed = np.ones(len(points), dtype=np.bool_)
    clear = crossed.copy()
    for way in (tolerance, -tolerance, 0.1 * tolerance, -0.1 * tolerance):
        grown = (ss.signed_distance(shape, points + way * normal) - distance) / way
        clear &= np.abs(grown - 1.0) < 1e-3 + rounding / abs(way)
        crossed &= grown > 0.9
    points, clear = points[crossed], clear[crossed]
    if len(points) == 0:
        return
    away = np.full(len(points), np.inf)
    if contours:
        fine = max(0.02 * tolerance, rounding)
        away = oracles.polyline_distance([c.points(fine) for c in contours], points)
        away -= fine + rounding
    wrong = away > np.where(clear, tolerance * 1.001, TIP * tolerance)
    if wrong.any() and (clear[wrong].any() or not verdict.undecided):
        k = np.argmax(np.where(wrong, away, 0.0))
        text = f"{np.sum(wrong)} of {len(points)} points, the worst {away[k] / tolerance:.3g} away"
        verdict.fail("missing", f"{text}, at {points[k]}")
