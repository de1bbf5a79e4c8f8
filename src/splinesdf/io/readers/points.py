"""Tables of points as text: one point a line, columns apart by a comma, semicolon, tab or spaces.

A header names the columns; ``x`` and ``y`` are taken wherever they are, and a new value in a column
``contour``, as `write` has one, begins a new polygon. Where semicolons or tabs stand between
columns, a comma may stand in a number.
"""

from __future__ import annotations

import csv
import math
import re

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.reading import Part, Reading
from splinesdf.io.readers.source import Options, Source
from splinesdf.shapes.loops import check_count
from splinesdf.shapes.region import Loops
from splinesdf.shapes.sources.compiled import polygon

_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")


def points_reading(source: Source, options: Options) -> Reading:
    """Closed polygons through the points, an element each; a blank line begins the next one.

    A polygon's last point is always joined to its first, whatever ``close`` says.
    """
    loops, text = [], source.text()
    for line, points in read_blocks(text, finite=True, columns=options.columns):
        try:
            loops.append(polygon(points))
        except InputError as error:
            raise InputError(f"points from line {line} on: {error}") from error
    distances = _distances(text)
    if len(distances) > 1 and options.fill is None:
        raise InputError(
            f"expected contours of one distance, got {len(distances)} distances "
            f"({', '.join(distances)[:60]}): keep the lines of one, or give fill='evenodd' (--fill "
            "evenodd) to fill by nesting, 'nonzero' to fill all that any of them encloses"
        )
    return polygons_reading(loops, source.stem, options)


def _distances(text: str) -> list[str]:
    """The distances of a table of contours as `write` has it; none of another table."""
    rows = (_fields(line.partition("#")[0].strip()) for line in lines_of(text))
    names = [name.lower() for name in next(filter(None, rows))]
    if not {"contour", "distance"} <= set(names):
        return []
    contour, distance = names.index("contour"), names.index("distance")
    found: dict[str, str] = {}
    for row in filter(None, rows):
        if found.setdefault(row[contour], row[distance]) != row[distance]:
            return []  # one of each point, not of the contour
    return list(dict.fromkeys(found.values()))


def polygons_reading(
    loops: Loops, name: str, options: Options, notes: tuple[str, ...] = ()
) -> Reading:
    """Polygons that fill a region together."""
    return Reading(
        name,
        [f"polygon {k + 1}" for k in range(len(loops))],
        [],
        [Part(k, [loop]) for k, loop in enumerate(loops)],
        rule=options.fill,
        close=options.close,
        once=options.fill is None,
        notes=notes,
    )


def read_blocks(
    text: str, *, finite: bool, columns: tuple[str | int, str | int] | None = None
) -> list[tuple[int, Floats]]:
    """Runs of lines between blank ones: the first line's number and the points, shape (n, 2).

    ``#`` starts a comment; a line of nothing else is no blank line. The first line may be a
    header: it is one if it does not begin with a number.

    Parameters
    ----------
    text : str
    finite : bool
        Refuse NaN and infinity.
    columns : pair of str or int, optional
        Which columns are x and y, by the header's names or by number from 0.

    Raises
    ------
    InputError
        With the number of the line that is not two numbers, or if there are no points at all.
    """
    blocks: list[tuple[int, Floats]] = []
    rows: list[tuple[float, float]] = []
    first = 0
    places: tuple[int, int] | None = None
    contour: int | None = None
    named = 0  # columns that the header has
    label = ""
    begun, count = False, 0
    for number, line in enumerate(lines_of(text), 1):
        if not line.strip():
            _finish(blocks, rows, first)
            rows = []
            continue
        content = line.partition("#")[0].strip()
        if not content:
            continue
        fields = _fields(content)
        if not begun:
            begun = True
            is_header = _is_word(fields[0])
            places = _places(fields, columns, is_header, number)
            if is_header:
                names = [field.lower() for field in fields]
                contour = names.index("contour") if "contour" in names else None
                named = len(names)
                continue
        if named and len(fields) != named:
            raise InputError(
                f"line {number}: expected {named} columns{_axes(named)}, got {len(fields)}"
            )
        if contour is not None and contour < len(fields) and fields[contour] != label:
            _finish(blocks, rows, first)
            rows, label = [], fields[contour]
        if not rows:
            first = number
        rows.append(_point(fields, places, number, finite))
        count += 1
        if finite:  # of points to ask about there may be more
            check_count(count)
    _finish(blocks, rows, first)
    if not blocks:
        raise InputError("expected points, two numbers a line, got none")
    return blocks


def lines_of(text: str) -> list[str]:
    """The lines; not by splitlines(), which splits where no editor sees a new line."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _finish(blocks: list[tuple[int, Floats]], rows: list[tuple[float, float]], first: int) -> None:
    if rows:
        blocks.append((first, np.array(rows, dtype=np.float64)))


def _fields(content: str) -> list[str]:
    for separator in ";\t,":
        if separator in content:
            if '"' in content:
                fields = next(csv.reader([content], delimiter=separator, skipinitialspace=True))
            else:
                fields = content.split(separator)
            if separator != ",":
                fields = [_with_point(field) for field in fields]
            return [field.strip() for field in fields]
    return content.split()


def _axes(count: int) -> str:
    return ", x and y" if count == 2 else ""


def _with_point(field: str) -> str:
    return field.replace(",", ".") if _DECIMAL_COMMA.fullmatch(field.strip()) else field


def _places(
    fields: list[str], columns: tuple[str | int, str | int] | None, is_header: bool, line: int
) -> tuple[int, int] | None:
    """The columns of x and y; None if there must be two."""
    names = [field.lower() for field in fields] if is_header else []
    if columns is not None:
        found = []
        for column in columns:
            if isinstance(column, str):
                if column.lower() not in names:
                    raise InputError(
                        f"line {line}: expected a column {column!r:.40}, got "
                        f"{', '.join(fields)[:80] if names else 'no header'}"
                    )
                column = names.index(column.lower())
            found.append(column)
        return found[0], found[1]
    if "x" in names and "y" in names:
        return names.index("x"), names.index("y")
    return None


def _is_word(field: str) -> bool:
    """Whether it is no number and not even a misspelled one, such as 1,5."""
    return not is_number(field) and field.strip()[:1] not in "+-.0123456789"


def is_number(field: str) -> bool:
    """Whether a text is a number."""
    try:
        _number(field)
    except ValueError:
        return False
    return True


def _number(field: str) -> float:
    """A number as files have it: not 4_0, which is 40 in Python only."""
    if "_" in field:
        raise ValueError("not a number")
    return float(field)


def _point(
    fields: list[str], places: tuple[int, int] | None, line: int, finite: bool
) -> tuple[float, float]:
    if places is None:
        if len(fields) != 2:
            raise InputError(
                f"line {line}: expected 2 columns, x and y, got {len(fields)}: name those that "
                "are meant, columns=('x', 'y')"
            )
        places = 0, 1
    if max(places) >= len(fields):
        raise InputError(f"line {line}: expected {max(places) + 1} columns, got {len(fields)}")
    chosen = [fields[k] for k in places]
    try:
        x, y = _number(chosen[0]), _number(chosen[1])
    except ValueError:
        shown = chosen[1 if is_number(chosen[0]) else 0]
        raise InputError(f"line {line}: expected a number, got {_short(shown)}") from None
    if finite and not (math.isfinite(x) and math.isfinite(y)):
        raise InputError(f"line {line}: expected finite numbers, got NaN or infinity")
    return x, y


def _short(text: str) -> str:
    return repr(text if len(text) <= 30 else text[:27] + "...")
