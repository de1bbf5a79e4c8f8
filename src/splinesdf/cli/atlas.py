"""`splinesdf atlas`: the glyphs of a font, or drawings, in one picture of distances."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import splinesdf as ss
from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, note, working
from splinesdf.cli.shapes import axis_of, check_outputs
from splinesdf.io.readers.source import STROKES
from splinesdf.rasters.images import checked_format


@click.command()
@click.argument("source", metavar="FONT|FOLDER")
@click.option("-o", "--output", required=True, help=".png .tif .tiff .npy; a .json comes beside.")
@click.option("--size", type=float, default=32.0, show_default=True, help="Texels in an em.")
@click.option(
    "--range",
    "width",
    type=float,
    default=4.0,
    show_default=True,
    help="Width of the distances that are told apart, in texels.",
)
@click.option("--characters", help="Of the font.  [default: those of ASCII]")
@click.option("--axis", "location", multiple=True, help="Variable fonts: wght=650; again.")
@click.option("--em", help="Drawings: their units in an em, or each.  [default: the largest]")
@click.option(
    "--stroke",
    type=click.Choice(STROKES),
    help="Drawings: strokes fill nothing, what they cover, or closed lines (centre).  [none]",
)
@click.option("--bits", type=int, help="Of a texel. PNG: 8 or 16. NPY: 64 or 32.")
@click.option(
    "--y-origin",
    type=click.Choice(["bottom", "top"]),
    default="bottom",
    show_default=True,
    help="From where the JSON counts y.",
)
@answering
def atlas(
    source: str,
    output: str,
    size: float,
    width: float,
    location: tuple[str, ...],
    em: str | None,
    stroke: str | None,
    bits: int | None,
    y_origin: Any,
    characters: str | None,
) -> None:
    """Write the distances to all glyphs of FONT, or to the drawings in FOLDER, as one picture.

    The layout is written beside it, as the JSON of msdf-atlas-gen.
    """
    checked_format(output, bits)
    layout = str(Path(output).with_suffix(".json"))
    check_outputs(source, output, layout)
    scale: Any = em
    if em is not None and em != "each":
        try:
            scale = float(em)
        except ValueError as error:
            raise ss.InputError(f"expected --em as a number or each, got {em!r:.40}") from error
    with working("computing distances"):
        found = ss.atlas(
            source,
            size=size,
            range=width,
            characters=characters,
            location=dict(map(axis_of, location)) or None,
            em=scale,
            stroke=stroke,
        )
    found.save(output, bits=bits, y_origin=y_origin)
    for line in found.notes:
        note(f"note: {line}")
    high, wide = found.values.shape
    unseen = sum(glyph.cell is None for glyph in found.glyphs)
    figures = {
        "texels": [wide, high],
        "size": found.size,
        "range": found.range,
        "glyphs": len(found.glyphs),
        "unseen": unseen,
        "kerning": len(found.kerning),
        "written": [output, layout],
    }

    def show() -> None:
        report.print_pairs(
            atlas=f"{wide} × {high} texels, {found.size:g} in an em, range {found.range:g}",
            glyphs=f"{len(found.glyphs):,}, of which {unseen:,} with nothing to see",
            kerning=f"{len(found.kerning):,} pairs",
        )
        report.print_written(output, layout)

    answer(figures, show)
