"""`splinesdf thickness`: where a shape is narrowest."""

from __future__ import annotations

from typing import Any

import click

import splinesdf as ss
from splinesdf.cli.console import answer, answering, working
from splinesdf.cli.shapes import read_shape, shape_options


@click.command()
@shape_options
@click.option("--side", type=click.Choice(["inside", "outside"]), default="inside")
@click.option("--count", type=int, default=10, show_default=True, help="Print so many places.")
@answering
def thickness(shape: str, reading: dict[str, Any], side: Any, count: int) -> None:
    """Print the narrowest places of SHAPE: width,x,y,x1,y1,x2,y2.

    Walls, or with --side outside the channels between them: the width, its middle and both ends.
    """
    if count < 1:
        raise ss.InputError(f"expected a count of at least 1, got {count}")
    drawn = read_shape(shape, reading)
    with working("looking for narrow places"):
        found = ss.thickness(drawn, side=side)
    places = [
        {"width": place.width, "point": place.point.tolist(), "feet": place.feet.tolist()}
        for place in found[:count]
    ]

    def show() -> None:
        click.echo("width,x,y,x1,y1,x2,y2")
        for place in found[:count]:
            numbers = [place.width, *place.point.tolist(), *place.feet.ravel().tolist()]
            click.echo(",".join(f"{number:.9g}" for number in numbers))

    answer({"places": places, "found": len(found)}, show)
