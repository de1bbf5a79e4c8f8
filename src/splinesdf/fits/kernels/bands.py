"""Points of a triangle that count: all, or those where the distance or the spline is in a band.

Used by `enclosure`. The spline has the coefficients AA BB CC AB BC CA; p is the middle of AB.
"""

from __future__ import annotations

from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import uncounted


@uncounted
def least_of(c: Floats) -> float:
    """The smallest of six coefficients."""
    least = float(c[0])
    for k in range(1, 6):
        least = min(least, c[k])
    return least


@uncounted
def most_of(c: Floats) -> float:
    """The largest of six coefficients."""
    most = float(c[0])
    for k in range(1, 6):
        most = max(most, c[k])
    return most


@uncounted
def meets(bands: Floats, around: bool, low: float, high: float, c: Floats, grain: float) -> bool:
    """Whether the distance, from low to high, or the spline can be in a band, or around it."""
    least = least_of(c) - grain
    most = most_of(c) + grain
    for k in range(bands.shape[0]):
        below, above = least <= bands[k, 1], most >= bands[k, 0]
        nearer, farther = low <= bands[k, 1], high >= bands[k, 0]
        if _counts(below, above, nearer, farther, around):
            return True
    return False


@uncounted
def seen(errors: Floats, margin: float, value: float, room: float) -> float:
    """A lower bound of |s - u| in a corner or in p, where it is known up to some margins."""
    corners = max(max(abs(errors[0]), abs(errors[1])), abs(errors[2]))
    return float(max(max(0.0, corners - margin), abs(value) - room))


@uncounted
def seen_in_bands(
    bands: Floats,
    around: bool,
    c: Floats,
    errors: Floats,
    margin: float,
    value: float,
    room: float,
    everywhere: float,
) -> float:
    """A lower bound of |s - u| in some point of a triangle that counts for the bands.

    It is at least ``everywhere`` on all of it. That counts if the spline, or the distance, is
    known to be below a band's end in one point and above its other end in one, as both are
    continuous.
    """
    found = 0.0
    middle = 0.25 * (c[0] + 2.0 * c[3] + c[1])
    for k in range(bands.shape[0]):
        low, high = bands[k, 0], bands[k, 1]
        distance = middle - value
        spline_below, spline_above = middle <= high, middle >= low
        some_nearer, some_farther = distance + room <= high, distance - room >= low
        if _counts(spline_below, spline_above, some_nearer, some_farther, around):
            found = max(found, abs(value) - room)
        for v in range(3):
            distance = c[v] - errors[v]
            below, above = c[v] <= high, c[v] >= low
            nearer, farther = distance + margin <= high, distance - margin >= low
            if _counts(below, above, nearer, farther, around):
                found = max(found, abs(errors[v]) - margin)
            spline_below, spline_above = spline_below or below, spline_above or above
            some_nearer, some_farther = some_nearer or nearer, some_farther or farther
        if _counts(spline_below, spline_above, some_nearer, some_farther, around):
            found = max(found, everywhere)
    return found


@uncounted
def _counts(below: bool, above: bool, nearer: bool, farther: bool, around: bool) -> bool:
    """Whether the spline, or the distance, is below and above a band's ends, or both together."""
    if around:
        return (below or nearer) and (above or farther)
    return (below and above) or (nearer and farther)
