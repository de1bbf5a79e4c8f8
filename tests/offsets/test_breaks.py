"""Where runs of parallels are cut before conics are fitted: where they bend to the other side."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from splinesdf.offsets.kernels import conic_fit
from splinesdf.offsets.runs import _straight_parts
from splinesdf.offsets.tables import Parallels, Path
from tests.compiled import from_python

find_breaks = from_python(conic_fit._find_breaks)


@pytest.mark.parametrize("distance", [-0.1, 0.0, 0.1])
@pytest.mark.parametrize("stretches", [1, 2, 3])
def test_a_run_is_cut_where_it_bends_to_the_other_side(stretches: int, distance: float) -> None:
    cuts = np.arange(stretches + 1) / stretches
    elements = np.zeros((stretches, 2), dtype=np.int64)
    spans = np.stack([cuts[:-1], cuts[1:]], axis=1)
    path = Path(elements, spans, (0.0, 0.0), (1.0, 0.0), False)
    # In every part of a stretch, of which eight are compared.
    for at in (np.arange(24) + 0.4) / 24.0:
        # (t, (t - at)³), which bends as t - at does, and so do its parallels.
        powers = [1.0, 3.0 * at * at, 0.0, -3.0 * at, 0.0, 1.0]
        arcs = np.zeros((1, 32))
        arcs[0, :11] = 3.0, 1.0, (1.0 - at) ** 3, 0.0, -(at**3), *powers
        tangents = np.zeros((1, 4))
        breaks = np.full(8 * stretches + 8, np.nan)
        levels = Parallels(distance, arcs, np.zeros(1), tangents)
        count = find_breaks(levels, path, breaks)
        assert breaks[:count] == pytest.approx([0.0, at * stretches, stretches], abs=1e-9)


@pytest.mark.parametrize("allowed", [1e-3, 0.02, 0.3])
def test_a_nearly_straight_chain_is_cut_to_the_longest_lines_that_pass_near(allowed: float) -> None:
    """Also with steps that are shorter than lines may be off."""
    random = np.random.default_rng(7)
    for _ in range(50):
        x = np.cumsum(10.0 ** random.uniform(-4.0, 0.0, 30))
        chain = np.column_stack([x, random.uniform(-1.0, 1.0, 30) * 1.5 * allowed])
        # The last segments of all lines, of which the chain's own is not named.
        last = [*_straight_parts(chain, allowed).tolist(), len(chain) - 2]
        assert last == sorted(set(last))
        first = 0
        for end in last:
            assert off_line(chain[first : end + 2]) <= allowed * (1.0 + 1e-9)
            if end < last[-1]:  # one vertex more is too many
                line = shapely.LineString(chain[[first, end + 2]])
                away = shapely.distance(line, shapely.points(chain[first : end + 3]))
                assert away.max() > allowed * (1.0 - 1e-9)
            first = end + 1


def off_line(points: np.ndarray) -> float:
    """How far points are from the line through the first and the last of them, at most."""
    x, y = (points - points[0]).T
    return float(np.abs(x * y[-1] - y * x[-1]).max() / np.hypot(x[-1], y[-1]))
