"""Contours as paths of a tool: which way around, which next, and where each is entered.

    contours ─lines and circular arcs, turned to the direction asked─→ paths
             ─the nearest one next of those in which nothing is left to cut, entered at its
              nearest point─→ paths in order

What is cut out of the sheet may move: so holes come before the outline around them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from splinesdf.contours.biarcs import arc_elements
from splinesdf.contours.conics import Element, Kind
from splinesdf.contours.contour import Contour
from splinesdf.ground.arrays import Bools

# Arcs of a smaller sweep (radians) are straight where the nearest point is looked for: within 1e-7
# of their chords.
_FLAT = 1e-6


@dataclass(frozen=True)
class Path:
    """One contour as the tool follows it."""

    distance: float
    closed: bool
    pieces: list[Element]

    def entered(self, at: int, share: float) -> Path:
        """The same, closed, from a point of one of its pieces on."""
        piece = self.pieces[at]
        if piece.is_full:
            start = piece.cut([share])[0].end if 0.0 < share < 1.0 else piece.start
            whole = Element(
                *(piece.kind, piece.first, piece.count, start, start),
                *(piece.center, piece.radius, piece.sweep),
            )
            return Path(self.distance, True, [whole])
        if share in (0.0, 1.0):
            at = (at + int(share)) % len(self.pieces)
            return Path(self.distance, True, self.pieces[at:] + self.pieces[:at])
        before, after = piece.cut([share])
        pieces = [after, *self.pieces[at + 1 :], *self.pieces[:at], before]
        return Path(self.distance, True, pieces)


def path_of(contour: Contour, tolerance: float, direction: str, mirrored: bool) -> Path:
    """The contour with what stays on the right (climb) or on the left."""
    pieces = arc_elements(contour, tolerance=tolerance)
    # Contours have the side nearer to the inside on their left, where x turns into y; a mirror
    # changes sides. The shape is inside, and it stays if the way is around it.
    inside_on_left = not mirrored
    stays_on_left = inside_on_left == (contour.distance >= 0.0)
    if stays_on_left == (direction == "climb"):
        pieces = [
            Element(p.kind, p.first, p.count, p.end, p.start, p.center, p.radius, -p.sweep)
            for p in reversed(pieces)
        ]
    return Path(contour.distance, contour.closed, pieces)


def ordered(
    paths: Sequence[Path], around: Sequence[int], here: complex, snap: float
) -> Iterator[Path]:
    """The paths, always the one next that is nearest to where the tool is then.

    Only those in which nothing is left are asked; ``around`` is `smallest_around`'s.
    """
    near = _Near(paths)
    left_inside = np.bincount([k for k in around if k >= 0], minlength=len(paths))
    for _ in paths:
        row, share = near.nearest(here, left_inside == 0)
        chosen = int(near.path[row])
        path, at, length = paths[chosen], int(near.piece[row]), float(near.lengths[row])
        near = near.without(chosen)
        if around[chosen] >= 0:
            left_inside[around[chosen]] -= 1
        if path.closed:
            share = 0.0 if share * length < snap else share
            share = 1.0 if (1.0 - share) * length < snap else share
            path = path.entered(at, share)
        here = path.pieces[-1].end
        yield path


class _Near:
    """The pieces of paths as arrays, to be asked for the nearest point; of open ones the start."""

    def __init__(self, paths: Sequence[Path]) -> None:
        rows = [
            (i, k, piece, path.closed)
            for i, path in enumerate(paths)
            for k, piece in enumerate(path.pieces if path.closed else path.pieces[:1])
        ]
        self.path = np.array([i for i, *_ in rows])
        self.piece = np.array([k for _, k, *_ in rows])
        self.start = np.array([p.start for *_, p, _ in rows])
        self.way = np.array([p.end - p.start if closed else 0j for *_, p, closed in rows])
        self.center = np.array([p.center for *_, p, _ in rows])
        self.sweep = np.array([p.sweep for *_, p, _ in rows])
        # Of flatter arcs the chord is as near, and the center too far away to tell angles.
        self.round = np.array(
            [p.kind is Kind.CIRCLE and closed and abs(p.sweep) > _FLAT for *_, p, closed in rows]
        )
        radius = np.array([p.radius for *_, p, _ in rows])
        self.lengths = np.where(self.round, radius * np.abs(self.sweep), np.abs(self.way))

    def without(self, path: int) -> _Near:
        """The same, all but one path's."""
        result = object.__new__(_Near)
        kept = self.path != path
        vars(result).update({name: values[kept] for name, values in vars(self).items()})
        return result

    def nearest(self, here: complex, allowed: Bools) -> tuple[int, float]:
        """In which row, at which share of the piece, the nearest point of an allowed path is."""
        squares = np.maximum(np.abs(self.way) ** 2, np.finfo(np.float64).tiny)
        share = ((here - self.start) * self.way.conjugate()).real / squares
        share = np.clip(share, 0.0, 1.0)
        points = self.start + share * self.way
        on = self.round
        spokes, turns = self.start[on] - self.center[on], self.sweep[on]
        angle = np.angle((here - self.center[on]) / spokes) * np.sign(turns)
        # Where the circle has no arc the nearer end is nearest: angles beyond the middle of the
        # gap are before the start.
        gap = 2.0 * np.pi - np.abs(turns)
        angle = np.where(angle < -0.5 * gap, angle + 2.0 * np.pi, angle)
        share[on] = np.clip(angle / np.abs(turns), 0.0, 1.0)
        points[on] = self.center[on] + spokes * np.exp(1j * share[on] * turns)
        row = int(np.argmin(np.where(allowed[self.path], np.abs(points - here), np.inf)))
        return row, float(share[row])
