"""Formulas with corners and cusps, and curves of several sections, from code and from JSON."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.arclets.points import evaluate_bezier
from splinesdf.shapes.sources.compiled import compile_curve
from splinesdf.shapes.sources.formula import parse_curve

EPS = float(np.finfo(float).eps)
# Irrational steps, so that no sample is a node of an interpolant.
SAMPLES = np.sort((np.arange(1, 40) * (math.sqrt(5.0) - 1.0) / 2.0) % 1.0)

Section = tuple[str, str, tuple[float | str, float | str]]


def dense(pieces: list[np.ndarray]) -> np.ndarray:
    return np.concatenate([evaluate_bezier(piece, SAMPLES) for piece in pieces])


def compiled(x: str, y: str, t: tuple[float | str, float | str]) -> list[np.ndarray]:
    return compile_curve(parse_curve(x, y, t))


# --- min and max ---------------------------------------------------------------------------------


@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_min_and_max_choose_values_and_derivatives(t: float, other: float) -> None:
    at = np.array([t])
    for name, choose in (("min", np.minimum), ("max", np.maximum)):
        curve = parse_curve(f"{name}(t^3, {other!r})", f"{name}({other!r}, t^3)", (0.0, 1.0))
        value = float(np.power(at, 3.0)[0])
        assert np.array_equal(curve(at), np.full((1, 2), choose(value, other)))
        point, first, second = curve.jet(at)
        assert np.array_equal(point, curve(at))
        if value != other:
            chosen = choose(value, other) == value
            assert first == pytest.approx(3.0 * t**2 if chosen else 0.0, rel=1e-15)
            assert second == pytest.approx(6.0 * t if chosen else 0.0, rel=1e-15)


def test_min_and_max_where_both_are_equal_or_undefined() -> None:
    curve = parse_curve("max(t, -t)", "min(2*t, log(t))", (-1.0, 1.0))
    _, first, second = curve.jet(np.zeros(1))
    assert abs(first[0, 0]) == 1.0
    assert second[0, 0] == 0.0
    assert np.isnan(curve(np.array([-0.5]))[0, 1])
    assert np.isnan(curve.jet(np.array([-0.5]))[0][0, 1])
    # Of numbers alone they are a number.
    assert parse_curve("t", "t", ("min(2, 3)", "max(2, 3)")).stop == 3.0


@pytest.mark.parametrize(
    "text", ["min(t)", "max()", "min(t, t, t)", "max(a=t, b=t)", "max(*t)", "min", "sin(t, t)"]
)
def test_min_and_max_take_two_arguments(text: str) -> None:
    with pytest.raises(ss.InputError, match=r"not allowed in a formula.*min"):
        parse_curve(text, "t", (0.0, 1.0))


def test_a_triangle_wave() -> None:
    pieces = compiled("t", "max(min(t, 2 - t), t - 4)", (-1.0, 5.0))
    # Three corners, each hit by splitting alone after a few times.
    assert len(pieces) <= 60
    t, y = dense(pieces).T
    assert np.abs(y - np.maximum(1.0 - np.abs(t - 1.0), t - 4.0)).max() <= 8 * EPS * 5.0


def test_a_rounded_square() -> None:
    # The circle of radius 1.25 cut off at 1 from all sides: eight corners.
    x, y = "max(-1, min(1, 1.25*cos(t)))", "max(-1, min(1, 1.25*sin(t)))"
    shape = ss.Shape.from_formula(x, y)
    assert shape.piece_count <= 120
    points = dense([shape.piece(i) for i in range(shape.piece_count)])
    off = np.minimum(np.abs(np.hypot(*points.T) - 1.25), np.abs(np.abs(points).max(axis=1) - 1.0))
    # The noise of cos and sin over the whole range, 8 ulp; a corner is known to the ulp of t = 6.
    assert off.max() < 16 * EPS
    assert np.abs(points).max() < 1.0 + 4 * EPS
    assert ss.signed_distance(shape, np.array([[0.0, 0.0], [3.0, 0.0]])) == pytest.approx(
        [-1.0, 2.0], abs=1e-15
    )


# --- cusps ---------------------------------------------------------------------------------------


CUSPED = {
    "astroid": ("cos(t)^3", "sin(t)^3"),
    "deltoid": ("2*cos(t) + cos(2*t)", "2*sin(t) - sin(2*t)"),
    "cardioid": ("(1 + cos(t))*cos(t)", "(1 + cos(t))*sin(t)"),
}


@pytest.mark.parametrize("shift", ["t", "(t + 0.3)"])
@pytest.mark.parametrize("name", CUSPED)
def test_cusps_take_few_pieces_and_lose_nothing(name: str, shift: str) -> None:
    x, y = (text.replace("(t)", f"({shift})").replace("*t", f"*{shift}") for text in CUSPED[name])
    pieces = compiled(x, y, (0.0, "2*pi"))
    assert len(pieces) <= 100
    px, py = dense(pieces).T
    square = px * px + py * py
    if name == "astroid":
        # |x|^(1/3) would be lost near the axes: the curve is f = 0 with grad f -> 0 at its cusps.
        f = (square - 1.0) ** 3 + 27.0 * px**2 * py**2
        size = 1.0
    elif name == "deltoid":
        f = square**2 + 18.0 * square - 27.0 - 8.0 * (px**3 - 3.0 * px * py**2)
        size = 3.0**4
    else:
        f = (square - px) ** 2 - square
        size = 4.0**2
    # f is of degree 4 or 6 and its terms go up to 4 times size; 16 ulp for each coordinate.
    assert np.abs(f).max() < 4 * 6 * 16 * EPS * size


def test_a_semicubical_cusp_closed_by_a_section() -> None:
    shape = ss.Shape.from_formulas([("t^2", "t^3", (-1, 1)), ("1", "-t", (-1, 1))])
    assert shape.piece_count <= 8
    points = dense([shape.piece(i) for i in range(shape.piece_count)])
    off = np.minimum(np.abs(points[:, 1] ** 2 - points[:, 0] ** 3), np.abs(points[:, 0] - 1.0))
    assert off.max() < 16 * EPS
    # At the left the cusp itself is nearest.
    assert ss.signed_distance(shape, np.array([[-2.0, 0.0]])) == pytest.approx([2.0], abs=1e-15)


# --- sections ------------------------------------------------------------------------------------

STADIUM: list[Section] = [
    ("1 + sin(t)", "-cos(t)", (0.0, "pi")),
    ("1 - t", "1", (0, 2)),
    ("-1 - sin(t)", "cos(t)", (0.0, "pi")),
    ("t", "-1", (-1, "1")),
]


def stadium_distance(points: np.ndarray) -> np.ndarray:
    x, y = points.T
    return np.hypot(np.maximum(np.abs(x) - 1.0, 0.0), y) - 1.0


def test_a_stadium_of_four_sections() -> None:
    shape = ss.Shape.from_formulas(iter(STADIUM), name="stadium", fill="evenodd")
    assert (shape.name, shape.fill, shape.loop_count) == ("stadium", "evenodd", 1)
    # 40 for a circle, and at most 4 for a line.
    assert shape.piece_count <= 48
    points = np.random.default_rng(1).uniform(-3.0, 3.0, (1000, 2))
    assert np.abs(ss.signed_distance(shape, points) - stadium_distance(points)).max() < 1e-14


def test_the_same_stadium_as_one_formula() -> None:
    angle = "(min(t, pi) + min(max(t - pi - 2, 0), pi))"
    x = f"1 - min(max(t - pi, 0), 2) + max(t - 2*pi - 2, 0) + sin{angle}"
    shape = ss.Shape.from_formula(x, f"-cos{angle}", t=(0.0, "2*pi + 4"))
    points = np.random.default_rng(1).uniform(-3.0, 3.0, (1000, 2))
    # A sudden bend is not a corner to fix an end at: more pieces, and as exact.
    assert shape.piece_count <= 160
    assert np.abs(ss.signed_distance(shape, points) - stadium_distance(points)).max() < 1e-14


def test_a_superellipse_of_sections() -> None:
    # x^4 + y^4 = 1, as graphs over the flat sides: the angle as a parameter has infinite slopes.
    graph, end = "(1 - t^4)^(1/4)", "2^(-1/4)"
    span = (f"-({end})", end)
    sections = [
        (graph, "t", span),
        ("-t", graph, span),
        (f"-{graph}", "-t", span),
        ("t", f"-{graph}", span),
    ]
    shape = ss.Shape.from_formulas(sections)
    points = dense([shape.piece(i) for i in range(shape.piece_count)])
    # Powers of 4 make 4 ulp of each coordinate 16.
    assert np.abs((points**4).sum(axis=1) - 1.0).max() < 32 * EPS
    assert ss.signed_distance(shape, np.zeros((1, 2))) == pytest.approx([-1.0], abs=1e-15)


@given(st.integers(0, 3))
def test_any_section_may_come_first(start: int) -> None:
    shape = ss.Shape.from_formulas(STADIUM[start:] + STADIUM[:start])
    points = np.random.default_rng(2).uniform(-3.0, 3.0, (100, 2))
    assert np.abs(ss.signed_distance(shape, points) - stadium_distance(points)).max() < 1e-14


def test_sections_must_follow_one_another() -> None:
    with pytest.raises(ss.OpenContourError, match=r"goes on at \(-1, 1\): its pieces must join"):
        ss.Shape.from_formulas([STADIUM[0], STADIUM[2], STADIUM[3]])
    with pytest.raises(ss.OpenContourError, match=r"ends at \(-1, -1\) but starts at \(1, -1\)"):
        ss.Shape.from_formulas(STADIUM[:3])
    assert ss.Shape.from_formulas(STADIUM[:3], close=True).piece_count >= 40


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ([], "at least one closed curve"),
        ([STADIUM[0], ("t", "1")], r"section 2: expected \(x, y, \(start, stop\)\), got"),
        ([STADIUM[0], None], "section 2: expected .* got 'None'"),
        ([STADIUM[0], ("t", "os", (0, 1))], "section 2: not allowed in a formula: 'os'"),
        ([("t", "1/t", (0, 1))], "section 1: the curve is not finite at t = 0"),
        ([("t", "1", (1, 0))], "section 1: expected a range of t with start < stop"),
    ],
)
def test_bad_sections_are_refused_by_number(sections: list[Section], message: str) -> None:
    with pytest.raises(ss.InputError, match=message) as caught:
        ss.Shape.from_formulas(sections)
    assert "\n" not in str(caught.value)


# --- JSON ----------------------------------------------------------------------------------------


def read(tmp_path: Path, content: object, **options: bool) -> ss.Shape:
    path = tmp_path / "curve.json"
    path.write_text(json.dumps(content))
    return ss.read(path, **options)


JSON_STADIUM = [{"x": x, "y": y, "t": list(t)} for x, y, t in STADIUM]


def test_sections_in_a_file(tmp_path: Path) -> None:
    expected = ss.Shape.from_formulas(STADIUM)
    alone = read(tmp_path, {"sections": JSON_STADIUM, "name": "slot", "fill": "evenodd"})
    assert np.array_equal(alone.control, expected.control)
    assert (alone.name, alone.fill) == ("slot", "evenodd")
    hole = {"x": "cos(t)/2", "y": "-sin(t)/2"}
    both = read(tmp_path, {"loops": [{"sections": JSON_STADIUM}, hole]})
    assert both.loop_count == 2
    assert np.array_equal(both.control[: len(expected.control)], expected.control)
    with pytest.raises(ss.OpenContourError):
        read(tmp_path, {"sections": JSON_STADIUM[:3]})
    assert read(tmp_path, {"sections": JSON_STADIUM[:3]}, close=True).loop_count == 1


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"sections": []}, '"sections" to be a list of curves, got an empty list'),
        ({"sections": {"x": "t"}}, '"sections" to be a list of curves, got an object'),
        ({"sections": ["t"]}, "section 1: expected an object .* got text"),
        ({"sections": JSON_STADIUM, "x": "t"}, "keys sections, fill, name, got 'x'"),
        ({"sections": [JSON_STADIUM[0], {"x": "t"}]}, 'section 2: .* "y", got nothing'),
        ({"sections": [{"x": "t", "y": "t", "fill": "evenodd"}]}, "section 1: .* got 'fill'"),
        ({"sections": [{"sections": JSON_STADIUM}]}, "section 1: .* got 'sections'"),
        ({"loops": [{"sections": JSON_STADIUM, "name": "a"}]}, "loop 1: .* got 'name'"),
        ({"loops": [{"sections": [{"x": "t", "y": "os"}]}]}, "loop 1: section 1: not allowed"),
        ({"loops": [{"loops": JSON_STADIUM}]}, "loop 1: .* got 'loops'"),
        ({"loops": [], "sections": JSON_STADIUM}, "got 'sections'"),
    ],
)
def test_bad_sections_in_a_file(tmp_path: Path, content: object, message: str) -> None:
    with pytest.raises(ss.InputError, match=message) as caught:
        read(tmp_path, content)
    assert "\n" not in str(caught.value)
