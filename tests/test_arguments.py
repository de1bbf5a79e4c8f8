"""Every number and array that a public function takes: what is none is refused in one line.

The functions and their parameters are found by looking through the package. A parameter of a new
name fails until `KINDS` says what it is.
"""

from __future__ import annotations

import contextlib
import inspect
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from splinesdf import plot
from splinesdf.distance import candidates
from splinesdf.distance import exact as distance
from splinesdf.fits.fit import fit_steps
from splinesdf.meshes import Grid, Quadtree
from splinesdf.offsets.offset import deviation
from splinesdf.splines import quasi
from splinesdf.splines.quasi import bspline
from tests.not_numbers import NOT_NUMBERS, NOT_WHOLE, NUMBERS, not_arrays

CORNERS = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
UNIT = (0.0, 0.0, 1.0, 1.0)


@cache
def shape() -> ss.Shape:
    return ss.Shape.from_points(CORNERS, name="bar")


@cache
def result() -> ss.FitResult:
    return ss.fit(shape(), tolerance=0.1)


@cache
def contour() -> ss.Contour:
    return ss.offset(shape(), 0.1, tolerance=1e-3)[0]


# What each parameter is, by its name. "number", "whole": one of them; "array": many; "numbers":
# a few, each of which is tried. Everything else is none.
KINDS: dict[str, str] = {
    **dict.fromkeys(("tolerance", "step", "max_distance", "min_side", "level", "beyond"), "number"),
    **dict.fromkeys(("gap", "unit", "size", "range", "em", "scale", "prune"), "number"),
    **dict.fromkeys(("dx", "dy", "degrees", "radius"), "number"),
    **dict.fromkeys(("xmin", "ymin", "xmax", "ymax"), "number"),
    **dict.fromkeys(("feed", "safe_height", "depth", "distance", "width", "height"), "number"),
    **dict.fromkeys(
        (
            "angle",
            "step_down",
            "tip",
            "allowance",
            "tool_diameter",
            "stepover",
            "ramp",
            "lead",
            "plunge_feed",
            "pass_depth",
            "spindle_speed",
            "laser_power",
        ),
        "number",
    ),
    **dict.fromkeys(("tab_width", "tab_height"), "number"),
    **dict.fromkeys(
        ("tabs", "nx", "ny", "max_cells", "count", "index", "m", "n", "i", "j", "family"), "whole"
    ),
    **dict.fromkeys(("degree", "samples", "max_steps", "workers"), "whole"),
    **dict.fromkeys(
        ("points", "distances", "control", "knots", "weights", "levels", "shell"), "array"
    ),
    **dict.fromkeys(("boxes", "ordinates", "arcs_", "x_", "y_", "values"), "array"),
    **dict.fromkeys(("domain", "band", "t", "page", "origin", "about", "center"), "numbers"),
    "start": "numbers",
    **dict.fromkeys(
        (
            *("shape", "space", "operator", "element", "stroke", "ignore", "layers", "text"),
            *("ids", "stroke_color", "flip", "limits"),
            *("location", "geometry", "certify", "coarse", "once", "fitted", "outside", "path"),
            *("fill", "close", "name", "content"),
            *("contours", "contour", "arcs", "units", "milling", "direction", "smooth", "periodic"),
            *("y_down", "notes", "loops", "sections", "x", "y", "mesh", "made", "closed", "parent"),
            *("function", "starts", "split", "columns", "rows", "spline", "ax", "result", "filled"),
            *("spline_or_mesh", "figure", "curve", "source", "characters"),
            *("progress", "holes", "other", "options", "factor", "machine", "laser_mode"),
            *("side", "corners"),
            *("sources", "job", "output", "reading", "writing", "scheduler", "overwrite"),
            *("chunks", "dtype", "device"),
        ),
        "other",
    ),
}
# Where a name means something else.
SPECIAL = {
    ("texture", "size"): "whole",
    ("Contour", "arcs"): "array",
    ("Grid.from_lines", "x"): "array",
    ("Grid.from_lines", "y"): "array",
    ("Grid", "x"): "array",
    ("Grid", "y"): "array",
    **dict.fromkeys((("signed_distance_array", name) for name in ("x", "y")), "array"),
    ("from_level_set", "x"): "array",
    ("from_level_set", "y"): "array",
    ("Shape.from_pieces", "loops"): "pieces",
    ("Quadtree.from_splits", "shape"): "other",
}
GOOD: dict[str, Any] = {
    "tolerance": 0.1,
    "points": CORNERS + 0.25,
    "distances": np.array([-0.1, 0.2]),
    "step": -0.2,
    "nx": 3,
    "ny": 4,
    "control": np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]]),
    "knots": np.array([0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]),
    "weights": np.array([1.0, 2.0, 2.0, 1.0]),
    "levels": np.array([-0.1, 0.0, 0.1]),
    "boxes": np.array([[0.0, 0.0, 1.0, 1.0]]),
    "domain": UNIT,
    "level": 0.05,
    "beyond": 0.5,
    "page": (0.0, 0.0, 2.0, 3.0),
    "origin": (1.0, 2.0),
    "max_distance": 0.5,
    "prune": 0.01,
    "min_side": 0.001,
    "max_cells": 100_000,
    "band": (-0.1, 0.1),
    "start": (3, 4),
    "t": (0.0, 6.283185307179586),
    "x": "cos(t)",
    "y": "sin(t)",
    "sections": [("cos(t)", "sin(t)", (0.0, "2*pi"))],
    "count": 5,
    "index": 1,
    "degree": 3,
    **{"m": 3, "n": 4, "i": 1, "j": 1},
    "operator": "V",
    "function": lambda points: points[:, 0],
    "loops": [[np.array(pair) for pair in zip(CORNERS, np.roll(CORNERS, -1, 0), strict=True)]],
    "feed": 100.0,
    "safe_height": 5.0,
    "depth": 1.0,
    **{"tool_diameter": 0.2, "stepover": 0.1, "ramp": 5.0, "lead": 1.0},
    **{"tabs": 2, "tab_width": 1.0, "tab_height": 0.5},
    **{"plunge_feed": 50.0, "pass_depth": 0.5, "spindle_speed": 12000.0, "laser_power": 255.0},
    "distance": 0.5,
    "samples": 10,
    "max_steps": 3,
    "size": 9,
    "range": 1.0,
    **{"dx": 1.0, "dy": 2.0, "degrees": 30.0, "radius": 1.5, "factor": 2.0, "about": (1.0, 2.0)},
    **{"xmin": 0.0, "ymin": 0.0, "xmax": 2.0, "ymax": 3.0, "center": (1.0, 2.0)},
    "shell": CORNERS,
}
# Good values that differ from one function to another.
GOOD_IN: dict[tuple[str, str], Any] = {
    ("Milling", "start"): (0.0, 1.0),
    ("example", "name"): "part",
    ("Grid.from_lines", "x"): np.array([0.0, 1.0, 2.0]),
    ("Grid.from_lines", "y"): np.array([0.0, 1.0, 2.0]),
    ("Grid", "x"): np.array([0.0, 1.0, 2.0]),
    ("Grid", "y"): np.array([0.0, 1.0, 2.0]),
    ("Contour", "closed"): True,
    ("Shape", "page"): (0.0, 0.0, 2.0, 3.0),
    ("signed_distance_array", "x"): np.array([0.0, 1.0, 2.0]),
    ("signed_distance_array", "y"): np.array([0.0, 1.0]),
    ("from_level_set", "x"): np.arange(9.0),
    ("from_level_set", "y"): np.arange(9.0),
    ("from_level_set", "values"): np.add.outer((np.arange(9.0) - 4) ** 2, (np.arange(9.0) - 4) ** 2)
    - 4.0,
}


def good(where: str, name: str) -> Any:
    if (where, name) in GOOD_IN:
        return GOOD_IN[where, name]
    made: dict[str, Callable[[], Any]] = {
        "shape": shape,
        "other": shape,
        "source": shape,
        "mesh": lambda: Grid.uniform(UNIT, 3, 4),
        "contour": contour,
        "contours": lambda: [contour()],
        "arcs": lambda: contour().arcs,
        "split": lambda: np.zeros(12, dtype=bool),
        "path": lambda: "out.svg",
        # Refused when all else is checked, as to start a process takes a second.
        **{"sources": lambda: [], "job": lambda: "write", "output": lambda: "{name}.svg"},
    }
    if where == "atlas" and name == "source":
        return {"bar": shape()}
    if where == "Contour" and name == "weights":
        return contour().weights
    if where == "Quadtree.from_splits" and name == "shape":
        return (3, 4)
    if where == "Shape":
        return getattr(shape(), name)
    if where == "SplineSDF" and name == "ordinates":
        return np.zeros((12, 8))
    return made[name]() if name in made else GOOD[name]


def offered() -> Iterator[tuple[str, Callable[..., Any]]]:
    """All that takes numbers: the package's functions, and methods of what they answer."""
    kinds: list[Any] = [ss.Shape, ss.SplineSDF, ss.Contour, ss.Milling, Grid, Quadtree]
    objects = {
        "Shape": shape,
        "SplineSDF": lambda: result().spline,
        "Contour": contour,
        "Grid": lambda: Grid.uniform(UNIT, 3, 4),
    }
    functions = [getattr(ss, name) for name in ss.__all__]
    functions += [fit_steps, deviation, bspline, distance.distance_and_gradient]
    functions += [candidates.closest_candidates, quasi.quasi_interpolate]
    for function in functions:
        if inspect.isfunction(function):
            yield function.__name__, function
    for kind in kinds:
        if kind is not Quadtree:
            yield kind.__name__, kind
        for name, member in inspect.getmembers(kind):
            if name.startswith("_") and name != "__call__":
                continue
            if inspect.ismethod(member):  # of the class
                yield f"{kind.__name__}.{name}", member
            elif inspect.isfunction(member) and kind.__name__ in objects:
                yield f"{kind.__name__}.{name}", getattr(objects[kind.__name__](), name)


def kind_of(where: str, name: str) -> str:
    kind = SPECIAL.get((where, name)) or KINDS.get(name)
    assert kind, f"{where} has a parameter {name!r}: say in KINDS what it is"
    return kind


def cases() -> list[Any]:
    found = []
    for where, function in offered():
        for name, parameter in inspect.signature(function).parameters.items():
            kind = kind_of(where, name)
            if kind != "other":
                found.append(
                    pytest.param(where, name, kind, parameter.default, id=f"{where}-{name}")
                )
    return found


def call(where: str, changed: dict[str, Any]) -> Any:
    """The function with good arguments where it needs them, and what was changed."""
    function = dict(offered())[where]
    arguments = dict(changed)
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind is parameter.VAR_KEYWORD:
            continue
        needed = parameter.default is parameter.empty or name == "distances"
        if needed and name not in arguments and not (name == "distances" and "step" in arguments):
            arguments[name] = good(where, name)
    answer = function(**arguments)
    return list(answer) if inspect.isgenerator(answer) else answer


def refused(where: str, changed: dict[str, Any]) -> str:
    """What it says; anything but an `InputError` of one line is a failure, an answer, too."""
    try:
        call(where, changed)
    except ss.InputError as error:
        message = str(error)
        assert "\n" not in message
        assert len(message) < 500
        return message
    except Exception as error:
        pytest.fail(f"{where}({changed!r:.200}): {type(error).__name__}: {error}")
    pytest.fail(f"{where}({changed!r:.200}) was answered")


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(("where", "name", "kind", "default"), cases())
def test_refused(where: str, name: str, kind: str, default: Any) -> None:
    if kind in ("number", "whole"):
        for value in [*NOT_NUMBERS, *(NOT_WHOLE if kind == "whole" else [])]:
            if not (value is None and default is None):
                message = refused(where, {name: value})
                assert name.replace("_", " ") in message.replace("_", " ")
    elif kind == "numbers":
        few = good(where, name)
        for value in NOT_NUMBERS:
            for place in range(len(few)):
                if not (name == "t" and isinstance(value, str)):  # t takes formulas
                    refused(where, {name: (*few[:place], value, *few[place + 1 :])})
        for value in [*few[:1], few[:1], (*few, 1.0), "x", "12", "1234", {}, object(), True]:
            refused(where, {name: value})
        for value in (
            np.ma.array(few, mask=True),
            np.array(few).astype(complex),
            np.array(few).astype(str),
        ):
            if not (name == "t" and np.asarray(value).dtype.kind == "U"):
                refused(where, {name: value})
    elif kind == "pieces":
        for value in not_arrays(CORNERS):
            if value is not None:
                refused(where, {name: [[value]]})
    else:
        for value in not_arrays(np.asarray(good(where, name))):
            one = isinstance(value, float | np.ndarray) and np.ndim(value) == 0
            if value is None or (one and name == "distances"):  # as good as an array of one
                continue
            refused(where, {name: value})


@pytest.mark.parametrize(("where", "name", "kind", "default"), cases())
def test_odd_numbers_are_answered_or_refused(
    where: str, name: str, kind: str, default: Any
) -> None:
    """Zero, negative, tiny, huge, of NumPy's types: no other error, and no warning."""
    for value in NUMBERS:
        if kind in ("number", "whole"):
            changes = [value]
        elif kind == "numbers":
            few = good(where, name)
            changes = [(*few[:k], value, *few[k + 1 :]) for k in range(len(few))]
        else:
            continue
        for changed in changes:
            with contextlib.suppress(ss.SplineSDFError):
                call(where, {name: changed})


def test_pictures() -> None:
    figure = plot.new_figure(3.0, 3.0)
    for levels in not_arrays(np.array([-0.1, 0.0, 0.1])):
        if levels is not None:
            with pytest.raises(ss.InputError, match="levels"):
                plot.plot_field(result().spline, figure.subplots(), levels=levels)


def test_a_point_without_coordinates_keeps_its_shape() -> None:
    """It was once said to have the shape (1,)."""
    for where in ("signed_distance", "project", "closest_point", "SplineSDF.__call__"):
        for value in (1.0, np.float64(1.0), np.array(1.0)):
            assert "shape ()" in refused(where, {"points": value})
        assert "shape (3,)" in refused(where, {"points": [1.0, 2.0, 3.0]})
    assert "shape ()" in refused("closest_candidates", {"boxes": 1.0})


@pytest.mark.parametrize("size", [(), (0,), (1,), (2, 3)])
def test_answers_have_the_shape_that_came(size: tuple[int, ...]) -> None:
    points = np.zeros((*size, 2))
    spline = result().spline
    for answer, more in (
        (ss.signed_distance(shape(), points), ()),
        (ss.closest_point(shape(), points), (2,)),
        (spline(points), ()),
        (spline.gradient(points), (2,)),
        (spline.hessian(points), (2, 2)),
        (spline.normal(points), (2,)),
        (spline.curvature(points), ()),
        (spline.closest_point(points), (2,)),
        (spline.inside(points), ()),
        *zip(ss.project(shape(), points), ((), (2,), (), (), ()), strict=True),
    ):
        assert answer.shape == (*size, *more)
        assert isinstance(answer, np.ndarray)


@pytest.mark.parametrize("kind", ["f4", "f2", "i8", "u1", ">f8", "longdouble", "O", "F", "view"])
def test_numbers_of_every_kind_are_taken(kind: str) -> None:
    """And no others: these give the same answer as doubles do."""
    whole = np.array([[1.0, 2.0], [3.0, 0.0]])
    points = {"F": np.asfortranarray(whole), "view": np.repeat(whole, 2, axis=0)[::2]}.get(kind)
    if points is None:
        points = whole.astype(kind)
    expected = ss.signed_distance(shape(), whole)
    assert np.array_equal(ss.signed_distance(shape(), points), expected)
    assert np.array_equal(ss.signed_distance(shape(), points.tolist()), expected)
    assert np.array_equal(result().spline(points), result().spline(whole))


@pytest.mark.parametrize("value", [1, np.int64(1), np.float32(1), Fraction(1), np.array(1.0)])
def test_numbers_of_every_kind_are_taken_one_by_one(value: Any) -> None:
    expected = ss.signed_distance(shape(), CORNERS, max_distance=1.0)
    found = ss.signed_distance(shape(), CORNERS, max_distance=value)
    assert np.array_equal(found, expected)
