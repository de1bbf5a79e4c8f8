"""Results as short tables and as JSON: what the command line prints; nothing is computed here."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from splinesdf.cli.console import Took, console, plain
from splinesdf.contours.contour import Contour
from splinesdf.distance.depth import deepest
from splinesdf.fits.fit import FitResult
from splinesdf.io.enclosed import Sides
from splinesdf.io.remeasured import Worst
from splinesdf.meshes import Box
from splinesdf.offsets.offset import deviation
from splinesdf.paper.spaces import SpaceRow
from splinesdf.paper.tables import Row
from splinesdf.shapes.shape import Shape
from splinesdf.splines.provenance import Provenance

if TYPE_CHECKING:
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table

# Columns of a terminal that no table of ours reaches: it is measured as if there were so many.
_WIDEST = 100_000


def print_pairs(**pairs: str) -> None:
    """Names and what they are, one line each."""
    from rich.table import Table

    table = Table.grid(padding=(0, 2))
    table.add_column(no_wrap=True, min_width=max(map(len, pairs)))
    table.add_column()
    for name, value in pairs.items():
        table.add_row(name.replace("_", " "), plain(value))
    terminal = console()
    _wide_enough(terminal, _measured(terminal, table).minimum).print(table, highlight=False)


def print_fit(result: FitResult, shape: Shape, took: Took) -> None:
    """Shape, errors and cost of a fit."""
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
        time=took.text,
    )


def provenance(made: Provenance | None) -> dict[str, str]:
    """The provenance of a saved fit."""
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


def fit_figures(result: FitResult, shape: Shape, took: Took) -> dict[str, Any]:
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
        "seconds": took.seconds,
        "seconds_compiling": took.compiling,
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


def offset_figures(
    shape: Shape, contours: Sequence[Contour], distances: Iterable[float]
) -> list[dict[str, Any]]:
    """For each distance: loops, arcs, length, and how far off they are, measured."""
    figures = []
    for distance in dict.fromkeys(distances):
        here = [contour for contour in contours if contour.distance == distance]
        figures.append(
            {
                "distance": distance,
                "loops": len(here),
                "arcs": sum(len(contour.arcs) for contour in here),
                "length": sum(contour.length for contour in here),
                "deviation": deviation(shape, here) if here else None,
            }
        )
    return figures


def worst_of(figures: Iterable[dict[str, Any]]) -> float:
    """How far off the offsets are at most."""
    return max((one["deviation"] or 0.0 for one in figures), default=0.0)


def print_offsets(shape: Shape, figures: Iterable[dict[str, Any]], tolerance: float) -> None:
    """One line for each distance."""
    _print_line(f"offsets of {shape.name}, tolerance {tolerance:.4g}")
    table = _table()
    for name in ("distance", "loops", "arcs", "length", "deviation"):
        table.add_column(name, justify="right")
    for one in figures:
        off = one["deviation"]
        table.add_row(
            f"{one['distance']:+g}",
            str(one["loops"]),
            f"{one['arcs']:,}",
            f"{one['length']:.6g}",
            _why_nothing(shape, one["distance"]) if off is None else f"{off:.3g}",
        )
    _print_table(table)


def _why_nothing(shape: Shape, distance: float) -> str:
    """Why there is no contour at a distance: no such point, or none that the tolerance shows."""
    gone = distance < 0.0 and deepest(shape, -distance)[1] < -distance
    return "nothing is left" if gone else "nothing as wide as the tolerance"


def print_check(path: str, worst: Worst, tolerance: float) -> None:
    """Deviation and counts of a file that was read back."""
    x, y = worst.point
    print_pairs(
        check=f"{path}, read back: {sum(worst.curves.values())} curves",
        worst=f"{worst.deviation:.4g} from the distance {worst.distance:+g}",
        at=f"({x!r}, {y!r}), as in the file",
        sides=f"{sum(s.asked for s in worst.sides):,} points asked, "
        f"{sum(s.wrong for s in worst.sides):,} on the wrong side",
        verdict=f"within the tolerance {tolerance:.4g}"
        if worst.keeps(tolerance)
        else f"NOT within the tolerance {tolerance:.4g}",
    )


def check_figures(path: str, worst: Worst, tolerance: float) -> dict[str, Any]:
    """The same, for JSON."""
    return {
        "file": path,
        "curves": sum(worst.curves.values()),
        "worst": worst.deviation,
        "distance": worst.distance,
        "at": list(map(float, worst.point)),
        "sides": sum(one.asked for one in worst.sides),
        "wrong_sides": sum(one.wrong for one in worst.sides),
        "kept": worst.keeps(tolerance),
    }


def wrong_sides(sides: Sides) -> str:
    """Region that curves of one distance miss, have twice, or have the wrong way around."""
    x, y = sides.point
    parts = (
        (sides.lost, "nearer, but not enclosed (a contour is lost, or there twice)"),
        (sides.spurious, "farther, but enclosed (a hole is lost, or a contour there twice)"),
        (sides.turned, "enclosed by contours that run the wrong way around"),
    )
    found = ", ".join(f"{count} {text}" for count, text in parts if count)
    return (
        f"at distance {sides.distance:+g}, of {sides.asked:,} points {found}: "
        f"the worst at ({x:.9g}, {y:.9g}), {sides.apart:.3g} from where a contour should be"
    )


def print_tables(rows: Iterable[Row]) -> None:
    """The paper's tables: computed, printed, and the true error."""
    _print_line("Tables 1-7: error at cell centers, the printed one, and the true error")
    table = _table()
    for name in ("table", "curve", "mesh", "operator"):
        table.add_column(name)
    for name in ("k", "m × n", "error", "printed", "true error"):
        table.add_column(name, justify="right")
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
    _print_table(table)
    _print_line(
        "* the printed digits are not the computed ones, rounded: table 2, V, k = 3 has a wrong "
        "exponent; table 2, W, k = 0 is cut off and not rounded; table 6, k = 4 is 2 % too small"
    )


def print_spaces(rows: Iterable[SpaceRow]) -> None:
    """Errors in the paper's spaces by curve, operator and mesh."""
    _print_line("Section 8's spaces: error at cell centers, true error, and that near the curve")
    table = _table()
    for name in ("curve", "space", "operator"):
        table.add_column(name)
    for name in ("n × n", "error", "true error", "order", "near", "order"):
        table.add_column(name, justify="right")
    last = None
    for row in rows:
        if last not in (None, (row.curve, row.space, row.operator)):
            table.add_section()
        last = row.curve, row.space, row.operator
        table.add_row(
            *last,
            f"{row.n} × {row.n}",
            f"{row.error:.3e}",
            f"{row.true_error:.3e}",
            "" if row.order is None else f"{row.order:.2f}",
            f"{row.near_error:.3e}",
            "" if row.near_order is None else f"{row.near_order:.2f}",
        )
    _print_table(table)
    _print_line(
        "near: the largest seen where |u| is 0.02 at most, of gamma3 0.15 and more from where its "
        "petals meet; ridges of the distance, where the order of all is 1, are elsewhere"
    )


def _printed(row: Row) -> str:
    """The figure that the paper prints, in three digits, with a star if ours round to others."""
    if row.printed is None:
        return ""
    text = f"{row.printed:.2e}"
    return text if text == f"{row.error:.2e}" else f"* {text}"


def print_written(*paths: str | None) -> None:
    """The files that were written."""
    for path in filter(None, paths):
        _print_line(f"written   {path}")


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


def _table() -> Table:
    from rich.box import SIMPLE
    from rich.table import Table

    return Table(box=SIMPLE, pad_edge=False)


def _print_line(text: str) -> None:
    """A line as it is, however narrow the terminal: names of files must come out in one piece."""
    console().print(plain(text), highlight=False, soft_wrap=True)


def _print_table(table: Table) -> None:
    """A table as wide as it is, however narrow the terminal: numbers must not be cut."""
    terminal = console()
    _wide_enough(terminal, _measured(terminal, table).maximum).print(table)


def _measured(terminal: Console, table: Table) -> Measurement:
    """The least width at which no word is cut, and the one at which no line is broken."""
    from rich.measure import Measurement

    return Measurement.get(terminal, terminal.options.update(max_width=_WIDEST), table)


def _wide_enough(terminal: Console, width: int) -> Console:
    from rich.console import Console

    return terminal if terminal.width >= width else Console(width=width)
