"""`splinesdf paper`: the tables and figures of the paper, computed again."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, working


@click.command()
@click.option("--tables", is_flag=True, help="Print Tables 1-7 beside the printed values.")
@click.option(
    "--spaces", is_flag=True, help="Print errors in S21, S31, S42, which its Section 8 names."
)
@click.option(
    "--figures", metavar="DIR", help="Draw Figures 5-12 into a folder: figure_05.png and so on."
)
@answering
def paper(tables: bool, spaces: bool, figures: str | None) -> None:
    """Recompute the tables and figures of the paper that this package grew from.

    With --spaces and --figures, those of the spaces as well: spaces_bsplines.png and so on.
    """
    from splinesdf.paper import tables as source

    rows, others = [], []
    paths: list[str] = []
    if tables or (figures is None and not spaces):
        with working("computing the tables") as say:
            for row in source.tables():
                rows.append(row)
                say(f"table {row.table}: {row.curve}, {row.operator}, {row.m} × {row.n}")
    if spaces:
        from splinesdf.paper.spaces import space_rows

        with working("computing the spaces") as say:
            for other in space_rows():
                others.append(other)
                say(f"{other.curve}, {other.space}, {other.operator}, {other.n} × {other.n}")
    if figures is not None:
        paths = _drawn(figures, spaces)

    def show() -> None:
        if rows:
            report.print_tables(rows)
        if others:
            report.print_spaces(others)
        report.print_written(*paths)

    tables_of, spaces_of = source.as_json(rows), [asdict(row) for row in others]
    if rows and others:
        answer({"tables": tables_of, "spaces": spaces_of}, show)
    else:
        answer(tables_of or spaces_of or {"written": paths}, show)


def _drawn(folder: str, spaces: bool) -> list[str]:
    """Draw the figures; their files."""
    from splinesdf.paper.figures import figures as draw_all

    with working("drawing the figures"):
        paths = draw_all(folder)
        if spaces:
            from splinesdf.paper.space_figures import space_figures

            paths += space_figures(Path(folder))
    return [str(path) for path in paths]
