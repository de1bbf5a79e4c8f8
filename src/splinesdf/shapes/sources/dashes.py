"""Dashes of strokes: paths cut by their length, as SVG 2 says (13.5.6, stroke dashing).

path ──adaptive Gauss──> stretches of known length ──Newton──> parameters of ends ──> parts of it
pattern, repeated from the start of each path ──> distances of ends ─┘

Where SVG leaves a choice, or renderers agree on another one, it is theirs: on a closed path a dash
that reaches the end and one that begins at the start are one, with a join; and a path that starts
just where a dash ends has no dash of no length there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from splinesdf.arclets.points import bezier_points
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.shapes.region import stretch
from splinesdf.shapes.sources.stroke import end_tangent

# Dashes of a drawing. More: minutes, as each curved one takes ten milliseconds; fewer: dotted lines
# across a map are refused.
MOST_DASHES = 10_000
# The rule that measures a stretch.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
# A stretch is measured when it and its halves differ by this share of the path's length. Smaller:
# rounding is chased; larger: with many pieces the sum is no longer good to 1e-12.
_EXACT = 4e-15
# Halvings of a stretch: it then is as short as rounding of its parameter.
_MOST_HALVINGS = 40
# Gauss points see no cusp between them, nor a place where a piece nearly stands still. So a stretch
# has no root of its squared speed, a complex number, nearer to its middle than this, in half
# lengths: the rule then errs by 1e-16. Roots this near to the real line are on it, where a piece is
# cut: double roots are not known better, and their being apart changes the length by the square.
_CLEAR, _REAL = 1.8, 1e-7
# Coefficients below this share of the largest are none: their quotients leave the range of floats.
_LEAST = 1e-40
# Steps to a parameter, the last ones halvings of what is left: together they end on any piece.
_NEWTON_STEPS, _STEPS = 20, 80
# A parameter is found when its distance is right to this share of the path's length, or nothing is
# left to halve. Smaller: below the rounding of the sum.
_FOUND, _NOTHING_LEFT = 4e-16, 2.0**-52
# Distances closer to one another than this share of the path's length are the same: where a dash
# ends on a corner, rounding would give it a crumb of the next side, and a join.
_SAME = 1e-12
# Next to a smooth joint a part shorter than these shares of the largest coordinate and of the
# path's length is left to its neighbor, which is continued by as much. Smaller: rounding turns
# crumbs, and caps with them; larger: the neighbor is no longer where the part was.
_CRUMB, _CRUMB_OF_LENGTH = 1e-8, 1e-6
# Turns (radians) of less are none, as for strokes.
_SMOOTH = 1e-6
# A neighbor is continued by up to this share of its parameter. More: a handle of nearly no length
# there takes it far away.
_MOST_CONTINUED = 1e-3


class Pattern(NamedTuple):
    """Dashes and gaps in turn."""

    lengths: tuple[float, ...]  # none negative, an even number of them; infinite ones may be
    offset: float = 0.0  # how far into the pattern each path starts


class Dashed(NamedTuple):
    """Dashes as open paths."""

    loops: list[list[Floats]]
    along: list[Floats]  # of each: the unit tangent at its start


def dashed(loops: Sequence[Sequence[Floats]], closed: Sequence[bool], pattern: Pattern) -> Dashed:
    """The dashes of paths, each of which begins the pattern anew.

    Parameters
    ----------
    loops : sequence of sequences of ndarray, shape (degree + 1, 2)
        The control points of each piece of each path.
    closed : sequence of bool
        Of each path whether its end and its start are joined.
    pattern : Pattern
        In the unit of the paths; some length is not 0.

    Raises
    ------
    InputError
        If there are more than 10,000.
    """
    paths = [_measured(loop) for loop in loops]
    lengths = [path.length if path else 0.0 for path in paths]
    period, pairs = sum(pattern.lengths), len(pattern.lengths) // 2
    _check_count(sum(pairs * math.floor(min(length / period, 1e15)) for length in lengths))
    ends = [_distances(length, pattern) for length in lengths]
    _check_count(sum(len(starts) for starts, _ in ends))
    result = Dashed([], [])
    for loop, path, is_closed, (starts, stops) in zip(loops, paths, closed, ends, strict=True):
        if not len(starts) or not len(loop):
            continue
        if path is None:  # a path of no length, where the pattern begins with a dash
            dashes = [_Dash([loop[0]], np.array([1.0, 0.0]))]
        else:
            dashes = _parts(path, starts, stops, is_closed)
        result.loops.extend(dash.pieces for dash in dashes)
        result.along.extend(dash.along for dash in dashes)
    return result


def path_length(loops: Sequence[Sequence[Floats]]) -> float:
    """The length of paths together, to about 1e-14 of it."""
    return sum(path.length for loop in loops if (path := _measured(loop)))


def _check_count(count: int) -> None:
    if count > MOST_DASHES:
        raise InputError(f"expected at most {MOST_DASHES:,} dashes, got {count:,}")


def _distances(length: float, pattern: Pattern) -> tuple[Floats, Floats]:
    """Where dashes start and stop, from the start of a path of some length."""
    period = sum(pattern.lengths)
    # Far into an infinite pattern there is no place: it can only be begun.
    offset = 0.0 if math.isinf(period) else math.fmod(pattern.offset, period)
    if offset < 0.0:
        offset = offset + period if offset + period < period else 0.0
    periods = math.ceil((offset + length) / period) + 1
    steps = np.arange(periods) * (period if periods > 1 else 0.0)
    sums = np.cumsum([0.0, *pattern.lengths])
    start = (steps[:, None] + sums[:-1:2]).ravel() - offset
    stop = (steps[:, None] + sums[1::2]).ravel() - offset
    dot = np.tile(np.array(pattern.lengths[::2]) == 0.0, periods)
    # One that ends at the start is past, unless it has no length.
    same = _SAME * length
    kept = np.where(dot, start >= -same, stop > same)
    kept &= start < length - same if length > 0.0 else start <= 0.0
    return np.clip(start[kept], 0.0, length), np.clip(stop[kept], 0.0, length)


@dataclass(frozen=True)
class _Path:
    """A path, cut into stretches of known length."""

    pieces: list[Floats]
    slopes: Floats  # (pieces, n, 2): control points of the derivatives, all of one degree
    piece: Ints  # of each stretch
    low: Floats
    high: Floats
    reached: Floats  # (stretches + 1,): the length up to each, and that of all
    joints: Floats  # (pieces + 1,): the length up to each piece, and that of all
    crumb: float  # parts shorter than this are left to their neighbors

    @property
    def length(self) -> float:
        return float(self.reached[-1])


def _measured(loop: Sequence[Floats]) -> _Path | None:
    """A path by its length; None if it has none."""
    pieces = [piece for piece in loop if np.any(piece != piece[0])]
    if not pieces:
        return None
    slopes = _slopes(pieces)
    most = sum(float(np.hypot(*np.diff(piece, axis=0).T).sum()) for piece in pieces)
    cuts, roots = _cusps(slopes, [len(piece) > 2 for piece in pieces])
    which = np.repeat(np.arange(len(pieces)), [len(cut) - 1 for cut in cuts])
    low = np.concatenate([cut[:-1] for cut in cuts])
    high = np.concatenate([cut[1:] for cut in cuts])
    whole = _lengths(slopes[which], low, high)
    done: list[tuple[Ints, Floats, Floats, Floats]] = []
    halving = 0
    while len(low):
        middle = 0.5 * (low + high)
        left = _lengths(slopes[which], low, middle)
        right = _lengths(slopes[which], middle, high)
        away = np.abs(roots[which] - middle[:, None]).min(axis=1)
        good = away >= _CLEAR * (high - middle)
        good &= np.abs(left + right - whole) <= _EXACT * most
        good |= halving >= _MOST_HALVINGS
        done.append((which[good], low[good], middle[good], left[good]))
        done.append((which[good], middle[good], high[good], right[good]))
        bad = ~good
        which, whole = which[bad].repeat(2), _in_turn(left[bad], right[bad])
        low, high = _in_turn(low[bad], middle[bad]), _in_turn(middle[bad], high[bad])
        halving += 1
    which, low, high, length = (np.concatenate(parts) for parts in zip(*done, strict=True))
    order = np.lexsort((low, which))
    reached = np.concatenate([[0.0], np.cumsum(length[order])])
    which = which[order]
    joints = reached[np.append(np.searchsorted(which, np.arange(len(pieces))), -1)]
    largest = max(float(np.abs(piece).max()) for piece in pieces)
    crumb = min(_CRUMB * largest, _CRUMB_OF_LENGTH * float(reached[-1]))
    return _Path(pieces, slopes, which, low[order], high[order], reached, joints, crumb)


def _cusps(slopes: Floats, curved: list[bool]) -> tuple[list[Floats], NDArray[np.complex128]]:
    """Parameters between which pieces have a speed, and the other roots of it squared."""
    degree = slopes.shape[1] - 1
    cuts = [np.array([0.0, 1.0])] * len(slopes)
    others = np.full((len(slopes), 2 * degree), np.inf, dtype=np.complex128)
    for k in np.flatnonzero(curved):
        control = slopes[k] / np.abs(slopes[k]).max()
        x, y = (
            [math.comb(degree, j) * np.diff(values, j)[0] for j in range(degree, -1, -1)]
            for values in control.T
        )
        squared = np.polyadd(np.polymul(x, x), np.polymul(y, y))
        roots = np.roots(np.where(np.abs(squared) > _LEAST * np.abs(squared).max(), squared, 0.0))
        real = np.abs(roots.imag) <= _REAL
        inner = np.sort(roots.real[real & (roots.real > 0.0) & (roots.real < 1.0)])
        cuts[k] = np.concatenate([[0.0], inner, [1.0]])
        others[k, : np.count_nonzero(~real)] = roots[~real]
    return cuts, others


def _in_turn(one: Floats, other: Floats) -> Floats:
    return np.stack([one, other], axis=1).ravel()


def _slopes(pieces: list[Floats]) -> Floats:
    """The control points of pieces' derivatives, raised to one degree: (pieces, n, 2)."""
    count = max(2, *(len(piece) - 1 for piece in pieces))
    result = np.empty((len(pieces), count, 2))
    degrees = np.array([len(piece) - 1 for piece in pieces])
    for degree in np.unique(degrees).tolist():
        here = np.flatnonzero(degrees == degree)
        slopes = degree * np.diff(np.stack([pieces[k] for k in here]), axis=1)
        while (size := slopes.shape[1]) < count:
            share = (np.arange(size + 1) / size)[:, None]
            before = np.concatenate([slopes[:, :1], slopes], axis=1)
            after = np.concatenate([slopes, slopes[:, -1:]], axis=1)
            slopes = share * before + (1.0 - share) * after
        result[here] = slopes
    return result


def _speeds(slopes: Floats, t: Floats) -> Floats:
    """Of stretches (n, degree + 1, 2) at parameters (n, m)."""
    first, _ = bezier_points(slopes[:, None], t)
    return np.asarray(np.hypot(first[..., 0], first[..., 1]))


def _lengths(slopes: Floats, low: Floats, high: Floats) -> Floats:
    half = 0.5 * (high - low)
    speeds = _speeds(slopes, (low + half)[:, None] + half[:, None] * _NODES)
    # What differs from the first: straight pieces are as long as they are, to the last bit.
    first = speeds[:, 0]
    return np.asarray(2.0 * half * first + half * ((speeds - first[:, None]) @ _WEIGHTS))


def _places(path: _Path, distances: Floats, side: str) -> list[tuple[int, float]]:
    """Pieces and parameters at distances from the start; at a joint the piece on one side."""
    last = len(path.piece) - 1
    index = np.searchsorted(path.reached, distances, "right" if side == "after" else "left")
    index = np.clip(index - 1, 0, last)
    begin, end = path.reached[index], path.reached[index + 1]
    start, wanted = path.low[index], distances - begin
    low, high = start, path.high[index]
    slopes = path.slopes[path.piece[index]]
    with np.errstate(divide="ignore", invalid="ignore"):  # where it has no speed: it is halved
        t = np.where(end > begin, low + wanted / (end - begin) * (high - low), low)
        for step in range(_STEPS):
            miss = _lengths(slopes, start, t) - wanted
            low, high = np.where(miss <= 0.0, t, low), np.where(miss >= 0.0, t, high)
            if np.all((np.abs(miss) <= _FOUND * path.length) | (high - low <= _NOTHING_LEFT)):
                break
            better = t - miss / _speeds(slopes, t[:, None])[:, 0]
            inside = (better > low) & (better < high) & (step < _NEWTON_STEPS)
            t = np.where(inside, better, 0.5 * (low + high))
    t = np.where(distances <= begin, path.low[index], t)
    t = np.where(distances >= end, path.high[index], t)
    return list(zip(path.piece[index].tolist(), t.tolist(), strict=True))


class _Dash(NamedTuple):
    pieces: list[Floats]
    along: Floats  # the unit tangent at its start


def _parts(path: _Path, starts: Floats, stops: Floats, closed: bool) -> list[_Dash]:
    """The parts of a path between distances from its start."""
    starts, stops = _on_joints(starts, path.joints), _on_joints(stops, path.joints)
    dashes = [
        _between(path, start, stop, (float(begin), float(end)))
        for start, stop, begin, end in zip(
            _places(path, starts, "after"), _places(path, stops, "before"), starts, stops,
            strict=True,
        )
    ]  # fmt: skip
    if closed and len(dashes) > 1 and starts[0] == 0.0 and stops[-1] == path.length:
        last = dashes.pop()  # it goes on over the start, where rounding may be between
        last.pieces[-1] = np.concatenate([last.pieces[-1][:-1], path.pieces[0][:1]])
        first = dashes[0].pieces if stops[0] > 0.0 else []
        dashes[0] = _Dash(last.pieces + first, last.along)
    return dashes


def _on_joints(distances: Floats, joints: Floats) -> Floats:
    """Distances, those that are next to a joint on it."""
    index = np.clip(np.searchsorted(joints, distances), 1, len(joints) - 1)
    before, after = joints[index - 1], joints[index]
    nearest = np.where(distances - before <= after - distances, before, after)
    return np.where(np.abs(distances - nearest) <= _SAME * joints[-1], nearest, distances)


def _between(
    path: _Path, start: tuple[int, float], stop: tuple[int, float], ends: tuple[float, float]
) -> _Dash:
    """The part of a path between two places, whose distances from its start are known, too."""
    (first, low), (last, high) = start, stop
    piece = path.pieces[first]
    rest = stretch(piece, low, 1.0) if low < 1.0 else piece[-1:].repeat(2, axis=0)
    along = end_tangent(rest, 0) if np.any(rest != rest[0]) else end_tangent(piece, 1)
    if start >= stop or ends[1] <= ends[0]:
        return _Dash([rest[:1].repeat(2, axis=0)], along)
    crumb = path.joints[first + 1] - ends[0]
    if first < last and crumb < path.crumb and (more := _continued(path, first + 1, 0, crumb)):
        first, low = first + 1, -more
    crumb = ends[1] - path.joints[last]
    if first < last and crumb < path.crumb and (more := _continued(path, last - 1, 1, crumb)):
        last, high = last - 1, 1.0 + more
    parts = [
        stretch(path.pieces[k], low if k == first else 0.0, high if k == last else 1.0)
        for k in range(first, last + 1)
    ]
    return _Dash(parts, along)


def _continued(path: _Path, k: int, end: int, by: float) -> float:
    """By how much of its parameter a piece is continued by a length; 0 if it cannot be."""
    one, other = (k - 1, k) if end == 0 else (k, k + 1)
    before, after = end_tangent(path.pieces[one], 1), end_tangent(path.pieces[other], 0)
    cross = abs(float(before[0] * after[1] - before[1] * after[0]))
    if cross > _SMOOTH or float(before @ after) < 0.0:
        return 0.0
    speed = float(_speeds(path.slopes[k : k + 1], np.array([[float(end)]]))[0, 0])
    return by / speed if by <= _MOST_CONTINUED * speed else 0.0
