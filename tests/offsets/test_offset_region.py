"""The judge of regions judged: right offsets pass, and each fault is found and named."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import splinesdf as ss
from benchmarks.offset_cases import made
from splinesdf.contours.contour import Contour
from tests.mechanical import parts
from tests.offset_region import judge_region
from tests.offsets.test_offset_checks import reversed_, ring

TOLERANCE = 1e-4


@cache
def washer(sizes: float) -> ss.Shape:
    """The washer moved; the same object each time, so that the judge asks GEOS once."""
    here = parts()["washer"]
    return replace(here, control=here.control + 22.0 * sizes)


def kinds(contours: list[Contour], d: float, *, sizes: float = 0.0) -> set[str]:
    """What is found of the washer's contours; both moved by so many sizes."""
    moved = [replace(c, arcs=c.arcs + 22.0 * sizes, parent=None) for c in contours]
    return judge_region(washer(sizes), moved, d, TOLERANCE).kinds


@pytest.mark.parametrize(("d", "sizes"), [(0.5, 0.0), (-0.5, 1e3), (0.0, 1e6)])
def test_exact_rings_pass_and_faults_are_found(d: float, sizes: float) -> None:
    outer, inner = ring(d)
    assert kinds([outer, inner], d, sizes=sizes) == set()
    assert kinds([outer], d, sizes=sizes) == {"spurious", "area", "loops"}
    assert {"lost", "area", "loops"} <= kinds([inner], d, sizes=sizes)
    assert kinds([], d, sizes=sizes) == {"lost", "area", "loops"}
    assert {"winding", "area", "loops"} <= kinds([outer, inner, outer], d, sizes=sizes)
    assert {"winding", "area"} <= kinds([outer, reversed_(inner)], d, sizes=sizes)
    aside = replace(outer, arcs=outer.arcs + np.array([3.0 * TOLERANCE, 0.0]))
    assert "deviation" in kinds([aside, inner], d, sizes=sizes)


@pytest.mark.parametrize(
    ("path", "distance", "loops"),
    [
        ("M40 -8C-25 -13 33 -21 33 -21L-23 -37L-6 12L40 -8Z", -11.731, 2),
        (
            "M-41 44C-41 44 -3 4 10 -30C10 -30 -37 -39 -37 -39C-49 41 -44 18 -44 18L-41 44Z",
            4.348,
            1,
        ),
        ("M-32 31C-16 -25 -21 -21 -21 -21L-38 -24L-32 31Z", 0.948, 1),
    ],
)
def test_where_buffers_of_two_finenesses_are_wrong_alike_another_way_decides(
    path: str, distance: float, loops: int
) -> None:
    shape = ss.Shape.from_svg_path(path)
    contours = ss.offset(shape, distance, tolerance=TOLERANCE)
    assert len(contours) == loops
    assert judge_region(shape, contours, distance, TOLERANCE).failures == []
    found = judge_region(shape, contours[1:], distance, TOLERANCE).kinds
    assert "lost" in found  # the count by buffers may be that of what is left


def test_a_small_circle_beside_a_large_square_counts() -> None:
    shape = made("beside(path('M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0Z'), 1e6)")
    contours = ss.offset(shape, 0.1, tolerance=TOLERANCE)
    large = max(contours, key=lambda contour: contour.length)
    assert judge_region(shape, contours, 0.1, TOLERANCE).failures == []
    assert "lost" in judge_region(shape, [large], 0.1, TOLERANCE).kinds
