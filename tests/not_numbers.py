"""Values that are no number, no whole number, no array of numbers; and odd ones that are."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np

HUGE = 10**400
NOT_NUMBERS: list[Any] = [
    *(True, np.True_, "1", b"1", "x", 1j, 1 + 0j, np.complex128(1.0), None),
    *(np.datetime64("2020-01-01"), np.timedelta64(1, "s"), np.str_("1")),
    *([1.0], (1.0,), {}, object(), np.array([1.0]), np.ma.masked, np.ma.array(1.0)),
    *(np.array(True), np.array("1"), np.array(1j), np.array(None), [], np.array([])),
    *(float("nan"), np.float64("nan"), float("inf"), -float("inf"), np.array(np.nan)),
    *(HUGE, -HUGE, Fraction(HUGE), 10**5000),
]
# None of which may be anything but refused or answered; which, the function's own tests say.
NUMBERS: list[Any] = [
    0,
    0.0,
    -0.0,
    -1,
    0.5,
    1e-300,
    1e300,
    np.float32(0.5),
    np.int8(1),
    np.array(1),
]
NOT_WHOLE: list[Any] = [0.5, 1.5, np.float64(2.5), np.float32(0.5), Fraction(1, 2)]


def not_arrays(values: np.ndarray) -> Iterator[Any]:
    """What is no array of numbers, made of one that is."""
    yield from (np.ma.array(values), np.ma.masked_less(values, values.max()))
    yield [np.ma.array(row) for row in values] if values.ndim > 1 else [np.ma.masked, 1.0]
    for dtype in (complex, "datetime64[s]", "timedelta64[s]", str, bytes, bool):
        yield values.astype("i8").astype(dtype) if "64" in str(dtype) else values.astype(dtype)
        yield values.astype("i8").astype(dtype).tolist() if "64" in str(dtype) else None
    for other in (None, True, "1", b"1", 1j, object(), [1.0], HUGE, -HUGE, np.datetime64("2020")):
        mixed = values.astype(object)
        mixed.flat[0] = other
        yield mixed
    if values.ndim > 1:
        rows = values.tolist()
        yield [[HUGE, *rows[0][1:]], *rows[1:]]
        yield [rows[0][:-1], *rows[1:]]  # ragged
    yield np.zeros(values.shape, dtype=[("x", "f8"), ("y", "f8")])
    yield from (None, "x", "1", {}, {1.0, 2.0}, object(), 1.0, np.float64(1.0), np.array(1.0), True)
