"""What counts on a triangle: all of it, or points where the distance or the spline is in a band.

Used by `enclosure`. The spline has the coefficients AA BB CC AB BC CA; p is the middle of AB.
"""

from __future__ import annotations

from splinesdf.fits.tables import Asked
from splinesdf.ground.arrays import Floats
from splinesdf.ground.jit import uncounted


@uncounted
def meets(asked: Asked, low: float, high: float, c: Floats, grain: float) -> bool:
    """Whether the distance, from low to high, or the spline can be in a band, or around it."""
    bands = asked.bands
    least = min(c[0], c[1], c[2], c[3], c[4], c[5]) - grain
    most = max(c[0], c[1], c[2], c[3], c[4], c[5]) + grain
    for k in range(bands.shape[0]):
        spline = (least <= bands[k, 1], most >= bands[k, 0])
        distance = (low <= bands[k, 1], high >= bands[k, 0])
        if _counts(spline, distance, asked.around):
            return True
    return False


@uncounted
def seen(errors: Floats, margin: float, value: float, room: float) -> float:
    """What |s - u| is at least in a corner or in p, where it is known up to some margins."""
    corners = max(abs(errors[0]), abs(errors[1]), abs(errors[2]))
    return float(max(0.0, corners - margin, abs(value) - room))


@uncounted
def seen_in_bands(
    asked: Asked,
    c: Floats,
    errors: Floats,
    margin: float,
    value: float,
    room: float,
    everywhere: float,
) -> float:
    """What |s - u| is at least in some point of a triangle that counts for the bands.

    It is at least ``everywhere`` on all of it. That counts if the spline, or the distance, is
    known to be below a band's end in one point and above its other end in one, as both are
    continuous.
    """
    bands = asked.bands
    found = 0.0
    middle = 0.25 * (c[0] + 2.0 * c[3] + c[1])
    for k in range(bands.shape[0]):
        low, high = bands[k, 0], bands[k, 1]
        spline_below = spline_above = below = above = False
        for v in range(4):
            spline, error, unsure = middle, value, room
            if v < 3:
                spline, error, unsure = c[v], errors[v], margin
            distance = spline - error
            first = (spline <= high, spline >= low)
            second = (distance + unsure <= high, distance - unsure >= low)
            if _counts(first, second, asked.around):
                found = max(found, abs(error) - unsure)
            spline_below, spline_above = spline_below or first[0], spline_above or first[1]
            below, above = below or second[0], above or second[1]
        if _counts((spline_below, spline_above), (below, above), asked.around):
            found = max(found, everywhere)
    return found


@uncounted
def _counts(spline: tuple[bool, bool], distance: tuple[bool, bool], around: bool) -> bool:
    """Whether one is below and above a band's ends, or both together are."""
    if around:
        return (spline[0] or distance[0]) and (spline[1] or distance[1])
    return (spline[0] and spline[1]) or (distance[0] and distance[1])
