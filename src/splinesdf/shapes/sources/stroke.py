"""The region that a stroke covers: a line of some width along paths, as drawing programs paint it.

path ──cut at corners and where it bends more than the width──> strips ─┐
        joins at corners, caps at open ends ────────────────────────────┴──> regions, united

A strip is what a segment across the path sweeps. Where the path bends less than half the width its
border is that of the two parallels; where it bends more, the inner half turns over at the center of
curvature, and both sides of that are strips of their own. Each is filled by itself, so that nothing
cancels. Parallels are compiled to pieces that agree with them to a few units in the last place.
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
from splinesdf.shapes.sources.compiled import compile_arc, compile_curve
from splinesdf.shapes.sources.straight import powers, straightened

# Turns of less (radians) are none: compiled pieces and printed digits turn by less.
_SMOOTH = 1e-6
# Roots this near to the real line are on it, where a path bends just as much as the width.
_REAL = 1e-6
# A piece is an arc of half the width's radius if it bends by that up to this share. Smaller: where
# a circle is as wide as the stroke, rounding cuts it into hundreds of stretches; larger: what is
# open in the middle is closed.
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


class Pen(NamedTuple):
    """How a stroke is drawn."""

    width: float
    cap: str = "butt"  # butt, round, square
    join: str = "miter"  # miter, round, bevel
    miter_limit: float = 4.0


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
            result += _dot(loop[0][0], np.array([1.0, 0.0]) if along is None else along[k], pen)
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
        if abs(_turn(ends[k][1], ends[(k + 1) % len(pieces)][0])) > _SMOOTH
    ]
    for k in corners:
        following = ends[(k + 1) % len(pieces)][0]
        how = pen._replace(join="round") if k in turns else pen
        result += _join(pieces[k][-1], ends[k][1], following, half, how)
    if not closed:
        result += _cap(pieces[0][0], -ends[0][0], half, pen)
        result += _cap(pieces[-1][-1], ends[-1][1], half, pen)
    for run in _runs(pieces, set(corners), half, closed):
        result += _band(run, half)
    return result


class _Stretch(NamedTuple):
    """A part of a piece, and how it bends throughout.

    ``gentle``: less than the half width; ``tight``: more; ``left``, ``right``: just as much, to
    that side, so that it is an arc about one center.
    """

    piece: Floats
    low: float
    high: float
    bend: str


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
    return one.bend == following.bend != "tight"


def _stretches(piece: Floats, half: float) -> list[_Stretch]:
    if len(piece) == 2:
        return [_Stretch(piece, 0.0, 1.0, "gentle")]
    if _is_round(piece, half):
        side = _turn(end_tangent(piece, 0), end_tangent(piece, 1))
        return [_Stretch(piece, 0.0, 1.0, "left" if side > 0.0 else "right")]
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
    return _sector(run, -half if bend == "left" else half)


def _is_round(piece: Floats, half: float) -> bool:
    """Whether it bends by half the width throughout: an arc whose inner parallel is a point."""
    t = np.linspace(0.0, 1.0, 17)
    _, first, second, still = _derivatives(piece, t)
    if still.any():
        return False
    share = np.abs(_cross(piece, t, first, second)) * half / np.hypot(first[:, 0], first[:, 1]) ** 3
    # What rounding of the coordinates does to the second derivative, beside that of the piece.
    length = float(np.ptp(piece, axis=0).max())
    rounding = _ROUNDED * float(np.abs(piece).max()) * half / length**2
    return bool(np.all(np.abs(share - 1.0) <= _ROUND + min(rounding, _MOST_ROUNDED)))


def _sector(run: list[_Stretch], outer: float) -> Loops:
    """What lies between the outer parallel of such arcs and their center."""
    side = [part for piece, low, high, _ in run for part in _beside(piece, low, high, outer)]
    if _is_loop(run):
        return region([side], "nonzero")
    # By first derivatives alone, so that bands before and after have their corners there as well:
    # what second ones of compiled arcs know is farther off than what counts as touching.
    spots = [run[0].piece[0] - outer * _left_of(run[0].piece, 0)]
    spots += [stretch.piece[-1] - outer * _left_of(stretch.piece, 1) for stretch in run]
    way = [side[-1][-1], spots[-1]]
    way += [spot for spot in spots[-2::-1] if np.abs(spot - way[-1]).max() > _SAME * abs(outer)]
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
    return abs(_turn(end_tangent(last.piece, 1), end_tangent(first.piece, 0))) <= _SMOOTH


def _between(run: list[_Stretch], one: float | None, other: float | None) -> Loops:
    """What lies between two curves beside a run."""
    sides = []
    for offset in (one, other):
        side: list[Floats] = []
        for piece, low, high, _ in run:
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


def _turn(one: Floats, other: Floats) -> float:
    return math.atan2(one[0] * other[1] - one[1] * other[0], float(one @ other))


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


def _join(at: Floats, before: Floats, after: Floats, half: float, pen: Pen) -> Loops:
    """What is added where a path turns, on the outer side."""
    turn = _turn(before, after)
    side = -math.copysign(half, turn)
    if pen.join == "round":
        return _fan(at, side * np.array([-before[1], before[0]]), turn)
    one = at + side * np.array([-before[1], before[0]])
    other = at + side * np.array([-after[1], after[0]])
    corners = [at, one, other]
    # The miter is 1 / sin of half the angle between the pieces, in widths.
    sine = math.cos(0.5 * turn)
    if pen.join != "bevel" and sine > 0.0 and pen.miter_limit * sine >= 1.0:
        middle = 0.5 * (one + other) - at
        tip = at + middle * (half * half / float(middle @ middle))
        corners = [at, one, tip, other]
    return region([_polygon(corners)], "nonzero")


def _cap(at: Floats, outward: Floats, half: float, pen: Pen) -> Loops:
    normal = half * np.array([-outward[1], outward[0]])
    if pen.cap == "round":
        return _fan(at, -normal, math.pi)
    if pen.cap != "square":
        return []
    far = at + half * outward
    return [_polygon([at - normal, far - normal, far + normal, at + normal])]


def _dot(at: Floats, along: Floats, pen: Pen) -> Loops:
    """A path of no length: its caps."""
    half = 0.5 * pen.width
    if pen.cap == "round":
        return _disk(at, half)
    ahead, left = half * along, half * np.array([-along[1], along[0]])
    return [_polygon([at - ahead - left, at + ahead - left, at + ahead + left, at - ahead + left])]


def _fan(at: Floats, spoke: Floats, turn: float) -> Loops:
    """A sector of a disk, from a spoke on.

    No more of the disk: that would be seen beyond the butt end of a short piece.
    """
    arc = compile_arc(at, spoke, np.array([-spoke[1], spoke[0]]), 0.0, turn)
    lines = [np.array([arc[-1][-1], at]), np.array([at, arc[0][0]])]
    return region([[*arc, *lines]], "nonzero")


def _disk(at: Floats, radius: float) -> Loops:
    return [compile_arc(at, (radius, 0.0), (0.0, radius), 0.0, 2.0 * math.pi)]


def _polygon(corners: Sequence[Floats]) -> list[Floats]:
    return [np.array(pair) for pair in zip(corners, [*corners[1:], corners[0]], strict=True)]
