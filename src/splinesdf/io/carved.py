"""The file of a carve: its paths placed as contours are, and what a file of them was to be.

x and y are mirrored, moved and scaled as `write` says for contours; z is scaled with them.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from splinesdf.contours.carve import Carve
from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.placing import Placement, placed
from splinesdf.io.writers.carved import CARVED
from splinesdf.io.writers.options import Options, factor


def carved_text(
    path: str | os.PathLike[str], suffix: str, placement: Placement, carve: Carve, asked: Any
) -> str:
    """What a file of a carve holds.

    Parameters
    ----------
    path : str or path
    suffix : str
        Its extension, in lower case.
    placement : Placement
    carve : Carve
    asked : mapping
        The options of `write`.
    """
    if suffix not in CARVED:
        raise InputError(
            f"expected a file name ending in {', '.join(sorted(CARVED))} for a carve, whose paths "
            f"are in space, got {os.fspath(path)!r}"
        )
    if asked["tolerance"] is not None or asked["arcs"]:
        name = "tolerance" if asked["tolerance"] is not None else "arcs"
        raise InputError(f"expected no {name} for a carve, whose paths are what they are, got it")
    units = asked["units"]
    by = factor(suffix, carve.unit, units)
    if by != 1.0:
        units = units or "mm"
    paths = paths_in_file(carve, suffix, placement, by)
    by *= placement.scale
    told = Options(by * carve.tolerance, False, units, asked["milling"], carve.unit, by)
    how = f"a bit of {carve.angle:g} degrees" + (f", tip {by * carve.tip:g}" if carve.tip else "")
    return CARVED[suffix](paths, how, told)


def paths_in_file(carve: Carve, suffix: str, placement: Placement, by: float) -> list[Floats]:
    """The paths in the file's coordinates."""
    (there,), _ = placed([seen_from_above(carve)], suffix, placement, by)
    z = by * placement.scale * np.concatenate(carve.paths)[:, 2]
    stops = np.cumsum([len(path) for path in carve.paths])[:-1]
    return np.split(np.column_stack([there.arcs[:, 0], z]), stops)


def seen_from_above(carve: Carve) -> Contour:
    """One line through all points of the paths; a piece of it begins at each."""
    points = np.concatenate(carve.paths)[:, :2]
    after = np.append(points[1:], points[-1:], axis=0)
    return Contour(
        np.stack([points, 0.5 * (points + after), after], axis=1),
        np.ones(len(points)),
        closed=False,
        y_down=carve.y_down,
        unit=carve.unit,
        page=carve.page,
        tolerance=carve.tolerance,
    )
