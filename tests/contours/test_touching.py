"""Contours that touch: what lies in what, wherever they begin; by distances of centers."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.contours.nesting import _places, enclosed, nested, smallest_around


def circle(x: float, y: float, radius: float, turn: float) -> ss.Contour:
    """A circle that starts at an angle, where others touch it."""
    (made,) = ss.Shape.circle((0.0, 0.0), radius).rotate(turn).translate(x, y).offset(0.0)
    return made


@settings(max_examples=40)
@given(st.floats(0.0, 360.0), st.sampled_from([0.25, 0.5, 1.0, 3.0]), st.booleans())
def test_circles_that_touch_lie_beside_or_in_each_other(
    degrees: float, radius: float, inner: bool
) -> None:
    angle = math.radians(degrees)
    apart = 1.0 - radius if inner else 1.0 + radius
    at = apart * math.cos(angle), apart * math.sin(angle)
    outer, other = (
        circle(0.0, 0.0, 1.0, degrees),
        circle(*at, radius, degrees + 180.0 * (not inner)),
    )
    if inner and radius == 1.0:
        return  # one and the same
    big, small = (outer, other) if radius < 1.0 else (other, outer)
    for given_ in ([big, small], [small, big]):
        parents = {id(one): made.parent for one, made in zip(given_, nested(given_), strict=True)}
        assert parents[id(big)] is None
        assert (parents[id(small)] is not None) == inner
        rows = smallest_around(given_)
        assert rows[given_.index(big)] == -1
        assert (rows[given_.index(small)] >= 0) == (inner and radius != 1.0)


def test_disks_that_touch_are_two_polygons_in_files(tmp_path: Path) -> None:
    """Once the second was a hole of the first, without a word."""
    both = ss.Shape.circle((0, 0), 1) | ss.Shape.circle((2, 0), 1)
    for name in ("a.geojson", "a.wkt"):
        ss.write(tmp_path / name, both.offset(0.0))
        assert ss.read(tmp_path / name).area == pytest.approx(2.0 * math.pi, rel=1e-5)


@pytest.mark.parametrize("place", [0, 2])
@pytest.mark.parametrize("inner", [False, True])
def test_where_one_of_the_places_that_are_asked_touches_the_other_two_decide(
    inner: bool, place: int
) -> None:
    """There rounding says in or out: of 33 turns, some this and some that."""
    big, said = circle(0.0, 0.0, 1.0, 0.0), set()
    for degrees in range(0, 360, 11):
        # Half as far as where the two touch.
        x, y = _places(circle(0.0, 0.0, 0.5, degrees))[place]
        small = circle(*((x, y) if inner else (-3.0 * x, -3.0 * y)), 0.5, degrees)
        said.add(bool(enclosed(big, _places(small)[place, None])[0]))
        assert nested([small, big])[0].parent is (big if inner else None), degrees
        assert smallest_around([small, big])[0] == (1 if inner else -1), degrees
    assert said == {False, True}
