"""Results and errors travel: through pickle, copy, and to and from other processes.

The classes are found by walking through the package, so that a new one is covered by itself, or
fails until there is an example of it.
"""

from __future__ import annotations

import copy
import dataclasses
import importlib
import inspect
import multiprocessing
import os
import pickle
import pkgutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, get_args, get_type_hints

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.fits.fit import fit_steps
from splinesdf.io.clearance import Cleared
from splinesdf.io.enclosed import Sides
from splinesdf.io.programs import Move, Way
from splinesdf.io.readers.fonts_glyphs import Kern
from splinesdf.io.remeasured import Worst
from splinesdf.io.writers.machines import MACHINES
from splinesdf.paper.tables import Row
from tests.named_shapes import gamma


def modules() -> Iterator[Any]:
    """Every module of the package but the compiled loops, which hold functions only."""
    yield ss
    for found in pkgutil.walk_packages(ss.__path__, "splinesdf."):
        if not found.name.startswith("splinesdf.kernels") and not found.name.endswith("__main__"):
            yield importlib.import_module(found.name)


@cache
def classes() -> list[type]:
    """Every class that is defined in the package and has a public name."""
    found = {
        kind
        for module in modules()
        for name, kind in inspect.getmembers(module, inspect.isclass)
        if kind.__module__.startswith("splinesdf.") and not name.startswith("_")
    }
    return sorted(found, key=lambda kind: (kind.__module__, kind.__qualname__))


ERRORS = [kind for kind in classes() if issubclass(kind, BaseException)]
# What holds values: a record, or an enumeration. The rest are protocols and working parts.
RECORDS = [kind for kind in classes() if dataclasses.is_dataclass(kind) or hasattr(kind, "_fields")]


@cache
def result() -> ss.FitResult:
    return ss.fit(gamma("gamma1"), tolerance=0.05)


def an_error(kind: type[BaseException]) -> BaseException:
    """An error of a kind, whatever it wants to be made."""
    wanted = {"message": "what was expected, what came", "result": result()}
    names = [
        name
        for name, parameter in inspect.signature(kind.__init__).parameters.items()
        if name != "self" and parameter.kind is parameter.POSITIONAL_OR_KEYWORD
    ]
    made = kind(*(wanted[name] for name in names)) if names else kind(wanted["message"])
    made.add_note("a note")
    made.extra = 7  # type: ignore[attr-defined]
    return made


WAYS: dict[str, Callable[[Any], Any]] = {
    "copy": copy.copy,
    "deep copy": copy.deepcopy,
} | {
    f"pickle {protocol}": lambda value, protocol=protocol: pickle.loads(
        pickle.dumps(value, protocol)
    )
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)
}


def same(a: Any, b: Any, seen: set[tuple[int, int]] | None = None) -> bool:
    """Whether two values hold the same, to the bit, down to the last part."""
    seen = set() if seen is None else seen
    if a is b or (id(a), id(b)) in seen:
        return True
    seen.add((id(a), id(b)))
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
    if isinstance(a, list | tuple):
        return len(a) == len(b) and all(same(x, y, seen) for x, y in zip(a, b, strict=True))
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key], seen) for key in a)
    if isinstance(a, BaseException):
        return str(a) == str(b) and same(a.args, b.args, seen) and same(vars(a), vars(b), seen)
    if dataclasses.is_dataclass(a):
        names = [field.name for field in dataclasses.fields(a)]
        return all(same(getattr(a, name), getattr(b, name), seen) for name in names)
    return bool(a == b or (a != a and b != b))


def parts(value: Any, seen: dict[int, Any]) -> None:
    """All records that a value holds, itself among them."""
    if id(value) in seen:
        return
    if isinstance(value, BaseException) or dataclasses.is_dataclass(value):
        seen[id(value)] = value
        for part in vars(value).values():
            parts(part, seen)
    elif isinstance(value, list | tuple):
        seen[id(value)] = value
        for part in value:
            parts(part, seen)
    elif isinstance(value, dict):
        for part in value.values():
            parts(part, seen)


@cache
def examples() -> dict[type, Any]:
    """A value of each kind, out of what the public functions answer."""
    shape, points = gamma("gamma2"), np.array([[0.2, 0.3], [np.nan, 1.0]])
    answers: list[Any] = [
        result(),
        list(fit_steps(gamma("gamma2"), tolerance=0.05, space="tensor", band=(0.0, 0.1))),
        ss.project(shape, points),
        ss.signed_distance_grid(shape, 3, 4),
        result().spline.grid(3, 4),
        result().spline.triangles(),
        ss.texture(shape, 5, range=0.1),
        dataclasses.replace(ss.atlas({"limaçon": shape}, size=8), kerning=(Kern("A", "V", -0.1),)),
        ss.offset(shape, [-0.02, 0.1], tolerance=1e-4),
        ss.pocket(shape, 0.1, 0.05, tolerance=1e-3),
        ss.vcarve(shape, 60.0, 0.1, tolerance=1e-2),
        Cleared(100, -0.1, (1.0, 2.0)),
        ss.Milling(feed=100.0),
        MACHINES["grbl"],
        Move(0j, 1 + 0j, (0.0, -1.0)),
        Way(-2.0, 0, moves=[Move(0j, 1 + 0j, (0.0, -1.0))]),
        ss.Progress("offset by 1", 1, 2),
        ss.medial_axis(shape, 0.01),
        ss.thickness(ss.Shape.rectangle(0, 0, 4, 2)),
        ss.maximal_disk(shape, points),
        ss.BatchReport((ss.BatchRow("a.svg", "a.dxf", "failed", "no such file", 0.5),)),
        shape.joints,
        shape.kinds,
        shape.bends,
    ]
    answers += [
        Worst(
            *(0.1, (1.0, 2.0), 0.5, {0.5: 2}, 0.0, 0),
            (Sides(0.5, 100, 1, 0, 0, (1.0, 2.0), 0.01),),
        ),
        Row(1, "gamma1", "uniform", "V", 0, 2, 2, 0.1, None, 0.2),
    ]
    seen: dict[int, Any] = {}
    for answer in answers:
        parts(answer, seen)
    return {type(value): value for value in reversed(seen.values())}


def named(hint: Any) -> Iterator[type]:
    """The classes of the package in a type hint, those in lists and unions, too."""
    if isinstance(hint, type) and hint.__module__.startswith("splinesdf."):
        yield hint
    for part in get_args(hint):
        yield from named(part)


def answered() -> set[type]:
    """The classes of what the public functions and methods say that they answer, and hold."""
    offered = [getattr(ss, name) for name in ss.__all__]
    kinds = [kind for kind in offered if inspect.isclass(kind) and kind in RECORDS]
    functions = [function for function in offered if inspect.isfunction(function)]
    functions += [
        function
        for kind in kinds
        for name, function in inspect.getmembers(kind, inspect.isfunction)
        if not name.startswith("_")
    ]
    # Some methods name types that only type checkers import: of a higher floor, or a library.
    typed = {"Axes": object} | {name: getattr(ss, name) for name in ss.__all__}
    hints = [get_type_hints(function, localns=typed).get("return") for function in functions]
    hints += [hint for kind in kinds for hint in get_type_hints(kind).values()]
    found = {kind for hint in hints for kind in named(hint)} | set(kinds)
    return {kind for kind in found if kind in RECORDS}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kind", ERRORS)
def test_errors(kind: type[BaseException], way: str) -> None:
    error = an_error(kind)
    back = WAYS[way](error)
    assert type(back) is kind
    assert same(error, back)
    assert str(back) == "what was expected, what came"


def test_every_answer_has_an_example() -> None:
    assert {ss.FitResult, ss.SplineSDF, ss.Projection, ss.DistanceGrid, ss.Contour} <= answered()
    missing = answered() - examples().keys()
    assert not missing, "give `examples` a value that holds one"
    assert len(ERRORS) >= 5


@pytest.mark.parametrize("way", WAYS)
def test_records(way: str) -> None:
    for kind, value in examples().items():
        assert same(value, WAYS[way](value)), kind


def test_what_came_back_answers_the_same() -> None:
    """Not only the numbers: what is worked out on first use and kept does not stand in the way."""
    spline, points = result().spline, np.random.default_rng(3).uniform(-1.0, 2.0, (50, 2))
    expected = spline(points), ss.signed_distance(gamma("gamma1"), points)
    back, shape = pickle.loads(pickle.dumps((spline, gamma("gamma1"))))
    for found in (
        (back(points), ss.signed_distance(shape, points)),
        (
            copy.copy(spline)(points),
            ss.signed_distance(copy.deepcopy(shape), points),
        ),
    ):
        assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))


def test_contours_nested_deeply() -> None:
    """Each holds its parent, that its own, and so on."""
    rings = [
        [np.array([a, b]) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
        for corners in (
            k * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
            for k in range(1, 401)
        )
    ]
    nested = ss.offset(ss.Shape.from_pieces(rings, fill="evenodd"), 0.0, tolerance=1e-3)
    for way in WAYS.values():
        back = way(nested)
        assert [c.area for c in back] == [c.area for c in nested]
        assert parents(back) == parents(nested)


def parents(contours: list[ss.Contour]) -> list[int | None]:
    """The number of each one's parent, which is one of them and no twin."""
    numbers = {id(contour): k for k, contour in enumerate(contours)}
    return [None if c.parent is None else numbers[id(c.parent)] for c in contours]


# Work for other processes, once raising and once answering. The parent has used its threads.
POOL = """
import multiprocessing, sys
import numpy as np
import splinesdf as ss

def shape():
    return ss.Shape.from_points([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]], name="bar")

def too_fine(cells):
    return ss.fit(shape(), tolerance=1e-6, max_cells=cells)

def distances(asked):
    return ss.signed_distance(*asked), ss.project(*asked)

def fitted(tolerance):
    return ss.fit(shape(), tolerance=tolerance)

if __name__ == "__main__":
    points = np.random.default_rng(1).uniform(-1.0, 3.0, (20_000, 2))
    expected = ss.signed_distance(shape(), points)
    with multiprocessing.get_context(sys.argv[1]).Pool(1) as pool:
        try:
            pool.map(too_fine, [20])
        except ss.ToleranceNotReached as error:
            result = error.result
            print(result.stopped, 0 < result.cells <= 20, result.spline.shape.name)
        found, projected = pool.apply(distances, [(shape(), points)])
        print(np.array_equal(found, expected), np.array_equal(projected.distance, expected))
        result = pool.apply(fitted, [0.05])
        print(np.array_equal(result.spline(points), ss.fit(shape(), tolerance=0.05).spline(points)))
"""


@pytest.mark.parametrize("start", multiprocessing.get_all_start_methods())
def test_pools(start: str, tmp_path: Path) -> None:
    """An error that could not be read back once made a pool wait for ever."""
    (tmp_path / "work.py").write_text(POOL)
    done = subprocess.run(
        [sys.executable, "-W", "ignore::DeprecationWarning", "work.py", start],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(Path(ss.__file__).parents[1])},
        capture_output=True,
        text=True,
        timeout=300,  # a test of nothing but that it ends
        check=False,
    )
    assert done.stdout.split("\n") == ["max_cells True bar", "True True", "True", ""], done.stderr
