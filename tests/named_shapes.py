"""The paper's curves and other named shapes that several tests share."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

import splinesdf as ss
from splinesdf.paper import tables
from tests import oracles

FORMULAS = {
    "gamma1": ("1/2 + 4/9*cos(t)", "1/2 + 5/11*sin(t)"),
    "gamma2": ("1/5 + (3 + 2*cos(t))*cos(t)/10", "2/5 + (3 + 2*cos(t))*sin(t)/10"),
    "gamma3": ("9/20 + 1/2*cos(3*t)*cos(t)", "9/20 + 1/2*cos(3*t)*sin(t)"),
}
Loops = list[list[np.ndarray]]  # of control points
UNIT = (0.0, 0.0, 1.0, 1.0)


@cache
def paper_rows() -> tuple[tables.Row, ...]:
    """The paper's tables, once in a process."""
    return tuple(tables.tables())


@cache
def gamma(name: str) -> ss.Shape:
    return ss.Shape.from_formula(*FORMULAS[name], name=name)


def curve(name: str, t: np.ndarray) -> np.ndarray:
    """The paper's curves written out once more, without the parser: (n,) -> (n, 2)."""
    if name == "gamma1":
        return np.stack([1 / 2 + 4 / 9 * np.cos(t), 1 / 2 + 5 / 11 * np.sin(t)], -1)
    if name == "gamma2":
        r = (3 + 2 * np.cos(t)) / 10
        return np.stack([1 / 5 + r * np.cos(t), 2 / 5 + r * np.sin(t)], -1)
    r = np.cos(3 * t) / 2
    return np.stack([9 / 20 + r * np.cos(t), 9 / 20 + r * np.sin(t)], -1)


def loops_of(shape: ss.Shape) -> Loops:
    """The pieces of each contour as they were given."""
    return [
        [oracles.piece(shape, i) for i in range(first, last)]
        for first, last in zip(shape.loops[:-1], shape.loops[1:], strict=True)
    ]


def rebuilt(shape: ss.Shape, change: Callable[[Loops], Loops]) -> ss.Shape:
    """The shape made anew from pieces that were changed."""
    return ss.Shape.from_pieces(change(loops_of(shape)), fill=shape.fill)
