"""Quadratic triangles judged by their nodes alone: does the mesh conform, what is the function?"""

from __future__ import annotations

from collections import Counter

import numpy as np

from splinesdf.meshes import Box
from splinesdf.splines.triangles import Triangles


def at_random(mesh: Triangles, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points uniform in the plane, (n, 2), and the function there by barycentric coordinates."""
    rng = np.random.default_rng(7)
    areas = signed_areas(mesh)
    which = rng.choice(len(areas), count, p=areas / areas.sum())
    bary = rng.dirichlet((1.0, 1.0, 1.0), count)
    corners, values = mesh.points[mesh.triangles[which, :3]], mesh.values[mesh.triangles[which]]
    a, b, c = bary.T
    shape = [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a]
    points = np.einsum("nk,nkd->nd", bary, corners)
    return points, np.einsum("kn,nk->n", np.array(shape), values)


def signed_areas(mesh: Triangles) -> np.ndarray:
    a, b, c = np.moveaxis(mesh.points[mesh.triangles[:, :3]], 1, 0)
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    return np.asarray(0.5 * (ux * vy - uy * vx))


def check_conforming(mesh: Triangles, domain: Box) -> None:
    """Triangles tile the domain edge to edge, and every node is there once and is used."""
    points, triangles = mesh.points, mesh.triangles
    xmin, ymin, xmax, ymax = domain
    # Nodes are as exact as their coordinates, lengths as differences of those.
    off = 8.0 * float(np.spacing(max(map(abs, domain))))
    width, height = xmax - xmin, ymax - ymin
    areas = signed_areas(mesh)
    assert areas.min() > 0.0
    assert abs(areas.sum() - width * height) <= 1e-12 * width * height + off * (width + height)
    assert np.array_equal(np.unique(triangles), np.arange(len(points)))
    assert len(np.unique(points, axis=0)) == len(points)
    corner = np.unique(triangles[:, :3])
    assert np.array_equal(corner, np.arange(len(corner)))

    middle_of: dict[tuple[int, int], int] = {}
    used: Counter[tuple[int, int]] = Counter()
    for row in triangles.tolist():
        for k in range(3):
            one, other = row[k], row[(k + 1) % 3]
            edge = min(one, other), max(one, other)
            used[edge] += 1
            assert middle_of.setdefault(edge, row[3 + k]) == row[3 + k]
    assert len(set(middle_of.values())) == len(middle_of)
    assert sorted(middle_of.values()) == list(range(len(corner), len(points)))
    ends = np.array(list(middle_of))
    gap = points[list(middle_of.values())] - points[ends].mean(axis=1)
    assert np.max(np.abs(gap)) <= off

    assert set(used.values()) <= {1, 2}
    border = np.array([edge for edge, times in used.items() if times == 1])
    one, other = points[border[:, 0]], points[border[:, 1]]
    on = [
        (one[:, axis] == line) & (other[:, axis] == line)
        for axis, line in ((0, xmin), (0, xmax), (1, ymin), (1, ymax))
    ]
    assert np.all(np.sum(on, axis=0) == 1)
    length = np.abs(one - other).sum()
    assert abs(length - 2.0 * (width + height)) <= len(border) * off
    # Euler: a disk.
    assert len(corner) - len(used) + len(triangles) == 1
