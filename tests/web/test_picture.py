"""The picture against `SplineSDF`: its values pixel by pixel, and the colors on the canvas."""

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

_PIXELS = 2000
_ZOOMS = (1.0, 1e3, 1e6, 1e7)


def places(spline: ss.SplineSDF) -> dict[str, tuple[float, float]]:
    """On the curve in the largest and in the smallest cell that it meets, and at a corner."""
    ends = spline.ordinates[:, :4]
    met = np.flatnonzero((ends.min(axis=1) < 0.0) & (ends.max(axis=1) > 0.0))
    boxes = spline.mesh.boxes
    sides = boxes[met, 2] - boxes[met, 0]
    places = {}
    for name, cell in (("large", met[sides.argmax()]), ("small", met[sides.argmin()])):
        center = 0.5 * (boxes[cell, :2] + boxes[cell, 2:])
        x, y = spline.closest_point(center)
        places[name] = float(x), float(y)
    return places | {"corner": (spline.domain[0], spline.domain[1])}


@pytest.mark.parametrize("name", ["part", "thin", "far", "many", "grid"])
def test_values_at_pixels_are_the_splines(
    name: str, pages: Pages, splines: Splines, open_page: Open
) -> None:
    spline, page = splines(name), open_page(pages(name))
    largest = max(map(abs, spline.domain))
    generator = np.random.default_rng(7)
    for place, (x, y) in places(spline).items():
        for zoom in _ZOOMS if place != "corner" else (1e3,):
            view = page.set(cx=x, cy=y, zoom=zoom)
            size = int(view["width"]), int(view["height"])
            pixels = generator.integers(0, size, size=(_PIXELS, 2))
            found = np.array(page.ask("values", pixels.tolist()), dtype=float)
            points = page.points(view, pixels)
            exact = spline(points, outside="nan")
            # On the domain's border rounding decides.
            low, high = np.array(spline.domain[:2]), np.array(spline.domain[2:])
            border = np.minimum(points - low, high - points).min(axis=1)
            clear = np.abs(border) > 1.0 / view["scale"]
            assert (np.isnan(found) == np.isnan(exact))[clear].all(), (place, zoom)
            off = np.abs(found - exact)[clear & ~np.isnan(exact)]
            # A unit in the last place of a coordinate, more or less, and what sums of eight round.
            assert off.max(initial=0.0) <= 1e-14 * largest, (place, zoom)
            assert clear.mean() > 0.5
            # All of the thin domain is a single pixel high.
            assert len(off) > _PIXELS // 20 or place == "corner" or (name, zoom) == ("thin", 1.0)
            assert page.ask("uncovered") == 0, (place, zoom)
    assert page.errors == []


def test_ten_million_times_is_reached(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"))
    whole = page.state()["whole"]
    page.set(zoom=1e7)
    assert page.state()["scale"] == pytest.approx(1e7 * whole)
    # Far from the origin a pixel stays four units in the last place wide: beyond is rounding.
    page = open_page(pages("far"))
    assert page.set(zoom=1e9)["scale"] == pytest.approx(2**50 / 1e6, rel=1e-5)


@pytest.mark.parametrize("name", ["part", "grid"])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_colors_on_the_canvas(
    name: str, theme: str, pages: Pages, splines: Splines, open_page: Open
) -> None:
    """Fill by side, background outside, a strong line at zero, the offset's color at its level."""
    spline, page = splines(name), open_page(pages(name), color_scheme=theme)
    size = max(np.ptp(np.array(spline.domain).reshape(2, 2), axis=0))
    level = 0.04 * size
    view = page.set(level=level, bands=False, mesh=False, exact=False)
    colors = page.colors().astype(int)
    height, width = colors.shape[:2]
    grid = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).reshape(-1, 2)
    points = page.points(view, grid)
    values = spline(points, outside="nan").reshape(height, width)
    slope = np.linalg.norm(spline.gradient(points, outside="nan"), axis=-1).reshape(height, width)
    red, green, blue = np.moveaxis(colors, -1, 0)
    pixels = values * view["scale"]
    from_zero, from_level = np.abs(pixels), np.abs(pixels - level * view["scale"])
    smooth = slope > 0.8
    fill = (from_zero > 3.0) & (from_level > 3.0) & smooth
    assert np.count_nonzero(fill & (values < 0.0)) > 3000
    assert (blue > red)[fill & (values < 0.0)].all()
    assert (red > blue)[fill & (values > 0.0)].all()
    ground = colors[np.isnan(values)]
    assert len(ground)
    assert (np.ptp(ground, axis=1) < 10).all()
    sum_ = red + green + blue
    line = (from_zero < 0.5) & smooth
    assert np.count_nonzero(line) > 300
    assert (sum_[line] < 250).all() if theme == "light" else (sum_[line] > 500).all()
    level_line = (from_level < 0.5) & smooth
    assert np.count_nonzero(level_line) > 300
    assert (red > green + 60)[level_line].all()
    assert (red > blue + 60)[level_line].all()


def test_contour_lines_where_the_values_are_round(
    pages: Pages, splines: Splines, open_page: Open
) -> None:
    spline, page = splines("part"), open_page(pages("part"))
    view = page.set(zoom=4.0, bands=False, exact=False, level=1e9)
    plain = page.colors().astype(int)
    page.set(bands=True)
    lined = page.colors().astype(int)
    height, width = plain.shape[:2]
    grid = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).reshape(-1, 2)
    points = page.points(view, grid)
    values = spline(points, outside="nan").reshape(height, width)
    slope = np.linalg.norm(spline.gradient(points, outside="nan"), axis=-1).reshape(height, width)
    changed = np.abs(plain - lined).sum(axis=-1) > 0
    # Some 56 pixels between two lines: the round number of these that is next to it.
    steps = {s * 10.0**e for s in (1, 2, 5) for e in range(-3, 3)}
    step = min(steps, key=lambda one: abs(np.log(one * view["scale"] / 56.0)))
    off = np.abs(values / step - np.round(values / step)) * step * view["scale"] / slope
    smooth = (slope > 0.8) & (np.abs(values) * view["scale"] > 3.0)
    assert np.count_nonzero((off < 0.5) & smooth) > 1000
    assert changed[(off < 0.5) & smooth].all()
    assert not changed[(off > 1.5) & smooth].any()


def test_mesh_fades_where_cells_are_small(pages: Pages, splines: Splines, open_page: Open) -> None:
    spline, page = splines("many"), open_page(pages("many"))
    view = page.set(mesh=False)
    plain = page.colors().astype(int)
    page.set(mesh=True)
    changed = np.abs(page.colors().astype(int) - plain).sum(axis=-1) > 0
    boxes = spline.mesh.boxes
    sides = (boxes[:, 2] - boxes[:, 0]) * view["scale"]
    # A pixel and more away from where the sides and diagonals of larger cells may be.
    for small, corner in ((sides < 2.9, False), (sides > 8.0, True)):
        at = boxes[small, :2] if corner else 0.5 * (boxes[small, :2] + boxes[small, 2:])
        x = (at[:, 0] - view["cx"]) * view["scale"] + view["width"] / 2
        y = view["down"] * (at[:, 1] - view["cy"]) * view["scale"] + view["height"] / 2
        pixels = np.floor([x, y]).astype(int)
        seen = ((pixels >= 2) & (pixels < np.array([[640 - 2], [480 - 2]]))).all(axis=0)
        shares = changed[pixels[1, seen], pixels[0, seen]].mean()
        assert np.count_nonzero(seen) > 100
        # At a corner four cells meet, and the pixel may lie in a small one.
        assert shares > 0.7 if corner else shares == 0.0


def test_without_webgl_the_picture_is_the_same(pages: Pages, open_page: Open) -> None:
    pictures = []
    for flags in ((), ("--disable-3d-apis",)):
        page = open_page(pages("part"), *flags)
        page.set(level=2.0, mesh=True)
        pictures.append(page.colors().astype(int))
        assert page.errors == []
    assert np.abs(pictures[0] - pictures[1]).max() <= 8
