"""The conic of each arc of a contour, and of consecutive arcs together.

    arcs ─classify─→ line, circle, ellipse, parabola or hyperbola ─elements─→ one line where arcs
    lie on one line, one circular arc where they lie on one circle

Points are complex numbers in an `Element`: turning about a center is then one product.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from splinesdf.contours.contour import Contour, evaluate, unit
from splinesdf.contours.extremes import evaluate_each
from splinesdf.ground.arrays import Floats, Ints

_EPS = float(np.finfo(np.float64).eps)
# Within this many ulp of the largest coordinate an arc counts as a line, a circle or a parabola:
# the rounding of its control points makes as much. Fewer, and circles that were computed are not
# recognized; more, and what is truly bent is straightened.
_ROUNDING = 4.0 * _EPS
# And this far from one line or circle arcs may lie that are merged: their ends and shoulders are
# rounded one by one, and the circle through three of them is up to three times as uncertain.
_MERGED = 16.0 * _EPS
# Readers of circular arcs find a point from the center, radius and angle, each rounded: so many
# radii are lost. Fewer, and flat arcs are read wrongly; more, and they are drawn otherwise although
# they could be read.
_READ = 4.0 * _EPS
# Sweeps that add up to a full turn within this (radians) are one: each is good to a few ulp
# unless its arc is tiny.
_FULL_TURN = 1e-6


class Kind(IntEnum):
    """What an arc is part of."""

    LINE = 0
    CIRCLE = 1
    ELLIPSE = 2
    PARABOLA = 3
    HYPERBOLA = 4


class Conics(NamedTuple):
    """What arcs are, row by row. The circle is NaN for all that are none."""

    kind: Ints  # (n,) a `Kind`
    center: Floats  # (n, 2)
    radius: Floats  # (n,)
    sweep: Floats  # (n,) radians, positive if x turns into y


@dataclass(frozen=True)
class Element:
    """One or more consecutive arcs of a contour that are one curve.

    Attributes
    ----------
    kind : Kind
    first, count : int
        It stands for so many arcs from that one on, past the last one on to the first.
    start, end : complex
        x + iy, to the bit those of the arcs; equal for a full circle.
    center, radius, sweep : complex, float, float
        NaN unless it is a circle's. The sweep is positive if x turns into y, and up to 2 pi.
    """

    kind: Kind
    first: int
    count: int
    start: complex
    end: complex
    center: complex = complex(math.nan, math.nan)
    radius: float = math.nan
    sweep: float = math.nan

    @property
    def is_full(self) -> bool:
        """Whether it is a full circle."""
        return self.kind is Kind.CIRCLE and abs(self.sweep) == 2.0 * math.pi

    def is_flat(self, allowed: float) -> bool:
        """Whether a reader who works from the center may miss the arc by more than this."""
        if self.kind is not Kind.CIRCLE or self.is_full:
            return False
        # Nearer centers cost no more than the coordinates themselves.
        far = self.radius > 4.0 * abs(self.end - self.start)
        return far and _READ * self.radius > allowed

    def chords(self, allowed: float) -> list[Element]:
        """A circular arc as lines between points of it, from which it bulges no more than this."""
        bulge = 2.0 * self.radius * math.sin(0.25 * self.sweep) ** 2
        count = max(1, math.ceil(math.sqrt(bulge / allowed)))
        return [
            Element(Kind.LINE, self.first, self.count, part.start, part.end)
            for part in self.cut([k / count for k in range(1, count)])
        ]

    def parts(self, most: float) -> list[Element]:
        """A circular arc as equal ones that sweep no more than this each; a line as it is."""
        if self.kind is not Kind.CIRCLE:
            return [self]
        # A hair more is let through: a half turn that is off by rounding stays one.
        count = max(1, math.ceil(abs(self.sweep) / most - _FULL_TURN))
        return self.cut([k / count for k in range(1, count)])

    def cut(self, shares: Sequence[float]) -> list[Element]:
        """A line or circular arc cut at shares of its way, ascending, in (0, 1)."""
        spoke = self.start - self.center
        if self.kind is Kind.LINE:
            inner = [self.start + share * (self.end - self.start) for share in shares]
        else:
            # From the start, not from the center: that of a flat arc is so far away that its
            # rounding is larger than the arc.
            inner = [self.start + spoke * _turn_by(share * self.sweep) for share in shares]
        points = [self.start, *inner, self.end]
        lengths = np.diff([0.0, *shares, 1.0]).tolist()
        return [
            Element(
                *(self.kind, self.first, self.count, points[k], points[k + 1]),
                *(self.center, self.radius, length * self.sweep),
            )
            for k, length in enumerate(lengths)
        ]


def _turn_by(angle: float) -> complex:
    """What turning by an angle adds to a vector, as a share of it: without cancellation."""
    return 2j * math.sin(0.5 * angle) * cmath.rect(1.0, 0.5 * angle)


def rounding(arcs: Floats) -> float:
    """How far rounding may have moved the control points of arcs."""
    return _ROUNDING * float(np.abs(arcs).max())


def classify(arcs: Floats, weights: Floats, grain: float | None = None) -> Conics:
    """What each arc is, to rounding: (n, 3, 2), (n,) -> n rows.

    An arc counts as the simplest kind that it is nowhere farther from than ``grain``, by default
    the rounding of its coordinates: four ulp of the largest of them all. A line that turns back
    on itself is not a line: see `unfolded`.
    """
    grain = rounding(arcs) if grain is None else grain
    a, along, forward, height = _in_frame(arcs)
    h = np.abs(height)
    # The shoulder has the share w / (1 + w) of P1, so much of P1's error comes through.
    share = weights / (1.0 + weights)
    flat = h * share <= grain
    line = flat & (_overshoot(a, forward, weights)[0] <= grain)
    slant = np.hypot(a, h)
    cosine = np.divide(a, slant, out=np.ones_like(a), where=slant > 0.0)
    off = np.abs(share - cosine / (1.0 + cosine)) * slant
    circle = ~flat & (np.abs(forward) * share <= grain) & (off <= grain) & (a > 0.0)
    # Of weight 1 and of weight w it is two arcs that differ by half the change of the share.
    parabola = np.abs(share - 0.5) * slant <= grain
    kind = np.select(
        [line, circle, parabola, weights < 1.0],
        [Kind.LINE, Kind.CIRCLE, Kind.PARABOLA, Kind.ELLIPSE],
        Kind.HYPERBOLA,
    ).astype(np.int64)
    steep = np.where(circle, height, np.nan)
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    middle = 0.5 * (arcs[:, 0] + arcs[:, 2])
    center = middle - normal * (a * a / steep)[:, None]
    # Positive height: P1 is on the left, and the arc turns to the right.
    sweep = -2.0 * np.arctan2(steep, a)
    return Conics(kind, center, a * slant / np.abs(steep), sweep)


def unfolded(contour: Contour) -> Contour:
    """The contour with each arc that is folded onto a line cut in its tip: two lines.

    Folded is an arc that leaves the line through its ends by rounding only and turns back on it.
    Nearly so, an ellipse has an axis that is all rounding, and no reader finds it again.
    """
    arcs, weights = contour.arcs, contour.weights
    grain = rounding(arcs)
    a, _, forward, height = _in_frame(arcs)
    over, tip = _overshoot(a, forward, weights)
    folded = (np.abs(height) * (weights / (1.0 + weights)) <= grain) & (over > grain)
    if not folded.any():
        return contour
    rows = np.repeat(np.arange(len(arcs)), np.where(folded, 2, 1))
    cut, heavy = arcs[rows], weights[rows]
    first = np.flatnonzero(folded) + np.arange(np.count_nonzero(folded))
    tips = evaluate_each(arcs[folded], weights[folded], tip[folded])
    cut[first, 2] = cut[first + 1, 0] = tips
    for lines in (first, first + 1):
        cut[lines, 1] = 0.5 * (cut[lines, 0] + cut[lines, 2])
        heavy[lines] = 1.0
    return replace(contour, arcs=cut, weights=heavy)


def _in_frame(arcs: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Half the chord, its direction, and P1 along and to the left of it, from its middle.

    Of an arc that ends where it starts the direction is that to P1.
    """
    half = 0.5 * (arcs[:, 2] - arcs[:, 0])
    apart = 0.5 * (arcs[:, 1] - arcs[:, 0]) + 0.5 * (arcs[:, 1] - arcs[:, 2])
    a = np.hypot(half[:, 0], half[:, 1])
    along = unit(np.where((a > 0.0)[:, None], half, apart))
    forward = np.sum(apart * along, axis=1)
    height = along[:, 0] * apart[:, 1] - along[:, 1] * apart[:, 0]
    return a, along, forward, height


def _overshoot(a: Floats, forward: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """How far arcs reach beyond their chords, measured along these, and at which parameter.

    With e from the end to the foot of P1, beyond it, and s = t / (1 - t), the arc is at
    2 (w e s - a) / (1 + 2 w s + s²) from the end; the largest such number is a root of a square.
    """
    e = np.maximum(np.abs(forward) - a, 0.0)
    # With numbers up to 1 instead of w, so that no square overflows: u = min(w, 1), v = u / w.
    u, v = np.minimum(weights, 1.0), 1.0 / np.maximum(weights, 1.0)
    root = np.hypot(a * v * v, np.sqrt(e) * np.sqrt(e + 2.0 * a) * u * v) + a * v * v
    below = u * u * e + root
    over = np.divide(u * u * e * e, below, out=np.zeros_like(e), where=below > 0.0)
    below = root + u * v * e
    t = np.divide(root, below, out=np.ones_like(e), where=below > 0.0)
    return over, np.where(forward < 0.0, 1.0 - t, t)


def elements(contour: Contour, grain: float | None = None) -> list[Element]:
    """The contour's lines, circular arcs and other conics, as few as are exact to rounding.

    Consecutive lines along one line and consecutive arcs of one circle are merged, in a closed
    contour also the last with the first, so the list may start in the middle of the contour's
    first arc's element. Other conics stay one by one. Arcs without an extent are left out. The
    grain is that of `classify`.
    """
    conics = classify(contour.arcs, contour.weights, grain)
    merged: list[Element] = []
    for element in _singles(contour, conics):
        together = _merge(contour, merged[-1], element) if merged else None
        if together is None:
            merged.append(element)
        else:
            merged[-1] = together
    if contour.closed and len(merged) > 1:
        together = _merge(contour, merged[-1], merged[0])
        if together is not None:
            merged = [together, *merged[1:-1]]
    return merged


def _singles(contour: Contour, conics: Conics) -> list[Element]:
    points = contour.arcs[:, ::2].reshape(-1, 4).tolist()
    rows = zip(
        conics.kind.tolist(),
        points,
        conics.center.tolist(),
        conics.radius.tolist(),
        conics.sweep.tolist(),
        strict=True,
    )
    return [
        Element(Kind(kind), i, 1, complex(*ends[:2]), complex(*ends[2:]), complex(*c), r, s)
        for i, (kind, ends, c, r, s) in enumerate(rows)
        if ends[:2] != ends[2:] or kind not in (Kind.LINE, Kind.CIRCLE)
    ]


def _merge(contour: Contour, one: Element, other: Element) -> Element | None:
    """Both as one element, or None if they are not one curve."""
    if one.kind is not other.kind or one.kind not in (Kind.LINE, Kind.CIRCLE):
        return None
    count = other.first + other.count - one.first
    count = count if count > 0 else count + len(contour.arcs)
    rows = np.arange(one.first, one.first + count) % len(contour.arcs)
    grain = _MERGED * float(np.abs(contour.arcs).max())
    if one.kind is Kind.LINE:
        way = other.end - one.start
        joints = _complex(contour.arcs[rows[1:], 0]) - one.start
        turned = ((one.end - one.start) * (other.end - other.start).conjugate()).real <= 0.0
        if turned or way == 0.0 or np.abs((joints * way.conjugate()).imag).max() > grain * abs(way):
            return None
        return Element(Kind.LINE, one.first, count, one.start, other.end)
    sweep = one.sweep + other.sweep
    if one.sweep * other.sweep < 0.0 or abs(sweep) > 2.0 * math.pi + _FULL_TURN:
        return None
    halves = evaluate(contour.arcs[rows], contour.weights[rows], np.array([0.0, 0.5]))
    points = np.append(_complex(halves.reshape(-1, 2)), other.end)
    center, radius = _circle_through(points)
    if not np.abs(np.abs(points - center) - radius).max() <= grain:
        return None
    if abs(sweep) >= 2.0 * math.pi - _FULL_TURN and one.start == other.end:
        sweep = math.copysign(2.0 * math.pi, sweep)
    return Element(Kind.CIRCLE, one.first, count, one.start, other.end, center, radius, sweep)


def _circle_through(points: np.ndarray) -> tuple[complex, float]:
    """The circle through three of the points along an arc of it, far apart."""
    last = len(points) - 1
    b, c = points[last // 2] - points[0], points[last] - points[0]
    if abs(c) < abs(b):
        b, c = points[last // 3] - points[0], points[2 * last // 3] - points[0]
    cross = (b.conjugate() * c).imag
    # Flatter than the rounding of its points, a triangle has no circle.
    if abs(cross) <= _EPS * float(np.abs(points).max()) * abs(c):
        return complex(math.nan, math.nan), math.nan
    spoke = complex(1j * (b * abs(c) ** 2 - c * abs(b) ** 2) / (2.0 * cross))
    return complex(points[0] + spoke), abs(spoke)


def _complex(points: Floats) -> np.ndarray:
    """Points (n, 2) as n complex numbers."""
    return points[:, 0] + 1j * points[:, 1]
