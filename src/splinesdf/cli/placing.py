"""The options that place what is written: unit, scale, origin, and which way y points."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import reduce
from typing import Any

import click

import splinesdf as ss
from splinesdf.io.placing import CORNERS
from splinesdf.io.writers.options import UNITS, Y_UP, factor

Command = Callable[..., Any]

_OPTIONS = (
    click.option(
        "--units", type=click.Choice(UNITS), help="DXF, G-code: what the numbers are. [G-code: mm]"
    ),
    click.option("--scale", type=float, default=1.0, help="Enlarge the numbers of the files."),
    click.option("--origin", help="What becomes 0,0: lower-left, center, or a point X,Y of SHAPE."),
    click.option(
        "--flip/--no-flip", default=None, help="Mirror y, or not.  [as the file's axis asks]"
    ),
)


def placing_options(command: Command) -> Command:
    """All options that place what is written."""
    return reduce(lambda made, option: option(made), reversed(_OPTIONS), command)


def placing_of(flags: Mapping[str, Any]) -> dict[str, Any]:
    """The options as `write` takes them."""
    return {
        "units": flags["units"],
        "scale": flags["scale"],
        "origin": _origin(flags["origin"]),
        "flip": flags["flip"],
    }


def _origin(text: str | None) -> str | tuple[float, ...] | None:
    """The origin as `write` takes it."""
    if text is None or text in CORNERS:
        return text
    try:
        return tuple(map(float, text.split(",")))
    except ValueError as error:
        raise ss.InputError(
            f"expected --origin as {', '.join(CORNERS)} or X,Y, got {text!r:.60}"
        ) from error


def about_units(source: ss.Shape, suffix: str, units: str | None) -> str | None:
    """Say by how much the numbers of the file are larger, or that their unit is not known."""
    if suffix not in Y_UP:
        return None
    if source.unit is not None:
        by = factor(suffix, source.unit, units)
        return None if by == 1.0 else f"converted to {units or 'mm'}: {by:.9g} a unit"
    if units is None and suffix == ".dxf":
        return None
    return (
        f"{source.name} does not say its unit: its numbers are written as they are, in "
        f"{units or 'mm'}"
    )
