"""Make what the site shows: pictures and the explorer's page, from the blocks of its own pages.

python -m docs.pictures [NAME ...]     part, gcode, pocket, ..., explorer; all unless named
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import splinesdf as ss
from splinesdf.io.recarved import carved_depth
from splinesdf.plot import (
    INK,
    INSIDE,
    OUTSIDE,
    new_figure,
    plot_contours,
    plot_shape,
    save_figure,
)
from splinesdf.web.page import write_page
from tests.docs.pages import blocks_of

DOCS = Path(__file__).resolve().parent
PICTURES = DOCS / "pictures"
Names = dict[str, Any]


@contextlib.contextmanager
def in_empty_folder() -> Iterator[None]:
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def names_of(page: str) -> Names:
    """What a page's Python blocks leave behind."""
    names: Names = {}
    for block in blocks_of(DOCS / "howto" / f"{page}.md"):
        with contextlib.redirect_stdout(io.StringIO()):
            if block.kind == "python":
                exec(block.text, names)
            elif block.kind == "sh":
                _run(block.text)
    return names


def save(figure: Any, name: str) -> None:
    """Few colors are enough for lines, and take a fifth of the bytes."""
    save_figure(figure, name)
    with Image.open(name) as image:
        few = image.convert("RGB").quantize(96, dither=Image.Dither.NONE)
        few.save(PICTURES / name, optimize=True)


def _run(text: str) -> None:
    from splinesdf.cli.main import main

    for line in text.splitlines():
        sys.argv = line.split("#")[0].split()
        with contextlib.suppress(SystemExit):
            main()


def part() -> None:
    readme = (DOCS.parent / "README.md").read_text(encoding="utf-8")
    block = re.search(r"```python\n(.*?)```", readme, re.DOTALL)
    assert block is not None
    exec(block.group(1), {})
    shutil.copy("part.png", DOCS / "part.png")


def explorer() -> None:
    page = (DOCS / "explorer.md").read_text(encoding="utf-8")
    found = re.search(r"--tolerance (\S+) -d -2 -d 2", page)
    assert found is not None
    spline = ss.fit(ss.example("part"), tolerance=float(found[1])).spline
    write_page(DOCS / "explorer" / "bracket.html", spline, distances=[-2, 2])


def explored() -> None:
    """The explorer's page in a browser: Debian's chromium, through Playwright."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        browser = play.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        tab = browser.new_page(viewport={"width": 900, "height": 560})
        tab.goto((DOCS / "explorer" / "bracket.html").as_uri())
        tab.wait_for_timeout(2000)
        tab.screenshot(path="explorer.png")
        browser.close()
    with Image.open("explorer.png") as image:
        few = image.convert("RGB").quantize(96, dither=Image.Dither.NONE)
        few.save(PICTURES / "explorer.png", optimize=True)


def gcode() -> None:
    names = names_of("gcode")
    part, path, machined = names["part"], names["path"], names["machined"]
    figure = new_figure(7.0, 4.6)
    ax = figure.add_subplot()
    plot_shape(part, ax)
    left = ss.Shape.from_contours(machined)
    grid = ss.signed_distance_grid(left, 700, 500, domain=left.box)
    other = ss.signed_distance_grid(part, 700, 500, domain=left.box)
    where = np.maximum(grid.distance, 0.05 - other.distance)  # in the one and not in the other
    ax.contourf(grid.x, grid.y, where, levels=[-99.0, 0.0], colors=["#f2a679"])
    plot_contours(path, ax, color=OUTSIDE)
    ax.set_title("gray: the part; line: the cutter's center; orange: what it leaves", fontsize=9)
    save(figure, "gcode.png")


def pocket() -> None:
    names = names_of("pocket")
    figure = new_figure(7.0, 4.6)
    ax = figure.add_subplot()
    plot_shape(names["pocket"], ax)
    plot_contours(names["wall"], ax, color=OUTSIDE)
    for ring in names["rings"]:
        plot_contours([ring], ax, color=INSIDE)
    for path in names["extra"]:
        plot_contours([path], ax, color="#2a8f5b")
    for piece in names["pieces"]:
        ax.fill(*np.array(piece.exterior.coords).T, color=INK)
    ax.set_title("orange: along walls; blue: rings; green: between; black: what stays", fontsize=9)
    save(figure, "pocket.png")


def vcarve() -> None:
    names = names_of("vcarve")
    carve = names["carve"]
    xmin, ymin, xmax, ymax = names["letter"].box
    x, y = np.linspace(xmin - 2, xmax + 2, 900), np.linspace(ymin - 2, ymax + 2, 900)
    points = np.stack(np.meshgrid(x, y), axis=-1)
    cuts = np.concatenate([np.stack([path[:-1], path[1:]], axis=1) for path in carve.paths])
    z = -carved_depth(cuts, points.reshape(-1, 2), carve).reshape(points.shape[:2])
    figure = new_figure(7.0, 6.0)
    ax = figure.add_subplot()
    drawn = ax.contourf(x, y, z, levels=np.linspace(-4.0, 0.0, 17), cmap="bone")
    figure.colorbar(drawn, ax=ax, label="z of the surface (mm)", ticks=range(-4, 1))
    ground = ss.signed_distance(names["ground"], points)
    ax.contourf(x, y, ground, levels=[-99.0, 0.0], colors=["#f2a679"])
    for path in carve.paths:
        ax.plot(*path[:, :2].T, color=OUTSIDE, lw=0.7)
    ax.set_aspect("equal")
    ax.set_xlabel("x (mm)")
    ax.set_ylabel("y (mm)")
    ax.set_title("gray: how deep; line: the bit's tip; orange: flat, for another tool", fontsize=9)
    save(figure, "vcarve.png")


def check_offset() -> None:
    names = names_of("check_offset")
    points, off, allowed = names["points"], names["off"], names["allowed"]
    figure = new_figure(7.0, 4.6)
    ax = figure.add_subplot()
    plot_shape(names["part"], ax)
    plot_contours(names["exact"], ax, color=INSIDE)
    plot_contours(ss.offset(names["supplied"], 0), ax, color=INK)
    far = np.abs(off) > allowed
    ax.plot(*points[far].T, "o", color=OUTSIDE, markersize=4)
    ax.set_title(
        f"blue: asked and not there; black: supplied; dots: off by more than {allowed}", fontsize=9
    )
    save(figure, "check_offset.png")


def reinitialise() -> None:
    names = names_of("reinitialise")
    x, y = names["x"], names["y"]
    figure = new_figure(8.0, 4.2)
    for k, (values, title) in enumerate(
        [(names["moved"](names["X"], names["Y"]), "before"), (names["again"], "after")]
    ):
        ax = figure.add_subplot(1, 2, k + 1)
        ax.contour(x, y, values, levels=np.arange(-0.5, 1.6, 0.1), colors=[INSIDE], linewidths=0.7)
        ax.contour(x, y, values, levels=[0.0], colors=[OUTSIDE], linewidths=1.6)
        ax.set_aspect("equal")
        ax.set_axis_off()
        ax.set_title(f"{title}: level sets 0.1 apart", fontsize=9)
    save(figure, "reinitialise.png")


def flow_solver() -> None:
    names = names_of("flow_solver")
    figure = new_figure(8.0, 3.8)
    for k, (values, title, colors) in enumerate(
        [
            (names["phi"], "φ at the centers of cells", "RdBu_r"),
            (names["fraction"], "fractions", "Blues"),
        ]
    ):
        ax = figure.add_subplot(1, 2, k + 1)
        span = np.abs(values).max() if k == 0 else 1.0
        shown = ax.imshow(
            values,
            origin="lower",
            extent=(0, 1, 0, 1),
            cmap=colors,
            vmin=-span if k == 0 else 0,
            vmax=span,
        )
        figure.colorbar(shown, ax=ax, shrink=0.85)
        plot_contours(ss.offset(names["drop"], 0), ax, color=INK)
        ax.set_title(title, fontsize=9)
        ax.set_axis_off()
    save(figure, "flow_solver.png")


def unfitted_fem() -> None:
    names = names_of("unfitted_fem")
    spline = ss.interpolate(names["limacon"], (12, 12), domain=(0, 0, 1, 1)).spline
    basis, vector = spline.to_skfem()
    values, inside, crossed = names["sorted_out"](basis, vector)
    figure = new_figure(6.0, 5.4)
    ax = figure.add_subplot()
    mesh = basis.mesh
    ax.triplot(*mesh.p, mesh.t.T, color="#c4ccd4", linewidth=0.5)
    for chosen, color in ((inside, "#dbe7f3"), (crossed, "#f7e3d6")):
        for k in chosen:
            ax.fill(*mesh.p[:, mesh.t[:, k]], color=color, edgecolor="#9aa5b1", linewidth=0.5)
    jacobians, corner = np.moveaxis(mesh.mapping().A, 2, 0), mesh.mapping().b.T
    for k in crossed:
        x, _, y, _, _ = names["cut"](names["polynomial"](values[:, k]))
        ax.plot(*(corner[k] + x @ jacobians[k].T).T, ".", color=INSIDE, markersize=1.5)
        ax.plot(*(corner[k] + y @ jacobians[k].T).T, ".", color=OUTSIDE, markersize=3)
    plot_contours(spline.contours(0.0), ax, color=OUTSIDE)
    ax.lines[-1].set_linewidth(0.6)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_title("points on {s < 0} of cut triangles, and on {s = 0}", fontsize=9)
    save(figure, "unfitted_fem.png")


def textures() -> None:
    names = names_of("textures")
    shutil.copy("atlas.png", PICTURES / "atlas.png")
    picture, codes, sampled = names["picture"], names["codes"], names["sampled"]
    xmin, ymin, xmax, ymax = picture.domain
    ny, nx = codes.shape
    many = 8
    x = xmin + (np.arange(nx * many) + 0.5) * (xmax - xmin) / (nx * many)
    y = ymax - (np.arange(ny * many) + 0.5) * (ymax - ymin) / (ny * many)
    points = np.stack(np.meshgrid(x, y), axis=-1)
    away = sampled(codes, points.reshape(-1, 2)).reshape(points.shape[:2])
    pixel = (xmax - xmin) / (nx * many)
    fill = np.clip(0.5 - away / pixel, 0, 1)
    line = np.clip(0.5 - (np.abs(away - 2.0) - 0.6) / pixel, 0, 1)
    glow = 0.9 * np.clip(1.0 - np.maximum(away, 0.0) / 4.0, 0.0, 1.0)
    blue, orange = np.array([0.13, 0.35, 0.6]), np.array([0.85, 0.4, 0.1])
    image = np.ones((*away.shape, 3))
    for share, color in ((glow, np.array([1.0, 0.8, 0.35])), (line, orange), (fill, blue)):
        image = image * (1 - share[..., None]) + share[..., None] * color
    figure = new_figure(8.0, 4.8)
    for k, (shown, title) in enumerate(((codes, "the texture"), (image, "drawn from it"))):
        ax = figure.add_subplot(2, 1, k + 1)
        ax.imshow(shown, cmap="gray", interpolation="nearest")
        ax.set_axis_off()
        ax.set_title(title, fontsize=9)
    save(figure, "textures.png")


MADE: tuple[Callable[[], None], ...] = (
    *(part, explorer, explored, gcode, pocket, vcarve, check_offset),
    *(reinitialise, flow_solver, unfitted_fem, textures),
)


def main() -> None:
    wanted = sys.argv[1:]
    for make in MADE:
        if not wanted or make.__name__ in wanted:
            with in_empty_folder():
                make()


if __name__ == "__main__":
    main()
