"""Where runs of parallels are cut before conics are fitted: where they bend to the other side."""

from __future__ import annotations

import numpy as np
import pytest

from splinesdf.offsets.kernels import conic_fit
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
