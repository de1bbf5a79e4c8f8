"""Splines for the page: large and small cells, a thin domain, a far one, 10⁵ cells, a grid."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

import splinesdf as ss
from tests.named_shapes import gamma

PART = Path(ss.__file__).parent / "data" / "part.svg"


def _part() -> ss.SplineSDF:
    return ss.fit(ss.read(PART), tolerance=0.5).spline


def _thin() -> ss.SplineSDF:
    bar = ss.Shape.from_points([(0.0, 0.0), (1000.0, 0.5), (1000.0, 1.0), (0.0, 1.0)], name="bar")
    return ss.fit(bar, tolerance=0.02, domain=(-1.0, -1.0, 1001.0, 2.0)).spline


def _far() -> ss.SplineSDF:
    disk = ss.Shape.from_formula("10^6 + cos(t)/2", "10^6 + sin(t)/2")
    return ss.fit(disk, tolerance=1e-3).spline


def _many() -> ss.SplineSDF:
    shape = ss.read(PART)
    return ss.fit(shape, tolerance=1.5e-4 * shape.size).spline


def _grid() -> ss.SplineSDF:
    lines = np.linspace(0.0, 1.0, 12) ** 1.5, np.linspace(-0.2, 1.0, 9)
    return ss.interpolate(gamma("gamma2"), lines).spline


SPLINES: dict[str, Callable[[], ss.SplineSDF]] = {
    "part": _part,
    "thin": _thin,
    "far": _far,
    "many": _many,
    "grid": _grid,
}
