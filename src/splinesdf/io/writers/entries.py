"""Ways into and out of a contour, and what is left standing along it: ramps, leads, tabs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from splinesdf.contours.conics import Element, Kind
from splinesdf.contours.contour import Contour
from splinesdf.distance.exact import signed_distance
from splinesdf.io.writers.paths import Path
from splinesdf.shapes.shape import Shape

# A ramp goes at most so often around a contour: around a short one it is steeper than asked.
_MOST_TURNS = 10
# A lead that does not fit is tried at these shares of its radius.
_SHORTER = (1.0, 0.5, 0.25, 0.125)
# Points along a lead are so many tolerances apart, at most so many: the exact distance between two
# is less by half of that at most, and a hundredth of a lead is less than what is seen of it.
_APART, _MOST_POINTS = 0.25, 20_000
# Of the length of a contour, tabs take this share at most: more would be no cut.
_TABBED = 0.5


class Step(NamedTuple):
    """A piece of the tool's way, and the height at its end; None: the height does not change."""

    piece: Element
    z: float | None = None


def length_of(piece: Element) -> float:
    """The length of a line or circular arc."""
    if piece.kind is Kind.LINE:
        return abs(piece.end - piece.start)
    return piece.radius * abs(piece.sweep)


def ramped(path: Path, above: float, below: float, slope: float) -> tuple[list[Step], Path, bool]:
    """Down along a closed path: the steps, the path from their end on, and whether it is too short.

    Parameters
    ----------
    above, below : float
        Heights at the beginning and the end.
    slope : float
        The way down for one along the path.
    """
    lengths = [length_of(piece) for piece in path.pieces]
    whole = sum(lengths)
    wanted = (above - below) / slope
    short = wanted > _MOST_TURNS * whole
    left = wanted = min(wanted, _MOST_TURNS * whole)

    def height(to_go: float) -> float:
        return below + (above - below) * to_go / wanted

    steps: list[Step] = []
    at = 0
    while True:  # at most so many times around
        piece, length = path.pieces[at], lengths[at]
        if left <= length:
            break
        left -= length
        steps += _sloping(piece, height(left + length), height(left))
        at = (at + 1) % len(path.pieces)
    share = left / length if length else 1.0
    before = piece if share >= 1.0 else piece.cut([share])[0]
    steps += _sloping(before, height(left), below)
    # But for rounding it is there.
    steps[-1] = steps[-1]._replace(z=below)
    return steps, path.entered(at, min(share, 1.0)), short


def _sloping(piece: Element, above: float, below: float) -> Iterator[Step]:
    """A piece in parts of half a turn at most, on an even slope."""
    parts = piece.parts(math.pi)
    for k, part in enumerate(parts, start=1):
        yield Step(part, above + (below - above) * k / len(parts))


class Room:
    """Where the tool may be beside contours, by the exact distance to those of each level."""

    def __init__(self, contours: Sequence[Contour], tolerance: float, climb: bool) -> None:
        self.tolerance, self.turn = tolerance, 1j if climb else -1j
        closed = [contour for contour in contours if contour.closed]
        self.levels = {
            level: Shape.from_contours([c for c in closed if c.distance == level])
            for level in {contour.distance for contour in closed}
        }
        inward = [level for level in self.levels if level < 0.0]
        self.widest = max(inward, default=None)

    def lead(self, path: Path, radius: float, out: bool) -> Element | None:
        """A quarter circle into a path or out of it, tangential; None if even a short one spoils.

        It has the radius asked, or a shorter one where that has no room.
        """
        at_path = path.pieces[-1].end if out else path.pieces[0].start
        ahead = _tangent(path.pieces[-1] if out else path.pieces[0], at_end=out)
        sweep = math.copysign(0.5 * math.pi, self.turn.imag)
        for share in _SHORTER:
            center = at_path + self.turn * share * radius * ahead
            aside = center + (share * radius if out else -share * radius) * ahead
            ends = (at_path, aside) if out else (aside, at_path)
            found = Element(Kind.CIRCLE, 0, 1, *ends, center, share * radius, sweep)
            if self._is_free(found, path.distance):
                return found
        return None

    def _is_free(self, piece: Element, level: float) -> bool:
        """Whether a lead is nowhere on the side of what stays, by half the tolerance."""
        count = math.ceil(length_of(piece) / (_APART * self.tolerance))
        shares = np.linspace(0.0, 1.0, min(count, _MOST_POINTS) + 1)
        at = piece.center + (piece.start - piece.center) * np.exp(1j * shares * piece.sweep)
        points = np.stack([at.real, at.imag], axis=-1)
        side = 1.0 if level >= 0.0 else -1.0
        free = side * signed_distance(self.levels[level], points)
        if level < 0.0 and self.widest is not None:
            free = np.minimum(free, -signed_distance(self.levels[self.widest], points))
        return bool(free.min() >= -_APART * self.tolerance)


def _tangent(piece: Element, at_end: bool) -> complex:
    """The direction at an end of a line or circular arc."""
    if piece.kind is Kind.LINE:
        way = piece.end - piece.start
    else:
        spoke = (piece.end if at_end else piece.start) - piece.center
        way = spoke * math.copysign(1.0, piece.sweep) * 1j
    return way / abs(way)


def with_tabs(path: Path, count: int, width: float, z: float, top: float) -> list[Step]:
    """A closed path at a height, each step's own, and higher over tabs, which are even along it.

    The first step is at ``z``: no tab is at the start.
    """
    lengths = [length_of(piece) for piece in path.pieces]
    ends = [0.0, *accumulate(lengths)]
    middles = [ends[-1] * (k + 0.5) / count for k in range(count)]
    marks = sorted(middle + side * 0.5 * width for middle in middles for side in (-1.0, 1.0))
    steps: list[Step] = []
    for piece, low, high in zip(path.pieces, ends, ends[1:], strict=False):
        inner = [mark for mark in marks if low < mark < high]
        pieces = piece.cut([(mark - low) / (high - low) for mark in inner]) if inner else [piece]
        for part, start in zip(pieces, [low, *inner], strict=True):
            within = sum(mark <= start for mark in marks) % 2 == 1
            steps.append(Step(part, top if within else z))
    return steps


def tabs_that_fit(path: Path, count: int, width: float) -> int:
    """How many tabs of a width a closed path has room for."""
    whole = sum(map(length_of, path.pieces))
    return min(count, math.floor(_TABBED * whole / width)) if width > 0.0 else count
