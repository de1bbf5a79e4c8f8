"""`splinesdf texture`: a shape's distances as a picture."""

from __future__ import annotations

from typing import Any

import click

import splinesdf as ss
from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, note, working
from splinesdf.cli.pipes import OUTPUT, SHAPE
from splinesdf.cli.shapes import check_outputs, holds_fit, load_fit, read_shape, reading_options
from splinesdf.rasters.images import checked_format


@click.command()
@click.argument("source", metavar="FIT|SHAPE", type=SHAPE)
@reading_options
@click.option("-o", "--output", required=True, type=OUTPUT, help=".png .tif .tiff .npy")
@click.option("--texels", type=int, default=64, show_default=True, help="Of the larger side.")
@click.option(
    "--range",
    "width",
    type=float,
    required=True,
    help="Width of the distances that are told apart, in the shape's unit.",
)
@click.option("--domain", type=float, nargs=4, help="XMIN YMIN XMAX YMAX.")
@click.option("--bits", type=int, help="Of a texel. PNG: 8 or 16. NPY: 64 or 32.")
@click.option(
    "--rows",
    type=click.Choice(["top", "bottom"]),
    default="top",
    show_default=True,
    help="Which row is first; bottom as in OpenGL.",
)
@answering
def texture(
    source: str,
    reading: dict[str, Any],
    output: str,
    texels: int,
    width: float,
    domain: tuple[float, float, float, float] | None,
    bits: int | None,
    rows: Any,
) -> None:
    """Write the distances to SHAPE at the centers of texels as a picture.

    PNG: 1/2 - distance / range, from 0 to the largest number: half of it on the curve, more inside.
    TIFF and NPY: the distances, negative inside.
    """
    checked_format(output, bits)
    shape = load_fit(source, reading) if holds_fit(source) else read_shape(source, reading)
    check_outputs(source, output)
    with working("computing distances"):
        found = ss.texture(shape, texels, range=width, domain=domain, rows=rows)
    found.save(output, bits=bits)
    for line in found.notes:
        note(f"note: {line}")
    ny, nx = found.values.shape
    low, high = float(found.values.min()), float(found.values.max())
    figures = {
        "texels": [nx, ny],
        "texel": list(found.texel),
        "domain": list(found.domain),
        "distances": [low, high],
        "range": found.range,
        "written": [output],
    }

    def show() -> None:
        report.print_pairs(
            texture=f"{nx} × {ny} texels of {found.texel[0]:.6g}",
            domain=report.box_text(found.domain),
            distances=f"{low:.6g} to {high:.6g}, range {found.range:.6g}",
        )
        report.print_written(output)

    answer(figures, show)
