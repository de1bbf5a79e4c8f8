"""The region that a stroke covers: a line of some width along paths, as drawing programs paint it.

path ──cut at corners and where it bends more than the width──> strips ─┐
        joins at corners, caps at open ends ────────────────────────────┴──> regions, united

A strip is what a segment across the path sweeps. Where the path bends less than half the width its
border is that of the two parallels; where it bends more, the inner half turns over at the center of
curvature, and both sides of that are strips of their own (sectors, along an arc). Each is filled
by itself, so that nothing cancels. Parallels are compiled to pieces that agree with them to a few
units in the last place.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.points import bezier_points
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats
from splinesdf.shapes.region import Loops, region
from splinesdf.shapes.sources.compiled import compile_curve
from splinesdf.shapes.sources.pen import Pen, cap, dot, join, turn_between
from splinesdf.shapes.sources.straight import powers, straightened

# Turns of less (radians) are none: compiled pieces and printed digits turn by less.
_SMOOTH = 1e-6
# Roots this near to the real line are on it, where a path bends just as much as the width.
_REAL = 1e-6
# A piece is an arc, of half the width's radius or less, if it bends by the same up to this share.
# Smaller: rounding cuts a circle as wide as the stroke into hundreds of stretches, and hundreds of
# pieces follow what it makes of the center; larger: what is open in the middle is closed.
_ROUND = 1e-7
# Of the largest coordinate: how far rounding moves second derivatives of pieces of degree 7; and
# how much of it is let pass. Smaller: far from the origin a circle as wide as the stroke is cut
# into slices; larger: as for _ROUND.
_ROUNDED, _MOST_ROUNDED = 2e-13, 1e-5
# A piece stands still where its speed is less than this share of its largest one.
_STILL = 1e-12
# Next to an end with a short handle a parallel is no better known than its direction: it is
# compiled to so many times the usual tolerance, 4 units in the last place, whichever suffices.
_LOOSER = (1.0, 1e2, 1e4)
# Centers of such an arc, seen from its ends, are one if nearer than this share of the half width.
# Larger: borders are off by so much; smaller: rounding puts a line between them.
_SAME = 1e-13
# Stretches of a piece shorter than this (of its parameter) are left out: rounding made them.
_SHORT = 1e-9


@dataclass(frozen=True)
class _Beside:
    """A curve beside a piece: at an offset to the left, or through the centers of curvature."""

    control: Floats
    start: float
    stop: float
    offset: float | None  # None for the evolute

    def __call__(self, t: Floats) -> Floats:
        points, first, second, still = _derivatives(self.control, t)
        speed = np.hypot(first[:, 0], first[:, 1])
        normal = np.stack([-first[:, 1], first[:, 0]], axis=1) / speed[:, None]
        if self.offset is not None:
            return np.asarray(points + self.offset * normal)
        bend = _cross(self.control, t, first, second) / speed**3
        # Where handles have no length the curve bends without bound, about itself.
        bent = (bend != 0.0) & ~still
        radius = np.where(bent, 1.0 / np.where(bent, bend, 1.0), 0.0)
        return np.asarray(points + radius[:, None] * normal)


def stroke_region(
    loops: Sequence[Sequence[Floats]],
    closed: Sequence[bool],
    pen: Pen,
    along: Sequence[Floats] | None = None,
) -> Loops:
    """Loops around what a stroke along paths covers, inside on the left; they may overlap.

    Parameters
    ----------
    loops : sequence of sequences of ndarray, shape (degree + 1, 2)
        The control points of each piece of each path.
    closed : sequence of bool
        Of each path whether its end and its start are joined; they are the same but for rounding.
        Otherwise it has caps there, even if they are the same.
    pen : Pen
    along : sequence of ndarray, shape (2,), optional
        Of each path the direction of its caps if it has no length, a unit vector. That of x unless
        given.
    """
    result: Loops = []
    for k, (loop, is_closed) in enumerate(zip(loops, closed, strict=True)):
        pieces = [piece for piece in loop if np.any(piece != piece[0])]
        if pieces:
            result += _stroked(pieces, is_closed, pen)
        elif len(loop) and pen.cap != "butt":
            result += dot(loop[0][0], np.array([1.0, 0.0]) if along is None else along[k], pen)
    return result


def _stroked(pieces: list[Floats], closed: bool, pen: Pen) -> Loops:
    if closed:
        pieces = [*pieces[:-1], np.concatenate([pieces[-1][:-1], pieces[0][:1]])]
    parts = [straightened(piece) for piece in pieces]
    pieces = [part for some in parts for part in some]
    # As renderers draw it: where a piece turns back the stroke is round, as if it bent there.
    turns = set(range(len(pieces))) - {last - 1 for last in accumulate(map(len, parts))}
    half = 0.5 * pen.width
    ends = [(end_tangent(piece, 0), end_tangent(piece, 1)) for piece in pieces]
    result: Loops = []
    corners = [
        k
        for k in range(len(pieces) if closed else len(pieces) - 1)
        if abs(turn_between(ends[k][1], ends[(k + 1) % len(pieces)][0])) > _SMOOTH
    ]
    for k in corners:
        following = ends[(k + 1) % len(pieces)][0]
        how = pen._replace(join="round") if k in turns else pen
        result += join(pieces[k][-1], ends[k][1], following, half, how)
    if not closed:
        result += cap(pieces[0][0], -ends[0][0], half, pen)
        result += cap(pieces[-1][-1], ends[-1][1], half, pen)
    for run in _runs(pieces, set(corners), half, closed):
        result += _band(run, half)
    return result


class _Stretch(NamedTuple):
    """A part of a piece, and how it bends throughout.

    ``gentle``: less than the half width; ``tight``: more; ``left``, ``right``: no less, to that
    side, and all of it an arc of this radius about one center.
    """

    piece: Floats
    low: float
    high: float
    bend: str
    radius: float = 0.0


def _runs(
    pieces: list[Floats], corners: set[int], half: float, closed: bool
) -> list[list[_Stretch]]:
    """Stretches that go on smoothly and are one band together; tight ones are by themselves."""
    runs: list[list[_Stretch]] = [[]]
    for k, piece in enumerate(pieces):
        for stretch in _stretches(piece, half):
            if runs[-1] and not _together(runs[-1][-1], stretch):
                runs.append([])
            runs[-1].append(stretch)
        if k in corners:
            runs.append([])
    runs = [run for run in runs if run]
    last = len(pieces) - 1
    goes_on = closed and len(runs) > 1 and last not in corners
    if goes_on and _together(runs[-1][-1], runs[0][0]):
        runs[0] = runs.pop() + runs[0]
    return runs


def _together(one: _Stretch, following: _Stretch) -> bool:
    same = abs(one.radius - following.radius) <= _ROUND * one.radius
    return one.bend == following.bend != "tight" and same


def _stretches(piece: Floats, half: float) -> list[_Stretch]:
    if len(piece) == 2:
        return [_Stretch(piece, 0.0, 1.0, "gentle")]
    radius = _radius(piece, half)
    if radius is not None:
        side = turn_between(end_tangent(piece, 0), end_tangent(piece, 1))
        return [_Stretch(piece, 0.0, 1.0, "left" if side > 0.0 else "right", radius)]
    result = []
    for low, high in pairwise(_turning_over(piece, half)):
        if high - low < _SHORT:
            continue
        bend, speed = _bend(piece, 0.5 * (low + high))
        tight = abs(bend) * half > speed**3
        result.append(_Stretch(piece, low, high, "tight" if tight else "gentle"))
    return result


def _bend(piece: Floats, t: float) -> tuple[float, float]:
    """The cross product of the first two derivatives, and the speed."""
    at = np.array([t])
    _, first, second, _ = _derivatives(piece, at)
    bend = float(_cross(piece, at, first, second)[0])
    return bend, float(np.hypot(*first[0]))


def _band(run: list[_Stretch], half: float) -> Loops:
    """What the segment across a run sweeps."""
    bend, piece = run[0].bend, run[0].piece
    if bend == "gentle":
        return _between(run, -half, half)
    if bend == "tight":
        turn, _ = _bend(piece, 0.5 * (run[0].low + run[0].high))
        inner = math.copysign(half, turn)
        pairs: list[tuple[float | None, float | None]] = [(0.0, -inner), (0.0, None), (None, inner)]
        return [loop for one, other in pairs for loop in _between(run, one, other)]
    outer = -half if bend == "left" else half
    loops = _sector(run, outer)
    # What lies across the center: where an arc is as round as the stroke that is the center.
    return loops if run[0].radius == half else loops + _sector(run, -outer)


def _radius(piece: Floats, half: float) -> float | None:
    """The radius of an arc that is no wider than the stroke; half the width if that is it."""
    t = np.linspace(0.0, 1.0, 17)
    _, first, second, still = _derivatives(piece, t)
    if still.any():
        return None
    bend = np.abs(_cross(piece, t, first, second)) / np.hypot(first[:, 0], first[:, 1]) ** 3
    # What rounding of the coordinates does to the second derivative, beside that of the piece.
    length = float(np.ptp(piece, axis=0).max())

    def is_arc(radius: float) -> bool:
        rounding = _ROUNDED * float(np.abs(piece).max()) * radius / length**2
        same = np.abs(bend * radius - 1.0) <= _ROUND + min(rounding, _MOST_ROUNDED)
        return bool(np.all(same))

    if is_arc(half):
        return half
    turn = abs(turn_between(end_tangent(piece, 0), end_tangent(piece, 1)))
    if turn <= _SMOOTH:
        return None
    radius = math.hypot(*(piece[-1] - piece[0])) / (2.0 * math.sin(0.5 * turn))
    return radius if radius < half and is_arc(radius) else None


def _sector(run: list[_Stretch], offset: float) -> Loops:
    """What lies between a parallel of such arcs and their center."""
    side = [part for piece, low, high, *_ in run for part in _beside(piece, low, high, offset)]
    if _is_loop(run):
        return region([side], "nonzero")
    # By first derivatives alone, so that bands before and after have their corners there as well:
    # what second ones of compiled arcs know is farther off than what counts as touching.
    radius = run[0].radius if run[0].bend == "left" else -run[0].radius
    spots = [run[0].piece[0] + radius * _left_of(run[0].piece, 0)]
    spots += [stretch.piece[-1] + radius * _left_of(stretch.piece, 1) for stretch in run]
    way = [side[-1][-1], spots[-1]]
    way += [spot for spot in spots[-2::-1] if np.abs(spot - way[-1]).max() > _SAME * abs(radius)]
    lines = [np.array(pair) for pair in pairwise([*way, side[0][0]])]
    return region([[*side, *lines]], "nonzero")


def _left_of(piece: Floats, end: int) -> Floats:
    """The unit vector to the left of the piece's start (0) or end (1)."""
    return np.asarray(np.array([-1.0, 1.0]) * end_tangent(piece, end)[::-1])


def _is_loop(run: list[_Stretch]) -> bool:
    """Whether a run ends where it starts, and as smoothly."""
    first, last = run[0], run[-1]
    if first.low > 0.0 or last.high < 1.0:
        return False
    if not np.array_equal(first.piece[0], last.piece[-1]):
        return False
    return abs(turn_between(end_tangent(last.piece, 1), end_tangent(first.piece, 0))) <= _SMOOTH


def _between(run: list[_Stretch], one: float | None, other: float | None) -> Loops:
    """What lies between two curves beside a run."""
    sides = []
    for offset in (one, other):
        side: list[Floats] = []
        for piece, low, high, *_ in run:
            side += _beside(piece, low, high, offset)
        sides.append(side)
    back = [part[::-1] for part in reversed(sides[1])]
    if _is_loop(run):
        loops = [sides[0], back]
    else:
        across = [sides[0][-1][-1], back[0][0]], [back[-1][-1], sides[0][0][0]]
        loops = [[*sides[0], np.array(across[0]), *back, np.array(across[1])]]
    # Gentle bands have the inside on the left throughout, also where they overlap themselves.
    return loops if run[0].bend == "gentle" else region(loops, "nonzero")


def _beside(piece: Floats, low: float, high: float, offset: float | None) -> list[Floats]:
    if len(piece) == 2 and offset is not None:
        return [piece + offset * _left_of(piece, 0)]
    curve, largest = _Beside(piece, low, high, offset), float(np.abs(piece).max())
    for looser in _LOOSER:
        with suppress(InputError):
            return compile_curve(curve, scale=looser * largest)
    return compile_curve(curve)


def _derivatives(control: Floats, t: Floats) -> tuple[Floats, Floats, Floats, Bools]:
    """Points, first and second derivatives, and where the piece has no speed."""
    points, rate = bezier_points(control, t)
    # From differences: next to an end with a short handle they are small, and known all the same.
    slopes = (len(control) - 1) * np.diff(control, axis=0)
    first, second = bezier_points(slopes, t)
    still = np.hypot(rate[:, 0], rate[:, 1]) <= _STILL * float(np.abs(slopes).max())
    # Where handles have no length the direction is that of the next difference.
    if still.any():
        first = np.where(still[:, None], np.where(t[:, None] < 0.5, second, -second), first)
    return points, first, second, still


def _cross(control: Floats, t: Floats, first: Floats, second: Floats) -> Floats:
    """The cross product of the first two derivatives.

    Of a cubic from its hodograph's control points, as next to an end with a short handle both
    derivatives have nearly the same direction.
    """
    if len(control) != 4:
        return np.asarray(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    a, b, c = 3.0 * np.diff(control, axis=0)
    ab, ac, bc = (one[0] * two[1] - one[1] * two[0] for one, two in ((a, b), (a, c), (b, c)))
    return np.asarray(2.0 * (ab * (1.0 - t) ** 2 + ac * t * (1.0 - t) + bc * t * t))


def end_tangent(piece: Floats, end: int) -> Floats:
    """The unit tangent at the start (0) or the end (1)."""
    steps = piece[1:] - piece[0] if end == 0 else piece[-1] - piece[-2::-1]
    size = np.hypot(steps[:, 0], steps[:, 1])
    step = steps[int(np.argmax(size > 1e-12 * size.max()))]
    return np.asarray(step / math.hypot(*step))


def _turning_over(piece: Floats, half: float) -> list[float]:
    """Parameters between which the piece bends less than half the width everywhere, or more."""
    x, y = (powers(piece[:, axis]) for axis in (0, 1))
    dx, dy = np.polyder(x), np.polyder(y)
    ddx, ddy = np.polyder(dx), np.polyder(dy)
    bend: Floats = np.polysub(np.polymul(dx, ddy), np.polymul(dy, ddx))
    speed = np.polyadd(np.polymul(dx, dx), np.polymul(dy, dy))
    cubed = np.polymul(speed, np.polymul(speed, speed))
    roots = np.roots(np.polysub(cubed, half * half * np.polymul(bend, bend)))
    real = roots.real[(np.abs(roots.imag) < _REAL) & (roots.real > 0.0) & (roots.real < 1.0)]
    return [0.0, *np.sort(real).tolist(), 1.0]
