"""Every code block of the site runs, in an empty folder, and prints what the page says."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import matplotlib
import pytest

import splinesdf as ss
from splinesdf.web.page import write_page
from tests.docs.pages import DOCS, blocks_of, run_page

DATA = Path(ss.__file__).parent / "data"
PAGES = [page for page in sorted(DOCS.rglob("*.md")) if blocks_of(page)]
# Pages of reference speak of files that a reader has: part.svg, a font, a folder of icons. The
# tutorial and the pages under howto/ begin with nothing.
FILES = {"textures.md", "view.md", "command_line.md"}
# What a test cannot run, and why the page says so.
NOT_RUN = {
    **{"benchmarks.md": 1, "command_line.md": 2, "index.md": 1, "tutorial.md": 1, "view.md": 1},
    **{"elsewhere.md": 1, "many.md": 2},
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(DOCS).as_posix())
def test_all_blocks_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    if page.parent == DOCS and page.name in FILES:
        _put_files(tmp_path)
    run_page(page)


def test_few_blocks_are_left_out_and_all_say_why() -> None:
    found = {
        page.name: count
        for page in PAGES
        if (count := sum(block.why_not is not None for block in blocks_of(page)))
    }
    assert found == NOT_RUN


def test_no_block_is_overlooked() -> None:
    kinds = {"python", "sh", "text", "glsl"}
    for page in PAGES:
        blocks = blocks_of(page)
        assert {block.kind for block in blocks} <= kinds, page
        fences = re.findall(r"^\s*```\w+$", page.read_text("utf-8"), re.MULTILINE)
        assert len(fences) == len(blocks), page


def _put_files(folder: Path) -> None:
    shutil.copy(DATA / "part.svg", folder)
    shutil.copy(DATA / "part.svg", folder / "drawing.svg")
    ss.write(folder / "flange.dxf", ss.offset(ss.example("part"), 0))
    fonts = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    shutil.copy(fonts / "DejaVuSans.ttf", folder)
    (folder / "icons").mkdir()
    for icon in (Path(__file__).parents[1] / "data").glob("*-fill.svg"):
        shutil.copy(icon, folder / "icons")


def test_the_page_on_the_site_is_of_today(tmp_path: Path) -> None:
    """Its code and style are those that are written now; after a change of them it is made anew."""
    square = ss.Shape.rectangle(0, 0, 4, 4)
    write_page(tmp_path / "page.html", ss.fit(square, 1.0).spline)
    now, there = (
        file.read_text(encoding="utf-8")
        for file in (tmp_path / "page.html", DOCS / "explorer" / "bracket.html")
    )
    for part in (r"<style>.*?</style>", r'<script id="code">.*?</script>'):
        (written,) = re.findall(part, now, re.DOTALL)
        assert len(written) > 1000
        assert written in there, "run python -m docs.pictures explorer"
