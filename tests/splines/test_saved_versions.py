"""Files of the first version of the format are read, and as strictly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from tests.saving import about, fields_of, fit_with_shape, version_1, with_about

Fields = dict[str, np.ndarray]
VERSION_1 = Path(__file__).parents[1] / "data" / "saved_version_1.npz"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "fit.npz"


@pytest.fixture
def fields(path: Path) -> Fields:
    fit_with_shape().save(path)
    return fields_of(path)


def refused(path: Path, message: str) -> None:
    with pytest.raises(ss.InputError, match=message) as caught:
        ss.load(path)
    assert "\n" not in str(caught.value)


def test_files_of_version_1_are_read() -> None:
    """Saved by splinesdf before there was a second version, from a drawing with y downward."""
    loaded = ss.load(VERSION_1)
    assert (loaded.name, loaded.y_down, loaded.shape, loaded.made) == ("kite é", True, None, None)
    points = np.array([[0.5, 0.5], [1.0, 1.25], [2.1, 0.3]])
    # What that version answered. 1e-15: a few roundings of numbers below one.
    answers = [-0.44949994063367965, -0.28686273558167547, 0.0343946906948775]
    assert loaded(points) == pytest.approx(answers, abs=1e-15)


def test_version_1_has_no_fields_of_version_2(fields: Fields, path: Path) -> None:
    old = version_1(fields)
    np.savez(path, **old)
    assert ss.load(path).name == "kite"
    np.savez(path, **{**old, "name": np.array("kite \ud800")})
    assert ss.load(path).name == "kite \ud800"
    for key in ("about", "control"):
        np.savez(path, **{**old, key: fields[key]})
        refused(path, "version 1")
    for key in old:
        np.savez(path, **{name: values for name, values in old.items() if name != key})
        refused(path, "expected")
    np.savez(path, **{**old, "name": np.array([2**32 - 1], dtype=np.uint32).view("<U1")[0:1]})
    refused(path, "name")


def test_shapes_in_files_of_version_2_have_neither_unit_nor_page(
    fields: Fields, path: Path
) -> None:
    said = about(fields)
    del said["element"], said["shape"]["unit"], said["shape"]["page"]
    np.savez(path, **{**with_about(fields, said), "version": np.array(2)})
    found, expected = ss.load(path), fit_with_shape()
    assert found.shape is not None
    assert (found.shape.unit, found.shape.page, found.shape.fill) == (None, None, "evenodd")
    assert expected.shape is not None
    assert np.array_equal(found.shape.control, expected.shape.control)
    assert np.array_equal(found.ordinates, expected.ordinates)
    # A later file says both.
    np.savez(path, **{**with_about(fields, said), "version": np.array(3)})
    refused(path, "element")


def test_letters_that_do_not_exist(fields: Fields, path: Path) -> None:
    for key in ("format", "name"):
        letter = np.ndarray((), dtype="<U1", buffer=np.array([2**31], dtype=np.uint32).data)
        np.savez(path, **{**version_1(fields), key: letter})
        refused(path, f"text in '{key}'")
