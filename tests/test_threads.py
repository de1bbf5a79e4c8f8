"""Several threads at once, with one shape and one spline: each gets what it gets alone."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import splinesdf as ss

POINTS = np.random.default_rng(2).uniform(-20, 140, (3000, 2))

WORK: dict[str, Callable[[ss.Shape, ss.SplineSDF], Any]] = {
    "distance": lambda shape, _: ss.signed_distance(shape, POINTS),
    "grid": lambda shape, _: ss.signed_distance_grid(shape, 60, 40).distance,
    "closest point": lambda shape, _: ss.closest_point(shape, POINTS),
    "offset": lambda shape, _: [c.arcs for c in ss.offset(shape, [-2.0, 3.0], tolerance=0.01)],
    "fit": lambda shape, _: ss.fit(shape, 2.0).spline.ordinates,
    "spline": lambda _, spline: spline(POINTS),
    "level set": lambda _, spline: [c.arcs for c in spline.contours(1.0)],
    "area": lambda shape, _: shape.area,
    "drawing": lambda _, __: ss.example("part").control,
}


def equal(one: Any, other: Any) -> bool:
    if isinstance(one, list):
        return len(one) == len(other) and all(map(equal, one, other))
    return bool(np.array_equal(one, other, equal_nan=True))


@pytest.fixture(scope="module")
def alone() -> dict[str, Any]:
    shape = ss.example("part")
    spline = ss.fit(shape, 1.0).spline
    return {name: work(shape, spline) for name, work in WORK.items()}


def asked_at_once(shape: ss.Shape, spline: ss.SplineSDF) -> dict[str, Any]:
    """What each work answers when all begin together."""
    together = threading.Barrier(len(WORK))

    def ask(name: str) -> Any:
        together.wait(60)
        return WORK[name](shape, spline)

    with ThreadPoolExecutor(len(WORK)) as pool:
        return dict(zip(WORK, pool.map(ask, WORK), strict=True))


def test_threads_with_one_shape_answer_as_one_thread_does(alone: dict[str, Any]) -> None:
    spline = ss.fit(ss.example("part"), 1.0).spline
    for _ in range(3):
        # Nothing is made yet: what is made on first use is made by all threads at once.
        own = ss.SplineSDF(spline.mesh, spline.ordinates)
        answers = asked_at_once(ss.example("part"), own)
        wrong = [name for name in WORK if not equal(answers[name], alone[name])]
        assert not wrong
