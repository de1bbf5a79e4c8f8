"""Objects in one line, for notebooks, and without their caches, for pickle and copy."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, TypeVar

Class = TypeVar("Class", bound=type)

# Letters of a name in a line. More: one name fills it; fewer: two files of a series look the same.
_LETTERS = 40


def brief(kind: str, name: str, *figures: str) -> str:
    """One line about an object: its kind, its name, if it has one, and its figures.

    Examples
    --------
    >>> brief("Shape", "part", "5 loops", "", "48 pieces")
    '<Shape part: 5 loops, 48 pieces>'
    """
    # A name comes from a file: it must neither break the line nor steer a terminal.
    printed = "".join(letter if letter.isprintable() else "?" for letter in name)
    printed = printed if len(printed) <= _LETTERS else f"{printed[: _LETTERS - 3]}..."
    return f"<{kind}{' ' * bool(printed)}{printed}: {', '.join(filter(None, figures))}>"


def counted(count: int, noun: str) -> str:
    """A count and its noun, in the plural where it is not one: "1 loop", "1,114 cells"."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def measured_in(unit: float | None) -> str:
    """What follows a quantity for a unit in millimeters: ", mm", or nothing if it is not known.

    Examples
    --------
    >>> f"distance{measured_in(25.4)}"
    'distance, inch'
    """
    if unit is None:
        return ""
    names = {1.0: "mm", 10.0: "cm", 25.4: "inch", 1000.0: "m"}
    return f", {names.get(unit, f'units of {unit:.6g} mm')}"


def without_caches(kind: Class) -> Class:
    """Pickle and copy objects of a dataclass by their fields; what follows from these is left out.

    A cached property lies in the object's dictionary beside its fields, and is made anew on use.
    """

    def state(self: Any) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in fields(self)}

    type.__setattr__(kind, "__getstate__", state)
    return kind
