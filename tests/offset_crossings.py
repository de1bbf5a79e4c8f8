"""Where conic arcs meet though they should not: pairs of control triangles, halved till they part.

Arcs lie in their control triangles. Two arcs that are neighbors in a chain share a joint, and
there they must part as well: their triangles lie in two cones that have only the joint in common.

    boxes that meet (STRtree) ─→ pairs of triangles ─ apart? ─→ done
                                        ↑              │ no
                                        └── halve both ┴─→ as small as rounding: they meet
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from splinesdf.contours.contour import Contour

EPS = float(np.finfo(np.float64).eps)
# Shares of the largest coordinate. Triangles are apart if a line keeps them more than the first
# apart: halving rounds by about that. Triangles within the second that are not apart meet.
APART = 4.0 * EPS
SMALLEST = 64.0 * EPS
# Pairs at a time. Arcs that cross leave a few at each level; as many as this lie on each other.
MOST_PAIRS = 200_000
# Rounding of angles between sides of triangles that are not the smallest.
ANGLE = 1e-13
# Control polygons that turn by more than this (radians) run back over themselves.
FOLD = np.pi - 1e-6


@dataclass(frozen=True)
class Pairs:
    """Two arcs each, and whether the first ends in the second's start, and the reverse."""

    a: np.ndarray  # (n, 3, 2)
    b: np.ndarray
    weight_a: np.ndarray  # (n,)
    weight_b: np.ndarray
    a_then_b: np.ndarray  # (n,) of bool
    b_then_a: np.ndarray

    def __getitem__(self, which: np.ndarray) -> Pairs:
        return Pairs(*(getattr(self, name)[which] for name in self.__dataclass_fields__))


def meetings(contours: Sequence[Contour]) -> np.ndarray:
    """Places where arcs cross, touch, or lie on each other: (n, 2); where many do, one of them."""
    if not contours:
        return np.empty((0, 2))
    largest = max(float(np.abs(contour.arcs).max()) for contour in contours)
    pairs, places = first_pairs(contours), [folds(contours)]
    while len(pairs.a):
        pairs = pairs[~apart(pairs, APART * largest)]
        small = np.maximum(extent(pairs.a), extent(pairs.b)) < SMALLEST * largest
        places.append(pairs.a[small, 0])
        pairs = halved(pairs[~small])
        if len(pairs.a) > MOST_PAIRS:
            places.append(pairs.a[:1, 0])
            break
    return distinct(np.concatenate(places), 1e-9 * largest)


def folds(contours: Sequence[Contour]) -> np.ndarray:
    """Where an arc, a straight one say, runs back over itself."""
    arcs = np.concatenate([contour.arcs for contour in contours])
    into, out_of = arcs[:, 1] - arcs[:, 0], arcs[:, 2] - arcs[:, 1]
    return arcs[np.abs(angle(into, out_of)) > FOLD, 1]


def first_pairs(contours: Sequence[Contour]) -> Pairs:
    """All pairs of different arcs whose boxes meet."""
    arcs = np.concatenate([contour.arcs for contour in contours])
    weights = np.concatenate([contour.weights for contour in contours])
    counts = [len(contour.arcs) for contour in contours]
    firsts = np.cumsum([0, *counts[:-1]])
    following = np.concatenate(
        [first + (np.arange(n) + 1) % n for first, n in zip(firsts, counts, strict=True)]
    )
    boxes = shapely.box(*arcs.min(axis=1).T, *arcs.max(axis=1).T)
    i, j = shapely.STRtree(boxes).query(boxes)
    i, j = i[i < j], j[i < j]
    return Pairs(arcs[i], arcs[j], weights[i], weights[j], following[i] == j, following[j] == i)


def apart(pairs: Pairs, gap: float) -> np.ndarray:
    """Whether triangles have nothing in common but the joint they share, if any: (n,)."""
    joined = pairs.a_then_b | pairs.b_then_a
    result = triangles_apart(pairs.a, pairs.b, gap)
    one = pairs.a_then_b & ~pairs.b_then_a
    result[one] = cones_apart(pairs.a[one][:, [2, 1, 0]], pairs.b[one])
    other = pairs.b_then_a & ~pairs.a_then_b
    result[other] = cones_apart(pairs.a[other], pairs.b[other][:, [2, 1, 0]])
    result[joined & (pairs.a_then_b == pairs.b_then_a)] = False
    return result


def triangles_apart(a: np.ndarray, b: np.ndarray, gap: float) -> np.ndarray:
    """Whether a line parts them, perpendicular or parallel to one of their sides."""
    sides = np.concatenate([np.roll(a, -1, axis=1) - a, np.roll(b, -1, axis=1) - b], axis=1)
    axes = np.concatenate([np.stack([-sides[..., 1], sides[..., 0]], axis=-1), sides], axis=1)
    lengths = np.linalg.norm(axes, axis=-1, keepdims=True)
    axes = axes / np.where(lengths > 0.0, lengths, 1.0)
    origin = a[:, :1]
    along_a, along_b = (np.einsum("nkx,nmx->nkm", axes, t - origin) for t in (a, b))
    between = np.maximum(
        along_b.min(axis=-1) - along_a.max(axis=-1), along_a.min(axis=-1) - along_b.max(axis=-1)
    )
    return between.max(axis=-1, initial=-np.inf) > gap


def cones_apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Whether triangles with the same first corner have only that in common."""
    rays = [t[:, 1:] - t[:, :1] for t in (a, b)]
    for ray in rays:  # a control point on the corner: the other one tells the direction
        zero = ~ray.any(axis=-1)
        ray[zero[:, 0], 0] = ray[zero[:, 0], 1]
        ray[zero[:, 1], 1] = ray[zero[:, 1], 0]
    first, second = rays
    unit = first / np.linalg.norm(first, axis=-1, keepdims=True)
    axis = unit.sum(axis=1)
    half = np.abs(angle(axis, unit[:, 0]))
    one, other = (angle(axis, second[:, k]) for k in (0, 1))
    outside = np.minimum(np.abs(one), np.abs(other)) > half + ANGLE
    same_side = one * other > 0.0
    return outside & (same_side | (np.abs(one) + np.abs(other) > np.pi + ANGLE))


def halved(pairs: Pairs) -> Pairs:
    """Four pairs of halves each."""
    a, b = halves(pairs.a, pairs.weight_a), halves(pairs.b, pairs.weight_b)
    weight_a, weight_b = (np.sqrt(0.5 * (1.0 + w)) for w in (pairs.weight_a, pairs.weight_b))
    no = np.zeros(len(pairs.a), dtype=np.bool_)
    parts = [
        Pairs(
            a[i],
            b[j],
            weight_a,
            weight_b,
            pairs.a_then_b if (i, j) == (1, 0) else no,
            pairs.b_then_a if (i, j) == (0, 1) else no,
        )
        for i in (0, 1)
        for j in (0, 1)
    ]
    names = Pairs.__dataclass_fields__
    return Pairs(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def halves(arcs: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both halves of rational arcs, cut at the shoulder."""
    w = weights[:, None]
    into, out_of = ((arcs[:, k] + w * arcs[:, 1]) / (1.0 + w) for k in (0, 2))
    shoulder = 0.5 * (into + out_of)
    return (
        np.stack([arcs[:, 0], into, shoulder], axis=1),
        np.stack([shoulder, out_of, arcs[:, 2]], axis=1),
    )


def extent(triangles: np.ndarray) -> np.ndarray:
    return np.ptp(triangles, axis=1).max(axis=-1, initial=0.0)


def angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """By how much to turn the first vectors to the second, in (-pi, pi]."""
    cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.arctan2(cross, np.sum(a * b, axis=-1))


def distinct(points: np.ndarray, step: float) -> np.ndarray:
    """One of all points in the same cell of a fine grid."""
    _, first = np.unique(np.round(points / step), axis=0, return_index=True)
    return points[first]
