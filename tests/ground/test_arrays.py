"""Arrays as they come: read-only, or lists deeper than any array."""

from __future__ import annotations

import numpy as np
import pytest

from splinesdf.errors import InputError
from splinesdf.ground.arrays import as_floats, as_points


def test_read_only_points_are_copied_for_the_kernels() -> None:
    """Kernels would be compiled once more for them."""
    given = np.array([[1.0, 2.0], [3.0, np.nan]])
    given.setflags(write=False)
    points = as_points(given)
    assert points.flags.writeable
    assert np.array_equal(points, given, equal_nan=True)
    points[0, 0] = 5.0
    assert given[0, 0] == 1.0


@pytest.mark.parametrize("depth", [70, 5000])
def test_lists_deeper_than_an_array_are_refused_in_one_line(depth: int) -> None:
    nested: object = 1.0
    for _ in range(depth):
        nested = [nested]
    with pytest.raises(InputError, match="expected points as numbers, got") as caught:
        as_floats(nested, "points")  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300
