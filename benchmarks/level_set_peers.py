"""Reinitialisation on a grid by others, for `level_sets`: fast marching, and two of a PDE.

Each takes samples, rows along y, the step of the grid, which is the same both ways, and how far the
farthest node is from the zero set, and answers distances at the nodes.

The PDE is φ_t = sgn(φ₀) (1 - |∇φ|) with Godunov's upwinding, until what leaves the zero set at
speed one has reached every node.

References
----------
Sussman, Smereka, Osher 1994 (the PDE); Peng and others 1999 (its smoothed sign); Jiang, Peng 2000
(WENO of order 5); Shu, Osher 1988 (Runge-Kutta of order 3); Russo, Smereka 2000 (the subcell fix);
Min 2010 (the fix in ENO of order 2, by quadratic crossings, and its own time step at each node).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Array = np.ndarray
Reinitialize = Callable[[Array, float, float], Array]

# Share of a step that a time step is, plain and with the fix (Min's). Larger: unstable.
_COURANT, _COURANT_FIXED = 0.5, 0.45
# Times as long as speed one needs to the farthest node: news starts late from the zero set, where
# the sign is small, or time steps are.
_LONGER = 1.5
# WENO's own: what keeps its weights finite where a function is flat. A share of squared slopes.
_FLAT = 1e-6
# A crossing nearer to a node than this share of a step counts as so far: a time step is its share.
# Smaller: a node beside the zero set takes so many times as many steps.
_NEAREST = 1e-3


def fast_marching(phi: Array, step: float, reach: float) -> Array:
    """Of order 2, its default; every node at once, so nothing depends on the reach."""
    import skfmm

    return np.asarray(skfmm.distance(phi, dx=float(step)))


def plain(phi: Array, step: float, reach: float) -> Array:
    """WENO of order 5 in space, Runge-Kutta of order 3 in time, Peng's sign smoothed over a step.

    With Sussman's first sign, φ₀ / √(φ₀² + h²), zero sets of steep functions are lost.
    """

    def rate(values: Array) -> Array:
        slopes = [_weno(values, step, axis) for axis in (0, 1)]
        squared = sum((0.5 * (left + right)) ** 2 for left, right in slopes)
        sign = values / np.sqrt(values * values + squared * step * step + 1e-99)
        return sign * (1.0 - _godunov(slopes, sign))

    values, time = phi.copy(), _COURANT * step
    for _ in range(int(np.ceil(_LONGER * reach / time))):
        values = _runge_kutta(values, rate, time)
    return values


def subcell(phi: Array, step: float, reach: float) -> Array:
    """ENO of order 2 that ends at the zero set of φ₀, Runge-Kutta of order 3, own steps a node."""
    sign = np.sign(phi)
    crossings = [_crossings(phi, axis) for axis in (0, 1)]
    nearest = np.minimum.reduce([gap for pair in crossings for gap in pair])
    time = _COURANT_FIXED * step * np.maximum(nearest, _NEAREST)

    def rate(values: Array) -> Array:
        slopes = [_eno(values, step, axis, crossings[axis]) for axis in (0, 1)]
        return time * sign * (1.0 - _godunov(slopes, sign))

    values = phi.copy()
    for _ in range(int(np.ceil(_LONGER * reach / (_COURANT_FIXED * step)))):
        values = _runge_kutta(values, rate, 1.0)
    return values


def _runge_kutta(values: Array, rate: Callable[[Array], Array], time: float) -> Array:
    first = values + time * rate(values)
    second = 0.75 * values + 0.25 * (first + time * rate(first))
    return values / 3.0 + 2.0 / 3.0 * (second + time * rate(second))


def _godunov(slopes: list[tuple[Array, Array]], sign: Array) -> Array:
    """|∇φ| from the slopes to the left and to the right, against the way that news comes from."""
    total = np.zeros_like(sign)
    for left, right in slopes:
        out = np.maximum(np.maximum(left, 0.0) ** 2, np.minimum(right, 0.0) ** 2)
        inward = np.maximum(np.minimum(left, 0.0) ** 2, np.maximum(right, 0.0) ** 2)
        total += np.where(sign > 0.0, out, inward)
    return np.sqrt(total)


def _widened(values: Array, by: int) -> Array:
    """So many more values at each end of axis 0, on lines that lead away from zero.

    On the line through the last two, news would come from beyond the border where a function falls.
    """
    more = np.arange(1, by + 1).reshape(-1, *[1] * (values.ndim - 1))
    first = values[0] + more[::-1] * np.sign(values[0]) * np.abs(values[0] - values[1])
    last = values[-1] + more * np.sign(values[-1]) * np.abs(values[-1] - values[-2])
    return np.concatenate([first, values, last])


def _weno(values: Array, step: float, axis: int) -> tuple[Array, Array]:
    """One-sided slopes of order 5 to the left and to the right."""
    slope = np.diff(_widened(np.moveaxis(values, axis, 0), 3), axis=0) / step
    count = values.shape[axis]
    v = [slope[k : k + count] for k in range(6)]
    left, right = _weno_slope(*v[:5]), _weno_slope(*v[:0:-1])
    return np.moveaxis(left, 0, axis), np.moveaxis(right, 0, axis)


def _weno_slope(a: Array, b: Array, c: Array, d: Array, e: Array) -> Array:
    """From five neighboring slopes, upwind ones first."""
    rough = (
        13.0 / 12.0 * (a - 2.0 * b + c) ** 2 + 0.25 * (a - 4.0 * b + 3.0 * c) ** 2,
        13.0 / 12.0 * (b - 2.0 * c + d) ** 2 + 0.25 * (b - d) ** 2,
        13.0 / 12.0 * (c - 2.0 * d + e) ** 2 + 0.25 * (3.0 * c - 4.0 * d + e) ** 2,
    )
    small = _FLAT * np.maximum.reduce([s * s for s in (a, b, c, d, e)]) + 1e-99
    weights = [w / (small + r) ** 2 for w, r in zip((0.1, 0.6, 0.3), rough, strict=True)]
    candidates = (
        (2.0 * a - 7.0 * b + 11.0 * c) / 6.0,
        (-b + 5.0 * c + 2.0 * d) / 6.0,
        (2.0 * c + 5.0 * d - e) / 6.0,
    )
    total = sum(w * s for w, s in zip(weights, candidates, strict=True))
    return np.asarray(total / sum(weights))


def _minmod(a: Array, b: Array) -> Array:
    return np.where(a * b > 0.0, np.where(np.abs(a) < np.abs(b), a, b), 0.0)


def _bends(values: Array) -> Array:
    """Second differences along axis 0 by minmod, between neighbors: one more than values."""
    second = np.diff(_widened(values, 2), 2, axis=0)
    return _minmod(second[:-1], second[1:])


def _crossings(phi: Array, axis: int) -> tuple[Array, Array]:
    """How far the zero set is to the left and to the right, in steps; 1 where it is not."""
    values = np.moveaxis(phi, axis, 0)
    bend, wide = _bends(values), _widened(values, 1)
    near, far = wide[:-1], wide[1:]
    # The parabola with these ends and second difference; from its linear form where it is flat.
    with np.errstate(divide="ignore", invalid="ignore"):
        linear = near / (near - far)
        root = np.sqrt(np.maximum((0.5 * bend - near - far) ** 2 - 4.0 * near * far, 0.0))
        curved = 0.5 + (near - far - np.sign(near - far) * root) / bend
    at = np.where(np.abs(bend) > 1e-10 * np.abs(near - far), curved, linear)
    crossed = near * far < 0.0
    crossed[[0, -1]] = False
    right = np.where(crossed, at, 1.0)[1:]
    left = np.where(crossed, 1.0 - at, 1.0)[:-1]
    return np.moveaxis(left, 0, axis), np.moveaxis(right, 0, axis)


def _eno(
    values: Array, step: float, axis: int, crossings: tuple[Array, Array]
) -> tuple[Array, Array]:
    """One-sided slopes of order 2; where the zero set is nearer than the neighbor, to it."""
    along = np.moveaxis(values, axis, 0)
    bend, wide = _bends(along), _widened(along, 1)
    gaps = [np.maximum(np.moveaxis(gap, axis, 0), _NEAREST) for gap in crossings]
    left_end = np.where(gaps[0] < 1.0, 0.0, wide[:-2])
    right_end = np.where(gaps[1] < 1.0, 0.0, wide[2:])
    left = (along - left_end) / gaps[0] + 0.5 * gaps[0] * bend[:-1]
    right = (right_end - along) / gaps[1] - 0.5 * gaps[1] * bend[1:]
    return np.moveaxis(left / step, 0, axis), np.moveaxis(right / step, 0, axis)


PEERS: dict[str, Reinitialize] = {
    "scikit-fmm": fast_marching,
    "PDE, WENO5": plain,
    "PDE, subcell": subcell,
}
