"""`splinesdf paper`: the tables and figures of the paper, computed again."""

from __future__ import annotations

import json

import click

from splinesdf.cli import report
from splinesdf.cli.report import working


@click.command()
@click.option("--tables", is_flag=True, help="Print Tables 1-7 beside the printed values.")
@click.option(
    "--figures", metavar="DIR", help="Draw Figures 5-12 into a folder: figure_05.png and so on."
)
@click.option("--json", "as_json", is_flag=True, help="Print the tables as JSON.")
def paper(tables: bool, figures: str | None, as_json: bool) -> None:
    """Recompute the tables and figures of the paper that this package grew from."""
    from splinesdf.paper import tables as source

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
        from splinesdf.paper.figures import figures as draw_all

        with working("drawing the figures"):
            paths = draw_all(figures)
        if not as_json:
            report.print_written(*map(str, paths))
