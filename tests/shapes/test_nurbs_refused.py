"""NURBS that are no closed curve, and those that are none at all."""

from __future__ import annotations

import math

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.shapes.sources.nurbs import nurbs_pieces


def test_open_curves_are_refused_or_closed() -> None:
    arch = [(0, 0), (0, 2), (2, 2), (2, 0)]
    with pytest.raises(ss.OpenContourError, match="ends at"):
        ss.Shape.from_nurbs(arch)
    shape = ss.Shape.from_nurbs(arch, close=True, fill="evenodd")
    assert shape.piece_count == 2
    assert shape.fill == "evenodd"
    with pytest.raises(ss.InputError, match="at least one closed curve"):
        ss.Shape.from_nurbs([(1, 1)] * 4)


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"control": [(0, 0, 0)] * 4}, r"shape \(\.\.\., 2\), got shape \(4, 3\)"),
        ({"control": [SQUARE]}, r"shape \(n, 2\), got shape \(1, 4, 2\)"),
        ({"control": "text"}, "points as numbers"),
        ({"control": [(0, 0), (1, 0), (1, math.nan), (0, 1)]}, "finite control points"),
        ({"control": [(0, 0), (1, 0), (1, 1e70), (0, 1)]}, "coordinates up to 1e"),
        ({"control": SQUARE[:3]}, "at least 4 control points for degree 3, got 3"),
        ({"control": np.empty((0, 2))}, "at least 4 control points for degree 3, got 0"),
        ({"control": SQUARE[:2], "periodic": True}, "at least 3 control points .*, got 2"),
        ({"degree": 0}, "degree from 1 to 25, got 0"),
        ({"degree": 26}, "degree from 1 to 25, got 26"),
        ({"degree": 3.0}, "degree as an integer, got 3.0"),
        ({"degree": "3"}, "degree as an integer, got '3'"),
        ({"knots": [0, 0, 0, 1, 1, 1]}, "expected 8 knots for 4 .* degree 3, got 6"),
        ({"knots": [0, 0, 0, 0, 1, 1, 1, math.inf]}, "finite knots"),
        ({"knots": [0, 0, 0, 0, 1, 1, 1, 1e61]}, r"knots up to 1e\+60, got 1e\+61"),
        ({"knots": [0, 0, 0, 0, 1, 1, 0.5, 1]}, "increasing order, got 1 before 0.5"),
        ({"knots": [0, 0, 0, 0, 0, 1, 1, 1]}, r"at most degree \+ 1 = 4 times, got 0 5 times"),
        ({"knots": [0, 1, 2, 3, 3, 4, 5, 6]}, "knots that increase, got 3 all along"),
        ({"knots": "text"}, "knots as numbers, got 'text'"),
        ({"knots": 3.0}, r"a row of knots, got shape \(\)"),
        ({"knots": range(8), "periodic": True}, "one period of 5 knots .*, got 8"),
        ({"knots": [0, 0, 1, 2, 3], "periodic": True}, "first knot of a period once"),
        ({"weights": [1, 1, 1]}, r"weight for each of 4 control points, got shape \(3,\)"),
        ({"weights": [1, 0, 1, 1]}, "positive finite weights, got 0 for control point 2"),
        ({"weights": [1, 1, -2, 1]}, "positive finite weights, got -2 for control point 3"),
        ({"weights": [1, 1, 1, math.nan]}, "positive finite weights, got nan"),
        ({"weights": [1, 1, 1, math.inf]}, "positive finite weights, got inf"),
        ({"weights": [1, 1, 1, 1e-13]}, "within a factor of 1e.12, got 1e-13 and 1"),
        ({"weights": ["a"] * 4}, "weights as numbers"),
    ],
)
def test_bad_curves_are_refused_in_one_line(change: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {"control": SQUARE, "degree": 3, **change}
    with pytest.raises(ss.InputError, match=message) as caught:
        nurbs_pieces(arguments.pop("control"), **arguments)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


def test_a_jump_is_refused() -> None:
    knots = [0, 0, 1, 1, 2, 2]
    assert len(nurbs_pieces([(0, 0), (1, 0), (1, 0), (1, 1)], degree=1, knots=knots)) == 2
    with pytest.raises(ss.InputError, match=r"without jumps, .* jumps by 0.5 from \(1, 0\)"):
        nurbs_pieces([(0, 0), (1, 0), (1.5, 0), (1, 1)], degree=1, knots=knots)
