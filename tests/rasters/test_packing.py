"""Rectangles on shelves: all of them placed, within the picture, none over another."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.rasters.packing import packed

SIDES = st.lists(st.tuples(st.integers(1, 60), st.integers(1, 60)), min_size=1, max_size=60)


@given(SIDES)
def test_each_texel_has_one_owner_at_most(sizes: list[tuple[int, int]]) -> None:
    (width, height), places = packed(sizes, 10_000)
    assert len(places) == len(sizes)
    owners = np.zeros((height, width), dtype=int)
    for (wide, high), (column, row) in zip(sizes, places, strict=True):
        assert 0 <= column <= width - wide
        assert 0 <= row <= height - high
        owners[row : row + high, column : column + wide] += 1
    assert owners.max() == 1
    assert np.count_nonzero(owners) == sum(wide * high for wide, high in sizes)
    assert height <= width
    assert width % 4 == height % 4 == 0


def test_like_ones_fill_most_of_a_square() -> None:
    generator = np.random.default_rng(3)
    sizes = [(int(w), int(h)) for w, h in generator.integers(15, 40, (500, 2))]
    (width, height), _ = packed(sizes, 10_000)
    assert sum(w * h for w, h in sizes) > 0.85 * width * height
    assert width < 1.1 * height


def test_nothing_takes_four_texels() -> None:
    assert packed([], 10_000) == ((4, 4), [])


@pytest.mark.parametrize("sizes", [[(41, 3)], [(3, 41)], [(10, 10)] * 17])
def test_what_does_not_fit_is_refused(sizes: list[tuple[int, int]]) -> None:
    with pytest.raises(ss.InputError, match="fit into 40 x 40 texels"):
        packed(sizes, 40)
