"""`splinesdf view`: a fit in the browser, from a local server or as one file."""

from __future__ import annotations

from typing import Any

import click

import splinesdf as ss
from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, as_json, note, working
from splinesdf.cli.fit import fitted
from splinesdf.cli.pipes import OUTPUT, SHAPE
from splinesdf.cli.shapes import (
    check_outputs,
    holds_fit,
    load_fit,
    read_shape,
    reading_options,
    tolerance_of,
)
from splinesdf.web.block import check_spline
from splinesdf.web.page import check_page_path, write_page

# Cells beyond which a browser takes seconds to begin; measured at 666,000: three.
_MANY = 300_000


@click.command()
@click.argument("file", type=SHAPE)
@reading_options
@click.option("--tolerance", type=float, help="Of a shape: the fit's.  [1e-3 of its larger side]")
@click.option(
    "--html", "page", type=OUTPUT, help="Write the page to one file that needs no server."
)
@click.option(
    "-d", "--distance", "distances", type=float, multiple=True, help="--html: exact offsets; again."
)
@click.option("--no-open", is_flag=True, help="Print the address, open no browser.")
@answering
def view(
    file: str,
    reading: dict[str, Any],
    tolerance: float | None,
    page: str | None,
    distances: tuple[float, ...],
    no_open: bool,
) -> None:
    """Explore FILE, a saved fit (.npz, .json) or a shape, in the browser.

    Without --html the page comes from this machine and to this machine only, as long as the command
    runs; exact offsets are made at any distance then.
    """
    if page is None and distances:
        raise ss.InputError("expected --distance with --html only: a live page makes any offset")
    if page is not None:
        check_outputs(file, page)
        check_page_path(page)
    spline = _spline(file, reading, tolerance)
    check_spline(spline)
    if len(spline.ordinates) > _MANY:
        note(
            f"note: {len(spline.ordinates):,} cells take a browser seconds to open: a larger "
            "tolerance, or a band, has fewer"
        )
    if page is not None:
        with working("offsetting and writing the page"):
            write_page(page, spline, distances=distances or None)
        figures = {"cells": len(spline.ordinates), "written": [page]}
        answer(figures, lambda: report.print_written(page))
        return
    # Not above: no other command needs a server.
    import webbrowser

    from splinesdf.web.server import make_server

    with working("making the page"):
        server, address = make_server(spline)
    # The address is what was asked for: it is printed even when all else is not.
    if as_json():
        answer({"address": address}, lambda: None)
    else:
        click.echo(address)
        note("Ctrl+C ends it.")
    if not no_open:
        webbrowser.open(address)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        note("ended")
    finally:
        server.server_close()


def _spline(file: str, reading: dict[str, Any], tolerance: float | None) -> ss.SplineSDF:
    if not holds_fit(file):
        shape = read_shape(file, reading)
        return fitted(shape, tolerance_of(shape, tolerance)).spline
    if tolerance is not None:
        raise ss.InputError(
            f"expected a shape for --tolerance, got a saved fit, {file!r}: it has its own"
        )
    return load_fit(file, reading)
