"""A fit saved as JSON is the one saved as .npz, to the bit; what is no such file is refused."""

from __future__ import annotations

import dataclasses
import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.meshes import Grid
from splinesdf.spaces.cubic import CUBIC
from splinesdf.splines import json_form
from splinesdf.splines.spline import SplineSDF
from tests.examples import examples
from tests.named_shapes import UNIT, gamma
from tests.saving import fields_of, fit_with_shape, full_tree

Content = dict[str, Any]


def grid_fit() -> SplineSDF:
    return ss.interpolate(gamma("gamma1"), (3, 2), operator="W").spline


def cubic_fit() -> SplineSDF:
    ordinates = np.random.default_rng(1).normal(size=(6, CUBIC.numbers))
    return SplineSDF(Grid.uniform(UNIT, 2, 3), ordinates, element=CUBIC)


MAKE = {"tree": fit_with_shape, "grid": grid_fit, "cubic": cubic_fit}


@pytest.mark.parametrize("kind", MAKE)
@pytest.mark.parametrize("way", ["file", "dict", "text"])
def test_the_same_as_npz_to_the_bit(kind: str, way: str, tmp_path: Path) -> None:
    spline = MAKE[kind]()
    spline.save(tmp_path / "one.npz")
    if way == "file":
        spline.save(tmp_path / "fit.json")
        loaded = ss.load(tmp_path / "fit.json")
    elif way == "dict":
        loaded = SplineSDF.from_dict(spline.to_dict())
    else:
        loaded = SplineSDF.from_dict(json.loads(json.dumps(spline.to_dict())))
    loaded.save(tmp_path / "other.npz")
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "other.npz").read_bytes()
    assert loaded.ordinates.flags.writeable


def test_the_file_holds_the_dict(tmp_path: Path) -> None:
    spline = fit_with_shape()
    spline.save(tmp_path / "fit.JSON")
    text = (tmp_path / "fit.JSON").read_text("ascii")
    assert json.loads(text) == spline.to_dict()
    assert text.startswith('{\n"format": "splinesdf",\n"version": 3,\n"domain": [')
    # Nothing that the .npz has is left out.
    spline.save(tmp_path / "fit.npz")
    fields = fields_of(tmp_path / "fit.npz")
    plain = spline.to_dict()
    assert list(plain) == list(fields)
    assert plain["about"] == json.loads(fields["about"].tobytes())
    for key in set(fields) - {"about", "split"}:
        assert np.array_equal(fields[key], plain[key])
    assert set(plain["split"]) == {0, 1}
    assert [type(flag) for flag in plain["split"][:2]] == [int, int]
    assert np.array_equal(fields["split"], plain["split"])


@given(
    numbers=st.lists(
        st.floats(-1e100, 1e100) | st.sampled_from([-0.0, 5e-324, -2.2e-308, 0.1 + 0.2]),
        min_size=8,
        max_size=8,
    ),
    name=st.text(),
)
@examples(50)
def test_every_float_comes_back(
    tmp_path_factory: pytest.TempPathFactory, numbers: list[float], name: str
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.json"
    SplineSDF(Grid.uniform(UNIT, 1, 1), np.array([numbers]), name=name).save(path)
    loaded = ss.load(path)
    assert loaded.ordinates.tobytes() == np.array(numbers).tobytes()
    assert loaded.name == name


def as_javascript(value: Any) -> Any:
    """What JSON.stringify(JSON.parse(text)) makes of whole numbers."""
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if isinstance(value, dict):
        return {key: as_javascript(one) for key, one in sorted(value.items())}
    return [as_javascript(one) for one in value] if isinstance(value, list) else value


def test_numbers_without_a_point_and_fields_in_any_order(tmp_path: Path) -> None:
    shape = dataclasses.replace(gamma("gamma2"), unit=25.0)
    spline = dataclasses.replace(fit_with_shape(), shape=shape, name="gamma2", y_down=False)
    ordinates = np.round(spline.ordinates)
    spline = dataclasses.replace(spline, ordinates=ordinates)
    (tmp_path / "fit.json").write_text(json.dumps(as_javascript(spline.to_dict())), "utf-8")
    loaded = ss.load(tmp_path / "fit.json")
    assert loaded.to_dict() == spline.to_dict()
    assert np.array_equal(loaded.ordinates, ordinates)


def test_flags_may_be_booleans() -> None:
    content = fit_with_shape().to_dict()
    content["split"] = [flag == 1 for flag in content["split"]]
    assert np.array_equal(SplineSDF.from_dict(content).ordinates, content["ordinates"])


def change(path: str, value: Any) -> Callable[[Content], Any]:
    """A change of one entry, as "about.made.error"; ... takes it away."""

    def changed(content: Content) -> Any:
        *outer, last = path.split(".")
        inner: Any = content
        for name in outer:
            inner = inner[int(name) if isinstance(inner, list) else name]
        if value is ...:
            del inner[last]
        else:
            inner[int(last) if isinstance(inner, list) else last] = value
        return content

    return changed


def deep(levels: int) -> list[Any]:
    nested: list[Any] = []
    for _ in range(levels):
        nested = [nested]
    return nested


CHANGES: list[tuple[Callable[[Content], Any], str]] = [
    (lambda _: [], "another list"),
    (lambda _: None, "another NoneType"),
    (lambda _: {"x": "cos(t)", "y": "sin(t)"}, "another dict"),
    (change("format", "other"), "another dict"),
    (change("version", 4), "update splinesdf"),
    (change("version", 3.0), "'version'"),
    (change("version", True), "'version'"),
    (change("version", 10**30), r"below 2\*\*63"),
    (change("extra", 1), "'extra' among them"),
    (change("domain", [0, 0, 1]), "'domain'"),
    (change("domain", "0 0 1 1"), "'domain'"),
    (change("domain", [0, 0, 1, None]), "'domain'"),
    (change("domain.0", True), "'domain'.*booleans"),
    (change("domain.0", "0"), "'domain'"),
    (change("domain.2", 10**400), "'domain'"),
    (change("shape", [4.0, 4]), "whole numbers for 'shape'"),
    (change("shape", [True, 4]), "whole numbers for 'shape'"),
    (change("shape", [4, 4, 4]), "'shape'"),
    (change("shape.0", 2**70), r"below 2\*\*63"),
    (change("shape.0", 0), "at least one cell"),
    (change("split", [0, 1]), "too few"),
    (change("split.0", 2), "flags 0 and 1"),
    (change("split.0", -1), "flags 0 and 1"),
    (change("split.0", 0.0), "whole numbers for 'split'"),
    (change("split", {}), "whole numbers for 'split'"),
    (change("ordinates", []), "'ordinates'"),
    (change("ordinates", deep(70)), "'ordinates'"),
    (change("ordinates", [[1.0] * 8, [1.0] * 7]), "'ordinates'"),
    (change("ordinates.3", {}), "'ordinates'"),
    (change("ordinates.3.1", None), "'ordinates'"),
    (change("ordinates.3.1", [0.0]), "'ordinates'"),
    (change("ordinates.3.1", 1e200), "finite"),
    (change("about", "{}"), "about"),
    (change("about", []), "about"),
    (change("about.name", 1), "name as str"),
    (change("about.element", "quintic"), "element"),
    (change("about.shape.unit", True), "unit"),
    (change("about.shape.unit", -1), "unit"),
    (change("about.made.error", "0"), "error"),
    (change("control", ...), "'control'"),
    (change("starts.1", 1.5), "'starts'"),
    (change("x", [0, 1]), "fields"),
]


@pytest.mark.parametrize(("changed", "message"), CHANGES)
@pytest.mark.parametrize("way", ["file", "dict"])
def test_what_is_tampered_with_is_refused(
    changed: Callable[[Content], Any], message: str, way: str, tmp_path: Path
) -> None:
    content = changed(fit_with_shape().to_dict())
    if way == "file":
        (tmp_path / "fit.json").write_text(json.dumps(content))
        refused(tmp_path / "fit.json", message)
        return
    with pytest.raises(ss.InputError, match=message) as caught:
        SplineSDF.from_dict(content)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 1000


def read_or_refused(path: Path) -> SplineSDF | None:
    """The fit, or None if it was refused in one line; any other error or warning is raised."""
    try:
        return ss.load(path)
    except ss.InputError as caught:
        error = caught
    assert "\n" not in str(error)
    return None


def refused(path: Path, message: str) -> None:
    with pytest.raises(ss.InputError, match=message) as caught:
        ss.load(path)
    assert "\n" not in str(caught.value)
    assert "fit.json" in str(caught.value) or len(path.name) > 255
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize(
    ("replace", "message"),
    [
        ((rb"^\{", b""), "damaged"),
        ((rb"(?s)^.*$", b""), "damaged"),
        ((rb"(?s)^.*$", b"\x00\xff\xfe" * 9), "damaged"),
        ((rb"(?s)^.*$", b"[" * 200_000), "damaged"),
        ((rb"(?s)^.*$", b'{"a":' * 200_000), "damaged"),
        ((rb'"domain": \[', b'"domain": [NaN, '), "finite numbers, got NaN"),
        ((rb'"domain": \[', b'"domain": [-Infinity, '), "finite numbers, got -Infinity"),
        ((rb'"domain": \[[^,]*', b'"domain": [1e999'), "finite"),
        ((rb'"domain": \[[^,]*', b'"domain": [' + b"9" * 5000), "damaged"),
        ((rb'"error": ', b'"error": NaN, "more": '), "finite numbers, got NaN"),
        ((rb'"version": 3,', b'"version": 3, "version": 3,'), "every name once"),
        ((rb'"version": 3,', b'"version": 3,,'), "damaged"),
    ],
)
def test_damaged_text_is_refused(
    replace: tuple[bytes, bytes], message: str, tmp_path: Path
) -> None:
    path = tmp_path / "fit.json"
    fit_with_shape().save(path)
    text = re.sub(replace[0], replace[1], path.read_bytes(), count=1)
    assert text != path.read_bytes()
    path.write_bytes(text)
    refused(path, message)


def test_cut_and_flipped_files(tmp_path: Path) -> None:
    """A fit without a warning, or one line; cut short, always the line."""
    path = tmp_path / "fit.json"
    fit_with_shape().save(path)
    whole = path.read_bytes().rstrip()
    rng = np.random.default_rng(2)
    for stop in rng.integers(0, len(whole), 60):
        path.write_bytes(whole[:stop])
        refused(path, "fit.json")
    loaded = 0
    for _ in range(300):
        data = bytearray(whole)
        data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))
        path.write_bytes(data)
        spline = read_or_refused(path)
        if spline is not None:
            loaded += 1
            assert np.isfinite(spline.ordinates).all()
    assert 50 < loaded < 250


def test_what_is_not_there_and_what_is_no_file(tmp_path: Path) -> None:
    refused(tmp_path / "fit.json", "does not exist")
    (tmp_path / "fit.json").mkdir()
    refused(tmp_path / "fit.json", "folder")
    os.mkfifo(tmp_path / "a_fit.json")
    refused(tmp_path / "a_fit.json", "not a regular file")
    refused(tmp_path / "null\0fit.json", "null")
    refused(tmp_path / f"{'x' * 5000}_fit.json", "cannot read|does not exist")


def test_a_file_beyond_the_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "fit.json"
    fit_with_shape().save(path)
    monkeypatch.setattr(json_form, "_LARGEST", path.stat().st_size)
    ss.load(path)
    monkeypatch.setattr(json_form, "_LARGEST", path.stat().st_size - 1)
    refused(path, "bytes, got more")
    before = path.read_bytes()
    with pytest.raises(ss.InputError, match=r"save it as \.npz"):
        fit_with_shape().save(path)
    assert path.read_bytes() == before
    assert [one.name for one in tmp_path.iterdir()] == ["fit.json"]


def test_what_would_not_load_is_no_dict() -> None:
    nan = np.zeros((1, 8))
    nan[0, 1] = np.nan
    grid = Grid.uniform(UNIT, 1, 1)
    for spline, message in (
        (SplineSDF(grid, nan), "finite"),
        (SplineSDF(grid, np.zeros((2, 8))), "ordinates"),
    ):
        with pytest.raises(ss.InputError, match=message):
            spline.to_dict()


def test_a_dict_of_other_things_is_refused() -> None:
    for key, value in (
        ("about", {1, 2}),
        ("about", {"name": np.zeros(3)}),
        ("about", {"made": float("nan")}),
        ("about", deep(5000)),
        ("ordinates", deep(5000)),
        ("split", np.zeros(3)),
        (7, 1),
    ):
        content = fit_with_shape().to_dict()
        content[key] = value  # type: ignore[index]
        with pytest.raises(ss.InputError) as caught:
            SplineSDF.from_dict(content)
        assert "\n" not in str(caught.value)


def test_a_fit_is_no_shape(tmp_path: Path) -> None:
    fit_with_shape().save(tmp_path / "fit.json")
    with pytest.raises(ss.InputError, match=r"saved fit: splinesdf\.load reads it"):
        ss.read(tmp_path / "fit.json")


def test_a_formula_is_no_fit(tmp_path: Path) -> None:
    (tmp_path / "fit.json").write_text('{"x": "cos(t)", "y": "sin(t)"}')
    refused(tmp_path / "fit.json", "another dict")


def test_a_large_tree_comes_back(tmp_path: Path) -> None:
    ordinates = np.random.default_rng(0).normal(size=(4**6, 8))
    SplineSDF(full_tree(5), ordinates).save(tmp_path / "fit.json")
    assert np.array_equal(ss.load(tmp_path / "fit.json").ordinates, ordinates)
