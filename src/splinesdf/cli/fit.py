"""`splinesdf fit`: a fit within a tolerance, saved, drawn and reported."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import click

import splinesdf as ss
from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, stopwatch, working
from splinesdf.cli.pipes import OUTPUT
from splinesdf.cli.shapes import (
    check_outputs,
    read_shape,
    shape_options,
    tolerance_of,
    tolerance_option,
)
from splinesdf.fits.fit import FitResult, fit_steps, require_reached
from splinesdf.io.fields import FIELDS
from splinesdf.spaces.elements import find_element
from splinesdf.splines.archive import SAVED


@click.command()
@shape_options
@tolerance_option
@click.option(
    "--band",
    "band",
    type=float,
    nargs=2,
    multiple=True,
    help="Keep the tolerance only where LO <= u <= HI; may be given again.",
)
@click.option(
    "--space", default="hierarchical", help="hierarchical, tensor or uniform.", show_default=True
)
@click.option(
    "--operator",
    help="S W V P; of others O C D X S V.  [default: S; P for bands; W on a tensor grid; O]",
)
@click.option(
    "--element",
    default="quadratic",
    help="quadratic, quartic; uniform: cubic, S31, M222, M1122.",
    show_default=True,
)
@click.option("--no-proof", is_flag=True, help="Sample what a proof takes a closer look for.")
@click.option("--domain", type=float, nargs=4, help="XMIN YMIN XMAX YMAX.")
@click.option("--max-cells", type=click.IntRange(min=1), help="Give up beyond so many cells.")
@click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=OUTPUT,
    help="Save the fit as .npz or .json, write its field as .vtu .glsl .wgsl; again.",
)
@click.option("--plot", "picture", type=OUTPUT, help="Draw the fit as .png, .svg or .pdf.")
@answering
def fit(
    shape: str,
    reading: dict[str, Any],
    tolerance: float | None,
    outputs: tuple[str, ...],
    picture: str | None,
    **options: Any,
) -> None:
    """Fit a signed distance function to SHAPE within a tolerance."""
    source = read_shape(shape, reading)
    check_outputs(shape, *outputs, picture)
    for output in outputs:
        _check_fit(output, options["element"])
    if picture is not None:
        from splinesdf.plot import check_format as check_picture

        check_picture(picture)
    options |= {"band": options["band"] or None, "certify": not options.pop("no_proof")}
    if options["max_cells"] is None:
        del options["max_cells"]
    watch = stopwatch()
    result = fitted(source, tolerance_of(source, tolerance), **options)
    took = watch()
    for output in outputs:
        if _suffix(output) in FIELDS:
            ss.write(output, result.spline)
        else:
            result.spline.save(output)
    if picture is not None:
        draw(result, source, picture)
    figures = report.fit_figures(result, source, took)
    figures["written"] = list(filter(None, [*outputs, picture]))

    def show() -> None:
        report.print_fit(result, source, took)
        report.print_written(*outputs, picture)

    answer(figures, show)


def _suffix(path: str) -> str:
    return Path(path).suffix.lower()


def _check_fit(path: str, element: str) -> None:
    """Refuse, before the work, a file that cannot hold the fit."""
    if _suffix(path) not in {*SAVED, *FIELDS}:
        raise ss.InputError(
            f"expected a file name ending in {', '.join(sorted({*SAVED, *FIELDS}))} for a fit, got "
            f"{path!r}"
        )
    kind, suffix = find_element(element), _suffix(path)
    if suffix in FIELDS and suffix != ".vtu" and kind.power_form is None:
        raise ss.InputError(
            f"expected a quadratic or quartic element for {suffix}, got {element}: save the fit as "
            ".npz or .json"
        )


def fitted(shape: ss.Shape, tolerance: float, **options: Any) -> FitResult:
    """Fit a shape, and say how far it is."""
    with working(f"fitting {shape.name}") as say:
        for result in fit_steps(shape, tolerance=tolerance, **options):
            say(
                f"fitting {shape.name}: {result.cells:,} cells, error {result.error:.2e}, "
                f"tolerance {tolerance:.2e}"
            )
    return require_reached(result)


def draw(
    result: FitResult, shape: ss.Shape, path: str, contours: Iterable[ss.Contour] = ()
) -> None:
    """Draw a fit, with offsets if there are any, to a file."""
    from splinesdf.plot import overview, save_figure

    with working("drawing"):
        save_figure(overview(result, shape, contours), path)
