"""`splinesdf query`: distances and gradients at the points of a file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click
import numpy as np

from splinesdf.cli import report
from splinesdf.cli.report import working
from splinesdf.cli.shapes import (
    check_outputs,
    holds_fit,
    load_fit,
    read_shape,
    reading_options,
)
from splinesdf.distance.exact import distance_and_gradient
from splinesdf.ground.atomic import write_text
from splinesdf.io.input import read_points


@click.command()
@click.argument("source", metavar="FIT|SHAPE")
@click.argument("points")
@click.option("-o", "--output", help="Write the CSV to a file and not to the screen.")
@reading_options
def query(source: str, points: str, output: str | None, reading: dict[str, Any]) -> None:
    """Distance and gradient at the POINTS of a CSV file: x,y,distance,gx,gy.

    From a saved fit (.npz, .json), or exact from a shape. Not a number: a point that is not one; a
    shape's gradient on the boundary itself.
    """
    if holds_fit(source):
        spline = load_fit(source, reading)
        ask: Callable[[Any], Any] = spline.value_and_gradient
    else:
        shape = read_shape(source, reading)

        def ask(at: Any) -> Any:
            return distance_and_gradient(shape, at)

    at = read_points(points, limits=reading["limits"])
    check_outputs(source, output)
    check_outputs(points, output)
    with working("computing distances"):
        distance, gradient = ask(at)
    table = np.column_stack([at, distance, gradient])
    lines = ["x,y,distance,gx,gy", *(",".join(map(repr, row)) for row in table.tolist()), ""]
    if output is None:
        click.echo("\n".join(lines), nl=False)
    else:
        write_text(output, "\n".join(lines))
        report.print_written(output)
    unknown = int(np.count_nonzero(np.isnan(distance)))
    if unknown:
        click.echo(f"note: no distance at {unknown} of {len(at)} points", err=True)
