"""`splinesdf info`: what is in files."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from splinesdf.cli import report
from splinesdf.cli.console import answer, answering
from splinesdf.cli.pipes import SHAPE
from splinesdf.cli.shapes import holds_fit, load_fit, read_shape, reading_options

Described = tuple[dict[str, str], dict[str, Any]]


@click.command()
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=SHAPE)
@reading_options
@click.option("--measure", is_flag=True, help="Also the area, and the length of the boundary.")
@answering
def info(files: tuple[str, ...], reading: dict[str, Any], measure: bool) -> None:
    """Describe each FILE: a saved fit (.npz, .json) or a shape.

    With --json: an object, or a list of them if there are several files.
    """
    found = [
        _fit(file, reading) if holds_fit(file) else _shape(file, reading, measure) for file in files
    ]
    figures = [one for _, one in found]

    def show() -> None:
        for number, (pairs, _) in enumerate(found):
            if number:
                click.echo()
            report.print_pairs(**pairs)

    answer(figures if len(files) > 1 else figures[0], show)


def _fit(file: str, reading: dict[str, Any]) -> Described:
    spline = load_fit(file, reading)
    made = spline.made
    pairs = {
        "fit": spline.name or file,
        "cells": f"{len(spline.ordinates):,} ({spline.mesh.description})",
        "element": spline.element.name,
        "domain": report.box_text(spline.domain),
        "y": "downward" if spline.y_down else "upward",
        "size": _size_of(file),
        "shape": "not in the file" if spline.shape is None else report.describe(spline.shape),
        **report.provenance(made),
    }
    figures = {
        "fit": spline.name or file,
        "cells": len(spline.ordinates),
        "element": spline.element.name,
        "domain": list(spline.domain),
        "y_down": spline.y_down,
        "made": None if made is None else asdict(made),
    }
    return pairs, figures


def _shape(file: str, reading: dict[str, Any], measure: bool) -> Described:
    shape = read_shape(file, reading)
    measured = {"area": shape.area, "length": shape.length} if measure else {}
    pairs = {
        "shape": shape.name,
        "loops": f"{shape.loop_count} ({shape.fill})",
        "pieces": f"{shape.piece_count} ({report.pieces_by_degree(shape)})",
        "box": report.box_text(shape.box),
        **{name: f"{value:.9g}" for name, value in measured.items()},
        "y": "downward" if shape.y_down else "upward",
        "unit": "not said" if shape.unit is None else f"{shape.unit:.6g} mm",
        "page": "none" if shape.page is None else report.box_text(shape.page),
    }
    figures = {
        "shape": shape.name,
        "loops": shape.loop_count,
        "fill": shape.fill,
        "pieces": shape.piece_count,
        "box": list(shape.box),
        **measured,
        "y_down": shape.y_down,
        "unit": shape.unit,
        "page": None if shape.page is None else list(shape.page),
        "notes": list(shape.notes),
    }
    return pairs, figures


def _size_of(file: str) -> str:
    try:
        return f"{Path(file).stat().st_size:,} bytes"
    except OSError:  # it was there when it was read
        return "no longer there"
