"""The array types of the package, and the one check that every public function shares."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from splinesdf.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


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
