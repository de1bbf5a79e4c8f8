"""`splinesdf axis`: the medial axis of a shape."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import click

import splinesdf as ss
from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, working
from splinesdf.cli.pipes import OUTPUT
from splinesdf.cli.shapes import (
    check_outputs,
    read_shape,
    shape_options,
    tolerance_of,
    tolerance_option,
)


@click.command()
@shape_options
@tolerance_option
@click.option("-o", "--output", type=OUTPUT, help=".svg .dxf .geojson .csv ..., see offset.")
@click.option("--side", type=click.Choice(["inside", "outside"]), default="inside")
@click.option("--prune", type=float, help="Leave out lower branches. Default: the tolerance.")
@click.option("--no-corners", is_flag=True, help="Leave out branches that end in corners.")
@click.option("--longest", is_flag=True, help="Write the longest path only.")
@answering
def axis(
    shape: str,
    reading: dict[str, Any],
    tolerance: float | None,
    output: str | None,
    side: Any,
    prune: float | None,
    no_corners: bool,
    longest: bool,
) -> None:
    """Find the medial axis of SHAPE: all centers of largest disks in it.

    Between lines, circles and corners it is exact; other edges are within the tolerance.
    """
    check_outputs(shape, output)
    drawn = read_shape(shape, reading)
    tolerance = tolerance_of(drawn, tolerance)
    with working("finding the medial axis"):
        found = ss.medial_axis(drawn, tolerance, side=side, prune=prune, corners=not no_corners)
    if output is not None:
        edges = tuple(found.longest_path()) if longest else found.edges
        if longest and not edges:
            raise ss.InputError("expected an axis with two ends for --longest: this one has loops")
        ss.write(output, replace(found, edges=edges).contours(), tolerance=tolerance)
    kinds = {kind: found.kind.count(kind) for kind in sorted(set(found.kind))}
    figures = {
        "vertices": kinds,
        "edges": len(found.edges),
        "length": found.length,
        "largest_radius": max(
            [edge.largest for edge in found.edges] + found.radius.tolist(), default=None
        ),
        "error": found.error,
        "complete": found.complete,
        "pruned_below": found.pruned_below,
        "written": [] if output is None else [output],
    }

    def show() -> None:
        counts = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
        report.print_pairs(
            axis=f"{len(found.edges):,} edges, length {found.length:.6g}",
            vertices=counts or "none",
            error=f"{found.error:.2e}, tolerance {found.tolerance:.2e}",
            pruned=f"below {found.pruned_below:.4g}",
        )
        report.print_written(output)

    answer(figures, show)
