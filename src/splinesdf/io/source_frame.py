"""From a file's numbers back to the source's coordinates, by what `write` says that it does.

This shares no code with what placed them: the unit is what the file itself declares, and the map
is the stated one, read backward.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from splinesdf.contours.contour import Contour, smallest_tolerance
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.shapes.shape import Shape

# The box of what was written is taken from polylines that are within this share of the tolerance:
# what it is off must not show beside the tolerance.
_BOX = 1e-3
# Factors that differ from 1 by less than this share are 1, as `write` says of units.
_PRINTED = 1e-6
_UNITS = {"G20": 25.4, "G21": 1.0, "mm": 1.0, "inch": 25.4}
# Of $INSUNITS, after the DXF reference: inch, foot, mm, cm, m, km, yard, micrometer, decimeter.
_INSUNITS = {
    **{1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0},
    **{7: 1e6, 10: 914.4, 13: 1e-3, 14: 100.0},
}
_UP, _DOWN = (".dxf", ".nc", ".ngc", ".gcode"), (".svg",)


class Told(NamedTuple):
    """How `write` was told to place contours."""

    units: str | None = None
    scale: float = 1.0
    origin: str | tuple[float, float] | None = None
    flip: bool | None = None


class Frame(NamedTuple):
    """Where a file's numbers lie.

    Attributes
    ----------
    by : float
        How many of the file's units one unit of the source is.
    mirrored : bool
        Whether y runs the other way.
    zero : (float, float)
        The point of the source that is (0, 0) in the file.
    """

    by: float
    mirrored: bool
    zero: tuple[float, float]

    def to_source(self, points: Floats) -> Floats:
        """Points of the file in the source's coordinates, (..., 2)."""
        return np.asarray(points / self._steps + self.zero)

    def to_file(self, point: tuple[float, float]) -> tuple[float, float]:
        """A point of the source in the file's coordinates."""
        x, y = (self._steps * (np.asarray(point) - self.zero)).tolist()
        return x, y

    @property
    def _steps(self) -> Floats:
        return np.array([self.by, -self.by if self.mirrored else self.by])


def frame_of(
    file: Path, shape: Shape, told: Told, written: Sequence[Contour], tolerance: float
) -> Frame:
    """Where the numbers of a file should lie that `write` made.

    Parameters
    ----------
    file : Path
    shape : Shape
        What its contours are of.
    told : Told
    written : sequence of Contour
        All contours that are in the file, for an origin in the box of these.
    tolerance : float

    Raises
    ------
    InputError
        If the file declares another unit than `write` was told, or the origin is a corner of what
        was written and that is not given.
    """
    suffix = file.suffix.lower()
    mirrored = told.flip
    if mirrored is None:
        mirrored = shape.y_down if suffix in _UP else suffix in _DOWN and not shape.y_down
    zero = (0.0, 0.0)
    if mirrored and shape.page is not None:
        _, bottom, _, top = shape.page
        zero = (0.0, bottom + top)
    if isinstance(told.origin, str):
        low, high = _box(written, tolerance)
        if told.origin == "lower-left":
            zero = (low[0], high[1] if mirrored else low[1])
        else:
            zero = (0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]))
    elif told.origin is not None:
        zero = told.origin
    return Frame(told.scale * _conversion(file, suffix, shape.unit, told.units), mirrored, zero)


def _box(written: Sequence[Contour], tolerance: float) -> tuple[list[float], list[float]]:
    if not written:
        raise InputError("expected the contours that were written, to know their box, got none")
    lines = [c.points(max(_BOX * tolerance, smallest_tolerance(c.arcs))) for c in written]
    every = np.concatenate(lines)
    return every.min(axis=0).tolist(), every.max(axis=0).tolist()


def _conversion(file: Path, suffix: str, unit: float | None, units: str | None) -> float:
    """How many of the units that a file declares one unit of the source is."""
    if suffix not in _UP:
        return 1.0
    declared = _declared(file, suffix)
    if units is not None and declared != _UNITS[units]:
        raise InputError(f"{file.name}: expected numbers in {units}, got a file in another unit")
    if unit is None:
        return 1.0
    if declared is None:
        raise InputError(f"{file.name}: expected a file that declares its unit, got one that not")
    by = unit / declared
    return 1.0 if math.isclose(by, 1.0, rel_tol=_PRINTED) else by


def _declared(file: Path, suffix: str) -> float | None:
    """The millimeters of the unit that a file declares."""
    if suffix != ".dxf":
        found = re.search(r"^[^(\n]*\b(G2[01])\b", file.read_text("utf-8"), re.MULTILINE)
        return None if found is None else _UNITS[found[1]]
    from ezdxf.filemanagement import readfile

    return _INSUNITS.get(int(readfile(file).header.get("$INSUNITS", 0)))
