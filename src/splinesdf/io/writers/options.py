"""Options of the writers of formats, and which formats have no use for which."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from splinesdf.errors import InputError
from splinesdf.io.writers.milling import Milling

UNITS = ("mm", "inch")


@dataclass(frozen=True)
class Options:
    """What a writer is told of a file whose contours are in its own coordinates."""

    tolerance: float
    arcs: bool = False
    units: str | None = None
    milling: Milling | None = None
    unit: float | None = None  # millimeters of the contours' own unit, if it is known
    by: float = 1.0  # how many of the file's units one unit of the contours' distances is
    mirrored: tuple[bool, ...] = ()  # of each contour: whether its source is seen in a mirror


# Millimeters of the units that can be asked for, and of those that DXF has a number for.
MILLIMETERS = {"mm": 1.0, "inch": 25.4}
DXF_UNITS = {25.4: 1, 304.8: 2, 1.0: 4, 10.0: 5, 1000.0: 6, 1e6: 7, 914.4: 10, 1e-3: 13, 100.0: 14}
# Factors that differ by less than this share from 1 are 1: it is what the printed digits of a
# drawing's size leave.
_PRINTED = 1e-6


def factor(suffix: str, unit: float | None, units: str | None) -> float:
    """By what the numbers of a file are larger than the coordinates.

    G-code is in millimeters or inches, and so is DXF if that is asked for, or if it has no number
    for the coordinates' own unit. Other formats, and coordinates whose unit is not known, are
    written as they are.

    Parameters
    ----------
    suffix : str
    unit : float or None
        How many millimeters one unit of the coordinates is.
    units : {"mm", "inch"} or None
    """
    if unit is None or suffix not in Y_UP:
        return 1.0
    if units is None and suffix == ".dxf" and dxf_unit(unit):
        return 1.0
    found = unit / MILLIMETERS[units or "mm"]
    return 1.0 if abs(found - 1.0) <= _PRINTED else found


def dxf_unit(unit: float | None) -> int:
    """DXF's number for a unit of so many millimeters, but for printed digits; 0 if it has none."""
    known = (n for mm, n in DXF_UNITS.items() if unit and abs(unit / mm - 1.0) <= _PRINTED)
    return next(known, 0)


def is_used(suffix: str, name: str) -> bool:
    """Whether a format has a use for an option; all have for those that place contours."""
    return name not in _USE or suffix in _USE[name]


def check_options(suffix: str, **given: Any) -> None:
    """Refuse what a format cannot use: arcs, units, milling."""
    for name, value in given.items():
        if value and not is_used(suffix, name):
            raise InputError(
                f"expected {name} only for {', '.join(sorted(_USE[name]))}, got it for {suffix}: "
                "leave it out, or name another file"
            )
    units = given.get("units")
    if units is not None and units not in UNITS:
        raise InputError(f"expected mm or inch for units, got {units!r}")
    milling = given.get("milling")
    if milling is not None and not isinstance(milling, Milling):
        raise InputError(f"expected a Milling for milling, got {type(milling).__name__}")


GCODE = frozenset({".nc", ".ngc", ".gcode"})
# Formats in which y points up, and those in which it points down; the others have no axes.
Y_UP, Y_DOWN = GCODE | {".dxf"}, frozenset({".svg"})
_USE = {"arcs": Y_UP | Y_DOWN, "units": Y_UP, "milling": GCODE}
