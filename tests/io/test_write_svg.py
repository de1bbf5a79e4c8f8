"""SVG read back by other code, and compared with the arcs it was written from."""

import math
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import svgelements
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import splinesdf as ss
from splinesdf.contours.contour import Contour, mirrored
from splinesdf.io.output import write
from splinesdf.io.writers import svg
from splinesdf.io.writers.svg import path_data
from tests.chains import (
    circle,
    circular,
    ellipse,
    from_arc,
    mixed_chain,
    open_chain,
    slot,
)
from tests.nearness import apart_from_conics, compare

SVG = "{http://www.w3.org/2000/svg}"
PARAMETERS = np.linspace(0.0, 1.0, 101)


def test_svg_of_a_circle_is_three_arcs(tmp_path: Path) -> None:
    """Of two half turns, a reader finds the centers again to half of the digits only."""
    write(tmp_path / "a.svg", [circle(radius=2.0)])
    (d,) = svg_paths(tmp_path / "a.svg")
    assert commands(d) == "MAAAZ"
    for points in read_path(d):
        # The ellipse is exact; the center that a reader computes loses an ulp or two.
        assert_allclose(np.linalg.norm(points, axis=1), 2.0, rtol=1e-14)


@pytest.mark.parametrize("y_down", [False, True])
@pytest.mark.parametrize("tolerance", [1e-1, 1e-4, 1e-8])
def test_svg_is_within_the_tolerance_and_upright(
    tmp_path: Path, y_down: bool, tolerance: float
) -> None:
    chain = mixed_chain(y_down=y_down)
    write(tmp_path / "a.svg", [chain], tolerance=tolerance)
    (d,) = svg_paths(tmp_path / "a.svg")
    assert re.fullmatch("MQLC+ALZ", commands(d))
    read = np.concatenate(read_path(d))
    drawn = chain if y_down else mirrored(chain)
    # SVG's A is found again to 1e-9 of the chord, here 55; the rest is the promise.
    assert distance_to_chain(read, drawn).max() <= tolerance + 55e-9
    assert np.array_equal(read[0], drawn.arcs[0, 0])


def test_svg_cubics_use_the_tolerance() -> None:
    """Fewer for a coarse one, and not far better than asked."""
    hyperbola = Contour(
        np.array([[[0.0, 0.0], [50.0, 80.0], [100.0, 0.0]]]), np.array([3.0]), closed=False
    )
    counts = []
    for tolerance in (1.0, 1e-2, 1e-4, 1e-6, 1e-8):
        d = path_data(hyperbola, tolerance)
        off = distance_to_chain(np.concatenate(read_path(d)), hyperbola).max()
        assert off <= tolerance
        counts.append(commands(d).count("C"))
    # Sixth order: a hundred times finer costs 100^(1/6) = 2.2 times as many, in powers of two.
    assert counts == sorted(counts)
    assert counts[0] <= 2
    assert counts[-1] <= 64


def test_cubics_that_are_not_near_enough_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    hyperbola = Contour(
        np.array([[[0.0, 0.0], [50.0, 80.0], [100.0, 0.0]]]), np.array([3.0]), closed=False
    )
    monkeypatch.setattr(svg, "_MOST_HALVINGS", 3)
    assert re.fullmatch("MC{4}", commands(path_data(hyperbola, 1e-2)))
    with pytest.raises(ss.InputError, match=r"cubics follow to 1e-08, got one .* raise the tol"):
        path_data(hyperbola, 1e-8)


@given(
    weight=st.floats(0.01, 20.0),
    x=st.floats(-3.0, 4.0),
    y=st.floats(-5.0, 5.0),
    turn=st.floats(0.0, 6.28),
    far=st.sampled_from([0.0, 1e3]),
)
# Folded onto a line, with an axis far below rounding; these overflowed, or were judged by feet that
# were missed at the tip of a fold.
@example(weight=0.01, x=1.15625, y=0.0, turn=0.0, far=0.0)
@example(weight=0.5, x=2.0, y=0.0, turn=1.4e-161, far=0.0)
@example(weight=0.5, x=2.0, y=3.9262492068128747e-227, turn=0.0, far=0.0)
# An axis far beyond the chord; an axis, and a half turn, that a reader would not find again.
@example(weight=0.9999999707251256, x=0.5, y=2.1114287798974987, turn=0.0, far=0.0)
@example(weight=0.9924161509570961, x=-0.9425302081780966, y=9.763e-05, turn=0.0, far=0.0)
@example(weight=1.2095952786750406e-09, x=0.5, y=2369422241.4021516, turn=0.0, far=0.0)
def test_any_arc_comes_back(weight: float, x: float, y: float, turn: float, far: float) -> None:
    rotation = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    arc = np.array([[[0.0, 0.0], [x, y], [1.0, 0.0]]]) @ rotation + far
    contour = Contour(arc, np.array([weight]), closed=False)
    read = np.concatenate(read_path(path_data(contour, 1e-6)))
    # A is allowed 1e-9 of the chord, cubics the tolerance.
    assert distance_to_chain(read, contour).max() <= 1.001e-6


@pytest.mark.parametrize("first", range(8))
def test_svg_merges_wherever_a_contour_begins(tmp_path: Path, first: int) -> None:
    """Two lines, and each half turn as two arcs."""
    write(tmp_path / "a.svg", [from_arc(slot(), first)])
    (d,) = svg_paths(tmp_path / "a.svg")
    assert sorted(commands(d)) == sorted("MLAALAAZ")
    for x, y in np.concatenate(read_path(d)):
        # Of radius 2 about (±2.5, 0), or on the lines between them.
        assert math.hypot(max(abs(x) - 2.5, 0.0), y) == pytest.approx(2.0, abs=1e-12)


@pytest.mark.parametrize("arcs", [False, True])
@pytest.mark.parametrize(
    "chain",
    [mixed_chain(y_down=True), slot(), ellipse(center=(1e6, 1e6)), replace(slot(), y_down=True)],
)
def test_svg_as_a_library_reads_it(tmp_path: Path, chain: Contour, arcs: bool) -> None:
    tolerance = 1e-3
    write(tmp_path / "a.svg", [chain], tolerance=tolerance, arcs=arcs)
    (d,) = svg_paths(tmp_path / "a.svg")
    path = svgelements.Path(d)
    points = [
        segment.npoint(np.linspace(0.0, 1.0, 200))
        for segment in path
        if isinstance(segment, svgelements.Curve | svgelements.Linear)
    ]
    assert (re.search("[QC]", d) is None) or not arcs
    compare(np.concatenate(points), chain if chain.y_down else mirrored(chain), tolerance)


def test_svg_groups_by_distance(tmp_path: Path) -> None:
    rings = [circle(radius=1.0 + d, distance=d) for d in (0.5, -0.5, 0.0)] + [
        circle(center=(5.0, 0.0), distance=0.5)
    ]
    write(tmp_path / "a.svg", rings)
    groups = ElementTree.parse(tmp_path / "a.svg").getroot().findall(f"{SVG}g/{SVG}g")
    found = {float(g.attrib["data-distance"]): len(g.findall(f"{SVG}path")) for g in groups}
    assert found == {-0.5: 1, 0.0: 1, 0.5: 2}


def test_svg_view_holds_everything_with_a_margin(tmp_path: Path) -> None:
    write(tmp_path / "a.svg", [circle(radius=10.0, center=(30.0, 100.0))])
    root = ElementTree.parse(tmp_path / "a.svg").getroot()
    x, y, width, height = map(float, root.attrib["viewBox"].split())
    assert 19.0 <= x - -0.5 <= 20.0 <= 40.0 <= x + width <= 42.0
    assert -112.0 <= y <= -110.0 < -90.0 <= y + height <= -88.0


@pytest.mark.parametrize("radius", [1e6, 1e8])
def test_an_arc_whose_center_is_far_away_is_a_cubic(radius: float) -> None:
    """Of its center a reader would know too few digits."""
    arc = circular(radius, complex(-radius, 0.0), sweep=10.0 / radius, count=2)
    d = path_data(arc, 1e-12)
    assert commands(d) == "MCC"
    x, y = np.concatenate(read_path(d)).T
    assert np.abs(x + y * y / (radius + np.hypot(radius + x, y))).max() <= 4e-16 * radius
    assert y.max() == pytest.approx(10.0)


@pytest.mark.parametrize(("weight", "x", "y"), [(0.5, -1.0, 1e-8), (0.5, 2.0, -1e-8)])
def test_an_ellipse_that_a_reader_misses_is_a_cubic(weight: float, x: float, y: float) -> None:
    """It is thin: read from A, it was off by 1.8e-8."""
    contour = Contour(
        np.array([[[0.0, 0.0], [x, y], [1.0, 0.0]]]), np.array([weight]), closed=False
    )
    d = path_data(contour, 1e-9)
    assert re.fullmatch("MC+", commands(d))
    assert distance_to_chain(np.concatenate(read_path(d)), contour).max() <= 2e-9


def test_a_contour_that_is_a_point_draws_nothing(tmp_path: Path) -> None:
    point = Contour(np.full((2, 3, 2), 5.0), np.ones(2))
    write(tmp_path / "a.svg", [circle(), point])
    assert svg_paths(tmp_path / "a.svg")[1] == "M5 -5"
    shape = ss.read(tmp_path / "a.svg")
    assert shape.loop_count == 1
    assert shape.box == pytest.approx((-1.0, -1.0, 1.0, 1.0))


def test_an_open_contour_is_not_closed_in_svg(tmp_path: Path) -> None:
    write(tmp_path / "a.svg", [open_chain()])
    (d,) = svg_paths(tmp_path / "a.svg")
    assert "Z" not in d


# --- an own, independent reading of SVG ----------------------------------------------------------


def svg_paths(path: Path) -> list[str]:
    return [p.attrib["d"] for p in ElementTree.parse(path).getroot().iter(f"{SVG}path")]


def commands(d: str) -> str:
    return "".join(re.findall("[MLQCAZ]", d))


def read_path(d: str) -> list[np.ndarray]:
    """Dense points of every segment of a path of absolute M L Q C A Z."""
    segments = []
    here = np.zeros(2)
    for command, rest in re.findall(r"([MLQCAZ])([^MLQCAZ]*)", d):
        numbers = [float(n) for n in rest.split()]
        if command in "LQC":
            control = np.array([*here, *numbers]).reshape(-1, 2)
            segments.append(bezier(control))
        elif command == "A":
            segments.append(elliptic(here, numbers))
        if numbers:
            here = np.array(numbers[-2:])
    return segments


def bezier(control: np.ndarray) -> np.ndarray:
    degree = len(control) - 1
    t = PARAMETERS[:, None]
    return sum(
        math.comb(degree, k) * t**k * (1 - t) ** (degree - k) * control[k]
        for k in range(degree + 1)
    )


def elliptic(start: np.ndarray, numbers: list[float]) -> np.ndarray:
    """SVG 1.1, appendix F.6.5 and F.6.6, step by step with complex numbers."""
    rx, ry, degrees, large, sweep, x, y = numbers
    turn = complex(math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))
    first, last = complex(*start), complex(x, y)
    half = (first - last) / 2 / turn
    u, v = half.real / rx, half.imag / ry
    if u * u + v * v > 1.0:  # radii too small: scaled up
        scale = math.hypot(u, v)
        rx, ry, u, v = rx * scale, ry * scale, u / scale, v / scale
    root = math.sqrt(max(0.0, 1.0 / (u * u + v * v) - 1.0))
    if large == sweep:
        root = -root
    cx, cy = root * v, -root * u
    a, b = math.atan2(v - cy, u - cx), math.atan2(-v - cy, -u - cx)
    swept = (b - a) % (2 * math.pi)
    if not sweep:
        swept -= 2 * math.pi
    angles = a + swept * PARAMETERS
    center = (first + last) / 2 + turn * complex(cx * rx, cy * ry)
    points = center + turn * (rx * np.cos(angles) + 1j * ry * np.sin(angles))
    return np.stack([points.real, points.imag], axis=1)


def distance_to_chain(points: np.ndarray, chain: Contour) -> np.ndarray:
    return apart_from_conics(points, chain.arcs, chain.weights)
