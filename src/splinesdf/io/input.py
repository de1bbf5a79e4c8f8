"""`read`: a shape from a file, by the file's extension; `read_points`: points to ask about."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, Unpack

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.limits import Limits, checked_limits, too_much, using
from splinesdf.ground.paths import as_path, shortened
from splinesdf.io.examples import EXAMPLES, example_file
from splinesdf.io.readers import READERS, USED
from splinesdf.io.readers.points import read_blocks
from splinesdf.io.readers.reading import Reading, united
from splinesdf.io.readers.separate import separated
from splinesdf.io.readers.source import (
    ReadOptions,
    Source,
    check_used,
    checked_options,
    read_options,
)
from splinesdf.shapes.shape import Shape

# Bytes of a file that are read at a time. More: memory is taken for those that are not there;
# fewer: more calls.
_BLOCK = 1 << 20


@read_options
def read(path: str | os.PathLike[str], **options: Unpack[ReadOptions]) -> Shape:
    """Read a shape; the file's extension says how.

    Parameters
    ----------
    path : str or path
        ``.svg`` or ``.svgz`` (what elements fill, in user units, y pointing down), ``.dxf`` (closed
        outlines of the model space), ``.geojson`` or ``.wkt`` (the union of polygons), ``.json``
        (formulas, or GeoJSON), ``.csv`` (corners of polygons, a blank line between two) or
        ``.dat`` (airfoils by Selig or Lednicer, and the same); ``.ttf``, ``.otf``, ``.woff``,
        ``.woff2`` or ``.ttc`` (a text in a font).

    Other Parameters
    ----------------
    fill : {"nonzero", "evenodd"}, optional
        Instead of the file's rule, of a drawing that of each element. Default: what the file says,
        else nonzero, or evenodd for lines. And unless it is given, a contour that is drawn several
        times counts once, but for a drawing's elements under nonzero: these are as they are shown.
    close : bool
        Close open lines by a straight piece instead of refusing them. Those of a drawing are
        joined first where their ends meet, within 1e-6 of its size. (A fill is always closed.)
    stroke : {"none", "outline", "centre"}, optional
        Of a drawing's strokes: "none" reads what is filled only, as a stroke fills nothing;
        "outline" also what strokes cover, with their width, caps, joins and dashes; "centre" also
        the closed lines that are stroked and not filled, as a laser or a plotter follows them.
        None unless the file says otherwise, as those of `write` do.
    ignore : {"clip-path", "mask", "dashes"} or several
        Read a drawing as if it had none of these, which otherwise cut it, or are refused. Without
        dashes, strokes are read whole.
    layers : str or several, optional
        Of a DXF file, or of a drawing's groups by their layer's label or id, these only; all that
        are not hidden unless given.
    ids : str or several, optional
        Of a drawing what has one of these ids, or is in a group that has.
    stroke_color : str, optional
        Of a drawing what is stroked in this color, as CSS writes it.
    gap : float, optional
        Of a DXF file: how far apart ends of edges may be that are joined, 1e-6 of the size of the
        drawing unless given.
    columns : pair of str or int, optional
        Of a table: the columns of x and y, by name or number from 0. Those named x and y unless
        given, or the only two.
    text : str, optional
        What is read from a font.
    size : float, optional
        The height of an em of a font; its own units unless given.
    location : mapping of str to float, optional
        Where on the axes of a variable font, as ``{"wght": 650}``.
    limits : Limits, optional
        How much the file may ask for, where that is not the usual: ``Limits(pieces=5_000_000)``.

    Returns
    -------
    Shape
        Its ``notes`` name what the file holds beside it, such as texts, images or open paths, what
        is drawn again, and how long a drawing says that one unit is, if that is neither a
        millimeter nor an inch; ``unit`` is that length in millimeters, ``page`` the viewBox of a
        drawing, or its width and height.

    Raises
    ------
    OpenContourError
        If a contour is open and ``close`` is not set. Open paths beside closed ones in a drawing
        are left out instead, and named in the notes.
    InputError
        If the file is missing, cannot be read, is not what its extension says, or asks for more
        than a limit, which the message names.

    Examples
    --------
    >>> import splinesdf as ss
    >>> from pathlib import Path
    >>> drawing = '<svg width="4mm" viewBox="0 0 8 4"><rect width="4" height="2"/></svg>'
    >>> _ = Path("bar.svg").write_text(drawing)
    >>> shape = ss.read("bar.svg")
    >>> shape, shape.unit
    (<Shape bar: 1 loop, 4 pieces, nonzero>, 0.5)
    """
    with _parts(path, options) as parts:
        return united(parts)


@read_options
def example(name: str, **options: Unpack[ReadOptions]) -> Shape:
    """Read a shape that comes with the package.

    Parameters
    ----------
    name : {"part", "gamma1", "gamma2", "gamma3"}
        A flange bracket, 114 by 72 mm; the three curves of [Wang2014].

    Other Parameters
    ----------------
    fill, close, stroke, ignore, layers, ids, stroke_color, gap, columns, text, size, location
        As of `read`.

    Raises
    ------
    InputError
        If there is no such example: the message lists them.

    Examples
    --------
    >>> import splinesdf
    >>> splinesdf.example("gamma2")
    <Shape gamma2: 1 loop, 96 pieces, nonzero>
    """
    with example_file(name) as file:
        return read(file, **options)


@read_options
def read_all(path: str | os.PathLike[str], **options: Unpack[ReadOptions]) -> list[Shape]:
    """Read the elements of a file, one shape each; together they fill what `read` reads.

    An element is

    - of a drawing (SVG) what is drawn: fill and stroke together, cut to its clips;
    - of GeoJSON a feature, or a geometry that is in none, of WKT a geometry;
    - of JSON a loop, of a table or of airfoils a polygon, of a font a glyph that is placed;
    - of DXF an outermost outline with what lies in it: joined edges have no other name.

    Outlines of one file that are filled together may be holes in each other: closed lines of a
    drawing, loops, polygons of a table. Those that overlap are one shape where they could cancel
    each other: under even-odd, and under nonzero unless they run the same way around.

    Parameters
    ----------
    path : str or path

    Other Parameters
    ----------------
    fill, close, stroke, ignore, layers, ids, stroke_color, gap, columns, text, size, location
        As of `read`.

    Returns
    -------
    list of Shape
        In the file's order. Each ``name`` is there once: an element's id, else its label, else its
        kind and number; of a glyph its characters. The ``notes`` are those of the file, then the
        elements that the shape holds beside its own, then the elements that fill nothing by
        themselves: those in no shape. So every element is a shape or is counted there.

    Raises
    ------
    OpenContourError, InputError
        As of `read`, and if no element fills anything.

    Examples
    --------
    >>> names = [shape.name for shape in splinesdf.read_all("letters.svg")]  # doctest: +SKIP
    """
    with _parts(path, options) as parts:
        return separated(parts)


@contextmanager
def _parts(path: str | os.PathLike[str], options: ReadOptions) -> Iterator[Reading]:
    """What is in a file, and the file's name in front of every error, later ones too."""
    asked = checked_options(options)
    with using(asked.limits), named(path) as file:
        suffix = file.suffix.lower()
        if suffix not in READERS:
            kept = f"; or splinesdf.example({file.name!r})" if file.name in EXAMPLES else ""
            if suffix == ".npz":
                kept = "; a saved fit is read by splinesdf.load"
            raise InputError(
                f"expected a file ending in {', '.join(sorted(READERS))}, got "
                f"{suffix or 'none'!r}{kept}"
            )
        check_used(asked, USED, suffix)
        content = content_of(file, asked.limits.bytes)
        yield READERS[suffix](Source(file, content, file.stem, suffix), asked)


def read_points(path: str | os.PathLike[str], *, limits: Limits | None = None) -> Floats:
    """Points from a CSV file: two columns, with or without a header, blank lines skipped.

    Parameters
    ----------
    path : str or path
    limits : Limits, optional
        Of these, how many bytes the file may have.

    Returns
    -------
    ndarray, shape (n, 2)
        NaN and infinity are let through.

    Raises
    ------
    InputError
        If the file cannot be read or a line is not two numbers.
    """
    most = checked_limits(limits).bytes
    with named(path) as file:
        text = Source(file, content_of(file, most), file.stem, file.suffix).text()
        return np.concatenate([points for _, points in read_blocks(text, finite=False)])


@contextmanager
def named(path: str | os.PathLike[str]) -> Iterator[Path]:
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
        # What a file holds may be quoted, with signs that no terminal should be given.
        words = "".join(letter if letter.isprintable() else "?" for letter in str(error))
        raise type(error)(f"{name if name.isprintable() else repr(name)}: {words}") from error


def content_of(file: Path, most: int) -> bytes:
    """All of a file of up to so many bytes, or an `InputError`."""
    try:
        if file.exists() and not file.is_file():
            # Reading from a pipe or a device might never end.
            raise InputError("expected a regular file, got a pipe or a device")
        length = file.stat().st_size
        with file.open("rb") as opened:
            content = _read_some(opened, most + 1) if length <= most else b""
        if length > most or len(content) > most:  # it may have grown since
            raise too_much("bytes", f"expected a file of up to {most:,} bytes, got {length:,}")
        return content
    except InputError:  # a ValueError as well
        raise
    except FileNotFoundError as error:
        raise InputError(f"the file does not exist in {str(file.parent)!r}") from error
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        raise InputError(f"expected a file's path, got one with {error}") from error


def _read_some(opened: BinaryIO, most: int) -> bytes:
    """All of an open file, or so many bytes of it; memory is taken for what there is only."""
    parts, length = [], 0
    while part := opened.read(min(_BLOCK, most - length)):
        parts.append(part)
        length += len(part)
    return b"".join(parts)
