"""The explorer page's speed and size: time to the first frame, milliseconds a frame, bytes.

    python -m benchmarks.page [--tolerance 1e-3 1.5e-4] [--size 1280x800] [--flags ...]

Tolerances are shares of the part's size. Frames are painted one after the other, the view moved
by a pixel between them: least and median, at ×1, ×30 and ×10⁶. Needs chromium and Playwright.
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import tempfile
from pathlib import Path

import splinesdf as ss
from benchmarks.digest_shapes import PART
from splinesdf.web.page import write_page


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tolerance", type=float, nargs="+", default=[1e-3, 1.5e-4])
    parser.add_argument("--size", default="1280x800")
    parser.add_argument("--frames", type=int, default=25)
    parser.add_argument("--painter", help="Only this one: canvas, workers, walk or quads.")
    parser.add_argument("--flags", nargs="*", default=[], help="For chromium, without their --.")
    given = parser.parse_args()
    from playwright.sync_api import sync_playwright

    shape = ss.read(PART)
    width, height = map(int, given.size.split("x"))
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        flags = ["--no-sandbox", *(f"--{flag}" for flag in given.flags)]
        path = shutil.which("chromium")
        browser = playwright.chromium.launch(executable_path=path, args=flags)
        for share in given.tolerance:
            spline = ss.fit(shape, tolerance=share * shape.size).spline
            page = Path(folder) / "page.html"
            write_page(page, spline)
            cells, size = len(spline.ordinates), page.stat().st_size
            print(f"{cells:,} cells: {size:,} bytes, {size / cells:.1f} a cell")
            _time(browser, page, (width, height), given)
        browser.close()


def _time(browser: object, path: Path, size: tuple[int, int], given: argparse.Namespace) -> None:
    tab = browser.new_page(viewport={"width": size[0], "height": size[1]})
    tab.goto(path.as_uri())
    tab.wait_for_selector("html[data-ready]")
    first = float(tab.get_attribute("html", "data-ready"))
    print(
        f"  first frame {first:.0f} ms after navigation, by {tab.evaluate('splinesdf.painter()')}"
    )
    painters = tab.evaluate("splinesdf.painters()")
    for painter in painters if given.painter is None else [given.painter]:
        tab.evaluate("name => splinesdf.use(name)", painter)
        for zoom in (1.0, 30.0, 1e6):
            tab.evaluate("set => splinesdf.set(set)", {"cx": 0.0, "cy": 40.0, "zoom": zoom})
            times = tab.evaluate("count => splinesdf.times(count)", given.frames)
            print(
                f"  {painter} ×{zoom:g}: {min(times):.1f} ms least, "
                f"{statistics.median(times):.1f} median"
            )
    tab.close()


if __name__ == "__main__":
    main()
