"""Contours made by hand."""

from dataclasses import replace
from typing import Any

import numpy as np

from splinesdf.contours.contour import Contour


def circle(
    radius: float = 1.0, center: tuple[float, float] = (0.0, 0.0), distance: float = 0.0
) -> Contour:
    """Four exact quarters, counterclockwise where y points up."""
    corners = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    middles = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    arcs = np.stack([corners, middles, np.roll(corners, -1, axis=0)], axis=1)
    return Contour(radius * arcs + center, np.full(4, np.sqrt(0.5)), distance=distance)


def mixed_chain(*, y_down: bool = False, distance: float = -0.5) -> Contour:
    """Closed: a parabola, a straight arc, a hyperbola, a tilted ellipse, another line."""
    points = np.array(
        [
            [[0.0, 0.0], [20.0, -9.0], [40.0, 0.0]],
            [[40.0, 0.0], [50.0, 10.0], [60.0, 20.0]],
            [[60.0, 20.0], [75.0, 45.0], [52.0, 48.0]],
            [[52.0, 48.0], [20.0, 55.0], [3.0, 30.0]],
            [[3.0, 30.0], [1.5, 15.0], [0.0, 0.0]],
        ]
    )
    weights = np.array([1.0, 0.8, 3.5, 0.6, 1.0])
    return Contour(points, weights, distance=distance, y_down=y_down)


def open_chain() -> Contour:
    chain = mixed_chain()
    return replace(chain, arcs=chain.arcs[:3], weights=chain.weights[:3], closed=False)


def circular(
    radius: float = 1.0,
    center: complex = 0j,
    start: float = 0.0,
    sweep: float = 2.0 * np.pi,
    count: int = 4,
    **options: Any,
) -> Contour:
    """An arc of a circle in equal parts; closed if it goes once around."""
    angles = start + sweep * np.arange(count + 1) / count
    ends = radius * np.exp(1j * angles)
    half = 0.5 * sweep / count
    middles = ends[:-1] * np.exp(1j * half) / np.cos(half)
    closed = abs(sweep) == 2.0 * np.pi
    if closed:
        ends[-1] = ends[0]
    points = center + np.stack([ends[:-1], middles, ends[1:]], axis=1)
    arcs = np.stack([points.real, points.imag], axis=-1)
    return Contour(arcs, np.full(count, np.cos(half)), closed=closed, **options)


def line(*points: complex, weight: float = 1.0, closed: bool = False) -> Contour:
    """Straight arcs from point to point."""
    at = np.array([*points, points[0]] if closed else points)
    triples = np.stack([at[:-1], 0.5 * (at[:-1] + at[1:]), at[1:]], axis=1)
    arcs = np.stack([triples.real, triples.imag], axis=-1)
    return Contour(arcs, np.full(len(arcs), weight), closed=closed)


def joined(*parts: Contour, closed: bool = True) -> Contour:
    """One chain of several, each made to start where the one before ends."""
    arcs = np.concatenate([part.arcs for part in parts])
    arcs[1:, 0] = arcs[:-1, 2]
    if closed:
        arcs[-1, 2] = arcs[0, 0]
    return Contour(arcs, np.concatenate([part.weights for part in parts]), closed=closed)


def slot(length: float = 5.0, radius: float = 2.0, center: complex = 0j) -> Contour:
    """Two lines and two half circles, counterclockwise, beginning in the middle of the lower."""
    a, r, c = 0.5 * length, radius, center
    return joined(
        line(c - 1j * r, c + a - 1j * r),
        circular(r, c + a, -0.5 * np.pi, np.pi, 2),
        line(c + a + 1j * r, c - a + 1j * r),
        circular(r, c - a, 0.5 * np.pi, np.pi, 3),
        line(c - a - 1j * r, c - 1j * r),
    )


def ellipse(a: float = 3.0, b: float = 1.0, center: tuple[float, float] = (0.0, 0.0)) -> Contour:
    """Four exact quarters."""
    ring = circle()
    return replace(ring, arcs=ring.arcs * [a, b] + center)


def from_arc(contour: Contour, first: int) -> Contour:
    """The same closed contour, beginning with another arc."""
    return replace(
        contour,
        arcs=np.roll(contour.arcs, -first, axis=0),
        weights=np.roll(contour.weights, -first),
    )


def turned(contour: Contour) -> Contour:
    """The same contour the other way round."""
    return replace(
        contour,
        arcs=np.ascontiguousarray(contour.arcs[::-1, ::-1]),
        weights=contour.weights[::-1].copy(),
    )
