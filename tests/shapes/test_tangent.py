"""Curves that touch in one point and bend apart, with halves in common but for rounding."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import splinesdf as ss

Loop = list[np.ndarray]

# The upper outlines of twemoji's 1f96e.svg (CC BY 4.0): all touch in (18, 4.003).
SLICES = (
    "M35.15 20.01c-.115-3.396-.216-7.078-.216-7.078 0-4.97-7.545-8.929-16.934-8.929-9.389 0-17 "
    "4.03-17 9L18 25.004z",
    "M18 4.003c-9.389 0-17 4.03-17 9 0 1.905 1.125 3.669 3.033 5.124L18 13.003l5.653 8.48C30.259 "
    "20.248 35 16.922 35 13.003c0-4.97-7.611-9-17-9z",
    "M18 4.003c-8.837 0-16 3.806-16 8.5 0 1.942 1.24 3.727 3.304 5.158L18 13.003l5.042 "
    "7.563C29.405 19.443 34 16.26 34 12.503c0-4.694-7.163-8.5-16-8.5z",
    "M18 4.003c-8.317 0-15.059 3.582-15.059 8 0 1.985 1.369 3.797 3.622 5.196L18 13.003l4.431 "
    "6.647c6.154-1.006 10.628-4.049 10.628-7.647 0-4.418-6.742-8-15.059-8z",
)


def polygon(loop: Loop) -> shapely.Polygon:
    """A loop of lines and cubics, by 2,000 chords each."""
    t = np.linspace(0.0, 1.0, 2001)[:-1, None]
    powers = {
        2: [1.0 - t, t],
        4: [(1.0 - t) ** 3, 3.0 * t * (1.0 - t) ** 2, 3.0 * t * t * (1.0 - t), t**3],
    }
    rows = [sum(w * p for w, p in zip(powers[len(piece)], piece, strict=True)) for piece in loop]
    return shapely.make_valid(shapely.Polygon(np.concatenate(rows)))


def tangent_loops(rng: np.random.Generator) -> list[Loop]:
    """Loops that touch in one point; halves are drawn from a few, and differ by roundings."""
    halves = [
        (rng.uniform(9, 17), rng.uniform(4, 9), rng.uniform(2, 7))
        for _ in range(rng.integers(2, 5))
    ]
    at, angle = rng.uniform(-30, 30, 2), rng.uniform(0, 2 * np.pi) * rng.integers(2)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    loops = []
    for _ in range(rng.integers(2, 6)):
        (wide, flat, steep), (other, even, low) = (
            halves[k] for k in rng.integers(len(halves), size=2)
        )
        pieces = [
            np.array([[0, 0], [-flat, 0], [-wide, steep], [-wide, 8]]),
            np.array([[-wide, 8], [other, 8]]),
            np.array([[other, 8], [other, low], [even, 0], [0, 0]]),
        ]
        loop = [(piece @ turn + at).round(3) for piece in pieces]
        loop = [p + rng.integers(-2, 3, p.shape) * np.spacing(np.abs(p)) for p in loop]
        for piece, following in zip(loop, [*loop[1:], loop[0]], strict=True):
            following[0] = piece[-1]
        loops.append(loop)
    return loops


def check(shape: ss.Shape, loops: list[Loop]) -> None:
    """The boundary is closed and encloses the union, by chords and Shapely."""
    following = shape.boundary.following
    assert np.array_equal(np.sort(following), np.arange(len(following)))
    region = shapely.union_all([polygon(loop) for loop in loops])
    assert shape.area == pytest.approx(region.area, rel=2e-6)


@pytest.mark.parametrize("seed", range(40))
def test_loops_with_halves_in_common_are_united(seed: int) -> None:
    loops = tangent_loops(np.random.default_rng(seed))
    check(ss.Shape.from_pieces(loops, fill="nonzero"), loops)


def test_slices_that_touch_in_one_point_are_united() -> None:
    shapes = [ss.Shape.from_svg_path(path, fill="nonzero") for path in SLICES]
    loops = [list(loop) for shape in shapes for loop in shape]
    check(ss.Shape.from_pieces(loops, fill="nonzero"), loops)
