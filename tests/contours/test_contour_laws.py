"""What is asked of a contour and what is written of it is the same wherever it lies.

Contours of lines, circular arcs, other conics and folds, of any size, moved by up to 1e8: points,
length, area, circular arcs and files are those at home, moved, within the tolerance and the
rounding of the coordinates there.
"""

import cmath
import math
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.contours.conics import Kind, classify
from splinesdf.contours.contour import Contour
from splinesdf.io.remeasured import curves_in
from tests.chains import circular, joined, line
from tests.examples import examples
from tests.nearness import apart, apart_from_conics, apart_from_line, dense

EPS = float(np.finfo(np.float64).eps)
FORMATS = ["a.svg", "a.dxf", "a.nc", "a.geojson", "a.wkt", "a.csv"]
# What may be lost far away: so many ulp of the largest coordinate. Control points are rounded when
# they are moved, arcs are merged within sixteen, points computed with a few.
ULPS = 64.0

angles = st.floats(-math.pi, math.pi)
weights = st.one_of(
    st.floats(-3.0, 3.0).map(lambda power: 10.0**power),
    st.sampled_from([1.0, 0.5, math.sqrt(0.5), 0.01, 1.0 + 1e-12, 1.0 - 1e-9]),
)
# Zero, of the size of rounding, far below it, and any.
flatness = st.one_of(
    st.just(0.0),
    st.floats(-320.0, 0.0).map(lambda power: 10.0**power),
    st.floats(-17.0, -5.0).map(lambda power: -(10.0**power)),
)


def conic(x: float, y: float, weight: float) -> Contour:
    """From 0 to 1."""
    return Contour(np.array([[[0.0, 0.0], [x, y], [1.0, 0.0]]]), np.array([weight]), closed=False)


def arc_of(sweep: float) -> Contour:
    """A circular arc from 0 to 1."""
    radius = 0.5 / math.sin(0.5 * abs(sweep))
    count = max(1, math.ceil(abs(sweep) / 2.0))
    center = complex(0.5, math.copysign(radius * math.cos(0.5 * sweep), sweep))
    result = circular(radius, center, cmath.phase(-center), sweep, count)
    return result


pieces = st.one_of(
    st.just(line(0j, 1 + 0j)),
    st.builds(
        arc_of, st.one_of(st.floats(0.01, 6.0), st.floats(-6.0, -0.01), st.floats(1e-9, 1e-3))
    ),
    st.builds(conic, st.floats(-2.0, 3.0), st.floats(-3.0, 3.0), weights),
    st.builds(conic, st.floats(-2.0, 3.0), flatness, weights),
)


@st.composite
def contours(draw: st.DrawFn) -> Contour:
    """Pieces one after the other, of various sizes and directions, and maybe a line back."""
    parts, at = [], 0j
    for part in draw(st.lists(pieces, min_size=1, max_size=4)):
        way = cmath.rect(10.0 ** draw(st.sampled_from([0.0, 0.0, -1.0, -3.0])), draw(angles))
        placed = at + way * (part.arcs @ [1.0, 1j])
        arcs = np.stack([placed.real, placed.imag], axis=-1)
        parts.append(replace(part, arcs=arcs))
        at = complex(placed[-1, 2])
    closed = draw(st.booleans())
    if closed:
        parts.append(line(at, 0j))
    size = 10.0 ** draw(st.sampled_from([0, 0, -6, -3, 3]))
    chain = joined(*parts, closed=closed)
    return replace(chain, arcs=size * chain.arcs)


ways = st.builds(
    lambda power, angle: cmath.rect(0.0 if power is None else 10.0**power, angle),
    st.sampled_from([None, 3, 4, 5, 6, 7, 8]),
    st.sampled_from([0.0, 0.5 * math.pi, 0.7, -2.3]),
)
tolerances = st.sampled_from([1e-2, 1e-4, 1e-6, 1e-8])


class Moved:
    """A contour at home and far away."""

    def __init__(self, home: Contour, way: complex, share: float) -> None:
        self.home = home
        self.way = np.array([way.real, way.imag])
        self.far = replace(home, arcs=home.arcs + self.way)
        # A contour below an ulp is a point there, which is refused.
        assume(np.ptp(self.far.arcs, axis=(0, 1)).max() > 0.0)
        self.largest = float(np.abs(self.far.arcs).max())
        self.size = float(np.ptp(home.arcs.reshape(-1, 2), axis=0).max())
        # Below rounding a tolerance is refused.
        self.tolerance = max(share * self.size, 17.0 * EPS * self.largest)
        self.allowed = self.tolerance + ULPS * EPS * self.largest

    def check(self, points: np.ndarray, line: np.ndarray, sag: float) -> None:
        """Points that are to be on the contour, and a polyline that is to pass all of it."""
        back = points - self.way
        # By roots where points are few, else by a polyline.
        if len(back) <= 400:
            off = apart_from_conics(back, self.home.arcs, self.home.weights)
            assert off.max() <= self.allowed
        else:
            fine = 0.01 * self.allowed
            assert apart(back, self.home, fine).max() <= self.allowed + fine
        missed = apart_from_line(dense(self.home), line - self.way)
        assert missed.max() <= self.allowed + sag


@given(contours(), ways, tolerances)
def test_points(home: Contour, way: complex, share: float) -> None:
    moved = Moved(home, way, max(share, 1e-6))
    points = moved.far.points(moved.tolerance)
    assert np.array_equal(points[[0, -1]], moved.far.arcs[[0, -1], [0, 2]])
    moved.check(points, points, 0.0)


@given(contours(), ways)
def test_length_and_area(home: Contour, way: complex) -> None:
    moved = Moved(home, way, 1.0)
    # What is left of the contour when its control points are rounded far away, back again: the
    # differences of close numbers are exact.
    origin = moved.far.arcs[0, 0]
    back = replace(home, arcs=moved.far.arcs - origin)
    reach = float(np.abs(back.arcs).max())
    sides = np.linalg.norm(np.diff(back.arcs, axis=1), axis=2).sum()
    # Both go with the control points; sixteen Gauss points on hundreds of parts add a few ulp.
    rounding = 2e-13
    assert moved.far.length == pytest.approx(back.length, abs=rounding * sides)
    assert moved.far.area == pytest.approx(back.area, abs=rounding * sides * reach)
    # And the curve itself is moved by no more than its control points: by half an ulp each.
    off = EPS * moved.largest
    assert moved.far.area == pytest.approx(
        home.area, abs=(rounding * reach + 4.0 * off) * (sides + off)
    )


@examples(50)
@given(contours(), ways, tolerances)
def test_circular_arcs(home: Contour, way: complex, share: float) -> None:
    moved = Moved(home, way, share)
    result = ss.as_arcs(moved.far, tolerance=moved.tolerance)
    assert result.closed == home.closed
    assert np.array_equal(result.arcs[0, 0], moved.far.arcs[0, 0])
    assert np.array_equal(result.arcs[-1, 2], moved.far.arcs[-1, 2])
    found = classify(result.arcs, result.weights, 16.0 * EPS * moved.largest)
    assert set(found.kind.tolist()) <= {Kind.LINE, Kind.CIRCLE}
    fine = replace(result, arcs=result.arcs - moved.way).points(0.01 * moved.allowed)
    moved.check(dense(result, max(3, 400 // len(result.arcs))), fine + moved.way, moved.allowed)


def test_an_arc_on_its_own_way_back_has_circular_arcs() -> None:
    # Found at random: the weight of a half of it is zero, as it ends where it starts.
    p1 = np.array([-0.18486048, 0.0763322])
    home = Contour(
        np.array([[[0.0, 0.0], p1, 0.5 * p1]]), np.ones(1), closed=False, distance=0.0, y_down=False
    )
    result = ss.as_arcs(home, tolerance=2e-3)
    assert apart_from_conics(dense(result), home.arcs, home.weights).max() <= 2e-3


@examples(100)
@given(contours(), ways, tolerances, st.sampled_from(FORMATS), st.booleans())
def test_files(home: Contour, way: complex, share: float, name: str, arcs: bool) -> None:
    moved = Moved(home, way, max(share, 1e-6) if name[2] in "gwc" else share)
    # Within the tolerance of a point it is one in a program, and nothing to mill.
    assume(name != "a.nc" or moved.size > moved.tolerance)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / name
        arcs = arcs and name in ("a.svg", "a.dxf", "a.nc")
        ss.write(file, [moved.far], tolerance=moved.tolerance, arcs=arcs)
        (curve,) = curves_in(file)
    at = np.linspace(0.0, curve.count, 12 * curve.count + 1)
    points = curve.at(at)
    # Until no chord is longer than a thousandth of the whole, which then bulges by less than 1e-6
    # of the radius of an arc of a quarter turn.
    for _ in range(12):
        long = np.flatnonzero(np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-3 * moved.size)
        if not len(long) or len(at) > 20000:
            break
        at = np.insert(at, long + 1, 0.5 * (at[long] + at[long + 1]))
        points = curve.at(at)
    if name == "a.svg":
        points = points * [1.0, -1.0]
    moved.check(points[:: max(1, len(points) // 3000)], points, 1e-3 * moved.size)


# --- what was once wrong -------------------------------------------------------------------------
