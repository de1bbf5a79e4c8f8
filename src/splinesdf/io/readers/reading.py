"""What a reader finds in a file, part by part, and the one shape that all of it is.

file ──reader──> `Reading` ─┬─ `united` ──────────────> one shape: `read`
                            └─ `separate.separated` ──> one shape an element: `read_all`
"""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Page
from splinesdf.shapes.region import Loops, united_regions
from splinesdf.shapes.shape import Shape


class Part(NamedTuple):
    """Loops of one element of a file."""

    element: int  # which of `Reading.elements`
    loops: Loops
    rule: str | None = None  # what they fill; None if inside is on their left already


class Reading(NamedTuple):
    """A file's content before it is united.

    Attributes
    ----------
    name : str
        Of the whole.
    elements : list of str
        What messages call each element, in the file's order; those that have no part included.
    regions : list of Part
        Each a region of its own; the shape is the union of these and of what the outlines fill.
    outlines : list of Part
        Their loops fill a region together, so that one may be a hole in another.
    rule : str or None
        The fill rule of the outlines; nonzero unless given.
    close : bool
        Close open outlines instead of refusing them.
    once : bool
        Count an outline that is drawn several times once.
    notes, y_down, unit, page
        As in `Shape`.
    nothing : str
        The error's words if there is no loop.
    """

    name: str
    elements: list[str]
    regions: list[Part]
    outlines: list[Part]
    rule: str | None = None
    close: bool = False
    once: bool = False
    notes: tuple[str, ...] = ()
    y_down: bool = False
    unit: float | None = None
    page: Page | None = None
    nothing: str = "expected at least one closed curve, got none"

    def shape(self, loops: Loops, rule: str | None, *, close: bool, once: bool) -> Shape:
        """Loops of the file as a shape."""
        return Shape.from_pieces(
            loops,
            fill=rule,
            close=close,
            once=once,
            y_down=self.y_down,
            name=self.name,
            notes=self.notes,
            unit=self.unit,
            page=self.page,
        )


def united(reading: Reading) -> Shape:
    """The union of all that was read."""
    parts = [(part.loops, part.rule) for part in reading.regions]
    if reading.outlines:
        every = [loop for part in reading.outlines for loop in part.loops]
        parts.append((every, reading.rule or "nonzero"))
    loops, rule = united_regions(parts)
    if not loops:
        raise InputError(reading.nothing)
    close = reading.close or bool(reading.regions)
    return reading.shape(loops, rule, close=close, once=reading.once and not reading.regions)
