"""Closest points where little can be closest: what is convex, and how soon steps end."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest
from numpy.polynomial import Polynomial

import splinesdf as ss
from splinesdf.arclets.kernels import nearest_convex
from tests.compiled import from_python
from tests.glyphs import glyphs
from tests.named_shapes import gamma

SHAPES = {
    "gamma2": lambda: gamma("gamma2"),
    "glyph": lambda: glyphs()["DejaVuSans:g"],
    "cubics": lambda: ss.Shape.from_pieces(
        [[np.array([[0.0, 0.0], [0.5, -0.4], [1.2, 0.1], [1.5, 0.9]])]], close=True
    ),
}
all_convex = from_python(nearest_convex._all_convex)
try_cubic = from_python(nearest_convex._try_cubic)


def coefficients(polynomial: Polynomial, degree: int) -> np.ndarray:
    """In Bernstein's basis on [0, 1]."""
    a = np.append(polynomial.coef, np.zeros(degree + 1 - len(polynomial.coef)))
    shares = [[comb(k, i) / comb(degree, i) for i in range(degree + 1)] for k in range(degree + 1)]
    return np.array(shares) @ a


@pytest.mark.parametrize("name", SHAPES)
def test_distances_are_convex_by_their_second_derivatives(name: str) -> None:
    boundary = SHAPES[name]().boundary
    random = np.random.default_rng(3)
    leaves = np.flatnonzero(np.diff(boundary.range, axis=1)[:, 0] == 1)
    size = float(np.ptp(boundary.start, axis=0).max())
    said = []
    for _ in range(400):
        node = int(random.choice(leaves))
        i = int(boundary.range[node, 0])
        degree = int(boundary.arcs[i, 0])
        if degree == 1:
            continue
        x, y = (Polynomial(boundary.power[i, : degree + 1, k]) for k in range(2))
        vx, vy = size * random.normal(size=2) * 10.0 ** random.uniform(-2.0, 0.5)
        reach = size * 10.0 ** random.uniform(-3.0, 0.5)
        # Of |c|² - 2 v c, the second derivative; how much that of any other point differs.
        most = 2 * degree - 2
        bends = coefficients((x * x + y * y - 2.0 * (vx * x + vy * y)).deriv(2), most)
        rest = np.hypot(*(coefficients(part.deriv(2), most) for part in (x, y)))
        least = float((bends - 2.0 * reach * rest).min())
        if abs(least) < 1e-9 * (np.abs(bends).max() + reach * rest.max()):
            continue
        px, py = boundary.start[i] + [vx, vy]
        kept = np.array([node])
        assert all_convex(boundary.tree, boundary.arcs, px, py, reach, kept) == (least > 0.0)
        said.append(least > 0.0)
    assert 0.1 < np.mean(said) < 0.9


@pytest.mark.parametrize("length", [0.01, 0.4, 6.0])
def test_two_steps_to_a_foot_are_enough(length: float) -> None:
    """On cubics that bend little; what ended is the foot."""
    random = np.random.default_rng(4)
    ended = 0
    for _ in range(200):
        power = np.zeros((7, 2))
        angle = random.uniform(-np.pi, np.pi)
        power[0] = np.cos(angle), np.sin(angle)
        power[1:3] = random.uniform(-0.05, 0.05, (2, 2))
        power *= length
        start, end = np.zeros(2), power.sum(axis=0)
        row = np.array([[3.0, *end, *start, *power[:3].ravel()]])
        normal = np.array([-power[0, 1], power[0, 0]])
        point = random.uniform(-0.2, 1.2) * power[0] + random.uniform(-0.3, 0.3) * normal
        squared, at, arclet = np.full(1, np.inf), np.full(1, np.nan), np.full(1, -1)
        if try_cubic(row, 0, power, point[None], squared, arclet, at) > 0:
            continue
        ended += 1
        x, y = (Polynomial([start[k] - point[k], *power[:3, k]]) for k in range(2))
        exact = x * x + y * y
        roots = exact.deriv().roots()
        places = np.append([0.0, 1.0], roots[abs(roots.imag) < 1e-9].real.clip(0.0, 1.0))
        assert arclet[0] == 0
        assert at[0] == pytest.approx(places[exact(places).argmin()], abs=1e-13)
        assert squared[0] == pytest.approx(exact(places).min(), abs=1e-13 * length * length)
    # The others would take a third step.
    assert ended > 150
