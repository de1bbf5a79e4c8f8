"""DXF read back by ezdxf, and compared with the arcs it was written from."""

import math
import sys
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from numpy.testing import assert_allclose

from splinesdf.contours.contour import Contour, evaluate, mirrored
from splinesdf.errors import MissingExtraError
from splinesdf.io.output import write
from splinesdf.io.remeasured import curves_in
from tests.chains import (
    circle,
    circular,
    ellipse,
    from_arc,
    line,
    mixed_chain,
    open_chain,
    slot,
    turned,
)
from tests.nearness import compare

PARAMETERS = np.linspace(0.0, 1.0, 101)


@pytest.mark.parametrize("chain", [ellipse(3.0, 1.0, (7.0, -2.0)), mixed_chain(), open_chain()])
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


@pytest.mark.parametrize("far", [0.0, 1e6])
@pytest.mark.parametrize("count", [3, 4, 9])
def test_dxf_of_a_circle_is_a_circle(tmp_path: Path, far: float, count: int) -> None:
    write(tmp_path / "a.dxf", [circular(3.0, far + 7 - 2j, 0.4, 2.0 * math.pi, count)])
    (found,) = ezdxf.readfile(tmp_path / "a.dxf").modelspace()
    assert found.dxftype() == "CIRCLE"
    assert found.dxf.radius == pytest.approx(3.0, rel=1e-12 if far == 0.0 else 1e-9)
    assert_allclose(
        [found.dxf.center.x, found.dxf.center.y], [far + 7.0, -2.0], atol=1e-12 + 1e-15 * far
    )


@pytest.mark.parametrize("first", range(8))
@pytest.mark.parametrize("flip", [False, True])
def test_dxf_of_lines_and_arcs_is_a_polyline(tmp_path: Path, first: int, flip: bool) -> None:
    chain = from_arc(slot(), first)
    write(tmp_path / "a.dxf", [turned(chain) if flip else chain])
    (found,) = ezdxf.readfile(tmp_path / "a.dxf").modelspace()
    assert found.dxftype() == "LWPOLYLINE"
    assert found.closed
    bulges = sorted(abs(bulge) for *_, bulge in found.get_points("xyb"))
    # Half turns.
    assert bulges == pytest.approx([0.0, 0.0, 1.0, 1.0], rel=1e-12)
    for part in found.virtual_entities():
        if part.dxftype() == "ARC":
            assert part.dxf.radius == pytest.approx(2.0, rel=1e-12)
            assert abs(part.dxf.center.x) == pytest.approx(2.5, rel=1e-12)
            assert part.dxf.center.y == pytest.approx(0.0, abs=1e-12)


def test_dxf_of_what_has_no_center_nearby_is_a_spline(tmp_path: Path) -> None:
    """Of a far center, or a bulge, a reader would know too few digits; a point has none."""
    radius = 1e8
    far = circular(radius, complex(-radius, 0.0), sweep=10.0 / radius, count=2)
    write(tmp_path / "a.dxf", [far, Contour(np.full((2, 3, 2), 5.0), np.ones(2))])
    arc, point = ezdxf.readfile(tmp_path / "a.dxf").modelspace()
    assert (arc.dxftype(), point.dxftype()) == ("SPLINE", "SPLINE")
    x, y, _ = np.array([tuple(p) for p in arc.construction_tool().approximate(50)]).T
    assert np.abs(x + y * y / (radius + np.hypot(radius + x, y))).max() <= 4e-16 * radius
    assert y.max() == pytest.approx(10.0)
    assert np.ptp(np.array(point.control_points), axis=0).max() == 0.0


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_dxf_of_a_single_open_arc_or_line(tmp_path: Path, way: float) -> None:
    chains = [circular(2.0, 1 + 1j, 0.3, way * 4.0, 3), line(0j, 1 + 1j, 3 + 3j)]
    write(tmp_path / "a.dxf", chains)
    arc, straight = ezdxf.readfile(tmp_path / "a.dxf").modelspace()
    assert (arc.dxftype(), straight.dxftype()) == ("ARC", "LINE")
    low, high = (math.degrees(a) for a in sorted((0.3, 0.3 + way * 4.0)))
    for found, expected in ((arc.dxf.start_angle, low), (arc.dxf.end_angle, high)):
        assert (found - expected + 180.0) % 360.0 == pytest.approx(180.0, abs=1e-12)
    assert (straight.dxf.start.x, straight.dxf.end.y) == (0.0, 3.0)
    # And as `splinesdf offset --check` reads it: counterclockwise, whichever way it was written.
    read, _ = curves_in(tmp_path / "a.dxf")
    u = np.linspace(0.0, 1.0, 41)
    angle = 0.3 + 4.0 * (u if way > 0.0 else u - 1.0)
    around = 2.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1) + 1.0
    assert_allclose(read.at(read.count * u), around, atol=1e-12)


@pytest.mark.parametrize("tolerance", [1.0, 1e-2, 1e-5])
@pytest.mark.parametrize(
    "chain", [mixed_chain(), open_chain(), ellipse(center=(1e6, 0.0)), mixed_chain(y_down=True)]
)
def test_dxf_of_arcs_is_within_the_tolerance(
    tmp_path: Path, chain: Contour, tolerance: float
) -> None:
    write(tmp_path / "a.dxf", [chain], tolerance=tolerance, arcs=True)
    (found,) = ezdxf.readfile(tmp_path / "a.dxf").modelspace()
    assert found.dxftype() == "LWPOLYLINE"
    assert found.closed == chain.closed
    points = []
    for part in found.virtual_entities():
        if part.dxftype() == "LINE":
            share = np.linspace(0.0, 1.0, 200)[:, None]
            ends = np.array([[p.x, p.y] for p in (part.dxf.start, part.dxf.end)])
            points.append(ends[0] + share * (ends[1] - ends[0]))
        else:
            low = part.dxf.start_angle
            angles = np.radians(low + np.linspace(0.0, (part.dxf.end_angle - low) % 360.0, 200))
            ring = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
            at = part.dxf.radius * ring + [part.dxf.center.x, part.dxf.center.y]
            # An arc that turns the other way is listed from its end.
            last = points[-1][-1] if points else at[0]
            points.append(at if math.dist(at[0], last) <= math.dist(at[-1], last) else at[::-1])
    compare(np.concatenate(points), mirrored(chain) if chain.y_down else chain, tolerance)


@pytest.mark.parametrize(("units", "code"), [(None, 0), ("inch", 1), ("mm", 4)])
def test_dxf_declares_units(tmp_path: Path, units: str | None, code: int) -> None:
    write(tmp_path / "a.dxf", [circle()], units=units)
    assert ezdxf.readfile(tmp_path / "a.dxf").header["$INSUNITS"] == code


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
