"""What can be closest in a disk: all that is closest somewhere, the nearest nodes first."""

from __future__ import annotations

import numpy as np
import pytest

from splinesdf.arclets.kernels import culling
from tests.compiled import from_python
from tests.glyphs import glyphs
from tests.named_shapes import gamma

SHAPES = {"gamma2": lambda: gamma("gamma2"), "glyph": lambda: glyphs()["DejaVuSans:g"]}
cull = from_python(culling._cull)


@pytest.mark.parametrize("filled", [-np.inf, 0.0, np.inf])
@pytest.mark.parametrize("name", SHAPES)
def test_nodes_are_in_order_whatever_the_room_for_them_holds(name: str, filled: float) -> None:
    shape = SHAPES[name]()
    tree, arcs = shape.boundary.tree, shape.boundary.arcs
    stack = np.zeros(culling._STACK, dtype=np.int64)
    random = np.random.default_rng(5)
    most = 0
    for _ in range(100):
        x, y = shape.size * random.uniform(-0.7, 0.7, 2)
        r = shape.size * 10.0 ** random.uniform(-3.0, -0.5)
        kept = np.full(culling.MOST_KEPT, -1)
        bounds = np.full(culling.MOST_KEPT, filled)
        count = cull(tree, arcs, (x, y, r), np.zeros(1, dtype=np.int64), kept, bounds, stack)
        assert count >= 1
        assert np.all(kept[:count] >= 0)
        assert len(set(kept[:count])) == count
        assert np.all(kept[count:] == -1)
        assert np.all(np.diff(bounds[:count]) >= 0.0)
        most = max(most, count)
    assert most > 5
