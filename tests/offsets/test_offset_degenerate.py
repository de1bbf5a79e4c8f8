"""Distances at which something degenerates exactly, and curves that begin with a cusp."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from benchmarks.offset_sweep import EXACT
from benchmarks.speed_cases import comb
from splinesdf.arclets.points import angles, tangents_at
from splinesdf.offsets.kernels import trim as kernels
from splinesdf.offsets.tables import Trimmed
from splinesdf.offsets.trimmed import trimmed
from tests.compiled import from_python
from tests.mechanical import AWKWARD, parts
from tests.offset_checks import judge
from tests.shapes.test_cusps import cusp

CASES = [(name, distance) for name, some in AWKWARD.items() for distance in some]


@pytest.mark.parametrize(("name", "distance"), CASES)
def test_what_is_left_where_walls_are_twice_the_distance_apart_is_exact(
    name: str, distance: float
) -> None:
    shape = parts()[name]
    for share in (1e-3, 1e-8):
        tolerance = share * shape.size
        contours = ss.offset(shape, distance, tolerance=tolerance)
        # The number of loops hangs on rounding here: `test_offset_sweep` counts elsewhere.
        verdict = judge(shape, contours, distance, tolerance, counts=[len(contours)])
        assert verdict.failures == []
        assert verdict.deviation < EXACT * shape.size


def looks(shape: ss.Shape, distance: float, tolerance: float) -> int:
    """How many stretches trimming looks at."""
    counted: list[Trimmed] = []

    def kept(elements: np.ndarray, spans: np.ndarray, counts: np.ndarray) -> Trimmed:
        counted.append(Trimmed(elements, spans, counts))
        return counted[-1]

    with pytest.MonkeyPatch.context() as patch:
        # The kernel run as Python; what it calls stays compiled.
        patch.setattr(kernels, "trim", kernels.trim.py_func)
        patch.setattr(kernels, "Trimmed", kept)
        patch.setattr(kernels, "_trim", from_python(kernels._trim))
        trimmed(shape, distance, tolerance)
    return int(counted[-1].counts[2])


@pytest.mark.parametrize(("name", "distance"), [("T-slot profile", -0.75), ("washer", -3.0)])
def test_walls_twice_the_distance_apart_are_not_cut_to_pieces(name: str, distance: float) -> None:
    # Straight ones, and circles about one center: halved where they are equally near, down to
    # rounding, they would take a thousand times as long as at other distances.
    shape = parts()[name]
    usual, apart = (looks(shape, share * distance, 1e-8 * shape.size) for share in (1.02, 1.0))
    assert 0 < apart < 300 * usual


def test_slots_side_by_side_are_not_cut_to_pieces() -> None:
    # A million times as deep as they are wide, and fifty of them within the distance: one wall is
    # nearer to all of a stretch, so that it need not be halved until few are near.
    shape = comb(60)
    assert looks(shape, 1e-4, 1e-5) < 20 * shape.piece_count
    outside, *others = ss.offset(shape, 1e-4, tolerance=1e-5)
    assert not others
    assert np.ptp(outside.arcs[..., 0]) == pytest.approx(120e-6 + 2e-4, abs=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1.0])
@pytest.mark.parametrize("reverse", [False, True])
def test_tangents_next_to_half_a_cusp_are_no_rounding(angle: float, reverse: bool) -> None:
    # An involute, far from the origin: it starts with a velocity of 0 and bends without bound.
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    flank = ss.Shape.from_formulas(
        [("cos(t) + t*sin(t)", "sin(t) - t*cos(t)", (0.0, 1.2))], close=True
    )
    pieces = [flank.piece(i) @ turn + 10.0 for i in range(flank.piece_count)]
    if reverse:
        pieces = [piece[::-1] for piece in pieces[::-1]]
    boundary = ss.Shape.from_pieces([pieces]).boundary
    ahead = boundary.following
    arclets = np.flatnonzero(boundary.piece == boundary.piece[ahead])
    one = tangents_at(boundary, arclets, np.ones(len(arclets)))
    other = tangents_at(boundary, ahead[arclets], np.zeros(len(arclets)))
    assert len(arclets) > 6
    # Control points rounded to 1e-15 bend the curve by this much, next to its tip.
    assert np.abs(angles(one, other)).max() < 1e-9


@pytest.mark.parametrize("share", [1e-3, -0.03])
def test_cusps_inside_pieces_of_a_formula(share: float) -> None:
    # Where the parameter starts decides where in a piece the cusps lie.
    shape = ss.Shape.from_formula("7.3 + cos(t + 0.3)^3", "1.1 + sin(t + 0.3)^3")
    tolerance = 1e-7 * shape.size
    contours = ss.offset(shape, share * shape.size, tolerance=tolerance)
    verdict = judge(shape, contours, share * shape.size, tolerance, counts=[1])
    assert verdict.failures == []
    assert len(contours[0].arcs) < 200


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_contour_does_not_turn_back_next_to_a_cusp(seed: int) -> None:
    # The parallels of both branches turn back there so shortly that rounding hides the crossing.
    control, _ = cusp(np.random.default_rng(seed))
    shape = ss.Shape.from_pieces([[control]], close=True)
    [contour] = ss.offset(shape, 1e-3 * shape.size, tolerance=1e-7 * shape.size)
    into, out_of = np.diff(contour.arcs, axis=1).transpose(1, 0, 2)
    turns = angles(out_of, np.roll(into, -1, axis=0))
    # Where the curve crosses itself there are corners, too.
    assert np.abs(turns).max() < 0.5
