"""Signed distances by other libraries, for `distance_speed`.

A peer is a function that gets ready for a question and gives what answers points, or None where
it has no answer. Polylines are within 1e-6 of the shape's size.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

import splinesdf as ss
from splinesdf.arclets.points import evaluate_bezier

DEVIATION = 1e-6
SAMPLES = 100_000  # of the kd-tree

Answer = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Question:
    shape: ss.Shape
    points: np.ndarray
    grid: tuple[int, int] | None  # nodes along x and y, if the points are a grid's
    domain: tuple[float, float, float, float]
    lines: list[np.ndarray]  # the shape's loops as closed polylines: making them is nobody's time


def limacon(t: np.ndarray, *, derivative: bool = False) -> np.ndarray:
    """The paper's second curve, or its derivative: (n,) -> (n, 2)."""
    if derivative:
        x, y = -3 * np.sin(t) - 2 * np.sin(2 * t), 3 * np.cos(t) + 2 * np.cos(2 * t)
        return np.stack([x, y], -1) / 10
    r = (3 + 2 * np.cos(t)) / 10
    return np.stack([1 / 5 + r * np.cos(t), 2 / 5 + r * np.sin(t)], -1)


def rings(shape: ss.Shape, deviation: float) -> list[np.ndarray]:
    """The loops as closed polylines, with as few equal steps a piece as the deviation needs."""
    result = []
    for first, last in zip(shape.loops[:-1], shape.loops[1:], strict=True):
        parts = []
        for control in (shape.piece(i) for i in range(first, last)):
            degree = len(control) - 1
            bend = np.linalg.norm(np.diff(control, 2, axis=0), axis=1).max() if degree > 1 else 0
            steps = max(1, math.ceil(math.sqrt(degree * (degree - 1) * bend / (8 * deviation))))
            parts.append(evaluate_bezier(control, np.arange(steps) / steps))
        result.append(np.concatenate([*parts, parts[0][:1]]))
    return result


def side_test(asked: Question) -> Answer:
    """-1 inside and 1 outside, by GEOS; for shapes whose loops do not cross."""
    import shapely

    region = reduce(
        lambda one, other: one.symmetric_difference(other),
        (shapely.Polygon(ring) for ring in asked.lines),
    )
    shapely.prepare(region)
    return lambda points: np.where(shapely.contains_xy(region, points), -1.0, 1.0)


def sides_of(lines: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The polylines' corners (n, 2), and the indices (n, 2) of the ends of their sides."""
    corners = np.concatenate([line[:-1] for line in lines])
    starts = np.cumsum([0] + [len(line) - 1 for line in lines])
    ends = np.arange(1, len(corners) + 1)
    ends[starts[1:] - 1] = starts[:-1]
    return corners, np.stack([np.arange(len(corners)), ends], -1)


def gpytoolbox_aabb(asked: Question) -> Answer:
    from gpytoolbox import squared_distance_precompute

    tree = squared_distance_precompute(*sides_of(asked.lines))
    side = side_test(asked)
    return lambda points: np.sqrt(tree.squared_distance(points)[0]) * side(points)


def fcpw_bvh(asked: Question) -> Answer:
    """In single precision, as it is made; distances come one by one from its list."""
    import fcpw

    corners, ends = sides_of(asked.lines)
    scene = fcpw.scene_2D()
    scene.set_object_count(1)
    scene.set_object_vertices(np.asfortranarray(corners, dtype=np.float32), 0)
    scene.set_object_line_segments(np.asfortranarray(ends, dtype=np.int32), 0)
    scene.build(fcpw.aggregate_type.bvh_surface_area, True)
    side = side_test(asked)

    def answer(points: np.ndarray) -> np.ndarray:
        found = fcpw.interaction_2D_list()
        reach = np.full(len(points), np.inf, dtype=np.float32)
        scene.find_closest_points(np.asfortranarray(points, dtype=np.float32), reach, found)
        return np.array([one.d for one in found]) * side(points)

    return answer


def shapely_ring(asked: Question) -> Answer:
    import shapely

    lines = shapely.multilinestrings([shapely.linestrings(line) for line in asked.lines])
    shapely.prepare(lines)
    side = side_test(asked)
    return lambda points: shapely.distance(lines, shapely.points(points)) * side(points)


def shapely_tree(asked: Question) -> Answer:
    """A tree of runs of eight sides: what GEOS can do if it is asked well."""
    import shapely

    runs = [
        shapely.linestrings(line[first : first + 9])
        for line in asked.lines
        for first in range(0, len(line) - 1, 8)
    ]
    tree, side = shapely.STRtree(runs), side_test(asked)

    def answer(points: np.ndarray) -> np.ndarray:
        _, distance = tree.query_nearest(
            shapely.points(points), all_matches=False, return_distance=True
        )
        return np.asarray(distance) * side(points)

    return answer


def kd_tree(asked: Question) -> Answer:
    from scipy.spatial import cKDTree

    each = max(1, SAMPLES // asked.shape.piece_count)
    t = np.arange(each) / each
    pieces = [asked.shape.piece(i) for i in range(asked.shape.piece_count)]
    tree = cKDTree(np.concatenate([evaluate_bezier(control, t) for control in pieces]))
    side = side_test(asked)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else -1
    return lambda points: tree.query(points, workers=cores)[0] * side(points)


def fast_marching(asked: Question) -> Answer | None:
    """From a level set that is good near the curve, if there is one, else from the sides."""
    import skfmm

    if asked.grid is None:
        return None
    level = limacon_level if asked.shape.name.startswith("limaçon") else side_test(asked)
    shape, spacing = _rows(asked)
    return lambda points: np.asarray(skfmm.distance(level(points).reshape(shape), spacing)).ravel()


def limacon_level(points: np.ndarray) -> np.ndarray:
    """Negative inside the limaçon, and of slope about one near it."""
    x, y = points[:, 0] - 1 / 5, points[:, 1] - 2 / 5
    r = np.maximum(np.hypot(x, y), 1e-9)
    return np.asarray(r - (3 + 2 * x / r) / 10)


def distance_transform(asked: Question) -> Answer | None:
    """From the nodes' sides: to the nearest node of the other side, less half a cell."""
    from scipy.ndimage import distance_transform_edt

    if asked.grid is None:
        return None
    side, (shape, spacing) = side_test(asked), _rows(asked)

    def answer(points: np.ndarray) -> np.ndarray:
        outside = side(points).reshape(shape) > 0
        out, into = (distance_transform_edt(mask, sampling=spacing) for mask in (outside, ~outside))
        half = 0.5 * max(spacing)
        return np.asarray(np.where(outside, out - half, half - into)).ravel()

    return answer


def _rows(asked: Question) -> tuple[tuple[int, int], Any]:
    """The grid as rows: (ny, nx), and the distances of the nodes along y and x."""
    if asked.grid is None:
        raise ValueError("expected a grid, got single points")
    (nx, ny), (xmin, ymin, xmax, ymax) = asked.grid, asked.domain
    return (ny, nx), [(ymax - ymin) / (ny - 1), (xmax - xmin) / (nx - 1)]


# What gets a peer ready, and how many points apart the ones are that it is given: some are slow.
PEERS: dict[str, tuple[Callable[[Question], Answer | None], int]] = {
    "gpytoolbox AABB": (gpytoolbox_aabb, 5),
    "FCPW": (fcpw_bvh, 5),
    "shapely ring": (shapely_ring, 331),
    "shapely STRtree": (shapely_tree, 19),
    "kd-tree of 1e5": (kd_tree, 97),
    "scikit-fmm": (fast_marching, 1),
    "scipy edt": (distance_transform, 1),
}
