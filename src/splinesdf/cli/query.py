"""`splinesdf query`: distances and gradients at the points of a file."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
import numpy as np

from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, as_json, note, working
from splinesdf.cli.pipes import OUTPUT, SHAPE, TABLE
from splinesdf.cli.shapes import (
    check_outputs,
    holds_fit,
    load_fit,
    read_shape,
    reading_options,
)
from splinesdf.distance.exact import distance_and_gradient
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.atomic import write_text
from splinesdf.io.input import read_points

# Numbers in place of a file's name.
_POINT = r"\s*[-+.\d][-+.\deE\s,;]*"


@click.command()
@click.argument("source", metavar="FIT|SHAPE", type=SHAPE)
@click.argument("points", type=TABLE)
@click.option("-o", "--output", type=OUTPUT, help="Write the CSV to a file and not to the screen.")
@reading_options
@answering
def query(source: str, points: str, output: str | None, reading: dict[str, Any]) -> None:
    """Distance and gradient at the POINTS of a CSV file: x,y,distance,gx,gy.

    From a saved fit (.npz, .json), or exact from a shape. Not a number: a point that is not one; a
    shape's gradient on the boundary itself.
    """
    if holds_fit(points):
        raise InputError(
            f"expected a table of points, got a saved fit, {points!r}: give the points last"
        )
    if re.fullmatch(_POINT, points) and not Path(points).exists():
        one = ",".join(re.findall(r"[^\s,;]+", points))
        raise InputError(
            f"expected a table of points, got {points!r:.60}: write them into a file, or "
            f"echo {one:.40} | splinesdf query {shlex.quote(source):.60} -"
        )
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
    if output is not None:
        write_text(output, "\n".join(lines))
        answer({"points": len(at), "written": [output]}, lambda: report.print_written(output))
    elif as_json():
        found = {"points": at, "distance": distance, "gradient": gradient}
        answer({name: _listed(numbers) for name, numbers in found.items()}, lambda: None)
    else:
        click.echo("\n".join(lines), nl=False)
    unknown = int(np.count_nonzero(np.isnan(distance)))
    if unknown:
        note(f"note: no distance at {unknown} of {len(at)} points")


def _listed(numbers: Floats) -> list[Any]:
    """Numbers for JSON, which has neither NaN nor infinity: null for these."""
    known = numbers.astype(object)
    known[~np.isfinite(numbers)] = None
    listed: list[Any] = known.tolist()
    return listed
