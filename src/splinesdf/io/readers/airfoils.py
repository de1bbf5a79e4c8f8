"""Airfoils and other outlines as ``.dat``: a name, points, and whatever else people put there.

Selig       a name, then points once around from the trailing edge
Lednicer    a name, two counts, and the upper and the lower side, both from the leading edge
several     elements apart by a blank line, or by a line of 999.0 999.0
"""

from __future__ import annotations

import math

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.points import is_number, lines_of, polygons_reading, read_blocks
from splinesdf.io.readers.reading import Reading
from splinesdf.io.readers.source import Options, Source
from splinesdf.shapes.sources.compiled import polygon

# Points that separate elements have a coordinate of at least this.
_SEPARATOR = 999.0


def airfoil_reading(source: Source, options: Options) -> Reading:
    """Closed polygons through the points; a blunt trailing edge is closed by a line."""
    text, notes = _without_prose(source.text())
    blocks = read_blocks(text, finite=True, columns=options.columns)
    if len(blocks) == 3 and (outline := _lednicer([points for _, points in blocks])) is not None:
        loops = [polygon(outline)]
    else:
        loops = []
        for line, points in blocks:
            for part in _elements(points):
                try:
                    loops.append(polygon(part))
                except InputError as error:
                    raise InputError(f"points from line {line} on: {error}") from error
    return polygons_reading(loops, source.stem, options, notes)


def _without_prose(text: str) -> tuple[str, tuple[str, ...]]:
    """The text with comments for lines before and after the points that are no numbers."""
    lines = lines_of(text)
    numeric = [k for k, line in enumerate(lines) if _is_row(line)]
    if not numeric:
        return text, ()
    first, last = numeric[0], numeric[-1]
    before = [k for k in range(first) if lines[k].strip() and not lines[k].lstrip().startswith("#")]
    after = [k for k in range(last + 1, len(lines)) if lines[k].strip()]
    domain = [k for k in before if _is_domain(lines[k])]
    kept = list(lines)
    for k in (*before, *after):
        kept[k] = "#"
    notes = []
    if domain:
        notes.append(f"left out: line {domain[0] + 1}, four numbers of a computing domain")
    prose = [k for k in after if not lines[k].lstrip().startswith("#")]
    if prose:
        notes.append(f"left out: {len(prose)} lines of text after the points")
    return "\n".join(kept), tuple(notes)


def _is_row(line: str) -> bool:
    """Whether a line may be a point: two columns, the first of which is a number."""
    fields = line.partition("#")[0].replace(",", " ").replace(";", " ").split()
    return len(fields) == 2 and is_number(fields[0])


def _is_domain(line: str) -> bool:
    fields = line.split()
    return len(fields) == 4 and all(is_number(field) for field in fields)


def _lednicer(blocks: list[Floats]) -> Floats | None:
    """The outline of two sides, if the first block is their numbers of points."""
    counts, upper, lower = blocks
    if len(counts) != 1 or not np.array_equal(np.rint(counts[0]), [len(upper), len(lower)]):
        return None
    return np.concatenate([upper[::-1], lower[1:] if np.all(lower[0] == upper[0]) else lower])


def _elements(points: Floats) -> list[Floats]:
    """The points between separators."""
    marks = np.flatnonzero(np.abs(points).max(axis=1) >= _SEPARATOR)
    if len(marks) == 0 or not all(math.isclose(*np.abs(points[k])) for k in marks):
        return [points]
    parts = np.split(points, marks)
    return [part for part in (parts[0], *(p[1:] for p in parts[1:])) if len(part)]
