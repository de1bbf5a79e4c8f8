"""What a polygon of a map fills: what its outline encloses, less what its holes do.

rings ──even-odd──> every ring as it stands? ─┬─ yes ──> the rings, filled by turns
                                              └─ no ───> outline − union of the holes
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.shapes.region import Loops, difference, region, union

# A loop is a ring if their areas agree up to this share. Smaller: the rounding of areas counts, and
# time is lost; larger: a hole that loses no more of itself at the outline is taken as it stands.
_SAME = 1e-9
# Regions of areas that agree up to this share of the larger one are one.
_ROUNDING = 1e-12


class Filled(NamedTuple):
    """A region."""

    loops: Loops
    rule: str | None  # None if the inside is on their left
    nested: bool  # whether each hole is within the outline, and outside of the others


def less_holes(rings: Loops) -> Filled:
    """The region between an outline, the first ring, and its holes, wherever these stand.

    A hole outside of the outline takes nothing away, and of one that crosses it only what both have
    in common; where holes overlap, or one is within another, all of them are left out. The rings
    come back as they are if even-odd says the same.
    """
    if len(rings) == 1:
        return Filled(rings, "evenodd", nested=True)
    by_turns = region(rings, "evenodd")
    areas = np.abs([_area(ring) for ring in rings])
    areas[1:] *= -1.0
    found = np.array([_area(loop) for loop in by_turns])
    if len(found) == len(areas) and np.allclose(np.sort(found), np.sort(areas), _SAME, 0.0):
        return Filled(rings, "evenodd", nested=True)
    holes = union([region([ring], "evenodd") for ring in rings[1:]])
    outline = region(rings[:1], "evenodd")
    left = difference(outline, holes) if holes else outline
    one, other = float(np.sum(found)), sum(map(_area, left))
    return Filled(left, None, nested=abs(one - other) <= _ROUNDING * max(one, other))


def _area(loop: list[np.ndarray]) -> float:
    """What a loop of lines encloses, positive if that is on its left."""
    corners = np.array([piece[0] for piece in loop])
    x, y = (corners - corners[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
