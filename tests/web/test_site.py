"""The site as a browser shows it: on a desk and on a phone, its pictures, its page to explore."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from tests.docs.pages import DOCS
from tests.web.conftest import Open

PAGE = DOCS / "explorer" / "bracket.html"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-W", "-q", "-b", "html"]
    subprocess.run(
        [*command, "-d", str(place / "trees"), str(DOCS), str(place / "html")], check=True
    )
    return place / "html"


@pytest.mark.parametrize("width", [1280, 390])
def test_pages_fit_the_window_and_show_their_pictures(
    width: int, site: Path, launch: Callable[..., Any]
) -> None:
    tab = launch().new_page(viewport={"width": width, "height": 800})
    errors: list[str] = []
    tab.on("pageerror", lambda error: errors.append(str(error)))
    pages = sorted(page for page in site.rglob("*.html") if page.name != PAGE.name)
    assert len(pages) > 25
    pictures = 0
    for page in pages:
        tab.goto(page.as_uri())
        assert tab.evaluate("document.documentElement.scrollWidth") <= width, page
        shown = tab.evaluate(
            "[...document.querySelectorAll('main img, article img')].map(i => i.naturalWidth)"
        )
        assert all(shown), page
        pictures += len(shown)
    assert pictures >= 10
    assert errors == []


def test_the_page_to_explore_is_small_and_works(open_page: Open) -> None:
    assert PAGE.stat().st_size <= 300_000
    shown = open_page(PAGE)
    assert shown.errors == []
    spline = ss.fit(ss.example("part"), tolerance=0.6).spline
    view = shown.set()
    pixels = np.random.default_rng(2).integers(
        0, (int(view["width"]), int(view["height"])), (500, 2)
    )
    found = np.array(shown.ask("values", pixels.tolist(), None), dtype=float)
    points = shown.points(view, pixels)
    low, high = np.reshape(spline.domain, (2, 2))
    inside = np.all((points > low) & (points < high), axis=1)
    assert inside.sum() > 100
    np.testing.assert_allclose(found[inside], spline(points[inside]), atol=1e-9)
