"""The command line: it parses, calls and prints; nothing is computed here."""

from __future__ import annotations

import re
import sys

import splinesdf as ss

try:
    import click
    import rich  # noqa: F401, no more of it than that it is there: what is used is loaded then
except ImportError:
    # This is the whole program's first import of them, so there is nothing else to be saved.
    print(
        'splinesdf: the command line needs: python -m pip install "splinesdf[cli]"',
        file=sys.stderr,
    )
    raise SystemExit(2) from None

from splinesdf.cli.atlas import atlas
from splinesdf.cli.axis import axis
from splinesdf.cli.batch import batch
from splinesdf.cli.completion import completion
from splinesdf.cli.console import write_on_any_terminal
from splinesdf.cli.demo import demo
from splinesdf.cli.fit import fit
from splinesdf.cli.info import info
from splinesdf.cli.offset import offset
from splinesdf.cli.paper import paper
from splinesdf.cli.query import query
from splinesdf.cli.texture import texture
from splinesdf.cli.thickness import thickness
from splinesdf.cli.vcarve import vcarve
from splinesdf.cli.view import view


def main() -> None:
    """Run the command line; bad input is one line on stderr and exit status 2."""
    write_on_any_terminal()
    try:
        status = commands.main(prog_name="splinesdf", standalone_mode=False)
    except click.Abort:
        click.echo("splinesdf: interrupted; nothing was written", err=True)
        sys.exit(130)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
        sys.exit(2)
    except click.ClickException as error:
        _fail(_in_words(error))
    except ss.SplineSDFError as error:
        _fail(str(error))
    except MemoryError:
        _fail("not enough memory: raise the tolerance, or ask for a band")
    sys.exit(status if isinstance(status, int) else 0)


def _in_words(error: click.ClickException) -> str:
    """What click says, with the way to give several values, which it does not name.

    Its "2mm is not a valid float" becomes what was expected and what came.
    """
    message = error.format_message()
    if isinstance(error, click.MissingParameter) and isinstance(error.param, click.Option):
        meant = (error.param.help or "").rstrip(".")
        return f"expected {error.param.opts[-1]}, got none: {meant[:1].lower()}{meant[1:]}"
    if isinstance(error, click.BadParameter) and error.param is not None:
        got = re.match(r"('.*') is not a valid (?:float|integer)", error.message, re.DOTALL)
        if got:
            name = error.param.opts[0]
            again = f": for several give {name} again for each" if error.param.multiple else ""
            return f"expected a number for {name}, got {got[1]}{again}"
    if message.startswith("Got unexpected extra argument"):
        return f"{message}: for a second value give its option again, as -d 2 -d 4"
    return message


def _fail(message: str) -> None:
    click.echo("splinesdf: " + " ".join(message.split()), err=True)
    sys.exit(2)


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(ss.__version__, prog_name="splinesdf")
def commands() -> None:
    """Closed curves to a compact, smooth signed distance function, and to trimmed offsets.

    SHAPE is a file (.svg, .dxf, .ttf, .geojson, .csv, ...) or the name of a shape that comes
    with the package: part, gamma1, gamma2, gamma3.
    """


_SHAPES = (fit, offset, vcarve, axis, thickness, query, batch)
for _command in (*_SHAPES, texture, atlas, view, paper, info, demo, completion):
    commands.add_command(_command)
