"""A spline as .vtu, read back by meshio; what has no use or no place there is refused."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid
from splinesdf.splines.triangles import Triangles
from tests.named_shapes import UNIT, gamma
from tests.triangle_meshes import at_random, check_conforming


@pytest.fixture(scope="module")
def spline() -> ss.SplineSDF:
    return ss.fit(gamma("gamma2"), tolerance=0.01).spline


def test_meshio_reads_the_spline(spline: ss.SplineSDF, tmp_path: Path) -> None:
    ss.write(tmp_path / "field.VTU", spline)
    read = meshio.read(tmp_path / "field.VTU", file_format="vtu")
    (cells,) = read.cells
    assert cells.type == "triangle6"
    assert read.points.shape[1] == 3
    assert not read.points[:, 2].any()
    values = read.point_data["distance"]
    assert (read.points.dtype, values.dtype) == (np.float64, np.float64)
    mesh = Triangles(read.points[:, :2], cells.data, values)
    check_conforming(mesh, spline.domain)
    points, inside = at_random(mesh, 100_000)
    assert np.max(np.abs(inside - spline(points))) <= 1e-13
    at_nodes = spline(read.points[:, :2], outside="nan")
    assert np.max(np.abs(at_nodes - values)) <= 1e-13
    made = spline.made
    assert made is not None
    assert {name: float(value[0]) for name, value in read.field_data.items()} == {
        "error": made.error,
        "bound": made.bound,
    }


def test_meshio_reads_a_quartic_spline(tmp_path: Path) -> None:
    quartic = ss.fit(gamma("gamma2"), tolerance=0.02, element="quartic").spline
    ss.write(tmp_path / "field.vtu", quartic)
    read = meshio.read(tmp_path / "field.vtu")
    (cells,) = read.cells
    assert cells.type == "VTK_LAGRANGE_TRIANGLE"
    assert np.array_equal(cells.data, quartic.triangles().triangles)
    at_nodes = quartic(read.points[:, :2], outside="nan")
    assert np.max(np.abs(at_nodes - read.point_data["distance"])) <= 1e-13


def test_the_file_is_xml_of_quadratic_triangles(tmp_path: Path) -> None:
    spline = ss.SplineSDF(Grid.uniform(UNIT, 2, 3), np.zeros((6, 8)), name="<&\0 ]]>")
    ss.write(tmp_path / "field.vtu", spline)
    root = ElementTree.fromstring((tmp_path / "field.vtu").read_text("ascii"))
    assert root.attrib["byte_order"] == "LittleEndian"
    (piece,) = root.iter("Piece")
    # 12 vertices, 6 centers, 17 sides, 24 half-diagonals.
    assert piece.attrib == {"NumberOfPoints": "59", "NumberOfCells": "24"}
    assert [node.tag for node in root.iter("FieldData")] == []  # nothing is known of it
    cells = {array.attrib["Name"]: decoded(array) for array in root.find(".//Cells") or ()}
    assert cells["offsets"].tolist() == list(range(6, 24 * 6 + 1, 6))
    assert cells["types"].tolist() == [22] * 24
    wanted = spline.triangles().triangles.ravel()
    assert np.array_equal(cells["connectivity"], wanted)
    assert meshio.read(tmp_path / "field.vtu").cells[0].data.shape == (24, 6)


def decoded(array: ElementTree.Element) -> np.ndarray:
    """What VTK's XML says is in base64: the number of bytes, then these."""
    assert array.attrib["format"] == "binary"
    data = base64.b64decode(array.text or "")
    assert int.from_bytes(data[:8], "little") == len(data) - 8
    kinds = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}
    return np.frombuffer(data[8:], dtype=kinds[array.attrib["type"]])


@pytest.mark.parametrize(
    "option",
    [
        {"tolerance": 0.1},
        {"tolerance": 0.0},
        {"arcs": True},
        {"units": "mm"},
        {"milling": ss.Milling()},
    ],
)
def test_options_of_contours_are_refused(
    spline: ss.SplineSDF, tmp_path: Path, option: dict[str, Any]
) -> None:
    with pytest.raises(ss.InputError, match=rf"{next(iter(option))} only for contours, .*\.vtu"):
        ss.write(tmp_path / "field.vtu", spline, **option)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.dxf", r"expected contours for \.dxf, got a spline: .*spline\.contours\(0\.0\).*\.vtu"),
        ("a.svg", r"spline\.contours"),
        ("a.nc", r"spline\.contours"),
        ("a.npz", r"spline\.save"),
        ("a.JSON", r"spline\.save"),
        ("a.vtk", r"ending in \.glsl, \.vtu, \.wgsl"),
        ("a", r"ending in \.glsl, \.vtu, \.wgsl"),
        ("no/a.vtu", "does not exist"),
    ],
)
def test_other_files_are_refused(
    spline: ss.SplineSDF, tmp_path: Path, name: str, message: str
) -> None:
    with pytest.raises(ss.InputError, match=message) as caught:
        ss.write(tmp_path / name, spline)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_what_has_no_field_is_refused(spline: ss.SplineSDF, tmp_path: Path) -> None:
    (tmp_path / "a.vtu").write_text("old")
    result = ss.fit(gamma("gamma2"), tolerance=0.1)
    for given, message in (
        (spline.contours(0.0), r"expected a spline for \.vtu, got none"),
        (result, r"expected a spline for \.vtu, got none"),
        (7, r"expected a spline for \.vtu, got none"),
    ):
        with pytest.raises(ss.InputError, match=message):
            ss.write(tmp_path / "a.vtu", given)  # type: ignore[arg-type]
    assert (tmp_path / "a.vtu").read_text() == "old"
    with pytest.raises(ss.InputError, match="contours or a spline, got FitResult"):
        ss.write(tmp_path / "a.svg", result)  # type: ignore[arg-type]
