"""What a person does to the page: wheel, drag, pinch, keys, slider, downloads, link, phone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.web.levels import level_at
from tests.web.browsing import Shown

Pages = Callable[[str], Path]
Splines = Callable[[str], ss.SplineSDF]
Open = Callable[..., Shown]
DESK: dict[str, Any] = {"viewport": {"width": 1280, "height": 800}}
PHONE: dict[str, Any] = {
    "viewport": {"width": 390, "height": 844},
    "device_scale_factor": 3,
    "has_touch": True,
    "is_mobile": True,
}


# Whether the overlay is painted within two pixels of where dashes cross the window's middle: along
# 40 pixels around it there is at least a dash and no more than its gaps are free.
_GREEN = """() => {
  const c = document.getElementById('over'), r = 20, w = 2 * r + 1;
  const d = c.getContext('2d').getImageData(c.width / 2 - r, c.height / 2 - r, w, w).data;
  let near = 0;
  for (let i = 0; i < w * w; i++) {
    const x = i % w - r, y = Math.floor(i / w) - r;
    if (d[4 * i + 3] > 100 && d[4 * i + 1] > d[4 * i] && Math.hypot(x, y) <= 6) near++;
  }
  return near >= 3;
}"""


def test_wheel_keeps_what_is_under_the_mouse(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"), **DESK)
    # Whole pixels, as the mouse has them.
    at = tuple(map(round, page.place(30.0, 40.0)))
    page.tab.mouse.move(*at)
    before = page.state()
    x, y = before["hover"]["x"], before["hover"]["y"]
    for _ in range(10):
        page.tab.mouse.wheel(0, -300)
    page.until(f"splinesdf.state().scale > {20 * before['scale']!r}")
    assert page.place(x, y) == pytest.approx(at, abs=0.01)


def test_drag_moves_the_picture(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"), **DESK)
    page.tab.mouse.move(*page.place(30.0, 40.0))
    x, y = (page.state()["hover"][key] for key in "xy")
    px, py = page.place(x, y)
    page.tab.mouse.down()
    page.tab.mouse.move(px + 60.0, py - 35.0, steps=5)
    page.tab.mouse.up()
    assert page.place(x, y) == pytest.approx((px + 60.0, py - 35.0), abs=1e-6)


def test_pinch_zooms_by_the_fingers_distance(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"), **PHONE)
    before = page.state()
    touch = page.tab.context.new_cdp_session(page.tab)

    def send(kind: str, *fingers: tuple[float, float]) -> None:
        points = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(fingers)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    send("touchStart", (150.0, 200.0), (250.0, 200.0))
    for step in range(1, 6):
        send("touchMove", (150.0 - 10.0 * step, 200.0), (250.0 + 10.0 * step, 200.0))
    send("touchEnd")
    assert page.state()["scale"] / before["scale"] == pytest.approx(2.0, rel=1e-9)
    middle = page.tab.evaluate("splinesdf.state()")
    assert middle["cx"] != before["cx"] or middle["cy"] != before["cy"]


def test_keys(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"), **DESK)
    page.tab.focus("#over")
    press = page.tab.keyboard.press
    start = page.state()
    press("+")
    assert page.state()["scale"] == pytest.approx(1.3 * start["scale"])
    press("ArrowRight")
    assert page.state()["cx"] > start["cx"]
    assert page.text("#status").startswith(("distance ", "outside"))
    press("ArrowUp")
    assert page.state()["cy"] < start["cy"]  # y points down in this drawing
    press("0")
    assert page.state()["scale"] == start["scale"]
    press("]")
    assert page.state()["level"] == pytest.approx(1.0 / start["scale"])
    for key, name in (("m", "mesh"), ("c", "bands"), ("e", "exact")):
        was = page.state()[name]
        press(key)
        assert page.state()[name] is not was
        assert page.tab.is_checked(f"#{name}") is not was
    was = page.tab.evaluate("getComputedStyle(document.body).backgroundColor")
    press("d")
    assert page.tab.evaluate("getComputedStyle(document.body).backgroundColor") != was


def test_tab_order_reaches_everything(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"), **DESK)
    seen = []
    for _ in range(14):
        page.tab.keyboard.press("Tab")
        seen.append(page.tab.evaluate("document.activeElement.id"))
    assert seen[:1] == ["over"]
    every = [
        "number",
        "level",
        "bands",
        "mesh",
        "exact",
        "in",
        "out",
        "whole",
        "ruler",
        "theme",
        "link",
        "svg",
        "dxf",
    ]
    assert seen[1:] == every


def test_slider_and_number_move_the_level(pages: Pages, splines: Splines, open_page: Open) -> None:
    page = open_page(pages("part"), **DESK)
    page.tab.fill("#number", "1.9")
    assert page.state()["level"] == 1.9
    assert float(page.tab.input_value("#level")) == pytest.approx(1.9)
    # Offline the exact curve is the nearest that lies ready, and the page says so.
    assert page.state()["exact"] == 2.0
    assert page.text("#found").startswith("exact at 2: ")
    assert "the nearest in this file" in page.text("#found")
    page.tab.fill("#number", "2")
    assert "nearest" not in page.text("#found")
    shape = splines("part").shape
    assert shape is not None
    level = level_at(shape, 2.0)
    assert f"{level.figures['count']} conics" in page.text("#found")
    said = float(page.text("#found").rpartition("≤")[2])
    assert level.deviation <= said <= 1.01 * level.deviation
    page.tab.fill("#number", "")
    assert page.state()["level"] == 2.0
    page.tab.fill("#level", "-3")
    assert page.state()["level"] == -3.0
    assert page.tab.input_value("#number") == "-3"


@pytest.mark.parametrize("kind", ["svg", "dxf"])
def test_download_is_what_write_writes(
    kind: str, pages: Pages, splines: Splines, open_page: Open, tmp_path: Path
) -> None:
    page = open_page(pages("part"), **DESK)
    page.tab.fill("#number", "-2.1")
    with page.tab.expect_download() as waiting:
        page.tab.click(f"#{kind}")
    assert waiting.value.suggested_filename == f"part-offset--2.{kind}"
    waiting.value.save_as(tmp_path / f"got.{kind}")
    assert "-2, the nearest" in page.text("#status")
    shape = splines("part").shape
    assert shape is not None
    again = ss.read(tmp_path / f"got.{kind}", **({"stroke": "centre"} if kind == "svg" else {}))
    wanted = level_at(shape, -2.0).contours
    assert again.loop_count == len(wanted)
    if kind == "svg":
        ss.write(tmp_path / "wanted.svg", wanted)
        assert (tmp_path / "got.svg").read_text() == (tmp_path / "wanted.svg").read_text()


def test_exact_conics_are_drawn_at_every_zoom(
    pages: Pages, splines: Splines, open_page: Open
) -> None:
    """The line runs through the middle of the window if the view's center is on the conic."""
    page = open_page(pages("part"), **DESK)
    shape = splines("part").shape
    assert shape is not None
    contour = max(level_at(shape, 2.0).contours, key=lambda one: one.length)
    for arc, weight in zip(contour.arcs[::9], contour.weights[::9], strict=True):
        # At t = 0.3, which no halving of the arc meets at once.
        shares = np.array([0.49, 0.42 * weight, 0.09])
        x, y = shares @ arc / shares.sum()
        for zoom in (1.0, 1e3, 1e6, 1e7):
            page.set(level=2.0, exact=True, cx=float(x), cy=float(y), zoom=zoom)
            assert page.state()["segments"] >= 1
            assert page.tab.evaluate(_GREEN), (zoom, x, y)
    page.set(exact=False)
    assert page.state()["segments"] == 0


def test_link_brings_the_view_back(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"), **DESK)
    page.set(cx=12.25, cy=33.5, zoom=37.0, level=1.5, mesh=True, bands=False)
    mine = page.state()
    page.tab.click("#theme")
    page.tab.click("#link")
    address = page.tab.evaluate("location.href")
    other = open_page(address, **DESK)
    its = other.state()
    assert its["level"] == 1.5
    for key in ("cx", "cy", "scale", "level", "mesh", "bands", "exact", "ruling"):
        assert its[key] == mine[key], key
    assert other.tab.get_attribute("html", "data-theme") == "dark"
    # A link that somebody mangled is the page as it is.
    odd = open_page(f"{address.partition('#')[0]}#v=1,NaN,3&o=&m=2&t=<b>&%%%", **DESK)
    assert odd.state()["level"] == 0
    assert odd.errors == []


def test_phone(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"), **PHONE)
    page.tab.touchscreen.tap(*page.place(60.0, 40.0))
    assert "distance" in page.read()
    box = page.tab.locator("#panel").bounding_box()
    assert box["height"] <= 0.4 * 844 + 0.5
    assert page.tab.evaluate("document.documentElement.scrollWidth") == 390
    for button in page.tab.locator("button").all():
        size = button.bounding_box()
        assert size["height"] >= 44.0
        assert size["width"] >= 44.0
    # The whole domain is above the panel.
    for corner in ((-9.0, -7.0), (127.0, 87.0)):
        x, y = page.place(*corner)
        assert 0.0 < x < 390.0
        assert 0.0 < y < box["y"]
