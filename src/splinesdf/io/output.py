"""`write`: contours to a file, in the format that the file's extension names."""

from __future__ import annotations

import os
from collections.abc import Iterable

import numpy as np

from splinesdf._atomic import write_text
from splinesdf._paths import as_path
from splinesdf.contour import Contour, box, check_tolerance
from splinesdf.errors import InputError
from splinesdf.io.writers import WRITERS

# The default tolerance as a share of the contours' size: far below what a machine cuts or a
# screen shows, while a circle still takes only about 2000 chords.
_DEFAULT_TOLERANCE = 1e-6


def write(
    path: str | os.PathLike[str], contours: Iterable[Contour], *, tolerance: float | None = None
) -> None:
    """Write contours to a file, whole or not at all.

    Parameters
    ----------
    path : str or path
        ``.svg``, ``.dxf``, ``.geojson``, ``.wkt`` or ``.csv``. The first two keep the arcs: SVG
        exactly but for hyperbolas, DXF exactly. The others hold polylines. SVG and DXF are
        written upright, whichever way the source's y axis points; the others hold the
        coordinates as they are.
    contours : iterable of Contour
    tolerance : float, optional
        How far a polyline, or the cubic that stands for a hyperbola in SVG, may be from the
        contour. DXF needs none. Default: 1e-6 of the larger side of the contours' box.

    Raises
    ------
    InputError
        If the extension is unknown, there is nothing to write, the tolerance is not positive or
        below rounding, or the file cannot be written.
    MissingExtraError
        For ``.dxf`` without ezdxf.
    """
    suffix = check_format(path)
    chains = _as_contours(contours)
    xmin, ymin, xmax, ymax = box(chains)
    size = max(xmax - xmin, ymax - ymin)
    if size == 0.0:
        raise InputError("expected contours with an extent, got a single point")
    every = np.concatenate([chain.arcs for chain in chains])
    if tolerance is None:
        tolerance = _DEFAULT_TOLERANCE * size
    check_tolerance(tolerance, every)
    write_text(path, WRITERS[suffix](chains, tolerance))


def check_format(path: str | os.PathLike[str]) -> str:
    """The extension, in lower case, or an `InputError` if no contours can be written to it."""
    suffix = as_path(path).suffix.lower()
    if suffix not in WRITERS:
        raise InputError(
            f"expected a file name ending in {', '.join(sorted(WRITERS))}, got {os.fspath(path)!r}"
        )
    return suffix


def _as_contours(contours: Iterable[Contour]) -> list[Contour]:
    if isinstance(contours, Contour):
        raise InputError("expected a list of contours, got one Contour: put it in brackets")
    chains = list(contours)
    for chain in chains:
        if not isinstance(chain, Contour):
            raise InputError(f"expected a list of contours, got {type(chain).__name__} in it")
    if not chains:
        raise InputError("expected at least one contour to write, got none")
    return chains
