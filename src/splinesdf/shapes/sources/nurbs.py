"""B-splines and NURBS of any degree, cut into polynomial pieces.

    control, knots ──blossom──> one Bézier span between each two knots
        polynomial, degree <= 7 ──────────────────────> the span itself, exactly
        rational, or of a higher degree ──compile──> pieces of degree 7, good to a few ulp

Everything up to the spans is convex combinations of control points, so nothing is lost there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.errors import InputError
from splinesdf.ground.arrays import (
    LARGEST,
    Floats,
    Ints,
    as_floats,
    as_points,
    largest_coordinate,
    shown,
    whole,
)
from splinesdf.shapes.sources.compiled import compile_curve

# Spans up to this degree are kept as they are; the distance costs more with every degree, so
# higher ones are compiled to this degree as formulas are.
_HIGHEST_KEPT = 7
# OpenCASCADE's limit as well. Higher: the work of the blossom grows like degree^3 a span.
_HIGHEST = 25
# The largest weight over the smallest. From 1e13 on, the curve runs through much of its length in a
# step of the parameter that is lost beside one half.
_WIDEST = 1e12
# A jump up to this share of the largest coordinate is rounding, as where loops of pieces are
# joined. Larger: real jumps would vanish unseen.
_ROUNDING_GAP = 1e-13


@dataclass(frozen=True)
class _HalfSpan:
    """The first half of a Bézier span with positive weights, as a curve to compile.

    Small weights at an end make the curve run through much of its length within a tiny step of
    the parameter. Near zero there are enough floats for that, near one there are not: the second
    half is the first half of the span turned around.
    """

    control: Floats
    weights: Floats
    start: float = 0.0
    stop: float = 0.5

    def __call__(self, t: Floats) -> Floats:
        """Points at the parameters: (n,) -> (n, 2)."""
        degree = len(self.control) - 1
        k = np.arange(degree + 1)
        binomial = np.array([math.comb(degree, int(i)) for i in k], dtype=np.float64)
        basis = self.weights * binomial * t[:, None] ** k * (1.0 - t[:, None]) ** (degree - k)
        # Seen from the first point, so that rounding stays in proportion to the span.
        offset = self.control - self.control[0]
        return np.asarray(self.control[0] + basis @ offset / basis.sum(axis=1, keepdims=True))


def nurbs_pieces(
    control: ArrayLike,
    *,
    degree: SupportsIndex,
    knots: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    periodic: bool = False,
) -> list[Floats]:
    """Bézier pieces of one B-spline curve, or of a NURBS curve if there are weights.

    Parameters
    ----------
    control : array_like, shape (n, 2)
        Control points, not multiplied by their weights.
    degree : int
        From 1 to 25.
    knots : array_like, shape (n + degree + 1,), optional
        All knots in order, repeated ones written out, as in SciPy, geomdl and DXF. The curve runs
        from ``knots[degree]`` to ``knots[n]``, which need not be repeated. Rhino leaves out the
        first and last knot: repeat them. Without knots: equal steps, the ends repeated
        degree + 1 times so that the curve starts and ends in a control point.
    weights : array_like, shape (n,), optional
        Positive, the largest at most 1e12 times the smallest; only their ratios count.
    periodic : bool
        The n control points are one period of a closed curve and wrap around. Without knots these
        are equal steps, and the curve has degree - 1 continuous derivatives everywhere. Given
        knots are then one period, shape (n + 1,): ``knots[n]`` is ``knots[0]`` again, the span
        that starts at ``knots[0]`` depends on the control points 0 to degree as in OpenCASCADE,
        and a knot that is repeated there is repeated at the end of the array. A curve whose
        control points are already repeated (Rhino, geomdl, SciPy) needs no ``periodic``.

    Returns
    -------
    list of ndarray, shape (d + 1, 2)
        Each piece starts exactly where the last one ended; spans of length zero are left out.
        Polynomial spans up to degree 7 are exact but for the rounding of their control points (d
        is the degree). Others are compiled to d = 7 (or 1), good to a few units in the last place
        of the largest coordinate of the control points.

    Raises
    ------
    InputError
        If an argument is not as described, or the curve jumps at a knot that is repeated
        degree + 1 times.

    References
    ----------
    L. Ramshaw, *Blossoms are polar forms*, Computer Aided Geometric Design 6 (1989) 323-358.
    """
    points = _control(control)
    order = _degree(degree)
    mass = _weights(weights, len(points))
    if periodic:
        if len(points) < 3:
            raise InputError(
                f"expected at least 3 control points for a periodic curve, got {len(points)}"
            )
        every = _periodic_knots(knots, len(points), order)
        wrapped = np.arange(len(points) + order) % len(points)
        points, mass = points[wrapped], mass[wrapped]
    else:
        if len(points) <= order:
            raise InputError(
                f"expected at least {order + 1} control points for degree {order}, "
                f"got {len(points)}"
            )
        every = _given_knots(knots, len(points), order)
    inner = every[order : len(points) + 1]
    spans = order + np.flatnonzero(np.diff(inner))
    if len(spans) == 0:
        raise InputError(f"expected knots that increase, got {inner[0]:g} all along the curve")
    beziers = _bezier_spans(points, mass, every, order, spans)
    # Weights may hide the farthest points in a tiny part of a span, where samples miss them.
    largest = max(float(np.max(np.abs(bezier))) for bezier, _ in beziers)
    pieces: list[Floats] = []
    for index, (bezier, weight) in zip(spans, beziers, strict=True):
        active = mass[index - order : index + 1]
        rational = bool(np.any(active != active[0]))
        pieces += _span_pieces(bezier, weight, rational=rational, scale=largest)
    _join(pieces, float(np.max(np.abs(points))))
    return [piece for piece in pieces if np.any(piece != piece[0])]


def _bezier_spans(
    points: Floats, mass: Floats, knots: Floats, degree: int, spans: Ints
) -> list[tuple[Floats, Floats]]:
    """Control points and weights of the Bézier span from knot i to i + 1, for each i in ``spans``.

    Bézier point k is the blossom at (degree - k) times the left and k times the right knot. Points
    are weighed at each step, not multiplied by their weights first: so a control point that the
    curve passes through comes out to the bit.
    """
    active = spans[:, None] + np.arange(-degree, 1)
    table = np.repeat(points[active][:, None], degree + 1, axis=1)
    weight = np.repeat(mass[active][:, None], degree + 1, axis=1)
    left, right = knots[spans, None, None], knots[spans + 1, None, None]
    for step in range(1, degree + 1):
        argument = np.where(np.arange(degree + 1)[:, None] >= step, right, left)
        low = spans[:, None] + np.arange(step - degree, 1)
        first, last = knots[low][:, None], knots[low + degree - step + 1][:, None]
        share = (argument - first) / (last - first)
        after = share * weight[..., 1:]
        weight = (1.0 - share) * weight[..., :-1] + after
        share = (after / weight)[..., None]
        table = (1.0 - share) * table[:, :, :-1] + share * table[:, :, 1:]
    return list(zip(table[:, :, 0], weight[:, :, 0], strict=True))


def _span_pieces(control: Floats, weights: Floats, *, rational: bool, scale: float) -> list[Floats]:
    # With weights, a straight piece from end to end is the same straight piece.
    if len(control) > 2 and (rational or len(control) > _HIGHEST_KEPT + 1):
        first = compile_curve(_HalfSpan(control, weights), scale=scale)
        second = compile_curve(_HalfSpan(control[::-1], weights[::-1]), scale=scale)
        return first + [piece[::-1].copy() for piece in reversed(second)]
    return [control]


def _join(pieces: list[Floats], largest: float) -> None:
    """Let each piece start where the last one ended, or refuse a jump."""
    for before, after in pairwise(pieces):
        gap = math.dist(before[-1], after[0])
        if gap > _ROUNDING_GAP * largest:
            raise InputError(
                f"expected a curve without jumps, got a knot repeated degree + 1 times where it "
                f"jumps by {gap:.3g} from ({before[-1, 0]:.6g}, {before[-1, 1]:.6g})"
            )
        after[0] = before[-1]


def _control(control: ArrayLike) -> Floats:
    points = as_points(control)
    if points.ndim != 2:
        raise InputError(f"expected control points of shape (n, 2), got shape {points.shape}")
    if not np.isfinite(points).all():
        raise InputError("expected finite control points, got NaN or infinity")
    largest_coordinate(points)
    return points


def _degree(degree: SupportsIndex) -> int:
    if isinstance(degree, float) or not hasattr(type(degree), "__index__"):
        raise InputError(f"expected a degree as an integer, got {shown(degree)}")
    return whole(degree, "degree", least=1, most=_HIGHEST)


def _weights(weights: ArrayLike | None, count: int) -> Floats:
    """The weights as shares of the largest, so that no product with them overflows."""
    if weights is None:
        return np.ones(count)
    array = as_floats(weights, "weights")
    if array.shape != (count,):
        raise InputError(
            f"expected one weight for each of {count} control points, got shape {array.shape}"
        )
    bad = ~(np.isfinite(array) & (array > 0.0))
    if bad.any():
        index = int(np.flatnonzero(bad)[0])
        raise InputError(
            f"expected positive finite weights, got {array[index]:g} for control point {index + 1}"
        )
    least, most = float(array.min()), float(array.max())
    if least < most / _WIDEST:
        raise InputError(
            f"expected weights within a factor of {_WIDEST:g}, got {least:.3g} and {most:.3g}"
        )
    return np.asarray(array / most)


def _given_knots(knots: ArrayLike | None, count: int, degree: int) -> Floats:
    if knots is None:
        steps = np.arange(count - degree + 1, dtype=np.float64)
        return np.concatenate([np.zeros(degree), steps, np.full(degree, steps[-1])])
    array = _checked_knots(knots, degree)
    if len(array) != count + degree + 1:
        raise InputError(
            f"expected {count + degree + 1} knots for {count} control points and degree {degree}, "
            f"got {len(array)}"
        )
    return array


def _periodic_knots(knots: ArrayLike | None, count: int, degree: int) -> Floats:
    """The knots of one period, continued by ``degree`` knots at both ends."""
    if knots is None:
        return np.arange(-degree, count + degree + 1, dtype=np.float64)
    array = _checked_knots(knots, degree)
    if len(array) != count + 1:
        raise InputError(
            f"expected one period of {count + 1} knots for {count} periodic control points, "
            f"got {len(array)}"
        )
    if array[0] == array[1]:
        raise InputError(
            f"expected the first knot of a period once, got {array[0]:g} twice: repeat it at the "
            f"end of the period"
        )
    # From zero, so that a knot repeated at the seam stays the same number on both sides of it.
    steps = array - array[0]
    turn, place = np.divmod(np.arange(-degree, count + degree + 1), count)
    return np.asarray(steps[place] + turn * steps[-1])


def _checked_knots(knots: ArrayLike, degree: int) -> Floats:
    """Knots that are finite, in order, and repeated degree + 1 times at most."""
    array = as_floats(knots, "knots")
    if array.ndim != 1 or len(array) < 2:
        raise InputError(f"expected a row of knots, got shape {array.shape}")
    if not np.isfinite(array).all():
        raise InputError("expected finite knots, got NaN or infinity")
    if np.max(np.abs(array)) > LARGEST:
        raise InputError(f"expected knots up to {LARGEST:g}, got {np.max(np.abs(array)):.3g}")
    falls = np.flatnonzero(np.diff(array) < 0.0)
    if len(falls):
        index = int(falls[0])
        raise InputError(
            f"expected knots in increasing order, got {array[index]:g} before {array[index + 1]:g}"
        )
    value, times = np.unique(array, return_counts=True)
    most = int(np.argmax(times))
    if times[most] > degree + 1:
        raise InputError(
            f"expected knots repeated at most degree + 1 = {degree + 1} times, got {value[most]:g} "
            f"{times[most]} times"
        )
    return array
