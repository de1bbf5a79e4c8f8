"""The array types of the package, and the checks that many public functions share."""

from __future__ import annotations

import operator
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from splinesdf.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Page = tuple[float, float, float, float]  # xmin, ymin, xmax, ymax

# Coordinates up to this, and sizes down to its inverse: beyond, the products of four lengths that
# the distance needs overflow or vanish, without a word.
LARGEST = 1e60
# What arrays hold that float64 would take for numbers, or refuse in NumPy's words.
_KINDS = {"b": "booleans", "c": "complex numbers", "M": "dates", "m": "time spans"} | dict.fromkeys(
    "SUT", "texts"
)
# Levels of lists in lists. More: none, as arrays have no more axes; fewer: a mask is missed.
_DEEPEST = 64
# What is shorter than this share of the size counts as a point. Shorter: squares of its length, and
# quotients by it, leave the range of floats; longer: it comes near to rounding, which is 1e-16.
NOTHING = 1e-20


def as_floats(values: ArrayLike, what: str) -> Floats:
    """Numbers as a contiguous float64 array of the shape they came in.

    NaN and infinity pass.

    Raises
    ------
    InputError
        That names ``what``: for texts, booleans, complex numbers, dates, masked arrays, ragged
        lists and anything else that NumPy would not, or not without loss, take for real numbers.
    """
    if type(values) is not np.ndarray and (lost := _lost(values)):
        raise InputError(f"expected {what} as numbers, got {lost}")
    try:
        array = np.asarray(values)
    except (TypeError, ValueError, OverflowError) as error:
        reason = _one_line(error)
        raise InputError(f"expected {what} as numbers, got {shown(values)}: {reason}") from error
    if array.dtype.kind == "O":
        numbers = [as_number(value, what) for value in array.flat]
        return np.array(numbers, dtype=np.float64).reshape(array.shape)
    if array.dtype.kind not in "fiu":
        got = _KINDS.get(array.dtype.kind, f"an array of {array.dtype}")
        got = shown(values) if array.ndim == 0 else got
        raise InputError(f"expected {what} as numbers, got {_one_line(got)}")
    if array.dtype.itemsize <= 8:
        return np.asarray(array, dtype=np.float64, order="C")
    with np.errstate(over="ignore"):  # a long double beyond the range is infinite
        return np.asarray(array, dtype=np.float64, order="C")


def as_points(points: ArrayLike, y: ArrayLike | None = None) -> Floats:
    """Points as a contiguous float64 array of shape (..., 2), or an `InputError`.

    With ``y`` the first are their x, and both are broadcast.

    NaN and infinity pass: they are answered by NaN, point by point. Read-only arrays are copied:
    kernels would be compiled once more for them.
    """
    if y is not None:
        x, y = as_floats(points, "x"), as_floats(y, "y")
        try:
            return np.stack(np.broadcast_arrays(x, y), axis=-1)
        except ValueError:
            raise InputError(
                f"expected x and y of shapes that broadcast, got {x.shape} and {y.shape}"
            ) from None
    array = as_floats(points, "points")
    if not array.flags.writeable:
        array = array.copy()
    if array.ndim == 0 or array.shape[-1] != 2:
        raise InputError(f"expected points of shape (..., 2), got shape {array.shape}")
    return array


def as_number(value: Any, name: str) -> float:
    """One real number as a float, perhaps NaN or infinite, or an `InputError` that names it."""
    if isinstance(value, np.ndarray) and value.ndim == 0 and not _lost(value):
        value = value[()]
    # A bool is a number to Python, and a text of digits one to float(), as a time span of NumPy's
    # is; an array of one number is one only with a warning.
    plain = isinstance(value, np.floating | np.integer) or not isinstance(
        value, bool | np.generic | np.ndarray | str | bytes | bytearray
    )
    try:
        if plain and hasattr(type(value), "__float__"):
            return float(value)
    except OverflowError as error:
        raise InputError(f"expected {name} up to 1.8e308, got a number beyond it") from error
    except (TypeError, ValueError):
        pass
    raise InputError(f"expected a number for {name}, got {shown(value)}")


def finite(value: float, name: str) -> float:
    """The value as a finite number, or an `InputError` that names it."""
    number = as_number(value, name)
    if not np.isfinite(number):
        raise InputError(f"expected a finite {name}, got {number:g}")
    return number


def positive(value: float, name: str) -> float:
    """The value as a finite number above zero, or an `InputError` that names it."""
    number = as_number(value, name)
    if not (np.isfinite(number) and number > 0.0):
        raise InputError(f"expected a positive {name}, got {number:g}")
    return number


def as_page(value: Any) -> Page | None:
    """A page as xmin, ymin, xmax, ymax, or None if none is given; else an `InputError`."""
    if value is None:
        return None
    sides = as_floats(value, "page")
    if sides.shape != (4,):
        raise InputError(f"expected a page of xmin, ymin, xmax, ymax, got {shown(value)}")
    xmin, ymin, xmax, ymax = (finite(side, "page") for side in sides.tolist())
    if not (xmin < xmax and ymin < ymax):
        raise InputError(f"expected a page with an extent, xmin < xmax, got {shown(value)}")
    return xmin, ymin, xmax, ymax


def whole(value: Any, name: str, *, least: int, most: int | None = None) -> int:
    """The value as a whole number within bounds, or an `InputError` that names it.

    A float passes if it is whole: 1e6 is how people write a million.
    """
    number = None
    if isinstance(value, float | np.floating) and float(value).is_integer():
        number = int(value)
    elif not isinstance(value, bool | np.bool_):
        try:
            number = operator.index(value)
        except TypeError:
            number = None
    if number is None:
        raise InputError(f"expected a whole number for {name}, got {shown(value)}")
    if number < least or (most is not None and number > most):
        limits = f"from {least} on" if most is None else f"from {least} to {most:,}"
        raise InputError(f"expected {name} {limits}, got {shown(number)}")
    return number


def largest_coordinate(points: Floats) -> float:
    """The largest absolute value of finite coordinates, or an `InputError` beyond `LARGEST`."""
    largest = float(np.max(np.abs(points), initial=0.0))
    if largest > LARGEST:
        raise InputError(
            f"expected coordinates up to {LARGEST:g}, got {largest:.3g}: use another unit"
        )
    return largest


def shown(value: object) -> str:
    """A value for a message: one line, not all of a long one."""
    try:
        text = ascii(value)
    except Exception:  # whatever a stranger's repr raises; an integer of thousands of digits
        return f"a value of type {type(value).__name__}"
    return _one_line(text)


def _one_line(text: object) -> str:
    line = " ".join(str(text).split())
    return line if len(line) <= 60 else f"{line[:57]}..."


def _lost(values: object) -> str:
    """The masked arrays or booleans that NumPy would lose, in lists too; nothing if none is there.

    It drops masks, and of a list that holds a number and True it makes two numbers. Lists are
    looked through level by level and by the types in each, as they may hold millions.
    """
    level: list[object] = [values]
    for _ in range(_DEEPEST):
        kinds = set(map(type, level))
        if any(issubclass(kind, np.ma.MaskedArray) for kind in kinds):
            return "a masked array: fill or drop what it masks"
        arrays = (value for value in level if isinstance(value, np.ndarray))
        if kinds & {bool, np.bool_} or (
            np.ndarray in kinds and any(array.dtype == np.bool_ for array in arrays)
        ):
            return "booleans"
        if not kinds & {list, tuple}:
            break
        lists = [value for value in level if isinstance(value, list | tuple)]
        level = list(chain.from_iterable(lists))
    return ""
