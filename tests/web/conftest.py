"""A browser for the tests of the page: Debian's chromium, driven by Playwright's Python package.

Where one of them is missing the tests skip and say so; with SPLINESDF_BROWSER=required, as CI has
it, they fail.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import splinesdf as ss
from splinesdf.web.page import write_page
from tests.web.browsing import Shown, show
from tests.web.splines import SPLINES

_NAMES = ("chromium", "chromium-browser", "google-chrome")
Open = Callable[..., Shown]


def missing(reason: str) -> None:
    """Skip a test, or fail it where a browser is required."""
    if os.environ.get("SPLINESDF_BROWSER") == "required":
        pytest.fail(f"SPLINESDF_BROWSER=required, but {reason}")
    pytest.skip(reason)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark all tests that start a browser: they are run by themselves (`-m browser`)."""
    for item in items:
        if "launch" in getattr(item, "fixturenames", ()):
            item.add_marker("browser")


@pytest.fixture(scope="session")
def launch() -> Iterator[Callable[..., Any]]:
    """Start a browser, with flags if wanted; one for each set of flags."""
    path = next(filter(None, map(shutil.which, _NAMES)), None)
    if path is None:
        missing("no chromium is installed: apt-get install chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        missing("Playwright is not installed: pip install playwright")
    with sync_playwright() as playwright:
        running: dict[tuple[str, ...], Any] = {}

        def launched(*flags: str) -> Any:
            if flags not in running:
                # Without a sandbox, as CI is root in a container; pages are only our own.
                running[flags] = playwright.chromium.launch(
                    executable_path=path, args=["--no-sandbox", *flags]
                )
            return running[flags]

        yield launched
        for browser in running.values():
            browser.close()


@pytest.fixture
def open_page(launch: Callable[..., Any]) -> Iterator[Open]:
    """Open a page, a file or an address, in a fresh window."""
    contexts = []

    def opened(address: Path | str, *flags: str, **settings: Any) -> Shown:
        usual = {"viewport": {"width": 640, "height": 480}, "color_scheme": "light"}
        context = launch(*flags).new_context(**(usual | settings))
        contexts.append(context)
        return show(context, address)

    yield opened
    for context in contexts:
        context.close()


@pytest.fixture(scope="session")
def splines() -> Callable[[str], ss.SplineSDF]:
    """Splines by name, each made once."""
    made: dict[str, ss.SplineSDF] = {}

    def spline(name: str) -> ss.SplineSDF:
        if name not in made:
            made[name] = SPLINES[name]()
        return made[name]

    return spline


@pytest.fixture(scope="session")
def pages(
    splines: Callable[[str], ss.SplineSDF], tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], Path]:
    """Their pages, each written once."""
    folder = tmp_path_factory.mktemp("pages")

    def page(name: str) -> Path:
        path = folder / f"{name}.html"
        if not path.exists():
            write_page(path, splines(name))
        return path

    return page
