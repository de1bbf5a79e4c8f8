"""A curve given by several formulas, each for one part of it."""

from __future__ import annotations

from collections.abc import Iterable

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.shapes.sources.compiled import compile_curve
from splinesdf.shapes.sources.formula import parse_curve

Section = tuple[str, str, tuple[float | str, float | str]]


def compile_sections(sections: Iterable[Section]) -> list[Floats]:
    """The pieces of all sections in order; errors name the section by its number."""
    loop: list[Floats] = []
    for number, section in enumerate(sections, 1):
        try:
            x, y, t = section
        except (TypeError, ValueError) as error:
            raise InputError(
                f"section {number}: expected (x, y, (start, stop)), got {str(section)[:60]!r}"
            ) from error
        try:
            loop += compile_curve(parse_curve(x, y, t))
        except InputError as error:
            raise InputError(f"section {number}: {error}") from error
    return loop
