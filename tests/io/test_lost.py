"""What is so small beside its coordinates that floats lose it: named, never dropped in silence."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import splinesdf as ss

SQUARE = "<path d='M0 0H4V4H0Z'/>"


def _svg(tmp_path: Path, inner: str) -> ss.Shape:
    (tmp_path / "a.svg").write_text(f"<svg>{inner}</svg>")
    return ss.read(tmp_path / "a.svg")


@pytest.mark.parametrize("place", ["1e12", "1e17", "1e22", "-1e22"])
@pytest.mark.parametrize(
    "far",
    [
        "<rect x='{}' width='9' height='9'/>",
        "<circle cy='{}' r='4.5'/>",
        "<path d='M0 0H9V9H0Z' transform='translate({} 0)'/>",
    ],
)
def test_an_element_that_is_lost_in_rounding_is_named(tmp_path: Path, place: str, far: str) -> None:
    shape = _svg(tmp_path, SQUARE + far.format(place))
    assert ss.signed_distance(shape, (2.0, 2.0)) == -2.0
    (note,) = shape.notes
    lost = r"its size \d+ is lost beside its coordinates of"
    assert re.search(lost, note)
    with pytest.raises(ss.InputError, match=lost):
        _svg(tmp_path, far.format(place))


@pytest.mark.parametrize(("place", "size"), [("1e15", "1e7"), ("1e22", "1e14"), ("1e30", "1e29")])
def test_a_contour_that_is_lost_beside_a_far_one_is_named(
    tmp_path: Path, place: str, size: str
) -> None:
    shape = _svg(tmp_path, SQUARE + f"<rect x='{place}' width='{size}' height='{size}'/>")
    assert ss.signed_distance(shape, (2.0, 2.0)) == pytest.approx(float(place))
    (note,) = shape.notes
    assert note.startswith("left out: 1 contour of size 4 or less, lost beside coordinates of")


def test_dots_and_strokes_without_area_are_as_they_were(tmp_path: Path) -> None:
    far = "<path d='M9 9h0' stroke='red' fill='none'/><path d='M1e22 0h1' fill='none'/>"
    shape = _svg(tmp_path, SQUARE + far)
    assert not any("lost" in note for note in shape.notes)


def test_specks_alone_are_refused() -> None:
    square = [(0.0, 0.0), (1e-15, 0.0), (1e-15, 1e-15), (0.0, 1e-15)]
    specks = [[(x + a, y + b) for x, y in square] for a, b in ((0, 0), (0.125, 0), (0, 0.125))]
    with pytest.raises(ss.InputError, match=r"enclose something, got 3 contours of size"):
        ss.Shape.from_points(specks)


@pytest.mark.parametrize("text", ["0 0\n4 0\n4 1e-320\n", "0 0\n4 0\n2 1e-320\n"])
def test_a_point_beside_a_point_is_no_third(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(ss.InputError) as caught:
        ss.signed_distance(ss.read(tmp_path / "a.csv"), (1.0, 1.0))
    assert "\n" not in str(caught.value)


def test_a_formula_that_is_zero_almost_everywhere_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"x":"cos(t)^1e154","y":"sin(t)^1e154"}')
    with pytest.raises(ss.InputError, match="cannot be resolved near t"):
        ss.read(tmp_path / "a.json")
