"""A saved fit comes back to the bit, with its shape and with what it says of itself."""

from __future__ import annotations

import dataclasses
import itertools
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.meshes import Grid, Quadtree
from splinesdf.splines.provenance import Provenance, this_version
from splinesdf.splines.spline import SplineSDF
from tests.naive_tree import refine
from tests.named_shapes import UNIT, gamma
from tests.saving import MADE, before_line, fields_of, fit_with_shape, full_tree, two_loops

VERSION_1 = Path(__file__).parents[1] / "data" / "saved_version_1.npz"


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


def test_the_shape_comes_back_to_the_bit(tmp_path: Path) -> None:
    shape = two_loops()
    fit_with_shape().save(tmp_path / "fit.npz")
    loaded = ss.load(tmp_path / "fit.npz")
    assert loaded.shape is not None
    for name in ("control", "starts", "loops"):
        one, other = getattr(shape, name), getattr(loaded.shape, name)
        assert (one.dtype, one.shape) == (other.dtype, other.shape)
        assert one.tobytes() == other.tobytes()
    for name in ("fill", "y_down", "name", "notes"):
        assert getattr(loaded.shape, name) == getattr(shape, name)
    assert (loaded.name, loaded.y_down) == (shape.name, shape.y_down)
    points = np.random.default_rng(2).uniform(-0.2, 1.2, (500, 2))
    assert np.array_equal(
        ss.signed_distance(loaded.shape, points), ss.signed_distance(shape, points)
    )


def test_the_provenance_comes_back(tmp_path: Path) -> None:
    fit_with_shape().save(tmp_path / "fit.npz")
    assert ss.load(tmp_path / "fit.npz").made == MADE


finite = st.floats(allow_nan=False, allow_infinity=False)
above = st.floats(min_value=0.0, exclude_min=True, allow_infinity=False)
bands = st.lists(st.tuples(finite, finite).map(lambda pair: (min(pair), max(pair))), max_size=3)
provenances = st.builds(
    Provenance,
    tolerance=above,
    error=above,
    bound=st.none() | above,
    bands=bands.map(tuple),
    space=st.sampled_from(["tensor", "uniform"]),
    operator=st.sampled_from("VWSP"),
    stopped=st.text(),
    evaluations=st.integers(0, 2**63 - 1),
    version=st.text(),
)


@given(made=provenances, name=st.text())
def test_any_provenance_comes_back(
    tmp_path_factory: pytest.TempPathFactory, made: Provenance, name: str
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.npz"
    SplineSDF(Grid.uniform(UNIT, 1, 1), np.zeros((1, 8)), name=name, made=made).save(path)
    loaded = ss.load(path)
    assert (loaded.made, loaded.name) == (made, name)


def test_the_version_is_that_of_this_package() -> None:
    values = dataclasses.asdict(MADE)
    del values["version"]
    assert Provenance(**values).version == ss.__version__


def test_sources_that_are_not_installed_have_no_version(monkeypatch: pytest.MonkeyPatch) -> None:
    def version(name: str) -> str:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "version", version)
    assert this_version() == "unknown"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tolerance": 0.0}, "tolerance above 0"),
        ({"tolerance": "1"}, "finite number for tolerance"),
        ({"error": np.inf}, "finite number for error"),
        ({"error": -1.0}, "error from 0"),
        ({"bound": np.nan}, "finite number for bound"),
        ({"bound": True}, "finite number for bound"),
        ({"tolerance": 10**400}, "finite number for tolerance"),
        ({"bands": None}, "pairs"),
        ({"bands": (0.0, 1.0)}, "pairs"),
        ({"bands": ((1.0, 0.0),)}, "lo <= hi"),
        ({"bands": ((0.0, np.nan),)}, "finite number for a band"),
        ({"space": "hilbert"}, "space to be one of"),
        ({"operator": ["W"]}, "operator to be one of"),
        ({"stopped": None}, "text for stopped"),
        ({"evaluations": 1.5}, "count"),
        ({"evaluations": 2**63}, "count"),
        ({"version": 1}, "text for version"),
    ],
)
def test_a_provenance_is_checked(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ss.InputError, match=message) as caught:
        dataclasses.replace(MADE, **change)
    assert "\n" not in str(caught.value)


def test_numbers_of_numpy_are_taken(tmp_path: Path) -> None:
    numbers = {"error": np.float64(0.5), "bound": np.float32(0.5), "evaluations": np.int32(7)}
    made = dataclasses.replace(MADE, space="uniform", **numbers)  # type: ignore[arg-type]
    spline = SplineSDF(Grid.uniform(UNIT, 1, 1), np.zeros((1, 8)), made=made)
    spline.save(tmp_path / "fit.npz")
    assert ss.load(tmp_path / "fit.npz").made == made


def test_a_fit_has_the_name_and_the_axis_of_its_shape() -> None:
    shape = two_loops()
    grid, ordinates = Grid.uniform(UNIT, 1, 1), np.zeros((1, 8))
    spline = SplineSDF(grid, ordinates, shape=shape)
    assert (spline.name, spline.y_down) == (shape.name, True)
    with pytest.raises(ss.InputError, match="of the shape"):
        SplineSDF(grid, ordinates, "other", shape=shape)
    with pytest.raises(ss.InputError, match="of the shape"):
        SplineSDF(grid, ordinates, y_down=True, shape=gamma("gamma1"))


def test_equal_fits_are_equal_files(tmp_path: Path) -> None:
    spline = fit_with_shape()
    spline.save(tmp_path / "one.npz")
    ss.load(tmp_path / "one.npz").save(tmp_path / "other.npz")
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "other.npz").read_bytes()


def test_numpy_reads_the_file(tmp_path: Path) -> None:
    spline = fit_with_shape()
    spline.save(tmp_path / "fit.npz")
    assert np.array_equal(fields_of(tmp_path / "fit.npz")["ordinates"], spline.ordinates)


def test_arrays_in_any_order_are_saved(tmp_path: Path) -> None:
    spline = fit_with_shape()
    turned = dataclasses.replace(spline, ordinates=np.asfortranarray(spline.ordinates))
    turned.save(tmp_path / "fit.npz")
    loaded = ss.load(tmp_path / "fit.npz").ordinates
    assert loaded.flags.c_contiguous
    assert np.array_equal(loaded, spline.ordinates)


def test_what_would_not_load_is_not_saved(tmp_path: Path) -> None:
    (tmp_path / "fit.npz").write_text("old")
    ordinates = np.zeros((1, 8))
    ordinates[0, 3] = np.nan
    tree = Quadtree.uniform((1e9, 0.0, 1e9 + 1e-7, 1.0), 1, 1)
    open_shape = dataclasses.replace(two_loops(), loops=np.array([0, 3, 6]))
    grid = Grid.uniform(UNIT, 1, 1)
    for spline, message in (
        (SplineSDF(grid, ordinates), "finite"),
        (SplineSDF(grid, np.zeros((2, 8))), "ordinates"),
        (SplineSDF(tree, np.zeros((1, 8))), "rounding"),
        (SplineSDF(grid, np.zeros((1, 8)), made=MADE), "hierarchical"),
        (SplineSDF(grid, np.zeros((1, 8)), shape=open_shape), "closed"),
        (SplineSDF("mesh", np.zeros((1, 8))), "Grid or a Quadtree"),  # type: ignore[arg-type]
    ):
        with pytest.raises(ss.InputError, match=message):
            spline.save(tmp_path / "fit.npz")
        assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]


def test_no_line_is_run_for_each_leaf(tmp_path: Path) -> None:
    """A million leaves load in 0.1 s, as only NumPy goes through them."""
    ordinates = np.random.default_rng(0).normal(size=(4**8, 8))
    SplineSDF(full_tree(7), ordinates).save(tmp_path / "fit.npz")
    many = 10**9
    with before_line(many, lambda: None) as left:
        loaded = ss.load(tmp_path / "fit.npz")
    assert np.array_equal(loaded.ordinates, ordinates)
    assert 1000 < many - left[0] < len(ordinates) // 10  # most are for the header and for blocks


def test_info_says_from_what_a_fit_was_made(tmp_path: Path) -> None:
    fit_with_shape().save(tmp_path / "fit.npz")
    for path, words in (
        (tmp_path / "fit.npz", ["2 loops, 6 pieces", "0.3 (", "-0.1 to 0.333333, 2 to 2"]),
        (tmp_path / "fit.npz", ["reached", "12,345", "hierarchical, W", "splinesdf 0.0.7"]),
        (VERSION_1, ["not in the file", "does not say"]),
    ):
        code = "import sys; from splinesdf.cli.main import main; main()"
        done = subprocess.run(
            [sys.executable, "-X", "importtime", "-c", code, "info", str(path)],
            capture_output=True,
            text=True,
            check=True,
        )
        for word in words:
            assert word in done.stdout
        modules = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
        assert "splinesdf.splines.provenance" in modules
        assert "numba" not in modules


def test_random_trees_come_back(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    for m, n in itertools.product((1, 3), (1, 2)):
        mesh = Quadtree.uniform((-1.0, 2.0, 1.0, 3.0), m, n)
        for _ in range(5):
            mesh = refine(mesh, rng.random(len(mesh.leaves)) < 0.1)
        SplineSDF(mesh, rng.normal(size=(len(mesh.leaves), 8))).save(tmp_path / "fit.npz")
        loaded = ss.load(tmp_path / "fit.npz").mesh
        assert isinstance(loaded, Quadtree)
        assert (loaded.domain, loaded.shape) == (mesh.domain, mesh.shape)
        for name in ("level", "index", "child"):
            assert np.array_equal(getattr(loaded, name), getattr(mesh, name))


@pytest.mark.parametrize("name", ["fit", "fit.vtu", "fit.png", "fit.npz.bak"])
def test_a_name_of_another_kind_is_refused(name: str, tmp_path: Path) -> None:
    spline = SplineSDF(Grid.uniform(UNIT, 1, 1), np.zeros((1, 8)))
    with pytest.raises(ss.InputError, match=r"ending in \.npz or \.json"):
        spline.save(tmp_path / name)
    assert not list(tmp_path.iterdir())
