"""A saved fit comes back to the bit; a damaged one is refused in one line."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from tests.shapes import UNIT, gamma


@pytest.mark.parametrize("space", ["hierarchical", "tensor", "uniform"])
def test_save_and_load_give_the_same_spline(space: str, tmp_path: Path) -> None:
    spline = ss.fit(gamma("gamma2"), tolerance=0.02, space=space, domain=UNIT).spline
    spline.save(tmp_path / "fit.npz")
    loaded = ss.load(tmp_path / "fit.npz")
    points = np.random.default_rng(1).uniform(-0.1, 1.1, (5000, 2))
    assert np.array_equal(spline(points), loaded(points), equal_nan=True)
    assert np.array_equal(spline.gradient(points), loaded.gradient(points), equal_nan=True)
    assert (loaded.name, loaded.y_down, loaded.domain) == ("gamma2", False, spline.domain)
    for one, other in zip(spline.contours(0.05), loaded.contours(0.05), strict=True):
        assert np.array_equal(one.arcs, other.arcs)


@pytest.fixture(scope="module")
def fields(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    path = tmp_path_factory.mktemp("fit") / "fit.npz"
    ss.fit(gamma("gamma1"), tolerance=0.05).spline.save(path)
    with np.load(path) as stored:
        return dict(stored)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"version": np.array(2)}, "update splinesdf"),
        ({"format": np.array("other")}, "another .npz"),
        ({"domain": np.array([0.0, 0.0, -1.0, 1.0])}, "domain"),
        ({"domain": np.array([0.0, 0.0, np.nan, 1.0])}, "finite"),
        ({"split": np.zeros(3, dtype=bool)}, "too few"),
        ({"split": np.zeros(10_000, dtype=bool)}, "too many"),
        ({"shape": np.array([0, 4])}, "at least one cell"),
        ({"ordinates": np.zeros((3, 8))}, "ordinates"),
        ({"ordinates": np.zeros((3, 8), dtype=complex)}, "ordinates"),
        ({"y_down": np.array("yes")}, "y_down"),
        ({"extra": np.array(1)}, "fields"),
    ],
)
def test_tampered_files_are_refused(
    fields: dict[str, np.ndarray], change: dict[str, np.ndarray], message: str, tmp_path: Path
) -> None:
    path = tmp_path / "fit.npz"
    np.savez(path, **{**fields, **change})
    with pytest.raises(ss.InputError, match=message) as caught:
        ss.load(path)
    assert "\n" not in str(caught.value)


def test_pickled_objects_are_not_run(fields: dict[str, np.ndarray], tmp_path: Path) -> None:
    np.savez(tmp_path / "fit.npz", **{**fields, "name": np.array([print], dtype=object)})
    with pytest.raises(ss.InputError, match="another file or damaged"):
        ss.load(tmp_path / "fit.npz")


def test_cut_and_foreign_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "fit.npz"
    ss.fit(gamma("gamma1"), tolerance=0.05).spline.save(path)
    whole = path.read_bytes()
    for length in range(0, len(whole), max(1, len(whole) // 40)):
        path.write_bytes(whole[:length])
        with pytest.raises(ss.InputError, match="damaged"):
            ss.load(path)
    path.write_bytes(b"x,y\n0,0\n")
    with pytest.raises(ss.InputError, match="damaged"):
        ss.load(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "hello")
    with pytest.raises(ss.InputError, match="another"):
        ss.load(path)
    with pytest.raises(ss.InputError, match="does not exist"):
        ss.load(tmp_path / "missing.npz")
    with pytest.raises(ss.InputError, match="folder"):
        ss.load(tmp_path)


def test_flipped_bytes_give_a_fit_or_one_line(tmp_path: Path) -> None:
    path = tmp_path / "fit.npz"
    ss.fit(gamma("gamma1"), tolerance=0.05).spline.save(path)
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    refused = 0
    for _ in range(200):
        broken = bytearray(whole)
        broken[rng.integers(len(broken))] ^= 1 << int(rng.integers(8))
        path.write_bytes(broken)
        try:
            ss.load(path)
        except ss.InputError:
            refused += 1
    assert refused > 150  # the zip's checksums see nearly all of them
