"""A drawing's unit: 100 mm drawn are 100 mm in every file that a machine follows."""

from __future__ import annotations

from pathlib import Path

import ezdxf
import numpy as np
import pytest
from numpy.testing import assert_allclose

import splinesdf as ss
from splinesdf.io.remeasured import curves_in, measure_file
from splinesdf.io.source_frame import Told

# A part of 100 mm x 50 mm, in 378 units across: pixels of a screen.
DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
    'viewBox="0 0 378 189"><rect width="378" height="189"/></svg>'
)


@pytest.fixture
def part(tmp_path: Path) -> ss.Shape:
    (tmp_path / "part.svg").write_text(DRAWING.format(width="100mm", height="50mm"))
    return ss.read(tmp_path / "part.svg")


def sides(path: Path) -> np.ndarray:
    """The box of what is in a file."""
    points = np.concatenate(
        [curve.at(np.linspace(0.0, curve.count, 8 * curve.count + 1)) for curve in curves_in(path)]
    )
    return np.ptp(points, axis=0)


@pytest.mark.parametrize(
    ("name", "units", "millimeters"),
    [("a.dxf", None, 1.0), ("a.dxf", "inch", 25.4), ("a.nc", None, 1.0), ("a.nc", "mm", 1.0),
     ("a.nc", "inch", 25.4)],
)  # fmt: skip
@pytest.mark.parametrize("arcs", [False, True])
def test_lengths_are_what_was_drawn(
    part: ss.Shape, tmp_path: Path, name: str, units: str | None, millimeters: float, arcs: bool
) -> None:
    assert part.unit == pytest.approx(100.0 / 378.0)
    assert part.unit is not None
    distance = -2.0 / part.unit  # 2 mm
    contours = ss.offset(part, distance, tolerance=1e-3)
    assert contours[0].unit == part.unit
    ss.write(tmp_path / name, contours, units=units, arcs=arcs)
    assert_allclose(sides(tmp_path / name), [96.0 / millimeters, 46.0 / millimeters], rtol=1e-6)
    worst = measure_file(tmp_path / name, part, [distance], 1e-3, Told(units))
    assert worst.keeps(1.01e-3)
    # Told wrongly, it is seen.
    other = "mm" if units == "inch" else "inch"
    with pytest.raises(ss.InputError, match=f"expected numbers in {other}"):
        measure_file(tmp_path / name, part, [distance], 1e-3, Told(other))


@pytest.mark.parametrize(
    ("width", "height", "units", "code", "across"),
    [
        ("378mm", "189mm", None, 4, 378.0),  # a unit is a millimeter
        ("378in", "189in", None, 1, 378.0),  # an inch
        ("378cm", "189cm", None, 5, 378.0),
        ("378cm", "189cm", "mm", 4, 3780.0),
        ("100mm", "50mm", None, 4, 100.0),
        ("378", "189", None, 0, 378.0),  # not known
        ("378", "189", "mm", 4, 378.0),
    ],
)
def test_dxf_says_its_unit(
    tmp_path: Path, width: str, height: str, units: str | None, code: int, across: float
) -> None:
    (tmp_path / "a.svg").write_text(DRAWING.format(width=width, height=height))
    shape = ss.read(tmp_path / "a.svg")
    ss.write(tmp_path / "a.dxf", ss.offset(shape, 0.0, tolerance=1e-3), units=units)
    assert ezdxf.readfile(tmp_path / "a.dxf").header["$INSUNITS"] == code
    assert sides(tmp_path / "a.dxf")[0] == pytest.approx(across, rel=1e-9)
    again = ss.read(tmp_path / "a.dxf")
    if code:
        assert again.unit is not None
        assert shape.unit is None or again.size * again.unit == pytest.approx(378 * shape.unit)


def test_svg_says_its_size_in_millimeters(part: ss.Shape, tmp_path: Path) -> None:
    ss.write(tmp_path / "a.svg", ss.offset(part, -5.0, tolerance=1e-3))
    again = ss.read(tmp_path / "a.svg")
    assert again.unit == pytest.approx(part.unit, rel=1e-6)
    assert again.size == pytest.approx(368.0)


def test_contours_of_several_units_are_refused(part: ss.Shape, tmp_path: Path) -> None:
    other = ss.Shape.from_points([(0, 0), (9, 0), (9, 9)])
    contours = [ss.offset(shape, 1.0, tolerance=1e-3)[0] for shape in (part, other)]
    with pytest.raises(ss.InputError, match="contours of one unit"):
        ss.write(tmp_path / "a.dxf", contours)


@pytest.mark.parametrize("mm", [1.0 - 2e-16, 1.0 + 2e-9, 25.4 * (1.0 - 3e-9)])
def test_dxf_says_a_unit_that_is_one_but_for_printed_digits(mm: float, tmp_path: Path) -> None:
    (tmp_path / "part.svg").write_text(
        DRAWING.format(width=f"{378 * mm!r}mm", height=f"{189 * mm!r}mm")
    )
    shape = ss.read(tmp_path / "part.svg")
    contours = ss.offset(shape, 0.0)
    ss.write(tmp_path / "a.dxf", contours)
    assert ss.read(tmp_path / "a.dxf").unit == pytest.approx(round(mm, 1), rel=1e-15)
    measure_file(tmp_path / "a.dxf", shape, [0.0], 1e-3, Told(), contours)  # which asks for a unit


@pytest.mark.parametrize(("name", "said"), [("a.dxf", "$INSUNITS\n 70\n4"), ("a.nc", "G21 ")])
def test_a_file_that_lost_its_unit_is_not_measured(
    part: ss.Shape, tmp_path: Path, name: str, said: str
) -> None:
    """By a unit that is guessed, a part of the wrong size could pass."""
    assert part.unit is not None
    distance = -2.0 / part.unit
    ss.write(tmp_path / name, ss.offset(part, distance, tolerance=1e-3))
    text = (tmp_path / name).read_text()
    assert text.count(said) == 1
    (tmp_path / name).write_text(text.replace(said, said.replace("4", "0").replace("G21 ", "")))
    with pytest.raises(ss.InputError, match=f"{name}: expected a file that declares its unit"):
        measure_file(tmp_path / name, part, [distance], 1e-3)


def test_a_corner_as_origin_is_that_of_what_was_written(part: ss.Shape, tmp_path: Path) -> None:
    contours = ss.offset(part, -2.0, tolerance=1e-3)
    ss.write(tmp_path / "a.svg", contours, origin="lower-left")
    told = Told(origin="lower-left")
    assert measure_file(tmp_path / "a.svg", part, [-2.0], 1e-3, told, contours).keeps(1.01e-3)
    with pytest.raises(ss.InputError, match="expected the contours that were written"):
        measure_file(tmp_path / "a.svg", part, [-2.0], 1e-3, told)
