"""`splinesdf paper`: the tables and figures of the paper, computed again."""

from __future__ import annotations

import click

from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, working


@click.command()
@click.option("--tables", is_flag=True, help="Print Tables 1-7 beside the printed values.")
@click.option(
    "--figures", metavar="DIR", help="Draw Figures 5-12 into a folder: figure_05.png and so on."
)
@answering
def paper(tables: bool, figures: str | None) -> None:
    """Recompute the tables and figures of the paper that this package grew from."""
    from splinesdf.paper import tables as source

    rows, paths = [], []
    if tables or figures is None:
        with working("computing the tables") as say:
            for row in source.tables():
                rows.append(row)
                say(f"table {row.table}: {row.curve}, {row.operator}, {row.m} × {row.n}")
    if figures is not None:
        from splinesdf.paper.figures import figures as draw_all

        with working("drawing the figures"):
            paths = [str(path) for path in draw_all(figures)]

    def show() -> None:
        if rows:
            report.print_tables(rows)
        report.print_written(*paths)

    answer(source.as_json(rows) if rows else {"written": paths}, show)
