"""What a drawing says of its coordinates goes along: down or up, how long a unit is, which page."""

from __future__ import annotations

import copy
import json
import pickle
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.contours.conics import unfolded
from splinesdf.contours.contour import Contour
from splinesdf.contours.nesting import nested
from splinesdf.io.placing import changed
from splinesdf.splines.archive import _VERSION

# All that shapes and contours both have, whatever is added: none of it may be lost on the way.
CARRIED = sorted({f.name for f in fields(ss.Shape)} & {f.name for f in fields(Contour)})
SAID = {"y_down": True, "unit": 0.25, "page": (-3.0, 2.0, 60.0, 47.5)}
PATH = "M10 10H40V30H10ZM20 15V22A4 3 0 0 0 30 22V15Z"


@pytest.fixture(scope="module")
def drawn() -> ss.Shape:
    return replace(ss.Shape.from_svg_path(PATH, fill="evenodd"), **SAID)


def fitted(shape: ss.Shape) -> ss.SplineSDF:
    return ss.fit(shape, tolerance=0.5, certify=False).spline


def saved(shape: ss.Shape, folder: Path) -> ss.SplineSDF:
    fitted(shape).save(folder / "a.npz")
    return ss.load(folder / "a.npz")


def offset(shape: ss.Shape) -> list[Contour]:
    return ss.offset(shape, -1.0, tolerance=1e-2)


ROADS: dict[str, Callable[[ss.Shape, Path], list[object]]] = {
    "offset": lambda shape, _: offset(shape),
    "offset far": lambda shape, _: ss.offset(shape, 1e9, tolerance=1.0, coarse=True),
    "offset 0": lambda shape, _: ss.offset(shape, 0.0, tolerance=1e-2),
    "offset in steps": lambda shape, _: ss.offset(shape, step=-2.0, tolerance=1e-2),
    "offset of an offset": lambda shape, _: ss.offset(
        ss.Shape.from_contours(offset(shape)), 1.0, tolerance=1e-2
    ),
    "level set": lambda shape, _: fitted(shape).contours(1.0),
    "saved": lambda shape, folder: [saved(shape, folder).shape, *saved(shape, folder).contours(0)],
    "arcs": lambda shape, _: [ss.as_arcs(c, tolerance=1e-3) for c in offset(shape)],
    "unfolded": lambda shape, _: [unfolded(c) for c in offset(shape)],
    "nested": lambda shape, _: nested(offset(shape)),
    "parents": lambda shape, _: [c.parent or c for c in changed(offset(shape), lambda c: c)],
    "from contours": lambda shape, _: [ss.Shape.from_contours(offset(shape))],
    "copies": lambda shape, _: [
        *(copy.deepcopy(c) for c in offset(shape)),
        *pickle.loads(pickle.dumps(offset(shape))),
        pickle.loads(pickle.dumps(shape)),
    ],
}


def test_what_is_said_is_all_that_is_carried() -> None:
    assert sorted(SAID) == CARRIED


@pytest.mark.parametrize("road", ROADS)
def test_nothing_that_is_said_is_lost(drawn: ss.Shape, tmp_path: Path, road: str) -> None:
    results = ROADS[road](drawn, tmp_path)
    assert results
    for result in results:
        assert {name: getattr(result, name) for name in CARRIED} == SAID


def test_files_of_this_version_without_a_page_are_read(drawn: ss.Shape, tmp_path: Path) -> None:
    fitted(drawn).save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as file:
        arrays = dict(file)
    about = json.loads(arrays["about"].tobytes())
    del about["shape"]["page"]
    arrays["about"] = np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)
    assert int(arrays["version"]) == _VERSION
    np.savez(tmp_path / "b.npz", **arrays)
    shape = ss.load(tmp_path / "b.npz").shape
    assert shape is not None
    assert (shape.page, shape.unit) == (None, 0.25)


@pytest.mark.parametrize(
    "page", [(0, 0, 1), (0, 0, 0, 1), (0, 1, 2, 1), (0, 0, np.nan, 1), "abcd", (0, 0, np.inf, 1)]
)
def test_what_is_no_page_is_refused(drawn: ss.Shape, tmp_path: Path, page: object) -> None:
    with pytest.raises(ss.InputError, match="page"):
        replace(drawn, page=page)
    with pytest.raises(ss.InputError, match="page"):
        Contour(np.zeros((1, 3, 2)), np.ones(1), page=page)
