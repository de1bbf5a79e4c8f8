"""Curves given by formulas, as JSON: one ``{"x", "y", "t"}``, or several in ``"loops"``.

A loop may also be ``{"sections": [...]}``, a list of curves that follow one another.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.limits import check_limit
from splinesdf.io.readers.maps import geojson_reading
from splinesdf.io.readers.reading import Part, Reading
from splinesdf.io.readers.source import Options, Source
from splinesdf.shapes.sources.compiled import compile_curve
from splinesdf.shapes.sources.formula import parse_curve
from splinesdf.shapes.sources.geojson import TYPES

_CURVE = ("x", "y", "t")
_WHOLE = ("fill", "name")
_FULL_TURN = [0.0, "2*pi"]


def json_reading(source: Source, options: Options) -> Reading:
    """Formulas, or a GeoJSON document, which has a type."""
    try:
        # As integers, long ones would not convert.
        content = json.loads(source.text(), parse_int=float)
    except (ValueError, RecursionError) as error:
        raise InputError(f"expected formulas as JSON, got something else: {error}") from error
    if isinstance(content, dict) and content.get("type") in TYPES:
        return geojson_reading(source, options)
    if isinstance(content, dict) and content.get("format") == "splinesdf":
        raise InputError("expected a shape, got a saved fit: splinesdf.load reads it")
    return formula_reading(content, source.stem, options)


def formula_reading(content: Any, stem: str, options: Options) -> Reading:
    """The curves of ``{"x": ..., "y": ..., "t": [start, stop]}`` or of a list ``"loops"`` of these.

    Each is an element.

    ``"t"`` may be missing (0 to 2π). Instead of ``"x"`` and ``"y"`` a loop may have a list
    ``"sections"`` of such curves, each of which starts where the one before it ended. ``"fill"``
    and ``"name"`` stand beside ``"x"``, ``"sections"`` or ``"loops"``. An argument ``fill``
    overrules the file's.
    """
    if not isinstance(content, dict):
        raise InputError(
            f'expected a JSON object such as {{"x": "cos(t)", "y": "sin(t)"}}, got {_kind(content)}'
        )
    fill = options.fill
    rule = fill if fill is not None else _text(content, "fill", "nonzero")
    name = _text(content, "name", stem)
    if "loops" not in content:
        loops = [_loop(content, _WHOLE)]
    else:
        _check_keys(content, ("loops", *_WHOLE))
        loops = _several(content, "loops", _loop)
    return Reading(
        name,
        [f"loop {k + 1}" for k in range(len(loops))] if "loops" in content else [name],
        [],
        [Part(k, [loop]) for k, loop in enumerate(loops)],
        rule=rule,
        close=options.close,
        once=fill is None,
    )


def _several(
    content: dict[str, Any],
    key: str,
    read: Callable[[dict[str, Any], tuple[str, ...]], list[Floats]],
) -> list[list[Floats]]:
    """Each entry of a list by ``read``; errors name the entry by its number."""
    entries = content[key]
    if not isinstance(entries, list) or not entries:
        raise InputError(f'expected "{key}" to be a list of curves, got {_kind(entries)}')
    result, count = [], 0
    for number, entry in enumerate(entries, 1):
        try:
            if not isinstance(entry, dict):
                raise InputError(f'expected an object with "x" and "y", got {_kind(entry)}')
            result.append(read(entry, ()))
            count += len(result[-1])
            _check_together(count)
        except InputError as error:
            raise InputError(f"{key.removesuffix('s')} {number}: {error}") from error
    return result


def _loop(entry: dict[str, Any], beside: tuple[str, ...]) -> list[Floats]:
    """The pieces of one loop; the keys ``beside`` may stand in its object as well."""
    if "sections" not in entry:
        return _curve(entry, beside)
    _check_keys(entry, ("sections", *beside))
    return [piece for part in _several(entry, "sections", _curve) for piece in part]


def _curve(entry: dict[str, Any], beside: tuple[str, ...]) -> list[Floats]:
    _check_keys(entry, _CURVE + beside)
    for key in "xy":
        if not isinstance(entry.get(key), str):
            got = _kind(entry[key]) if key in entry else "nothing"
            raise InputError(f'expected a formula in quotes for "{key}", got {got}')
    t = entry.get("t", _FULL_TURN)
    if not isinstance(t, list) or len(t) != 2 or any(not isinstance(end, float | str) for end in t):
        raise InputError('expected "t" to be [start, stop], each a number or a formula in quotes')
    pieces = compile_curve(parse_curve(entry["x"], entry["y"], (t[0], t[1])))
    _check_together(len(pieces))
    return pieces


def _check_together(count: int) -> None:
    check_limit("formulas", count, "pieces of all formulas together")


def _check_keys(entry: dict[str, Any], known: tuple[str, ...]) -> None:
    unknown = [key for key in entry if key not in known]
    if unknown:
        shown = ", ".join(repr(key[:30]) for key in unknown[:5])
        raise InputError(f"expected only the keys {', '.join(known)}, got {shown}")


def _text(content: dict[str, Any], key: str, default: str) -> str:
    value = content.get(key, default)
    if not isinstance(value, str):
        raise InputError(f'expected text for "{key}", got {_kind(value)}')
    return value


def _kind(value: Any) -> str:
    """The type of a JSON value, in JSON's own words."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return "a number"
    if isinstance(value, str):
        return "text"
    if not value:
        return "an empty list" if isinstance(value, list) else "an empty object"
    return "a list" if isinstance(value, list) else "an object"
