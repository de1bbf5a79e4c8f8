"""A law: what is far from the origin, or small beside something large, has the offsets of home.

Offsets, level sets of fits, contours as lines and circular arcs, and G-code that is read again are
those of the shape at home, moved, within the tolerance and what rounding adds there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from benchmarks.offset_cases import beside, made, moved
from splinesdf.contours.contour import Contour
from splinesdf.io.remeasured import measure_file
from tests.flat_contours import on_arcs
from tests.offset_region import home, slack

WORDS = {
    "curve": "gamma('gamma2')",
    "glyph": "glyph('DejaVuSans:g')",
    "part": "part('slotted link')",
    "splines": "part('cam')",
    "arcs": "path('M1 0H9A1 1 0 0 1 10 1V5A1 1 0 0 1 9 6H1A1 1 0 0 1 0 5V1A1 1 0 0 1 1 0Z')",
    "cubics": "path('M0 0C2 4 5 -4 8 1C9 3 1 7 0 0Z')",
    "circle": "path('M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0Z')",
    "NURBS": "formula_shape('NURBS ellipse')",
}
MOVES = (1e3, 1e4, 1e5, 1e6, 1e7, 1e8)
# Shares of the size. The tolerance is ten times what is refused at 1e8 sizes from the origin.
DISTANCES = (0.05, -0.03)
TOLERANCE = 1e-4
ALONG = np.linspace(0.0, 1.0, 9)


def same(
    shape: ss.Shape,
    contours: Sequence[Contour],
    origin: np.ndarray,
    at_home: Sequence[Contour],
    allowed: float,
) -> None:
    """As many loops, as long, around as much, all of it at the distance from the shape at home."""
    assert len(contours) == len(at_home)
    around = sum(contour.length for contour in at_home)
    back = [replace(c, arcs=c.arcs - origin, parent=None) for c in contours]
    # A tolerance aside all along, on both sides, as both may be off; a length changes by as much as
    # the offset does along a full turn, for each loop, and some for each arc's own wavering.
    area, there = (sum(contour.area for contour in some) for some in (at_home, back))
    assert there == pytest.approx(area, abs=2.0 * allowed * around)
    number = sum(len(contour.arcs) for contour in [*at_home, *back])
    length = sum(contour.length for contour in back)
    assert length == pytest.approx(around, abs=2.0 * np.pi * allowed * number)
    for contour in back:
        points = on_arcs(contour.arcs, contour.weights, ALONG).reshape(-1, 2)
        off = np.abs(ss.signed_distance(shape, points) - contour.distance)
        assert off.max() <= allowed


def pair(name: str, sizes: float) -> tuple[ss.Shape, ss.Shape, np.ndarray]:
    """A shape far away, the same at home, and where it was."""
    far = moved(made(WORDS[name]), sizes)
    near, origin = home(far)
    return far, near, origin


@pytest.mark.parametrize("sizes", MOVES)
@pytest.mark.parametrize("name", WORDS)
def test_offsets_move_with_the_shape(name: str, sizes: float) -> None:
    far, near, origin = pair(name, sizes)
    for share in DISTANCES:
        distance, tolerance = share * near.size, TOLERANCE * near.size
        contours = ss.offset(far, distance, tolerance=tolerance)
        at_home = ss.offset(near, distance, tolerance=tolerance)
        assert at_home
        same(near, contours, origin, at_home, tolerance + slack(far, distance))


@pytest.mark.parametrize("times", [1e3, 1e6])
@pytest.mark.parametrize("name", WORDS)
def test_a_small_part_in_a_large_drawing_has_its_offsets(name: str, times: float) -> None:
    alone = made(WORDS[name])
    large = beside(alone, times)
    for share in DISTANCES:
        distance, tolerance = share * alone.size, TOLERANCE * alone.size
        at_home = ss.offset(alone, distance, tolerance=tolerance)
        found = ss.offset(large, distance, tolerance=tolerance)
        small = [c for c in found if np.ptp(c.arcs[:, ::2], axis=(0, 1)).max() < 2.0 * alone.size]
        assert len(found) == len(small) + 1
        same(alone, small, np.zeros(2), at_home, tolerance + slack(large, distance))


@pytest.mark.parametrize("sizes", [1e3, 1e6, 1e8])
@pytest.mark.parametrize("name", ["curve", "arcs", "circle"])
def test_level_sets_of_fits_move_with_the_shape(name: str, sizes: float) -> None:
    far, near, origin = pair(name, sizes)
    distance, tolerance = 0.05 * near.size, 1e-3 * near.size
    there, here = (
        ss.fit(shape, tolerance=tolerance, band=(distance, distance)).spline.contours(distance)
        for shape in (far, near)
    )
    same(near, there, origin, here, tolerance + slack(far, distance))


@pytest.mark.parametrize("sizes", MOVES)
@pytest.mark.parametrize("name", ["curve", "glyph", "arcs", "cubics"])
def test_arcs_and_programs_move_with_the_shape(name: str, sizes: float, tmp_path: Path) -> None:
    far, near, origin = pair(name, sizes)
    distance, tolerance = 0.05 * near.size, TOLERANCE * near.size
    there, here = (
        [
            ss.as_arcs(contour, tolerance=0.5 * tolerance)
            for contour in ss.offset(shape, distance, tolerance=0.5 * tolerance)
        ]
        for shape in (far, near)
    )
    same(near, there, origin, here, tolerance + slack(far, distance))
    allowed = tolerance + slack(far, distance)
    ss.write(
        tmp_path / "far.nc",
        ss.offset(far, distance, tolerance=0.5 * tolerance),
        tolerance=0.5 * tolerance,
    )
    worst = measure_file(tmp_path / "far.nc", far, [distance], allowed)
    assert worst.keeps(allowed)
    assert worst.curves == {distance: len(here)}
