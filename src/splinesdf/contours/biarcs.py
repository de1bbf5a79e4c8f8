"""`as_arcs`: a contour made only of lines and circular arcs, within a tolerance.

contour ─cut at corners, lines and circular arcs─→ smooth runs of other conics
        ─the farthest-reaching biarcs, across the conics' joints─→ lines and circular arcs
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from splinesdf.contours.conics import Element, Kind, classify, elements, rounding, unfolded
from splinesdf.contours.contour import (
    Contour,
    check_tolerance,
    evened,
    halve,
    smallest_tolerance,
    to_origin,
    unit,
)
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, positive

# Arcs that meet at less than this angle (radians) are joined smoothly, to which the biarcs hold
# exactly. Chains of conics are smooth within 1e-6; corners that a part has on purpose are far
# above. Larger, and flat corners get rounded, though within the tolerance; smaller, and runs end
# where rounding says so.
_SMOOTH = 1e-5
# This share of a tolerance is for what readers of circular arcs lose to rounding, and for the
# chords of those so flat that they would lose more. Larger, and there are more arcs; smaller, and
# more of the flat ones are cut into many chords.
_FLAT_SHARE = 0.02
# The most that an arc may turn is a quarter: beyond it cos(half) of a weight loses digits.
_QUARTER = np.sqrt(0.5) * (1.0 - 1e-12)


def as_arcs(contour: Contour, *, tolerance: float) -> Contour:
    """The contour as lines and circular arcs.

    Parameters
    ----------
    contour : Contour
    tolerance : float
        No point of the result is farther from the contour, nor one of the contour from the
        result.

    Returns
    -------
    Contour
        Its lines have the weight 1 and P1 in their middle; its circular arcs turn by a quarter at
        most. Lines and circular arcs of the contour are among them, to the bit, if they are
        longer than the tolerance. Corners stay where they are; elsewhere the tangent is
        continuous, to rounding. Level, direction, closedness and parent are the contour's.

    Raises
    ------
    InputError
        If the tolerance is not positive, or below the rounding of the coordinates.

    References
    ----------
    [Bolton1975] Biarc curves, Computer-Aided Design 7 (2), 89-92: the biarc of equal legs.

    Examples
    --------
    >>> import splinesdf as ss
    >>> ellipse = ss.Shape.from_formula("2*cos(t)", "sin(t)")
    >>> contour = ss.offset(ellipse, 0.5, tolerance=1e-3)[0]
    >>> arcs = ss.as_arcs(contour, tolerance=1e-3)
    >>> len(contour.arcs), len(arcs.arcs)  # doctest: +SKIP
    (8, 24)
    """
    if not isinstance(contour, Contour):
        raise InputError(f"expected a Contour, got {type(contour).__name__}: give them one by one")
    check_tolerance(tolerance, contour.arcs)
    grain = rounding(contour.arcs)
    contour = unfolded(contour)
    # Near the origin new points are rounded less; what is there already comes back to the bit.
    arcs, origin = to_origin(contour.arcs)
    contour = replace(contour, arcs=arcs)
    pieces, weights, fixed = _pieces(contour, grain)
    smooth = _smooth_joints(contour.closed, pieces, grain)
    fixed &= ~_negligible(pieces, fixed, smooth, positive(tolerance, "tolerance"))
    chains: list[tuple[Floats, Floats]] = []
    for first, last in _runs(fixed, smooth):
        arcs, heavy = pieces[first:last], weights[first:last]
        if not fixed[first]:
            tangents = _tangents(pieces, fixed, smooth, first, last)
            arcs, heavy = _follow(arcs, heavy, tangents, float(tolerance), grain)
        chains.append((arcs, heavy))
    arcs, weights = (np.concatenate(parts) for parts in zip(*chains, strict=True))
    wide = (weights < _QUARTER) & (classify(arcs, weights, grain).kind == Kind.CIRCLE)
    # Halved twice, even a whole turn is four quarters.
    for _ in range(2):
        arcs, weights = halve(arcs, weights, wide)
        wide = (weights < _QUARTER) & (classify(arcs, weights, grain).kind == Kind.CIRCLE)
    return replace(contour, arcs=arcs + origin, weights=weights)


def arc_elements(contour: Contour, *, tolerance: float) -> list[Element]:
    """What a machine follows of a contour: lines and circular arcs whose centers it finds.

    Parameters
    ----------
    contour : Contour
    tolerance : float
        Of it, some hundredths are left for arcs so flat that their centers are beyond reading:
        they become chords.
    """
    least = smallest_tolerance(contour.arcs)
    arcs = as_arcs(contour, tolerance=max((1.0 - _FLAT_SHARE) * tolerance, least))
    allowed = max(_FLAT_SHARE * tolerance, least)
    result: list[Element] = []
    # The arcs were rounded once more, which tells on those of a few roundings: they are found
    # with twice the grain, and what even then is neither line nor circle is no wider than that.
    for piece in elements(arcs, 2.0 * rounding(arcs.arcs)):
        if piece.kind is Kind.CIRCLE:
            result += piece.chords(allowed) if piece.is_flat(allowed) else [piece]
        else:
            result.append(Element(Kind.LINE, piece.first, piece.count, piece.start, piece.end))
    return result


def _pieces(contour: Contour, grain: float) -> tuple[Floats, Floats, Bools]:
    """Lines and circular arcs as they are and evened parts of the others; which are the former."""
    arcs, weights, fixed = [], [], []
    kind = classify(contour.arcs, contour.weights, grain).kind
    steady = (kind == Kind.LINE) | (kind == Kind.CIRCLE)
    for first, last in _runs(steady, np.append(False, steady[1:] == steady[:-1])):
        part, heavy = contour.arcs[first:last], contour.weights[first:last]
        if steady[first]:
            part, heavy = _standard(part, heavy, kind[first:last] == Kind.LINE)
        else:
            part, heavy = evened(part, heavy)
        arcs.append(part)
        weights.append(heavy)
        fixed.append(np.full(len(part), steady[first]))
    pieces, heavy = np.concatenate(arcs), np.concatenate(weights)
    # What has no extent has no tangent, and nobody misses it.
    some = np.any(pieces[:, 0] != pieces[:, 2], axis=1)
    if not some.any():
        some[0] = True
    return pieces[some], heavy[some], np.concatenate(fixed)[some]


def _standard(arcs: Floats, weights: Floats, line: Bools) -> tuple[Floats, Floats]:
    """The same, lines with the weight 1 and P1 in their middle."""
    arcs = arcs.copy()
    arcs[line, 1] = 0.5 * (arcs[line, 0] + arcs[line, 2])
    return arcs, np.where(line, 1.0, weights)


def _ends(pieces: Floats) -> tuple[Floats, Floats]:
    """Unit tangents at the starts and ends of pieces; zero where there is none."""
    chords = pieces[:, 2] - pieces[:, 0]
    result = []
    for legs in (pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 1]):
        legs = np.where(np.any(legs != 0.0, axis=1)[:, None], legs, chords)
        result.append(unit(legs))
    return result[0], result[1]


def _smooth_joints(closed: bool, pieces: Floats, grain: float) -> Bools:
    """For each piece, whether it goes on smoothly from the one before (the last, for the first)."""
    starts, ends = _ends(pieces)
    before = np.roll(ends, 1, axis=0)
    turn = np.hypot(*(starts - before).T)
    # The tangents of a short piece are as uncertain as its legs are short.
    legs = np.minimum(
        np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1),
        np.linalg.norm(np.roll(pieces[:, 2] - pieces[:, 1], 1, axis=0), axis=1),
    )
    allowed = _SMOOTH + 8.0 * grain / np.maximum(legs, 8.0 * grain)
    smooth: Bools = turn <= allowed
    smooth[0] &= closed
    return smooth


def _runs(fixed: Bools, smooth: Bools) -> Iterator[tuple[int, int]]:
    """First and past-the-end piece of each stretch of fixed ones, and of others joined smoothly."""
    changes = (fixed[1:] != fixed[:-1]) | (~fixed[1:] & ~smooth[1:])
    bounds = [0, *(np.flatnonzero(changes) + 1).tolist(), len(fixed)]
    yield from pairwise(bounds)


def _negligible(pieces: Floats, fixed: Bools, smooth: Bools, tolerance: float) -> Bools:
    """Lines and circular arcs shorter than the tolerance, between two other conics.

    A chain of conics passes through them where it is bent little; kept, they would end the runs.
    """
    result = np.zeros(len(fixed), dtype=np.bool_)
    lengths = np.linalg.norm(pieces[:, 2] - pieces[:, 0], axis=1)
    for first, last in _runs(fixed, smooth):
        inner = first > 0 and last < len(fixed)
        if fixed[first] and inner and smooth[first : last + 1].all():
            result[first:last] = lengths[first:last].sum() < tolerance
    return result


def _tangents(pieces: Floats, fixed: Bools, smooth: Bools, first: int, last: int) -> Floats:
    """Unit tangents at the joints of a run: of both sides, or of a line or circular arc beside."""
    starts, ends = _ends(pieces)
    count = len(pieces)
    here = np.arange(first, last + 1)
    before, after = (here - 1) % count, here % count
    left, right = ends[before], starts[after]
    both = unit(left + right)
    # A joint at the run's end has another piece beside it only if it is smooth.
    joined = smooth[after]
    both[fixed[before] & joined] = left[fixed[before] & joined]
    both[fixed[after] & joined] = right[fixed[after] & joined]
    if not joined[0]:
        both[0] = right[0]
    if not joined[-1]:
        both[-1] = left[-1]
    return both


def _follow(
    arcs: Floats, weights: Floats, tangents: Floats, tolerance: float, grain: float
) -> tuple[Floats, Floats]:
    """A run as biarcs."""
    from splinesdf.contours.kernels.biarcs import (  # Numba loads only when used
        fill_biarcs,
        find_knots,
    )

    knots = find_knots(
        np.ascontiguousarray(arcs), np.ascontiguousarray(weights), tangents, tolerance
    )
    result = np.zeros((2 * (len(knots) - 1), 3, 2))
    fill_biarcs(knots, result)
    return _straightened(result, grain)


def _straightened(arcs: Floats, grain: float) -> tuple[Floats, Floats]:
    """The weights of biarcs; those that are straight to rounding become one line."""
    straight = classify(arcs, _weights(arcs), grain).kind == Kind.LINE
    both = straight[::2] & straight[1::2]
    arcs = arcs.copy()
    arcs[::2][both, 2] = arcs[1::2][both, 2]
    arcs = arcs[np.stack([np.ones_like(both), ~both], axis=1).ravel()]
    straight = classify(arcs, _weights(arcs), grain).kind == Kind.LINE
    return _standard(arcs, _weights(arcs), straight)


def _weights(arcs: Floats) -> Floats:
    """The weights with which arcs with equal legs are circular."""
    half = 0.5 * np.linalg.norm(arcs[:, 2] - arcs[:, 0], axis=1)
    height = np.linalg.norm(arcs[:, 1] - 0.5 * (arcs[:, 0] + arcs[:, 2]), axis=1)
    slant = np.hypot(half, height)
    result: Floats = np.divide(half, slant, out=np.ones_like(half), where=slant > 0.0)
    return result
