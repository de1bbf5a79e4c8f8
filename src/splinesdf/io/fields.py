"""A spline's field to a file, in the format that the file's extension names."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence

from splinesdf.errors import InputError
from splinesdf.ground.atomic import atomic_file
from splinesdf.ground.paths import as_path
from splinesdf.io.writers import WRITERS
from splinesdf.io.writers.shaders import glsl_bytes, wgsl_bytes
from splinesdf.io.writers.vtu import spline_bytes
from splinesdf.splines.archive import SAVED
from splinesdf.splines.spline import SplineSDF

FIELDS: Mapping[str, Callable[[SplineSDF], bytes]] = {
    ".vtu": spline_bytes,
    ".glsl": glsl_bytes,
    ".wgsl": wgsl_bytes,
}


def write_field(path: str | os.PathLike[str], spline: SplineSDF, given: Sequence[str]) -> None:
    """Write a spline, whole or not at all.

    Parameters
    ----------
    path : str or path
    spline : SplineSDF
    given : sequence of str
        Options of `splinesdf.write` that were given: none has a use here.

    Raises
    ------
    InputError
        If the extension is not of a field, an option is given, the format cannot hold the spline,
        or the file cannot be written.
    """
    suffix = check_field(path)
    if given:
        raise InputError(
            f"expected {', '.join(given)} only for contours, got a spline for {suffix}: leave that "
            "out"
        )
    data = FIELDS[suffix](spline)
    with atomic_file(path) as file:
        file.write(data)


def check_field(path: str | os.PathLike[str]) -> str:
    """The extension, in lower case, or an `InputError` if it is none of a field."""
    suffix = as_path(path).suffix.lower()
    if suffix in WRITERS:
        raise InputError(
            f"expected contours for {suffix}, got a spline: write its level sets, as "
            f"spline.contours(0.0), or the field as {_listed()}"
        )
    if suffix in SAVED:
        raise InputError(f"expected {_listed()} for a field, got {suffix}: use spline.save")
    if suffix not in FIELDS:
        raise InputError(
            f"expected a file name ending in {_listed()} for a field, got {os.fspath(path)!r}"
        )
    return suffix


def _listed() -> str:
    return ", ".join(sorted(FIELDS))
