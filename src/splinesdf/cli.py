"""The command line: it parses, calls and prints; nothing is computed here."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

import splinesdf as ss
from splinesdf import report
from splinesdf._atomic import write_text
from splinesdf.distance import distance_and_gradient
from splinesdf.fit import FitResult, fit_steps, require_reached
from splinesdf.io.input import read_points
from splinesdf.meshes import Quadtree
from splinesdf.report import working

try:
    import click
except ImportError:
    # This is the whole program's first import of it, so there is nothing else to be saved.
    print('splinesdf: the command line needs: python -m pip install "splinesdf[cli]"')
    raise SystemExit(2) from None

from splinesdf.cli_offset import offset
from splinesdf.cli_shapes import (
    check_outputs,
    offsets_of,
    read_shape,
    shape_options,
    tolerance_of,
    tolerance_option,
)

# For the demo's part, in millimeters: near enough that every hole is still there at the first and
# gone at the second, and a tolerance that a milling machine would ask for.
_DEMO_DISTANCES = (-4.0, -2.0, 2.0, 4.0)
_DEMO_TOLERANCE = 1e-3


def main() -> None:
    """Run the command line; bad input is one line on stderr and exit status 2."""
    report.write_on_any_terminal()
    try:
        status = commands.main(prog_name="splinesdf", standalone_mode=False)
    except click.Abort:
        click.echo("splinesdf: interrupted; nothing was written", err=True)
        sys.exit(130)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
        sys.exit(2)
    except click.ClickException as error:
        _fail(error.format_message())
    except ss.SplineSDFError as error:
        _fail(str(error))
    except BrokenPipeError:
        # Whoever read the output has enough of it ("| head"); so that the interpreter does not
        # complain when it flushes what is left:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except MemoryError:
        _fail("not enough memory: raise the tolerance, or ask for a band")
    sys.exit(status if isinstance(status, int) else 0)


def _fail(message: str) -> None:
    click.echo("splinesdf: " + " ".join(message.split()), err=True)
    sys.exit(2)


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(ss.__version__, prog_name="splinesdf")
def commands() -> None:
    """Closed curves to a compact, smooth signed distance function, and to trimmed offsets.

    SHAPE is a file (.svg, .json formulas, .csv or .dat points) or the name of a shape that comes
    with the package: part, gamma1, gamma2, gamma3.
    """


@commands.command()
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
@click.option("--operator", help="S, W, V or P.  [default: S; P for bands; W on a tensor grid]")
@click.option("--no-proof", is_flag=True, help="Sample what a proof takes a closer look for.")
@click.option("--domain", type=float, nargs=4, help="XMIN YMIN XMAX YMAX.")
@click.option("--max-cells", type=click.IntRange(min=1), help="Give up beyond so many cells.")
@click.option("-o", "--output", help="Save the fit as .npz.")
@click.option("--plot", "picture", help="Draw the fit as .png, .svg or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print the figures as JSON.")
def fit(
    shape: str,
    fill: str | None,
    close: bool,
    tolerance: float | None,
    output: str | None,
    picture: str | None,
    as_json: bool,
    max_cells: int | None,
    no_proof: bool,
    **options: Any,
) -> None:
    """Fit a signed distance function to SHAPE within a tolerance."""
    source = read_shape(shape, fill, close)
    check_outputs(shape, output, picture)
    if output is not None and Path(output).suffix.lower() != ".npz":
        raise ss.InputError(f"expected a file name ending in .npz for a fit, got {output!r}")
    if picture is not None:
        from splinesdf.plot import check_format as check_picture

        check_picture(picture)
    if max_cells is not None:
        options["max_cells"] = max_cells
    options |= {"band": options["band"] or None, "certify": not no_proof}
    began = time.perf_counter()
    result = _fit(source, tolerance_of(source, tolerance), **options)
    seconds = time.perf_counter() - began
    if output is not None:
        result.spline.save(output)
    if picture is not None:
        _picture(result, source, picture)
    if as_json:
        figures = report.fit_figures(result, source, seconds=seconds)
        click.echo(json.dumps(figures, indent=2))
    else:
        report.print_fit(result, source, seconds)
        report.print_written(output, picture)


commands.add_command(offset)


@commands.command()
@click.argument("source", metavar="FIT.npz|SHAPE")
@click.argument("points")
@click.option("-o", "--output", help="Write the CSV to a file and not to the screen.")
@click.option("--fill", type=click.Choice(["nonzero", "evenodd"]), help="The fill rule.")
@click.option("--close", is_flag=True, help="Close open contours by a straight piece.")
def query(source: str, points: str, output: str | None, fill: str | None, close: bool) -> None:
    """Distance and gradient at the POINTS of a CSV file: x,y,distance,gx,gy.

    From a saved fit, or exact from a shape. Not a number: a point that is not one; a shape's
    gradient on the boundary itself.
    """
    if Path(source).suffix.lower() == ".npz":
        spline = ss.load(source)
        ask: Callable[[Any], Any] = spline.value_and_gradient
    else:
        shape = read_shape(source, fill, close)

        def ask(at: Any) -> Any:
            return distance_and_gradient(shape, at)

    at = read_points(points)
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


@commands.command()
@click.option("--tables", is_flag=True, help="Print Tables 1-7 beside the printed values.")
@click.option(
    "--figures", metavar="DIR", help="Draw Figures 5-12 into a folder: figure_05.png and so on."
)
@click.option("--json", "as_json", is_flag=True, help="Print the tables as JSON.")
def paper(tables: bool, figures: str | None, as_json: bool) -> None:
    """Recompute the tables and figures of the paper that this package grew from."""
    from splinesdf import paper as source

    if tables or as_json or figures is None:
        rows = []
        with working("computing the tables") as say:
            for row in source.tables():
                rows.append(row)
                say(f"table {row.table}: {row.curve}, {row.operator}, {row.m} × {row.n}")
        if as_json:
            click.echo(json.dumps(source.as_json(rows), indent=2))
        else:
            report.print_tables(rows)
    if figures is not None:
        from splinesdf.figures import figures as draw

        with working("drawing the figures"):
            paths = draw(figures)
        if not as_json:
            report.print_written(*map(str, paths))


@commands.command()
@click.argument("file")
@click.option("--fill", type=click.Choice(["nonzero", "evenodd"]), help="The fill rule.")
@click.option("--close", is_flag=True, help="Close open contours by a straight piece.")
def info(file: str, fill: str | None, close: bool) -> None:
    """What is in FILE: a saved fit (.npz) or a shape."""
    if Path(file).suffix.lower() == ".npz":
        spline = ss.load(file)
        mesh = spline.mesh
        kind = f"quadtree of {mesh.depth + 1} levels" if isinstance(mesh, Quadtree) else "grid"
        report.print_pairs(
            fit=spline.name or file,
            cells=f"{len(spline.ordinates):,} ({kind})",
            domain=report.box_text(spline.domain),
            y="downward" if spline.y_down else "upward",
            size=_size_of(file),
            shape="not in the file" if spline.shape is None else report.describe(spline.shape),
            **report.provenance(spline.made),
        )
    else:
        shape = read_shape(file, fill, close)
        report.print_pairs(
            shape=shape.name,
            loops=f"{shape.loop_count} ({shape.fill})",
            pieces=f"{shape.piece_count} ({report.pieces_by_degree(shape)})",
            box=report.box_text(shape.box),
            y="downward" if shape.y_down else "upward",
        )


def _size_of(file: str) -> str:
    try:
        return f"{Path(file).stat().st_size:,} bytes"
    except OSError:  # it was there when it was read
        return "no longer there"


@commands.command()
@click.option("-o", "--output", default="splinesdf-demo", show_default=True, help="The folder.")
def demo(output: str) -> None:
    """Fit a mechanical part, draw it, save the fit, and write its offsets as SVG and DXF."""
    source = read_shape("part", None, False)
    folder = Path(output)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ss.InputError(f"cannot make the folder {output!r}: {error.strerror}") from error
    files = [str(folder / name) for name in ("part.npz", "offsets.svg", "offsets.dxf", "part.png")]
    check_outputs("part", *files)
    began = time.perf_counter()
    result = _fit(source, tolerance_of(source, None))
    seconds = time.perf_counter() - began
    contours = offsets_of(source, _DEMO_DISTANCES, _DEMO_TOLERANCE)
    with working("writing files"):
        result.spline.save(files[0])
        ss.write(files[1], contours)
        ss.write(files[2], contours)
    _picture(result, source, files[3], contours)
    report.print_fit(result, source, seconds)
    report.print_offsets(source, contours, _DEMO_DISTANCES, _DEMO_TOLERANCE)
    report.print_written(*files)


def _fit(shape: ss.Shape, tolerance: float, **options: Any) -> FitResult:
    with working(f"fitting {shape.name} (the first run compiles)") as say:
        for result in fit_steps(shape, tolerance=tolerance, **options):
            say(
                f"fitting {shape.name}: {result.cells:,} cells, error {result.error:.2e}, "
                f"tolerance {tolerance:.2e}"
            )
    return require_reached(result)


def _picture(
    result: FitResult, shape: ss.Shape, path: str, contours: Iterable[ss.Contour] = ()
) -> None:
    from splinesdf.plot import overview, save_figure

    with working("drawing"):
        save_figure(overview(result, shape, contours), path)
