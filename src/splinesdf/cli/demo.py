"""`splinesdf demo`: a part, its fit, its picture and its offsets."""

from __future__ import annotations

from pathlib import Path

import click

import splinesdf as ss
from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, stopwatch, working
from splinesdf.cli.fit import draw, fitted
from splinesdf.cli.shapes import (
    check_outputs,
    offsets_of,
    read_shape,
    tolerance_of,
)

# For the demo's part, in millimeters: near enough that every hole is still there at the first and
# gone at the second, and a tolerance that a milling machine would ask for.
_DEMO_DISTANCES = (-4.0, -2.0, 2.0, 4.0)
_DEMO_TOLERANCE = 1e-3


@click.command()
@click.option("-o", "--output", default="splinesdf-demo", show_default=True, help="The folder.")
@answering
def demo(output: str) -> None:
    """Fit a mechanical part, draw it, save the fit, and write its offsets as SVG and DXF."""
    source = read_shape("part", {})
    folder = Path(output)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ss.InputError(f"cannot make the folder {output!r}: {error.strerror}") from error
    files = [str(folder / name) for name in ("part.npz", "offsets.svg", "offsets.dxf", "part.png")]
    check_outputs("part", *files)
    watch = stopwatch()
    result = fitted(source, tolerance_of(source, None))
    took = watch()
    contours = offsets_of(source, _DEMO_DISTANCES, _DEMO_TOLERANCE)
    with working("writing files"):
        result.spline.save(files[0])
        ss.write(files[1], contours)
        ss.write(files[2], contours)
    draw(result, source, files[3], contours)
    offsets = report.offset_figures(source, contours, _DEMO_DISTANCES)

    def show() -> None:
        report.print_fit(result, source, took)
        report.print_offsets(source, offsets, _DEMO_TOLERANCE)
        report.print_written(*files)

    fit = report.fit_figures(result, source, took)
    answer({"fit": fit, "offsets": offsets, "written": files}, show)
