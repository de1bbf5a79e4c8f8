"""A saved fit as JSON: the fields of `splinesdf.splines.archive` in one object.

Texts and numbers are themselves, arrays are lists (of lists), flags 0 and 1, and ``about`` is an
object. Every float is written in as many digits as bring it back to the bit. A number may come
without a point (JavaScript writes 1.0 so), and fields in any order.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from splinesdf.errors import InputError
from splinesdf.ground.arrays import as_floats, shown
from splinesdf.ground.npz import Fields
from splinesdf.ground.paths import as_path, shortened
from splinesdf.ground.saved_file import saved_file

# Bytes of a file: a fit of a million cells has 180 MB. More: lists take up to twenty times as much
# memory as the text; fewer: fits are refused that .npz holds without effort.
_LARGEST = 2**28
_FLOATS = ("domain", "x", "y", "ordinates", "control")
_COUNTS = ("shape", "starts", "loops")
_MARK = re.compile(rb'"format"\s*:\s*"splinesdf"')


def to_plain(fields: Fields) -> dict[str, Any]:
    """The fields as texts, numbers, lists and one object."""
    plain = {key: values.tolist() for key, values in fields.items() if key != "about"}
    if "split" in plain:
        plain["split"] = fields["split"].astype(np.int64).tolist()
    about = json.loads(fields["about"].tobytes())
    # In the order of the fields, which is that of the description.
    return {key: about if key == "about" else plain[key] for key in fields}


def from_plain(content: object) -> Fields:
    """The fields as arrays; what they are worth, `archive` checks."""
    if not isinstance(content, dict) or content.get("format") != "splinesdf":
        raise InputError(
            'expected a fit saved by splinesdf, an object with "format": "splinesdf", got another '
            f"{type(content).__name__}"
        )
    return {key: _array(key, value) for key, value in content.items()}


def write_json(file: BinaryIO, fields: Fields) -> None:
    """Write the fields, one a line."""
    lines = [f'"{key}": {json.dumps(value)}' for key, value in to_plain(fields).items()]
    text = "{\n" + ",\n".join(lines) + "\n}\n"  # ASCII only
    if len(text) > _LARGEST:
        raise InputError(
            f"expected a fit of up to {_LARGEST:,} bytes of JSON, got {len(text):,}: save it as "
            ".npz"
        )
    file.write(text.encode())


def read_json(path: Path) -> Fields:
    """Read all fields of a file.

    Raises
    ------
    InputError
        If the file is missing, cannot be read, is damaged, or is no such file.
    """
    name = shortened(str(as_path(path)))
    with saved_file(path) as file:
        data = file.read(_LARGEST + 1)
        if len(data) > _LARGEST:
            raise InputError(
                f"expected a saved fit of up to {_LARGEST:,} bytes, got more: {name!r}"
            )
        try:
            content = json.loads(data, parse_constant=_no_number, object_pairs_hook=_once)
        except (ValueError, RecursionError) as error:
            raise InputError(
                f"expected a fit saved by splinesdf (.json), but {name!r} is another file or "
                f"damaged ({shown(str(error)) if str(error) else 'nested too deep'}): save it again"
            ) from error
        try:
            return from_plain(content)
        except InputError as error:
            raise InputError(f"{name!r} is not a usable saved fit: {error}") from error


def is_fit(path: Path) -> bool:
    """Whether a file that may be JSON of another kind is a saved fit, by its format's name."""
    try:
        if not path.is_file() or path.stat().st_size > _LARGEST:
            return False
        return _MARK.search(path.read_bytes()) is not None
    except (OSError, ValueError):  # whoever opens it says what is wrong
        return False


def _array(key: object, value: Any) -> NDArray[Any]:
    if key in _FLOATS:
        return as_floats(value, repr(key))
    if key in _COUNTS or key == "split":
        return _counts(str(key), value)
    if key == "about":
        try:
            text = json.dumps(value, allow_nan=False)
        except (TypeError, ValueError, RecursionError) as error:
            raise InputError(
                f"expected what JSON can hold in 'about', got {shown(value)}"
            ) from error
        return np.frombuffer(text.encode(), dtype=np.uint8)
    if key == "version":
        return _counts("version", [value]).reshape(())
    if key == "format":
        return np.array(value)
    raise InputError(f"expected the fields of a saved fit, got {shown(key)} among them")


def _counts(key: str, values: Any) -> NDArray[Any]:
    """Whole numbers in a row; of the field ``split`` flags, which are 0 and 1 or booleans."""
    kinds = {int, bool} if key == "split" else {int}
    if not isinstance(values, list) or not set(map(type, values)) <= kinds:
        raise InputError(f"expected whole numbers for {key!r}, got {shown(values)}")
    try:
        array = np.array(values, dtype=np.int64)
    except OverflowError as error:
        raise InputError(f"expected numbers below 2**63 in {key!r}, got a larger one") from error
    if key != "split":
        return array
    if array.min(initial=0) < 0 or array.max(initial=0) > 1:
        raise InputError("expected flags 0 and 1 in 'split', got others")
    return array.astype(np.bool_)


def _no_number(text: str) -> None:
    raise ValueError(f"expected finite numbers, got {text}")


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object, no name of which may stand in it twice."""
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("expected every name once in an object, got one again")
    return found
