"""What all writers have in common: what they refuse, and that they write all or nothing."""

import math
import os
from pathlib import Path

import numpy as np
import pytest

from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError
from splinesdf.io.output import write
from splinesdf.io.remeasured import curves_in
from splinesdf.io.writers.milling import Milling
from tests.chains import (
    circle,
    mixed_chain,
)


@pytest.mark.parametrize("name", ["a.ncc", "a", "a.svg.bak"])
def test_an_unknown_extension_names_what_exists(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"\.csv, \.dxf, .*\.nc, .*\.wkt, got") as caught:
        write(tmp_path / name, [circle()])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("contours", "message"),
    [([], "got none"), (3.0, "got float"), ([np.zeros(2)], "got ndarray in it")],
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


@pytest.mark.parametrize("name", ["a.svg", "a.csv", "a.wkt", "a.geojson", "a.dxf", "a.nc"])
@pytest.mark.parametrize(
    ("option", "used_by"),
    [
        ({"arcs": True}, {"a.svg", "a.dxf", "a.nc"}),
        ({"units": "mm"}, {"a.dxf", "a.nc"}),
        ({"milling": Milling()}, {"a.nc"}),
    ],
)
def test_options_that_a_format_cannot_use_are_refused(
    tmp_path: Path, name: str, option: dict[str, object], used_by: set[str]
) -> None:
    if name in used_by:
        write(tmp_path / name, [circle()], **option)
        return
    (word,) = option
    with pytest.raises(InputError, match=f"expected {word} only for .*: leave it out") as caught:
        write(tmp_path / name, [circle()], **option)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_options_of_the_wrong_kind_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="mm or inch for units, got 'cm'"):
        write(tmp_path / "a.nc", [circle()], units="cm")
    with pytest.raises(InputError, match="expected a Milling for milling, got dict"):
        write(tmp_path / "a.nc", [circle()], milling={"feed": 3})


@pytest.mark.parametrize("name", ["a.svg", "a.csv", "a.wkt", "a.geojson", "a.dxf", "a.nc"])
def test_what_fails_leaves_the_old_file(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path / name, [circle()])
    before = (tmp_path / name).read_bytes()

    def interrupted(file: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write(tmp_path / name, [mixed_chain()])
    assert (tmp_path / name).read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("name", ["a.svg", "a.csv", "a.wkt", "a.geojson", "a.dxf", "a.nc"])
def test_a_small_contour_far_away_is_written_without_a_tolerance(tmp_path: Path, name: str) -> None:
    """Regression: a millionth of its size, the default, was below rounding and refused."""
    write(tmp_path / name, [circle(1e-2, (1e8, -1e8))])
    (curve,) = curves_in(tmp_path / name)
    center = [1e8, 1e8 if name == "a.svg" else -1e8]
    off = np.hypot(*(curve.at(np.linspace(0.0, curve.count, 200)) - center).T) - 1e-2
    # 64 ulp of the coordinates, where 16 are the tolerance.
    assert np.abs(off).max() <= 64 * np.finfo(float).eps * 1e8
