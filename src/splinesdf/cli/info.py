"""`splinesdf info`: what is in a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from splinesdf.cli import report
from splinesdf.cli.shapes import (
    holds_fit,
    load_fit,
    read_shape,
    reading_options,
)


@click.command()
@click.argument("file")
@reading_options
def info(file: str, reading: dict[str, Any]) -> None:
    """Describe FILE: a saved fit (.npz, .json) or a shape."""
    if holds_fit(file):
        spline = load_fit(file, reading)
        report.print_pairs(
            fit=spline.name or file,
            cells=f"{len(spline.ordinates):,} ({spline.mesh.description})",
            element=spline.element.name,
            domain=report.box_text(spline.domain),
            y="downward" if spline.y_down else "upward",
            size=_size_of(file),
            shape="not in the file" if spline.shape is None else report.describe(spline.shape),
            **report.provenance(spline.made),
        )
    else:
        shape = read_shape(file, reading)
        report.print_pairs(
            shape=shape.name,
            loops=f"{shape.loop_count} ({shape.fill})",
            pieces=f"{shape.piece_count} ({report.pieces_by_degree(shape)})",
            box=report.box_text(shape.box),
            y="downward" if shape.y_down else "upward",
            unit="not said" if shape.unit is None else f"{shape.unit:.6g} mm",
            page="none" if shape.page is None else report.box_text(shape.page),
        )


def _size_of(file: str) -> str:
    try:
        return f"{Path(file).stat().st_size:,} bytes"
    except OSError:  # it was there when it was read
        return "no longer there"
