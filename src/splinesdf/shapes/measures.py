"""Area and length of a boundary, from its arcs' polynomials."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.tables import Arclets
from splinesdf.ground.arrays import Floats

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)
# An arc is halved until two halves have the same length as the whole, to this share of all arcs'.
# Smaller: rounding is halved in vain; larger: digits are lost.
_SAME = 1e-15
# 50 halvings shrink any arc below rounding: a ceiling for cusps.
_HALVINGS = 50


def area(boundary: Arclets) -> float:
    """The area that arcs with the inside on their left enclose, by Green's theorem; to rounding."""
    power = boundary.power
    degrees = np.arange(power.shape[1])
    # The integral of x dy - y dx over an arc minus its start: t^i times the derivative of t^j.
    of_both = degrees[None, :] / np.maximum(degrees[:, None] + degrees[None, :], 1)
    x, y = power[..., 0], power[..., 1]
    bulges = np.einsum("ni,ij,nj->n", x, of_both, y) - np.einsum("ni,ij,nj->n", y, of_both, x)
    # Seen from one of the points: far from the origin products would cancel.
    start, end = boundary.start - boundary.start[0], boundary.end - boundary.start[0]
    spans = start[:, 0] * (end - start)[:, 1] - start[:, 1] * (end - start)[:, 0]
    return 0.5 * math.fsum(np.concatenate([bulges, spans]).tolist())


def length(boundary: Arclets) -> float:
    """The length of all arcs, by Gauss's rule on halves until it settles; to rounding.

    Straight ones are their chords.
    """
    straight = ~np.any(boundary.power[:, 2:], axis=(1, 2))
    chords = np.hypot(*(boundary.end - boundary.start)[straight].T)
    power = boundary.power[~straight]
    derivatives = power[:, 1:] * np.arange(1, power.shape[1])[None, :, None]
    arc, low, high = np.arange(len(power)), np.zeros(len(power)), np.ones(len(power))
    whole = _lengths(derivatives, low, high)
    enough, settled = _SAME * float(whole.sum() + chords.sum()), chords.tolist()
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        first, second = (
            _lengths(derivatives[arc], *ends) for ends in ((low, middle), (middle, high))
        )
        rough = np.abs(first + second - whole) > enough
        settled += (first + second)[~rough].tolist()
        if not rough.any():
            break
        arc, whole = np.tile(arc[rough], 2), np.concatenate([first[rough], second[rough]])
        low, high = (
            np.concatenate([low[rough], middle[rough]]),
            np.concatenate([middle[rough], high[rough]]),
        )
    else:
        settled += whole.tolist()
    return math.fsum(settled)


def _lengths(derivatives: Floats, low: Floats, high: Floats) -> Floats:
    """Lengths of arcs (n, degree, 2) between two parameters each, by one rule: (n,)."""
    t = 0.5 * ((high - low)[:, None] * _POINTS + (high + low)[:, None])
    velocity = np.zeros((*t.shape, 2))
    for k in range(derivatives.shape[1] - 1, -1, -1):
        velocity = velocity * t[..., None] + derivatives[:, None, k]
    result: Floats = 0.5 * (high - low) * (np.hypot(velocity[..., 0], velocity[..., 1]) @ _WEIGHTS)
    return result
