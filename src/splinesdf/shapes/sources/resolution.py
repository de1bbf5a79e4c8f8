"""Whether pieces of degree 7 resolve curves on intervals, and how to cut intervals they do not.

Curves are seen through their samples only, so that one arithmetic serves a single curve
(`compiled`) and many that are compiled together (`rational`). Samples stand coordinate by
coordinate, which is several times as quick: in rows of two numbers NumPy's calls cost most.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from splinesdf.arclets.interpolation import DEGREE, SAMPLES, TO_CHECKS, TO_CONTROL
from splinesdf.ground.arrays import Bools, Floats, Ints

# Fewer might overlook a feature between the samples; more would cost simple curves more pieces.
FIRST_INTERVALS = 4
# Pieces narrower than this share of the range have run into a corner.
CORNER = 2.0**-30
# Noise is measured on pieces of the curve this long, as a share of its range. Longer: they bend;
# shorter: the samples in them fall together.
SHORT = 2.0**-26
# Agreement asked for, in units in the last place of the largest coordinate. Smaller: rounding in
# the formula itself is chased in vain. Larger: error that the exact distance would inherit.
_ULPS = 4.0
# A formula may be noisier than that (sin(100*t) loses two digits to its argument). Its own noise
# is measured and accepted up to this share of the size; above, the formula is refused as noise.
_MOST_NOISE = 1e-11
# Noise elsewhere may be larger than at 64 places. Less: rounding is chased in vain somewhere;
# more: digits are given away.
_NOISE_RESERVE = 2.0
# An error below this share of the size shrinks like width^8, so the number of parts that reach
# the tolerance can be foretold; above it the curve is not resolved and is just halved.
_FORESEEN = 1e-5
_MOST_PARTS = 12
# So many times the parts foretold. At 1 rounding pushes some over the tolerance and each is cut
# in two: a circle takes 59 pieces instead of 36. More: every curve takes more.
_FORESIGHT = 1.06


class Interpolants(NamedTuple):
    """Polynomials through samples of intervals, and how well they agree with the others."""

    control: Floats  # (n, 8, 2); of a straight one, the ends say all
    straight: Bools  # (n,): the curve is its chord, within the tolerance
    error: Floats  # (n,): the largest miss at the checks


def noise_parameters(start: float, stop: float) -> Floats:
    """Parameters at which `agreement` wants a curve sampled: 64 short bursts, (64, 29)."""
    # Irrational places, so that no sample falls on a corner at a simple fraction of the range.
    places = (np.arange(64) + 0.5 * (math.sqrt(5.0) - 1.0)) / 64.0
    # So short that what an interpolant misses there is rounding and nothing else.
    return np.asarray(start + (stop - start) * (0.999 * places[:, None] + SHORT * SAMPLES))


def agreement(points: Floats, scale: Floats | float) -> tuple[Floats, Floats]:
    """The error to accept of each curve, and its largest coordinate, each of shape (...,).

    Parameters
    ----------
    points : ndarray, shape (..., 2, 64, 29)
        At `noise_parameters`: all x, then all y.
    scale : ndarray, shape (...,)
        Taken as the largest coordinate where it is larger than what samples show.
    """
    largest: Floats = np.maximum(scale, np.abs(points).max(axis=(-3, -2, -1)))
    bulge = points - points[..., :1]
    miss = np.abs(bulge[..., : DEGREE + 1] @ TO_CHECKS.T - bulge[..., DEGREE + 1 :])
    # One sample of 64 may sit on a corner by chance; the second largest is noise all the same.
    noise = _NOISE_RESERVE * np.sort(miss.max(axis=(-3, -1)), axis=-1)[..., -2]
    ulp = float(np.finfo(np.float64).eps) * largest
    return np.maximum(_ULPS * ulp, np.minimum(noise, _MOST_NOISE * largest)), largest


def interval_parameters(intervals: Floats) -> Floats:
    """Parameters at which `interpolate` wants a curve sampled on intervals: (n, 2) -> (n, 29)."""
    left, right = intervals[:, :1], intervals[:, 1:]
    t: Floats = left + (right - left) * SAMPLES
    t[:, DEGREE] = intervals[:, 1]
    return t


def interpolate(points: Floats, tolerance: Floats | float) -> Interpolants:
    """Polynomials through points (n, 2, 29) at `interval_parameters`, tolerance (n,) or ()."""
    first, last = points[..., :1], points[..., DEGREE : DEGREE + 1]
    # Interpolating the difference to the chord keeps rounding in proportion to the bulge.
    bulge = points - (first + (last - first) * SAMPLES)
    nodes = bulge[..., : DEGREE + 1]
    inner = np.arange(DEGREE + 1) / DEGREE
    control = first + (last - first) * inner + nodes @ TO_CONTROL.T
    control[..., :1], control[..., -1:] = first, last
    miss = nodes @ TO_CHECKS.T - bulge[..., DEGREE + 1 :]
    straight = np.abs(bulge).max(axis=(1, 2)) <= tolerance
    error = np.abs(miss).max(axis=(1, 2))
    return Interpolants(np.ascontiguousarray(np.swapaxes(control, 1, 2)), straight, error)


def split(
    intervals: Floats, error: Floats, tolerance: Floats | float, scale: Floats | float
) -> tuple[Floats, Ints]:
    """Each interval in as many equal parts as its error asks for, and the row each part is of.

    Parameters
    ----------
    intervals : ndarray, shape (n, 2)
    error, tolerance, scale : ndarray, shape (n,)
        What was missed, what may be, and the largest coordinate; the latter two may be ().
    """
    resolved = error < _FORESEEN * scale
    times = np.where(resolved, error, 0.0) / np.maximum(tolerance, np.finfo(np.float64).tiny)
    foreseen = np.ceil(_FORESIGHT * times ** (1.0 / (DEGREE + 1)))
    parts = np.where(resolved, np.clip(foreseen, 2, _MOST_PARTS), 2).astype(int)
    result, rows = [np.empty((0, 2))], [np.empty(0, dtype=np.int64)]
    for count in np.unique(parts):
        chosen = intervals[parts == count]
        cuts = chosen[:, :1] + (chosen[:, 1:] - chosen[:, :1]) * (np.arange(count + 1) / count)
        cuts[:, -1] = chosen[:, 1]
        result.append(np.stack([cuts[:, :-1], cuts[:, 1:]], axis=-1).reshape(-1, 2))
        rows.append(np.repeat(np.flatnonzero(parts == count), count))
    return np.concatenate(result), np.concatenate(rows)
