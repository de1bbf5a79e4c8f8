"""WebGL2 and workers against the processor's picture and `SplineSDF`, and which of them paints."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import splinesdf as ss
from tests.web.browsing import Shown
from tests.web.conftest import missing
from tests.web.test_picture import places

Pages = Callable[[str], Path]
Splines = Callable[[str], ss.SplineSDF]
Open = Callable[..., Shown]

# Float32 leaves 1e-4 pixels.
_PIXELS_OFF = 1e-3


def _with_webgl(page: Shown) -> Shown:
    if "quads" not in page.ask("painters"):
        missing("this chromium has no WebGL2")
    return page


def _both(page: Shown, name: str) -> tuple[NDArray[Any], NDArray[Any]]:
    """The picture by the processor and by another painter."""
    pictures = []
    for painter in ("canvas", name):
        page.ask("use", painter)
        page.set()
        pictures.append(page.colors().astype(int))
    page.ask("use", None)
    return pictures[0], pictures[1]


def _check(
    page: Shown,
    spline: ss.SplineSDF,
    painter: str,
    view: dict[str, float],
    *,
    others: float = 0.0,
) -> None:
    """Values everywhere, and colors but for a share of pixels."""
    size = int(view["width"]), int(view["height"])
    pixels = np.random.default_rng(5).integers(0, size, size=(2000, 2))
    points = page.points(view, pixels)
    low, high = np.array(spline.domain[:2]), np.array(spline.domain[2:])
    clear = np.abs(np.minimum(points - low, high - points).min(axis=1)) > 1.0 / view["scale"]
    found = np.array(page.ask("values", pixels.tolist(), painter), dtype=float)[clear]
    exact = spline(points, outside="nan")[clear]
    assert (np.isnan(found) == np.isnan(exact)).all()
    allowed = 1e-14 * max(map(abs, spline.domain)) + _PIXELS_OFF / view["scale"]
    assert np.nanmax(np.abs(found - exact), initial=0.0) <= allowed
    assert page.ask("uncovered", painter) == 0
    mine, its = _both(page, painter)
    grid = np.stack(np.meshgrid(*map(np.arange, size)), axis=-1).reshape(-1, 2)
    points = page.points(view, grid)
    clear = np.abs(np.minimum(points - low, high - points).min(axis=1)) > 1.0 / view["scale"]
    assert clear.mean() > 0.9
    apart = np.abs(mine - its).max(axis=-1).ravel()
    assert (apart[clear] > 8).mean() <= others
    assert np.ptp(mine.reshape(-1, 3), axis=0).max() > 10  # a picture, not one color


@pytest.mark.parametrize("name", ["part", "thin", "far", "grid"])
def test_quads_show_what_the_processor_shows(
    name: str, pages: Pages, splines: Splines, open_page: Open
) -> None:
    spline, page = splines(name), _with_webgl(open_page(pages(name)))
    small = (1e3,) if name == "thin" else (1.0, 1e3)  # 40,000 quads at once take software seconds
    for place, zooms in (("small", small), ("large", (1e7,))):
        x, y = places(spline)[place]
        for zoom in zooms:
            view = page.set(cx=x, cy=y, zoom=zoom, level=0.1, mesh=False)
            _check(page, spline, "quads", view)


def test_walk_shows_what_the_processor_shows(
    pages: Pages, splines: Splines, open_page: Open
) -> None:
    spline, page = splines("many"), _with_webgl(open_page(pages("many")))
    for zoom in (1.0, 30.0):
        _check(page, spline, "walk", page.set(cx=20.0, cy=40.0, zoom=zoom, level=1.0))


def test_the_mesh_is_the_same(pages: Pages, open_page: Open) -> None:
    page = _with_webgl(open_page(pages("part")))
    page.set(mesh=True, zoom=3.0)
    for painter in ("quads", "walk"):
        mine, its = _both(page, painter)
        apart = np.abs(mine - its).max(axis=-1)
        # But for pixels on a side between cells of which one shows its mesh and one does not.
        assert np.count_nonzero(apart > 8) <= 1e-3 * apart.size


def test_a_lost_context_is_no_lost_picture(pages: Pages, splines: Splines, open_page: Open) -> None:
    page = _with_webgl(open_page(pages("part")))
    lose = "document.getElementById('gl').getContext('webgl2').getExtension('WEBGL_lose_context')"
    page.ask("use", "quads")
    page.set(zoom=5.0)
    assert page.ask("painter") == "gl"
    page.tab.evaluate(f"window.lose = {lose}, lose.loseContext()")
    page.set(zoom=6.0)
    assert page.ask("painter") == "canvas"
    page.tab.evaluate("lose.restoreContext()")
    page.until("!document.getElementById('gl').getContext('webgl2').isContextLost()")
    page.tab.wait_for_timeout(50)
    view = page.set(zoom=7.0)
    assert page.ask("painter") == "gl"
    _check(page, splines("part"), "quads", view)
    assert page.errors == []


# A graphics processor, feigned: its name, and what its frames take.
_FEIGNED = """
const get = WebGL2RenderingContext.prototype.getParameter;
WebGL2RenderingContext.prototype.getParameter = function (name) {
  return name === 0x9246 || name === 0x1F01 ? 'Some GPU' : get.call(this, name);
};
for (const call of ['drawArrays', 'drawArraysInstanced']) {
  WebGL2RenderingContext.prototype[call] = () => {};
}
WebGL2RenderingContext.prototype.readPixels = () => {
  for (const end = performance.now() + TAKES; performance.now() < end;);
};
"""


@pytest.mark.parametrize(("takes", "painter"), [(0, "gl"), (500, "canvas")])
def test_the_quicker_one_paints(
    takes: int, painter: str, pages: Pages, launch: Callable[..., Any]
) -> None:
    from tests.web.browsing import show

    context = launch().new_context(viewport={"width": 1280, "height": 800})
    context.add_init_script(_FEIGNED.replace("TAKES", str(takes)))
    page = _with_webgl(show(context, pages("part")))
    page.until("splinesdf.compared()")
    page.set()
    assert page.ask("painter") == painter
    context.close()


def test_software_is_not_tried(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"))
    page.until("splinesdf.compared()")
    page.set()
    assert page.ask("painter") == "canvas"
    assert page.tab.is_hidden("#gl")


def test_workers_paint_the_same_to_the_byte(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"))
    for zoom in (1.0, 1e3):
        page.set(zoom=zoom, level=1.5, mesh=True)
        mine, its = _both(page, "workers")
        assert (mine == its).all()
    assert page.tab.evaluate("violations") == []
    # Frames asked for faster than they are painted: the last one stands at the end.
    page.ask("use", "workers")
    page.tab.evaluate(
        "Promise.all([1, 2, 3, 4, 5].map(level => splinesdf.set({ level, zoom: level })))"
    )
    last = page.colors().astype(int)
    page.ask("use", "canvas")
    page.set()
    assert (last == page.colors()).all()


def test_workers_paint_large_windows(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"), viewport={"width": 1000, "height": 900}, device_scale_factor=2)
    page.set(zoom=2.0)
    assert page.ask("painter") == "workers"
    large = page.digest()
    page.ask("use", "canvas")
    page.set()
    assert page.digest() == large
    page.set(zoom=2.1)
    assert page.digest() != large
    assert page.errors == []
