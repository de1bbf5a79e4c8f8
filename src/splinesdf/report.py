"""Results as short tables and as JSON: what the command line prints; nothing is computed here."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from splinesdf.contour import Contour
from splinesdf.curves.shape import Shape
from splinesdf.errors import MissingExtraError
from splinesdf.fit import FitResult
from splinesdf.io.written import Worst
from splinesdf.meshes import Box
from splinesdf.offset import deviation
from splinesdf.paper import Row
from splinesdf.provenance import Provenance

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text


@contextmanager
def working(text: str) -> Iterator[Callable[[str], None]]:
    """A spinner with a text on stderr while something runs; nothing if stderr is no terminal.

    Yields what changes the text.
    """
    console = _console(stderr=True)
    with console.status(_plain(text)) as status:
        yield lambda text: status.update(_plain(text))


def print_pairs(**pairs: str) -> None:
    """Names and what they are, one line each."""
    from rich.table import Table

    table = Table.grid(padding=(0, 2))
    for name, value in pairs.items():
        table.add_row(name.replace("_", " "), _plain(value))
    _console().print(table, highlight=False)


def print_fit(result: FitResult, shape: Shape, seconds: float) -> None:
    """What was fitted, how well, and what it took."""
    made = result.spline.made
    method = "" if made is None else f"{made.space}, {made.operator}"
    where = "where the bands are" if result.bands else "over the whole domain"
    print_pairs(
        shape=describe(shape),
        method=method,
        domain=box_text(result.spline.domain),
        tolerance=_asked(result.tolerance),
        error=f"{result.error:.4g} (largest |s - u| {where})",
        bound="not asked for" if result.bound is None else f"{result.bound:.4g} (proved)",
        centre_error=f"{result.centre_error:.4g} (at cell centers only, as in the paper)",
        cells=f"{result.cells:,}",
        evaluations=f"{result.evaluations:,} exact distances",
        time=f"{seconds:.2f} s",
    )


def provenance(made: Provenance | None) -> dict[str, str]:
    """What a saved fit says of how it was made."""
    if made is None:
        return {"made": "the file does not say how"}
    bands = ", ".join(f"{low:.6g} to {high:.6g}" for low, high in made.bands)
    return {
        "method": f"{made.space}, {made.operator}",
        "kept": f"at distances of {bands}" if bands else "over the whole domain",
        "tolerance": _asked(made.tolerance),
        "error": f"{made.error:.4g} (largest |s - u| found)",
        "bound": "none was asked for" if made.bound is None else f"{made.bound:.4g} (proved)",
        "stopped": made.stopped,
        "evaluations": f"{made.evaluations:,} exact distances",
        "made_by": f"splinesdf {made.version}",
    }


def _asked(tolerance: float | None) -> str:
    return "none was asked for" if tolerance is None else f"{tolerance:.4g}"


def fit_figures(result: FitResult, shape: Shape, *, seconds: float) -> dict[str, Any]:
    """The same and the history, for JSON."""
    made = result.spline.made
    return {
        "shape": shape.name,
        "space": made.space if made else None,
        "operator": made.operator if made else None,
        "domain": list(result.spline.domain),
        "bands": [list(band) for band in result.bands],
        "tolerance": result.tolerance,
        "error": result.error,
        "centre_error": result.centre_error,
        "bound": result.bound,
        "cells": result.cells,
        "stopped": result.stopped,
        "evaluations": result.evaluations,
        "seconds": seconds,
        "history": [
            {
                "cells": step.cells,
                "error": step.error,
                "centre_error": step.centre_error,
                "evaluations": step.evaluations,
            }
            for step in result.history
        ],
    }


def print_offsets(
    shape: Shape, contours: Sequence[Contour], distances: Iterable[float], tolerance: float
) -> None:
    """One line for each distance: loops, arcs, length, and how far off they are, measured."""
    table = _table(f"offsets of {shape.name}, tolerance {tolerance:.4g}")
    for name in ("distance", "loops", "arcs", "length", "deviation"):
        table.add_column(name, justify="right")
    for distance in dict.fromkeys(distances):
        here = [contour for contour in contours if contour.distance == distance]
        table.add_row(
            f"{distance:+g}",
            str(len(here)),
            f"{sum(len(contour.arcs) for contour in here):,}",
            f"{sum(contour.length for contour in here):.6g}",
            f"{deviation(shape, here):.3g}" if here else "nothing is left",
        )
    _console().print(table)


def print_check(path: str, worst: Worst, tolerance: float) -> None:
    """What was found in a file that was read back."""
    x, y = worst.point
    print_pairs(
        check=f"{path}, read back: {sum(worst.curves.values())} curves",
        worst=f"{worst.deviation:.4g} from the distance {worst.distance:+g}",
        at=f"({x!r}, {y!r}), as in the file",
        verdict=f"within the tolerance {tolerance:.4g}"
        if worst.deviation <= tolerance
        else f"NOT within the tolerance {tolerance:.4g}",
    )


def print_tables(rows: Iterable[Row]) -> None:
    """The paper's tables: computed, printed, and the true error."""
    table = _table("Tables 1-7: error at cell centers, the printed one, and the true error")
    for name in ("table", "curve", "mesh", "operator"):
        table.add_column(name)
    for name in ("k", "m × n", "error", "printed", "true error"):
        table.add_column(name, justify="right", no_wrap=True)
    last = None
    for row in rows:
        if last not in (None, row.table):
            table.add_section()
        last = row.table
        table.add_row(
            str(row.table),
            row.curve,
            row.mesh,
            row.operator,
            str(row.k),
            f"{row.m} × {row.n}",
            f"{row.error:.4e}",
            _printed(row),
            f"{row.true_error:.4e}",
        )
    table.caption = (
        "* the printed digits are not the computed ones, rounded: table 2, V, k = 3 has a wrong\n"
        "  exponent; table 2, W, k = 0 is cut off and not rounded; table 6, k = 4 is 2 % too small"
    )
    table.caption_justify = "left"
    _console(least=90).print(table)


def _printed(row: Row) -> str:
    """What the paper prints, in its three digits, with a star if ours round to others."""
    if row.printed is None:
        return ""
    text = f"{row.printed:.2e}"
    return text if text == f"{row.error:.2e}" else f"* {text}"


def print_written(*paths: str | None) -> None:
    """The files that were written."""
    for path in filter(None, paths):
        _console().print(f"written   {path}", highlight=False, markup=False, soft_wrap=True)


def describe(shape: Shape) -> str:
    """Name, parts and size of a shape in a few words."""
    loops = "loop" if shape.loop_count == 1 else "loops"
    pieces = "piece" if shape.piece_count == 1 else "pieces"
    return (
        f"{shape.name}: {shape.loop_count} {loops}, {shape.piece_count} {pieces}, "
        f"larger side {shape.size:.4g}"
    )


def pieces_by_degree(shape: Shape) -> str:
    """How many pieces there are of each polynomial degree."""
    degrees = np.bincount(np.diff(shape.starts) - 1)
    return ", ".join(f"{count} of degree {d}" for d, count in enumerate(degrees) if count)


def box_text(box: Box) -> str:
    """A box as its two ranges."""
    xmin, ymin, xmax, ymax = box
    return f"[{xmin:.6g}, {xmax:.6g}] × [{ymin:.6g}, {ymax:.6g}]"


def _table(title: str) -> Any:
    from rich.box import SIMPLE
    from rich.table import Table

    return Table(
        title=_plain(title, "table.title"), title_justify="left", box=SIMPLE, pad_edge=False
    )


def _plain(text: str, style: str = "") -> Text:
    """A text as it stands: a name from a file is no markup and must not steer the terminal."""
    from rich.text import Text

    return Text("".join(c if c.isprintable() else " " for c in text), style)


def _console(*, stderr: bool = False, least: int = 0) -> Console:
    try:
        from rich.console import Console
    except ImportError as error:
        raise MissingExtraError(
            'the command line needs rich: python -m pip install "splinesdf[cli]"'
        ) from error
    console = Console(stderr=stderr)
    if console.width < least and not console.is_terminal:
        # A file has no width: rows must not be cut to that of an imagined terminal.
        return Console(stderr=stderr, width=least)
    return console
