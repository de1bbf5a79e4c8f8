"""Coordinates from the smallest float to the largest: an answer or one clear line, and no warning.

Warnings of NumPy are errors here, as everywhere in these tests.
"""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.distance.exact import distance_and_gradient

# What lies beside overflow, underflow and rounding, of a number, its square and its fourth power.
MAGNITUDES = [
    *(0.0, 1.0, 2.0, 3.0, 4.0, 0.25, 5e-324, 1e-320, 2.3e-308, 1e-300, 1e-162, 1.5e-154, 1e-100),
    *(1e-81, 1e-77, 1e-60, 1e-30, 1e-16, 3e-14, 1e-9, 1e-6, 1e6, 1e9, 1e16, 1e17, 1e30, 1e59, 1e60),
    *(1e61, 1e77, 1e100, 1e154, 1e155, 1e300, 1.7e308),
]
# Mostly plain ones: a drawing in which everything is extreme is refused at once.
numbers = st.one_of(
    st.sampled_from(MAGNITUDES[:6]),
    st.sampled_from(MAGNITUDES),
    st.integers(-9, 9).map(float),
).flatmap(lambda x: st.sampled_from([x, -x]))
points = st.lists(st.tuples(numbers, numbers), min_size=3, max_size=6)
commands = st.one_of(
    st.tuples(st.just("L"), numbers, numbers),
    st.tuples(st.just("Q"), *[numbers] * 4),
    st.tuples(st.just("C"), *[numbers] * 6),
    st.tuples(st.just("A"), *[numbers] * 3, st.just(0), st.just(1), numbers, numbers),
)
paths = st.tuples(st.lists(commands, min_size=2, max_size=4), numbers, numbers).map(
    lambda all_: (
        f"M {all_[1]!r} {all_[2]!r} "
        + " ".join(" ".join(map(str, command)) for command in all_[0])
        + " Z"
    )
)
formulas = st.tuples(
    st.sampled_from(
        [
            *("{a}*cos(t)+{b}", "cos(t)^{a}+{b}", "cos(t)*exp({a}*cos(t))+{b}", "{a}/(2+cos(t))"),
            *("log({a}+cos(t))", "sqrt({a}+cos(t))", "sinh({a}*cos(t))", "abs({a}*cos(t))^1.5"),
        ]
    ),
    numbers,
    numbers,
).map(lambda all_: all_[0].format(a=f"({all_[1]!r})", b=f"({all_[2]!r})"))


def ask(make: Any) -> None:
    """Make the shape, and ask of it all that there is; errors of ours may end it anywhere."""
    with contextlib.suppress(ss.SplineSDFError):
        shape = make()
        assert np.isfinite(shape.box).all()
        asked = np.array([[0.3, 0.7], [0.0, 0.0], [1e-310, 1.0], [1e300, -1.0], [np.inf, 0.0]])
        asked = np.concatenate([asked, shape.control[:3], np.mean(shape.control, axis=0)[None]])
        distance = ss.signed_distance(shape, asked)
        assert np.array_equal(np.isnan(distance), ~np.isfinite(asked).all(axis=1))
        ss.project(shape, asked)
        distance_and_gradient(shape, asked)
        ss.signed_distance_grid(shape, 3, 3)
        size = shape.size
        for share in (-0.1, 0.1):
            with contextlib.suppress(ss.SplineSDFError):
                for contour in ss.offset(shape, share * size, tolerance=1e-2 * size):
                    _ = contour.length, contour.area
        with contextlib.suppress(ss.SplineSDFError):
            try:
                result = ss.fit(shape, tolerance=0.1 * size, max_cells=200)
            except ss.ToleranceNotReached as error:
                result = error.result
            spline = result.spline
            spline.value_and_gradient(asked), spline.curvature(asked), spline.normal(asked)
            spline.closest_point(asked)
            spline.contours(0.1 * size)


@given(points, st.booleans(), st.booleans())
@settings(max_examples=150)
def test_polygons(corners: list[tuple[float, float]], smooth: bool, evenodd: bool) -> None:
    fill = "evenodd" if evenodd else "nonzero"
    ask(lambda: ss.Shape.from_points(corners, smooth=smooth, fill=fill))


@given(paths)
@settings(max_examples=100)
def test_paths(path: str) -> None:
    ask(lambda: ss.Shape.from_svg_path(path))


@given(formulas, formulas)
@settings(max_examples=100)
def test_formulas(x: str, y: str) -> None:
    ask(lambda: ss.Shape.from_formula(x, y.replace("cos", "sin")))


@given(points, st.integers(1, 5), st.lists(numbers, min_size=3, max_size=6), st.booleans())
@settings(max_examples=100)
def test_nurbs(
    control: list[tuple[float, float]], degree: int, weights: list[float], periodic: bool
) -> None:
    count = min(len(control), len(weights))
    ask(
        lambda: ss.Shape.from_nurbs(
            control[:count],
            degree=degree,
            weights=np.abs(weights[:count]),
            periodic=periodic,
            close=True,
        )
    )


@pytest.mark.parametrize(
    "make",
    [
        lambda: ss.Shape.from_points([[0.0, 0.0], [4.0, 0.0], [4.0, 1e-320]]),
        lambda: ss.Shape.from_formula("cos(t)^1e154", "sin(t)^1e154"),
        lambda: ss.Shape.from_svg_path("M0 0H4V4H0Z M1e22 0H1e22V9H1e22Z"),
        lambda: ss.Shape.from_svg_path("M0 0H4V4H0Z M1e17 0H1.000000000000001e17V9H1e17Z"),
    ],
)
def test_what_warned_once(make: Any) -> None:
    ask(make)
