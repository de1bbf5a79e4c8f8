"""Kinds of shapes whose offsets were wrong or endless once, a few of each; the sweep has thousands.

Judged by deviation, by GEOS's regions, and by how they were made: none by the level set of a fit.
"""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from benchmarks.offset_cases import Case, cases, made
from splinesdf.arclets.tables import FREE, ROUND
from splinesdf.offsets import offset as driver
from splinesdf.offsets.at_distance import _meeting
from splinesdf.offsets.far import hull_offset
from splinesdf.offsets.offset import deviation
from splinesdf.offsets.tables import RunArcs
from tests.named_shapes import gamma
from tests.offset_checks import Verdict, check_chains
from tests.offset_region import judge_region, slack

SQUARE = ss.Shape.from_points([(-1, -1), (1, -1), (1, 1), (-1, 1)])
# Path data of two triangles that share a corner.
SHARED = "M51 38L30 16L18 2Z M51 38L4 0L10 48Z"


@pytest.mark.parametrize("part", ["zero-handles", "touching", "shallow"])
def test_random_shapes_of_each_kind(part: str) -> None:
    wrong = []
    for case in cases(part, 11, 8):
        wrong += [f"{kind}: {text} {case}" for kind, text in failures(case)]
    assert not wrong, f"{len(wrong)} wrong, {wrong[0]}"


def failures(case: Case) -> list[tuple[str, str]]:
    shape = made(case.shape)
    contours = ss.offset(shape, case.distance, tolerance=case.tolerance, coarse=True)
    verdict = Verdict()
    check_chains(verdict, contours, case.distance)
    judge_region(shape, contours, case.distance, case.tolerance, verdict=verdict)
    allowed = case.tolerance + slack(shape, case.distance)
    if (off := deviation(shape, contours)) > allowed:
        verdict.fail("deviation", f"{off} > {allowed}")
    if any(contour.fitted for contour in contours):
        verdict.fail("fallback", "the level set of a fit")
    return verdict.failures


@pytest.mark.parametrize("sizes", [30.0, 1e3])
@pytest.mark.parametrize(
    ("shape", "share"),
    [
        ("moved(icon('apple'), 1e6)", 1e-4),
        ("scaled(icon('fingerprint'), 1e-3)", 1e-3),
        ("scaled(glyph('DejaVuSans:Ω'), 1e-6)", 1e-7),
        ("gamma('gamma3')", 1e-6),
        ("gamma('gamma3')", 1e-9),
        ("shallow(519, 4.4e-8, 13, True)", 1e-5),
        ("shallow(400, 1e-9, 3, True)", 1e-9),
    ],
)
def test_far_out_parallels_cross_at_small_angles(shape: str, share: float, sizes: float) -> None:
    size = made(shape).size
    assert failures(Case("far", "far", shape, sizes * size, share * size, size)) == []


@pytest.mark.parametrize("distance", [1.0, -0.5, 3.0])
def test_what_touches_in_a_point_has_one_corner_for_each_wedge(distance: float) -> None:
    shape = ss.Shape.from_svg_path(SHARED)
    contours = ss.offset(shape, distance, tolerance=1e-3)
    assert deviation(shape, contours) < 1e-12 * shape.size
    # Seen from outside one loop goes through the corner twice; from inside each is its own.
    assert len(shape.joints.loops) - 1 == 2
    assert len(shape.joints_outside.loops) - 1 == 1


@pytest.mark.parametrize("seed", range(5))
def test_a_corner_on_a_slanted_side_is_one_point_with_it(seed: int) -> None:
    # Nowhere near round numbers: the corner is on the side to rounding only.
    random = np.random.default_rng(seed)
    c, s = np.cos(seed + 0.3), np.sin(seed + 0.3)
    turn, shift = np.array([[c, s], [-s, c]]), random.uniform(-50.0, 50.0, 2)
    one = np.array([(0.0, 0.0), (10.0, 0.0), (3.0, 8.0)])
    other = np.array([(0.0, 0.0), (-1.5, -3.0), (2.0, -4.0)])
    other[:, 0] += random.uniform(2.0, 8.0)
    loops = [np.stack([p, np.roll(p, -1, axis=0)], 1) @ turn + shift for p in (one, other)]
    shape = ss.Shape.from_pieces([list(loop) for loop in loops])
    assert len(shape.joints.loops) - 1 == 2
    assert len(shape.joints_outside.loops) - 1 == 1
    for distance in (0.3, -0.3):
        contours = ss.offset(shape, distance, tolerance=1e-4)
        assert deviation(shape, contours) < 1e-12 * 50.0
        assert not any(contour.fitted for contour in contours)


@pytest.mark.parametrize("sizes", [1e5, 1e7, 1e9])
@pytest.mark.parametrize("name", ["gamma2", "square", "stadium"])
def test_far_offsets_are_those_of_the_hull(name: str, sizes: float) -> None:
    shape = {
        "gamma2": gamma("gamma2"),
        "square": SQUARE,
        "stadium": ss.Shape.from_svg_path("M0 0H4A1 1 0 0 1 4 2H0A1 1 0 0 1 0 0Z"),
    }[name]
    distance = sizes * shape.size
    tolerance = max(1e-3 * shape.size, 2e-13 * distance)
    (contour,) = ss.offset(shape, distance, tolerance=tolerance)
    assert deviation(shape, [contour]) <= tolerance
    # Two half lines, four quarters: Steiner's formula, with the hull's perimeter.
    perimeter = (
        hull_offset(shape, 1e3 * shape.size, 1e-3 * shape.size).length
        - 2.0 * np.pi * 1e3 * shape.size
    )
    expected = np.pi * distance**2 + perimeter * distance
    assert contour.area == pytest.approx(expected, rel=1e-9 + 4.0 * tolerance / distance)
    if name != "gamma2":
        assert len(contour.arcs) <= 10


@pytest.mark.parametrize(
    ("path", "perimeter"),
    [("M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0Z", 2.0 * np.pi), ("M0 0L4 1L4 3Z M0 0L4 -3L4 -1Z", 16.0)],
)
def test_far_offsets_of_one_circle_and_of_what_touches(path: str, perimeter: float) -> None:
    """The hull of the latter begins where two of its triangles do."""
    shape = ss.Shape.from_svg_path(path)
    distance = 3e4 * shape.size
    (contour,) = ss.offset(shape, distance, tolerance=1e-3)
    assert deviation(shape, [contour]) <= 1e-3
    assert contour.length == pytest.approx(2.0 * np.pi * distance + perimeter, rel=1e-11)
    assert contour.closed


@pytest.mark.parametrize("sizes", [0.25, 3.0, 25.0])
def test_what_parallels_cannot_do_is_done_by_a_fit_or_the_hull(
    sizes: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No loose ends are known that are in the way of all shifts: they are pretended."""
    monkeypatch.setattr(driver, "contours_at", lambda *_, **__: None)
    distance = sizes * SQUARE.size
    (contour,) = ss.offset(SQUARE, distance, tolerance=0.05)
    assert deviation(SQUARE, [contour]) <= 0.05
    assert contour.fitted == (sizes < 20.0)
    assert (contour.distance, contour.tolerance) == (distance, 0.05)
    assert contour.area == pytest.approx(
        4.0 + 8.0 * distance + np.pi * distance**2, abs=0.05 * contour.length
    )


def test_far_offsets_below_what_the_hull_is_good_for_are_refused_at_once() -> None:
    with pytest.raises(ss.InputError, match=r"expected a tolerance of at least .* times the"):
        ss.offset(SQUARE, 1e6, tolerance=1e-6)
    assert ss.offset(SQUARE, -1e6, tolerance=1e-3) == []


@pytest.mark.parametrize("distances", [[0.1, 1e9], [1e9, 0.1], [1e9]])
def test_the_farthest_of_several_distances_says_what_rounding_leaves_room_for(
    distances: list[float],
) -> None:
    # The hull is good for 5e-9 out there; 1e-13 of the distance is the rounding.
    with pytest.raises(ss.InputError, match=r"of at least 0\.0001, above the rounding"):
        ss.offset(SQUARE, distances, tolerance=1e-6)
    found = ss.offset(SQUARE, distances, tolerance=1.1e-4)
    assert [contour.distance for contour in found] == distances


def test_the_default_tolerance_knows_the_distance() -> None:
    contours = ss.offset(SQUARE, [0.01, -0.5])
    assert {contour.tolerance for contour in contours} == {1e-4}
    assert ss.offset(SQUARE, [0.9, 0.0])[0].tolerance == 2e-3
    assert ss.offset(SQUARE, step=-0.4)[0].tolerance == 2e-3
    assert ss.offset(SQUARE, 0.0)[0].tolerance == 2e-3
    for options in ({"distances": [1.0, -0.1]}, {"step": -0.1}):
        with pytest.raises(ss.InputError, match=r"a quarter of the smallest distance, 0\.025, got"):
            ss.offset(SQUARE, **options, tolerance=0.03)
        assert ss.offset(SQUARE, **options, tolerance=0.03, coarse=True)


def test_steps_have_a_ceiling() -> None:
    with pytest.raises(ss.InputError, match="taken 10,000 times at most"):
        ss.offset(SQUARE, step=-1e-5)


def test_a_curve_without_extent_across_its_line_is_that_line() -> None:
    to_and_fro = ss.Shape.from_svg_path("M 0 0 C 3 0 -2 0 1 0 L 1 1 Z")
    assert [len(to_and_fro.piece(i)) for i in range(to_and_fro.piece_count)] == [2, 2, 2]
    bulging = ss.Shape.from_svg_path("M 0 0 C 0 1e-12 1 1e-12 1 0 L 1 1 Z")
    assert len(bulging.piece(0)) == 4


@pytest.mark.parametrize("at", [0.0, 1e4, 1e6])
def test_circles_are_told_by_their_own_size(at: float) -> None:
    circle = f"M{at + 5} {at}A5 5 0 0 1 {at - 5} {at}A5 5 0 0 1 {at + 5} {at}Z"
    assert (ss.Shape.from_svg_path(circle).kinds.kind == ROUND).all()
    # A curve of the same size that is none, by a thousandth.
    ellipse = f"M{at + 5} {at}A5 5.005 0 0 1 {at - 5} {at}A5 5.005 0 0 1 {at + 5} {at}Z"
    assert (ss.Shape.from_svg_path(ellipse).kinds.kind == FREE).all()


def test_a_chain_of_turns_below_the_tolerance_is_no_line() -> None:
    # Each of 400 vertices turns by less than counts as a corner; all together they are an arc.
    turn, count = 5e-8, 400
    angle = np.concatenate([[0.0], np.cumsum(np.full(count - 1, turn))])
    chain = np.cumsum(np.stack([np.cos(angle), np.sin(angle)], axis=1), axis=0)
    shape = ss.Shape.from_points(np.concatenate([[[0.0, 0.0]], chain, [[200.0, 300.0]]]))
    for distance in (1.0, -1.0):
        for tolerance in (1e-4, 1e-6, 1e-9):
            contours = ss.offset(shape, distance, tolerance=tolerance)
            assert deviation(shape, contours) <= 0.1 * tolerance + 1e-12


def test_work_has_a_ceiling(monkeypatch: pytest.MonkeyPatch) -> None:
    from splinesdf.offsets.kernels import conic_fit

    # What compiled code goes by stays as it is; this is what the caller compares with.
    monkeypatch.setattr(conic_fit, "MOST_ARCS", 3)
    with pytest.raises(ss.InputError, match="3 arcs are enough, got 1e-06: raise it"):
        ss.offset(gamma("gamma2"), 0.1, tolerance=1e-6)


def test_looks_have_a_ceiling(monkeypatch: pytest.MonkeyPatch) -> None:
    from splinesdf.offsets.kernels import trim

    monkeypatch.setattr(trim, "trim", lambda *_: -1)  # as it answers after so many
    with pytest.raises(ss.InputError, match=r"told apart by 50,000,000 looks, got 0\.1, which"):
        ss.offset(gamma("gamma2"), 0.1, tolerance=1e-6)


def test_all_arcs_that_meet_are_found_however_many() -> None:
    """A lattice of lines, each of which meets all across."""
    at = np.linspace(0.0, 1.0, 12)
    ends = np.array([[[(x, -1.0), (x, 2.0)], [(-1.0, x), (2.0, x)]] for x in at]).reshape(-1, 2, 2)
    arcs = np.stack([ends[:, 0], ends.mean(axis=1), ends[:, 1]], axis=1)
    rows = np.arange(len(arcs))
    met = _meeting(RunArcs(arcs, np.ones(len(arcs)), rows), np.full(len(arcs), -1))
    found = {tuple(sorted(pair)) for pair in met.reshape(-1, 2).tolist()}
    assert found == {(min(i, j), max(i, j)) for i in rows[::2] for j in rows[1::2]}


@pytest.mark.parametrize("distance", [4e-7, 5e-7, 1e-6, 1e-4, -5e-7, -5e-4])
@pytest.mark.parametrize("shape", ["comb(60, 1e-6)", "spiral(8)"])
def test_long_thin_slots_take_no_longer_than_wide_ones(shape: str, distance: float) -> None:
    # Seconds, once, or no end: stretches were halved until they were as short as the distance.
    assert failures(Case("work", "work", shape, distance, 1e-10, made(shape).size)) == []


def test_a_short_arc_between_turning_parallels_is_found() -> None:
    # A reflex corner between curves that bend without limit there: of its arc a fifth is left.
    text = "M-25 -32C18 49 27 31 27 31C27 31 47 -3 6 -29L26 -12C26 -12 -31 -23 -31 -23"
    shape = f"path('{text}L-44 30C-49 51 -25 -32 -25 -32Z')"
    for distance in (-2.741, -1.0, -0.1):
        assert failures(Case("work", "work", shape, distance, 1e-4, 76.0)) == []
