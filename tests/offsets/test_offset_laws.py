"""Laws of offsets: what must not change them, and how they go together."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.contours.contour import Contour, evaluate
from tests import oracles
from tests.examples import examples
from tests.glyphs import glyphs
from tests.mechanical import parts
from tests.named_shapes import Loops, gamma, loops_of, rebuilt

# Share of the size. Two runs may place joints differently: both are within this of the offset.
TOLERANCE = 1e-5
# Areas and lengths of contours that are within the tolerance of each other differ by the length
# times it, and by the square of the slopes at which they waver: less than this many tolerances
# of the length.
MEASURES = 4.0

NAMES = ["gamma2", "gamma3", "DejaVuSans:g", "slotted link", "involute gear", "ratchet"]
# Away from where something degenerates, for all of them.
SHARES = (0.021, -0.017, 0.077)
some_shape = st.sampled_from(NAMES)
some_share = st.sampled_from(SHARES)
few = examples(12)


@cache
def shape_of(name: str) -> ss.Shape:
    if name.startswith("gamma"):
        return gamma(name)
    return glyphs()[name] if ":" in name else parts()[name]


@cache
def offset_of(name: str, share: float) -> list[Contour]:
    shape = shape_of(name)
    return ss.offset(shape, share * shape.size, tolerance=TOLERANCE * shape.size)


def points_of(contours: Sequence[Contour]) -> np.ndarray:
    t = np.linspace(0.0, 1.0, 17)
    return np.concatenate([evaluate(c.arcs, c.weights, t).reshape(-1, 2) for c in contours])


def apart(some: Sequence[Contour], others: Sequence[Contour], fine: float) -> float:
    """Two-sided Hausdorff distance, to a few times ``fine``."""
    lines = [[c.points(fine) for c in contours] for contours in (some, others)]
    return max(
        float(oracles.polyline_distance(lines[1], points_of(some)).max()),
        float(oracles.polyline_distance(lines[0], points_of(others)).max()),
    )


def check_same(found: Sequence[Contour], expected: Sequence[Contour], tolerance: float) -> None:
    """The same loops, each with the same length and area, nowhere apart by more than is allowed.

    Corners may lie off by more than the tolerance where curves meet at a small angle.
    """
    assert len(found) == len(expected)
    pairs = [sorted(contours, key=lambda c: c.area) for contours in (found, expected)]
    for a, b in zip(*pairs, strict=True):
        assert abs(a.area - b.area) <= MEASURES * tolerance * b.length
        assert abs(a.length - b.length) <= MEASURES * tolerance * b.length / np.sqrt(abs(b.area))
    assert apart(found, expected, 0.1 * tolerance) <= 4.0 * tolerance


def moved(contours: Sequence[Contour], turn: np.ndarray, shift: np.ndarray) -> list[Contour]:
    """Contours mapped by a matrix; one that mirrors turns the inside to the right: reversed."""
    result = []
    for c in contours:
        arcs, weights = c.arcs @ turn.T + shift, c.weights
        if np.linalg.det(turn) < 0.0:
            arcs, weights = arcs[::-1, ::-1], weights[::-1]
        result.append(Contour(arcs, weights, distance=c.distance))
    return result


@few
@given(
    some_shape,
    some_share,
    st.floats(-np.pi, np.pi),
    st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)),
    st.booleans(),
)
def test_rigid_motions_and_mirrors(
    name: str, share: float, angle: float, shift: tuple[float, float], mirror: bool
) -> None:
    shape = shape_of(name)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]]) @ np.diag([1.0, -1.0 if mirror else 1.0])
    way = shape.size * np.array(shift)
    other = rebuilt(shape, lambda loops: [[p @ turn.T + way for p in loop] for loop in loops])
    tolerance = TOLERANCE * shape.size
    found = ss.offset(other, share * shape.size, tolerance=tolerance)
    check_same(found, moved(offset_of(name, share), turn, way), tolerance)


@few
@given(some_shape, some_share, st.floats(-9.0, 9.0))
def test_scale(name: str, share: float, exponent: float) -> None:
    shape, scale = shape_of(name), 10.0**exponent
    other = rebuilt(shape, lambda loops: [[scale * p for p in loop] for loop in loops])
    tolerance = TOLERANCE * shape.size * scale
    found = ss.offset(other, share * shape.size * scale, tolerance=tolerance)
    check_same(found, moved(offset_of(name, share), scale * np.eye(2), np.zeros(2)), tolerance)


@few
@given(some_shape, some_share, st.floats(0.0, 1.0), st.booleans(), st.booleans())
def test_start_point_direction_and_order(
    name: str, share: float, start: float, backwards: bool, reorder: bool
) -> None:
    shape = shape_of(name)

    def change(loops: Loops) -> Loops:
        result = []
        for loop in loops:
            first = int(start * (len(loop) - 1))
            turned = loop[first:] + loop[:first]
            result.append([p[::-1] for p in reversed(turned)] if backwards else turned)
        return result[::-1] if reorder else result

    tolerance = TOLERANCE * shape.size
    found = ss.offset(rebuilt(shape, change), share * shape.size, tolerance=tolerance)
    check_same(found, offset_of(name, share), tolerance)


def as_shape(contours: Sequence[Contour], degree: int = 2) -> ss.Shape:
    """Contours as a shape again: their rational arcs as NURBS, one loop after the other."""
    loops: Loops = []
    for c in contours:
        control = np.concatenate([c.arcs[:, :2].reshape(-1, 2), c.arcs[:1, 0]])
        weights = np.ones(len(control))
        weights[1::2] = c.weights
        spans = np.repeat(np.arange(len(c.arcs) + 1), degree)
        knots = [0, *spans, len(c.arcs)]
        curve = ss.Shape.from_nurbs(control, degree=degree, knots=knots, weights=weights)
        loops += loops_of(curve)
    return ss.Shape.from_pieces(loops)


POLYGON = ss.Shape.from_points([(0, 0), (3, -0.5), (4, 1), (3.2, 2.5), (1, 2.8), (-0.5, 1.5)])
CONVEX = {
    "polygon": POLYGON,
    "gamma1": gamma("gamma1"),
    "stadium": ss.Shape.from_svg_path("M0 0 L3 0 A1 1 0 0 1 3 2 L0 2 A1 1 0 0 1 0 0 Z"),
}


@pytest.mark.parametrize("name", CONVEX)
@examples(5)
@given(st.floats(0.01, 0.5), st.floats(0.01, 0.5))
def test_outward_of_a_convex_shape_distances_add_up(name: str, a: float, b: float) -> None:
    shape = CONVEX[name]
    tolerance = TOLERANCE * shape.size
    first = ss.offset(shape, a * shape.size, tolerance=tolerance)
    twice = ss.offset(as_shape(first), b * shape.size, tolerance=tolerance)
    once = ss.offset(shape, (a + b) * shape.size, tolerance=tolerance)
    check_same(twice, once, 2.0 * tolerance)


def region(contours: Sequence[Contour], fine: float) -> shapely.Geometry:
    """What is nearer to the inside, as a polygon: loops one in the other take turns."""
    result = shapely.Polygon()
    for contour in contours:
        # Where loops touch themselves, as gamma3 at 0 does, chords may cross.
        polygon = shapely.make_valid(shapely.Polygon(contour.points(fine)))
        result = shapely.symmetric_difference(result, polygon)
    return result


@pytest.mark.parametrize("name", NAMES)
def test_regions_of_nested_distances_are_nested(name: str) -> None:
    shape = shape_of(name)
    shares = [-0.03, -0.02, -0.0199, -0.003, 0.0, 0.003, 0.01, 0.0101, 0.05]
    tolerance = TOLERANCE * shape.size
    contours = ss.offset(shape, [share * shape.size for share in shares], tolerance=tolerance)
    regions = [
        region([c for c in contours if c.distance == share * shape.size], 0.1 * tolerance)
        for share in shares
    ]
    for inner, outer in pairwise(regions):
        assert inner.area < outer.area
        assert outer.contains(inner)


@pytest.mark.parametrize("name", NAMES)
def test_offset_by_nothing_is_the_boundary(name: str) -> None:
    shape = shape_of(name)
    tolerance = TOLERANCE * shape.size
    contours = ss.offset(shape, 0.0, tolerance=tolerance)
    deviation = 0.1 * tolerance
    rings = oracles.polylines(shape, deviation)
    boundary = oracles.filled_boundary(rings, shape.fill, snap=1e-13 * np.abs(shape.control).max())
    lines = [c.points(deviation) for c in contours]
    there = oracles.polyline_distance(boundary, points_of(contours))
    back = oracles.polyline_distance(lines, np.concatenate(boundary))
    assert max(there.max(), back.max()) <= tolerance + 2.0 * deviation
