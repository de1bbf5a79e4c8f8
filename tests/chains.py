"""Contours made by hand."""

from dataclasses import replace

import numpy as np

from splinesdf.contour import Contour


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
