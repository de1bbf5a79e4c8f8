"""`AxisEdge`: an edge of a medial axis as conic arcs in (x, y, r), with the feet of its disks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, as_floats, positive
from splinesdf.ground.brief import brief, counted
from splinesdf.ground.values import by_value
from splinesdf.medial.conics import conic_points, conic_velocities

# Points of an arc between which it is measured: lengths are good to about 1e-9 of them, as arcs
# turn little.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
# Parts of one arc of a polyline, at most: a tolerance near rounding would ask for millions.
_PARTS = 4096


@by_value
@dataclass(frozen=True, eq=False)
class AxisEdge:
    """One edge of a medial axis: from one vertex to another, or a closed curve without any.

    Attributes
    ----------
    start, end : int
        Numbers of the vertices that it joins, -1 for none.
    arcs : ndarray, shape (n, 3, 3)
        Control points (x, y, r) of its conic arcs, each of which starts where the one before
        ended. Center and radius of a disk are the two parts of one curve: at each parameter they
        belong together.
    weights : ndarray, shape (n,)
        Of the middle control points; those at the ends have the weight 1.
    feet : ndarray, shape (n + 1, 2, 2)
        Where the disks at the ends of arcs touch the boundary, on the right and on the left.
    exact : ndarray of bool, shape (n,)
        Whether an arc is the axis to rounding, as between lines, circles and corners, or is fitted
        to it within the tolerance.

    Examples
    --------
    >>> import splinesdf as ss
    >>> axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 4, 2))
    >>> edge = max(axis.edges, key=lambda edge: edge.length)
    >>> edge.length, edge.smallest, edge.largest
    (2.0, 1.0, 1.0)
    >>> sorted(edge.points(0.1)[:, 0].tolist())
    [1.0, 3.0]
    >>> edge.reversed().start == edge.end
    True
    """

    start: int
    end: int
    arcs: Floats
    weights: Floats
    feet: Floats
    exact: Bools

    def __repr__(self) -> str:
        joined = f"{self.start} to {self.end}" if self.start >= 0 else "closed"
        return brief(
            "AxisEdge", joined, counted(len(self.arcs), "arc"), f"length {self.length:.6g}"
        )

    def at(self, parameters: Floats) -> Floats:
        """Disks (x, y, r) at parameters: 1.5 is the middle of the second arc.

        Parameters
        ----------
        parameters : array_like, shape (...,)
            From 0 to the number of arcs.

        Returns
        -------
        ndarray, shape (..., 3)

        Examples
        --------
        >>> import splinesdf as ss
        >>> axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 4, 2))
        >>> axis.edges[0].at([0.0, 1.0]).shape
        (2, 3)
        """
        places = as_floats(parameters, "parameters")
        count = len(self.arcs)
        if not ((places >= 0.0) & (places <= count)).all():
            raise InputError(f"expected parameters from 0 to {count}, the number of arcs")
        flat = places.reshape(-1)
        arc = np.minimum(flat.astype(np.int64), count - 1)
        points = conic_points(self.arcs[arc], self.weights[arc], flat - arc)
        return points.reshape(*places.shape, 3)

    def points(self, tolerance: float) -> Floats:
        """A polyline (m, 3) of x, y, r whose chords are within the tolerance of the arcs.

        Parameters
        ----------
        tolerance : float
        """
        tolerance = positive(tolerance, "tolerance")
        middle = 0.5 * (self.arcs[:, 0] + self.arcs[:, 2])
        sag = np.sqrt(np.sum((self.arcs[:, 1] - middle) ** 2, axis=1))
        sag = sag * np.maximum(self.weights, 1.0)
        parts = np.clip(np.ceil(np.sqrt(sag / tolerance)), 1, _PARTS).astype(np.int64)
        places = [k + np.arange(n) / n for k, n in enumerate(parts.tolist())]
        return self.at(np.append(np.concatenate(places), len(self.arcs)))

    @property
    def length(self) -> float:
        """The length in the plane."""
        arcs, weights = self.arcs[..., :2], self.weights
        speeds = [
            np.sqrt(np.sum(conic_velocities(arcs, weights, 0.5 + 0.5 * node) ** 2, axis=1))
            for node in _NODES.tolist()
        ]
        return 0.5 * float(np.sum(_WEIGHTS[:, None] * np.stack(speeds)))

    @property
    def smallest(self) -> float:
        """The smallest radius of its disks."""
        return float(_extremes(self.arcs[..., 2], self.weights).min())

    @property
    def largest(self) -> float:
        """The largest radius of its disks."""
        return float(_extremes(self.arcs[..., 2], self.weights).max())

    def reversed(self) -> AxisEdge:
        """The same edge the other way."""
        return AxisEdge(
            self.end,
            self.start,
            self.arcs[::-1, ::-1].copy(),
            self.weights[::-1].copy(),
            self.feet[::-1, ::-1].copy(),
            self.exact[::-1].copy(),
        )


def _extremes(values: Floats, weights: Floats) -> Floats:
    """Values (n, 3) of rational quadratics where they are largest and smallest, and at the ends."""
    a, b, c = values.T
    # The derivative's numerator: w (b - a) (1 - t)^2 + (c - a) t (1 - t) + w (c - b) t^2.
    p, q, s = weights * (b - a), c - a, weights * (c - b)
    found = [a, c]
    for sign in (-1.0, 1.0):
        # In u = t / (1 - t): s u^2 + q u + p = 0.
        with np.errstate(divide="ignore", invalid="ignore"):
            u = (-q + sign * np.sqrt(q * q - 4.0 * s * p)) / (2.0 * s)
            u = np.where(s == 0.0, -p / q, u)
            t = u / (1.0 + u)
        good = np.isfinite(t) & (t > 0.0) & (t < 1.0)
        at = np.where(good, t, 0.0)
        found.append(conic_points(values[..., None], weights, at)[:, 0])
    return np.concatenate(found)


def joined(one: AxisEdge, other: AxisEdge) -> AxisEdge:
    """Two edges as one, the second from where the first ends."""
    return AxisEdge(
        one.start,
        other.end,
        np.concatenate([one.arcs, other.arcs]),
        np.concatenate([one.weights, other.weights]),
        np.concatenate([one.feet, other.feet[1:]]),
        np.concatenate([one.exact, other.exact]),
    )
