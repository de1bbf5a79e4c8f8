"""What the mouse reads, against `SplineSDF` and the exact distance; the ruler."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from tests.web.browsing import Shown

Pages = Callable[[str], Path]
Splines = Callable[[str], ss.SplineSDF]
Open = Callable[..., Shown]


@pytest.mark.parametrize("name", ["part", "thin", "many", "grid"])
def test_answers_are_the_splines(
    name: str, pages: Pages, splines: Splines, open_page: Open
) -> None:
    spline, page = splines(name), open_page(pages(name))
    low, high = np.array(spline.domain[:2]), np.array(spline.domain[2:])
    points = np.random.default_rng(3).uniform(low, high, (2000, 2))
    found = page.ask("answers", points.tolist())
    assert None not in found
    value, gradient = spline.value_and_gradient(points)
    scale = max(1.0, float(np.abs(spline.domain).max()))
    asked = {key: np.array([one[key] for one in found]) for key in ("value", "gx", "gy")}
    assert np.abs(asked["value"] - value).max() <= 1e-12
    assert np.abs(asked["gx"] - gradient[:, 0]).max() <= 1e-12
    assert np.abs(asked["gy"] - gradient[:, 1]).max() <= 1e-12
    curvature = np.array([one["curvature"] for one in found], dtype=float)
    # Third powers of a slope near zero make rounding large: where it is steep, only.
    steep = np.linalg.norm(gradient, axis=1) > 0.5
    bent = spline.curvature(points)
    assert steep.mean() > 0.9
    assert np.abs(curvature - bent)[steep].max() <= 1e-9 * max(1.0, np.abs(bent[steep]).max())
    normal = np.array([one["normal"] for one in found])
    assert np.abs(normal - spline.normal(points))[steep].max() <= 1e-11
    # Within the domain, and away from ridges, where the next step may go either way.
    feet = spline.closest_point(points, outside="nan")
    mine = np.array([one["foot"] or (np.nan, np.nan) for one in found], dtype=float)
    off = np.linalg.norm(mine - feet, axis=1)
    both = ~np.isnan(off)
    assert both.mean() > 0.7
    assert np.quantile(off[both], 0.9) <= 1e-12 * scale
    assert np.count_nonzero(np.isnan(mine[:, 0]) != np.isnan(feet[:, 0])) <= 20


def test_the_mouse_reads(pages: Pages, splines: Splines, open_page: Open) -> None:
    spline, page = (
        splines("part"),
        open_page(pages("part"), viewport={"width": 1280, "height": 800}),
    )
    page.tab.mouse.move(*page.place(60.0, 30.0))
    lines = page.read()
    assert float(lines["distance"]) == pytest.approx(float(spline((60.0, 30.0))), abs=0.2)
    x, y = map(float, lines["at"].split(","))
    assert float(lines["distance"]) == pytest.approx(float(spline((x, y))), abs=2e-3)
    assert lines["exact − spline"].startswith("within ±")
    assert spline.made is not None
    assert spline.made.bound is not None
    bound = float(lines["exact − spline"].split()[1].removeprefix("±"))
    # Three digits of it, rounded up: a bound must not say too little.
    assert spline.made.bound <= bound <= 1.01 * spline.made.bound
    page.tab.mouse.move(*page.place(spline.domain[2] + 1.0, 30.0))
    assert page.text("#read") == "outside the domain"


def test_ruler(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"), viewport={"width": 1280, "height": 800})
    page.tab.click("#ruler")
    assert page.tab.get_attribute("#ruler", "aria-pressed") == "true"
    for point in ((20.0, 20.0), (80.0, 65.0)):
        page.tab.mouse.click(*page.place(*point))
    lines = page.read()
    (ax, ay), (bx, by) = page.state()["ruler"]
    assert (ax, ay, bx, by) == pytest.approx((20.0, 20.0, 80.0, 65.0), abs=0.2)
    assert float(lines["length"]) == pytest.approx(np.hypot(bx - ax, by - ay), abs=1e-3)
    # y points down here, so a rise of y is a fall on the screen.
    assert float(lines["angle"].rstrip("°")) == pytest.approx(
        np.degrees(-np.arctan2(by - ay, bx - ax)), abs=1e-3
    )
    page.tab.focus("#over")
    page.tab.keyboard.press("Escape")
    assert page.state()["ruler"] == []
