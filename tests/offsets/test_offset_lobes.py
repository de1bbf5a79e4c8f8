"""Smooth curves whose pieces end where x or y turns: their offsets have no corner."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from tests.mechanical import parts
from tests.offset_corners import corners_of, false_corners

CASES = [(n, radius, bulge) for n in (2, 3, 5, 7, 8, 12) for radius, bulge in ((24, 4), (1, 0.1))]


@pytest.mark.parametrize(("lobes", "radius", "bulge"), CASES)
@pytest.mark.parametrize("turned", [0.0, 1e-9, 0.4])
def test_lobes_have_no_corners(lobes: int, radius: float, bulge: float, turned: float) -> None:
    bulge = bulge * min(1.0, 12.0 / lobes**2)  # curvature stays below 1 / |d|
    r = f"({radius} + {bulge}*cos({lobes}*(t - {turned})))"
    shape = ss.Shape.from_formula(f"{r}*cos(t)", f"{r}*sin(t)")
    for share in (-1e-3, 1e-3, -1e-2, 1e-2):
        for tolerance in (1e-5, 1e-7):
            found = ss.offset(shape, share * shape.size, tolerance=tolerance * shape.size)
            assert len(found) == 1
            assert len(corners_of(found).turn) == 0, (share, tolerance, corners_of(found))


@pytest.mark.parametrize(("lobes", "radius", "bulge"), CASES)
def test_no_piece_is_cut_beside_its_end(lobes: int, radius: float, bulge: float) -> None:
    """What is cut off is no speck: directions of one are rounding."""
    r = f"({radius} + {bulge}*cos({lobes}*t))"
    arclets = ss.Shape.from_formula(f"{r}*cos(t)", f"{r}*sin(t)").boundary
    length = np.hypot(*(arclets.end - arclets.start).T)
    assert length.min() > 1e-8 * length.max()


@pytest.mark.parametrize("tolerance", [1e-5, 1e-6, 1e-8])
def test_the_star_knob_has_corners_where_the_distance_has(tolerance: float) -> None:
    """Its x turned 1e-11 beside the end of a piece; the tangent between jumped by 2e-3."""
    shape = parts()["star knob"]
    for share in (-1e-3, 1e-3, -3e-3):
        found = ss.offset(shape, share * shape.size, tolerance=tolerance * shape.size)
        wanted = share * shape.size, tolerance * shape.size
        assert false_corners(shape, corners_of(found), *wanted) == []
