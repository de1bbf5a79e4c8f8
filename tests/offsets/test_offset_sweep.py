"""A thinned selection of the sweep (benchmarks/offset_sweep.py), no failure allowed."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from benchmarks.offset_sweep import EXACT, Run, group, one, sampled
from tests.mechanical import SPLINES
from tests.offset_checks import judge
from tests.offset_count import loop_counts

# Group, shape, distance and tolerance as shares of the size: every kind of shape, both sides,
# near and far, coarse and fine.
CHOSEN = [
    ("curves", "gamma1", -0.3, 1e-8),
    ("curves", "gamma2", 0.3, 1e-7),
    ("curves", "gamma2", -0.03, 1e-6),
    ("curves", "gamma3", -0.03, 1e-5),
    ("curves", "gamma3", 0.01, 1e-4),
    ("glyphs", "DejaVuSans:g", 0.03, 1e-6),
    ("glyphs", "DejaVuSans:&", -0.01, 1e-5),
    ("glyphs", "DejaVuSans:Å", 0.1, 1e-4),
    ("glyphs", "DejaVuSans:%", -0.03, 1e-3),
    ("glyphs", "DejaVuSerif-Italic:k", -0.003, 1e-6),
    ("icons", "cart", 0.01, 1e-5),
    ("icons", "fingerprint", 0.01, 1e-4),
    ("icons", "airplane", -0.03, 1e-6),
    ("icons", "umbrella-fill", 0.1, 1e-5),
    ("icons", "toggles2", -0.01, 1e-5),
    ("mechanical", "flange", 0.03, 1e-6),
    ("mechanical", "flange", -0.1, 1e-4),
    ("mechanical", "slotted link", -0.1, 1e-5),
    ("mechanical", "involute gear", 0.03, 1e-8),
    ("mechanical", "airfoil rib", -0.01, 1e-6),
    ("mechanical", "cam", 0.1, 1e-7),
    ("mechanical", "star knob", 0.1, 1e-5),
    ("mechanical", "connecting rod", -0.03, 1e-5),
    ("mechanical", "sprocket", 0.03, 1e-6),
    ("mechanical", "T-slot profile", -0.01, 1e-8),
    ("polygons", "chile", 0.003, 1e-4),
]


@pytest.mark.parametrize(("title", "name", "distance", "tolerance"), CHOSEN)
def test_no_failure(title: str, name: str, distance: float, tolerance: float) -> None:
    shape = group(title)[name]
    run = Run(title, name, distance * shape.size, tolerance)
    exact = title == "polygons" or (title == "mechanical" and name not in SPLINES)
    contours = one(run, shape, loop_counts(shape, run.distance), exact)
    assert run.failures == []
    assert run.undecided == []
    assert len(sampled(contours, 10)) in (0, 10)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_lines_and_arcs_come_back_exactly_at_any_tolerance(sign: float) -> None:
    shape = group("mechanical")["L bracket"]
    distance = sign * 0.02 * shape.size
    coarse, fine = (
        ss.offset(shape, distance, tolerance=tolerance * shape.size, coarse=True)
        for tolerance in (1e-2, 1e-8)
    )
    verdict = judge(shape, coarse, distance, 1e-6 * shape.size)
    assert verdict.failures == []
    assert verdict.deviation < EXACT * shape.size
    for one_, other in zip(coarse, fine, strict=True):
        np.testing.assert_allclose(one_.arcs, other.arcs, rtol=0.0, atol=EXACT * shape.size)
        np.testing.assert_allclose(one_.weights, other.weights, rtol=0.0, atol=1e-12)
