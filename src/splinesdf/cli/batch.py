"""`splinesdf batch`: one job for many files, by all processors or a cluster."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

import splinesdf as ss
from splinesdf.cli.console import answer, answering, working
from splinesdf.cli.shapes import reading_options
from splinesdf.io.writers.options import UNITS

Command = Callable[..., None]


class _Group(click.Group):
    """The jobs in the order in which they are written here."""

    def list_commands(self, _: click.Context) -> list[str]:
        return list(self.commands)


@click.group(cls=_Group)
def batch() -> None:
    """One job for many FILES: offset, fit, grid or write.

    The same command does what is left after a batch that was interrupted or killed. A file that
    fails is told of at the end, with status 1, and stops no other.
    """


def _batch_options(command: Command) -> Command:
    """The files, how they are read, where results go, and who does the work."""
    command = answering(reading_options(command))
    for option in (
        click.option("--overwrite", is_flag=True, help="Replace files that no batch wrote."),
        click.option("--scheduler", help="Address of a Dask cluster, as tcp://10.0.0.1:8786."),
        click.option("-j", "--workers", type=int, help="Processes.  [default: one a processor]"),
        click.option(
            *("-o", "--output"),
            required=True,
            help="With {name} (of the file) or {index} in it: out/{name}.dxf.",
        ),
        click.argument("files", nargs=-1, required=True),
    ):
        command = option(command)
    return command


def _tolerance(command: Command) -> Command:
    return click.option("--tolerance", type=float, help="As of the command of that name.")(command)


def _writing(command: Command) -> Command:
    for option in (
        click.option("--units", type=click.Choice(UNITS), help="DXF, G-code: of the numbers."),
        click.option("--arcs", is_flag=True, help="DXF, SVG: only lines and circular arcs."),
    ):
        command = option(command)
    return command


@batch.command()
@click.option("-d", "--distance", "distances", type=float, multiple=True, help="> 0: outward.")
@click.option("--step", type=float, help="Inward, < 0: at STEP, 2 STEP, ... until nothing is left.")
@click.option("--coarse", is_flag=True, help="Allow a tolerance above a quarter of the distance.")
@_tolerance
@_writing
@_batch_options
def offset(distances: tuple[float, ...], arcs: bool, units: str | None, **given: Any) -> None:
    """Write the trimmed offsets of each file."""
    _run("offset", _about(arcs, units), given, distances=list(distances) or None)


@batch.command()
@click.option("--band", type=float, nargs=2, multiple=True, help="Where LO <= u <= HI; again.")
@click.option("--max-cells", type=int, help="Give up beyond so many cells.")
@_tolerance
@_batch_options
def fit(band: tuple[tuple[float, float], ...], **given: Any) -> None:
    """Fit a signed distance function to each file: .npz, .json, .vtu, .glsl, .wgsl."""
    _run("fit", {}, given, band=list(band) or None)


@batch.command()
@click.option("--nodes", "nx", type=int, nargs=2, required=True, help="Along x and along y.")
@click.option("--domain", type=float, nargs=4, help="XMIN YMIN XMAX YMAX.  [each shape's own]")
@click.option("--max-distance", type=float, help="Look no farther: quicker.")
@_batch_options
def grid(**given: Any) -> None:
    """Exact distances at the nodes of a grid: an .npz with x, y and distance for each file."""
    _run("grid", {}, given)


@batch.command()
@_tolerance
@_writing
@_batch_options
def write(tolerance: float | None, arcs: bool, units: str | None, **given: Any) -> None:
    """Write the boundary of each file in another format."""
    _run(
        "write",
        _about(arcs, units) | ({} if tolerance is None else {"tolerance": tolerance}),
        given,
    )


def _about(arcs: bool, units: str | None) -> dict[str, Any]:
    """The options of writing that were given."""
    return _given({"arcs": arcs, "units": units})


def _run(job: str, writing: dict[str, Any], given: dict[str, Any], **options: Any) -> None:
    """Run a batch, say how far it is, and what came of it."""
    files, output = given.pop("files"), given.pop("output")
    asked = {name: given.pop(name) for name in ("workers", "scheduler", "overwrite")}
    asked |= {"reading": _given(given.pop("reading")), "writing": writing}
    asked |= _given(given | options)
    try:
        with working(f"{job} of {len(files):,} files") as say:
            asked["progress"] = lambda progress: say(str(progress))
            report = ss.batch(files, job, output, **asked)
    except KeyboardInterrupt:
        click.echo("splinesdf: interrupted; the same command does what is left", err=True)
        raise click.exceptions.Exit(130) from None

    def show() -> None:
        counts = {"written": report.written, "kept": report.kept, "failed": report.failed}
        click.echo(", ".join(f"{len(rows):,} {name}" for name, rows in counts.items() if rows))

    for row in report.failed:
        click.echo(f"splinesdf: {row.source}: {_beyond(row)}", err=True)
    answer({"rows": [row._asdict() for row in report.rows]}, show)
    if report.failed:
        raise click.exceptions.Exit(1)


def _given(options: dict[str, Any]) -> dict[str, Any]:
    """Those that were given; zero is a value, and may be refused."""
    return {
        name: value
        for name, value in options.items()
        if value is not None and value is not False and value != ()
    }


def _beyond(row: ss.BatchRow) -> str:
    """A row's message without the file's name, which stands before it."""
    name = row.source.replace("\\", "/").rpartition("/")[2]
    return row.message.removeprefix(f"{name}: ")
