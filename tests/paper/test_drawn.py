"""The method ``plot`` and its like: nothing to draw, nothing to fade, and no matplotlib."""

from __future__ import annotations

import sys

import pytest
from matplotlib.figure import Figure

import splinesdf as ss
from splinesdf import plot
from tests.named_shapes import UNIT, gamma


def test_no_contours_leave_axes_as_they_are() -> None:
    """An offset that nothing is left of is drawn as such, beside others."""
    ax = Figure().subplots()
    nothing = ss.Shape.circle((0.0, 0.0), 1.0).offset(-2.0)
    assert nothing == []
    assert plot.drawn(nothing, ax) is ax
    assert not ax.lines
    assert not ax.collections
    assert ax.get_ylim() == (0.0, 1.0)


def test_without_matplotlib_the_method_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ss.MissingExtraError, match=r'pip install "splinesdf\[plot\]"'):
        ss.Shape.circle((0.0, 0.0), 1.0).plot()


@pytest.mark.parametrize(("band", "faded"), [((-9.0, 9.0), False), ((-0.1, 0.1), True)])
def test_only_what_is_outside_the_bands_is_faded(band: tuple[float, float], faded: bool) -> None:
    spline = ss.fit(gamma("gamma2"), 0.05, band=band, domain=UNIT).spline
    ax = Figure().subplots()
    plot.plot_field(spline, ax)
    assert any(drawn.get_alpha() == 0.6 for drawn in ax.collections) == faded
