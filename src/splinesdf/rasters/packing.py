"""Rectangles packed on shelves into a nearly square picture.

┌──────┬─────┬────┬───┐
│      │     │    │   │   a shelf is as high as its first rectangle,
├────┬─┴──┬──┴┬───┴─┬─┤   the highest of those that are left
│    │    │   │     │ │
└────┴────┴───┴─────┴─┘
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from splinesdf.errors import InputError

# Widths and heights of a picture are multiples of this many texels: rows of 8-bit texels then begin
# where OpenGL expects them unless it is told otherwise.
_STEP = 4
# A width that makes the picture higher than wide grows by this share. Larger: pictures less square;
# smaller: more tries, of which the shelves of some ten thousand rectangles need dozens.
_GROWTH = 1 / 64

Sides = tuple[int, int]


def packed(sizes: Sequence[Sides], most: int) -> tuple[Sides, list[Sides]]:
    """Places for rectangles that do not overlap.

    Parameters
    ----------
    sizes : sequence of (width, height)
        Whole numbers from 1 on.
    most : int
        The largest side that the picture may have.

    Returns
    -------
    (width, height), list of (column, row)
        The picture's sides, multiples of 4 and the width at least the height, and the upper left
        corner of each rectangle.

    Raises
    ------
    InputError
        If they do not fit.
    """
    # High ones first, so that little is lost above those beside them.
    order = sorted(range(len(sizes)), key=lambda i: (-sizes[i][1], -sizes[i][0], i))
    area = sum(wide * high for wide, high in sizes)
    width = _stepped(max([math.isqrt(area), *(wide for wide, _ in sizes), 1]))
    while width <= most:
        height, places = _shelves(sizes, order, width)
        if height <= width:
            return (width, height), places
        width += _stepped(max(1, int(width * _GROWTH)))
    raise InputError(
        f"expected pictures that fit into {most:,} x {most:,} texels, got more: ask for a smaller "
        "size or range, or for fewer"
    )


def _shelves(sizes: Sequence[Sides], order: Sequence[int], width: int) -> tuple[int, list[Sides]]:
    """The height that is needed at a width, and places."""
    places: list[Sides] = [(0, 0)] * len(sizes)
    x = top = bottom = 0
    for i in order:
        wide, high = sizes[i]
        if x + wide > width or bottom == 0:
            x, top, bottom = 0, bottom, bottom + high
        places[i] = x, top
        x += wide
    return _stepped(max(1, bottom)), places


def _stepped(side: int) -> int:
    return -(-side // _STEP) * _STEP
