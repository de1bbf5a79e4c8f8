"""`Contour`: a level set as a chain of conic arcs, each a rational quadratic Bézier curve."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from splinesdf.contours.extremes import extremes
from splinesdf.errors import InputError
from splinesdf.ground.arrays import (
    LARGEST,
    Floats,
    as_floats,
    as_page,
    finite,
    largest_coordinate,
    positive,
)
from splinesdf.ground.brief import brief, counted
from splinesdf.ground.card import Picture, card
from splinesdf.ground.doors import above, public
from splinesdf.ground.values import by_value

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# A tolerance below this share of the largest coordinate asks for more than doubles hold:
# subdivision would go on splitting rounding noise.
_ROUNDING = 16.0 * float(np.finfo(np.float64).eps)
# The default tolerance of polylines, as a share of the larger side: what a picture shows.
_OF_SIDE = 1e-3
# Arcs are even if their sag is at most this share of the chord (a turn of about 0.4 radians) and
# the speeds along them differ by no more than about this factor; 16 Gauss points are then good to
# rounding. Larger: digits are lost. Smaller: only slower.
_EVEN_SAG = 0.05
_EVEN_SPEEDS = 2.0
_GAUSS_POINTS, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(16)


@by_value
@dataclass(frozen=True, eq=False)
class Contour:
    """A chain of conic arcs, each starting exactly where the one before it ended.

    Attributes
    ----------
    arcs : ndarray, shape (n, 3, 2)
        The control points P0, P1, P2 of each arc. The arc lies inside their triangle, starts at
        P0, ends at P2 and its tangents there pass through P1.
    weights : ndarray, shape (n,)
        The weight of P1, positive; P0 and P2 have the weight 1. Below 1 the arc is part of
        an ellipse, at 1 of a parabola (or a straight line), above 1 of a hyperbola.
    closed : bool
        The last arc ends exactly where the first one starts.
    distance : float
        The level: which distance to the shape the contour stands for.
    y_down : bool
        The source's y axis points down (SVG). The coordinates are as in the source.
    parent : Contour, optional
        The contour of the same level that directly encloses this one: None for an outermost one,
        an outer one for a hole, a hole for what lies in it.
    tolerance : float, optional
        Of an offset: how far from its distance a point of it may be.
    fitted : bool
        Of an offset: it is the level set of a fit, as parallels left loose ends. It is within the
        tolerance, but has many arcs, and none of its lines, circles and corners are exact.
    unit : float, optional
        How many millimeters one unit of the coordinates is, as in the shape that it is of.
    page : (xmin, ymin, xmax, ymax), optional
        The page of the drawing that it is of, in the coordinates' unit. `write` mirrors y about
        its height.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> outer = ss.offset(square, 1)[0]
    >>> outer
    <Contour: at 1, 8 arcs, closed>
    >>> round(outer.length, 6), round(outer.area, 6)  # 16 + 2 pi, 32 + pi
    (22.283185, 35.141593)
    >>> len(outer.points(tolerance=0.1)) > len(outer.points(tolerance=1.0))
    True
    >>> outer.svg_path().startswith("M")
    True
    >>> len(outer), [weight for _points, weight in outer] == outer.weights.tolist()
    (8, True)
    >>> axes = outer.plot()
    """

    arcs: Floats
    weights: Floats
    closed: bool = True
    distance: float = 0.0
    y_down: bool = False
    parent: Contour | None = field(default=None, repr=False, compare=False)
    tolerance: float | None = None
    fitted: bool = False
    unit: float | None = None
    page: tuple[float, float, float, float] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "page", as_page(self.page))
        if self.unit is not None:
            object.__setattr__(self, "unit", positive(self.unit, "unit"))
        for name in ("arcs", "weights"):
            object.__setattr__(self, name, as_floats(getattr(self, name), name))
        object.__setattr__(self, "distance", finite(self.distance, "distance"))
        if self.tolerance is not None:
            object.__setattr__(self, "tolerance", positive(self.tolerance, "tolerance"))
        if self.arcs.ndim != 3 or self.arcs.shape[1:] != (3, 2) or len(self.arcs) == 0:
            raise InputError(f"expected arcs of shape (n, 3, 2), n > 0, got {self.arcs.shape}")
        if self.weights.shape != self.arcs.shape[:1]:
            raise InputError(
                f"expected one weight for each of the {len(self.arcs)} arcs, "
                f"got weights of shape {self.weights.shape}"
            )
        if not (np.isfinite(self.arcs).all() and np.isfinite(self.weights).all()):
            raise InputError("expected finite control points and weights, got NaN or infinity")
        if not (self.weights > 0.0).all():
            raise InputError(f"expected positive weights, got {self.weights.min():.6g}")
        if not ((self.weights <= LARGEST) & (self.weights >= 1.0 / LARGEST)).all():
            raise InputError(
                f"expected weights from {1.0 / LARGEST:g} to {LARGEST:g}, got "
                f"{self.weights.min():.3g} to {self.weights.max():.3g}: an arc is its chord or its "
                "legs beyond"
            )
        if 0.0 < largest_coordinate(self.arcs) < 1.0 / LARGEST:
            raise InputError(
                f"expected a coordinate of at least {1.0 / LARGEST:g}, got none above "
                f"{np.abs(self.arcs).max():.3g}: use another unit"
            )
        if not (self.arcs[:-1, 2] == self.arcs[1:, 0]).all():
            raise InputError("expected each arc to start exactly where the last one ended")
        if self.closed and not (self.arcs[-1, 2] == self.arcs[0, 0]).all():
            raise InputError("expected a closed contour to end exactly where it starts")

    def __repr__(self) -> str:
        closed = "closed" if self.closed else "open"
        inner = "" if self.parent is None else "in another"
        return brief(
            "Contour", "", f"at {self.distance:g}", counted(len(self.arcs), "arc"), closed, inner
        )

    def __len__(self) -> int:
        """How many arcs it has."""
        return len(self.arcs)

    def __iter__(self) -> Iterator[tuple[Floats, float]]:
        """The arcs in order, each as its control points, shape (3, 2), and its middle weight."""
        return zip(self.arcs, self.weights.tolist(), strict=True)

    def __getstate__(self) -> tuple[dict[str, Any], tuple[Contour, ...]]:
        """The state for pickle and copy: the parent last of a few ancestors, the outermost first.

        They recurse into what they have not met yet. Of n contours in one another, the parent
        alone would take them n deep; with the ancestors at 1/2, 3/4, 7/8 ... of the depth before
        it, whose own ancestors are then known, they go log n deep.
        """
        line: list[Contour] = []
        above = self.parent
        while above is not None:
            line.append(above)
            above = above.parent
        line.reverse()
        chosen, first = [], 0
        while first < len(line):
            at = (first + len(line)) // 2
            chosen.append(line[at])
            first = at + 1
        return {**self.__dict__, "parent": None}, tuple(chosen)

    def __setstate__(self, state: tuple[dict[str, Any], tuple[Contour, ...]]) -> None:
        fields, ancestors = state
        self.__dict__.update(fields, parent=ancestors[-1] if ancestors else None)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The smallest box around the contour, to rounding: xmin, ymin, xmax, ymax."""
        return box([self])

    def points(self, tolerance: float | None = None) -> Floats:
        """The contour as a polyline that is nowhere farther from it than the tolerance.

        Parameters
        ----------
        tolerance : float, optional
            1e-3 of the larger side of its box unless given.

        Returns
        -------
        ndarray, shape (n, 2)
            All vertices lie on the arcs. Closed: the last one repeats the first.
        """
        allowed = self._tolerance(tolerance)
        arcs, origin = to_origin(self.arcs)
        weights = self.weights
        # Halving divides the sag by four, or by nearly two next to a cusp: it soon is below any
        # tolerance above rounding.
        while (coarse := _sag(arcs, weights) > allowed).any():
            arcs, weights = halve(arcs, weights, coarse)
        return np.concatenate([arcs[:, 0], arcs[-1:, 2]]) + origin

    @property
    def length(self) -> float:
        """The length of the curve, to rounding."""
        _, velocities, steps = self._quadrature()
        return float(np.sum(np.hypot(velocities[..., 0], velocities[..., 1]) * steps))

    @property
    def area(self) -> float:
        """The signed area, to rounding: positive if x turns into y along the contour.

        That is counterclockwise where y points up. An open contour is closed by its chord.
        """
        spokes, velocities, steps = self._quadrature()
        swept = spokes[..., 0] * velocities[..., 1] - spokes[..., 1] * velocities[..., 0]
        return float(0.5 * np.sum(swept * steps))

    def svg_path(self, tolerance: float | None = None) -> str:
        """SVG path data (the ``d`` attribute), exact but for hyperbolas; coordinates as they are.

        Parameters
        ----------
        tolerance : float, optional
            Of hyperbolas, which become cubics: as that of `points`.
        """
        data: str = above("io.writers.svg").path_data(self, self._tolerance(tolerance))
        return data

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the contour on axes, the current ones unless given, and return them."""
        axes: Axes = public("plot").drawn(self, ax)
        return axes

    def _repr_html_(self) -> str:
        figures = {
            "distance": f"{self.distance:g}",
            "arcs": f"{len(self.arcs):,} ({'closed' if self.closed else 'open'})",
            "length": f"{self.length:.6g}",
        }
        picture = Picture([self.points()], self.bounds, y_down=self.y_down, closed=self.closed)
        return card("Contour", "", figures, picture)

    def _tolerance(self, given: float | None) -> float:
        """A tolerance that is none of rounding, or the default."""
        if given is None:
            low, high = np.reshape(self.bounds, (2, 2))
            return max(_OF_SIDE * float(np.max(high - low)), smallest_tolerance(self.arcs))
        check_tolerance(given, self.arcs)
        return given

    def _quadrature(self) -> tuple[Floats, Floats, Floats]:
        """Points as seen from the first, velocities and steps of a Gauss rule over all arcs."""
        # Far from the origin points are rounded and products cancel; differences do not.
        arcs, weights = evened(self.arcs - self.arcs[0, 0], self.weights)
        t = (_GAUSS_POINTS + 1.0)[:, None] / 2.0
        first, middle, last = (arcs[:, None, k] for k in range(3))
        w = weights[:, None, None]
        weight = (1.0 - t) ** 2 + 2.0 * w * t * (1.0 - t) + t**2
        # The quotient rule, with the common factors taken out.
        velocities = (
            2.0
            * (
                w * (1.0 - t) ** 2 * (middle - first)
                + t * (1.0 - t) * (last - first)
                + w * t**2 * (last - middle)
            )
            / weight**2
        )
        return evaluate(arcs, weights, t[:, 0]), velocities, _GAUSS_WEIGHTS / 2.0


def evaluate(arcs: Floats, weights: Floats, parameters: Floats) -> Floats:
    """Points of every arc at every parameter in [0, 1]: (n, 3, 2), (n,), (m,) -> (n, m, 2)."""
    t = parameters[:, None]
    w = weights[:, None, None]
    first, middle, last = (1.0 - t) ** 2, 2.0 * w * t * (1.0 - t), t**2
    sums = first * arcs[:, None, 0] + middle * arcs[:, None, 1] + last * arcs[:, None, 2]
    return sums / (first + middle + last)


def to_origin(arcs: Floats) -> tuple[Floats, Floats]:
    """The arcs moved near to the origin, and by what to move them back, both without rounding.

    Where the numbers of one axis are within a factor of two of each other, their differences are
    exact. Where they are not, they are no larger than their differences, so nothing is to be won.
    """
    flat = arcs.reshape(-1, 2)
    low, high = flat.min(axis=0), flat.max(axis=0)
    close = ((low > 0.0) & (high <= 2.0 * low)) | ((high < 0.0) & (low >= 2.0 * high))
    origin = np.where(close, flat[0], 0.0)
    return arcs - origin, origin


def unit(vectors: Floats) -> Floats:
    """Vectors (..., 2) made one long; zero stays zero. Right down to the tiniest numbers."""
    largest = np.abs(vectors).max(axis=-1, keepdims=True)
    scaled = vectors / np.where(largest > 0.0, largest, 1.0)
    lengths = np.hypot(scaled[..., 0], scaled[..., 1])[..., None]
    result: Floats = scaled / np.where(lengths > 0.0, lengths, 1.0)
    return result


def halve(arcs: Floats, weights: Floats, which: np.ndarray) -> tuple[Floats, Floats]:
    """Cut the arcs named by a mask at their shoulders, exactly; the others stay, in order.

    The shoulder is the point at parameter 1/2, where the tangent is parallel to the chord. Both
    halves get the weight sqrt((1 + w) / 2).
    """
    w = weights[:, None]
    into, out_of = ((arcs[:, k] + w * arcs[:, 1]) / (1.0 + w) for k in (0, 2))
    shoulders = 0.5 * (into + out_of)
    rows = np.repeat(np.arange(len(arcs)), np.where(which, 2, 1))
    result, heavier = arcs[rows], weights[rows]
    at = np.flatnonzero(which) + np.arange(np.count_nonzero(which))
    result[at, 1], result[at, 2] = into[which], shoulders[which]
    result[at + 1, 0], result[at + 1, 1] = shoulders[which], out_of[which]
    heavier[at] = heavier[at + 1] = np.sqrt(0.5 * (1.0 + weights[which]))
    return result, heavier


def evened(arcs: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """The arcs, halved until each turns little and its speed is nearly even, down to rounding."""
    negligible = _ROUNDING * np.abs(arcs).max()
    while True:  # cusps never flatten, but soon are below rounding
        early, late, chords = (
            np.linalg.norm(arcs[:, j] - arcs[:, i], axis=1) for i, j in ((0, 1), (1, 2), (0, 2))
        )
        uneven = np.maximum(early, late) > _EVEN_SPEEDS * np.minimum(early, late)
        uneven |= (weights > _EVEN_SPEEDS) | (weights < 1.0 / _EVEN_SPEEDS)
        curved = _sag(arcs, weights) > _EVEN_SAG * chords
        rough = (uneven | curved) & (early + late > negligible)
        if not rough.any():
            return arcs, weights
        arcs, weights = halve(arcs, weights, rough)


def box(contours: Iterable[Contour]) -> tuple[float, float, float, float]:
    """The smallest box around the contours, to rounding: xmin, ymin, xmax, ymax."""
    reached = np.concatenate([extremes(contour.arcs, contour.weights) for contour in contours])
    low, high = reached.min(axis=0), reached.max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def mirrored(contour: Contour, about: float = 0.0) -> Contour:
    """The contour with y mirrored, ``about - y``, so that it turns the other way.

    A page is mirrored about its height if ``about`` is the sum of its upper and lower edge.
    """
    # 0 - y, not -y: a zero stays a zero without a sign in front when it is printed.
    arcs = np.stack([contour.arcs[..., 0], about - contour.arcs[..., 1]], axis=-1)
    page = contour.page
    if page is not None:
        page = page[0], about - page[3], page[2], about - page[1]
    return replace(contour, arcs=arcs, y_down=not contour.y_down, page=page)


def check_tolerance(tolerance: float, arcs: Floats) -> None:
    """Refuse a tolerance that is not positive, or below the rounding of the coordinates."""
    tolerance = positive(tolerance, "tolerance")
    smallest = smallest_tolerance(arcs)
    if tolerance < smallest:
        raise InputError(
            f"expected a tolerance of at least {smallest:.2g}, the rounding of the "
            f"coordinates, got {tolerance:.2g}: raise it, or move the shape nearer to the origin"
        )


def smallest_tolerance(arcs: Floats) -> float:
    """Below this, subdivision would go on splitting what is rounding."""
    return _ROUNDING * float(np.abs(arcs).max())


def _sag(arcs: Floats, weights: Floats) -> Floats:
    """How far each arc leaves its chord at most: (n,).

    The share of P1 in a point of the arc is at most w / (1 + w), at the shoulder.
    """
    chords = arcs[:, 2] - arcs[:, 0]
    legs = arcs[:, 1] - arcs[:, 0]
    squares = np.sum(chords * chords, axis=1)
    along = np.sum(legs * chords, axis=1) / np.where(squares > 0.0, squares, 1.0)
    apart = legs - np.clip(along, 0.0, 1.0)[:, None] * chords
    result: Floats = weights / (1.0 + weights) * np.hypot(apart[:, 0], apart[:, 1])
    return result
