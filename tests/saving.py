"""Fits to save and files to damage, which several tests share."""

from __future__ import annotations

import contextlib
import json
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

import splinesdf as ss
from splinesdf.meshes import Quadtree
from splinesdf.splines.provenance import Provenance
from tests.naive_tree import refine

MADE = Provenance(
    tolerance=0.1,
    error=0.1 + 0.2,  # a number that needs all its digits
    bound=None,
    bands=((-0.1, 1 / 3), (2.0, 2.0)),
    space="hierarchical",
    operator="W",
    stopped="reached",
    evaluations=12_345,
    version="0.0.7",
)


def two_loops() -> ss.Shape:
    """A square with a hole, pieces of three degrees, a name and notes beyond ASCII."""
    hole = [np.array([[0.4, 0.4], [0.4, 0.6], [0.6, 0.6]]), np.array([[0.6, 0.6], [0.4, 0.4]])]
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.1 + 0.2, 1.0]])
    square = [*np.stack([corners[:-1], corners[1:]], axis=1)]
    back = np.array([corners[-1], [0.2, 0.9], [0.1, 0.5], corners[0]])
    return ss.Shape.from_pieces(
        [[*square, back], hole],
        fill="evenodd",
        y_down=True,
        name="Löffel\n[red] \ud800\0",
        notes=("3 texts left out", "", "zwei\nZeilen\0"),
    )


def fit_with_shape() -> ss.SplineSDF:
    """A quadtree of three levels with any ordinates: a file asks for no more than that."""
    mesh = Quadtree.uniform((-0.1, -0.1, 1.1, 1.1), 4, 4)
    for cell in (5, 9):
        mesh = refine(mesh, np.arange(len(mesh.leaves)) == cell)
    ordinates = np.random.default_rng(5).normal(size=(len(mesh.leaves), 8))
    return ss.SplineSDF(mesh, ordinates, shape=two_loops(), made=MADE)


def fields_of(path: Path) -> dict[str, np.ndarray]:
    with np.load(path) as stored:
        return dict(stored)


def about(fields: dict[str, np.ndarray]) -> dict[str, Any]:
    """What the JSON in a file says."""
    result: dict[str, Any] = json.loads(fields["about"].tobytes())
    return result


def with_about(fields: dict[str, np.ndarray], said: Any) -> dict[str, np.ndarray]:
    text = said if isinstance(said, bytes) else json.dumps(said).encode()
    return {**fields, "about": np.frombuffer(text, dtype=np.uint8)}


def version_1(fields: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The fields as the first version of the format had them."""
    rest = {key: fields[key] for key in ("format", "domain", "shape", "split", "ordinates")}
    words = {"name": np.array("kite"), "y_down": np.array(True), "version": np.array(1)}
    return rest | words


def full_tree(levels: int) -> Quadtree:
    """Four roots, halved everywhere so many times: 4 ** (levels + 1) leaves."""
    counts = [4 ** (level + 1) for level in range(levels + 1)]
    split = np.arange(sum(counts)) < sum(counts[:-1])
    return Quadtree.from_splits((0.0, 0.0, 1.0, 1.0), (2, 2), split)


@contextlib.contextmanager
def before_line(number: int, act: Callable[[], object]) -> Iterator[list[int]]:
    """Do something before the line of ours or of zipfile that is run after so many others.

    Yields how many lines are left before it, below zero once it was done.
    """
    ours = str(Path(ss.__file__).parent)
    left = [number]

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        name = frame.f_code.co_filename
        if not (name.startswith(ours) or name == zipfile.__file__):
            return None
        if event == "line":
            left[0] -= 1
            if left[0] < 0:
                sys.settrace(None)
                act()
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        yield left
    finally:
        sys.settrace(before)
