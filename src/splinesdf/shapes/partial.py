"""Parts of arcs between parameters, and groups of one degree each put together."""

from __future__ import annotations

import numpy as np

from splinesdf.arclets.tables import Arcs
from splinesdf.ground.arrays import Floats


def restrict(arcs: Arcs, interval: Floats) -> Arcs:
    """The parts of arcs between two parameters each."""
    low, high = interval.T
    count = len(low)
    result = Arcs._make(column.copy() for column in arcs)
    for at, part, whole in (
        (high, slice(0, count), high == 1.0),
        (low / high, slice(count, None), low == 0.0),
    ):
        cut = _split(result, at)
        result.control[~whole] = cut.control[part][~whole]
        result.start[~whole] = cut.start[part][~whole]
        result.interval[~whole] = cut.interval[part][~whole]
    return result


def _split(arcs: Arcs, at: float | Floats) -> Arcs:
    """Both parts of arcs of one degree, all first ones before all second ones."""
    t = np.broadcast_to(at, len(arcs.control))
    middle = arcs.interval[:, 0] + t * (arcs.interval[:, 1] - arcs.interval[:, 0])
    first, second = np.empty_like(arcs.control), np.empty_like(arcs.control)
    points = arcs.control
    last = points.shape[1] - 1
    for k in range(last + 1):  # de Casteljau
        first[:, k] = points[:, 0]
        second[:, last - k] = points[:, -1]
        points = (1.0 - t)[:, None, None] * points[:, :-1] + t[:, None, None] * points[:, 1:]
    between = arcs.start + (second[:, 0] - first[:, 0])
    return Arcs(
        np.concatenate([first, second]),
        np.concatenate([arcs.start, between]),
        np.concatenate([arcs.degree, arcs.degree]),
        np.concatenate([arcs.piece, arcs.piece]),
        np.concatenate(
            [
                np.column_stack([arcs.interval[:, 0], middle]),
                np.column_stack([middle, arcs.interval[:, 1]]),
            ]
        ),
    )


def ends_of(arcs: Arcs) -> Floats:
    """Where the last control points lie: (n, 2)."""
    return np.asarray(arcs.start + (arcs.control[:, -1] - arcs.control[:, 0]))


def together(groups: list[Arcs]) -> Arcs:
    """The arcs of groups of one degree each, with room for the highest degree."""
    most = max(group.control.shape[1] for group in groups)
    padded = [
        group._replace(control=np.pad(group.control, ((0, 0), (0, most - k), (0, 0))))
        for group in groups
        for k in [group.control.shape[1]]
    ]
    return Arcs._make(np.concatenate(column) for column in zip(*padded, strict=True))
