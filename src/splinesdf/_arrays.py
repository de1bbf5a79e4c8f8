"""The array types of the package, and the checks that many public functions share."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from splinesdf.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

# Coordinates up to this, and sizes down to its inverse: beyond, the products of four lengths that
# the distance needs overflow or vanish, without a word.
LARGEST = 1e60


def as_points(points: ArrayLike) -> Floats:
    """Points as a contiguous float64 array of shape (..., 2), or an `InputError`.

    NaN and infinity pass: they are answered by NaN, point by point.
    """
    try:
        array = np.ascontiguousarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"expected points as numbers of shape (..., 2): {error}") from error
    if array.ndim == 0 or array.shape[-1] != 2:
        raise InputError(f"expected points of shape (..., 2), got shape {array.shape}")
    return array


def finite(value: float, name: str) -> float:
    """The value as a finite number, or an `InputError` that names it."""
    number = _as_number(value, name)
    if not np.isfinite(number):
        raise InputError(f"expected a finite {name}, got {number:g}")
    return number


def positive(value: float, name: str) -> float:
    """The value as a finite number above zero, or an `InputError` that names it."""
    number = _as_number(value, name)
    if not (np.isfinite(number) and number > 0.0):
        raise InputError(f"expected a positive {name}, got {number:g}")
    return number


def _as_number(value: float, name: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise InputError(f"expected a number for {name}, got {value!r}") from error


def largest_coordinate(points: Floats) -> float:
    """The largest absolute value of finite coordinates, or an `InputError` beyond `LARGEST`."""
    largest = float(np.max(np.abs(points), initial=0.0))
    if largest > LARGEST:
        raise InputError(
            f"expected coordinates up to {LARGEST:g}, got {largest:.3g}: use another unit"
        )
    return largest
