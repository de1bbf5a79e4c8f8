"""`read`: a shape from a file, by the file's extension; `read_points`: points to ask about."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.paths import as_path, shortened
from splinesdf.io.readers import READERS
from splinesdf.io.readers.points import read_blocks
from splinesdf.shapes.shape import Shape


def read(path: str | os.PathLike[str], *, fill: str | None = None, close: bool = False) -> Shape:
    """Read a shape; the file's extension says how.

    Parameters
    ----------
    path : str or path
        ``.svg`` (paths and basic shapes, in user units, y pointing down), ``.json`` (formulas),
        ``.csv`` or ``.dat`` (the corners of polygons, a blank line between two).
    fill : {"nonzero", "evenodd"}, optional
        Default: what the file says; else nonzero, or evenodd for a drawing of mere outlines. And
        unless it is given, a contour that is drawn several times counts once.
    close : bool
        Close open contours by a straight piece instead of refusing them. Those of a drawing are
        joined first where their ends meet, within 1e-6 of its size.

    Returns
    -------
    Shape
        Its ``notes`` name what the file holds beside it, such as texts, images or open paths, what
        is drawn again, and how long a drawing says that one unit is, if that is neither a
        millimeter nor an inch.

    Raises
    ------
    OpenContourError
        If a contour is open and ``close`` is not set. Open paths beside closed ones in a drawing
        are left out instead, and named in the notes.
    InputError
        If the file is missing, cannot be read, or is not what its extension says.
    """
    with _named(path) as file:
        suffix = file.suffix.lower()
        if suffix not in READERS:
            raise InputError(
                f"expected a file ending in {', '.join(sorted(READERS))}, got {suffix or 'none'!r}"
            )
        return READERS[suffix](_text(file), file.stem, fill, close)


def read_points(path: str | os.PathLike[str]) -> Floats:
    """Points from a CSV file: two columns, with or without a header, blank lines skipped.

    Returns
    -------
    ndarray, shape (n, 2)
        NaN and infinity are let through.

    Raises
    ------
    InputError
        If the file cannot be read or a line is not two numbers.
    """
    with _named(path) as file:
        return np.concatenate([points for _, points in read_blocks(_text(file), finite=False)])


@contextmanager
def _named(path: str | os.PathLike[str]) -> Iterator[Path]:
    """The path, and the file's name in front of every error."""
    file = as_path(path)
    try:
        try:
            folder = file.is_dir()
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror or error}") from error
        if folder:
            raise InputError("expected a file, got a folder")
        yield file
    except InputError as error:
        name = shortened(file.name or str(file))
        raise type(error)(f"{name if name.isprintable() else repr(name)}: {error}") from error


def _text(file: Path) -> str:
    try:
        if file.exists() and not file.is_file():
            # Reading from a pipe or a device might never end.
            raise InputError("expected a regular file, got a pipe or a device")
        content = file.read_bytes()
    except FileNotFoundError as error:
        raise InputError(f"the file does not exist in {str(file.parent)!r}") from error
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        raise InputError(f"expected a file's path, got one with {error}") from error
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"expected text in UTF-8, got something else at byte {error.start + 1}: "
            f"is it really a {file.suffix} file?"
        ) from error
    if "\0" in text:
        raise InputError(f"expected text, got binary data: is it really a {file.suffix} file?")
    if not text.strip():
        raise InputError("the file is empty")
    return text
