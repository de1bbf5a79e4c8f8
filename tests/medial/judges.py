"""Judges of a medial axis that share nothing with how it is found."""

from __future__ import annotations

import numpy as np

import splinesdf as ss


def disks_of(axis: ss.MedialAxis, spacing: float) -> np.ndarray:
    """Disks (n, 3) of all vertices and edges, on edges no farther apart than the spacing."""
    rows = [np.column_stack([axis.points, axis.radius])]
    for edge in axis.edges:
        # No arc is longer, in (x, y, r), than the polygon of its control points.
        reach = np.sqrt((np.diff(edge.arcs, axis=1) ** 2).sum(axis=2)).sum(axis=1)
        for k, most in enumerate(reach.tolist()):
            rows.append(edge.at(k + np.linspace(0.0, 1.0, int(most / spacing) + 3)))
    return np.concatenate(rows)


def off_distance(shape: ss.Shape, axis: ss.MedialAxis, *, exact: bool) -> float:
    """How far radii are off the exact distance, at 20 places of each edge, of the size."""
    worst = 0.0
    for edge in axis.edges:
        arcs = np.flatnonzero(edge.exact == exact)
        if not len(arcs):
            continue
        share = (np.arange(20) + 0.5) / 20
        disks = edge.at((arcs[:, None] + share).ravel())
        far = -ss.signed_distance(shape, disks[:, :2])
        worst = max(worst, float(np.abs(far - disks[:, 2]).max()))
    return worst / shape.size


def off_feet(shape: ss.Shape, axis: ss.MedialAxis) -> float:
    """How far feet at the ends of arcs are from being as far as the radius, of the size.

    Feet must be on the boundary, too.
    """
    worst = 0.0
    for edge in axis.edges:
        disks = np.concatenate([edge.arcs[:, 0], edge.arcs[-1:, 2]])
        far = np.hypot(*np.moveaxis(edge.feet - disks[:, None, :2], -1, 0))
        worst = max(worst, float(np.abs(far - disks[:, 2:]).max()))
        worst = max(worst, float(np.abs(ss.signed_distance(shape, edge.feet)).max()))
    return worst / shape.size


def off_reconstructed(shape: ss.Shape, axis: ss.MedialAxis, count: int, seed: int) -> float:
    """How far the union of disks is off the shape: max over disks of r - |x - c| is -u(x) inside.

    What is missing of an axis shows here, as what is surplus does.
    """
    rng = np.random.default_rng(seed)
    xmin, ymin, xmax, ymax = shape.box
    points = rng.uniform([xmin, ymin], [xmax, ymax], (count, 2))
    inside = -ss.signed_distance(shape, points)
    points, inside = points[inside > 0.0], inside[inside > 0.0]
    disks = disks_of(axis, 5e-4 * shape.size)
    depth = np.full(len(points), -np.inf)
    for part in np.array_split(disks, max(1, len(disks) * len(points) // 2_000_000)):
        away = np.hypot(*(points[:, None] - part[None, :, :2]).transpose(2, 0, 1))
        depth = np.maximum(depth, (part[None, :, 2] - away).max(axis=1))
    return float(np.abs(depth - inside).max()) / shape.size


def loops_and_parts(axis: ss.MedialAxis) -> tuple[int, int]:
    """Loops and connected parts of the graph, by union of the ends of edges."""
    parent = list(range(len(axis.radius)))

    def root(v: int) -> int:
        while parent[v] != v:
            v = parent[v]
        return v

    loops = parts = 0
    parts += len(parent)
    for edge in axis.edges:
        if edge.start < 0:
            loops, parts = loops + 1, parts + 1
            continue
        one, other = root(edge.start), root(edge.end)
        if one == other:
            loops += 1
        else:
            parent[one] = other
            parts -= 1
    return loops, parts
