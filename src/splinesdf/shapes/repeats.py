"""Contours that are drawn several times: the same curve, wherever it starts, is cut, or leads.

loops ──area, moments (the same for any start and cuts)──> pairs ──points of one on the other──>
the same curve
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from splinesdf.arclets.points import bezier_points
from splinesdf.ground.arrays import Floats, Ints, largest_coordinate

# Curves nearer than this share of the largest coordinate coincide: what rounding, transforms and
# compiled pieces can put between them, and what the boundary of a drawing takes for touching.
# Larger: what was drawn side by side counts once; smaller: copies under a transform count twice.
_COINCIDE = 64 * 2.220446049250313e-16
# How many times that share, of length and of length times reach, areas and moments may differ
# before curves are compared at all. Smaller: rounding in their sums hides copies.
_ROOM = 16.0
# Points of each piece that are looked for on the other curve, and where the search for each of
# them starts. More: slower; fewer: pieces that cross in so many points are taken for equal.
_POINTS, _STARTS = 8, 16
# Steps of Newton's method from there: each doubles the digits of a start that has one.
_STEPS = 7
# Pairs of pieces beyond which only copies in the same pieces are recognized: 100 MB.
_MOST_PAIRS = 400_000
# Repeated contours that a note names.
_SHOWN = 3
# Not in proportion to 1, so that contours side by side have different sums of moments.
_MIXED = 0.6180339887498949


def drawn_once(loops: Sequence[list[Floats]]) -> tuple[list[list[Floats]], list[str]]:
    """Contours without those that repeat an earlier one; what was left out, in words.

    Parameters
    ----------
    loops : sequence of lists of ndarray, shape (degree + 1, 2)
        The control points of each piece of each contour. Of a contour that runs several times
        through the same pieces one round is left.
    """
    near = _COINCIDE * largest_coordinate(np.concatenate([p for loop in loops for p in loop]))
    times = [_rounds(loop, near) for loop in loops]
    short = [loop[: len(loop) // count] for loop, count in zip(loops, times, strict=True)]
    first = first_of_each(short)
    again = [
        f"contour {k + 1} as {first[k] + 1}" if first[k] != k else f"contour {k + 1} in itself"
        for k in range(len(short))
        if first[k] != k or times[k] > 1
    ]
    kept = [loop for k, loop in enumerate(short) if first[k] == k]
    return kept, again


def repeats_note(again: Sequence[str]) -> tuple[str, ...]:
    """A note on what repeats something else, given in words; none if nothing does."""
    if not again:
        return ()
    shown = ", ".join(again[:_SHOWN]) + (", ..." if len(again) > _SHOWN else "")
    return (f"drawn again, counted once: {len(again)} ({shown}); give the fill rule to count each",)


def first_of_each(loops: Sequence[Sequence[Floats]]) -> Ints:
    """The first contour that is the same curve as each: itself if there is none before.

    Parameters
    ----------
    loops : sequence of sequences of ndarray, shape (degree + 1, 2)
        The control points of each piece of each contour.

    Returns
    -------
    ndarray of int, shape (n_loops,)
    """
    result = np.arange(len(loops))
    if len(loops) < 2:
        return result
    every = np.concatenate([piece for loop in loops for piece in loop])
    near = _COINCIDE * largest_coordinate(every)
    center = 0.5 * (every.min(axis=0) + every.max(axis=0))
    moved = [[p - center for p in loop if np.any(p != p[0])] for loop in loops]
    sums = moments_of(moved)
    length, reach = sums[:, 3], sums[:, 4]
    room = _ROOM * near * np.stack([length, length * reach, length * reach], axis=1)
    # The first that is not zero tells the direction; a line to and fro, of which none is, fills
    # nothing and is left as it is.
    plain = np.abs(sums[:, :3]) > room
    leading = sums[np.arange(len(sums)), np.argmax(plain, axis=1)]
    moments = np.sign(leading)[:, None] * sums[:, :3]
    key = moments[:, 1] + _MIXED * moments[:, 2]
    spread = 4.0 * float(room[:, 1].max())
    candidates = np.flatnonzero(plain.any(axis=1))
    candidates = candidates[np.argsort(key[candidates], kind="stable")]
    ends = np.searchsorted(key[candidates], key[candidates] + spread, side="right")
    for place, one in enumerate(candidates.tolist()):
        if result[one] != one:
            continue  # what is the same as that is so to the first one: else time is a square
        others = candidates[place + 1 : ends[place]]
        apart = np.abs(moments[others] - moments[one])
        others = others[np.all(apart <= room[others] + room[one], axis=1)]
        for other in others.tolist():
            first, second = min(one, other), max(one, other)
            if result[second] == second and same_curve(moved[first], moved[second], near):
                result[second] = result[first]
    return result


def moments_of(loops: Sequence[Sequence[Floats]]) -> Floats:
    """Area and first moments of what contours enclose, length, and how far they reach: (n, 5).

    They do not depend on where a contour starts and is cut; the first three change sign with its
    direction.
    """
    owner = np.array([k for k, loop in enumerate(loops) for _ in loop], dtype=np.int64)
    pieces = [piece for loop in loops for piece in loop]
    counts = np.array([len(piece) for piece in pieces])
    total = np.zeros((len(loops), 5))
    for count in np.unique(counts):
        chosen = np.flatnonzero(counts == count)
        control = np.stack([pieces[k] for k in chosen])
        nodes, weights = np.polynomial.legendre.leggauss(2 * int(count))
        weights = 0.5 * weights
        points, slopes = bezier_points(control[:, None], 0.5 + 0.5 * nodes[None])
        x, y = points[..., 0], points[..., 1]
        cross = x * slopes[..., 1] - y * slopes[..., 0]
        whole = owner[chosen]
        np.add.at(total[:, 0], whole, 0.5 * (cross @ weights))
        np.add.at(total[:, 1], whole, ((x * cross) @ weights) / 3.0)
        np.add.at(total[:, 2], whole, ((y * cross) @ weights) / 3.0)
        np.add.at(total[:, 3], whole, np.hypot(slopes[..., 0], slopes[..., 1]) @ weights)
        np.maximum.at(total[:, 4], whole, np.abs(control).max(axis=(1, 2)))
    return total


def same_curve(one: Sequence[Floats], other: Sequence[Floats], near: float) -> bool:
    """Whether each of two contours lies within ``near`` of the other one.

    If both are long, only if they have the same pieces, in either direction and from any start.
    """
    if _same_pieces(one, other, near):
        return True
    if len(one) * len(other) > _MOST_PAIRS:
        return False
    degree = max(len(piece) for loop in (one, other) for piece in loop) - 1
    first, second = (
        np.stack([_elevated(piece, degree) for piece in loop]) for loop in (one, other)
    )
    return _lies_on(first, second, near) and _lies_on(second, first, near)


def _same_pieces(one: Sequence[Floats], other: Sequence[Floats], near: float) -> bool:
    count, every = len(one), np.concatenate(one)
    if len(other) != count:
        return False
    sizes = [len(piece) for piece in one]
    for candidate in (list(other), [piece[::-1] for piece in reversed(other)]):
        starts = np.array([piece[0] for piece in candidate])
        for shift in np.flatnonzero(np.abs(starts - every[0]).max(axis=1) <= near).tolist():
            shifted = candidate[shift:] + candidate[:shift]
            if [len(piece) for piece in shifted] == sizes and np.all(
                np.abs(np.concatenate(shifted) - every) <= near
            ):
                return True
    return False


def _elevated(control: Floats, degree: int) -> Floats:
    """The same piece with the control points of a higher degree."""
    while len(control) <= degree:
        n = len(control)
        share = (np.arange(1, n) / n)[:, None]
        inner = share * control[:-1] + (1.0 - share) * control[1:]
        control = np.concatenate([control[:1], inner, control[-1:]])
    return control


def _lies_on(one: Floats, other: Floats, near: float) -> bool:
    """Whether points of all pieces (n, degree + 1, 2) of a contour lie on another one."""
    points, _ = bezier_points(one[:, None], np.linspace(0.0, 1.0, _POINTS, endpoint=False)[None])
    points = points.reshape(-1, 2)
    starts = (np.arange(_STARTS) + 0.5) / _STARTS
    samples, _ = bezier_points(other[:, None], starts[None])
    samples = samples.reshape(-1, 2)
    found = np.empty(len(points), dtype=np.int64)
    block = max(1, _MOST_PAIRS // len(samples))
    for first in range(0, len(points), block):
        away = points[first : first + block, None] - samples
        found[first : first + block] = np.argmin(np.sum(away * away, axis=2), axis=1)
    least = np.full(len(points), np.inf)
    for beside in (-1, 0, 1):  # the point may lie just beyond a joint
        piece = (found // _STARTS + beside) % len(other)
        t = starts[found % _STARTS] if beside == 0 else np.full(len(points), 0.5 - 0.5 * beside)
        for _ in range(_STEPS):
            place, slope = bezier_points(other[piece], t)
            square = np.maximum(np.sum(slope * slope, axis=1), np.finfo(np.float64).tiny)
            t = np.clip(t - np.sum((place - points) * slope, axis=1) / square, 0.0, 1.0)
        place, _ = bezier_points(other[piece], t)
        least = np.minimum(least, np.hypot(*(place - points).T))
    return bool(np.all(least <= near))


def _rounds(loop: Sequence[Floats], near: float) -> int:
    """How many times a contour runs through the same pieces, one time after the other."""
    count = len(loop)
    for times in range(count, 1, -1):
        ahead = count // times
        if count % times == 0 and all(
            len(a) == len(b) and np.abs(a - b).max() <= near
            for a, b in zip(loop, loop[ahead:], strict=False)
        ):
            return times
    return 1
