"""Options that commands share: a shape, its tolerance, files to write."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import click

import splinesdf as ss
from splinesdf.cli.console import note, working
from splinesdf.cli.pipes import SHAPE
from splinesdf.fits.request import default_tolerance
from splinesdf.ground.arrays import positive
from splinesdf.ground.atomic import check_target
from splinesdf.ground.limits import NAMES as LIMITS
from splinesdf.io.examples import EXAMPLES
from splinesdf.io.readers.source import IGNORED, STROKES
from splinesdf.offsets.offset import offset_tolerance
from splinesdf.splines.json_form import is_fit

Command = Callable[..., None]


_READING: tuple[Callable[[Command], Command], ...] = (
    click.option(
        "--close", is_flag=True, help="Join open paths end to end, close the rest straight."
    ),
    click.option(
        "--fill",
        type=click.Choice(["nonzero", "evenodd"]),
        help="The fill rule; then what is drawn twice counts twice.",
    ),
    click.option(
        "--stroke",
        type=click.Choice(STROKES),
        help="SVG: strokes fill nothing, what they cover, or closed lines (centre).  [none]",
    ),
    click.option(
        "--ignore",
        type=click.Choice(IGNORED),
        multiple=True,
        help="SVG: read without clips, masks or dashes; again.",
    ),
    click.option("--layer", "layers", multiple=True, help="DXF, SVG: this layer only; again."),
    click.option("--id", "ids", multiple=True, help="SVG: what has this id, or is in it; again."),
    click.option("--stroke-color", help="SVG: what is stroked in this color, as red or #f00."),
    click.option("--gap", type=float, help="DXF: join ends so far apart.  [1e-6 of the size]"),
    click.option("--text", help="Fonts: what to read."),
    click.option("--size", type=float, help="Fonts: height of an em.  [default: the font's units]"),
    click.option("--axis", "location", multiple=True, help="Variable fonts: wght=650; again."),
    click.option("--columns", nargs=2, help="Tables: the columns of x and y, names or numbers."),
    click.option("--limit", "limits", multiple=True, help="A larger limit: pieces=5e6; again."),
)
_NAMES = (
    "close",
    "fill",
    "stroke",
    "ignore",
    "layers",
    "ids",
    "stroke_color",
    "gap",
    "columns",
    "text",
    "size",
    "location",
    "limits",
)
# What those are called on the command line that are not called so.
_CALLED = {"layers": "layer", "ids": "id", "location": "axis"}


def reading_options(command: Command) -> Command:
    """How a shape is read, handed to the command as one argument ``reading``."""

    def read_as(**given: Any) -> None:
        reading = {name: given.pop(name) for name in _NAMES}
        for name in ("layers", "ids"):
            reading[name] = reading[name] or None
        if reading["columns"]:
            columns = reading["columns"]
            reading["columns"] = tuple(int(one) if one.isdigit() else one for one in columns)
        reading["location"] = dict(map(axis_of, reading["location"])) or None
        reading["limits"] = _limits(reading["limits"])
        command(reading=reading, **given)

    bundled: Command = functools.wraps(command)(read_as)
    for option in _READING:
        bundled = option(bundled)
    return bundled


def _limits(texts: Iterable[str]) -> ss.Limits:
    given: dict[str, Any] = {}
    for text in texts:
        name, _, value = text.partition("=")
        if name not in LIMITS:
            raise ss.InputError(f"expected a limit of {', '.join(LIMITS)}, got {text!r:.40}")
        try:
            given[name] = float(value)
        except ValueError as error:
            raise ss.InputError(f"expected a limit such as pieces=5e6, got {text!r:.40}") from error
    return ss.Limits(**given)


def axis_of(text: str) -> tuple[str, float]:
    """An axis of a variable font and where on it, or an `InputError`."""
    tag, sign, value = text.partition("=")
    try:
        return tag, float(value if sign else "")
    except ValueError as error:
        raise ss.InputError(f"expected an axis such as wght=650, got {text!r:.40}") from error


def shape_options(command: Command) -> Command:
    """The shape and how it is read."""
    return click.argument("shape", type=SHAPE)(reading_options(command))


def tolerance_option(command: Command) -> Command:
    """The tolerance, which has a default here."""
    return click.option(
        "--tolerance",
        type=float,
        help="Largest error, in the shape's unit. Default: 1e-3 of its larger side; of an offset, "
        "1e-2 of the smallest distance at most.",
    )(command)


def read_shape(text: str, reading: Mapping[str, Any]) -> ss.Shape:
    """A shape from a file, or one that comes with the package; its notes go to stderr."""
    kept = text in EXAMPLES and not Path(text).exists()
    shape = ss.example(text, **reading) if kept else ss.read(text, **reading)
    for line in shape.notes:
        note(f"note: {line}")
    return shape


def holds_fit(path: str) -> bool:
    """Whether a file is a saved fit: by its ending, .json by what is in it."""
    suffix = Path(path).suffix.lower()
    return suffix == ".npz" or (suffix == ".json" and is_fit(Path(path)))


def load_fit(path: str, reading: Mapping[str, Any]) -> ss.SplineSDF:
    """A saved fit, of which options of reading but limits say nothing: those are refused."""
    for name, value in reading.items():
        if name == "limits" or value is None or value is False or value == ():
            continue
        option = "--" + _CALLED.get(name, name).replace("_", "-")
        raise ss.InputError(
            f"expected a shape for {option}, got a saved fit, {path!r:.200}: leave it out, or give "
            "the file that the fit was made of"
        )
    return ss.load(path, limits=reading["limits"])


def check_outputs(source: str, *outputs: str | None) -> None:
    """Refuse, before the work, files that cannot be written, are its source, or are there twice."""
    seen = set[str]()
    for output in filter(None, outputs):
        check_target(output)
        place = os.path.realpath(output)
        if place in seen:
            raise ss.InputError(f"expected different files, got {output!r} twice: name another")
        seen.add(place)
        try:
            lost = Path(output).samefile(source)
        except (OSError, ValueError):  # one of them does not exist
            lost = False
        if lost:
            raise ss.InputError(f"{output!r} is the input, it would be lost: name another file")


def tolerance_of(shape: ss.Shape, tolerance: float | None) -> float:
    """The tolerance, or the default, which is then told."""
    if tolerance is not None:
        return positive(tolerance, "tolerance")
    tolerance = default_tolerance(shape.box)
    note(f"tolerance {tolerance:.4g}: 1e-3 of the larger side, as none was given")
    return tolerance


def offset_tolerance_of(
    shape: ss.Shape, distances: Iterable[float], tolerance: float | None, *, coarse: bool
) -> float:
    """The tolerance of offsets, or the default, which is then told."""
    found = offset_tolerance(shape, distances, tolerance, coarse=coarse)
    if tolerance is None:
        note(
            f"tolerance {found:.4g}: 1e-3 of the larger side, at most 1e-2 of the smallest "
            "distance, as none was given"
        )
    return found


def offsets_of(shape: ss.Shape, distances: Iterable[float], tolerance: float) -> list[ss.Contour]:
    """The offsets at distances, one after the other."""
    contours = []
    with working("offsetting") as say:
        for distance in distances:
            say(f"offsetting {shape.name} by {distance:g}")
            contours += ss.offset(shape, distance, tolerance=tolerance, coarse=True)
    return contours
