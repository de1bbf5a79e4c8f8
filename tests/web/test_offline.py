"""One file, no request but the file itself, its policy, its size, and its answer to damage."""

from __future__ import annotations

import base64
import re
import zlib
from collections.abc import Callable
from pathlib import Path

import pytest

import splinesdf as ss
from tests.web.browsing import Shown

Pages = Callable[[str], Path]
Splines = Callable[[str], ss.SplineSDF]
Open = Callable[..., Shown]


def test_no_request_and_no_violation(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"))
    page.tab.context.set_offline(True)
    page.set(level=2.0, mesh=True, zoom=100.0)
    page.tab.mouse.move(300.0, 200.0)
    page.tab.keyboard.press("Tab")
    assert page.requests == [pages("part").as_uri()]
    assert page.tab.evaluate("violations") == []
    assert page.errors == []


def test_policy_blocks_what_is_not_the_pages_own(pages: Pages, open_page: Open) -> None:
    page = open_page(pages("part"))
    page.tab.evaluate(
        """async () => {
        const add = (tag, set) =>
            document.body.append(Object.assign(document.createElement(tag), set));
        add('script', { textContent: 'window.broken = 1' });
        add('img', { src: 'http://127.0.0.1:9/x.png' });
        add('style', { textContent: 'body { display: none }' });
        await fetch('http://127.0.0.1:9/').catch(() => 0);
        await new Promise(done => setTimeout(done, 50)); }"""
    )
    found = " ".join(page.tab.evaluate("violations"))
    for directive in ("script-src", "img-src", "style-src", "connect-src"):
        assert directive in found
    assert page.tab.evaluate("window.broken") is None


def _damaged(text: str, change: Callable[[str], str]) -> str:
    start = text.index('id="block">') + len('id="block">')
    end = text.index("</script>", start)
    return text[:start] + change(text[start:end]) + text[end:]


def _flipped(block: str) -> str:
    raw = bytearray(zlib.decompress(base64.b64decode(block)))
    raw[len(raw) // 2] ^= 1
    packed = bytearray(zlib.compress(bytes(raw)))
    # With the checksum of what it was: only that can tell.
    packed[-4:] = base64.b64decode(block)[-4:]
    return base64.b64encode(packed).decode()


@pytest.mark.parametrize(
    "change",
    [
        lambda block: "",
        lambda block: block[: len(block) // 2],
        lambda block: block[:1000] + "!" + block[1001:],
        lambda block: block[:5000] + ("A" if block[5000] != "A" else "B") + block[5001:],
        _flipped,
        lambda block: base64.b64encode(zlib.compress(b"\5\0\0\0\0\0\0\0{nope")).decode(),
        lambda block: base64.b64encode(zlib.compress(b"\xff\xff\0\0\0\0\0\0{}")).decode(),
        lambda block: base64.b64encode(
            zlib.compress(zlib.decompress(base64.b64decode(block))[:-8])
        ).decode(),
    ],
    ids=["empty", "cut", "letter", "other letter", "bit", "no JSON", "length", "short"],
)
def test_damage_is_one_clear_line(
    change: Callable[[str], str], pages: Pages, open_page: Open, tmp_path: Path
) -> None:
    path = tmp_path / "damaged.html"
    path.write_text(_damaged(pages("part").read_text(), change))
    page = open_page(path)
    assert page.tab.get_attribute("html", "data-ready") is None
    line = page.text("#fail")
    assert line.startswith("This page is damaged: ")
    assert "\n" not in line
    assert "undefined" not in line
    assert "is not a" not in line
    assert not page.tab.is_visible("#panel")
    assert page.errors == []


def test_size(pages: Pages, splines: Splines) -> None:
    for name in ("part", "many"):
        cells = len(splines(name).ordinates)
        assert pages(name).stat().st_size <= 50 * cells + 120_000
    assert len(splines("many").ordinates) >= 100_000


def test_names_are_texts(open_page: Open, tmp_path: Path) -> None:
    from splinesdf.web.page import write_page

    name = "</script><img src=x onerror=alert(1)>{{code}}\"'&"
    shape = ss.Shape.from_formula("cos(t)", "sin(t)", name=name)
    write_page(tmp_path / "odd.html", ss.fit(shape, tolerance=0.1).spline, distances=[0.25])
    page = open_page(tmp_path / "odd.html")
    assert page.text("h1") == name
    assert page.tab.title().startswith(name)
    assert page.tab.locator("img").count() == 0
    with page.tab.expect_download() as waiting:
        page.tab.click("#svg")
    assert re.fullmatch(r"[\w.-]+-offset-0\.svg", waiting.value.suggested_filename)
