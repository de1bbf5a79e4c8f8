"""A conic's arc between two of its points as a rational quadratic Bézier curve, exactly."""

from __future__ import annotations

import numpy as np

from splinesdf.contours.contour import evaluate
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.splines.level_sets.quadratics import Quadratics

# Arcs that turn further than about this cosine says (100 degrees) are cut: at 180 the tangents no
# longer meet ahead. Smaller turns would only make more arcs.
_TURN = -0.2
# Below this sine the tangents' meeting point loses more digits than the parabola with the same
# sag, which is off by the square of the turn.
_STRAIGHT = 1e-8
# A gradient below this share of the other end's, or of its change on the way, is rounding: the
# level passes a saddle or the ridge of a fold there, where its arcs are straight.
_STATIONARY = 1e-9
# An arc that bows by less than this share of its chord is straight: larger ones begin to matter,
# and along the lines of a saddle no digit of the bow is right.
_FLAT = 1e-9
# An ellipse is less than a full turn and each cut halves it: 5 leave no turn above 100 degrees.
_CUTS = 5
# Where an arc is asked whether it is in its triangle: next to its ends shows the tangents there.
_PLACES = np.array([0.05, 0.5, 0.95])


def conic_arcs(
    quadratics: Quadratics, first: Floats, last: Floats, shortest: float
) -> tuple[Ints, Floats, Floats]:
    """Arcs of f = 0 from ``first`` to ``last``, f negative on the left.

    Parameters
    ----------
    quadratics : Quadratics
        n of them.
    first, last : ndarray, shape (n, 2)
    shortest : float
        What would have to be cut nearer than this to an end is straight instead.

    Returns
    -------
    rows : ndarray, shape (m,)
        Which of the n an arc belongs to; arcs of one follow one another. m > n if some turn so
        far that they are cut.
    arcs : ndarray, shape (m, 3, 2)
    weights : ndarray, shape (m,)
    """
    rows = np.arange(len(first))
    for _ in range(_CUTS):
        f = quadratics.take(rows)
        middle, weight, bad = _middles(f, first, last)
        turning = f.take(np.flatnonzero(bad))
        at = shoulders(turning, first[bad], last[bad])
        # An arc that would leave its triangle joins two crossings that rounding has put in the
        # wrong order; they are so close together that it stays straight.
        there = turning.contains(at)
        # Next to a saddle at the level rounding decides which way an arc turns.
        chord = last[bad] - first[bad]
        for end in (first[bad], last[bad]):
            there &= np.linalg.norm(at - end, axis=1) >= shortest
        there &= np.abs(_cross(chord, at - first[bad])) >= _FLAT * np.sum(chord * chord, axis=1)
        bad[bad] = there
        at = at[there]
        if not bad.any():
            break
        copies = np.where(bad, 2, 1)
        early = (np.cumsum(copies) - copies)[bad]
        rows = np.repeat(rows, copies)
        first, last = np.repeat(first, copies, axis=0), np.repeat(last, copies, axis=0)
        last[early], first[early + 1] = at, at
    else:
        f = quadratics.take(rows)
        middle, weight, _ = _middles(f, first, last)
    arcs = np.stack([first, middle, last], axis=1)
    # On a plateau at the level rounding makes the conic; what leaves the triangle is straight.
    astray = ~np.all([f.contains(at) for at in evaluate(arcs, weight, _PLACES).swapaxes(0, 1)], 0)
    arcs[astray, 1] = 0.5 * (first + last)[astray]
    weight[astray] = 1.0
    return rows, arcs, weight


def _middles(f: Quadratics, first: Floats, last: Floats) -> tuple[Floats, Floats, Bools]:
    """P1 and its weight, and which arcs turn too far to have one (they get a straight line)."""
    chord = last - first
    slopes = f.gradient_at(first), f.gradient_at(last)
    start, end = (_ahead(slope) for slope in slopes)
    steep = np.linalg.norm([*slopes, slopes[1] - slopes[0]], axis=-1)
    fold = steep[:2].min(axis=0) <= _STATIONARY * steep.max(axis=0)
    cosine = np.sum(start * end, axis=1)
    sine = _cross(start, end)
    forward = (np.sum(chord * start, axis=1) > 0.0) & (np.sum(chord * end, axis=1) > 0.0)
    straight = (np.abs(sine) <= _STRAIGHT) & (cosine > 0.0) & forward & ~fold
    with np.errstate(invalid="ignore", divide="ignore"):
        reach = _cross(chord, end) / sine
        back = _cross(start, chord) / sine
        leg = reach[:, None] * start
        # The arc is b1² = 4 w² b0 b2 in barycentric coordinates, so w² = -f(M) / f(P1) with M
        # in the middle of the chord; both follow from the Hessian, as f = 0 at the ends and the
        # leg is tangent.
        squared = _form(f.hessian, chord) / (4.0 * _form(f.hessian, leg))
    bad = ~straight & ~fold
    bad &= ~(
        (cosine > _TURN) & (reach > 0.0) & (back > 0.0) & (squared > 0.0) & np.isfinite(squared)
    )
    length = np.hypot(chord[:, 0], chord[:, 1])
    right = np.stack([chord[:, 1], -chord[:, 0]], axis=1)
    # The parabola's sag, bowed to the right where the chord lies on the negative side.
    sag = 0.125 * np.sum((start - end) * right, axis=1)
    bow = 2.0 * sag[:, None] * right / np.where(length > 0.0, length, 1.0)[:, None]
    plain = straight | fold | bad
    middle = np.where(
        plain[:, None],
        0.5 * (first + last) + np.where(straight[:, None], bow, 0.0),
        first + np.where(plain[:, None], 0.0, leg),
    )
    return middle, np.where(plain, 1.0, np.sqrt(np.where(plain, 1.0, squared))), bad


def shoulders(f: Quadratics, first: Floats, last: Floats) -> Floats:
    """The point of each arc farthest from its chord."""
    chord = last - first
    middle = 0.5 * (first + last)
    bend = np.einsum("nij,nj->ni", f.hessian, chord)
    # Along this line from the middle the gradient stays across the chord.
    along = np.stack([bend[:, 1], -bend[:, 0]], axis=1)
    size = np.hypot(along[:, 0], along[:, 1])
    along /= np.where(size > 0.0, size, 1.0)[:, None]
    constant = f.value_at(middle)
    linear = np.sum(f.gradient_at(middle) * along, axis=1)
    square = 0.5 * _form(f.hessian, along)
    root = np.sqrt(np.maximum(linear * linear - 4.0 * constant * square, 0.0))
    with np.errstate(invalid="ignore", divide="ignore"):
        half = -0.5 * (linear + np.copysign(root, linear))
        steps = np.stack([half / square, constant / half], axis=1)
    # If the middle is on the negative side, the arc is to the right of the chord, else left; of
    # two points there, the nearer one is on the same branch.
    side = np.where(constant < 0.0, -1.0, 1.0) * np.sign(_cross(chord, along))
    steps[~np.isfinite(steps)] = np.inf
    wrong = np.signbit(steps) != (side < 0.0)[:, None]
    chosen = np.argmin(np.where(wrong, np.inf, np.abs(steps)), axis=1)
    step = np.take_along_axis(steps, chosen[:, None], axis=1)
    return np.asarray(middle + np.where(np.isfinite(step), step, 0.0) * along)


def _ahead(gradient: Floats) -> Floats:
    """Unit tangents with the negative side on the left; zero where the gradient vanishes."""
    length = np.hypot(gradient[:, 0], gradient[:, 1])
    turned = np.stack([-gradient[:, 1], gradient[:, 0]], axis=1)
    return np.asarray(turned / np.where(length > 0.0, length, 1.0)[:, None])


def _cross(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def _form(hessian: Floats, v: Floats) -> Floats:
    return np.asarray(np.einsum("ni,nij,nj->n", v, hessian, v))
