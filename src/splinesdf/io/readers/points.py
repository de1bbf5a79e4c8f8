"""Points as text: one ``x y`` a line, apart by a comma, a semicolon, a tab or spaces."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.source import Options, Source
from splinesdf.shapes.shape import Shape
from splinesdf.shapes.sources.compiled import polygon


def points_shape(source: Source, options: Options) -> Shape:
    """Closed polygons through the points; a blank line begins the next one.

    A polygon's last point is always joined to its first, whatever ``close`` says.
    """
    loops = []
    for line, points in read_blocks(source.text(), finite=True):
        try:
            loops.append(polygon(points))
        except InputError as error:
            raise InputError(f"points from line {line} on: {error}") from error
    return Shape.from_pieces(loops, fill=options.fill, close=options.close, name=source.stem)


def read_blocks(text: str, *, finite: bool) -> list[tuple[int, Floats]]:
    """Runs of lines between blank ones: the first line's number and the points, shape (n, 2).

    ``#`` starts a comment; a line of nothing else is no blank line. The first line may be a
    header: it is one if it does not begin with a number.

    Parameters
    ----------
    finite : bool
        Refuse NaN and infinity.

    Raises
    ------
    InputError
        With the number of the line that is not two numbers, or if there are no points at all.
    """
    blocks: list[tuple[int, Floats]] = []
    rows: list[tuple[float, float]] = []
    first = number = 0
    header_allowed = True
    # Not splitlines(): it also splits at separators that no editor counts as a line.
    for line in text.replace("\r\n", "\n").replace("\r", "\n").split("\n"):
        number += 1
        if not line.strip():
            _finish(blocks, rows, first)
            rows = []
            continue
        content = line.partition("#")[0].strip()
        if not content:
            continue
        fields = _fields(content)
        is_header = header_allowed and _is_word(fields[0])
        header_allowed = False
        if is_header:
            continue
        if not rows:
            first = number
        rows.append(_point(fields, number, finite))
    _finish(blocks, rows, first)
    if not blocks:
        raise InputError("expected points, two numbers a line, got none")
    return blocks


def _finish(blocks: list[tuple[int, Floats]], rows: list[tuple[float, float]], first: int) -> None:
    if rows:
        blocks.append((first, np.array(rows, dtype=np.float64)))


def _fields(content: str) -> list[str]:
    for separator in ";,":
        if separator in content:
            return content.split(separator)
    return content.split()


def _is_word(field: str) -> bool:
    """Whether it is no number and not even a misspelled one, such as 1,5."""
    return not _is_number(field) and field.strip()[:1] not in "+-.0123456789"


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def _point(fields: list[str], line: int, finite: bool) -> tuple[float, float]:
    if len(fields) != 2:
        raise InputError(f"line {line}: expected 2 columns, x and y, got {len(fields)}")
    try:
        x, y = float(fields[0]), float(fields[1])
    except ValueError:
        shown = fields[1 if _is_number(fields[0]) else 0].strip()
        raise InputError(f"line {line}: expected a number, got {_short(shown)}") from None
    if finite and not (math.isfinite(x) and math.isfinite(y)):
        raise InputError(f"line {line}: expected finite numbers, got NaN or infinity")
    return x, y


def _short(text: str) -> str:
    return repr(text if len(text) <= 30 else text[:27] + "...")
