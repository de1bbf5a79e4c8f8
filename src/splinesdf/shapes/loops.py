"""Loops of pieces as they are given, made exactly closed or refused."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import InputError, OpenContourError
from splinesdf.ground.arrays import LARGEST, NOTHING, Floats, as_points, largest_coordinate
from splinesdf.ground.limits import check_limit

Fill = Literal["nonzero", "evenodd"]

# Neighbouring pieces meet to rounding; a gap up to this share of the shape's largest
# coordinate is closed by moving an end point by that much. Larger: real gaps would vanish unseen.
# Smaller: the ends of compiled arcs, good to a few ulp, would be called open.
_ROUNDING_GAP = 1e-13
# A gap up to this share of the size is a drawing program's printed digits: it is bridged by a
# straight piece, so the curve itself stays as drawn. Anything wider is an open contour.
PRINTED_GAP = 1e-6
# Sizes below this share of the coordinates are refused. Smaller: arcs and transforms are rounded by
# what can be seen of a shape.
_LOST = 1e-9
# A curve whose control points are within this share of the largest coordinate of the line through
# its ends is that line: what differs is rounding. Larger: flat curves lose their bulge; smaller:
# curves that run to and fro along a line keep arcs that only rounding gives a side.
_STRAIGHT = 4 * 2.220446049250313e-16


def fill_rule(fill: str) -> Fill:
    """The fill rule, or an `InputError`."""
    if fill == "nonzero":
        return "nonzero"
    if fill == "evenodd":
        return "evenodd"
    raise InputError(f"expected fill 'nonzero' or 'evenodd', got {fill!r}")


def closed_loops(loops: Iterable[Sequence[ArrayLike]], *, close: bool) -> list[list[Floats]]:
    """Loops in which every piece starts exactly where the last one ended.

    Parameters
    ----------
    loops : iterable of sequences of array_like, shape (degree + 1, 2)
        The control points of each piece of each loop. Pieces of length zero are dropped, and what
        is as good as that beside the shape's size.
    close : bool
        Close an open loop by a straight piece instead of refusing it.

    Raises
    ------
    OpenContourError
        If a loop's pieces do not follow one another, or it does not end where it starts.
    InputError
        If a coordinate is not finite or above 1e60, the size is below 1e-60 or below 1e-9 of
        the coordinates, or nothing is left.
    """
    given = [list(loop) for loop in loops]
    check_count(sum(map(len, given)))
    arrays = [[_as_control(piece) for piece in loop] for loop in given]
    size, largest = extent(arrays)
    closed = []
    for number, loop in enumerate(arrays):
        pieces = _closed_loop(loop, number, size=size, largest=largest, close=close)
        if pieces:
            closed.append(pieces)
    if not closed:
        raise InputError("expected a curve that encloses something, got only points")
    check_count(sum(map(len, closed)))
    return closed


def extent(loops: Sequence[Sequence[Floats]]) -> tuple[float, float]:
    """The larger side of the box of all control points, and their largest coordinate.

    Raises
    ------
    InputError
        If there is none, one is not finite or above 1e60, or the size is below 1e-60 or below 1e-9
        of the coordinates.
    """
    if not any(loops):
        raise InputError("expected at least one closed curve, got none")
    every = np.concatenate([piece for loop in loops for piece in loop])
    if not np.isfinite(every).all():
        raise InputError("expected finite coordinates, got NaN or infinity")
    largest = largest_coordinate(every)
    size = float(np.max(np.ptp(every, axis=0)))
    if size == 0.0:
        raise InputError("expected a curve that encloses something, got a single point")
    if size < 1.0 / LARGEST:
        raise InputError(
            f"expected a size of at least {1.0 / LARGEST:g}, got {size:.3g}: use another unit"
        )
    check_place(size, largest, "the shape's")
    return size, largest


def check_count(count: int) -> None:
    """Refuse more pieces than a shape may have, before there are tables of them."""
    check_limit("pieces", count, "pieces and corners")


def check_place(size: float, largest: float, whose: str = "its") -> None:
    """Refuse what is so far from the origin that rounding of its coordinates would change it."""
    if size < _LOST * largest:
        raise InputError(
            f"{whose} size {size:.3g} is lost beside its coordinates of {largest:.3g}: "
            f"move it nearer to the origin"
        )


def _as_control(piece: ArrayLike) -> Floats:
    control = as_points(piece)
    if control.ndim != 2 or len(control) < 2:
        raise InputError(
            f"expected a piece's control points of shape (degree + 1, 2), got {control.shape}"
        )
    return control


def _straightened(piece: Floats, largest: float) -> Floats:
    """A copy, only its ends if it has no extent across the line through them.

    Where such a curve runs to and fro, or beyond its ends, it bounds nothing.
    """
    if len(piece) == 2:
        return piece.copy()
    apart = piece - piece[0]
    chord = apart[-1]
    reach = float(np.abs(apart).max())
    if not chord.any():
        # Out and back again: along the line to the farthest control point, if they are on one.
        chord = apart[int(np.argmax(np.abs(apart).max(axis=1)))]
    if reach == 0.0:
        return piece[[0, -1]]
    unit = chord / float(np.hypot(*chord))
    across = float(np.abs(unit[0] * apart[:, 1] - unit[1] * apart[:, 0]).max())
    return piece[[0, -1]] if across <= _STRAIGHT * largest else piece.copy()


def _closed_loop(
    loop: list[Floats], number: int, *, size: float, largest: float, close: bool
) -> list[Floats]:
    """The loop's pieces, none of length zero, each starting exactly where the last one ended."""
    pieces = [_straightened(piece, largest) for piece in loop]
    pieces = [piece for piece in pieces if np.any(np.ptp(piece, axis=0) > NOTHING * size)]
    result: list[Floats] = []
    for index, piece in enumerate(pieces):
        result.append(piece)
        last = index + 1 == len(pieces)
        following = pieces[0] if last else pieces[index + 1]
        gap = math.dist(piece[-1], following[0])
        if gap <= _ROUNDING_GAP * largest:
            following[0] = piece[-1]
        elif gap <= PRINTED_GAP * size or (last and close):
            result.append(np.array([piece[-1], following[0]]))
        else:
            end, start = piece[-1], following[0]
            advice = "close it, or ask for it to be closed" if last else "its pieces must join"
            raise OpenContourError(
                f"expected closed contours; contour {number + 1} ends at "
                f"({end[0]:.6g}, {end[1]:.6g}) but {'starts' if last else 'goes on'} at "
                f"({start[0]:.6g}, {start[1]:.6g}): {advice}"
            )
    return result
