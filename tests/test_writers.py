"""Files are read back by other code and compared with the arcs they were written from."""

import json
import math
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from splinesdf.contour import Contour, evaluate, mirrored
from splinesdf.errors import InputError, MissingExtraError
from splinesdf.io.output import write
from splinesdf.io.writers.svg import path_data
from tests.chains import circle, mixed_chain, open_chain

SVG = "{http://www.w3.org/2000/svg}"
PARAMETERS = np.linspace(0.0, 1.0, 101)


# --- SVG ---------------------------------------------------------------------------------------


def test_svg_of_a_circle_is_four_elliptic_arcs(tmp_path: Path) -> None:
    write(tmp_path / "a.svg", [circle(radius=2.0)])
    (d,) = svg_paths(tmp_path / "a.svg")
    assert commands(d) == "MAAAAZ"
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
        d = path_data(hyperbola, tolerance, rounding=0.0)
        off = distance_to_chain(np.concatenate(read_path(d)), hyperbola).max()
        assert off <= tolerance
        counts.append(commands(d).count("C"))
    # Sixth order: a hundred times finer costs 100^(1/6) = 2.2 times as many, in powers of two.
    assert counts == sorted(counts)
    assert counts[0] <= 2
    assert counts[-1] <= 64


@given(
    weight=st.floats(0.01, 20.0),
    x=st.floats(-3.0, 4.0),
    y=st.floats(-5.0, 5.0),
    turn=st.floats(0.0, 6.28),
    far=st.sampled_from([0.0, 1e3]),
)
def test_any_arc_comes_back(weight: float, x: float, y: float, turn: float, far: float) -> None:
    rotation = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    arc = np.array([[[0.0, 0.0], [x, y], [1.0, 0.0]]]) @ rotation + far
    contour = Contour(arc, np.array([weight]), closed=False)
    rounding = 4.0 * np.finfo(np.float64).eps * float(np.abs(arc).max())
    read = np.concatenate(read_path(path_data(contour, 1e-6, rounding=rounding)))
    # A is allowed 1e-9 of the chord, cubics the tolerance.
    assert distance_to_chain(read, contour).max() <= 1.001e-6


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


def test_an_open_contour_is_not_closed_in_svg(tmp_path: Path) -> None:
    write(tmp_path / "a.svg", [open_chain()])
    (d,) = svg_paths(tmp_path / "a.svg")
    assert "Z" not in d


# --- DXF ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("chain", [circle(3.0, (7.0, -2.0)), mixed_chain(), open_chain()])
def test_dxf_is_exact(tmp_path: Path, chain: Contour) -> None:
    write(tmp_path / "a.dxf", [chain])
    (spline,) = ezdxf.readfile(tmp_path / "a.dxf").modelspace()
    assert spline.dxftype() == "SPLINE"
    assert spline.dxf.degree == 2
    assert spline.closed == chain.closed
    curve = spline.construction_tool()
    count = len(chain.arcs)
    assert curve.max_t == count
    for index in range(count):
        # Another algorithm (de Boor) for the same curve: a few ulp of coordinates below 100.
        read = np.array([(p.x, p.y) for p in curve.points(index + PARAMETERS)])
        expected = evaluate(
            chain.arcs[index : index + 1], chain.weights[index : index + 1], PARAMETERS
        )
        assert_allclose(read, expected[0], atol=1e-12, rtol=0.0)


def test_dxf_is_upright_layered_and_without_a_unit(tmp_path: Path) -> None:
    chains = [mixed_chain(y_down=True, distance=-2.0), mixed_chain(distance=0.25)]
    write(tmp_path / "a.dxf", chains)
    document = ezdxf.readfile(tmp_path / "a.dxf")
    assert document.header["$INSUNITS"] == 0
    assert not document.audit().errors
    mirrored_one, plain = document.modelspace()
    assert (mirrored_one.dxf.layer, plain.dxf.layer) == ("distance_-2.0", "distance_0.25")
    assert {"distance_-2.0", "distance_0.25"} <= {layer.dxf.name for layer in document.layers}
    assert_allclose(np.array(mirrored_one.control_points)[2, :2], [40.0, 0.0])
    assert_allclose(np.array(mirrored_one.control_points)[5, :2], [75.0, -45.0])
    assert_allclose(np.array(plain.control_points)[5, :2], [75.0, 45.0])


def test_dxf_without_ezdxf_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "ezdxf.filemanagement", None)
    with pytest.raises(MissingExtraError, match=r'pip install "splinesdf\[dxf\]"'):
        write(tmp_path / "a.dxf", [circle()])
    assert not (tmp_path / "a.dxf").exists()


# --- polylines ---------------------------------------------------------------------------------


def test_geojson(tmp_path: Path) -> None:
    chains = [mixed_chain(), open_chain()]
    write(tmp_path / "a.geojson", chains, tolerance=1e-3)
    collection = json.loads((tmp_path / "a.geojson").read_text())
    assert collection["type"] == "FeatureCollection"
    properties = [feature["properties"] for feature in collection["features"]]
    assert properties == [
        {"distance": -0.5, "closed": True},
        {"distance": -0.5, "closed": False},
    ]
    shapes = [shapely.geometry.shape(f["geometry"]) for f in collection["features"]]
    assert [shape.is_ring for shape in shapes] == [True, False]
    # A polyline within 1e-3 everywhere misses at most length times that of the area.
    area = shapely.Polygon(shapes[0]).area
    assert area == pytest.approx(chains[0].area, abs=1e-3 * chains[0].length)


def test_wkt(tmp_path: Path) -> None:
    chains = [circle(2.0), open_chain()]
    write(tmp_path / "a.wkt", chains, tolerance=1e-5)
    ring, line = (shapely.from_wkt(s) for s in (tmp_path / "a.wkt").read_text().splitlines())
    assert isinstance(ring, shapely.Polygon)
    assert isinstance(line, shapely.LineString)
    # Inscribed, so smaller; by at most length times tolerance.
    assert 0.0 <= 4.0 * math.pi - ring.area <= 4.0 * math.pi * 1e-5


def test_csv(tmp_path: Path) -> None:
    chains = [circle(2.0, distance=0.1), mixed_chain()]
    write(tmp_path / "a.csv", chains, tolerance=1e-2)
    with (tmp_path / "a.csv").open() as file:
        assert file.readline() == "contour,distance,x,y\n"
    table = np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1)
    for number, chain in enumerate(chains):
        rows = table[table[:, 0] == number]
        assert set(rows[:, 1]) == {chain.distance}
        assert np.array_equal(rows[:, 2:], chain.points(1e-2))


# --- what cannot be written --------------------------------------------------------------------


@pytest.mark.parametrize("name", ["a.nc", "a", "a.svg.bak"])
def test_an_unknown_extension_names_what_exists(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"\.csv, \.dxf, \.geojson, .*\.svg, \.wkt, got") as caught:
        write(tmp_path / name, [circle()])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("contours", "message"),
    [([], "got none"), (circle(), "put it in brackets"), ([np.zeros(2)], "got ndarray in it")],
)
def test_only_a_list_of_contours_can_be_written(
    tmp_path: Path, contours: list[Contour], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        write(tmp_path / "a.svg", contours)
    assert list(tmp_path.iterdir()) == []


def test_a_point_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a single point"):
        write(tmp_path / "a.csv", [Contour(np.ones((1, 3, 2)), np.ones(1))])


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.nan, 1e-20])
@pytest.mark.parametrize("name", ["a.svg", "a.csv", "a.dxf"])
def test_a_bad_tolerance_is_refused_for_every_format(
    tmp_path: Path, name: str, tolerance: float
) -> None:
    with pytest.raises(InputError, match="tolerance"):
        write(tmp_path / name, [circle()], tolerance=tolerance)


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
    """Distances to the nearest arc: from samples, then by golden-section search."""
    best = np.full(len(points), np.inf)
    grid = np.linspace(0.0, 1.0, 401)
    golden = (math.sqrt(5.0) - 1.0) / 2.0
    for arc, weight in zip(chain.arcs, chain.weights, strict=True):

        def off(t: np.ndarray, arc: np.ndarray = arc, weight: float = weight) -> np.ndarray:
            t = t[:, None]
            top = (1 - t) ** 2 * arc[0] + 2 * weight * t * (1 - t) * arc[1] + t**2 * arc[2]
            return np.linalg.norm(
                top / ((1 - t) ** 2 + 2 * weight * t * (1 - t) + t**2) - points, axis=1
            )

        samples = evaluate(arc[None], np.array([weight]), grid)[0]
        apart = np.linalg.norm(points[:, None] - samples, axis=2)
        wide = np.pad(apart, ((0, 0), (1, 1)), constant_values=np.inf)
        dips = np.where((apart <= wide[:, :-2]) & (apart <= wide[:, 2:]), apart, np.inf)
        # A hairpin passes a point twice, and the sample that looks nearer need not be.
        for nearest in np.argsort(dips, axis=1)[:, :3].T:
            low, high = grid[np.maximum(nearest - 1, 0)], grid[np.minimum(nearest + 1, 400)]
            for _ in range(60):
                left, right = high - golden * (high - low), low + golden * (high - low)
                closer = off(left) < off(right)
                low, high = np.where(closer, low, left), np.where(closer, right, high)
            best = np.minimum(best, np.minimum(off(low), off(high)))
    return best
